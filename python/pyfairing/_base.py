"""Base class of the parts of `Mesh`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from . import _core
from ._calls import running, warn

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._core import Mesh as CoreMesh


class Base:
    """The mesh of the extension, and the fields of its vertices and faces."""

    __slots__ = ()

    _core: CoreMesh
    _fields: dict[str, npt.NDArray[Any]]
    _face_fields: dict[str, npt.NDArray[Any]]

    if TYPE_CHECKING:

        def _moved(self, core: CoreMesh, report: Mapping[str, Any] | None = None) -> Self: ...
        @classmethod
        def _of(
            cls,
            core: CoreMesh,
            fields: Mapping[str, npt.ArrayLike] | None = None,
            report: Mapping[str, Any] | None = None,
            face_fields: Mapping[str, npt.ArrayLike] | None = None,
        ) -> Self: ...

    def _warn_of_orientation(self) -> None:
        """Warns if faces are oriented inconsistently and the result depends on it."""
        with running(None, None) as call:
            turned, one_sided = self._core.disagreeing_faces(call)
        if turned:
            warn(
                f"{turned} of {self._core.face_count} faces turn against the rest of their part "
                "and count as flipped"
            )
        if one_sided:
            warn(
                f"{one_sided} of {self._core.face_count} faces are on one-sided parts, which have no "
                "outside: signs and volumes are not defined there"
            )

    def _require_welded(self) -> None:
        with running(None, None) as call:
            if self._core.is_unwelded(call):
                raise _core.ComputationError(
                    "most vertices coincide with another vertex: the faces do not share their "
                    "corners, so that none has neighbours; use the mesh that Mesh.weld returns"
                )
