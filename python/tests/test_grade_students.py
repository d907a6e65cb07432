"""Exercises as students write them: loops over faces and neighbours, not the formulas of the judge."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pyfairing as pf


class Student:
    """Loops over the faces of a mesh, with the quantities of the exercises."""

    def __init__(self, mesh: pf.Mesh) -> None:
        self.mesh, self.v, self.f = mesh, mesh.vertices, mesh.faces.astype(int)
        self.n = len(self.v)
        self.directed = {
            (int(t[k]), int(t[(k + 1) % 3])): int(t[(k + 2) % 3]) for t in self.f for k in range(3)
        }
        self.neighbours: list[list[int]] = [[] for _ in range(self.n)]
        for i, j in self.directed:
            for a, b in ((i, j), (j, i)):
                if b not in self.neighbours[a]:
                    self.neighbours[a].append(b)
        self.edge = np.array(mesh.boundary_vertices)
        # Outer half-edges run against the faces: from the head to the tail.
        self.follow = {j: i for i, j in self.directed if (j, i) not in self.directed}
        self.before = {w: u for u, w in self.follow.items()}

    def angle(self, a: int, b: int, c: int) -> float:
        """At a."""
        u, w = self.v[b] - self.v[a], self.v[c] - self.v[a]
        return math.acos(max(-1.0, min(1.0, u @ w / math.sqrt(u @ u) / math.sqrt(w @ w))))

    def cot(self, a: int, b: int, c: int) -> float:
        u, w = self.v[b] - self.v[a], self.v[c] - self.v[a]
        return float(u @ w / np.linalg.norm(np.cross(u, w)))

    def triangle(self, a: int, b: int, c: int) -> float:
        return float(np.linalg.norm(np.cross(self.v[b] - self.v[a], self.v[c] - self.v[a])) / 2)

    def weights(self, of: Callable[[float], float] = lambda c: c / 2) -> Any:
        w = np.zeros((self.n, self.n))
        for (i, j), k in self.directed.items():
            w[i, j] += of(self.cot(k, i, j))
            w[j, i] += of(self.cot(k, i, j))
        return w

    def outer(self) -> Any:
        """Weights that the outer half-edges of the border add: the angle after each."""
        w = np.zeros((self.n, self.n))
        for i, j in self.follow.items():
            k = self.follow[j]
            w[i, j] += self.cot(k, i, j) / 2
            w[j, i] += self.cot(k, i, j) / 2
        return w

    def ring(self) -> Any:
        """Weights in the row of a border vertex if its ring is closed."""
        w = np.zeros((self.n, self.n))
        for own, after in self.follow.items():
            previous = self.before[own]
            w[own, after] += self.cot(previous, own, after) / 2
            w[own, previous] += self.cot(after, own, previous) / 2
        return w

    def s(self, **more: Any) -> Any:
        return laplace(self.weights(**more))

    def uniform(self) -> Any:
        a = (self.weights() != 0).astype(float)
        for i, around in enumerate(self.neighbours):
            a[i, around] = 1.0
        return a / a.sum(axis=1)[:, None] - np.eye(self.n)

    def barycentric(self) -> Any:
        m = np.zeros(self.n)
        for t in self.f:
            m[t] += self.triangle(*t) / 3
        return m

    def circumcentric(self, obtuse: bool = False) -> Any:
        m = np.zeros(self.n)
        for t in self.f:
            angles = [self.angle(t[k], t[k - 2], t[k - 1]) for k in range(3)]
            for k in range(3):
                a, b, c = t[k], t[k - 2], t[k - 1]
                if obtuse and max(angles) > math.pi / 2:
                    m[a] += self.triangle(*t) / (2 if angles[k] > math.pi / 2 else 4)
                    continue
                ab, ac = self.v[b] - self.v[a], self.v[c] - self.v[a]
                m[a] += (ab @ ab * self.cot(c, a, b) + ac @ ac * self.cot(b, a, c)) / 8
        return m

    def mixed(self) -> Any:
        return self.circumcentric(obtuse=True)

    def normals(self, weight: str = "area") -> Any:
        n = np.zeros((self.n, 3))
        for t in self.f:
            cross = np.cross(self.v[t[1]] - self.v[t[0]], self.v[t[2]] - self.v[t[0]])
            for k in range(3):
                unit = cross / np.linalg.norm(cross)
                n[t[k]] += {"area": cross / 2, "equal": unit,
                            "angle": unit * self.angle(t[k], t[k - 2], t[k - 1])}[weight]  # fmt: skip
        return n

    def vector(self, s: Any = None, m: Any = None) -> Any:
        s, m = self.s() if s is None else s, self.mixed() if m is None else m
        return s @ self.v / m[:, None] / 2

    def h(self, s: Any = None, m: Any = None, unit: Any = None) -> Any:
        vector = self.vector(s, m)
        sign = np.sign((vector * (self.normals() if unit is None else unit)).sum(axis=1))
        return sign * np.linalg.norm(vector, axis=1)

    def defect(self, edge: float = math.pi, full: float = 2 * math.pi) -> Any:
        d = np.where(self.edge, edge, full)
        for t in self.f:
            for k in range(3):
                d[t[k]] -= self.angle(t[k], t[k - 2], t[k - 1])
        return d

    def dihedral(self) -> Any:
        """Sum of angle times length."""
        total = np.zeros(self.n)
        unit = {
            tuple(t): np.cross(self.v[t[1]] - self.v[t[0]], self.v[t[2]] - self.v[t[0]])
            for t in self.f
        }
        face = {
            (t[k], t[(k + 1) % 3]): n / np.linalg.norm(n) for t, n in unit.items() for k in range(3)
        }
        for i, j in self.directed:
            if i < j and (j, i) in face:
                along = self.v[j] - self.v[i]
                length = np.linalg.norm(along)
                angle = math.atan2(
                    np.cross(face[i, j], face[j, i]) @ along / length, face[i, j] @ face[j, i]
                )
                total[[i, j]] += angle * length
        return total

    def principal(
        self, h: Any, k: Any, root: Callable[[Any], Any] = lambda x: np.sqrt(np.maximum(x, 0))
    ) -> Any:
        return np.column_stack([h + root(h**2 - k), h - root(h**2 - k)])

    def spectrum(self, s: Any = None, m: Any = None) -> tuple[Any, Any]:
        s, m = self.s() if s is None else s, self.barycentric() if m is None else m
        values, u = np.linalg.eigh(s / np.sqrt(m)[:, None] / np.sqrt(m)[None])
        return values, u / np.sqrt(m)[:, None]


def laplace(w: Any) -> Any:
    return np.diag(w.sum(axis=1)) - w


def rows(matrix: Any, mask: Any, value: Any = 0.0) -> Any:
    out = matrix.copy()
    out[mask] = value
    return out


def last(student: Student, of_face: Callable[[Any], Any], shape: tuple[int, ...]) -> Any:
    out = np.zeros((student.n, *shape))
    for t in student.f:
        out[t] = of_face(t)
    return out


def cross(student: Student, t: Any) -> Any:
    return np.cross(student.v[t[1]] - student.v[t[0]], student.v[t[2]] - student.v[t[0]])


def implicit(student: Student, operator: Any, lam: float = 0.5, steps: int = 1) -> Any:
    x = student.v
    for _ in range(steps):
        x = np.linalg.solve(np.eye(student.n) - lam * operator, x)
    return x


def explicit(student: Student, operator: Any, lam: float = 0.5, steps: int = 1) -> Any:
    x = student.v
    for _ in range(steps):
        x = x + lam * operator @ x
    return x


def in_place(student: Student, lam: float = 0.5, steps: int = 3) -> Any:
    x = student.v.copy()
    for _ in range(steps):
        for i in range(student.n):
            x[i] += lam * (x[student.neighbours[i]].mean(axis=0) - x[i])
    return x


def nan_where(values: Any, mask: Any) -> Any:
    out = np.array(values, dtype=float)
    out[mask] = np.nan
    return out


def open_mesh() -> pf.Mesh:
    """Uneven, with obtuse triangles inside and at the border, with saddles and caps."""
    plane = pf.shapes.irregular_plane(0.09)
    x, y, _ = plane.vertices.T
    return plane.with_vertices(
        np.column_stack(
            [1.1 * x + 0.1 * y**2, y - 0.1 * x**2, 0.2 * np.sin(4 * x + 1) * np.cos(3 * y)]
        )
    )


def closed_mesh() -> pf.Mesh:
    """Uneven, obtuse in places, in no symmetric position."""
    ball = pf.shapes.bumpy_sphere(2, 0.15, 4.0)
    return ball.with_vertices(ball.vertices * [1.0, 1.3, 0.8] + [0.1, 0.2, 0.3]).noise(
        0.12, kind="axes"
    )
