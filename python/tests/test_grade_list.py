"""Submissions written as students write them, and the name that the judge gives to each.

Answers come from the loops of test_grade_students.py, not from the formulas of the judge.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pyfairing as pf
import pytest
from pyfairing import grade
from test_grade_students import (
    Student,
    closed_mesh,
    cross,
    explicit,
    implicit,
    in_place,
    laplace,
    last,
    nan_where,
    open_mesh,
    rows,
)

Case = tuple[str, Callable[[Student], Any], str, str]

LAPLACIAN: list[Case] = [
    ("negative", lambda s: -s.s(), "convention", "other sign"),
    ("shift of 1e-8", lambda s: s.s() + 1e-8 * np.eye(s.n), "right", ""),
    ("negative and shift", lambda s: -s.s() + 1e-8 * np.eye(s.n), "convention", "other sign"),
    ("½ missing", lambda s: 2 * s.s(), "mistake", "½ missing"),
    ("½ twice", lambda s: s.s() / 2, "mistake", "½ twice"),
    ("outer half-edge", lambda s: laplace(s.weights() + s.outer()),
     "mistake|border", "outer half-edge"),
    ("second neighbour out of range", lambda s: rows(s.s(), s.edge, 1.234),
     "border", "at the border"),
    ("ring closed", lambda s: laplace(s.weights() + s.ring()),
     "mistake|border", "ring of neighbours closed"),
    ("border rows 0", lambda s: rows(s.s(), s.edge), "convention|border", "border rows 0"),
    ("border rows of the identity", lambda s: rows(s.s(), s.edge) + np.diag(s.edge * 1.0),
     "mistake|border", "identity"),
    ("negative, border rows of the identity", lambda s: rows(-s.s(), s.edge) + np.diag(s.edge * 1.0),
     "mistake|border",
     "identity"),
    ("absolute cotangents", lambda s: s.s(of=lambda c: abs(c) / 2),
     "mistake|obtuse", "absolute cotangents"),
    ("inverse mass on the right", lambda s: s.s() / s.barycentric()[None], "mistake", "transposed"),
    ("-inverse mass on the right", lambda s: -s.s() / s.barycentric()[None],
     "mistake", "transposed"),
    ("divided by the sum", lambda s: -s.s() / s.s().diagonal()[:, None],
     "convention", "divided by the diagonal"),
    ("M⁻¹S", lambda s: s.s() / s.barycentric()[:, None], "convention", "rows divided by the area"),
    ("-M⁻¹S", lambda s: -s.s() / s.barycentric()[:, None],
     "convention", "rows divided by the area"),
    ("-M⁻¹S, ½ missing, circumcentric", lambda s: -2 * s.s() / s.circumcentric()[:, None],
     "mistake", "½ missing"),
    ("symmetric form", lambda s: s.s() / np.sqrt(np.outer(s.barycentric(), s.barycentric())),
     "convention", "symmetric"),
    ("symmetric form multiplied",
     lambda s: laplace(s.weights() * np.sqrt(np.outer(s.barycentric(), s.barycentric()))),
     "mistake", "multiplied by"),
    ("right", lambda s: s.s(), "right", ""),
    ("uniform for cotangents", lambda s: s.uniform(), "convention", "uniform"),
]  # fmt: skip
PAIRS: list[Case] = [
    ("compensated", lambda s: (-2 * s.s(), 2 * s.barycentric()), "convention", "both times 2"),
    ("½ missing, not compensated", lambda s: (2 * s.s(), s.barycentric()), "mistake", "½ missing"),
    ("other sign, whole faces", lambda s: (-s.s(), 3 * s.barycentric()), "mistake",
     "(in M); L is right by another convention: the other sign"),
    ("negative mass", lambda s: (s.s(), -s.barycentric()), "mistake", "times -1"),
    ("right", lambda s: (s.s(), np.diag(s.barycentric())), "right", ""),
    (
        "consistent",
        lambda s: (s.s(), s.mesh.laplacian("uniform", "consistent").mass),
        "right|convention",
        "",
    ),
    ("mixed", lambda s: (-s.s(), s.mixed()), "convention", "mixed"),
]
UNIFORM: list[Case] = [
    ("right", lambda s: s.uniform(), "right", ""),
    ("I - D⁻¹W", lambda s: -s.uniform(), "convention", "other sign"),
    ("D - W", lambda s: laplace((s.uniform() > 0) * 1.0), "convention", "degree"),
    ("W - D", lambda s: -laplace((s.uniform() > 0) * 1.0), "convention", "degree"),
    ("pushed by faces", lambda s: by_faces(s), "mistake|border", "once for each face"),
    ("1 on the diagonal of border rows", lambda s: s.uniform() + 1.0 * np.diag(s.edge),
     "mistake|border",
     "diagonal of border rows"),
    ("border rows of the identity", lambda s: rows(s.uniform(), s.edge) + np.diag(s.edge * 1.0),
     "mistake|border",
     "identity"),
]  # fmt: skip


def by_faces(s: Student) -> Any:
    w = np.zeros((s.n, s.n))
    for i, j in s.directed:
        w[i, j] += 1
        w[j, i] += 1
    return w / w.sum(axis=1)[:, None] - np.eye(s.n)


def squares(s: Student) -> Any:
    m = np.zeros(s.n)
    for t in s.f:
        m[t] += (cross(s, t) / 2).sum() / 3
    return m


def indices(s: Student) -> Any:
    m = np.zeros(s.n)
    for t in s.f:
        m[t] += t.sum() / 3
    return m


def outer_area(s: Student) -> Any:
    m = s.barycentric()
    for own, after in s.follow.items():
        m[own] += s.triangle(s.before[own], own, after) / 3
    return m


MASS: list[Case] = [
    ("barycentric", lambda s: s.barycentric(), "right", ""),
    ("mixed", lambda s: s.mixed(), "convention", "mixed"),
    ("circumcentric", lambda s: s.circumcentric(), "convention", "circumcentric"),
    ("two thirds", lambda s: 2 * s.barycentric(), "convention", "two thirds"),
    ("one sixth", lambda s: s.barycentric() / 2, "mistake", "one sixth"),
    ("consistent", lambda s: s.mesh.laplacian("uniform", "consistent").mass, "right", ""),
    ("last face", lambda s: last(s, lambda t: s.triangle(*t) / 3, ()), "mistake", "last face"),
    ("visited in another order", lambda s: last_shuffled(s), "mistake", "one incident face"),
    ("components summed", squares, "mistake", "components of the cross product"),
    ("indices summed", indices, "mistake", "whole numbers"),
    ("across the border", outer_area, "mistake|border", "outside of the border"),
    ("memory not set to 0", lambda s: s.barycentric() + np.where(np.arange(s.n) == 7, 1e30, 0.0),
     "mistake",
     "never set"),
]  # fmt: skip


def last_shuffled(s: Student) -> Any:
    out = np.zeros(s.n)
    for t in np.random.default_rng(3).permutation(s.f):
        out[t] = s.triangle(*t) / 3
    return out


def one_component(s: Student) -> Any:
    vector, normal = s.vector(), s.normals()
    return np.linalg.norm(vector, axis=1) * np.where(vector[:, 0] * normal[:, 0] > 0, 1, -1)


MEAN: list[Case] = [
    ("part along the normal", lambda s: (s.vector() * unit(s.normals())).sum(axis=1), "right", ""),
    ("length with sign", lambda s: s.h(), "right", ""),
    ("length", lambda s: abs(s.h()), "convention", "length of the vector, without sign"),
    ("length with sign, in another order", lambda s: np.roll(s.h(), 7), "mistake", "another order"),
    ("half precision", lambda s: s.h().astype(np.float16), "convention", "rounded to half precision"),
    ("three digits", lambda s: [float(f"{h:.2e}") for h in s.h()], "convention", "rounded to 3 digits"),
    ("length, barycentric", lambda s: abs(s.h(m=s.barycentric())), "convention", "without sign"),
    ("sign by the mean of neighbours", lambda s: np.linalg.norm(s.vector(), axis=1) * np.where(
        (s.normals() * (s.uniform() @ s.v)).sum(axis=1) > 0, -1, 1), "right", ""),
    ("-2H", lambda s: -2 * s.h(), "mistake", "2H instead of H"),
    ("2H without sign", lambda s: 2 * abs(s.h()), "mistake", "2H instead of H"),
    ("vector 2Hn", lambda s: 2 * s.vector(), "convention", "2Hn"),
    ("sign of one component", one_component, "mistake", "one component"),
    ("sign of any component", lambda s: np.linalg.norm(s.vector(), axis=1) * np.where(
        (s.vector() * s.normals() > 0).any(axis=1), 1, -1), "mistake", "as soon as one component"),
    ("s/|s| at border", lambda s: nan_where(s.h(), s.edge), "mistake", "NaN at the border"),
    ("integrated and doubled", lambda s: np.linalg.norm(s.s() @ s.v, axis=1),
     "mistake", "integrated"),
    ("transposed", lambda s: np.linalg.norm(s.s() @ (s.v / s.barycentric()[:, None]), axis=1) / 2,
     "mistake",
     "transposed"),
    ("uniform", lambda s: np.linalg.norm(s.uniform() @ s.v, axis=1) / 2, "convention", "uniform"),
    ("uniform, negated", lambda s: -np.linalg.norm(s.uniform() @ s.v, axis=1) / 2,
     "convention", "uniform"),
    ("½Δx · n", lambda s: -(s.vector() * unit(s.normals())).sum(axis=1),
     "convention", "other sign"),
    ("0 at the border", lambda s: np.where(s.edge, 0, s.h()), "convention", "0 at the border"),
    ("0 at the border, length", lambda s: np.where(s.edge, 0, abs(s.h())),
     "convention", "0 at the border"),
    ("½Σθl", lambda s: s.dihedral() / 2, "convention", "dihedral"),
    ("Σθl", lambda s: s.dihedral(), "mistake", "dihedral"),
    ("½Σθl over the area", lambda s: s.dihedral() / 2 / s.mixed(), "mistake", "dihedral"),
    ("all triangles below an absolute area", lambda s: 0 * s.h(), "mistake", "0 everywhere"),
    ("½ missing in the cotangents", lambda s: s.h(2 * s.s()), "mistake", "2H"),
    ("outer half-edge", lambda s: s.h(laplace(s.weights() + s.outer())),
     "mistake|border", "at the border|outer"),
    ("ring closed", lambda s: s.h(laplace(s.weights() + s.ring())),
     "mistake|border", "at the border|ring"),
    ("absolute cotangents", lambda s: s.h(s.s(of=lambda c: abs(c) / 2)),
     "mistake|obtuse", "absolute cotangents"),
    ("circumcentric", lambda s: s.h(m=s.circumcentric()), "convention", "circumcentric"),
]  # fmt: skip


def unit(n: Any) -> Any:
    return n / np.linalg.norm(n, axis=1)[:, None]


def ring_defect(s: Student) -> Any:
    d, m = s.defect(edge=2 * math.pi), s.mixed()
    b = s.barycentric()
    for own, after in s.follow.items():
        d[own] -= s.angle(own, s.before[own], after)
        b[own] += s.triangle(s.before[own], own, after) / 3
    return d / b if m is not None else d


GAUSSIAN: list[Case] = [
    ("right", lambda s: s.defect() / s.mixed(), "right", ""),
    ("2π at the border", lambda s: s.defect(edge=2 * math.pi) / s.mixed(),
     "convention", "2π at the border"),
    ("2π at the border, barycentric", lambda s: s.defect(edge=2 * math.pi) / s.barycentric(),
     "convention", "2π at the"),
    ("2π at the border, integrated", lambda s: s.defect(edge=2 * math.pi),
     "convention", "integrated"),
    ("integrated", lambda s: s.defect(), "convention", "integrated"),
    ("barycentric", lambda s: s.defect() / s.barycentric(), "convention", "barycentric"),
    ("0 at the border", lambda s: np.where(s.edge, 0, s.defect() / s.mixed()),
     "convention", "0 at the border"),
    ("0 at the border, barycentric", lambda s: np.where(s.edge, 0, s.defect() / s.barycentric()),
     "convention",
     "0 at the border"),
    ("π everywhere", lambda s: s.defect(full=math.pi) / s.mixed(), "mistake", "π everywhere"),
    ("nothing inside", lambda s: nan_where(s.defect() / s.mixed(), ~s.edge),
     "mistake", "NaN inside"),
    ("ring closed", ring_defect, "mistake|border", "ring"),
    ("area garbage", lambda s: s.defect() / indices(s), "mistake", "wrong area"),
    ("all NaN", lambda s: nan_where(s.defect(), s.edge | True), "mistake", "NaN everywhere"),
    ("π as 3.1415926", lambda s: s.defect(edge=3.1415926, full=2 * 3.1415926) / s.mixed(),
     "right", ""),
    ("degrees", lambda s: np.rad2deg(s.defect()), "mistake", "degrees"),
    ("two thirds", lambda s: s.defect() / (2 * s.barycentric()), "convention", "two thirds"),
    ("circumcentric, 2π", lambda s: s.defect(edge=2 * math.pi) / s.circumcentric(),
     "convention", "circumcentric"),
]  # fmt: skip
PRINCIPAL: list[Case] = [
    ("right", lambda s: s.principal(s.h(), s.defect() / s.mixed()), "right", ""),
    ("doubled dihedral H", lambda s: s.principal(s.dihedral() / 2 / s.mixed(), s.defect() / s.mixed()),
     "mistake",
     "doubled"),
    ("doubled dihedral H, circumcentric",
     lambda s: s.principal(s.dihedral() / 2 / s.circumcentric(),
     s.defect(edge=2 * math.pi) / s.circumcentric()), "mistake", "doubled"),
    ("circumcentric", lambda s: s.principal(s.h(m=s.circumcentric()), s.defect() / s.circumcentric()),
     "convention",
     "circumcentric"),
    ("smallest first", lambda s: s.principal(s.h(), s.defect() / s.mixed())[:, ::-1],
     "convention", "smallest first"),
    ("by absolute value", lambda s: np.array([sorted(k, key=lambda x: -abs(x)) for k in s.principal(
        s.h(), s.defect() / s.mixed())]), "convention", "largest absolute"),
    ("integrated", lambda s: s.principal(s.dihedral() / 2, s.defect()), "mistake", "integrated"),
    ("absolute value under the root",
     lambda s: s.principal(s.h(), s.defect() / s.mixed(), lambda x: np.sqrt(abs(x))),
     "mistake", "absolute value under"),
    ("no clamp", lambda s: s.principal(s.h(), s.defect() / s.mixed(), np.sqrt),
     "mistake", "H² < K"),
]  # fmt: skip
NORMALS: list[Case] = [
    ("by area", lambda s: unit(s.normals()), "right", ""),
    ("by angle", lambda s: unit(s.normals("angle")), "right", ""),
    ("equal", lambda s: unit(s.normals("equal")), "convention", "equal"),
    ("mean of unit normals",
     lambda s: s.normals("equal") / (s.weights(of=lambda c: 1.0).sum(axis=1) / 2)[:, None],
     "mistake", "not normalised"),
    ("last face", lambda s: last(s, lambda t: unit(cross(s, t)[None])[0], (3,)),
     "mistake", "last face"),
    ("no test of incidence", lambda s: np.tile(sum(cross(s, t) for t in s.f), (s.n, 1)), "mistake",
     "over all faces|same value"),
    ("no test of incidence, unit", lambda s: np.tile(unit(sum(cross(s, t) for t in s.f)[None]), (s.n, 1)),
     "mistake",
     "over all faces|same value"),
    ("mean curvature, inward", lambda s: unit(-s.vector()),
     "convention", "mean curvature vector|S x"),
    ("inward", lambda s: -unit(s.normals()), "convention", "inward"),
    ("NaN at the border", lambda s: nan_where(unit(s.normals()), s.edge),
     "mistake", "NaN at the border"),
]  # fmt: skip
K = 12
EIGENVALUES: list[Case] = [
    ("right", lambda s: s.spectrum()[0][:K], "right", ""),
    ("½ missing", lambda s: s.spectrum(2 * s.s())[0][:K], "mistake", "½ missing"),
    ("½ missing, negative", lambda s: -s.spectrum(2 * s.s())[0][:K], "mistake", "½ missing"),
    ("negative", lambda s: -s.spectrum()[0][:K], "convention", "other sign"),
    (
        "graph",
        lambda s: np.linalg.eigvalsh(laplace((s.uniform() > 0) * 1.0))[:K],
        "convention",
        "graph",
    ),
    ("no mass", lambda s: np.linalg.eigvalsh(s.s())[:K], "mistake", "no mass"),
]
MODES: list[Case] = [
    ("right", lambda s: s.spectrum()[1][:, :K] * (-1) ** np.arange(K), "right", ""),
    ("unit length", lambda s: unit(s.spectrum()[1].T).T[:, :K], "right", "unit vectors"),
    ("not mapped back", lambda s: s.spectrum()[1][:, :K] * np.sqrt(s.barycentric())[:, None],
     "mistake", "not mapped back"),
    ("divided by the squared norm", lambda s: (s.spectrum()[1] / (s.spectrum()[1] ** 2).sum(axis=0))[:, :K],
     "mistake",
     "squared norm"),
    ("unsymmetric M⁻¹S", lambda s: unsymmetric(s)[:, :K], "right", "unit vectors"),
    ("graph", lambda s: np.linalg.eigh(laplace((s.uniform() > 0) * 1.0))[1][:, :K],
     "convention", "graph"),
]  # fmt: skip


def unsymmetric(s: Student) -> Any:
    values, u = np.linalg.eig(s.s() / s.barycentric()[:, None])
    return u[:, np.argsort(values.real)].real


def projected(phi: Any, x: Any, m: Any = None) -> Any:
    return phi @ (phi.T @ (x if m is None else m[:, None] * x))


RECONSTRUCTION: list[Case] = [
    ("right", lambda s: projected(s.spectrum()[1][:, :K], s.v, s.barycentric()), "right", ""),
    ("½ missing", lambda s: projected(s.spectrum(2 * s.s())[1][:, :K], s.v, s.barycentric()),
     "right", ""),
    ("unsymmetric, no mass", lambda s: projected(unsymmetric(s)[:, :K], s.v),
     "mistake", "unit modes, no mass"),
    ("graph", lambda s: projected(np.linalg.eigh(laplace((s.uniform() > 0) * 1.0))[1][:, :K], s.v),
     "convention", "graph"),
    ("squared norm",
     lambda s: projected((s.spectrum()[1] / (s.spectrum()[1] ** 2).sum(axis=0))[:, :K], s.v,
     s.barycentric()), "mistake", "squared norm"),
    ("no mass", lambda s: projected(s.spectrum()[1][:, :K], s.v), "mistake", "no mass"),
]  # fmt: skip
LAM, T = 0.5, 2e-3
IMPLICIT: list[Case] = [
    ("right", lambda s: implicit(s, s.uniform(), LAM, 3), "right", ""),
    ("λ = 1", lambda s: implicit(s, s.uniform(), 1.0, 3), "mistake|convention", "λ"),
    ("border fixed", lambda s: implicit(s, rows(s.uniform(), s.edge), LAM, 3),
     "convention|border", "border fixed"),
    ("border rows of the identity",
     lambda s: implicit(s, rows(s.uniform(), s.edge) + np.diag(s.edge * 1.0), LAM, 3),
     "mistake|border", "identity"),
    ("in place", lambda s: in_place(s), "mistake", "in place"),
    ("centred", lambda s: implicit(s, s.uniform(), LAM, 3) - implicit(s, s.uniform(), LAM, 3).mean(axis=0),
     "convention",
     "centred"),
    ("λ from two numbers", lambda s: implicit(s, s.uniform(), 0.3 * LAM, 3),
     "convention", "λ times 0.3"),
    ("explicit", lambda s: explicit(s, s.uniform(), LAM, 3), "mistake", "explicit"),
    ("one step too many", lambda s: implicit(s, s.uniform(), LAM, 4),
     "mistake", "one step too many"),
    ("transposed", lambda s: implicit(s, s.uniform().T, LAM, 3), "mistake", "transposed"),
    ("nothing moved", lambda s: s.v, "mistake", "nothing was moved"),
    ("axes", lambda s: implicit(s, s.uniform(), LAM, 3)[:, [0, 2, 1]], "mistake", "axes in the order xzy"),
]  # fmt: skip


def flow(s: Student, update: str, steps: int = 2) -> Any:
    x, first, mesh = s.v, s, s.mesh
    for _ in range(steps):
        moved = Student(mesh.with_vertices(x))
        stiff = moved.s() if update == "both" else first.s()
        x = np.linalg.solve(
            np.diag(moved.barycentric()) + T * stiff, moved.barycentric()[:, None] * x
        )
    return x


COTANGENT: list[Case] = [
    ("right", lambda s: implicit(s, -s.s() / s.barycentric()[:, None], T, 2), "right", ""),
    ("½ missing", lambda s: implicit(s, -2 * s.s() / s.barycentric()[:, None], T, 2),
     "mistake", "½ missing"),
    ("½ twice", lambda s: implicit(s, -s.s() / s.barycentric()[:, None] / 2, T, 2),
     "convention", "λ halved"),
    ("areas updated", lambda s: flow(s, "mass"), "convention", "area kept up to date"),
    ("both updated", lambda s: flow(s, "both"), "convention", "operator kept up to date"),
    ("absolute cotangents",
     lambda s: implicit(s, -s.s(of=lambda c: abs(c) / 2) / s.barycentric()[:, None], T, 2),
     "mistake", "absolute cotangents"),
]  # fmt: skip


def scaled_volume(s: Student) -> Any:
    x = implicit(s, s.uniform(), LAM, 1)
    after, before = s.mesh.with_vertices(x).volume, s.mesh.volume
    return x * (before / after) ** (1 / 3)


CLOSED: list[tuple[str, Callable[[Student], grade.Report], str, str]] = [
    ("volume", lambda s: grade.smoothed(s.mesh, scaled_volume(s), lam=LAM, iterations=1),
     "convention", "old volume"),
    ("heat, mass missing",
     lambda s: grade.heat(s.mesh, np.linalg.solve(np.diag(s.barycentric()) + T * s.s(), s.v[:, 0]),
     s.v[:, 0], T), "mistake", "mass missing on the right"),
    ("heat",
     lambda s: grade.heat(s.mesh, np.linalg.solve(np.diag(s.barycentric()) + T * s.s(), s.barycentric()
     * s.v[:, 0]), s.v[:, 0], T), "right", ""),
    ("poisson, mean by count",
     lambda s: grade.poisson(s.mesh, poisson(s, s.v[:, 0] ** 2 - (s.v[:, 0] ** 2).mean()),
     s.v[:, 0] ** 2), "mistake", "mean by count"),
    ("poisson", lambda s: grade.poisson(s.mesh, poisson(s, s.v[:, 0] ** 2 - (s.barycentric()
     @ s.v[:, 0] ** 2) / s.barycentric().sum()), s.v[:, 0] ** 2), "right", ""),
    ("noise in [0, 1)",
     lambda s: grade.noise(s.mesh, s.v + 0.1 * np.random.default_rng(1).random(s.v.shape), 0.1),
     "mistake", "biased"),
    ("noise of other axes",
     lambda s: grade.noise(s.mesh, s.v + 0.1 * np.roll(np.ptp(s.v, axis=0), 1)
     * np.random.default_rng(1).normal(size=s.v.shape), 0.1), "mistake", "other axes"),
    ("noise times extent", lambda s: grade.noise(s.mesh, s.v + 0.1 * np.ptp(s.v, axis=0)
     * np.random.default_rng(1).normal(size=s.v.shape), 0.1), "convention", "extent of each axis"),
    ("noise times diagonal", lambda s: grade.noise(s.mesh, s.v + 0.1 * s.mesh.diagonal
     * np.random.default_rng(1).normal(size=s.v.shape), 0.1), "convention", "diagonal"),
    ("noise σ²",
     lambda s: grade.noise(s.mesh, s.v + 0.01 * np.random.default_rng(1).normal(size=s.v.shape), 0.1),
     "mistake", "σ²"),
    ("noise",
     lambda s: grade.noise(s.mesh, s.v + 0.1 * np.random.default_rng(1).normal(size=s.v.shape), 0.1),
     "right", ""),
]  # fmt: skip


def poisson(s: Student, f: Any) -> Any:
    m = s.barycentric()
    u = np.linalg.lstsq(s.s(), m * f, rcond=None)[0]
    return u - (m * u).sum() / m.sum()


JUDGES: dict[str, tuple[list[Case], Callable[[pf.Mesh, Any], grade.Report]]] = {
    "laplacian": (LAPLACIAN, grade.laplacian),
    "laplacian and mass": (PAIRS, lambda mesh, both: grade.laplacian(mesh, *both)),
    "uniform": (UNIFORM, lambda mesh, L: grade.laplacian(mesh, L, weights="uniform")),
    "mass": (MASS, grade.mass),
    "mean": (MEAN, grade.mean_curvature),
    "gaussian": (GAUSSIAN, grade.gaussian_curvature),
    "principal": (PRINCIPAL, grade.principal_curvatures),
    "normals": (NORMALS, grade.vertex_normals),
    "eigenvalues": (EIGENVALUES, grade.eigenvalues),
    "modes": (MODES, grade.modes),
    "reconstruction": (RECONSTRUCTION, lambda mesh, x: grade.reconstruction(mesh, x, K)),
    "implicit": (
        IMPLICIT,
        lambda mesh, x: grade.smoothed(mesh, x, "implicit", lam=LAM, iterations=3),
    ),
    "cotangent": (
        COTANGENT,
        lambda mesh, x: grade.smoothed(mesh, x, time=T, iterations=2, weights="cotangent"),
    ),
}
ALL = [(name, case) for name, (cases, _) in JUDGES.items() for case in cases]


@pytest.fixture(scope="module")
def opened() -> Student:
    return Student(open_mesh())


@pytest.fixture(scope="module")
def closed() -> Student:
    return Student(closed_mesh())


@pytest.mark.parametrize(("quantity", "case"), ALL, ids=lambda x: x if isinstance(x, str) else x[0])
def test_deviations_are_named(quantity: str, case: Case, opened: Student) -> None:
    _, answer, status, name = case
    report = JUDGES[quantity][1](opened.mesh, answer(opened))
    assert report.status in status.split("|"), report
    text = (report.verdict + "; ".join(report.names)).lower()
    assert any(n.lower() in text for n in name.split("|")), report


@pytest.mark.parametrize("case", CLOSED, ids=lambda x: x[0])
def test_deviations_on_a_closed_mesh_are_named(case: Any, closed: Student) -> None:
    _, judged, status, name = case
    report = judged(closed)
    assert report.status in status.split("|"), report
    assert name in report.verdict + "; ".join(report.names), report


@pytest.mark.parametrize(("quantity", "case"), ALL, ids=lambda x: x if isinstance(x, str) else x[0])
def test_right_answers_stay_right_on_a_closed_mesh(
    quantity: str, case: Case, closed: Student
) -> None:
    """Answers that differ at borders alone are right here; conventions are no mistakes."""
    _, answer, status, _ = case
    if status in ("right", "convention", "convention|border"):
        report = JUDGES[quantity][1](closed.mesh, answer(closed))
        assert report.right, report
