"""Spectra of the Laplacian."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Csr, Floats
from ._calls import Progress, call, warn
from ._checks import warn_of_split
from ._docs import documented

if TYPE_CHECKING:
    from ._core import Spectrum as CoreSpectrum
    from ._mesh import Mesh


class Spectrum:
    """The k smoothest modes of a mesh, S φ = ω M φ; made by `Mesh.spectrum` or `Spectrum.load`.

    Modes with equal eigenvalues are an arbitrary basis of their eigenspace; `clusters` groups them.
    Every mode is 0 at isolated and fixed vertices.
    """

    __slots__ = ("_core", "_kind", "_mesh")

    _core: CoreSpectrum
    _mesh: Mesh | None
    _kind: str

    def __init__(self) -> None:
        raise TypeError("a spectrum is made by Mesh.spectrum or Spectrum.load")

    @classmethod
    def _of(cls, core: CoreSpectrum, mesh: Any, kind: str) -> Spectrum:
        spectrum = cls.__new__(cls)
        spectrum._core, spectrum._mesh, spectrum._kind = core, mesh, kind
        return spectrum

    @property
    def values(self) -> Floats:
        """ω, ascending, (k,), in 1 / squared mesh units."""
        return self._core.values

    @property
    def modes(self) -> Floats:
        """A mode in each column, (n, k), Φᵀ M Φ = I, in 1 / mesh unit: a view, not writeable."""
        return self._core.modes

    @property
    def residuals(self) -> Floats:
        """‖S φ - ω M φ‖ in the M⁻¹ norm of each mode, (k,), in the unit of ω."""
        return self._core.residuals

    @property
    def certified(self) -> bool:
        """True if an inertia count has verified that no smaller eigenvalue is missing."""
        return self._core.certified

    @property
    def mass(self) -> Csr:
        """M, (n, n), as `scipy.sparse.csr_matrix`."""
        return _arrays.mass(self._core.mass)

    @property
    def area(self) -> float:
        """The total mass: the area of the mesh."""
        return self._core.area

    @property
    def mesh(self) -> Mesh | None:
        """The mesh of the spectrum; None if unknown."""
        return self._mesh

    @property
    def kind(self) -> str:
        """The kind of the Laplacian; empty if unknown."""
        return self._kind

    def __len__(self) -> int:
        return len(self._core.values)

    def __repr__(self) -> str:
        values = self.values
        if not len(values):
            return "Spectrum(no modes)"
        sure = "certified" if self.certified else "not certified"
        return f"Spectrum({len(values)} modes, eigenvalues {values[0]:.4g} to {values[-1]:.4g}, {sure})"

    def clusters(self) -> list[range]:
        """The modes grouped by equal or nearly equal eigenvalues."""
        return [range(start, end) for start, end in self._core.clusters()]

    def split(self, k: int | None = None) -> tuple[int, int | None] | None:
        """The nearest numbers of modes below and above k that split no cluster; None if k splits none."""
        return self._core.split(len(self) if k is None else _arrays.whole(k, "k"))

    def truncated(self, k: int) -> Spectrum:
        """The first k modes only."""
        return self._of(self._core.truncated(_arrays.whole(k, "k")), self._mesh, self._kind)

    @documented
    def project(
        self, field: npt.ArrayLike, *, threads: int | None = None, progress: Progress = None
    ) -> Floats:
        """Coefficients Φᵀ M f of a field.

        Parameters
        ----------
        field : array_like, shape (n,) or (n, d)
            Values at the vertices.
        {run}

        Returns
        -------
        ndarray, shape (k,) or (k, d)
        """
        matrix, flat = _arrays.columns(field, "field")
        found = self._core.project(matrix, call(threads, progress))
        return found[:, 0] if flat else found

    @documented
    def expand(
        self, coefficients: npt.ArrayLike, *, threads: int | None = None, progress: Progress = None
    ) -> Floats:
        """The field Σ φᵢ cᵢ of the first coefficients: the inverse of `project`.

        Parameters
        ----------
        coefficients : array_like, shape (j,) or (j, d)
            Coefficients of the first j modes, with j at most k.
        {run}

        Returns
        -------
        ndarray, shape (n,) or (n, d)
        """
        matrix, flat = _arrays.columns(coefficients, "coefficients")
        found = self._core.expand(matrix, call(threads, progress))
        return found[:, 0] if flat else found

    @documented
    def reconstruct(
        self,
        k: int | None = None,
        mesh: Mesh | None = None,
        *,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Mesh:
        """The mesh with its positions projected onto the first k modes.

        Parameters
        ----------
        k : int, optional
            Number of modes; all by default. Warns if it splits a cluster of eigenvalues.
        mesh : Mesh, optional
            The mesh; by default that of the spectrum.
        {run}

        Returns
        -------
        Mesh
            Vertices without faces keep their positions.
        """
        mesh = mesh if mesh is not None else self._mesh
        if mesh is None:
            raise TypeError("the spectrum was loaded without its mesh: pass mesh")
        count = len(self) if k is None else _arrays.whole(k, "k")
        core, split = self._core.reconstruct(mesh._core, count, call(threads, progress))
        warn_of_split(split, count, "k")
        return mesh._moved(core)

    @documented
    def filter(
        self,
        field: npt.ArrayLike,
        response: Callable[[Floats], npt.ArrayLike] | npt.ArrayLike,
        *,
        rest: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Floats:
        """Multiplies the coefficient of each mode: Σ h(ωᵢ) φᵢ φᵢᵀ M f.

        Parameters
        ----------
        field : array_like, shape (n,) or (n, d)
            Values at the vertices.
        response : callable or array_like, shape (k,)
            h, called with the array of ω, or the values h(ωᵢ).
        rest : float, optional
            Factor of the part of the field outside the modes; by default that part is dropped.
        {run}

        Returns
        -------
        ndarray, shape (n,) or (n, d)
            Warns if the response splits a cluster of eigenvalues.

        Examples
        --------
        Heat after the time t is `s.filter(f, lambda w: np.exp(-w * t))`.
        """
        matrix, flat = _arrays.columns(field, "field")
        values = response(self.values) if callable(response) else response
        factors = _arrays.field(np.broadcast_to(np.asarray(values), len(self)), len(self), "response")
        found, split = self._core.filter(
            matrix, factors, None if rest is None else float(rest), call(threads, progress)
        )
        if split is not None:
            warn("the response splits a cluster of eigenvalues, whose modes are an arbitrary basis")
        return found[:, 0] if flat else found

    @documented
    def truncation_errors(
        self, field: npt.ArrayLike, *, threads: int | None = None, progress: Progress = None
    ) -> Floats:
        """Truncation error of keeping j modes, for j = 0 ... k.

        Parameters
        ----------
        field : array_like, shape (n,) or (n, d)
            Values at the vertices; the positions of the mesh for errors of `reconstruct`.
        {run}

        Returns
        -------
        ndarray, shape (k + 1,)
            The mass-weighted root mean square of the dropped part, in units of the field.
        """
        matrix, _ = _arrays.columns(field, "field")
        return self._core.truncation_errors(matrix, call(threads, progress))

    def heat_kernel_times(self, count: int = 100) -> Floats:
        """Logarithmically spaced times that the modes resolve, (count,), in squared mesh units."""
        return self._core.heat_kernel_times(_arrays.whole(count, "count"))

    @documented
    def heat_kernel_signature(
        self,
        times: npt.ArrayLike | None = None,
        *,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Floats:
        """The heat kernel signature, Σ exp(-ωᵢ t) φᵢ(x)².

        Parameters
        ----------
        times : array_like, shape (t,), optional
            In squared mesh units; `heat_kernel_times()` by default.
        {run}

        Returns
        -------
        ndarray, shape (n, t)
            In 1 / squared mesh units.
        """
        given = self.heat_kernel_times() if times is None else np.atleast_1d(np.asarray(times))
        array = _arrays.field(given, len(given), "times")
        return self._core.heat_kernel_signature(array, call(threads, progress))

    @documented
    def wave_kernel_signature(
        self,
        energies: int | npt.ArrayLike = 100,
        sigma: float | None = None,
        *,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Floats:
        """The wave kernel signature: at x the density of a particle with log-normal energy around e.

        Parameters
        ----------
        energies : int or array_like, shape (e,)
            The energies, in ln ω; a number is the `count` of `wave_kernel_energies`.
        sigma : float, optional
            The deviation of ln ω; required unless `energies` is a number, whose default is the
            deviation of `wave_kernel_energies`.
        {run}

        Returns
        -------
        ndarray, shape (n, e)
            In 1 / squared mesh units; the integral of each column is 1.

        Examples
        --------
        >>> import pyfairing as pf
        >>> s = pf.shapes.icosphere(3).spectrum(20)
        >>> energies, sigma = s.wave_kernel_energies(50)
        >>> s.wave_kernel_signature(energies, 2 * sigma).shape
        (642, 50)
        """
        if np.ndim(energies) == 0:
            levels, usual = self.wave_kernel_energies(energies)  # type: ignore[arg-type]
            sigma = usual if sigma is None else sigma
        else:
            levels = _arrays.field(energies, np.size(energies), "energies")
        if sigma is None:
            raise _core.OptionError("energies without sigma, their deviation in ln ω")
        return self._core.wave_kernel_signature(levels, float(sigma), call(threads, progress))

    def wave_kernel_energies(self, count: int = 100) -> tuple[Floats, float]:
        """Energies evenly spaced in ln ω, (count,), and the deviation σ: seven times their spacing."""
        return self._core.wave_kernel_energies(_arrays.whole(count, "count"))

    def global_point_signature(self) -> Floats:
        """φᵢ(x) / √ωᵢ for the modes with ω above zero, (n, modes), dimensionless."""
        return self._core.global_point_signature(call())

    def shape_dna(self) -> Floats:
        """The eigenvalues times the area, (k,), invariant under scaling."""
        return self._core.shape_dna()

    def save(self, path: str | PathLike[str]) -> None:
        """Writes an npz file, whole or not at all: `values`, `modes`, `residuals`, `mass`.

        Parameters
        ----------
        path : str or path
            The npz file, for `Spectrum.load` and `numpy.load`.
        """
        self._core.save(fspath(path), call())

    @classmethod
    def load(cls, path: str | PathLike[str], mesh: Mesh | None = None) -> Spectrum:
        """Reads a file of `save`.

        Parameters
        ----------
        path : str or path
            The npz file.
        mesh : Mesh, optional
            The mesh of the spectrum, for `reconstruct`.

        Returns
        -------
        Spectrum
        """
        core = _core.Spectrum.load(fspath(path), call())
        if mesh is not None and mesh.n_vertices != core.modes.shape[0]:
            raise _core.OptionError(
                f"the spectrum is of {core.modes.shape[0]} vertices, the mesh has {mesh.n_vertices}"
            )
        return cls._of(core, mesh, "")

    def __reduce__(self) -> Any:
        return _restored, (self._core.to_bytes(), self._mesh, self._kind)


def _restored(data: bytes, mesh: Mesh | None, kind: str) -> Spectrum:
    return Spectrum._of(_core.Spectrum.from_bytes(data), mesh, kind)
