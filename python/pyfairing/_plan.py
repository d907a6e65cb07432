"""The meshes of a data set, their sizes and their batches."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from os import PathLike, fspath
from typing import Any

#: Number of bytes read from the start of a file to find its counts.
_HEAD = 1 << 14
#: Bytes of text for each vertex, faces included: about the least that is usual.
_TEXT = 60
#: Bytes of binary files for each vertex, faces included.
_BINARY = 38
#: Assumed compression ratio of gzip files.
_RATIO = 4
#: A batch ends with the mesh that brings it to this number of vertices or of meshes.
BATCH_VERTICES = 400_000
BATCH_MESHES = 64


@dataclass(frozen=True)
class Source:
    """A mesh of the data set."""

    row: int
    path: str
    #: Of the file; None where it is not there.
    size: int | None
    #: An estimate of the number of vertices.
    vertices: int


@dataclass(frozen=True)
class Batch:
    """Consecutive meshes computed by one task."""

    sources: tuple[Source, ...]

    @property
    def first(self) -> int:
        return self.sources[0].row

    @property
    def end(self) -> int:
        return self.sources[-1].row + 1

    @property
    def part(self) -> str:
        """The file name of a part, which encodes its rows."""
        return f"part-{self.first:09d}-{self.end:09d}.parquet"


def part_rows(name: str) -> tuple[int, int] | None:
    """The rows of a part, from its name."""
    match = re.fullmatch(r"part-(\d{9})-(\d{9})\.parquet", name)
    return (int(match[1]), int(match[2])) if match else None


def filesystem(path: str) -> tuple[Any, str]:
    """The file system of an address, and the path in it."""
    import fsspec

    fs, inner = fsspec.core.url_to_fs(path)
    return fs, inner


def list_paths(paths: Any) -> tuple[list[str], Any]:
    """The addresses in order, and the table that they came in, if any."""
    if isinstance(paths, (str, PathLike)):
        address = fspath(paths)
        if any(c in address for c in "*?["):
            fs, inner = filesystem(address)
            protocol = address.split("://")[0] + "://" if "://" in address else ""
            found = [protocol + p for p in sorted(fs.glob(inner))]
            if not found and not fs.exists(inner):
                raise FileNotFoundError(f"no file matches {address}")
            return found or [address], None
        return [address], None
    if hasattr(paths, "columns"):
        table = paths.compute() if hasattr(paths, "compute") else paths
        if "path" not in table.columns:
            raise ValueError(f"the table has no column path, only {', '.join(map(str, table.columns))}")
        return [str(p) for p in table["path"]], table.reset_index(drop=True)
    if isinstance(paths, Iterable):
        return [fspath(p) for p in paths], None
    raise TypeError(f"paths must be addresses, a glob or a table, not {type(paths).__name__}")


def estimate(name: str, size: int, head: bytes) -> int:
    """The number of vertices, from the header of a file or from its size."""
    lower = name.lower()
    if lower.endswith(".gz") or head[:2] == b"\x1f\x8b":
        return size * _RATIO // _BINARY
    if head[:3] == b"ply":
        found = re.search(rb"element\s+vertex\s+(\d+)", head)
        if found:
            # No count is trusted beyond what the bytes could hold.
            return min(int(found[1]), size // 3 + 1)
    if lower.endswith(".off"):
        found = re.search(rb"OFF\s+(?:#[^\n]*\n\s*)*(\d+)\s+\d+", head)
        if found:
            return min(int(found[1]), size // 6 + 1)
    if lower.endswith(".stl") and not head[:5] == b"solid":
        return size // 50 // 2 + 1
    return size // (_TEXT if lower.endswith((".obj", ".off", ".stl")) else _BINARY) + 1


def describe(addresses: Sequence[str]) -> list[Source]:
    """Size and vertices of each file; headers of small remote files are not read."""
    sources = []
    systems: dict[str, Any] = {}
    for row, path in enumerate(addresses):
        protocol = path.split("://")[0] if "://" in path else ""
        if protocol not in systems:
            systems[protocol] = filesystem(path)[0]
        fs = systems[protocol]
        try:
            inner = fs._strip_protocol(path)
            size = int(fs.info(inner)["size"])
            if protocol and size < 8 << 20:
                head = b""
            else:
                with fs.open(inner, "rb") as file:
                    head = file.read(_HEAD)
            sources.append(Source(row, path, size, estimate(path, size, head)))
        except (OSError, ValueError, KeyError, TypeError):
            # Reading it says what is wrong.
            sources.append(Source(row, path, None, 0))
    return sources


def batches(sources: Iterable[Source]) -> list[Batch]:
    """Groups consecutive small meshes."""
    made: list[Batch] = []
    now: list[Source] = []
    total = 0
    for source in sources:
        gap = bool(now) and source.row != now[-1].row + 1
        large = bool(now) and total + source.vertices > BATCH_VERTICES
        if gap or large or len(now) == BATCH_MESHES:
            made.append(Batch(tuple(now)))
            now, total = [], 0
        now.append(source)
        total += source.vertices
    if now:
        made.append(Batch(tuple(now)))
    return made


def halves(batch: Batch) -> list[Batch]:
    """Splits a batch into single meshes."""
    return [Batch((source,)) for source in batch.sources]


def uncovered(sources: Sequence[Source], parts: Iterable[tuple[int, int]]) -> list[Source]:
    """The meshes whose rows are in no part."""
    done = bytearray(len(sources))
    for first, end in parts:
        done[first:end] = b"\x01" * max(0, min(end, len(sources)) - first)
    return [source for source in sources if not done[source.row]]


def ordered(sources: Sequence[Source], known: Iterable[tuple[str, int | None]]) -> list[Source]:
    """The files of an earlier run in its order, then the others, with their rows.

    Raises ValueError if one of the run is missing or has another size.
    """
    left: dict[str, list[Source]] = {}
    for source in sources:
        left.setdefault(source.path, []).append(source)
    found = []
    for path, size in known:
        same = left.get(path)
        if not same:
            raise ValueError(f"it has a row for {path}, which is not among the files")
        if same[0].size != size:
            raise ValueError(f"{path} has {same[0].size} bytes, and had {size}")
        found.append(same.pop(0))
    taken = {source.row for source in found}
    found += [source for source in sources if source.row not in taken]
    return [replace(source, row=row) for row, source in enumerate(found)]


def fingerprint(columns: Any, task: str) -> str:
    """Fingerprint of a run: it changes with the columns and with the task."""
    text = json.dumps([columns, task], sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
