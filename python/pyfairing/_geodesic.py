"""Geodesic distances, paths and isolines: methods of `Mesh`, and the solver."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple, overload

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats, Indices
from ._calls import Progress, call, warn
from ._docs import documented

if TYPE_CHECKING:
    from ._mesh import Mesh
    from ._names import Kind


class Polyline(NamedTuple):
    """A connected piece of an isoline.

    Attributes
    ----------
    points : ndarray, shape (p, 3)
        The points, in mesh units; the first of a closed piece is not repeated.
    edges : ndarray of int64, shape (p, 2)
        The vertices of the edge that each point lies on; twice the same at a vertex.
    closed : bool
        True if the last point is connected to the first.
    """

    points: Floats
    edges: Indices
    closed: bool

    @property
    def segments(self) -> Floats:
        """The segments, shape (s, 2, 3)."""
        following = np.roll(self.points, -1, axis=0)
        segments = np.stack([self.points, following], axis=1)
        return segments if self.closed else segments[:-1]


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
        As in `Mesh.geodesic_distance`.

    Attributes
    ----------
    kind : str
        The kind in use.

    Notes
    -----
    A solver can be pickled; it is factorised again where it is loaded.

    Examples
    --------
    >>> import pyfairing as pf
    >>> solver = pf.GeodesicSolver(pf.shapes.icosphere(3))
    >>> solver
    GeodesicSolver(642 vertices, cotangent)
    >>> bool(abs(solver.distance(0).max() - 3.14) < 0.1)
    True
    """

    def __init__(
        self,
        mesh: Mesh,
        kind: Kind = "non-negative",
        *,
        time: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> None:
        self._mesh, self._time = mesh, None if time is None else float(time)
        self._core = _core.Geodesics(mesh._core, kind, self._time, call(threads, progress))
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
        sources : array_like
            As in `Mesh.geodesic_distance`.
        {run}

        Returns
        -------
        ndarray, shape (n,)
            In mesh units, infinite on components without a source.
        """
        given = _sources(self._mesh, sources)
        return self._core.distance(given, call(threads, progress))

    @documented
    def path(
        self, start: int, sources: npt.ArrayLike, *, threads: int | None = None, progress: Progress = None
    ) -> Floats:
        """The descent path from a vertex to the nearest source.

        Parameters
        ----------
        start : int
            A vertex.
        sources : array_like
            As in `Mesh.geodesic_distance`.
        {run}

        Returns
        -------
        ndarray, shape (p, 3)
            As from `Mesh.geodesic_path`.
        """
        n = self._mesh._core.vertex_count
        (vertex,) = _arrays.numbers([start], n, "start")
        given = _sources(self._mesh, sources)
        points, arrives = self._core.path(vertex, given, call(threads, progress))
        if not arrives:
            warn("the path ends in a local minimum of the distance, not at a source")
        return points

    def __repr__(self) -> str:
        return f"GeodesicSolver({self._mesh._core.vertex_count} vertices, {self.kind})"

    def __reduce__(self) -> Any:
        return _solver, (type(self), self._mesh, self.kind, self._time)


def _solver(cls: type[GeodesicSolver], mesh: Mesh, kind: Kind, time: float | None) -> GeodesicSolver:
    return cls(mesh, kind, time=time)


def _sources(mesh: Mesh, sources: Any) -> Any:
    """Vertices, points in space, or pairs of a face and barycentric coordinates."""
    if isinstance(sources, tuple) and len(sources) == 2 and np.ndim(sources[1]) > 0:
        count = mesh._core.face_count
        faces = _arrays.numbers(sources[0], count, "sources", of="face")
        weights = _arrays.floats(sources[1], "barycentric coordinates").reshape(-1, 3)
        if len(weights) != len(faces):
            raise _core.OptionError(f"{len(weights)} barycentric coordinates for {len(faces)} faces")
        return list(zip(faces, weights.tolist(), strict=True))
    array = np.asarray(sources)
    if array.dtype.kind == "f" and array.size:
        points = _arrays.vertices(np.atleast_2d(array), "sources")
        _arrays.finite(points, "sources")
        return points.tolist()
    n = mesh._core.vertex_count
    return _arrays.numbers(sources, n, "sources")


@documented
def geodesic_distance(
    self: Mesh,
    sources: npt.ArrayLike,
    kind: Kind = "non-negative",
    *,
    time: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Floats:
    """The distance of each vertex to the nearest source, by the heat method.

    A smooth approximation of the geodesic distance, of first order in the edge length.
    For several sets of sources, create one `GeodesicSolver`.

    Parameters
    ----------
    sources : array_like
        Integers are vertices, booleans a mask of vertices. Floats of shape (3,) or (k, 3) are
        points in space: the nearest points of the surface are the sources. A tuple
        `(faces, barycentric)`, of shapes (k,) and (k, 3), is points on faces.
    kind : {'non-negative', 'auto', 'cotangent', 'robust'}
        The Laplacian, as in `laplacian`: by default cotangent, or robust if an edge has a
        negative weight or a face is too thin.
    time : float, optional
        The diffusion time in squared mesh units; by default the squared mean edge length
        of each component. Longer times smooth the distance more.
    {run}

    Returns
    -------
    ndarray, shape (n,)
        In mesh units, zero at every source vertex, infinite on components without a source.

    Examples
    --------
    >>> import pyfairing as pf
    >>> ball = pf.shapes.icosphere(4)
    >>> pole = ball.geodesic_distance([0.0, 0.0, 1.2])
    >>> on_face = ball.geodesic_distance((7, [0.2, 0.3, 0.5]))
    >>> bool(abs(pole.max() - 3.14) < 0.1), bool(on_face.min() < ball.mean_edge_length)
    (True, True)
    """
    solver = GeodesicSolver(self, kind, time=time, threads=threads, progress=progress)
    return solver.distance(sources, threads=threads)


@documented
def geodesic_path(
    self: Mesh,
    start: int,
    sources: npt.ArrayLike,
    kind: Kind = "non-negative",
    *,
    time: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Floats:
    """The descent path from a vertex to the nearest source, down the gradient of the distance.

    It is close to the shortest path; the difference decreases with the edge length.

    For several paths, create one `GeodesicSolver`.

    Parameters
    ----------
    start : int
        A vertex.
    sources : array_like
        As in `geodesic_distance`.
    kind : {'non-negative', 'auto', 'cotangent', 'robust'}
        As in `geodesic_distance`.
    time : float, optional
        As in `geodesic_distance`.
    {run}

    Returns
    -------
    ndarray, shape (p, 3)
        The points on edges and at vertices where the path bends, in mesh units, from the start
        to the source. A `FairingWarning` is issued if errors of the distance end it elsewhere.

    Raises
    ------
    ComputationError
        If the start is on a component without a source.

    Examples
    --------
    >>> import numpy as np, pyfairing as pf
    >>> ball = pf.shapes.icosphere(4)
    >>> path = ball.geodesic_path(0, ball.vertices[0] * -1)
    >>> length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    >>> bool(abs(length - np.pi) < 0.05)
    True
    """
    solver = GeodesicSolver(self, kind, time=time, threads=threads, progress=progress)
    return solver.path(start, sources, threads=threads)


@overload
def isolines(
    self: Mesh,
    field: npt.ArrayLike,
    levels: npt.ArrayLike,
    *,
    polylines: Literal[False] = False,
    threads: int | None = None,
    progress: Progress = None,
) -> list[Floats]: ...


@overload
def isolines(
    self: Mesh,
    field: npt.ArrayLike,
    levels: npt.ArrayLike,
    *,
    polylines: Literal[True],
    threads: int | None = None,
    progress: Progress = None,
) -> list[list[Polyline]]: ...


@documented
def isolines(
    self: Mesh,
    field: npt.ArrayLike,
    levels: npt.ArrayLike,
    *,
    polylines: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> list[Floats] | list[list[Polyline]]:
    """The lines where a field, linear on each face, has given values.

    Edges whose ends both have the value belong to the line. Of a region of faces whose corners
    all have it, only the outline does. No segment occurs twice or has length zero.

    Parameters
    ----------
    field : array_like, shape (n,)
        A value for each vertex; faces with a value that is infinite or NaN have no lines.
    levels : float or array_like, shape (k,)
        The values.
    polylines : bool
        Return connected pieces instead of segments.
    {run}

    Returns
    -------
    list of ndarray, shape (s, 2, 3), or list of list of Polyline
        For each level its segments, in mesh units; with `polylines` its pieces, which have
        `points` of shape (p, 3), `edges` of shape (p, 2), the vertices of the edge that each
        point lies on (twice the same at a vertex), and `closed`, True if the last point is
        connected to the first.

    Examples
    --------
    >>> import numpy as np, pyfairing as pf
    >>> ball = pf.shapes.icosphere(4)
    >>> equator, north = ball.isolines(ball.vertices[:, 2], [0.0, 0.5])
    >>> bool(abs(np.linalg.norm(equator[:, 0] - equator[:, 1], axis=1).sum() - 2 * np.pi) < 0.01)
    True
    >>> (circle,), _ = ball.isolines(ball.vertices[:, 2], [0.0, 0.5], polylines=True)
    >>> circle.closed
    True
    """
    n = self._core.vertex_count
    values = _arrays.floats(field, "field")
    if values.shape != (n,):
        raise _core.OptionError(f"field has the shape {values.shape}, but must have ({n},)")
    values = np.where(np.isnan(values), np.inf, values)
    at = np.atleast_1d(_arrays.floats(levels, "levels"))
    if at.ndim != 1:
        raise _core.OptionError(f"levels has the shape {at.shape}, but must be flat")
    _arrays.finite(at, "levels")
    found = _core.isolines(self._core, np.ascontiguousarray(values), at.tolist(), call(threads, progress))
    pieces = [[Polyline(p, edges.astype(np.int64), closed) for p, edges, closed in line] for line in found]
    if polylines:
        return pieces
    empty = np.empty((0, 2, 3))
    return [np.concatenate([empty, *(piece.segments for piece in line)]) for line in pieces]
