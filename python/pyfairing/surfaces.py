"""Surfaces given by formulas, with exact fundamental forms and curvature.

Methods take parameters u and v as numbers or arrays that broadcast, and return arrays of their
shape. The second form uses the inward normal, so that curvature is positive on a sphere.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats

__all__ = ["Cylinder", "Ellipsoid", "Helicoid", "Principal", "Sphere", "Surface", "Torus", "WavyGraph"]


class Principal(NamedTuple):
    """Principal curvatures kappa1 >= kappa2 in 1 / mesh units, and their unit tangents."""

    kappa1: Floats
    kappa2: Floats
    direction1: Floats
    direction2: Floats


class Surface:
    """A surface p(u, v) with exact derivatives."""

    _core: _core.Surface
    _numbers: tuple[float, ...]

    def __init__(self, name: str, *numbers: float) -> None:
        self._numbers = tuple(float(x) for x in numbers)
        self._core = _core.Surface(name, list(self._numbers))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{x:g}' for x in self._numbers)})"

    def __reduce__(self) -> Any:
        return type(self), self._numbers

    def _call(self, method: str, u: npt.ArrayLike, v: npt.ArrayLike) -> tuple[Any, tuple[int, ...]]:
        us, vs = np.broadcast_arrays(_arrays.floats(u, "u"), _arrays.floats(v, "v"))
        flat = [np.ascontiguousarray(a.reshape(-1)) for a in (us, vs)]
        return getattr(self._core, method)(*flat), us.shape

    def point(self, u: npt.ArrayLike, v: npt.ArrayLike) -> Floats:
        """p(u, v), shape (..., 3), in mesh units."""
        found, shape = self._call("point", u, v)
        return np.asarray(found.reshape(*shape, 3))

    def normal(self, u: npt.ArrayLike, v: npt.ArrayLike) -> Floats:
        """The outward unit normal, shape (..., 3).

        Raises
        ------
        ComputationError
            At a singular point of the chart, such as a pole of a sphere.
        """
        found, shape = self._call("normal", u, v)
        return np.asarray(found.reshape(*shape, 3))

    def first_form(self, u: npt.ArrayLike, v: npt.ArrayLike) -> Floats:
        """E, F, G, shape (..., 3), in squared mesh units."""
        found, shape = self._call("first_form", u, v)
        return np.asarray(found.reshape(*shape, 3))

    def second_form(self, u: npt.ArrayLike, v: npt.ArrayLike) -> Floats:
        """L, M, N, shape (..., 3), in mesh units."""
        found, shape = self._call("second_form", u, v)
        return np.asarray(found.reshape(*shape, 3))

    def mean_curvature(self, u: npt.ArrayLike, v: npt.ArrayLike) -> Floats:
        """H, in 1 / mesh units; limits where the chart is singular."""
        found, shape = self._call("mean_curvature", u, v)
        return np.asarray(found.reshape(shape))

    def gaussian_curvature(self, u: npt.ArrayLike, v: npt.ArrayLike) -> Floats:
        """K, in 1 / squared mesh units; limits where the chart is singular."""
        found, shape = self._call("gaussian_curvature", u, v)
        return np.asarray(found.reshape(shape))

    def principal(self, u: npt.ArrayLike, v: npt.ArrayLike) -> Principal:
        """Principal curvatures and directions; at an umbilic the directions are arbitrary.

        Raises
        ------
        ComputationError
            At a singular point of the chart.
        """
        (kappa, first, second), shape = self._call("principal", u, v)
        return Principal(
            kappa[:, 0].reshape(shape),
            kappa[:, 1].reshape(shape),
            first.reshape(*shape, 3),
            second.reshape(*shape, 3),
        )

    def curvature_at(self, points: npt.ArrayLike) -> tuple[Floats, Floats]:
        """Curvature of the level sets through points in space, poles included.

        Parameters
        ----------
        points : array_like, shape (n, 3)
            On the surface, in mesh units.

        Returns
        -------
        kappa1, kappa2 : ndarray, shape (n,)
        """
        kappa, _ = self._core.curvature_at(_arrays.vertices(points, "points"))
        return kappa[:, 0].copy(), kappa[:, 1].copy()


class Ellipsoid(Surface):
    """(a cos u sin v, b sin u sin v, c cos v), 0 <= u < 2 pi, 0 <= v <= pi."""

    def __init__(self, a: float, b: float, c: float) -> None:
        super().__init__("ellipsoid", a, b, c)


class Sphere(Surface):
    """The ellipsoid of equal half-axes."""

    def __init__(self, radius: float = 1.0) -> None:
        super().__init__("sphere", radius)


class Torus(Surface):
    """((R + r cos v) cos u, (R + r cos v) sin u, r sin v)."""

    def __init__(self, major: float = 1.0, minor: float = 0.4) -> None:
        super().__init__("torus", major, minor)


class Cylinder(Surface):
    """(r cos u, r sin u, v)."""

    def __init__(self, radius: float = 1.0) -> None:
        super().__init__("cylinder", radius)


class Helicoid(Surface):
    """(v cos u, v sin u, c u), a minimal surface."""

    def __init__(self, rise: float = 1.0) -> None:
        super().__init__("helicoid", rise)


class WavyGraph(Surface):
    """The graph z = A sin(kx) cos(ky) over (u, v) = (x, y); the outside is up."""

    def __init__(self, amplitude: float = 0.1, wave_number: float = 6.0) -> None:
        super().__init__("wavy_graph", amplitude, wave_number)
