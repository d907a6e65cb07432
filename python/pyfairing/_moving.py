"""Flows, noise and denoisers: the methods of `Mesh` that move vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._calls import Progress, call, warn
from ._checks import warn_of_orientation, warn_of_split
from ._docs import documented
from ._parameters import DENOISER, METHOD
from ._results import NoiseLevel

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._arrays import Bools
    from ._mesh import Mesh
    from ._names import Denoiser, DenoiserParameters, Method, MethodParameters, NoiseKind

Self = TypeVar("Self", bound="Mesh")


@METHOD.takes
@documented
def smooth(
    self: Self,
    method: Method = "taubin",
    *,
    where: npt.ArrayLike | None = None,
    threads: int | None = None,
    progress: Progress = None,
    **parameters: Unpack[MethodParameters],
) -> Self:
    """Smooths by a flow, by a filter or by fairing a region.

    Parameters
    ----------
    method : str
        The method:

        {methods}
    {parameters_of_methods}
    where : array_like of int or bool, optional
        The vertices that move, or a mask of them; the others are fixed. By default all. For
        `region` it may stand for `vertices`.
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
    selected = _selected(self._core, where)
    options = dict(parameters)
    # A projection on modes has no pins.
    pins = "pin" in METHOD.algorithms.get(method, ()) and options.get("modes") is None
    if selected is not None and pins:
        options["pin"] = _fixed(self._core, options.get("pin"), selected)  # type: ignore[arg-type]
    elif selected is not None and "vertices" in METHOD.algorithms.get(method, ()):
        given = _selected(self._core, options.get("vertices"))  # type: ignore[arg-type]
        options["vertices"] = selected if given is None else selected & given
    values = METHOD.values(method, options, self._core.vertex_count)
    try:
        core, report = _core.smooth(self._core, method, values, call(threads, progress))
    except _core.FlowError as error:
        error.last_good = self._moved(_kept(self._core, error.last_good, selected))
        raise
    if report["unstable"] and parameters.get("unstable") == "warn":
        warn("steps beyond the stable limit were taken: some modes grow")
    if report["too_thin"] is not None:
        warn(f"face {report['too_thin']} is too thin for cotangents; the robust operator is used")
    if report["degenerate_faces"]:
        warn(f"{report['degenerate_faces']} faces became degenerate on the way")
    warn_of_split(report["split"], parameters.get("modes") or 0, "modes")
    return self._moved(_kept(self._core, core, selected), {"method": method, **report})


@documented
def noise(
    self: Self,
    sigma: float,
    unit: Literal["edge", "model", "diagonal"] = "edge",
    kind: NoiseKind = "normal",
    *,
    fraction: float | None = None,
    length: float | None = None,
    camera: npt.ArrayLike | None = None,
    seed: int = 1,
    where: npt.ArrayLike | None = None,
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
    where : array_like of int or bool, optional
        The vertices that move, or a mask of them. By default all.
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
    selected = _selected(self._core, where)
    if kind in ("normal", "correlated", "varying", "fused"):
        warn_of_orientation(self._core)
    parameters = (
        None if fraction is None else float(fraction),
        None if length is None else float(length),
        None if camera is None else _arrays.point(camera, "camera"),
    )
    core = _core.noise(
        self._core, float(sigma), unit, kind, parameters, _arrays.whole(seed, "seed"), call(threads)
    )
    return self._moved(_kept(self._core, core, selected))


@documented
def scan(
    self: Self,
    camera: npt.ArrayLike | None = None,
    look_at: npt.ArrayLike | None = None,
    *,
    size: tuple[int, int] = (320, 240),
    field_of_view: float | None = None,
    jump: float = 5.0,
    threads: int | None = None,
) -> Self:
    """The mesh as a depth camera sees it: the depth image as a mesh, without noise.

    `noise` adds the noise of the camera; this mesh is the ground truth. +y is up, or +z for a camera that
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
    >>> bool((noisy.faces == truth.faces).all())
    True
    """
    views = (
        None if camera is None else _arrays.point(camera, "camera"),
        None if look_at is None else _arrays.point(look_at, "look_at"),
    )
    columns, rows = (_arrays.whole(pixels, "size") for pixels in size)
    angle = None if field_of_view is None else float(field_of_view)
    core, eye = _core.scan(self._core, views, (columns, rows), angle, float(jump), call(threads))
    return self._of(core, None, {"camera": eye})


@documented
def noise_level(self: Mesh, *, threads: int | None = None, progress: Progress = None) -> NoiseLevel | None:
    """Estimates the noise along the vertex normals.

    Parameters
    ----------
    {run}

    Returns
    -------
    NoiseLevel or None
        None if there are too few vertices.
    """
    found = _core.noise_level(self._core, call(threads, progress))
    return None if found is None else NoiseLevel(**found)


@DENOISER.takes
@documented
def denoise(
    self: Self,
    method: Denoiser = "automatic",
    *,
    pin: npt.ArrayLike | None = None,
    where: npt.ArrayLike | None = None,
    threads: int | None = None,
    progress: Progress = None,
    **parameters: Unpack[DenoiserParameters],
) -> Self:
    """Removes noise and keeps creases.

    Parameters
    ----------
    method : str
        The denoiser:

        {denoisers}
    {parameters_of_denoisers}
    pin : array_like of int or bool, optional
        Fixed vertices, or a mask of them.
    where : array_like of int or bool, optional
        The vertices that move, or a mask of them; the others are fixed. By default all.
        `automatic` measures the noise at the vertices that move.
    {run}

    Returns
    -------
    Mesh
        The same faces. For `automatic`, `Mesh.report` has the noise of `noise_level`: `sigma`,
        `correlation_length` and `wide_sigma` (None if there are too few vertices), `surface`:
        `creased`, `smooth`, `uneven` or `clean` (nothing was moved), and `approach`: `networks`,
        `total-generalised-variation` for noise that is correlated over several
        edges, like that of a depth camera, or None if nothing was moved. `expected_error` is the
        expected mean angle between the normals of faces and the true ones in degrees, to a
        factor of two in most cases; None if nothing was moved. `undecided` is the part of
            `sigma` that may be relief instead of noise: it is kept, and a `strength` of 2 removes
    it. `flipped_faces` is the number of folds that could not be opened. `spikes` is the
        number of outliers, which were moved back to the surface before the noise was measured.
        Parts with faces as uneven as those of CAD tessellations are left unchanged, with a
        `FairingWarning`. Faces that disagree with the rest of their part are flipped for the
        computation, with a `FairingWarning`.

    Raises
    ------
    OptionError
        For options that are out of range or do not belong to the method.
    ComputationError
        If the faces do not share their corners; see `Mesh.weld`.
    """
    fixed = _fixed(self._core, pin, _selected(self._core, where))
    values = DENOISER.values(method, parameters, self._core.vertex_count)
    warn_of_orientation(self._core)
    core, found = _core.denoise(self._core, method, values, fixed, call(threads, progress))
    report: dict[str, Any] = {"method": method}
    if found is None:
        return self._moved(core, report)
    if found["uneven_vertices"]:
        warn(
            f"{found['uneven_vertices']} vertices are on parts whose faces are too uneven (a CAD tessellation?): "
            "these parts stay as they are; other methods move them, too"
        )
    noise = found["noise"] or {}
    report |= {name: noise.get(name) for name in ("sigma", "correlation_length", "wide_sigma")}
    report["surface"] = found["kind"]
    names = ("approach", "expected_error", "spikes", "undecided", "flipped_faces")
    return self._moved(core, report | {name: found[name] for name in names})


@documented
def subdivide(
    self: Self, scheme: Literal["loop", "midpoint"] = "loop", *, threads: int | None = None
) -> Self:
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
    return self._of(self._core.subdivide(scheme, call(threads)))


def _selected(mesh: _core.Mesh, where: npt.ArrayLike | None) -> Bools | None:
    """The mask of the vertices that move; None for all."""
    if where is None:
        return None
    mask = np.zeros(mesh.vertex_count, dtype=np.bool_)
    mask[_arrays.numbers(where, mesh.vertex_count, "where")] = True
    return mask


def _fixed(mesh: _core.Mesh, pin: npt.ArrayLike | None, selected: Bools | None) -> list[int]:
    """The pinned vertices, and those that are not selected."""
    fixed = np.zeros(mesh.vertex_count, dtype=np.bool_) if selected is None else ~selected
    if pin is not None:
        fixed[_arrays.numbers(pin, mesh.vertex_count, "pin")] = True
    return [int(v) for v in np.flatnonzero(fixed)]


def _kept(mesh: _core.Mesh, moved: _core.Mesh, selected: Bools | None) -> _core.Mesh:
    """The moved mesh, with the vertices that are not selected where they were."""
    if selected is None:
        return moved
    return moved.with_vertices(np.where(selected[:, None], moved.vertices, mesh.vertices))
