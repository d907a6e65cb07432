"""Fields of vertices and faces: checked, sorted for files, and taken from other packages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._calls import warn

Element = Literal["vertex", "face"]
_NAMES = {"vertex": "field", "face": "face field"}


class Fields(Mapping[str, npt.NDArray[Any]]):
    """Fields by name.

    `fields[name]` is a copy, which may be changed; `fields.view(name)` is the array of the mesh
    itself, without a copy and read-only.
    """

    __slots__ = ("_arrays",)

    def __init__(self, arrays: dict[str, npt.NDArray[Any]]) -> None:
        self._arrays = arrays

    def view(self, name: str) -> npt.NDArray[Any]:
        """The field without a copy, read-only."""
        return self._arrays[name]

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self._arrays[name].copy()

    def __iter__(self) -> Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __repr__(self) -> str:
        return f"Fields({', '.join(self)})"


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


def kept(fields: Mapping[str, Any], n: int, of: Element) -> dict[str, npt.ArrayLike]:
    """The fields that a mesh can hold; a warning names the others."""
    kept: dict[str, npt.ArrayLike] = {}
    for name, values in fields.items():
        array = np.asarray(values)
        array = array[:, 0] if array.shape == (n, 1) else array
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
