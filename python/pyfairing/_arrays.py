"""Conversion of arguments to the arrays of the extension."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, Any, SupportsIndex, TypeAlias

import numpy as np
import numpy.typing as npt

from ._core import MeshError, OptionError

if TYPE_CHECKING:
    import scipy.sparse

Floats: TypeAlias = "npt.NDArray[np.float64]"
Indices: TypeAlias = "npt.NDArray[np.int64]"
Bools: TypeAlias = "npt.NDArray[np.bool_]"
#: Indices as the extension has them.
Unsigned: TypeAlias = "npt.NDArray[np.uint32]"
Bytes: TypeAlias = "npt.NDArray[np.uint8]"
Csr: TypeAlias = "scipy.sparse.csr_matrix"

#: The largest index.
_LAST = 2**32 - 1


def floats(values: npt.ArrayLike, name: str) -> Floats:
    """An array of float64, converted from other numbers; anything else raises TypeError."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        given = f"a {type(values).__name__}" if hasattr(values, "toarray") else array.dtype
        raise TypeError(f"{name} must be real numbers, not {given}")
    return np.asarray(array, dtype=np.float64)


def vertices(values: npt.ArrayLike, name: str = "vertices", *, planar: bool = False) -> Floats:
    """An (n, 3) array of float64, row by row; if `planar` also from (n, 2), with z = 0."""
    array = floats(values, name)
    if array.size == 0 and array.ndim < 2:
        array = array.reshape(0, 3)
    if planar and array.ndim == 2 and array.shape[1] == 2:
        array = np.column_stack([array, np.zeros(len(array))])
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"{name} have the shape {array.shape}, but must have (n, 3)")
    return np.ascontiguousarray(array)


def faces(values: npt.ArrayLike) -> Unsigned:
    """An (m, 3) array of uint32, row by row."""
    array = np.asarray(values)
    if array.size == 0:
        array = np.zeros((0, 3), dtype=np.uint32) if array.ndim < 2 else array.astype(np.uint32)
    if array.dtype.kind not in "iu":
        raise TypeError(f"faces must be integers, not {array.dtype}")
    if array.ndim != 2 or array.shape[1] != 3:
        hint = "; for polygons see Mesh.from_polygons" if array.ndim == 2 else ""
        raise MeshError(f"faces have the shape {array.shape}, but must have (m, 3){hint}")
    if array.dtype != np.uint32:
        bad = (array < 0) | (array > _LAST) if array.dtype.itemsize > 4 else array < 0
        if bad.any():
            face = int(np.flatnonzero(bad.any(axis=1))[0])
            index = int(array[face][bad[face]][0])
            raise MeshError(f"face {face} names vertex {index}, which does not exist")
    return np.ascontiguousarray(array, dtype=np.uint32)


def flat(values: Any) -> tuple[npt.NDArray[Any], Indices]:
    """The concatenated corners of all polygons, and the number of corners of each."""
    if isinstance(values, np.ndarray) and values.ndim == 2:
        return values.reshape(-1), np.full(len(values), values.shape[1])
    sizes = [len(polygon) for polygon in values]
    corners = np.concatenate([np.asarray(p) for p in values]) if sizes else np.zeros(0, np.int64)
    return corners, np.asarray(sizes, dtype=np.int64)


def polygons(corners: npt.NDArray[Any], sizes: Indices) -> tuple[Unsigned, Unsigned]:
    """The corners and sizes of polygons as the extension takes them."""
    if corners.dtype.kind not in "iu":
        raise TypeError(f"polygons must be integers, not {corners.dtype}")
    if corners.size and (corners.min() < 0 or corners.max() > _LAST):
        raise MeshError(f"the polygons name vertex {corners.min()} to {corners.max()}")
    return corners.astype(np.uint32), sizes.astype(np.uint32)


def numbers(values: npt.ArrayLike, n: int, what: str, *, of: str = "vertex") -> list[int]:
    """Indices of vertices or faces from one index, several, or a mask over all."""
    array = np.asarray(values)
    if array.dtype.kind == "b":
        if array.shape != (n,):
            raise OptionError(f"{what} is a mask of shape {array.shape}, but must have ({n},)")
        array = np.flatnonzero(array)
    if array.size and array.dtype.kind not in "iu":
        raise TypeError(f"{what} must be integers, not {array.dtype}")
    if array.ndim > 1:
        raise OptionError(f"{what} has the shape {array.shape}, but must be flat")
    flat = [int(i) for i in array.reshape(-1)]
    for index in flat:
        if not 0 <= index < n:
            plural = "vertices" if of == "vertex" else f"{of}s"
            raise OptionError(f"{what} names {of} {index}, but there are {n} {plural}")
    return flat


def field(values: npt.ArrayLike, n: int, name: str, *, constant: bool = False) -> Floats:
    """One finite number per vertex, or a single number if `constant`."""
    array = floats(values, name)
    if constant and array.ndim == 0:
        array = np.full(n, array)
    if array.shape != (n,):
        raise OptionError(f"{name} has the shape {array.shape}, but must have ({n},)")
    finite(array, name)
    return np.ascontiguousarray(array)


def fields(values: npt.ArrayLike, n: int, name: str, *, constant: bool = False) -> tuple[Floats, bool]:
    """Fields as columns of finite numbers, or a single number if `constant`; true for one field."""
    array = floats(values, name)
    if constant and array.ndim == 0:
        array = np.full(n, array)
    if array.ndim not in (1, 2) or len(array) != n:
        raise OptionError(f"{name} has the shape {array.shape}, but must have ({n},) or ({n}, k)")
    return columns(array, name)


def columns(values: npt.ArrayLike, name: str) -> tuple[Floats, bool]:
    """A matrix of finite numbers, and a flag that is true if it was a vector."""
    array = floats(values, name)
    flat = array.ndim == 1
    matrix = array[:, None] if flat else array
    if matrix.ndim != 2:
        raise OptionError(f"{name} has the shape {array.shape}, but must have (n,) or (n, d)")
    finite(matrix, name)
    return np.ascontiguousarray(matrix), flat


def point(values: npt.ArrayLike, name: str) -> list[float]:
    """The coordinates of a point."""
    array = floats(values, name)
    if array.shape != (3,):
        raise OptionError(f"{name} has the shape {array.shape}, but must have (3,)")
    finite(array, name)
    return [float(x) for x in array]


def finite(array: Floats, name: str) -> None:
    """Refuses NaN and infinity, naming the first."""
    good = np.isfinite(array)
    if not good.all():
        place = tuple(int(i) for i in np.argwhere(~good)[0])
        index = place[0] if len(place) == 1 else place
        raise OptionError(f"{name} is {array[place]} at {index}, which is not finite")


def whole(value: SupportsIndex, name: str) -> int:
    """A non-negative integer."""
    number = operator.index(value)
    if number < 0:
        raise OptionError(f"{name} is {number}, but must not be negative")
    return number


def csr(parts: tuple[Any, Any, Any, tuple[int, int]]) -> Csr:
    """A scipy matrix that shares the arrays of the extension."""
    try:
        from scipy.sparse import csr_matrix
    except ImportError as error:
        raise ImportError("sparse matrices need scipy: pip install scipy") from error
    starts, columns_, values, shape = parts
    # Indices of scipy are signed.
    kind = np.int32 if len(values) < 2**31 else np.int64
    signed = [a.view(np.int32) if kind == np.int32 else a.astype(np.int64) for a in (columns_, starts)]
    matrix = csr_matrix((values, signed[0], signed[1]), shape=shape, copy=False)
    matrix.has_sorted_indices = True
    matrix.has_canonical_format = True
    return matrix


def mass(given: Any) -> Csr:
    """A scipy matrix of the extension's parts, or of its diagonal, with every entry stored."""
    if isinstance(given, tuple):
        return csr(given)
    n = len(given)
    starts = np.arange(n + 1, dtype=np.uint32)
    return csr((starts, starts[:n].copy(), given, (n, n)))


def frozen(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The array, made read-only."""
    array.flags.writeable = False
    return array


def unit_or_nan(normals: Floats) -> Floats:
    """Unit normals, with NaN in place of zero where there is none."""
    normals[(normals == 0.0).all(axis=1)] = np.nan
    return normals
