"""Heat, factorised once for many fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats
from ._calls import Progress, call, warn
from ._docs import documented

if TYPE_CHECKING:
    from ._mesh import Mesh
    from ._names import Kind, MassKind


class HeatSolver:
    """Implicit heat steps (M + tS) u = M u₀ of fixed length, factorised once.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    time : float, optional
        Length of a step, in squared mesh units; by default the squared mean edge length.
    kind, mass : str
        As in `Mesh.laplacian`.
    threads : int, optional
        Maximum number of threads.
    progress : callable or bool, optional
        As in `Mesh.heat`.

    Notes
    -----
    A solver can be pickled; it is factorised again where it is loaded.
    """

    def __init__(
        self,
        mesh: Mesh,
        time: float | None = None,
        kind: Kind = "auto",
        mass: MassKind = "barycentric",
        *,
        threads: int | None = None,
        progress: Progress = None,
    ) -> None:
        time = mesh._core.mean_edge_length**2 if time is None else float(time)
        self._arguments = mesh, time, kind, mass
        self._n = mesh._core.vertex_count
        self._core = _core.Heat(mesh._core, time, kind, mass, call(threads, progress))
        if self._core.note:
            warn(self._core.note)

    @documented
    def step(
        self,
        temperatures: npt.ArrayLike,
        *,
        steps: int = 1,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Floats:
        """The temperatures after some steps.

        Parameters
        ----------
        temperatures : array_like, shape (n,) or (n, d)
            Initial temperatures, of one field or of one in each column.
        steps : int
            Number of steps.
        {run}

        Returns
        -------
        ndarray, shape of temperatures
        """
        fields, flat = _arrays.fields(temperatures, self._n, "temperatures")
        found = self._core.step(fields, _arrays.whole(steps, "steps"), call(threads, progress))
        return found[:, 0] if flat else found

    def __repr__(self) -> str:
        _, time, kind, mass = self._arguments
        return f"HeatSolver({self._n} vertices, time {time:g}, {kind}, {mass})"

    def __reduce__(self) -> Any:
        return type(self), self._arguments
