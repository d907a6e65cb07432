"""Heat and geodesic distances, factorised once for many fields or sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats
from ._calls import Progress, running, warn
from ._docs import documented

if TYPE_CHECKING:
    from ._base import Base, Kind, MassKind


class GeodesicSolver:
    """Factorised heat method for geodesic distances from any sources.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    kind : {'non-negative', 'auto', 'cotangent', 'robust'}
        The Laplacian, as in `Mesh.laplacian`: by default cotangent, or robust if an edge has a
        negative weight or a face is too thin.
    time : float, optional
        The diffusion time in squared mesh units; by default the squared mean edge length of each
        component.
    threads : int, optional
        Maximum number of threads.
    progress : callable or bool, optional
        As in `Mesh.geodesic`.

    Attributes
    ----------
    kind : str
        The kind in use.

    Examples
    --------
    >>> import pyfairing as pf
    >>> solver = pf.GeodesicSolver(pf.shapes.icosphere(3))
    >>> bool(abs(solver.distance(0).max() - 3.14) < 0.1)
    True
    """

    def __init__(
        self,
        mesh: Base,
        kind: Kind = "non-negative",
        *,
        time: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> None:
        self._n = mesh._core.vertex_count
        with running(threads, progress) as call:
            self._core = _core.Geodesics(mesh._core, kind, None if time is None else float(time), call)
        if self._core.note:
            warn(self._core.note)

    @property
    def kind(self) -> str:
        """The kind of the Laplacian in use."""
        return self._core.kind

    @documented
    def distance(
        self, sources: npt.ArrayLike, *, threads: int | None = None, progress: Progress = None
    ) -> Floats:
        """The distance of each vertex to the nearest source.

        Parameters
        ----------
        sources : int or array_like of int or bool
            Vertex indices, or a mask.
        {run}

        Returns
        -------
        ndarray, shape (n,)
            In mesh units, infinite on components without a source.
        """
        vertices = _arrays.numbers(sources, self._n, "sources", self._n)
        with running(threads, progress) as call:
            return self._core.distance(vertices, call)


class HeatSolver:
    """Implicit heat steps (M + tS) u = M u₀ of fixed length, factorised once.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    time : float
        Length of a step, in squared mesh units.
    kind, mass : str
        As in `Mesh.laplacian`.
    threads : int, optional
        Maximum number of threads.
    """

    def __init__(
        self,
        mesh: Base,
        time: float,
        kind: Kind = "auto",
        mass: MassKind = "barycentric",
        *,
        threads: int | None = None,
    ) -> None:
        self._n = mesh._core.vertex_count
        with running(threads, None) as call:
            self._core = _core.Heat(mesh._core, float(time), kind, mass, call)
        if self._core.note:
            warn(self._core.note)

    @documented
    def step(
        self,
        temperatures: npt.ArrayLike,
        steps: int = 1,
        *,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Floats:
        """The temperatures after some steps.

        Parameters
        ----------
        temperatures : array_like, shape (n,)
            Initial temperatures.
        steps : int
            Number of steps.
        {run}

        Returns
        -------
        ndarray, shape (n,)
        """
        field = _arrays.field(temperatures, self._n, "temperatures")
        with running(threads, progress) as call:
            return self._core.step(field, _arrays.whole(steps, "steps"), call)
