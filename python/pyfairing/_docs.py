"""Docstrings with the tables in the help of the program."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from typing import TypeVar, get_args

from . import _core
from ._names import ColorMap, Denoiser, Estimator, Kind, MassKind, Method
from ._parameters import DENOISER, ESTIMATOR, METHOD

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
    "{estimators}": _list(ESTIMATOR.descriptions.items()),
    "{methods}": _list(METHOD.descriptions.items()),
    "{denoisers}": _list(DENOISER.descriptions.items()),
    "{parameters_of_estimators}": ESTIMATOR.documentation(),
    "{parameters_of_methods}": METHOD.documentation(),
    "{parameters_of_denoisers}": DENOISER.documentation(),
    "{laplacians}": ", ".join(f"`{name}`" for name in _TABLES["laplacians"]),
    "{masses}": ", ".join(f"`{name}`" for name in _TABLES["masses"]),
    "{maps}": ", ".join(f"`{name}`" for name in _TABLES["color_maps"]),
}

ESTIMATORS: tuple[Estimator, ...] = get_args(Estimator)
METHODS: tuple[Method, ...] = get_args(Method)
DENOISERS: tuple[Denoiser, ...] = get_args(Denoiser)
LAPLACIANS: tuple[Kind, ...] = get_args(Kind)
MASSES: tuple[MassKind, ...] = get_args(MassKind)
COLOR_MAPS: tuple[ColorMap, ...] = get_args(ColorMap)


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
