"""Docstrings with the tables that the help of the program shows."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from typing import TypeVar

from . import _core

F = TypeVar("F", bound=Callable[..., object])

_TABLES = _core.tables()

_RUN = """threads : int, optional
    At most so many threads; all that there are unless given, or `RAYON_NUM_THREADS`.
    Results are the same, bit by bit, for any number.
progress : callable or bool, optional
    Called as `progress(stage, done, total)` about fifty times a second at most, `total` is
    None where nobody knows; True shows a bar of tqdm. What it raises ends the work."""


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
    """Puts the tables in the place of their names, with the indentation that they have there."""
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
