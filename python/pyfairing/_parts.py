"""Repair, components, submeshes and closest points: methods of `Mesh` on its parts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats, Indices
from ._calls import Progress, call, warn
from ._checks import warn_of_orientation
from ._docs import documented

if TYPE_CHECKING:
    from ._mesh import Mesh

Self = TypeVar("Self", bound="Mesh")


class Components(NamedTuple):
    """Labels of the parts that are connected by shared vertices.

    Parts are numbered from 0 in the order of their lowest vertices.

    Attributes
    ----------
    vertices : ndarray of int64, shape (n,)
        The part of each vertex; -1 for an isolated vertex.
    faces : ndarray of int64, shape (m,)
        The part of each face.
    """

    vertices: Indices
    faces: Indices

    @property
    def n_components(self) -> int:
        """The number of parts."""
        return int(self.faces.max(initial=-1)) + 1

    def __repr__(self) -> str:
        return f"Components({self.n_components} of {len(self.faces)} faces)"


class Closest(NamedTuple):
    """Closest points of a surface.

    Attributes
    ----------
    distance : ndarray, shape (k,)
        In mesh units; if signed, negative inside.
    point : ndarray, shape (k, 3)
        The closest points, in mesh units.
    face : ndarray of int64, shape (k,)
        A face that contains each.
    """

    distance: Floats
    point: Floats
    face: Indices

    def __repr__(self) -> str:
        text = f"Closest({len(self.distance)} points"
        if len(self.distance):
            text += f", distances from {self.distance.min():.4g} to {self.distance.max():.4g}"
        return text + ")"


@documented
def repair(
    self: Self,
    *,
    merge: bool = True,
    tolerance: float | None = None,
    unit: Literal["edge", "model", "diagonal"] = "edge",
    duplicates: bool = True,
    orient: bool = True,
    cavities: bool = False,
    split: bool = True,
    smallest_component: int = 0,
    thin: float = 0.0,
    isolated: bool = True,
    holes: int = 0,
    threads: int | None = None,
    progress: Progress = None,
) -> Self:
    """Mends a mesh; by default no vertex moves by more than rounding.

    Merges vertices, drops redundant faces and unused vertices, flips faces that disagree,
    separates sheets that touch, and on request removes small components and thin faces and
    fills holes. The remaining elements keep their order. A second repair changes nothing, except
    with a tolerance in mean edge lengths, which grow as short edges are removed.

    Parameters
    ----------
    merge : bool
        Merge vertices at the same place, and drop faces that lose a corner.
    tolerance : float, optional
        The distance up to which vertices are merged, 0 for exactly equal positions. A vertex
        moves to the first one within the distance that stays. By default four units in the last
        place of single-precision coordinates, at boundaries, and only where no face collapses,
        no edge gets an odd number of faces above one and no face lies on another, because a file
        in single precision does not distinguish such vertices. Numbers written with fewer than seven digits
        need a tolerance.
    unit : {'edge', 'model', 'diagonal'}
        Of the tolerance: mean edge lengths of this mesh (from 0 to 1), mesh units, or diagonals
        of the bounding box (from 0 to 1).
    duplicates : bool
        Drop faces with the corners of an earlier face, in any order. Both are dropped if they are
        a fin of a closed surface, which one of them would open; both are kept if they are a wall
        between two closed parts.
    orient : bool
        Flip faces so that neighbours agree, and closed parts that are inside out and in no
        other part, with their contents.
    cavities : bool
        Flip closed parts inside others, too, so that normals point outwards, or inwards where
        they are inside an odd number of others: a solid inside a solid becomes a cavity.
    split : bool
        Give a vertex of its own to each sheet of faces at a non-manifold edge or vertex.
    smallest_component : int
        Drop components with fewer faces than this.
    thin : float
        Collapse needles and flip caps: faces whose height is below this fraction of their
        longest edge, from 0 to 0.1. 0.002 removes the `sliver_faces` of `info`.
    isolated : bool
        Drop vertices that no face uses, unless there are no faces at all.
    holes : int
        Fill holes of at most this many edges, at most 2000, by patches that continue the
        surface around them. The boundary of an open surface counts as a hole, too.
    {run}

    Returns
    -------
    Mesh
        With the fields of this mesh and its faces; in the patch of a hole those nearby. Normals
        are left out if the surface has changed. `Mesh.report` has

        - `unchanged`: true if nothing had to be mended
        - `changes`: the elements of this mesh that each step changed, ascending, by the names
          `merged-vertices`, `collapsed-faces`, `duplicate-faces`, `turned-faces`,
          `split-vertices`, `small-components` (faces), `thin-faces`, `isolated-vertices`,
          `filled-holes`, `moved-vertices`, whose position changed because they were merged;
          and the defects left: `open-holes`, `nested-parts` (each named by its lowest face), closed
          parts within others that `cavities` would flip, and `touching-vertices`, at one position
          without a common edge. A hole is named by the lowest vertex of its boundary
        - `open_holes`: if holes were to be filled, for each one left its lowest vertex, its
          number of edges, and the reason: `too-large`, `lone-face` (the rim of a single face),
          `no-patch` (each would repeat an edge) or `patch-removed` (by other steps)
        - `vertices`: for each vertex of this mesh the vertex that took its place, -1 if it was
          dropped
        - `vertex_sources`, `face_sources`: for each vertex and face of the result that of this
          mesh, -1 in the patch of a hole
        - `flat_patches`: the reason why patches of holes stay flat, or None

    Raises
    ------
    OptionError
        For options that are out of range.

    Examples
    --------
    >>> import pyfairing as pf
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]
    >>> soup = pf.Mesh(corners, [[0, 1, 2], [3, 4, 5]])
    >>> mesh = soup.repair()
    >>> mesh, mesh.faces.tolist()
    (Mesh(4 vertices, 2 faces), [[0, 1, 2], [1, 3, 2]])
    >>> {step: elements.tolist() for step, elements in mesh.report["changes"].items()}
    {'merged-vertices': [3, 4], 'turned-faces': [1]}
    >>> mesh.report["vertices"].tolist()
    [0, 1, 2, 1, 2, 3]
    """
    steps = {
        "merge": bool(merge),
        "tolerance": None if tolerance is None else float(tolerance),
        "unit": unit,
        "duplicates": bool(duplicates),
        "orient": bool(orient),
        "cavities": bool(cavities),
        "split": bool(split),
        "smallest_component": _arrays.whole(smallest_component, "smallest_component"),
        "thin": float(thin),
        "isolated": bool(isolated),
        "holes": _arrays.whole(holes, "holes"),
    }
    core, report, (nearest, corners), normals = _core.repair(self._core, steps, call(threads, progress))
    report["changes"] = {step: elements.astype(np.int64) for step, elements in report["changes"].items()}
    if report["flat_patches"]:
        warn(f"the patches of holes stay flat: {report['flat_patches']}")
    faces = {name: values[corners[::3] // 3] for name, values in self._face_fields.items()}
    if "texture" in faces:
        faces["texture"] = self._face_fields["texture"].reshape(-1, 2)[corners].reshape(-1, 3, 2)
    fields = {name: values[nearest] for name, values in self._fields.items()}
    if not normals:
        fields.pop("normal", None)
        faces.pop("normal", None)
    return self._of(core, fields, report, faces)


def weld(self: Self, tolerance: float = 0.0) -> tuple[Self, Indices]:
    """Joins vertices at equal positions, or nearer than a tolerance.

    For files whose faces do not share corners, or that are open along seams of texture
    coordinates: compute on the welded mesh and map results back by `index`. `repair` does this
    and more, and keeps fields.

    Parameters
    ----------
    tolerance : float
        In mesh units: each vertex joins the first one within this distance that stays. 0 joins
        exactly equal positions.

    Returns
    -------
    mesh : Mesh
        Vertices in the order of their first appearance, without fields; faces that had two
        corners in one place are left out.
    index : ndarray of int64, shape (n,)
        The vertex of `mesh` that each vertex of this mesh became.

    Examples
    --------
    >>> import pyfairing as pf
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> soup = pf.Mesh(corners, [[0, 1, 2], [3, 4, 5]])
    >>> mesh, index = soup.weld()
    >>> mesh, index.tolist()
    (Mesh(4 vertices, 2 faces), [0, 1, 2, 1, 3, 2])
    >>> soup.with_vertices(mesh.vertices[index]) == soup
    True
    """
    if tolerance == 0:
        core, index = self._core.weld(call())
        return self._of(core), index.astype(np.int64)
    merge = {"merge": True, "tolerance": float(tolerance), "unit": "model"}
    off = {"duplicates", "orient", "cavities", "split", "isolated"}
    steps = {**merge, **dict.fromkeys(off, False), "smallest_component": 0, "thin": 0.0, "holes": 0}
    core, report, _, _ = _core.repair(self._core, steps, call())
    return self._of(core), report["vertices"].astype(np.int64)


def components(self: Mesh) -> Components:
    """Labels of the parts that are connected by shared vertices.

    Returns
    -------
    Components
        `vertices` (n,) and `faces` (m,), numbered from 0 in the order of their lowest
        vertices; -1 for isolated vertices.

    Examples
    --------
    >>> import numpy as np, pyfairing as pf
    >>> ball = pf.shapes.icosphere(1)
    >>> faces = np.vstack([ball.faces, ball.faces + ball.n_vertices])
    >>> two = pf.Mesh(np.vstack([ball.vertices, ball.vertices + 3]), faces)
    >>> parts = two.components()
    >>> parts, np.bincount(parts.faces).tolist()
    (Components(2 of 160 faces), [80, 80])
    >>> two.submesh(parts.faces == 1)[0]
    Mesh(42 vertices, 80 faces)
    """
    return Components(*_core.components(self._core, call()))


def submesh(self: Self, faces: npt.ArrayLike) -> tuple[Self, Indices]:
    """The mesh of some faces, and of their vertices.

    Parameters
    ----------
    faces : array_like of int or bool
        Face indices, or a mask. The faces with all corners in a mask of vertices are
        `mask[mesh.faces].all(axis=1)`.

    Returns
    -------
    mesh : Mesh
        Faces in the order given, vertices in the order of this mesh, both with their fields.
    index : ndarray of int64
        The vertex of this mesh of each vertex of `mesh`.

    Examples
    --------
    >>> import pyfairing as pf
    >>> ball = pf.shapes.icosphere(3)
    >>> upper = ball.vertices[:, 2] > 0
    >>> half, index = ball.submesh(upper[ball.faces].all(axis=1))
    >>> bool((half.vertices == ball.vertices[index]).all())
    True
    """
    numbers = _arrays.numbers(faces, self._core.face_count, "faces", of="face")
    chosen = np.asarray(numbers, dtype=np.int64)
    corners = self._core.faces[chosen]
    index = np.unique(corners)
    places = np.searchsorted(index, corners).astype(np.uint32).reshape(-1, 3)
    core = _core.Mesh(np.ascontiguousarray(self._core.vertices[index]), places)
    fields = {name: values[index] for name, values in self._fields.items()}
    of_faces = {name: values[chosen] for name, values in self._face_fields.items()}
    return self._of(core, fields, None, of_faces), index.astype(np.int64)


@documented
def closest(
    self: Mesh,
    points: npt.ArrayLike,
    *,
    signed: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Closest:
    """The closest points of the surface to points in space, exact to rounding.

    Parameters
    ----------
    points : array_like, shape (k, 3)
        In mesh units, such as the vertices of another mesh.
    signed : bool
        Make distances negative on the inner side: the side of the normal at the closest
        point, at edges and vertices of the mean of the normals weighted by angles. Exact on a
        closed surface that does not intersect itself.
    {run}

    Returns
    -------
    Closest
        `distance` (k,), `point` (k, 3) and `face` (k,).

    Raises
    ------
    ComputationError
        If the mesh has no faces.

    Examples
    --------
    >>> import pyfairing as pf
    >>> ball = pf.shapes.icosphere(4)
    >>> near = ball.closest([[0, 0, 0.5], [0, 3, 0]], signed=True)
    >>> near.distance.round(1).tolist()
    [-0.5, 2.0]
    """
    at = _arrays.vertices(points, "points")
    _arrays.finite(at, "points")
    if signed:
        warn_of_orientation(self._core)
    distance, point, face = _core.closest(self._core, at, bool(signed), call(threads, progress))
    return Closest(distance, point, face.astype(np.int64))
