"""The work of a Dask task: the rows of a batch of meshes, and the part of the table that holds them."""

from __future__ import annotations

import inspect
import json
import math
import threading
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from typing import Any

import distributed
import fsspec
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from ._calls import FairingWarning, default_threads
from ._mesh import Mesh, read, read_bytes
from .shapes import icosphere

#: Arrow types by the names that `pyfairing.dataset` takes.
TYPES = {
    "int64": pa.int64(),
    "float64": pa.float64(),
    "bool": pa.bool_(),
    "string": pa.string(),
    "list": pa.list_(pa.float64()),
    "matrix": pa.list_(pa.list_(pa.float64())),
}

#: Columns of every data set.
OWN = {
    "row": pa.int64(),
    "path": pa.string(),
    "vertices": pa.int64(),
    "faces": pa.int64(),
    "error": pa.string(),
    "warnings": pa.list_(pa.string()),
}

#: Bytes for each vertex of tasks without the attribute `bytes_per_vertex`.
PER_VERTEX = 2_000

#: Held by a mesh that needs more than its thread's part of the memory.
_LARGE = threading.Lock()


@dataclass(frozen=True)
class Source:
    """A file of the data set."""

    #: The row, and the place in the caller's list.
    row: int
    place: int
    path: str
    #: In bytes; None for a file that cannot be found.
    size: int | None


#: Files of consecutive rows, computed by one task.
Batch = Sequence[Source]


@dataclass(frozen=True)
class Work:
    """A task with the types of its columns and the settings of its calls."""

    task: Any
    columns: dict[str, str]
    bytes_per_vertex: int
    threads: int

    def schema(self) -> pa.Schema:
        return pa.schema(OWN | {name: TYPES[kind] for name, kind in self.columns.items()})

    def rows(self, batch: Batch) -> list[dict[str, Any]]:
        """Computes the rows of a batch; a mesh that fails becomes a row with its error."""
        with default_threads(self.threads):
            return [self._row(source) for source in batch]

    def frame(self, batch: Batch) -> pd.DataFrame:
        """Computes a batch as a pandas table."""
        return to_pandas(pa.Table.from_pylist(self.rows(batch), self.schema()))

    def save(self, batch: Batch, folder: str) -> None:
        """Computes a batch and writes its part."""
        self.write(batch, self.rows(batch), folder)

    def write(self, batch: Batch, rows: Sequence[Mapping[str, Any]], folder: str) -> None:
        """Writes the part of a batch."""
        fs, root = fsspec.core.url_to_fs(folder)
        with complete(fs, part_name(root, batch[0].row, batch[-1].row + 1)) as file:
            pq.write_table(pa.Table.from_pylist(rows, self.schema()), file)

    def name(self) -> str:
        """The task with its arguments, and the columns: runs that share a folder have the same."""
        function = innermost(self.task)
        name = getattr(function, "__qualname__", type(function).__name__)
        arguments = [getattr(self.task, "args", ()), getattr(self.task, "keywords", {})]
        parts = [getattr(function, "__module__", ""), name, arguments, self.columns]
        return json.dumps(parts, sort_keys=True, default=str)

    def _row(self, source: Source) -> dict[str, Any]:
        row: dict[str, Any] = {"row": source.row, "path": source.path}
        limit, fair = _memory()
        with warnings.catch_warnings(record=True) as seen:
            warnings.simplefilter("always", FairingWarning)
            try:
                mesh = load(source.path)
                row |= {"vertices": mesh.n_vertices, "faces": mesh.n_faces}
                need = mesh.n_vertices * self.bytes_per_vertex
                if need > limit:
                    raise MemoryError(
                        f"{mesh.n_vertices} vertices need about {need / 1e9:.3g} GB,"
                        f" but the worker has {limit / 1e9:.3g} GB"
                    )
                with _LARGE if need > fair else nullcontext():
                    found = result(self.task, mesh, source.path)
                unknown = sorted(set(found) - set(self.columns))
                if unknown:
                    raise ValueError(
                        f"the task returned columns that other meshes do not have: {', '.join(unknown)}"
                    )
                row |= {name: _value(name, value, self.columns[name]) for name, value in found.items()}
            except Exception as exception:
                row["error"] = f"{type(exception).__name__}: {exception}"
        row["warnings"] = [str(w.message) for w in seen if issubclass(w.category, FairingWarning)]
        return row


def load(path: str) -> Mesh:
    if "://" not in path:
        return read(path)
    fs, inner = fsspec.core.url_to_fs(path)
    with fs.open(inner, "rb") as file:
        return read_bytes(file.read(), inner.rsplit("/", 1)[-1])


def innermost(task: Any) -> Any:
    """The function behind a `functools.partial`."""
    while hasattr(task, "func"):
        task = task.func
    return task


def takes_path(task: Any) -> bool:
    """True if the task has a parameter `path` that is not set yet."""
    try:
        parameters = inspect.signature(task).parameters
    except (TypeError, ValueError):
        return False
    return "path" in parameters and "path" not in getattr(task, "keywords", {})


def result(task: Any, mesh: Mesh, path: str) -> dict[str, Any]:
    """The result of a task on a mesh and, if the task takes it, the address of its file."""
    return dict(task(mesh, path=path) if takes_path(task) else task(mesh))


def columns_of(task: Any, sources: Sequence[Source]) -> dict[str, str]:
    """The types of the columns, from the task on a sphere of 162 vertices, or on the first readable file
    if the task takes a path."""
    samples = [source.path for source in sources] if takes_path(task) else [""]
    failure: Exception | None = None
    for path in samples:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FairingWarning)
            try:
                row = result(task, load(path) if path else icosphere(2), path)
            except Exception as error:
                failure = error
                continue
        return {name: _kind_of(name, value) for name, value in row.items()}
    where = "on every file" if takes_path(task) else "on a small sphere"
    raise ValueError(f"the task fails {where} ({failure}): pass columns") from failure


def _kind_of(name: str, value: Any) -> str:
    """The name in `TYPES` of a value."""
    array = np.asarray(value)
    scalars = {"b": "bool", "i": "int64", "u": "int64", "f": "float64", "U": "string"}
    if array.ndim == 0 and array.dtype.kind in scalars:
        return scalars[array.dtype.kind]
    if array.ndim in (1, 2) and array.dtype.kind in "biuf":
        return "list" if array.ndim == 1 else "matrix"
    raise ValueError(
        f"the task returns {name} as {array.dtype} of {array.ndim} dimensions: columns hold numbers,"
        " strings, and arrays of numbers with one or two dimensions; for missing values pass columns"
    )


def _value(name: str, value: Any, kind: str) -> Any:
    """A value in a form that Arrow stores."""
    if value is None:
        return None
    found = _kind_of(name, value)
    if found != kind and (found, kind) != ("int64", "float64"):
        raise TypeError(f"{name} is of type {found}, but {kind} for other meshes")
    if kind in ("list", "matrix"):
        return list(np.asarray(value, dtype=np.float64))
    return np.asarray(value).item()


def _memory() -> tuple[float, float]:
    """Memory of this Dask worker, and of each of its threads, in bytes; infinite if unknown."""
    try:
        worker = distributed.get_worker()
    except ValueError:
        return math.inf, math.inf
    limit = worker.memory_manager.memory_limit or math.inf
    return limit, limit / worker.state.nthreads


def part_name(root: str, first: int, end: int) -> str:
    """The file of the rows from `first` to before `end`."""
    return f"{root}/part-{first:09d}-{end:09d}.parquet"


@contextmanager
def complete(fs: Any, path: str) -> Iterator[Any]:
    """Opens a file that gets its name once it is complete."""
    folder, name = path.rsplit("/", 1)
    unfinished = f"{folder}/_{name}.{threading.get_ident()}-{time.time_ns()}"
    with fs.open(unfinished, "wb") as file:
        yield file
    fs.mv(unfinished, path)


def to_pandas(arrow: Any) -> pd.DataFrame:
    """A pandas table with missing values distinct from NaN."""
    return arrow.to_pandas(types_mapper=pd.ArrowDtype).set_index("row")
