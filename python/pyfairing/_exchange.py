"""Meshes of other packages: taken by their attributes, and made by methods of `Mesh`."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _arrays, _core, _fields
from ._arrays import Indices
from ._calls import call, warn

if TYPE_CHECKING:
    from ._mesh import Mesh

_Given: TypeAlias = "Mapping[str, npt.ArrayLike]"
_Parts: TypeAlias = "tuple[_core.Mesh, _Given, _Given]"

#: Names of our fields in VTK and its readers, and in Open3D's meshes of tensors.
_VTK = {"normal": "Normals", "colors": "RGB"}
_OPEN3D = {"normal": "normals", "texture": "texture_uvs"}


def from_object(source: Any) -> _Parts:
    """The mesh in an object of another package, and its fields of vertices and of faces."""
    name = type(source).__name__
    if isinstance(source, tuple):
        if len(source) not in (2, 3):
            raise TypeError(
                f"a tuple is (vertices, faces) or (vertices, faces, values), not of {len(source)}"
            )
        core = _core.Mesh(_arrays.vertices(source[0], planar=True), _arrays.faces(source[1]))
        return core, {"values": values for values in source[2:]}, {}
    for attributes, taken in (
        (("vertex", "triangle"), _of_tensors),
        (("points", "faces", "strips"), _of_pyvista),
        (("vertices", "faces"), _of_trimesh),
        (("vertices", "triangles"), _of_open3d),
        (("vertices", "cells"), _of_vedo),
        (("points", "cells"), _of_meshio),
    ):
        if all(hasattr(source, attribute) for attribute in attributes):
            return taken(source)
    raise TypeError(f"a mesh is made of vertices and faces, or of an object that has them, not of {name}")


def _of_open3d(source: Any) -> _Parts:
    fields = {"normal": source.vertex_normals, "colors": _bytes(source.vertex_colors)}
    texture = np.asarray(source.triangle_uvs).reshape(-1, 3, 2)
    of_faces = {"normal": source.triangle_normals, "texture": texture}
    present = [{n: v for n, v in given.items() if len(v)} for given in (fields, of_faces)]
    return _made(source.vertices, *_arrays.flat(np.asarray(source.triangles)), *present)


def _of_tensors(source: Any) -> _Parts:
    """Of the new mesh of Open3D, with all its attributes."""
    fields, of_faces = (
        _named({name: values.cpu().numpy() for name, values in data.items()}, _OPEN3D)
        for data in (source.vertex, source.triangle)
    )
    for given in (fields, of_faces):
        if "colors" in given:
            given["colors"] = _bytes(given["colors"])
    positions = fields.pop("positions", np.zeros((0, 3)))
    triangles = of_faces.pop("indices", np.zeros((0, 3), np.int64))
    return _made(positions, *_arrays.flat(triangles), fields, of_faces)


def _bytes(colors: Any) -> npt.NDArray[Any]:
    """Colours from 0 to 255, of such or of numbers from 0 to 1."""
    array = np.asarray(colors)
    return array if array.dtype == np.uint8 else np.rint(255 * np.clip(array, 0, 1)).astype(np.uint8)


def _of_pyvista(source: Any) -> _Parts:
    other = source.n_verts + source.n_lines
    if other:
        warn(f"cells that are no faces are left out: {other} vertices and lines")
    polygons = _unpacked(source.faces)
    corners, sizes = _arrays.flat(polygons)
    strips = _unpacked(source.strips)
    # Every second triangle of a strip turns the other way.
    triangles = [
        strip[[i + 1, i, i + 2] if i % 2 else [i, i + 1, i + 2]]
        for strip in strips
        for i in range(len(strip) - 2)
    ]
    cells = np.repeat(
        np.arange(len(polygons) + len(strips)), [1] * len(polygons) + [len(strip) - 2 for strip in strips]
    )
    more, of_three = _arrays.flat(triangles)
    data = {name: np.asarray(source.cell_data[name])[other:][cells] for name in source.cell_data.keys()}
    texture = data.get("texture")
    if texture is not None and texture.shape[1:] == (6,):
        data["texture"] = texture.reshape(-1, 3, 2)
    return _made(
        source.points,
        np.concatenate([corners, more]).astype(np.int64),
        np.concatenate([sizes, of_three]),
        _named(source.point_data),
        _named(data),
    )


def _unpacked(cells: Any) -> Any:
    """The cells in an array of VTK, in which their sizes precede their corners."""
    flat = np.asarray(cells)
    step = int(flat[0]) + 1 if flat.size else 4
    if flat.size % step == 0 and (flat[::step] == step - 1).all():
        return flat.reshape(-1, step)[:, 1:]
    found, start = [], 0
    while start < len(flat):
        end = start + 1 + int(flat[start])
        found.append(flat[start + 1 : end])
        start = end
    return found


def _of_trimesh(source: Any) -> _Parts:
    positions, triangles = np.asarray(source.vertices), np.asarray(source.faces)
    fields = dict(getattr(source, "vertex_attributes", None) or {})
    of_faces = dict(getattr(source, "face_attributes", None) or {})
    visual: Any = getattr(source, "visual", None)
    kind = getattr(visual, "kind", None)
    if kind == "vertex":
        fields["colors"] = np.asarray(visual.vertex_colors)[:, :3]
    if kind == "face":
        of_faces["colors"] = np.asarray(visual.face_colors)[:, :3]
    if kind == "texture" and getattr(visual, "uv", None) is not None:
        of_faces["texture"] = np.asarray(visual.uv)[triangles]
    core = _core.Mesh(_arrays.vertices(positions), _arrays.faces(triangles))
    kept = _fields.kept(fields, core.vertex_count, "vertex")
    return core, kept, _fields.kept(of_faces, core.face_count, "face")


def _of_vedo(source: Any) -> _Parts:
    fields, cells = _named(source.pointdata), _named(source.celldata)
    return _made(source.vertices, *_arrays.flat(source.cells), fields, cells)


def _named(data: Any, names: Mapping[str, str] = _VTK) -> dict[str, Any]:
    """Data by our names."""
    ours = {theirs: own for own, theirs in names.items()}
    return {ours.get(str(name), str(name)): data[name] for name in data.keys()}


def _of_meshio(source: Any) -> _Parts:
    if hasattr(source, "extract_surface"):
        raise TypeError(f"{type(source).__name__} is no surface, but what its extract_surface() returns is")
    faces = [i for i, block in enumerate(source.cells) if block.type in ("triangle", "quad", "polygon")]
    skipped = {block.type for i, block in enumerate(source.cells) if i not in faces}
    if skipped:
        warn(f"cells that are no faces are left out: {', '.join(sorted(skipped))}")
    points = np.asarray(source.points)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    empty = np.zeros(0, np.int64)
    blocks = [_arrays.flat(source.cells[i].data) for i in faces] or [(empty, empty)]
    corners, sizes = (np.concatenate(each) for each in zip(*blocks, strict=True))
    cells = {
        name: np.concatenate([np.asarray(of_blocks[i]) for i in faces])
        for name, of_blocks in (getattr(source, "cell_data", None) or {}).items()
        if faces
    }
    return _made(points, corners, sizes, getattr(source, "point_data", None) or {}, cells)


def _made(
    points: Any,
    corners: npt.NDArray[Any],
    sizes: Indices,
    fields: Mapping[str, Any],
    cells: Mapping[str, Any],
) -> _Parts:
    """The mesh of polygons, whose triangles get the data of their polygons."""
    positions = _arrays.vertices(points)
    of_cells = _fields.kept(cells, len(sizes), "face")
    if (sizes == 3).all():
        core = _core.Mesh(positions, _arrays.faces(corners.reshape(-1, 3)))
    else:
        core = _core.from_polygons(positions, *_arrays.polygons(corners, sizes), call())
    of_faces = {name: np.repeat(np.asarray(values), sizes - 2, axis=0) for name, values in of_cells.items()}
    return core, _fields.kept(fields, len(positions), "vertex"), of_faces


def _required(name: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"to_{name} needs {name}: pip install {name}") from error


def _polygons(mesh: Mesh) -> tuple[Indices, Indices, dict[str, npt.NDArray[Any]]]:
    """The corners of all polygons, the number of corners of each, and their data."""
    found = mesh._core.polygons()
    if found is None:
        return mesh.faces.reshape(-1), np.full(mesh.n_faces, 3), dict(mesh.face_fields)
    corners, sizes = (each.astype(np.int64) for each in found)
    first = np.cumsum(sizes - 2) - (sizes - 2)
    data = {name: values[first] for name, values in mesh._face_fields.items()}
    for name, values in mesh._face_fields.items():
        if (np.repeat(data[name], sizes - 2, axis=0) != values).any():
            warn(f"the face field {name} is left out: it differs within polygons")
            del data[name]
    return corners, sizes, data


def to_pyvista(self: Mesh) -> Any:
    """Converts to a `pyvista.PolyData` with its polygons, fields and face fields.

    Returns
    -------
    pyvista.PolyData
        Normals are `Normals`, colours `RGB`, and the texture coordinates of the corners of a
        face six numbers, `texture`. A polygon has the value that its triangles share; a warning
        names face fields that differ within one.
    """
    pyvista = _required("pyvista")
    corners, sizes, data = _polygons(self)
    poly = pyvista.PolyData()
    poly.points = np.array(self.vertices)
    poly.faces = np.insert(corners, np.cumsum(sizes) - sizes, sizes)
    # None of them colours the surface unless asked to.
    for name, values in self.fields.items():
        poly.point_data.set_array(values, _VTK.get(name, name))
    for name, values in data.items():
        poly.cell_data.set_array(
            values.reshape(len(values), -1) if values.ndim > 2 else values, _VTK.get(name, name)
        )
    return poly


def to_open3d(self: Mesh, *, tensor: bool = False) -> Any:
    """Converts to a mesh of Open3D, which has no polygons.

    Parameters
    ----------
    tensor : bool
        Return an `open3d.t.geometry.TriangleMesh`, which holds all fields.

    Returns
    -------
    open3d.geometry.TriangleMesh or open3d.t.geometry.TriangleMesh
        The former has vertex colours, normals and texture coordinates; a warning names other
        fields. Colours are from 0 to 1.

    Raises
    ------
    OptionError
        For fields named `positions`, `indices`, `normals` or `texture_uvs`, which Open3D has.
    """
    o3d = _required("open3d")
    positions, indices = (o3d.core.Tensor(values.copy()) for values in (self.vertices, self.faces))
    made = o3d.t.geometry.TriangleMesh(positions, indices)
    for data, fields in ((made.vertex, self.fields), (made.triangle, self.face_fields)):
        for name, values in fields.items():
            if name in ("positions", "indices", *_OPEN3D.values()):
                raise _core.OptionError(f"Open3D's mesh has {name} of its own: rename the field {name}")
            data[_OPEN3D.get(name, name)] = o3d.core.Tensor(values / 255 if name == "colors" else values)
    if tensor:
        return made
    left_out = [name for name in self.fields if name not in ("colors", "normal")]
    left_out += [f"{name} of faces" for name in self.face_fields if name not in ("texture", "normal")]
    if left_out:
        warn(f"Open3D's mesh cannot hold {', '.join(left_out)}, which that of to_open3d(tensor=True) does")
    return made.to_legacy()


def to_trimesh(self: Mesh) -> Any:
    """Converts to a `trimesh.Trimesh`, which has no polygons; nothing is merged or dropped.

    Returns
    -------
    trimesh.Trimesh
        Colours are its own, other fields are `vertex_attributes` and `face_attributes`.
    """
    trimesh = _required("trimesh")
    fields, of_faces = dict(self.fields), dict(self.face_fields)
    # It has colours of one kind.
    colors = fields.pop("colors", None)
    return trimesh.Trimesh(
        self.vertices.copy(),
        self.faces.copy(),
        process=False,
        vertex_colors=colors,
        face_colors=of_faces.pop("colors", None) if colors is None else None,
        vertex_attributes=fields,
        face_attributes=of_faces,
    )


def to_meshio(self: Mesh) -> Any:
    """Converts to a `meshio.Mesh` with its polygons, fields and face fields.

    Returns
    -------
    meshio.Mesh
        Each run of polygons of one size is a block of cells: their order is kept.
    """
    meshio = _required("meshio")
    corners, sizes, data = _polygons(self)
    ends = [*(np.flatnonzero(np.diff(sizes)) + 1), len(sizes)]
    blocks, starts = [], [0, *ends[:-1]]
    at = np.concatenate([[0], np.cumsum(sizes)])
    for start, end in zip(starts, ends, strict=True):
        size = int(sizes[start]) if end > start else 3
        kind = {3: "triangle", 4: "quad"}.get(size, "polygon")
        blocks.append((kind, corners[at[start] : at[end]].reshape(-1, size)))
    of_cells = {
        name: [values[start:end] for start, end in zip(starts, ends, strict=True)]
        for name, values in data.items()
    }
    return meshio.Mesh(self.vertices.copy(), blocks, dict(self.fields), cell_data=of_cells)
