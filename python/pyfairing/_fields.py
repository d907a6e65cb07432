"""Fields of vertices and faces: checked, sorted for files, and taken from other packages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._calls import call, warn

Element = Literal["vertex", "face"]
_NAMES = {"vertex": "field", "face": "face field"}


def named(fields: Mapping[str, npt.NDArray[Any]]) -> _core.Named:
    """Scalars, vectors and colours."""
    scalars = [(name, values) for name, values in fields.items() if values.ndim == 1]
    vectors = [(name, values) for name, values in fields.items() if values.ndim == 2 and name != "colors"]
    return scalars, vectors, fields.get("colors")


def checked(
    fields: Mapping[str, npt.ArrayLike], n: int, of: Element = "vertex"
) -> dict[str, npt.NDArray[Any]]:
    """Read-only fields of n vertices or faces."""
    return {str(name): _checked(str(name), values, n, of) for name, values in fields.items()}


def _checked(name: str, values: npt.ArrayLike, n: int, of: Element) -> npt.NDArray[Any]:
    what, shapes = f"the {_NAMES[of]} {name}", _shapes(name, n, of)
    array: npt.NDArray[Any]
    if name == "colors":
        array = np.asarray(values)
        if array.dtype != np.uint8 or array.shape not in shapes:
            raise _core.OptionError(
                f"colors are {array.dtype} of shape {array.shape}, but must be uint8 of ({n}, 3)"
            )
    else:
        array = _arrays.floats(values, what)
        if array.shape not in shapes:
            wanted = " or ".join(map(str, shapes))
            raise _core.OptionError(f"{what} has the shape {array.shape}, but must have {wanted}")
    if not array.flags.writeable and array.flags.c_contiguous:
        return array
    _arrays.finite(array, what)
    return _arrays.frozen(np.array(array, order="C"))


def _shapes(name: str, n: int, of: Element) -> list[tuple[int, ...]]:
    """The shapes that a field may have."""
    if name == "colors":
        return [(n, 3)]
    return [(n, 3, 2)] if name == "texture" and of == "face" else [(n,), (n, 3)]


def from_object(
    source: Any,
) -> tuple[_core.Mesh, Mapping[str, npt.ArrayLike], Mapping[str, npt.ArrayLike]]:
    """The mesh in an object of another package, and its fields of vertices and of faces."""
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        core = _core.Mesh(_arrays.vertices(source.vertices), _arrays.faces(source.faces))
        return core, _colors_of_trimesh(source, core.vertex_count), {}
    if hasattr(source, "points") and hasattr(source, "cells"):
        return _from_meshio(source)
    raise TypeError(
        f"a mesh is made of vertices and faces, or of an object that has them, not of {type(source).__name__}"
    )


def _colors_of_trimesh(source: Any, n: int) -> dict[str, npt.ArrayLike]:
    visual: Any = getattr(source, "visual", None)
    if getattr(visual, "kind", None) != "vertex":
        return {}
    colors = np.asarray(visual.vertex_colors)
    return {"colors": np.ascontiguousarray(colors[:, :3])} if colors.shape[:1] == (n,) else {}


def _from_meshio(
    source: Any,
) -> tuple[_core.Mesh, Mapping[str, npt.ArrayLike], Mapping[str, npt.ArrayLike]]:
    polygons: list[Any] = []
    skipped = set()
    used = []
    for i, block in enumerate(source.cells):
        if block.type in ("triangle", "quad", "polygon"):
            polygons.extend(block.data)
            used.append(i)
        else:
            skipped.add(block.type)
    if skipped:
        warn(f"cells that are no faces are left out: {', '.join(sorted(skipped))}")
    points = np.asarray(source.points)
    if points.ndim == 2 and points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    fields = _kept(getattr(source, "point_data", None) or {}, len(points), "vertex")
    cells = {
        name: np.concatenate([np.asarray(blocks[i]) for i in used])
        for name, blocks in (getattr(source, "cell_data", None) or {}).items()
        if used
    }
    if all(len(p) == 3 for p in polygons):
        triangles = np.asarray(polygons) if polygons else np.zeros((0, 3), np.uint32)
        core = _core.Mesh(_arrays.vertices(points), _arrays.faces(triangles))
        return core, fields, _kept(cells, len(triangles), "face")
    if cells:
        warn(f"the fields of polygons are left out: {', '.join(cells)}")
    corners, sizes = _arrays.polygons(polygons)
    return _core.from_polygons(_arrays.vertices(points), corners, sizes, call()), fields, {}


def _kept(fields: Mapping[str, Any], n: int, of: Element) -> dict[str, npt.ArrayLike]:
    """The fields that a mesh can hold; a warning names the others."""
    kept: dict[str, npt.ArrayLike] = {}
    for name, values in fields.items():
        array = np.asarray(values)
        numbers = array.dtype == np.uint8 if name == "colors" else array.dtype.kind in "fiu"
        if numbers and array.shape in _shapes(name, n, of) and np.isfinite(array).all():
            kept[name] = array
        else:
            warn(f"the {_NAMES[of]} {name} is left out: {array.dtype} of shape {array.shape}")
    return kept


def by_name(given: _core.Named) -> dict[str, npt.ArrayLike]:
    scalars, vectors, colors = given
    fields: dict[str, npt.ArrayLike] = {n: _arrays.frozen(v) for n, v in [*scalars, *vectors]}
    if colors is not None:
        fields["colors"] = _arrays.frozen(colors)
    return fields
