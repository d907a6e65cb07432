"""Flows, noise and denoisers: the methods of `Mesh` that move vertices."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal

import numpy.typing as npt

from . import _arrays, _core
from ._base import Base
from ._calls import Progress, running, warn
from ._docs import documented
from ._parameters import parameters
from ._results import NoiseLevel
from ._spectrum import warn_of_split

if TYPE_CHECKING:
    from typing_extensions import Self

#: A vertex, a weight, and where it is drawn to (where it is, without).
Soft = Iterable["tuple[int, float] | tuple[int, float, npt.ArrayLike]"]


class Moving(Base):
    """The flows, noise and denoisers of a mesh."""

    __slots__ = ()

    @documented
    def smooth(
        self,
        method: str = "taubin",
        *,
        weights: Literal["uniform", "cotangent"] | None = None,
        lam: float | None = None,
        time: float | None = None,
        iterations: int | None = None,
        area: Literal["barycentric", "mixed", "voronoi"] | None = None,
        kind: Literal["auto", "cotangent", "robust"] | None = None,
        boundary: Literal["free", "pinned", "sliding"] | None = None,
        pin: npt.ArrayLike | None = None,
        soft: Soft | None = None,
        volume: Literal["drift", "rescale", "offset"] | None = None,
        unstable: Literal["refuse", "warn", "allow"] | None = None,
        mu: float | None = None,
        pass_band: float | None = None,
        degree: int | None = None,
        window: Literal["hanning", "hamming", "blackman"] | None = None,
        alpha: float | None = None,
        beta: float | None = None,
        fraction: float | None = None,
        cutoff: float | None = None,
        order: int | None = None,
        modes: int | None = None,
        update: Literal["never", "mass", "both"] | None = None,
        tolerance: float | None = None,
        settled: float | None = None,
        vertices: npt.ArrayLike | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Self:
        """Smooths by a flow, by a filter or by fairing a region.

        Parameters
        ----------
        method : str
            The method:

            {methods}
        weights : {'uniform', 'cotangent'}, optional
            Weights of the Laplacian for `explicit`, `implicit` and `region`; uniform by default
            (cotangent for `region`, and if a time is given).
        lam : float, optional
            The step λ: with uniform weights the fraction of the way to the mean of the
            neighbours, with cotangents a time in squared mean edge lengths.
        time : float, optional
            The step with cotangents, or the time of `low-pass`, in squared mesh units; for
            `conformal` a fraction of the area.
        iterations : int, optional
            The number of steps (10); pairs of steps for `taubin`.
        area : {'barycentric', 'mixed', 'voronoi'}, optional
            Vertex areas for cotangents.
        kind : {'auto', 'cotangent', 'robust'}, optional
            The Laplacian with cotangents; by default `auto`: robust if a face is too thin for
            cotangents.
        boundary : {'free', 'pinned', 'sliding'}, optional
            Treatment of the boundary of an open mesh.
        pin : array_like of int or bool, optional
            Fixed vertices.
        soft : iterable of (vertex, weight) or (vertex, weight, target), optional
            Vertices drawn to their positions, or to a point; with weight 1 a step ends half-way
            between the flow and the point.
        volume : {'drift', 'rescale', 'offset'}, optional
            Treatment of the volume of a closed mesh.
        unstable : {'refuse', 'warn', 'allow'}, optional
            Treatment of explicit steps beyond the stable limit, and of pairs of `taubin` steps
            that amplify a mode by more than two.
        mu : float, optional
            The growing step of `taubin`, below -λ.
        pass_band : float, optional
            Of `taubin` and `windowed-sinc`: modes with -eigenvalue below this stay (0 to 2).
        degree, window : optional
            Of `windowed-sinc`: its degree (20), and `hanning`, `hamming` or `blackman`.
        alpha, beta : float, optional
            Of `hc`: the weight of the input in differences, and the weight of a vertex's own
            difference in the correction (0 to 1).
        fraction : float, optional
            Of `scale-dependent`: the fraction of the largest stable step (0 to 1).
        cutoff, order, modes : optional
            Of `low-pass`: a wavelength in mesh units with the order of a Butterworth filter,
            or the number of modes to keep; `order` is also that of `region`.
        update : {'never', 'mass', 'both'}, optional
            Of `implicit`: the parts of the operator updated to the current positions.
        tolerance : float, optional
            The relative residual of linear systems.
        settled : float, optional
            Of `conformal`: stop when no vertex moves by more than this fraction of the square root
            of the area.
        vertices : array_like of int or bool, optional
            The region of `region`.
        {run}

        Returns
        -------
        Mesh
            The same faces, with the fields of this mesh except normals. `Mesh.report` describes
            how the steps were computed.

        Raises
        ------
        OptionError
            For options that are out of range or do not belong to the method.
        FlowError
            If a step fails; `last_good` is the mesh before it.
        """
        n = self._core.vertex_count
        given = {
            "weights": weights,
            "lam": lam,
            "time": time,
            "iterations": iterations,
            "area": area,
            "kind": kind,
            "boundary": boundary,
            "pin": None if pin is None else _arrays.numbers(pin, n, "pin", n),
            "soft": None if soft is None else [_soft(*entry) for entry in soft],
            "volume": volume,
            "unstable": unstable,
            "mu": mu,
            "pass_band": pass_band,
            "degree": degree,
            "window": window,
            "alpha": alpha,
            "beta": beta,
            "fraction": fraction,
            "cutoff": cutoff,
            "order": order,
            "modes": modes,
            "update": update,
            "tolerance": tolerance,
            "settled": settled,
            "vertices": None if vertices is None else _arrays.numbers(vertices, n, "vertices", n),
        }
        values = parameters(method, given)
        with running(threads, progress) as call:
            core, report = _core.smooth(self._core, method, values, call)
        if report["unstable"] and unstable == "warn":
            warn("steps beyond the stable limit were taken: some modes grow")
        if report["too_thin"] is not None:
            warn(f"face {report['too_thin']} is too thin for cotangents; the robust operator is used")
        if report["degenerate_faces"]:
            warn(f"{report['degenerate_faces']} faces became degenerate on the way")
        warn_of_split(report["split"], modes or 0, "modes")
        return self._moved(core, {"method": method, **report})

    @documented
    def noise(
        self,
        sigma: float,
        unit: Literal["edge", "model", "diagonal"] = "edge",
        kind: Literal[
            "normal",
            "axes",
            "direction",
            "uniform",
            "impulsive",
            "correlated",
            "varying",
            "rays",
            "depth-camera",
            "fused",
        ] = "normal",
        *,
        fraction: float | None = None,
        length: float | None = None,
        camera: npt.ArrayLike | None = None,
        seed: int = 1,
        threads: int | None = None,
    ) -> Self:
        """Adds seeded noise to the positions.

        Parameters
        ----------
        sigma : float
            Standard deviation of the displacement; for `uniform` the largest shift per axis; for
            `depth-camera` and `fused` the root mean square.
        unit : {'edge', 'model', 'diagonal'}
            Mean edge lengths, mesh units, or diagonals of the bounding box.
        kind : str
            - `normal`: Gaussian along the normal
            - `axes`: Gaussian along each axis
            - `direction`: Gaussian along a random direction
            - `uniform`: uniform along each axis
            - `impulsive`: as `direction`, at a fraction of the vertices
            - `correlated`: Gaussian along the normal, correlated over a few edges
            - `varying`: Gaussian along the normal, with a level that varies over the surface
            - `rays`: Gaussian along the ray from the camera
            - `depth-camera`: one view of a depth camera, with rounded disparities
            - `fused`: fused views of a depth camera, waves along the normal many edges long
        fraction : float, optional
            Fraction of vertices that `impulsive` noise moves (0.25).
        length : float, optional
            Correlation length in mean edge lengths, where the correlation is 1/e, of `correlated`
            (2), `depth-camera` (5) and `fused` (25).
        camera : array_like of 3 floats, optional
            Position of the camera of `rays` and `depth-camera`; by default three diagonals of the
            bounding box from its centre along +z.
        seed : int
            The same seed gives the same noise on every machine.
        threads : int, optional
            Maximum number of threads.

        Returns
        -------
        Mesh

        Raises
        ------
        OptionError
            For options that are out of range or do not belong to the kind.
        ComputationError
            If a vertex is not in front of the camera.
        """
        if kind in ("normal", "correlated", "varying", "fused"):
            self._warn_of_orientation()
        parameters = (
            None if fraction is None else float(fraction),
            None if length is None else float(length),
            None if camera is None else _arrays.point(camera, "camera"),
        )
        with running(threads, None) as call:
            core = _core.noise(
                self._core, float(sigma), unit, kind, parameters, _arrays.whole(seed, "seed"), call
            )
        return self._moved(core)

    @documented
    def scan(
        self,
        camera: npt.ArrayLike | None = None,
        look_at: npt.ArrayLike | None = None,
        *,
        size: tuple[int, int] = (320, 240),
        field_of_view: float | None = None,
        jump: float = 5.0,
        threads: int | None = None,
    ) -> Self:
        """The mesh as a depth camera sees it: the depth image as a mesh, without noise.

        The truth of a sensor's mesh, which `noise` makes of it. +y is up, or +z for a camera that
        looks along y.

        Parameters
        ----------
        camera : array_like of 3 floats, optional
            Position of the camera; by default three diagonals of the bounding box from its centre
            along +z.
        look_at : array_like of 3 floats, optional
            Point in the middle of the image; by default the centre of the bounding box.
        size : (int, int)
            Columns and rows of pixels, each from 2 to 2048.
        field_of_view : float, optional
            Horizontal, in degrees; by default the smallest that shows the whole mesh.
        jump : float
            The largest difference of depth along an edge, in widths of a pixel: triangles with a
            longer edge are left out.
        threads : int, optional
            Maximum number of threads.

        Returns
        -------
        Mesh
            Without fields; `Mesh.report` has the position of the camera.

        Raises
        ------
        OptionError
            For options that are out of range.
        ComputationError
            If the camera is inside of the mesh or sees nothing of it.

        Examples
        --------
        >>> import pyfairing as pf
        >>> truth = pf.shapes.icosphere(4).scan([3, 1, 2], size=(80, 60))
        >>> noisy = truth.noise(0.67, kind="depth-camera", camera=truth.report["camera"])
        >>> (noisy.faces == truth.faces).all()
        np.True_
        """
        views = (
            None if camera is None else _arrays.point(camera, "camera"),
            None if look_at is None else _arrays.point(look_at, "look_at"),
        )
        columns, rows = (_arrays.whole(pixels, "size") for pixels in size)
        angle = None if field_of_view is None else float(field_of_view)
        with running(threads, None) as call:
            core, eye = _core.scan(self._core, views, (columns, rows), angle, float(jump), call)
        return self._of(core, None, {"camera": eye})

    @documented
    def noise_level(self, *, threads: int | None = None, progress: Progress = None) -> NoiseLevel | None:
        """Estimates the noise along the vertex normals.

        Parameters
        ----------
        {run}

        Returns
        -------
        NoiseLevel or None
            None if there are too few vertices.
        """
        with running(threads, progress) as call:
            found = _core.noise_level(self._core, call)
        return None if found is None else NoiseLevel(*found)

    @documented
    def denoise(
        self,
        method: str = "automatic",
        *,
        strength: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Self:
        """Removes noise and keeps creases.

        Parameters
        ----------
        method : str
            With its default options:

            {denoisers}
        strength : float, optional
            Of `automatic` only: a factor on the estimated noise, 1 by default. Larger values
            remove more.
        {run}

        Returns
        -------
        Mesh
            The same faces. For `automatic`, `Mesh.report` has `sigma`, the noise in mesh
            units (None if there are too few vertices), `surface`: `creased`, `smooth`,
            `uneven` or `clean` (nothing was moved), and `approach`: `networks`,
            `total-generalised-variation` for strong noise that is correlated over several
            edges, like that of a depth camera, or None if nothing was moved. Parts with faces as uneven as those of CAD
            tessellations are left unchanged, with a `FairingWarning`. Faces that turn against the
            rest of their part are flipped for the computation, with a `FairingWarning`.

        Raises
        ------
        OptionError
            For a strength that is not positive, and for one of another method than `automatic`.
        ComputationError
            If the faces do not share their corners; see `Mesh.weld`.
        """
        self._warn_of_orientation()
        given = None if strength is None else float(strength)
        with running(threads, progress) as call:
            core, found = _core.denoise(self._core, method, given, call)
        report: dict[str, Any] = {"method": method}
        if found is None:
            return self._moved(core, report)
        sigma, surface, approach, uneven = found
        if uneven:
            warn(
                f"{uneven} vertices are on parts whose faces are too uneven (a CAD tessellation?): "
                "these parts stay as they are; other methods move them, too"
            )
        report |= {"sigma": sigma, "surface": surface, "approach": approach}
        return self._moved(core, report)

    @documented
    def subdivide(self, scheme: Literal["loop", "midpoint"] = "loop", *, threads: int | None = None) -> Self:
        """Cuts each face into four.

        Parameters
        ----------
        scheme : {'loop', 'midpoint'}
            Loop's scheme, which smooths, or midpoints, which keep the shape.
        threads : int, optional
            Maximum number of threads.

        Returns
        -------
        Mesh
            The vertices of this mesh, then one for each edge; without fields.
        """
        with running(threads, None) as call:
            return self._of(self._core.subdivide(scheme, call))


def _soft(vertex: int, weight: float, target: npt.ArrayLike | None = None) -> tuple[int, float, list[float] | None]:
    point = None if target is None else _arrays.field(target, 3, "a target of soft").tolist()
    return _arrays.whole(vertex, "a vertex of soft"), float(weight), point
