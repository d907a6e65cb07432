"""Work of a worker: computes and writes the rows of a batch of meshes."""

from __future__ import annotations

import inspect
import threading
import time
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from ._calls import FairingWarning, default_threads
from ._mesh import read, read_bytes
from ._plan import Batch, Source, filesystem

#: The share of a worker's memory that meshes may take together.
_SHARE = 0.7
#: Columns of every data set, with their types.
OWN = {
    "row": "int64",
    "path": "string",
    "vertices": "int64",
    "faces": "int64",
    "error": "string",
    "warnings": "list",
}

#: The types of arrays, with their numbers of dimensions.
DIMENSIONS = {"list": 1, "matrix": 2}


class _Budget:
    """Memory budget of the meshes in one process: a mesh that does not fit waits."""

    def __init__(self) -> None:
        self._change = threading.Condition()
        self._used = 0

    @contextmanager
    def taking(self, need: int, limit: int | None) -> Iterator[None]:
        share = need if limit is None else min(need, int(_SHARE * limit))
        with self._change:
            # A mesh that needs more than the share runs alone.
            while limit is not None and self._used and self._used + share > _SHARE * limit:
                self._change.wait()
            self._used += share
        try:
            yield
        finally:
            with self._change:
                self._used -= share
                self._change.notify_all()


_BUDGET = _Budget()


def memory_limit() -> int | None:
    """The memory limit of the current dask worker, if any."""
    try:
        from distributed import get_worker

        worker = get_worker()
    except (ImportError, ValueError):
        return None
    limit = getattr(getattr(worker, "memory_manager", None), "memory_limit", None)
    return int(limit) if limit else None


def load(source: Source) -> Any:
    if "://" not in source.path:
        return read(source.path)
    fs, inner = filesystem(source.path)
    with fs.open(inner, "rb") as file:
        return read_bytes(file.read(), inner.rsplit("/", 1)[-1])


def takes_path(task: Any) -> bool:
    """True if the task has a parameter `path` that is not set yet."""
    try:
        parameters = inspect.signature(task).parameters
    except (TypeError, ValueError):
        return False
    return "path" in parameters and "path" not in getattr(task, "keywords", {})


def call(task: Any, mesh: Any, path: str) -> dict[str, Any]:
    """The result of a task on a mesh and, if it takes that, the address of its file."""
    return dict(task(mesh, path=path) if takes_path(task) else task(mesh))


def _row(
    source: Source, task: Any, columns: Mapping[str, str], need: int, limit: int | None
) -> dict[str, Any]:
    row: dict[str, Any] = {"row": source.row, "path": source.path, "vertices": None, "faces": None}
    caught: list[str] = []
    error = None
    if limit is not None and need > limit:
        error = (
            f"MemoryError: about {source.vertices} vertices need about {need / 1e9:.3g} GB,"
            f" but the worker has {limit / 1e9:.3g} GB"
        )
    else:
        with _BUDGET.taking(need, limit), warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always", FairingWarning)
            try:
                mesh = load(source)
                row["vertices"], row["faces"] = mesh.n_vertices, mesh.n_faces
                found = call(task, mesh, source.path)
                strange = sorted(set(found) - set(columns))
                if strange:
                    raise ValueError(
                        f"the task returned columns that it has not for others: {', '.join(strange)}"
                    )
                row |= {name: _plain(found[name], columns[name], name) for name in found}
            except Exception as exception:
                row = {name: row[name] for name in ("row", "path", "vertices", "faces")}
                error = f"{type(exception).__name__}: {exception}"
        caught = [str(w.message) for w in seen if issubclass(w.category, FairingWarning)]
    return row | {"error": error, "warnings": caught}


def _plain(value: Any, kind: str, name: str) -> Any:
    """A value in a form that Parquet stores."""
    if value is None:
        return None
    if kind in DIMENSIONS:
        array = np.asarray(value, dtype=np.float64)
        if array.ndim != DIMENSIONS[kind]:
            raise TypeError(f"{name} has {array.ndim} dimensions, but {DIMENSIONS[kind]} for other meshes")
        return list(array) if array.ndim == 2 else array
    if isinstance(value, np.generic):
        value = value.item()
    wanted: dict[str, Any] = {"int64": int, "float64": (int, float), "bool": bool, "string": str}
    if not isinstance(value, wanted[kind]) or (kind in ("int64", "float64") and isinstance(value, bool)):
        raise TypeError(f"{name} is a {type(value).__name__}, but {kind} for other meshes")
    return float(value) if kind == "float64" else value


def rows(
    batch: Batch, task: Any, columns: Mapping[str, str], per_vertex: int, threads: int
) -> list[dict[str, Any]]:
    """The rows of a batch; a mesh that fails becomes a row with its error."""
    limit = memory_limit()
    done = []
    with default_threads(threads):
        for source in batch.sources:
            need = source.vertices * per_vertex + 2 * (source.size or 0)
            done.append(_row(source, task, columns, need, limit))
    return done


def failed(batch: Batch, error: str) -> list[dict[str, Any]]:
    """Rows of meshes that killed their workers."""
    return [
        {"row": s.row, "path": s.path, "vertices": None, "faces": None, "error": error, "warnings": []}
        for s in batch.sources
    ]


def schema(columns: Mapping[str, str]) -> Any:
    """The Arrow schema: the columns of every data set, then those of the task and of the table."""
    import pyarrow as pa

    kinds = {
        "int64": pa.int64(),
        "float64": pa.float64(),
        "bool": pa.bool_(),
        "string": pa.string(),
        "list": pa.list_(pa.float64()),
        "matrix": pa.list_(pa.list_(pa.float64())),
    }
    own = [pa.field(n, pa.list_(pa.string()) if n == "warnings" else kinds[k]) for n, k in OWN.items()]
    return pa.schema(own + [pa.field(n, kinds[k]) for n, k in columns.items()])


def table(done: list[dict[str, Any]], columns: Mapping[str, str]) -> Any:
    """The rows as an Arrow table."""
    import pyarrow as pa

    fields = schema(columns)
    return pa.table({f.name: pa.array([row.get(f.name) for row in done], f.type) for f in fields}, fields)


def write(done: list[dict[str, Any]], columns: Mapping[str, str], folder: str, part: str) -> str:
    """Writes the rows of a batch, whole or not at all."""
    import pyarrow.parquet as pq

    fs, inner = filesystem(folder)
    target = f"{inner.rstrip('/')}/{part}"
    unfinished = f"{inner.rstrip('/')}/_{part}.{threading.get_ident()}-{time.time_ns()}"
    with fs.open(unfinished, "wb") as file:
        pq.write_table(table(done, columns), file)
    fs.mv(unfinished, target)
    return part


def write_note(fs: Any, note: str, fingerprint: str, sources: list[Source]) -> None:
    """Writes the files of a run and its fingerprint, whole or not at all."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    files = pa.table(
        {
            "path": pa.array([s.path for s in sources], pa.string()),
            "size": pa.array([s.size for s in sources], pa.int64()),
        }
    ).replace_schema_metadata({"fingerprint": fingerprint})
    unfinished = f"{note}.{time.time_ns()}"
    with fs.open(unfinished, "wb") as file:
        pq.write_table(files, file)
    fs.mv(unfinished, note)


def read_note(fs: Any, note: str) -> tuple[str, list[tuple[str, int | None]]]:
    """The fingerprint of a run, and its files with their sizes, in the order of the rows."""
    import pyarrow.parquet as pq

    with fs.open(note, "rb") as file:
        files = pq.read_table(file)
    fingerprint = (files.schema.metadata or {}).get(b"fingerprint", b"").decode()
    return fingerprint, list(zip(files["path"].to_pylist(), files["size"].to_pylist(), strict=True))


def run(
    batch: Batch, task: Any, columns: Mapping[str, str], per_vertex: int, threads: int, folder: str
) -> str:
    """Computes and writes a batch; returns the name of its part."""
    return write(rows(batch, task, columns, per_vertex, threads), columns, folder, batch.part)


def frame(batch: Batch, task: Any, kinds: tuple[tuple[str, str], ...], per_vertex: int, threads: int) -> Any:
    """Computes a batch and returns its rows as a pandas table, for collections that are not written."""
    columns = dict(kinds)
    return to_pandas(table(rows(batch, task, columns, per_vertex, threads), columns))


def to_pandas(arrow: Any) -> Any:
    """A pandas table with missing values distinct from NaN."""
    import pandas as pd

    found = arrow.to_pandas(types_mapper=pd.ArrowDtype)
    return found.set_index("row")
