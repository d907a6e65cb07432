"""What the parts of a mesh share."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._core import Mesh as CoreMesh


class Base:
    """The mesh of the extension, and the fields of its vertices."""

    __slots__ = ()

    _core: CoreMesh
    _fields: dict[str, npt.NDArray[Any]]

    if TYPE_CHECKING:

        def _moved(self, core: CoreMesh, report: Mapping[str, Any] | None = None) -> Self: ...
        @classmethod
        def _of(
            cls,
            core: CoreMesh,
            fields: Mapping[str, npt.ArrayLike] | None = None,
            report: Mapping[str, Any] | None = None,
        ) -> Self: ...
