"""The mesh."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike, fspath
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _arrays, _computing, _core, _diffusion, _exchange, _fields, _geodesic, _moving, _parts, _pictures
from ._arrays import Bools, Floats, Indices, Unsigned
from ._calls import Progress, call, warn
from ._checks import warn_of_orientation
from ._docs import documented
from ._elements import Elements
from ._fields import Fields

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._core import FileFields
    from ._core import Mesh as CoreMesh


class Mesh(Elements):
    """An immutable triangle mesh.

    Parameters
    ----------
    vertices : array_like, shape (n, 3) or (n, 2)
        Positions, in mesh units; in a plane with z = 0. Or, without `faces`, a whole mesh: a `Mesh`, a tuple
        `(vertices, faces)`, a tuple of napari `(vertices, faces, values)`, or a mesh of PyVista
        (`PolyData`), Open3D (`TriangleMesh`), vedo, trimesh or meshio, whose numbers are copied
        once. Its polygons are kept, and its data becomes fields if it has one or three numbers
        for each vertex or face; a warning names the rest.
    faces : array_like of int, shape (m, 3), optional
        Corners, counter-clockwise seen from outside, numbered from 0.
    fields : mapping of str to array_like, optional
        Vertex data of shape (n,), (n, 3), or (n, 3) of uint8 under the name `colors`.
    face_fields : mapping of str to array_like, optional
        Face data of shape (m,), (m, 3), (m, 3) of uint8 under the name `colors`, or (m, 3, 2) under
        the name `texture`: the texture coordinates of the corners.

    Raises
    ------
    MeshError
        For the first invalid vertex or face: a coordinate that is not finite, an index of a vertex
        that does not exist, a face that repeats a corner.

    Notes
    -----
    All other defects are allowed: isolated vertices, faces without area, edges of three faces.
    Vertices and faces keep their order. A mesh can be pickled, compared and hashed.

    Examples
    --------
    >>> import pyfairing as pf
    >>> mesh = pf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> mesh
    Mesh(3 vertices, 1 face)
    >>> mesh.vertices.shape
    (3, 3)
    """

    __slots__ = ("__weakref__", "_core", "_face_fields", "_faces", "_fields", "_hash", "_report")

    _core: CoreMesh
    _fields: dict[str, npt.NDArray[Any]]
    _face_fields: dict[str, npt.NDArray[Any]]
    _report: Mapping[str, Any]
    _hash: int | None
    _faces: Indices | None

    def __init__(
        self,
        vertices: Any,
        faces: npt.ArrayLike | None = None,
        fields: Mapping[str, npt.ArrayLike] | None = None,
        face_fields: Mapping[str, npt.ArrayLike] | None = None,
    ) -> None:
        own: Mapping[str, npt.ArrayLike] = {}
        own_of_faces: Mapping[str, npt.ArrayLike] = {}
        if faces is None and isinstance(vertices, Mesh):
            core, own, own_of_faces = vertices._core, vertices._fields, vertices._face_fields
        elif faces is None:
            core, own, own_of_faces = _exchange.from_object(vertices)
        else:
            core = _core.Mesh(_arrays.vertices(vertices, planar=True), _arrays.faces(faces))
        self._fill(core, {**own, **(fields or {})}, {**own_of_faces, **(face_fields or {})}, {})

    def _fill(
        self,
        core: CoreMesh,
        fields: Mapping[str, npt.ArrayLike],
        face_fields: Mapping[str, npt.ArrayLike],
        report: Mapping[str, Any],
    ) -> None:
        parts = {
            "_core": core,
            "_fields": _fields.checked(fields, core.vertex_count),
            "_face_fields": _fields.checked(face_fields, core.face_count, "face"),
            "_report": MappingProxyType(dict(report)),
            "_hash": None,
            "_faces": None,
        }
        for name, part in parts.items():
            object.__setattr__(self, name, part)

    @classmethod
    def _of(
        cls,
        core: CoreMesh,
        fields: Mapping[str, npt.ArrayLike] | None = None,
        report: Mapping[str, Any] | None = None,
        face_fields: Mapping[str, npt.ArrayLike] | None = None,
    ) -> Self:
        mesh = cls.__new__(cls)
        mesh._fill(core, fields or {}, face_fields or {}, report or {})
        return mesh

    def _moved(self, core: CoreMesh, report: Mapping[str, Any] | None = None) -> Self:
        """A mesh at other positions, with its fields except normals, which depend on them."""
        kept, of_faces = (
            {name: values for name, values in fields.items() if name != "normal"}
            for fields in (self._fields, self._face_fields)
        )
        return self._of(core.with_statements_of(self._core), kept, report, of_faces)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a mesh never changes: {name} cannot be set")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"a mesh never changes: {name} cannot be deleted")

    @classmethod
    def from_polygons(
        cls,
        vertices: npt.ArrayLike,
        polygons: Any,
        fields: Mapping[str, npt.ArrayLike] | None = None,
    ) -> Self:
        """Builds a mesh from polygons, which are split into triangles.

        Parameters
        ----------
        vertices : array_like, shape (n, 3) or (n, 2)
            Positions, in mesh units; in a plane with z = 0.
        polygons : sequence of sequences of int, or array_like of int, shape (m, k)
            The corners of each polygon, counter-clockwise seen from outside.
        fields : mapping of str to array_like, optional
            Data of the vertices.

        Returns
        -------
        Mesh
            Its triangles in the order of the polygons, which it keeps (`polygons`).
        """
        corners, sizes = _arrays.polygons(*_arrays.flat(polygons))
        core = _core.from_polygons(_arrays.vertices(vertices, planar=True), corners, sizes, call())
        return cls._of(core, fields)

    @property
    def vertices(self) -> Floats:
        """Positions in mesh units, (n, 3) float64: a view, not writeable."""
        return self._core.vertices

    @property
    def faces(self) -> Indices:
        """Corners, (m, 3) int64, counter-clockwise seen from outside: converted once, not writeable."""
        if self._faces is None:
            object.__setattr__(self, "_faces", _arrays.frozen(self._core.faces.astype(np.int64)))
        assert self._faces is not None
        return self._faces

    @property
    def polygons(self) -> list[Indices] | None:
        """The polygons that `faces` were split from, as `from_polygons` takes them.

        None if all faces are triangles. A polygon of n corners has n - 2 faces, in the order of
        the polygons. Meshes that differ in positions or fields share them, and files get them
        if the format holds polygons; operations that change faces (`repair`, `subdivide`,
        `submesh`) drop them.
        """
        found = self._core.polygons()
        if found is None:
            return None
        corners, sizes = found
        return np.split(corners.astype(np.int64), np.cumsum(sizes)[:-1])

    @property
    def fields(self) -> Fields:
        """Vertex data by name, in the order of the file: writeable copies, which leave the mesh as it is.

        `mesh.fields.view(name)` is the array itself, without a copy and not writeable.

        Scalar fields are (n,) float64, vector fields (n, 3) float64 (vertex normals of a file
        are `normal`), and `colors` is (n, 3) uint8.
        """
        return Fields(self._fields)

    @property
    def face_fields(self) -> Fields:
        """Face data by name, in the order of the file: copies, as in `fields`.

        Scalar fields are (m,) float64, vector fields (m, 3) float64 (face normals of a file are
        `normal`), `colors` is (m, 3) uint8, and `texture` (m, 3, 2) float64, the texture
        coordinates of the corners of each face.
        """
        return Fields(self._face_fields)

    @property
    def report(self) -> Mapping[str, Any]:
        """Report of the operation that made the mesh: a reader, a flow, a scan or a denoiser."""
        return self._report

    @property
    def n_vertices(self) -> int:
        """The number of vertices, isolated ones included."""
        return self._core.vertex_count

    @property
    def n_faces(self) -> int:
        """The number of faces."""
        return self._core.face_count

    @property
    def mean_edge_length(self) -> float:
        """h: the mean side length of the faces, in mesh units; an edge counts once for each face."""
        return self._core.mean_edge_length

    @property
    def diagonal(self) -> float:
        """The diagonal of the bounding box, in mesh units."""
        return self._core.diagonal

    @property
    def edges(self) -> Indices:
        """Each edge once, (e, 2) int64, the lower number first."""
        return self._core.edges(call()).astype(np.int64)

    @property
    def boundary_vertices(self) -> Bools:
        """A mask of the boundary vertices, (n,) bool."""
        return self._core.boundary_vertices(call())

    @property
    def area(self) -> float:
        """The sum of the areas of the faces, in squared mesh units."""
        return self._core.area

    @property
    def volume(self) -> float | None:
        """The enclosed volume, in cubed mesh units: negative if normals point inwards, None if open."""
        volume: float | None = self.info()["volume"]
        return volume

    @property
    def face_areas(self) -> Floats:
        """The area of each face, (m,) float64, in squared mesh units."""
        return self._core.face_areas(call())

    @property
    def face_normals(self) -> Floats:
        """The outward unit normal of each face, (m, 3) float64; NaN for faces without area.

        Faces that disagree with the rest of their part are flipped for the computation, with a
        `FairingWarning`.
        """
        warn_of_orientation(self._core)
        return _arrays.unit_or_nan(self._core.face_normals(call()))

    def with_vertices(self, vertices: npt.ArrayLike) -> Self:
        """The same faces at other positions; data that depends on faces alone is shared.

        Parameters
        ----------
        vertices : array_like, shape (n, 3) or (n, 2)
            Positions, in mesh units; in a plane with z = 0.

        Returns
        -------
        Mesh
            With the same fields except normals, which depend on the positions.
        """
        return self._moved(self._core.with_vertices(_arrays.vertices(vertices, planar=True)))

    def with_fields(self, fields: Mapping[str, npt.ArrayLike] | None = None, **more: npt.ArrayLike) -> Self:
        """The same mesh with more vertex data; fields of the same names are replaced.

        Parameters
        ----------
        fields : mapping of str to array_like, optional
            Shape (n,), (n, 3), or (n, 3) of uint8 under the name `colors`.
        **more : array_like
            Fields as keyword arguments.

        Returns
        -------
        Mesh
            Shares the vertices and faces of this mesh.
        """
        given = {**self._fields, **(fields or {}), **more}
        return self._of(self._core, given, self._report, self._face_fields)

    def with_face_fields(
        self, fields: Mapping[str, npt.ArrayLike] | None = None, **more: npt.ArrayLike
    ) -> Self:
        """The same mesh with more face data; fields of the same names are replaced.

        Parameters
        ----------
        fields : mapping of str to array_like, optional
            Shape (m,), (m, 3), (m, 3) of uint8 under the name `colors`, or (m, 3, 2) under the name
            `texture`.
        **more : array_like
            Fields as keyword arguments.

        Returns
        -------
        Mesh
            Shares the vertices and faces of this mesh.
        """
        given = {**self._face_fields, **(fields or {}), **more}
        return self._of(self._core, self._fields, self._report, given)

    @documented
    def write(
        self,
        path: str | PathLike[str],
        *,
        ascii: bool = False,
        width: str = "lossless",
        threads: int | None = None,
        progress: Progress = None,
    ) -> None:
        """Writes the mesh with its fields, whole or not at all.

        Parameters
        ----------
        path : str or path
            Ends in .obj, .ply, .off, .stl, .vtp or .glb, optionally followed by .gz. PLY
            holds all fields; what a format cannot hold is left out, with a warning.
        ascii : bool
            Text instead of binary, for formats that have both.
        width : {'lossless', 'double', 'single'}
            Width of numbers in PLY and VTP files: 32 bits if nothing is lost, 64, or 32.
        {run}

        Raises
        ------
        OSError
            If the system cannot write the file.
        OptionError
            If the format cannot hold the mesh, or the file extension is unknown.
        """
        dropped, notes = self._core.write(
            fspath(path), self._file_fields(), ascii, width, call(threads, progress)
        )
        if dropped:
            warn(f"{fspath(path)}: the format cannot hold {', '.join(dropped)}")
        for note in notes:
            warn(f"{fspath(path)}: {note}")

    def to_bytes(self, format: str = "ply", *, ascii: bool = False, width: str = "lossless") -> bytes:
        """The content of the file that `write` writes.

        Parameters
        ----------
        format : {'ply', 'obj', 'off', 'stl', 'vtp', 'glb'}
            The format, not compressed. Fields that it cannot hold are left out.
        ascii : bool
            Text instead of binary, for formats that have both.
        width : {'lossless', 'double', 'single'}
            Width of numbers in PLY and VTP files.

        Returns
        -------
        bytes
        """
        return self._core.to_bytes(format, self._file_fields(), ascii, width, call())

    def _file_fields(self) -> FileFields:
        texture = self._face_fields.get("texture")
        flat = None if texture is None else texture.reshape(-1, 2)
        return _fields.named(self._fields), _fields.named(self._face_fields), flat

    # Methods by topic: each is documented where it is defined.

    laplacian = _computing.laplacian
    gradient = _computing.gradient
    divergence = _computing.divergence
    vertex_normals = _computing.vertex_normals
    curvature = _computing.curvature
    spectrum = _computing.spectrum
    diffusion_operators = _diffusion.diffusion_operators
    heat = _computing.heat
    poisson = _computing.poisson
    info = _computing.info

    geodesic_distance = _geodesic.geodesic_distance
    geodesic_path = _geodesic.geodesic_path
    isolines = _geodesic.isolines

    smooth = _moving.smooth
    noise = _moving.noise
    scan = _moving.scan
    noise_level = _moving.noise_level
    denoise = _moving.denoise
    subdivide = _moving.subdivide

    repair = _parts.repair
    weld = _parts.weld
    components = _parts.components
    submesh = _parts.submesh
    closest = _parts.closest

    to_pyvista = _exchange.to_pyvista
    to_open3d = _exchange.to_open3d
    to_trimesh = _exchange.to_trimesh
    to_meshio = _exchange.to_meshio

    render = _pictures.render
    show = _pictures.show
    _repr_html_ = _pictures.repr_html

    def __repr__(self) -> str:
        n, m = self.n_vertices, self.n_faces
        text = f"{n} {'vertex' if n == 1 else 'vertices'}, {m} {'face' if m == 1 else 'faces'}"
        if self._fields:
            text += f", fields {', '.join(self._fields)}"
        if self._face_fields:
            text += f", face fields {', '.join(self._face_fields)}"
        return f"Mesh({text})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        return self._core.same(other._core)

    def __hash__(self) -> int:
        if self._hash is None:
            value = hash((self.vertices.tobytes(), self._core.faces.tobytes()))
            object.__setattr__(self, "_hash", value)
        assert self._hash is not None
        return self._hash

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: object) -> Self:
        return self

    def __reduce__(self) -> Any:
        arrays = (np.array(self.vertices), np.array(self._core.faces))
        of_faces = (self._core.polygons(), self._core.statements())
        parts = (*arrays, self._fields, dict(self._report), self._face_fields, *of_faces)
        return _restored, (type(self), *parts)

    def __dask_tokenize__(self) -> Any:
        own = (self.vertices, self._core.faces, self._core.polygons(), self._core.statements())
        return ("pyfairing.Mesh", *own, dict(self._fields), dict(self._face_fields))


def _restored(
    cls: type[Mesh],
    vertices: Floats,
    faces: Unsigned,
    fields: Mapping[str, npt.ArrayLike],
    report: Mapping[str, Any],
    face_fields: Mapping[str, npt.ArrayLike],
    polygons: list[Unsigned] | None = None,
    statements: list[tuple[int, str, bytes]] | None = None,
) -> Mesh:
    core = _core.Mesh(vertices, faces)
    if polygons is not None:
        core = core.with_polygons(*polygons)
    if statements:
        core = core.with_statements(statements)
    return cls._of(core, fields, report, face_fields)


@documented
def read(
    path: str | PathLike[str],
    *,
    strict: bool = False,
    drop_broken: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Mesh:
    """Reads a mesh with its vertex fields.

    Parameters
    ----------
    path : str or path
        An OBJ, PLY, OFF, STL, VTP or GLB (or glTF) file, plain or compressed with gzip; content and file
        extension decide.
    strict : bool
        Raise an error instead of leaving out content with a warning, such as faces that repeat a
        corner.
    drop_broken : bool
        Leave out faces with a vertex that is missing or not finite, with a warning, instead of
        refusing the file. Such a vertex keeps its index, belongs to no face and moves to the first
        valid position.
    {run}

    Returns
    -------
    Mesh
        Vertices in the order of the file, isolated ones included; polygons are split into
        triangles. `Mesh.report` lists content that was split, reduced or left out; a warning
        names it.

    Raises
    ------
    OSError
        If the system cannot read the file.
    MeshError
        For an invalid file; the message names the line or byte and the value.
    """
    name = fspath(path)
    parts = _core.read(name, bool(strict), bool(drop_broken), call(threads, progress))
    return _with_warnings(parts, name)


def read_bytes(
    data: bytes,
    name: str | PathLike[str] = "",
    *,
    strict: bool = False,
    drop_broken: bool = False,
) -> Mesh:
    """Reads a mesh from the bytes of a file.

    Parameters
    ----------
    data : bytes
        The content.
    name : str or path
        Used for its file extension and in messages; may be empty.
    strict, drop_broken : bool
        As in `read`.

    Returns
    -------
    Mesh
    """
    parts = _core.read_bytes(fspath(name), bytes(data), bool(strict), bool(drop_broken), call())
    return _with_warnings(parts, fspath(name))


def _with_warnings(parts: Any, name: str) -> Mesh:
    core, of_vertices, of_faces, texture, report = parts
    fields, face_fields = _fields.by_name(of_vertices), _fields.by_name(of_faces)
    if texture is not None:
        face_fields["texture"] = _arrays.frozen(texture.reshape(-1, 3, 2))
    counts = ("polygons", "reduced_faces", "left_out_faces", "broken_vertices", "broken_faces")
    if any(report[name] for name in (*counts, "notes")):
        warn(f"{name}: {report['text']}".strip())
    return Mesh._of(core, fields, report, face_fields)
