"""The methods of `Mesh` on PyVista's `PolyData`: `poly.fairing.denoise()`.

PyVista from 0.48 on imports this module by its entry point when `fairing` is first used.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, TypeVar

import numpy.typing as npt
import pyvista

from ._mesh import Mesh
from .paraview_filters import add, curvatures, distances, mesh_of, move

F = TypeVar("F", bound=Callable[..., object])


def _like(method: Callable[..., object]) -> Callable[[F], F]:
    """Gives a function the signature of a method of `Mesh`."""

    def decorator(function: F) -> F:
        signature = inspect.signature(method).replace(return_annotation="pyvista.PolyData")
        function.__signature__ = signature  # type: ignore[attr-defined]
        return function

    return decorator


class Fairing:
    """Curvature, smoothing, denoising, spectra and distances of a `pyvista.PolyData`.

    Each method takes the parameters of the method of `pyfairing.Mesh` of the same name and returns
    a copy of the `PolyData` with its data; points and cells keep their order. `mesh` has the rest.
    """

    def __init__(self, poly: Any) -> None:
        self._poly = poly

    @property
    def mesh(self) -> Mesh:
        """The surface as a `pyfairing.Mesh`, with the data that its fields can hold."""
        return Mesh(self._poly)

    def _with(self, data: dict[str, npt.NDArray[Any]]) -> Any:
        poly = self._poly.copy()
        add(poly, data)
        return poly

    def _moved(self, mesh: Mesh) -> Any:
        poly = self._poly.copy()
        move(poly, mesh)
        return poly

    @_like(Mesh.curvature)
    def curvature(self, *args: Any, **parameters: Any) -> Any:
        """Estimates curvature at each point, as `pyfairing.Mesh.curvature`.

        Returns
        -------
        pyvista.PolyData
            With point data of VTK's names: `Mean_Curvature`, `Gauss_Curvature`,
            `Maximum_Curvature`, `Minimum_Curvature`, and, if the estimator provides them,
            `Maximum_Direction` and `Minimum_Direction`. Positive on a sphere whose faces are
            counter-clockwise seen from outside, in 1 / mesh units, NaN where undefined.
        """
        return self._with(curvatures(mesh_of(self._poly).curvature(*args, **parameters)))

    @_like(Mesh.smooth)
    def smooth(self, *args: Any, **parameters: Any) -> Any:
        """Smooths by a flow or a filter, as `pyfairing.Mesh.smooth`.

        Returns
        -------
        pyvista.PolyData
            With other points and the same data, except `Normals`.
        """
        return self._moved(mesh_of(self._poly).smooth(*args, **parameters))

    @_like(Mesh.denoise)
    def denoise(self, *args: Any, **parameters: Any) -> Any:
        """Removes noise and keeps creases, as `pyfairing.Mesh.denoise`.

        Returns
        -------
        pyvista.PolyData
            With other points and the same data, except `Normals`.
        """
        return self._moved(mesh_of(self._poly).denoise(*args, **parameters))

    @_like(Mesh.spectrum)
    def spectrum(self, *args: Any, **parameters: Any) -> Any:
        """The smoothest modes of the Laplacian, as `pyfairing.Mesh.spectrum`.

        Returns
        -------
        pyvista.PolyData
            With the point data `Mode_0`, `Mode_1`, …, and the field data `Eigenvalues`, in
            1 / squared mesh units.
        """
        spectrum = mesh_of(self._poly).spectrum(*args, **parameters)
        poly = self._with({f"Mode_{i}": mode for i, mode in enumerate(spectrum.modes.T.copy())})
        poly.field_data["Eigenvalues"] = spectrum.values
        return poly

    @_like(Mesh.geodesic_distance)
    def geodesic_distance(self, *args: Any, **parameters: Any) -> Any:
        """The distance to the nearest source along the surface, as `pyfairing.Mesh.geodesic_distance`.

        Returns
        -------
        pyvista.PolyData
            With the point data `Geodesic_Distance`, in mesh units, NaN on parts without a source.
        """
        return self._with(distances(mesh_of(self._poly).geodesic_distance(*args, **parameters)))


pyvista.register_dataset_accessor("fairing", pyvista.PolyData)(Fairing)
