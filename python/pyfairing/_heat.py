"""Heat and distances, factorised once for many fields or sources."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats
from ._calls import Progress, running, warn
from ._docs import documented

if TYPE_CHECKING:
    from ._base import Base
    from ._computing import Kind, MassKind


class GeodesicSolver:
    """The heat method for geodesic distance, ready for any sources.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    kind : {'non-negative', 'auto', 'cotangent', 'robust'}
        The Laplacian, as in `Mesh.laplacian`: cotangents unless an edge has a negative weight
        or a face is too thin for them; then the robust one.
    time : float, optional
        The time of diffusion in squared mesh units; that of the mean edge length squared of
        each component unless given.
    threads : int, optional
        At most so many threads.
    progress : callable or bool, optional
        As in `Mesh.geodesic`.

    Attributes
    ----------
    kind : str
        The kind that was taken.

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
        """The kind of the Laplacian that was taken."""
        return self._core.kind

    @documented
    def distance(
        self, sources: npt.ArrayLike, *, threads: int | None = None, progress: Progress = None
    ) -> Floats:
        """The distance of each vertex to the nearest source.

        Parameters
        ----------
        sources : int or array_like of int or bool
            Vertices: numbers, or a mask.
        {run}

        Returns
        -------
        ndarray, shape (n,)
            In mesh units, infinite where nothing is reached.
        """
        vertices = _arrays.numbers(sources, self._n, "sources", self._n)
        with running(threads, progress) as call:
            return self._core.distance(vertices, call)


class HeatSolver:
    """Implicit steps of heat, (M + tS) u = M u₀, of one length.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    time : float
        Of one step, in squared mesh units.
    kind, mass : str
        As in `Mesh.laplacian`.
    threads : int, optional
        At most so many threads.
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
            At the beginning.
        steps : int
            How many.
        {run}

        Returns
        -------
        ndarray, shape (n,)
        """
        field = _arrays.field(temperatures, self._n, "temperatures")
        with running(threads, progress) as call:
            return self._core.step(field, _arrays.whole(steps, "steps"), call)
