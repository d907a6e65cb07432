"""Edges, loops, neighbours, angles and moments: a base class of `Mesh`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _core
from ._arrays import Floats, Indices
from ._calls import call
from ._checks import warn_of_orientation

if TYPE_CHECKING:
    from ._core import Mesh as CoreMesh


class Moments(NamedTuple):
    """Size, centroid and inertia of a surface or of a solid, of density 1.

    Attributes
    ----------
    measure : float
        The area in squared, or the volume in cubed mesh units; positive.
    centroid : ndarray, shape (3,)
        In mesh units.
    inertia : ndarray, shape (3, 3)
        The inertia tensor about the centroid, `∫ (|x|² I - x xᵀ)`: symmetric, in mesh units to the
        power of four for a surface, five for a solid.
    """

    measure: float
    centroid: Floats
    inertia: Floats


class Elements:
    """Properties of edges, faces and corners."""

    __slots__ = ()

    _core: CoreMesh

    def _ends(self, edges: npt.NDArray[Any]) -> Indices:
        ends: Indices = self._core.edges(call())[edges].astype(np.int64)
        return ends

    @property
    def boundary_edges(self) -> Indices:
        """The edges with one face, as pairs of vertices, (b, 2) int64, in the order of `edges`."""
        return self._ends(_core.special_edges(self._core, call())[0])

    @property
    def nonmanifold_edges(self) -> Indices:
        """The edges with three or more faces, as pairs of vertices, (b, 2) int64."""
        return self._ends(_core.special_edges(self._core, call())[1])

    @property
    def boundary_loops(self) -> list[Indices]:
        """The vertices of each boundary loop in order, a list of (p,) int64.

        The surface is on the left, and the first vertex is not repeated. Holes that touch in a
        vertex are loops of their own.

        Examples
        --------
        >>> import pyfairing as pf
        >>> pipe = pf.shapes.cylinder(0.5, 2.0, 24, 20, ends="open")
        >>> [len(loop) for loop in pipe.boundary_loops]
        [24, 24]
        """
        return [loop.astype(np.int64) for loop in _core.boundary_loops(self._core, call())]

    @property
    def face_neighbors(self) -> Indices:
        """The faces beside each face, (m, 3) int64: column k across the edge opposite corner k.

        -1 at a boundary and at edges with three or more faces.
        """
        return _core.face_neighbors(self._core, call())

    @property
    def corner_angles(self) -> Floats:
        """The angle at each corner of each face, (m, 3) float64, in radians; a row sums to π."""
        return _core.corner_angles(self._core, call())

    @property
    def dihedral_angles(self) -> Floats:
        """The angle between the normals at each edge, (e,) float64 in the order of `edges`.

        In radians: positive where convex, negative where concave, 0 where flat. NaN for edges
        without exactly two faces and beside faces without area. Faces that turn against the rest
        of their part are flipped for the computation, with a `FairingWarning`; along the cut of a
        one-sided part angles are NaN.

        Examples
        --------
        >>> import numpy as np, pyfairing as pf
        >>> tetrahedron = pf.Mesh(
        ...     [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]],
        ...     [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]],
        ... )
        >>> np.degrees(tetrahedron.dihedral_angles).round(2).tolist()
        [109.47, 109.47, 109.47, 109.47, 109.47, 109.47]
        """
        warn_of_orientation(self._core)
        return _core.dihedral_angles(self._core, call())

    def feature_edges(self, angle: float = 30.0) -> Indices:
        """The interior edges where normals turn by at least an angle.

        Parameters
        ----------
        angle : float
            The smallest dihedral angle, convex or concave, in degrees from 0 to 180.

        Returns
        -------
        ndarray of int64, shape (b, 2)
            Pairs of vertices, in the order of `edges`.

        Raises
        ------
        OptionError
            For an angle out of range.

        Examples
        --------
        >>> import pyfairing as pf
        >>> can = pf.shapes.cylinder(0.5, 2.0, 24, 20)
        >>> len(can.feature_edges(60))
        48
        """
        if not 0 <= angle <= 180:
            raise _core.OptionError(f"angle is {angle}, but must be from 0 to 180 degrees")
        return self._ends(np.flatnonzero(abs(self.dihedral_angles) >= np.radians(angle)))

    @property
    def centroid(self) -> Floats:
        """The centroid of the surface, (3,) float64, in mesh units; NaN without area.

        `moments("volume").centroid` is that of the solid.
        """
        found = _core.moments(self._core, False, call())
        return np.full(3, np.nan) if found is None else found[1]

    def moments(self, of: Literal["surface", "volume"] = "surface") -> Moments:
        """Size, centroid and inertia of the surface or of the enclosed solid.

        Parameters
        ----------
        of : {'surface', 'volume'}
            A thin shell, or the solid. A surface that is inside out encloses the same solid.

        Returns
        -------
        Moments
            `measure`, `centroid` (3,) and `inertia` (3, 3) about the centroid, of density 1.

        Raises
        ------
        ComputationError
            If there is no area; for a volume if the surface is open or one-sided, or encloses
            nothing but rounding.

        Examples
        --------
        >>> import pyfairing as pf
        >>> ball = pf.shapes.icosphere(4)
        >>> ball.moments("volume").inertia.diagonal().round(2).tolist()   # 8π/15
        [1.67, 1.67, 1.67]
        """
        if of not in ("surface", "volume"):
            raise _core.OptionError(f"of is {of!r}, but must be 'surface' or 'volume'")
        found = _core.moments(self._core, of == "volume", call())
        if found is None:
            raise _core.ComputationError(self._without(of))
        return Moments(*found)

    def _without(self, of: str) -> str:
        info = self._core.diagnosis(call())
        if of == "surface":
            return f"the surface has no area: {info['area']}"
        open_edges = self.boundary_edges
        if len(open_edges):
            return f"the surface is open: edge {open_edges[0].tolist()} has one face"
        return f"the surface encloses no volume: {info['volume']}"
