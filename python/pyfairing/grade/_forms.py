"""Fundamental forms of surfaces given by formulas, and answers for them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from .._arrays import Floats
from .._core import OptionError
from ..surfaces import Surface
from ._engine import Answer
from ._facts import Facts
from ._pointwise import slip, usual

NAMES = ("E", "F", "G", "L", "M", "N")


def points() -> tuple[Floats, Floats]:
    """Parameters away from the poles, in no symmetric position."""
    u, v = np.meshgrid(0.3 + 0.77 * np.arange(8), 0.35 + 0.49 * np.arange(6))
    return u.reshape(-1), v.reshape(-1)


def forms(
    facts: Facts | None,
    surface: Surface,
    u: Floats,
    v: Floats,
    *,
    sign: float = 1.0,
    chart: str = "own",
    normal: str = "unit",
    middle: float = 1.0,
    swap: str = "",
    at: str = "own",
) -> Answer:
    """E, F, G, L, M, N with the inward normal, and variants; (p, 6)."""
    if chart == "degrees":
        u, v = np.deg2rad(u), np.deg2rad(v)
    elif chart == "swapped":
        u, v = v, u
    first, second = surface.first_form(u, v), surface.second_form(u, v)
    if at == "pole":
        second = surface.second_form(u, np.full_like(v, 1e-6)) * [0.0, 0.0, 1.0]
    root = np.sqrt(np.maximum(first[:, 0] * first[:, 2] - first[:, 1] ** 2, 0))[:, None]
    powers = {"unit": 0, "cross product": 1, "squared": -1}
    second = sign * second * root ** powers[normal]
    first, second = first * [1, middle, 1], second * [1, middle, 1]
    if swap in ("first", "both"):
        first = first[:, ::-1]
    if swap in ("second", "both"):
        second = second[:, ::-1]
    if swap == "roots":
        first = np.sqrt(np.abs(first)) * np.sign(first)
    values = np.hstack([first, second])
    return values, np.abs(values).max(axis=1)


FORMS = (
    usual("outward normal: L, M, N negative", "the sign of pᵤ × pᵥ: it points inward here",
          sign=-1.0),
    usual("u and v in the other order", "E and G, L and N are exchanged", swap="both"),
    slip("E and G exchanged", "the first form", swap="first"),
    slip("L and N exchanged", "the second form", swap="second"),
    slip("u and v exchanged in the formula", "sin u and sin v", chart="swapped"),
    slip("degrees", "the parameters", chart="degrees"),
    slip("normal not normalised", "pᵤ × pᵥ in place of pᵤ × pᵥ / ‖pᵤ × pᵥ‖",
         normal="cross product"),
    slip("normal divided by the squared norm", "EG - F² in place of its root", normal="squared"),
    usual("2F and 2M", "the coefficient of du dv", middle=2.0),
    slip("half of F and M", "the coefficient of du dv", middle=0.5),
    slip("roots of E, F, G", "‖pᵤ‖ in place of pᵤ · pᵤ", swap="roots"),
    slip("second form of the pole", "L = M = 0 at (0, 0, c), where the chart is singular",
         at="pole"),
)  # fmt: skip


def values_of(answer: Any, u: Floats, v: Floats) -> Floats:
    """E, F, G, L, M, N of a function or an array, (p, 6)."""
    if not callable(answer):
        return six(answer, len(u))
    function: Callable[..., Any] = answer
    try:
        found = six(function(u, v), len(u))
    except (TypeError, ValueError, IndexError, OptionError):
        # Functions of single numbers.
        found = np.vstack([six(function(float(a), float(b)), 1) for a, b in zip(u, v)])
    return found


def six(answer: Any, count: int) -> Floats:
    """An array of (count, 6) from six arrays, two triples, or two matrices."""
    parts: list[npt.NDArray[Any]] = []
    if isinstance(answer, dict):
        answer = [answer[name] for name in NAMES]
    items = list(answer) if isinstance(answer, (tuple, list)) else answer
    if isinstance(items, list) and len(items) == 2:
        for form in items:
            form = np.asarray(form, dtype=float)
            if form.shape[-2:] == (2, 2):
                form = np.stack([form[..., 0, 0], form[..., 0, 1], form[..., 1, 1]], axis=-1)
            elif form.shape[0] == 3 and form.shape[-1] != 3:
                form = form.T
            parts.append(form.reshape(-1, 3))
        joined = np.hstack(parts)
    elif isinstance(items, list) and len(items) == 6:
        joined = np.column_stack(
            [np.broadcast_to(np.asarray(x, dtype=float).reshape(-1), count) for x in items]
        )
    else:
        joined = np.asarray(items, dtype=float)
        joined = joined.T if joined.shape == (6, count) and count != 6 else joined
        joined = joined.reshape(-1, 6) if joined.size == 6 * count else joined
    if joined.shape != (count, 6):
        raise OptionError(
            f"the forms have the shape {joined.shape}; "
            f"E, F, G, L, M, N at {count} points are ({count}, 6)"
        )
    return joined
