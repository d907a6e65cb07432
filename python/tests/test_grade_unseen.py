"""Deviations written after the judge, which was not changed for them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from pyfairing import grade
from test_grade_list import JUDGES, LAM, K, projected, unit
from test_grade_students import (
    Student,
    closed_mesh,
    cross,
    explicit,
    implicit,
    open_mesh,
    rows,
)


def swapped_mixed(s: Student) -> Any:
    """Mixed areas with a quarter at the obtuse corner, a half at the others."""
    m = s.circumcentric(obtuse=True)
    for t in s.f:
        for k in range(3):
            if s.angle(t[k], t[k - 2], t[k - 1]) > math.pi / 2:
                m[t[k]] -= s.triangle(*t) / 4
                m[[t[k - 1], t[k - 2]]] += s.triangle(*t) / 4
    return m


def inward_first(s: Student) -> Any:
    out = np.zeros((s.n, 3))
    for t in s.f[::-1]:
        out[t] = -unit(cross(s, t)[None])[0]
    return out


def border_nan(s: Student) -> Any:
    return np.where(s.edge, np.nan, 2 * np.abs(s.h()))


Unseen = tuple[str, str, Callable[[Student], Any], str]
UNSEEN: list[Unseen] = [
    ("uniform, doubled, 0 at the border", "mean",
     lambda s: np.where(s.edge, 0, np.linalg.norm(s.uniform() @ s.v, axis=1)), "uniform|2H"),
    ("½ missing, circumcentric, length", "mean",
     lambda s: np.linalg.norm(s.s() @ s.v / s.circumcentric()[:, None], axis=1), "2H|circumcentric"),
    ("NaN at the border, doubled", "mean", border_nan, "2H"),
    ("2π, two thirds, integrated over the third", "gaussian",
     lambda s: s.defect(edge=2 * math.pi) / (2 * s.barycentric()), "two thirds"),
    ("degrees, 360 at the border", "gaussian",
     lambda s: np.rad2deg(s.defect(edge=2 * math.pi)) / s.barycentric(), "degrees"),
    ("negative weights set to 0, negated", "laplacian",
     lambda s: -s.s(of=lambda c: max(c, 0) / 2), "obtuse|cut off|set to 0"),
    ("half and quarter exchanged", "mass", swapped_mixed, "obtuse"),
    ("first face, inward", "normals", inward_first, "first face"),
    ("by angle, not normalised", "normals", lambda s: s.normals("angle"), "not normalised"),
    ("descending unit modes", "modes",
     lambda s: unit(s.spectrum()[1].T).T[:, :K][:, ::-1], "descending"),
    ("k - 1 modes", "reconstruction",
     lambda s: projected(s.spectrum()[1][:, : K - 1], s.v, s.barycentric()), "one mode too few"),
    ("without 0, negated", "eigenvalues", lambda s: -s.spectrum()[0][1 : K + 1], "eigenvalue 0"),
    ("border fixed, one step too few", "implicit",
     lambda s: implicit(s, rows(s.uniform(), s.edge), LAM, 2), "one step too few"),
    ("explicit, λ doubled", "implicit",
     lambda s: explicit(s, s.uniform(), 2 * LAM, 3), "explicit|λ times 2"),
    ("integrated K in the root", "principal",
     lambda s: s.principal(s.h(), s.defect()), "integrated"),
]  # fmt: skip


def judged(s: Student, case: Unseen) -> tuple[bool, grade.Report]:
    _, quantity, answer, names = case
    report = JUDGES[quantity][1](s.mesh, answer(s))
    text = report.verdict + "; ".join(report.names)
    return all(name in text for name in names.split("|")), report


@pytest.mark.parametrize("mesh", [open_mesh, closed_mesh])
def test_unseen_deviations(mesh: Callable[[], Any]) -> None:
    """Most are named; no explanation is a wrong one."""
    s = Student(mesh())
    found = {}
    for case in UNSEEN:
        with np.errstate(invalid="ignore"):
            named, report = judged(s, case)
        found[case[0]] = (named, report.verdict)
    missed = {name: verdict for name, (named, verdict) in found.items() if not named}
    assert len(missed) <= 3, missed
