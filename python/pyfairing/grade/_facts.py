"""Angles, areas, borders and operators of a mesh, each computed once."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from .._arrays import Bools, Csr, Floats

if TYPE_CHECKING:
    from .._mesh import Mesh

Integers = npt.NDArray[np.int64]


class Facts:
    """Ingredients of the formulas that are judged; lengths in mesh units, angles in radians.

    Corner c of a face is opposite the edge of its corners c + 1 and c + 2. The standard operators
    and areas are those of `Mesh.laplacian`; only variants are computed here.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self.points: Floats = mesh.vertices
        self.faces: Integers = mesh.faces
        self.n = mesh.n_vertices
        self.border: Bools = mesh.boundary_vertices
        self._memory: dict[Any, Any] = {}

    def remember(self, key: Any, make: Any) -> Any:
        """The value of `make()`, computed at the first call for this key."""
        if key not in self._memory:
            self._memory[key] = make()
        return self._memory[key]

    # Faces and corners.

    @cached_property
    def sides(self) -> Floats:
        """The vectors from corner c + 1 to corner c + 2, (m, 3, 3)."""
        p = self.points[self.faces]
        sides: Floats = np.roll(p, -2, axis=1) - np.roll(p, -1, axis=1)
        return sides

    @cached_property
    def cross(self) -> Floats:
        """Twice the area vector of each face, (m, 3)."""
        return np.cross(self.sides[:, 2], -self.sides[:, 1])

    @cached_property
    def face_areas(self) -> Floats:
        areas: Floats = np.linalg.norm(self.cross, axis=1) / 2
        return areas

    @cached_property
    def face_normals(self) -> Floats:
        return np.nan_to_num(self.mesh.face_normals)

    @cached_property
    def angles(self) -> Floats:
        return corner_angles(self.sides)

    @cached_property
    def cotangents(self) -> Floats:
        cotangents: Floats = 1 / np.tan(self.angles)
        return cotangents

    @cached_property
    def corner_sizes(self) -> dict[str, Floats]:
        """Extremes over the corners and faces at each vertex, for `where`."""
        worst: dict[str, Floats] = {}
        per_face = {
            "largest angle": (self.angles.max(axis=1), np.maximum),
            "smallest angle": (self.angles.min(axis=1), np.minimum),
            "smallest face": (self.face_areas, np.minimum),
        }
        for name, (values, ufunc) in per_face.items():
            found = np.full(self.n, -np.inf if ufunc is np.maximum else np.inf)
            ufunc.at(found, self.faces, values[:, None])
            worst[name] = found
        worst["valence"] = self.degree
        return worst

    @cached_property
    def obtuse(self) -> Bools:
        """The vertices with an obtuse face."""
        return np.asarray(self.corner_sizes["largest angle"] > np.pi / 2 + 1e-9)

    def gather(self, corner_values: Floats, faces: Integers | None = None) -> Floats:
        """Sums values of the corners, (m, 3) or (m, 3, d), at the vertices."""
        faces = self.faces if faces is None else faces
        total: Floats = np.zeros((self.n, *corner_values.shape[2:]))
        np.add.at(total, faces, corner_values)
        return total

    # Borders.

    @cached_property
    def outer(self) -> Integers:
        """Previous, own and next vertex along the outer side of the border, (b, 3).

        The outer half-edge of an edge with one face runs against that face.
        """
        starts, ends = (np.roll(self.faces, -k, axis=1).reshape(-1) for k in (0, 1))
        directed = set(zip(starts.tolist(), ends.tolist()))
        following = {b: a for a, b in sorted(directed) if (b, a) not in directed}
        triples = [(v, w, following[w]) for v, w in following.items() if w in following]
        return np.array(triples, dtype=np.int64).reshape(-1, 3)

    @cached_property
    def outer_angles(self) -> Floats:
        """The angles of the triangles of `outer`, (b, 3)."""
        return corner_angles(self.outer_sides)

    @cached_property
    def outer_sides(self) -> Floats:
        p = self.points[self.outer]
        sides: Floats = np.roll(p, -2, axis=1) - np.roll(p, -1, axis=1)
        return sides

    # Neighbours.

    def matrix(self, rows: npt.ArrayLike, columns: npt.ArrayLike, values: npt.ArrayLike) -> Csr:
        """The (n, n) matrix of these entries; equal places are added."""
        from scipy.sparse import csr_matrix

        flat = [np.asarray(x).reshape(-1) for x in (values, rows, columns)]
        return csr_matrix((flat[0], (flat[1], flat[2])), shape=(self.n, self.n))

    @cached_property
    def by_faces(self) -> Csr:
        """The number of faces at each edge, symmetric, (n, n)."""
        a, b = self.faces, np.roll(self.faces, -1, axis=1)
        return self.matrix([a, b], [b, a], np.ones((2, *a.shape)))

    @cached_property
    def adjacency(self) -> Csr:
        matrix = self.by_faces.copy()
        matrix.data[:] = 1.0
        return matrix

    @cached_property
    def degree(self) -> Floats:
        return np.asarray(self.adjacency.sum(axis=1)).reshape(-1).astype(np.float64)

    def diagonal(self, values: Floats) -> Csr:
        from scipy.sparse import csr_matrix

        places = np.arange(self.n + 1, dtype=np.int32)
        return csr_matrix((values, places[:-1], places), shape=(self.n, self.n))

    def weighted(self, corner_weights: Floats, faces: Integers | None = None) -> Csr:
        """Row sums minus weights, each corner's weight on the opposite edge: D - W."""
        faces = self.faces if faces is None else faces
        a, b = np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)
        weights = self.matrix([a, b], [b, a], [corner_weights, corner_weights])
        return self.with_row_sums(weights)

    def with_row_sums(self, weights: Csr) -> Csr:
        sums = np.asarray(weights.sum(axis=1)).reshape(-1)
        return (self.diagonal(sums) - weights).tocsr()

    def stiffness(self, weights: str = "cotangent") -> Csr:
        """D - W of these weights: the cotangent stiffness, a variant of it, or a graph."""
        return self.remember(("stiffness", weights), lambda: self._stiffness(weights))

    def _stiffness(self, weights: str) -> Csr:
        if weights == "cotangent":
            return self.mesh.laplacian("cotangent").stiffness
        if weights == "absolute":
            return self.weighted(np.abs(self.cotangents) / 2)
        if weights == "clamped":
            return self.weighted(np.maximum(self.cotangents, 0) / 2)
        if weights == "tangent":
            return self.weighted(np.tan(self.angles) / 2)
        if weights == "swapped":
            return self.weighted(np.roll(self.cotangents, 1, axis=1) / 2)
        if weights == "ends":
            return self.weighted(
                (np.roll(self.cotangents, 1, axis=1) + np.roll(self.cotangents, 2, axis=1)) / 2
            )
        if weights == "one side":
            return self.with_row_sums(self._one_side())
        if weights == "lengths":
            inverse = self.adjacency.copy().tocoo()
            inverse.data = 1 / np.linalg.norm(self.points[inverse.row] - self.points[inverse.col], axis=1)
            return self.with_row_sums(inverse.tocsr())
        if weights == "faces":
            return self.with_row_sums(self.by_faces)
        if weights == "uniform":
            return self.with_row_sums(self.adjacency)
        return (self.stiffness() + self._outer_stiffness(weights)).tocsr()

    def _one_side(self) -> Csr:
        """Half the cotangent of one of the two angles of each edge, that of the first face."""
        a, b = np.roll(self.faces, -1, axis=1), np.roll(self.faces, -2, axis=1)
        keys = np.minimum(a, b) * self.n + np.maximum(a, b)
        _, first = np.unique(keys.reshape(-1), return_index=True)
        rows, columns = a.reshape(-1)[first], b.reshape(-1)[first]
        values = self.cotangents.reshape(-1)[first] / 2
        return self.matrix([rows, columns], [columns, rows], [values, values])

    def _outer_stiffness(self, weights: str) -> Csr:
        """The part that triangles outside of the border add."""
        if not len(self.outer):
            raise ValueError("the mesh has no border")
        before, own, after = self.outer.T
        cotangents = 0.5 / np.tan(self.outer_angles)
        if weights == "outer triangles":
            return self.weighted(cotangents, self.outer)
        if weights == "outer ring":
            rows, columns = [own, own], [after, before]
            return self.with_row_sums(self.matrix(rows, columns, [cotangents[:, 0], cotangents[:, 2]]))
        if weights == "outer next":
            ends, values = (before, own), cotangents[:, 2]
        elif weights == "outer previous":
            ends, values = (own, after), cotangents[:, 0]
        else:  # "outer loop": cotangent between the sides before and after along the border
            follow = {int(v): int(w) for _, v, w in self.outer}
            last = np.array([follow.get(int(w), int(w)) for w in after], dtype=np.int64)
            p = self.points
            u, v = p[own] - p[before], p[after] - p[last]
            ends = (own, after)
            values = (u * v).sum(axis=1) / np.linalg.norm(np.cross(u, v), axis=1) / 2
        return self.with_row_sums(self.matrix([ends[0], ends[1]], [ends[1], ends[0]], [values, values]))

    # Areas.

    def area(self, kind: str = "mixed") -> Floats:
        """An area of each vertex, (n,): standard ones from `Mesh.laplacian`, or a variant."""
        values: Floats = self.remember(("area", kind), lambda: self._area(kind))
        return values

    def _area(self, kind: str) -> Floats:
        if kind in ("barycentric", "mixed", "voronoi"):
            weights: Any = "uniform" if kind == "barycentric" else "cotangent"
            mass: Any = kind
            found: Floats = self.mesh.laplacian(weights, mass).mass.diagonal()
            return found
        thirds = np.repeat(self.face_areas[:, None], 3, axis=1) / 3
        if kind in ("last face", "first face"):
            order = slice(None) if kind == "last face" else slice(None, None, -1)
            values = np.zeros(self.n)
            values[self.faces[order]] = thirds[order]
            return values
        if kind == "components":
            return self.gather(np.repeat(self.cross.sum(axis=1)[:, None], 3, axis=1) / 6)
        if kind == "absolute components":
            return self.gather(np.repeat(np.abs(self.cross).sum(axis=1)[:, None], 3, axis=1) / 6)
        if kind == "absolute voronoi":
            squares = (self.sides**2).sum(axis=2) * np.abs(self.cotangents) / 8
            return self.gather(np.roll(squares, 1, axis=1) + np.roll(squares, 2, axis=1))
        if kind.startswith("outer") and not len(self.outer):
            raise ValueError("the mesh has no border")
        outer = np.linalg.norm(np.cross(self.outer_sides[:, 2], self.outer_sides[:, 1]), axis=1) / 6
        if kind == "outer own":
            corners = np.zeros((len(outer), 3))
            corners[:, 1] = outer
        elif kind == "outer all":
            corners = np.repeat(outer[:, None], 3, axis=1)
        elif kind == "mean":
            counts = np.asarray(self.by_faces.sum(axis=1)).reshape(-1) / 2
            return 3 * self.area("barycentric") / np.maximum(counts, 1)
        elif kind == "degree":
            return self.degree
        else:
            raise ValueError(f"there is no area {kind}")
        return self.area("barycentric") + self.gather(corners, self.outer)

    # Normals and angles at vertices.

    def normal_sum(self, weight: str) -> Floats:
        """Weighted sums of face normals, (n, 3), not normalised."""
        sums: Floats = self.remember(("normal", weight), lambda: self._normal_sum(weight))
        return sums

    def _normal_sum(self, weight: str) -> Floats:
        unit = np.repeat(self.face_normals[:, None], 3, axis=1)
        lengths = np.linalg.norm(self.sides, axis=2)
        ends = np.roll(lengths, 1, axis=1) * np.roll(lengths, 2, axis=1)
        factors = {
            "area": np.repeat(self.face_areas[:, None], 3, axis=1),
            "angle": self.angles,
            "uniform": np.ones_like(self.angles),
            # Max 1999: sin over the lengths of both sides, exact on spheres.
            "sphere": np.sin(self.angles) / ends,
            "inverse lengths": 1 / ends,
            "squared area": np.repeat(self.face_areas[:, None] ** 2, 3, axis=1),
            "inverse area": np.repeat(1 / self.face_areas[:, None], 3, axis=1),
        }
        if weight in factors:
            return self.gather(unit * factors[weight][:, :, None])
        order = slice(None) if weight == "last face" else slice(None, None, -1)
        values = np.zeros((self.n, 3))
        values[self.faces[order]] = unit[order]
        return values

    @cached_property
    def angle_sum(self) -> Floats:
        return self.gather(self.angles)

    @cached_property
    def outer_angle(self) -> Floats:
        """The angle at each border vertex between its two neighbours along the border."""
        corners = np.zeros_like(self.outer_angles)
        corners[:, 1] = self.outer_angles[:, 1]
        return self.gather(corners, self.outer)

    @cached_property
    def dihedral_sum(self) -> Floats:
        """Sum of length times signed dihedral angle of the inner edges at each vertex."""
        a, b = np.roll(self.faces, -1, axis=1), np.roll(self.faces, -2, axis=1)
        face = np.repeat(np.arange(len(self.faces))[:, None], 3, axis=1)
        owner = {(int(i), int(j)): int(f) for i, j, f in zip(a.flat, b.flat, face.flat)}
        pairs = [(i, j, f, owner[(j, i)]) for (i, j), f in owner.items() if i < j and (j, i) in owner]
        total: Floats = np.zeros(self.n)
        if not pairs:
            return total
        i, j, f, g = np.array(pairs, dtype=np.int64).T
        along = self.points[j] - self.points[i]
        length = np.linalg.norm(along, axis=1)
        one, two = self.face_normals[f], self.face_normals[g]
        sines = (np.cross(one, two) * along).sum(axis=1) / length
        values = np.arctan2(sines, (one * two).sum(axis=1)) * length
        np.add.at(total, i, values)
        np.add.at(total, j, values)
        return total


def corner_angles(sides: Floats) -> Floats:
    """The angle at each corner of triangles given by their sides, (m, 3)."""
    u, v = -np.roll(sides, 1, axis=1), np.roll(sides, 2, axis=1)
    sines = np.linalg.norm(np.cross(u, v), axis=2)
    angles: Floats = np.arctan2(sines, (u * v).sum(axis=2))
    return angles
