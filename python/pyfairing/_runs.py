"""Runs of a data set: its files, its folder, and the work that is left."""

from __future__ import annotations

import json
import re
from collections.abc import Generator, Iterable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, as_completed
from dataclasses import replace
from os import PathLike, cpu_count, fspath
from typing import Any

import dask.dataframe
import distributed
import fsspec
from distributed.scheduler import KilledWorker

from ._batch import Batch, Source, Work, complete, part_name, to_pandas

#: A batch ends at this number of meshes, or of bytes.
BATCH_MESHES = 64
BATCH_BYTES = 16 << 20


def listed(paths: Any) -> tuple[list[Source], Any]:
    """The files in order, and the table that they came in, if any."""
    table = None
    if isinstance(paths, (str, PathLike)):
        addresses = _matching(fspath(paths))
    elif hasattr(paths, "columns"):
        table = (paths.compute() if hasattr(paths, "compute") else paths).reset_index(drop=True)
        if "path" not in table.columns:
            raise ValueError(f"the table has no column path, only {', '.join(map(str, table.columns))}")
        addresses = [str(p) for p in table["path"]]
    elif isinstance(paths, Iterable):
        addresses = [fspath(p) for p in paths]
    else:
        raise TypeError(f"paths must be addresses, a glob or a table, not {type(paths).__name__}")
    return [Source(row, row, path, _size(path)) for row, path in enumerate(addresses)], table


def _matching(address: str) -> list[str]:
    fs, inner = fsspec.core.url_to_fs(address)
    if not re.search(r"[*?[]", address) or fs.exists(inner):
        return [address]
    found = sorted(fs.glob(inner))
    if not found:
        raise FileNotFoundError(f"no file matches {address}")
    return [fs.unstrip_protocol(path) for path in found] if "://" in address else found


def _size(path: str) -> int | None:
    try:
        fs, inner = fsspec.core.url_to_fs(path)
        return int(fs.info(inner)["size"])
    except (OSError, ValueError, KeyError, TypeError):
        # The row of the file holds the error of reading it.
        return None


def batches(sources: Iterable[Source]) -> list[Batch]:
    """Groups consecutive small files."""
    groups: list[list[Source]] = []
    room = 0
    for source in sources:
        last = groups[-1] if groups else []
        size = source.size or 0
        if not last or source.row != last[-1].row + 1 or len(last) == BATCH_MESHES or size > room:
            groups.append([])
            room = BATCH_BYTES
        groups[-1].append(source)
        room -= size
    return list(groups)


def lazy(work: Work, sources: Sequence[Source]) -> Any:
    """The collection that computes a batch in each partition."""
    meta = to_pandas(work.schema().empty_table())
    made = batches(sources)
    if not made:
        return dask.dataframe.from_pandas(meta, npartitions=1)
    divisions = [batch[0].row for batch in made] + [len(sources) - 1]
    return dask.dataframe.from_map(work.frame, made, meta=meta, divisions=divisions)


def written(folder: str) -> Any:
    """The collection of the parts in a folder."""
    # Removes parts within others.
    _parts(*fsspec.core.url_to_fs(folder))
    return dask.dataframe.read_parquet(
        f"{folder.rstrip('/')}/part-*.parquet",
        index="row",
        calculate_divisions=True,
        dtype_backend="pyarrow",
        split_row_groups=False,
    )


def joined(found: Any, table: Any, sources: Sequence[Source]) -> Any:
    """The rows with the other columns of the caller's table."""
    others = table.drop(columns="path").iloc[[source.place for source in sources]].reset_index(drop=True)
    clash = set(map(str, others.columns)) & set(map(str, found.columns))
    others = others.rename(columns={name: f"{name}_given" for name in clash})
    others.index.name = "row"
    return found.join(dask.dataframe.from_pandas(others, npartitions=1))


def resumed(
    folder: str, sources: Sequence[Source], run: str, resume: bool
) -> tuple[list[Source], list[Source]]:
    """Prepares the folder of a run, empty or with the parts of an earlier one.

    Returns the files by row, the files of the earlier run first, and those that are not written yet.
    """
    fs, root = fsspec.core.url_to_fs(folder)
    fs.makedirs(root, exist_ok=True)
    note = f"{root}/_run.json"
    if not resume:
        for stale in [part_name(root, *rows) for rows in _parts(fs, root)] + [note]:
            if fs.exists(stale):
                fs.rm(stale)
    written_rows = {row for first, end in _parts(fs, root) for row in range(first, end)}
    other = f"{folder} holds another run (take another folder, or resume=False)"
    known: list[tuple[str, int | None]] = []
    if fs.exists(note):
        with fs.open(note, "rb") as file:
            earlier, known = json.load(file)
        if earlier != run:
            raise ValueError(f"{other}: its columns or its task are not these")
    elif written_rows:
        raise ValueError(f"{other}: it has parts, but no list of files")
    left: dict[str, list[Source]] = {}
    for source in sources:
        left.setdefault(source.path, []).append(source)
    files = []
    for path, size in known:
        same = left.get(path)
        if not same:
            raise ValueError(f"{other}: it has a row for {path}, which is not among the files")
        if same[0].size != size:
            raise ValueError(f"{other}: {path} has {same[0].size} bytes, and had {size}")
        files.append(same.pop(0))
    taken = {source.place for source in files}
    files += [source for source in sources if source.place not in taken]
    files = [replace(source, row=row) for row, source in enumerate(files)]
    if len(files) > len(known):
        with complete(fs, note) as file:
            file.write(json.dumps([run, [(source.path, source.size) for source in files]]).encode())
    return files, [source for source in files if source.row not in written_rows]


def _parts(fs: Any, root: str) -> list[tuple[int, int]]:
    """The rows of the parts. Removes parts within others: a worker believed lost may write its batch late."""
    fs.invalidate_cache(root)
    names = fs.ls(root, detail=False) if fs.exists(root) else []
    found = [re.search(r"/part-(\d{9})-(\d{9})\.parquet$", name) for name in names]
    rows = [(int(match[1]), int(match[2])) for match in found if match]
    kept: list[tuple[int, int]] = []
    for first, end in sorted(rows, key=lambda part: (part[0], -part[1])):
        covered = kept[-1][1] if kept else 0
        if end <= covered:
            fs.rm(part_name(root, first, end))
        elif first < covered:
            raise RuntimeError(f"{part_name(root, first, end)} overlaps another part")
        else:
            kept.append((first, end))
    return kept


def saved(work: Work, todo: Sequence[Source], folder: str, client: Any) -> Generator[int, None, None]:
    """Computes and writes batches, the largest first; yields their numbers of meshes.

    A worker that dies fails all its batches. Their meshes are tried again one by one, and those that fail
    again alone on the cluster: a mesh that ends its worker there becomes a row with an error.
    """
    largest_first = sorted(batches(todo), key=lambda batch: -sum(source.size or 0 for source in batch))
    with _executor(client) as executor:
        killed = yield from _attempted(executor, work, largest_first, folder)
        singles = [[source] for batch in killed for source in batch]
        for suspect in (yield from _attempted(executor, work, singles, folder)):
            if (yield from _attempted(executor, work, [suspect], folder)):
                text = "KilledWorker: the workers that had this mesh ended, perhaps because memory ran out"
                row = {"row": suspect[0].row, "path": suspect[0].path, "error": text, "warnings": []}
                work.write(suspect, [row], folder)
                yield 1


def _executor(client: Any) -> Any:
    """The cluster of a client, or of the current client, or threads of this process."""
    if client is None:
        try:
            client = distributed.default_client()
        except ValueError:
            return ThreadPoolExecutor(cpu_count() or 1, thread_name_prefix="pyfairing-dataset")
    return client.get_executor(pure=False)


def _attempted(
    executor: Executor, work: Work, todo: Sequence[Batch], folder: str
) -> Generator[int, None, list[Batch]]:
    """Computes and writes batches; yields their numbers of meshes, returns those whose workers died."""
    futures = {executor.submit(work.save, batch, folder): batch for batch in todo}
    killed = []
    try:
        for future in as_completed(futures):
            try:
                future.result()
            except KilledWorker:
                killed.append(futures[future])
            else:
                yield len(futures[future])
    finally:
        for future in futures:
            future.cancel()
    return killed
