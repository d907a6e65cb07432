"""Computations on many meshes and many machines."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from concurrent.futures import FIRST_COMPLETED, ThreadPoolExecutor, wait
from os import PathLike, cpu_count, fspath
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _batch, _plan
from ._calls import FairingWarning, Progress, call
from ._plan import Batch

if TYPE_CHECKING:
    from .tasks import Task

#: Batches that are given to a cluster at a time, for each of its threads.
_AHEAD = 4
#: Seconds after which a cluster is asked whether it has workers.
_PATIENCE = 5
#: So many times without a worker, and a warning says so.
_PATIENT = 12
#: Bytes for each vertex of tasks that do not say.
_PER_VERTEX = 2_000


def dataset(
    paths: Any,
    task: Task,
    out: str | PathLike[str] | None = None,
    *,
    client: Any = None,
    columns: Mapping[str, str] | None = None,
    bytes_per_vertex: int | None = None,
    threads: int = 1,
    resume: bool = True,
    progress: Progress = None,
) -> Any:
    """Applies a task to each mesh of a data set: a Dask collection with one row per mesh.

    Parameters
    ----------
    paths : str, path, sequence of them, or table
        Addresses of files, local or of fsspec (`s3://...`); one with `*`, `?` or `[` is a
        glob. A table of pandas or dask has them in the column `path`.
    task : callable
        Called with a `Mesh`, and with its address as `path=` if it has a parameter of this name, so
        that it can write a file for each mesh; returns a mapping from the names of columns to numbers,
        strings, or arrays of one or two dimensions: a function of `pyfairing.tasks`, or any other. It
        must be picklable for the workers, and its result should depend on mesh and path alone: a mesh
        may be computed twice.
    out : str or path, optional
        A folder, local or of fsspec, that all workers can access. If given, the meshes are
        computed at once and each batch is written to Parquet when it is done; an interrupted
        run resumes and does not recompute written batches, and files that have been added since are
        computed alone. Otherwise the collection is lazy.
    client : distributed.Client, optional
        The cluster; the current client of dask if there is one, else threads of this process.
    columns : mapping of str to str, optional
        The type of each column of the task: `int64`, `float64`, `bool`, `string`, `list` (of
        float64) or `matrix` (a list of lists). By default inferred by running the task on a small
        sphere, or on the first file if it takes a path.
    bytes_per_vertex : int, optional
        Memory that the task needs; by default `task.bytes_per_vertex` or 2000. Times the number
        of vertices in the header of a file (or from its size) it estimates the memory of a mesh:
        meshes that do not fit into a worker together wait for each other.
    threads : int
        Threads per mesh; a worker processes as many meshes at once as it has threads.
    resume : bool
        Resume the run in `out`; if false, its content is deleted.
    progress : callable or bool, optional
        Called as `progress("meshes", done, total)` after each batch.

    Returns
    -------
    dask.dataframe.DataFrame
        Index `row`, the place in `paths`; files that were added to a run come after its others.
        Columns `path`, `vertices`, `faces`, `error` (missing on success), `warnings`, those of the
        task, and those of the table. Values are the same for any number of workers.

    Raises
    ------
    FileNotFoundError
        If a glob matches no file.
    ValueError
        If `out` holds another run: with other columns or another task, with a file that is not in
        `paths`, or with one of another size.
    ImportError
        Without dask: `pip install 'pyfairing[dask]'`.

    Notes
    -----
    A mesh that cannot be read or computed becomes a row with its `error`. Batches of a killed
    worker are repeated; after several failures each mesh of the batch is computed separately,
    finally alone on the cluster, and a mesh that still kills its worker becomes a row with its
    error. A mesh whose estimate exceeds the memory of a worker is not tried.
    """
    try:
        import dask.dataframe
        import fsspec  # noqa: F401
        import pyarrow  # noqa: F401
    except ImportError as error:
        raise ImportError("data sets need dask: pip install 'pyfairing[dask]'") from error
    addresses, extra = _plan.list_paths(paths)
    kinds = dict(columns) if columns is not None else _columns_of(task, addresses)
    taken = sorted(set(kinds) & set(_batch.OWN))
    if taken:
        raise ValueError(f"the task returns {', '.join(taken)}, which every data set has")
    sources = _plan.describe(addresses)
    known: int = getattr(_innermost(task), "bytes_per_vertex", _PER_VERTEX)
    per_vertex = known if bytes_per_vertex is None else bytes_per_vertex
    run = _Run(task, kinds, int(per_vertex), threads)
    if out is None:
        return _with_table(_lazy(run, sources), extra, sources)
    folder = fspath(out)
    sources = _prepare(folder, sources, _plan.fingerprint(kinds, _name_of(task)), resume)
    _, tell = call(None, progress)
    _complete(run, sources, folder, client or _current_client(), tell)
    _drop_contained(folder)
    found = (
        dask.dataframe.read_parquet(
            _glob_of(folder),
            index="row",
            calculate_divisions=True,
            dtype_backend="pyarrow",
            split_row_groups=False,
        )
        if sources
        else _lazy(run, sources)
    )
    return _with_table(found, extra, sources)


class _Run:
    """Settings of the work on each batch."""

    def __init__(self, task: Any, columns: dict[str, str], per_vertex: int, threads: int) -> None:
        self.task, self.columns, self.per_vertex, self.threads = task, columns, per_vertex, threads

    @property
    def arguments(self) -> tuple[Any, dict[str, str], int, int]:
        return self.task, self.columns, self.per_vertex, self.threads


def _innermost(task: Any) -> Any:
    """The function behind a `functools.partial`."""
    while hasattr(task, "func"):
        task = task.func
    return task


def _name_of(task: Any) -> str:
    inner = _innermost(task)
    name = f"{getattr(inner, '__module__', '')}.{getattr(inner, '__qualname__', type(inner).__name__)}"
    arguments = [getattr(task, "args", ()), sorted(getattr(task, "keywords", {}).items())]
    return f"{name} {arguments}"


def _columns_of(task: Any, addresses: list[str]) -> dict[str, str]:
    """The types of the columns, from the task on a sphere of 162 vertices, or on the first file that can
    be read if the task takes its path."""
    from .shapes import icosphere

    if not _batch.takes_path(task):
        try:
            row = dict(task(icosphere(2)))
        except Exception as error:
            raise ValueError(f"the task fails on a small sphere ({error}): pass columns") from error
        return {name: _kind_of(name, value) for name, value in row.items()}
    failure: Exception | None = None
    for source in (_plan.Source(0, path, None, 0) for path in addresses):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FairingWarning)
            try:
                row = _batch.call(task, _batch.load(source), source.path)
            except Exception as error:
                failure = error
                continue
        return {name: _kind_of(name, value) for name, value in row.items()}
    raise ValueError(f"the task fails on every file ({failure}): pass columns")


def _kind_of(name: str, value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "bool"
    if isinstance(value, (int, np.integer)):
        return "int64"
    if isinstance(value, (float, np.floating)):
        return "float64"
    if isinstance(value, str):
        return "string"
    if isinstance(value, (list, tuple, np.ndarray)):
        array = np.asarray(value)
        kinds = [kind for kind, dimensions in _batch.DIMENSIONS.items() if dimensions == array.ndim]
        if array.dtype.kind in "fiub" and kinds:
            return kinds[0]
        raise ValueError(
            f"the task returns {name} as {array.dtype} of {array.ndim} dimensions:"
            " arrays are of numbers, with one or two dimensions"
        )
    raise ValueError(f"the task returns {name} as {type(value).__name__}: pass columns")


def _current_client() -> Any:
    try:
        from distributed import default_client

        return default_client()
    except (ImportError, ValueError):
        return None


def _lazy(run: _Run, sources: list[_plan.Source]) -> Any:
    """A lazy collection."""
    import dask.dataframe

    meta = _batch.to_pandas(_batch.schema(run.columns).empty_table())
    made = _plan.batches(sources)
    if not made:
        return dask.dataframe.from_pandas(meta, npartitions=1)
    divisions = [batch.first for batch in made] + [made[-1].end - 1]
    task, columns, per_vertex, threads = run.arguments
    return dask.dataframe.from_map(
        _batch.frame,
        made,
        meta=meta,
        divisions=divisions,
        task=task,
        # What dask can hash.
        kinds=tuple(columns.items()),
        per_vertex=per_vertex,
        threads=threads,
    )


def _with_table(found: Any, extra: Any, sources: list[_plan.Source]) -> Any:
    """The rows joined with the other columns of the caller's table, in the order of the files."""
    if extra is None or len(extra.columns) == 1:
        return found
    import dask.dataframe

    given: dict[str, list[int]] = {}
    for place, path in enumerate(map(str, extra["path"])):
        given.setdefault(path, []).append(place)
    order = [given[source.path].pop(0) for source in sources]
    others = extra.drop(columns="path").iloc[order].reset_index(drop=True)
    clash = sorted(set(map(str, others.columns)) & set(map(str, found.columns)))
    others = others.rename(columns={name: f"{name}_given" for name in clash})
    others.index.name = "row"
    return found.join(dask.dataframe.from_pandas(others, npartitions=1))


def _prepare(folder: str, sources: list[_plan.Source], fingerprint: str, resume: bool) -> list[_plan.Source]:
    """Prepares the folder of this run, empty or with the parts of an earlier one.

    Returns the files in the order of the rows: those of the earlier run first.
    """
    fs, inner = _plan.filesystem(folder)
    note = f"{inner.rstrip('/')}/_run.parquet"
    if not resume and fs.exists(inner):
        for name in _parts(folder):
            fs.rm(f"{inner.rstrip('/')}/{name}")
        if fs.exists(note):
            fs.rm(note)
    known: list[tuple[str, int | None]] = []
    if fs.exists(note):
        found, known = _batch.read_note(fs, note)
        if found != fingerprint:
            raise ValueError(
                f"{folder} holds another run (other columns or task): take another folder, or resume=False"
            )
        try:
            sources = _plan.ordered(sources, known)
        except ValueError as error:
            raise ValueError(
                f"{folder} holds another run: {error}; take another folder, or resume=False"
            ) from None
    elif _parts(folder):
        raise ValueError(f"{folder} holds parts of a run that is not known: take another folder")
    if len(known) < len(sources) or not fs.exists(note):
        fs.makedirs(inner, exist_ok=True)
        _batch.write_note(fs, note, fingerprint, sources)
    return sources


def _parts(folder: str) -> list[str]:
    """The names of the complete parts, in the order of their rows."""
    fs, inner = _plan.filesystem(folder)
    if not fs.exists(inner):
        return []
    # Others may have written since.
    fs.invalidate_cache(inner)
    names = (p.rsplit("/", 1)[-1] for p in fs.ls(inner, detail=False))
    return sorted(name for name in names if _plan.part_rows(name))


def _glob_of(folder: str) -> str:
    return f"{folder.rstrip('/')}/part-*.parquet"


def _rows_of(names: Iterable[str]) -> list[tuple[int, int]]:
    return [rows for rows in map(_plan.part_rows, names) if rows]


def _drop_contained(folder: str) -> None:
    """Removes parts contained in others: an abandoned worker may have written its batch after all."""
    fs, inner = _plan.filesystem(folder)
    parts = sorted(((rows, name) for name in _parts(folder) if (rows := _plan.part_rows(name))))
    end = 0
    for (first, last), name in sorted(parts, key=lambda p: (p[0][0], -p[0][1])):
        if last <= end:
            fs.rm(f"{inner.rstrip('/')}/{name}")
        elif first < end:
            raise RuntimeError(f"{name} overlaps another part")
        end = max(end, last)


def _complete(run: _Run, sources: list[_plan.Source], folder: str, client: Any, tell: Any) -> None:
    """Computes the batches that are not written yet, the largest first."""
    todo = _plan.batches(_plan.uncovered(sources, _rows_of(_parts(folder))))
    todo.sort(key=lambda batch: -sum(s.vertices for s in batch.sources))
    done = len(sources) - sum(len(batch.sources) for batch in todo)
    if tell and sources:
        tell("meshes", done, len(sources))
    work = _on_cluster if client is not None else _on_threads
    for batch in work(run, todo, folder, client):
        done += len(batch.sources)
        if tell:
            tell("meshes", done, len(sources))


def _on_threads(run: _Run, todo: list[Batch], folder: str, _: Any) -> Iterable[Batch]:
    pool = ThreadPoolExecutor(cpu_count() or 1, thread_name_prefix="pyfairing-dataset")
    try:
        futures = {pool.submit(_batch.run, batch, *run.arguments, folder): batch for batch in todo}
        while futures:
            ready, _pending = wait(futures, return_when=FIRST_COMPLETED)
            for future in ready:
                future.result()
                yield futures.pop(future)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _on_cluster(run: _Run, todo: list[Batch], folder: str, client: Any) -> Iterable[Batch]:
    """The batches on the workers of a cluster.

    A worker that dies takes all its meshes with it, and the scheduler counts a failure for each of them.
    So a mesh is abandoned only after it was alone on the cluster; until then it is a suspect and waits
    for the others.
    """
    from distributed.scheduler import KilledWorker

    shared = run.task
    waiting = list(reversed(todo))
    suspects: list[Batch] = []
    alone = False
    running_: dict[Any, tuple[Any, Batch]] = {}

    def submit(batch: Batch) -> None:
        future = client.submit(
            _batch.run,
            batch,
            shared,
            run.columns,
            run.per_vertex,
            run.threads,
            folder,
            pure=False,
            priority=sum(s.vertices for s in batch.sources) / 1e6,
        )
        running_[future.key] = future, batch

    def fill() -> None:
        threads: int = sum(client.nthreads().values())
        while waiting and len(running_) < max(_AHEAD * threads, _AHEAD):
            submit(waiting.pop())

    fill()
    while running_:
        for future in _finished([future for future, _ in running_.values()], client):
            _, batch = running_.pop(future.key)
            error = future.exception()
            if error is None:
                yield batch
            elif isinstance(error, KilledWorker) and len(batch.sources) > 1:
                waiting += reversed(_plan.halves(batch))
            elif isinstance(error, KilledWorker) and not alone:
                suspects.append(batch)
            elif isinstance(error, KilledWorker):
                text = "KilledWorker: the workers that had this mesh ended, perhaps because memory ran out"
                _batch.write(_batch.failed(batch, text), run.columns, folder, batch.part)
                yield batch
            else:
                raise error
            future.release()
        fill()
        if not running_ and suspects:
            alone = True
            submit(suspects.pop())


def _finished(futures: list[Any], client: Any) -> Iterable[Any]:
    """The finished futures, at least one; warns if there are no workers, which a queue may still start."""
    import distributed

    idle = 0
    while True:
        try:
            ready: Any = distributed.wait(futures, timeout=_PATIENCE, return_when="FIRST_COMPLETED")
            finished: Iterable[Any] = ready.done
            return finished
        except distributed.TimeoutError:
            idle = 0 if client.nthreads() else idle + 1
        if idle == _PATIENT:
            warnings.warn(
                f"the cluster has had no workers for {_PATIENCE * _PATIENT} s; this waits for new ones."
                " What is written is kept: after an interrupt the next call goes on after it",
                RuntimeWarning,
                stacklevel=2,
            )
