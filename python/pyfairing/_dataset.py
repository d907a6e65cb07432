"""Computations on many meshes and many machines."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

from ._calls import Progress, call

if TYPE_CHECKING:
    from .tasks import Task


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
        Memory that the task needs; by default `task.bytes_per_vertex` or 2000. Meshes that would
        need more than a thread's part of the memory of their worker wait for each other.
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
        Without dask: `pip install './python[dask]'` in a clone of the repository.

    Notes
    -----
    A mesh that cannot be read or computed becomes a row with its `error`. Batches of a killed
    worker are repeated; after several failures each mesh of the batch is computed separately,
    finally alone on the cluster, and a mesh that still kills its worker becomes a row with its
    error. A mesh that would need more than the memory of a worker is read but not computed.
    """
    try:
        from . import _batch, _runs
    except ImportError as error:
        raise ImportError("data sets need dask: pip install './python[dask]' in a clone") from error
    sources, table = _runs.listed(paths)
    kinds = dict(columns) if columns is not None else _batch.columns_of(task, sources)
    taken = sorted(set(kinds) & set(_batch.OWN))
    if taken:
        raise ValueError(f"the task returns {', '.join(taken)}, which every data set has")
    if bytes_per_vertex is None:
        bytes_per_vertex = getattr(_batch.innermost(task), "bytes_per_vertex", _batch.PER_VERTEX)
    work = _batch.Work(task, kinds, bytes_per_vertex, threads)
    if out is not None:
        sources, todo = _runs.resumed(fspath(out), sources, work.name(), resume)
        _, tell = call(None, progress)
        done = len(sources) - len(todo)
        for count in itertools.chain([0], _runs.saved(work, todo, fspath(out), client)):
            done += count
            if tell and sources:
                tell("meshes", done, len(sources))
    found = _runs.lazy(work, sources) if out is None or not sources else _runs.written(fspath(out))
    alone = table is None or len(table.columns) == 1
    return found if alone else _runs.joined(found, table, sources)
