"""Docstrings with the tables in the help of the program."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from typing import TypeVar

from . import _core

F = TypeVar("F", bound=Callable[..., object])

_TABLES = _core.tables()

_RUN = """threads : int, optional
    Maximum number of threads; by default `RAYON_NUM_THREADS` or all cores. Results are bitwise
    equal for any number.
progress : callable or bool, optional
    Called as `progress(stage, done, total)` at most about fifty times a second; `total` is None
    if unknown. True shows a tqdm bar. An exception in the callback cancels the work."""


def _list(rows: Iterable[tuple[str, str]]) -> str:
    return "\n".join(f"* `{name}`: {purpose}" for name, purpose in rows)


_PARTS = {
    "{run}": _RUN,
    "{estimators}": _list(_TABLES["estimators"]),
    "{methods}": _list(_TABLES["methods"]),
    "{denoisers}": _list(_TABLES["denoisers"]),
    "{laplacians}": ", ".join(f"`{name}`" for name in _TABLES["laplacians"]),
    "{masses}": ", ".join(f"`{name}`" for name in _TABLES["masses"]),
    "{maps}": ", ".join(f"`{name}`" for name in _TABLES["color_maps"]),
}

ESTIMATORS: tuple[str, ...] = tuple(name for name, _ in _TABLES["estimators"])
METHODS: tuple[str, ...] = tuple(name for name, _ in _TABLES["methods"])
DENOISERS: tuple[str, ...] = tuple(name for name, _ in _TABLES["denoisers"])
LAPLACIANS: tuple[str, ...] = tuple(_TABLES["laplacians"])
MASSES: tuple[str, ...] = tuple(_TABLES["masses"])
COLOR_MAPS: tuple[str, ...] = tuple(_TABLES["color_maps"])


def documented(function: F) -> F:
    """Replaces the names of tables by the tables, with their indentation."""
    text = inspect.cleandoc(function.__doc__ or "")
    lines = []
    for line in text.split("\n"):
        name = line.strip()
        if name in _PARTS:
            indent = line[: len(line) - len(line.lstrip())]
            lines += [indent + part if part else "" for part in _PARTS[name].split("\n")]
        else:
            for key, part in _PARTS.items():
                line = line.replace(key, part) if "\n" not in part else line
            lines.append(line)
    function.__doc__ = "\n".join(lines)
    return function
