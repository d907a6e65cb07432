"""Methods of `Mesh` that compute: Laplacian, normals, curvature, spectrum, heat, Poisson problems.

Also the Laplacian of polygons, and the comparison of two meshes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Csr, Floats
from ._calls import Progress, call, warn
from ._checks import require_welded, warn_of_orientation
from ._docs import documented
from ._heat import HeatSolver
from ._parameters import ESTIMATOR
from ._results import Curvature, Laplacian, Scores
from ._spectrum import Spectrum

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._mesh import Mesh
    from ._names import Estimator, EstimatorParameters, Kind, MassKind


@documented
def laplacian(
    self: Mesh,
    kind: Kind = "auto",
    mass: MassKind = "barycentric",
    *,
    threads: int | None = None,
    progress: Progress = None,
) -> Laplacian:
    """Stiffness S and mass M: `S, M = mesh.laplacian()`.

    S u is integrated, M⁻¹ S u pointwise, and Δu ≈ -M⁻¹ S u. Boundaries are natural
    (zero flux). Rows of isolated vertices are zero in both.

    Parameters
    ----------
    kind : str
        One of {laplacians}. `auto` is cotangent, or robust if a face is too thin for
        cotangents; `non-negative` is robust also if an edge has a negative weight. `auto`
        has the same meaning in every method.
    mass : str
        One of {masses}. The robust Laplacian supports the barycentric mass only.
    {run}

    Returns
    -------
    Laplacian
        A pair of `scipy.sparse.csr_matrix`, (n, n), in the order of the vertices, with
        the attributes `kind` and `reason`. S is positive semi-definite and dimensionless,
        M in squared mesh units.

    Raises
    ------
    ComputationError
        For the first face too thin for cotangents, if `kind` requests them.
    OptionError
        If there is no such kind or mass, or they do not fit together.
    """
    stiffness, matrix, taken, reason, note = _core.laplacian(self._core, kind, mass, call(threads, progress))
    if note:
        warn(note)
    return Laplacian(_arrays.csr(stiffness), _arrays.mass(matrix), taken, reason)


@documented
def gradient(self: Mesh, *, threads: int | None = None, progress: Progress = None) -> Csr:
    """The gradient on faces of functions on vertices.

    Parameters
    ----------
    {run}

    Returns
    -------
    scipy.sparse.csr_matrix, shape (3 m, n)
        Row 3 f + a is coordinate a of the gradient on face f, so that
        `(G @ u).reshape(-1, 3)` has a vector for each face. Pointwise, in units of the
        function per mesh unit.
    """
    return _arrays.csr(_core.gradient(self._core, call(threads, progress)))


@documented
def divergence(self: Mesh, *, threads: int | None = None, progress: Progress = None) -> Csr:
    """The integrated divergence at vertices of fields on faces: -Gᵀ A.

    Parameters
    ----------
    {run}

    Returns
    -------
    scipy.sparse.csr_matrix, shape (n, 3 m)
        Acts on fields in the order of `gradient`; positive at sources, no flux through
        the boundary. `divergence @ gradient` is -S.
    """
    return _arrays.csr(_core.divergence(self._core, call(threads, progress)))


@documented
def vertex_normals(
    self: Mesh,
    weight: Literal["area", "angle", "sphere", "uniform"] = "angle",
    *,
    threads: int | None = None,
) -> Floats:
    """The outward unit normal of each vertex.

    Parameters
    ----------
    weight : {'area', 'angle', 'sphere', 'uniform'}
        Weight of a face: its area, its angle at the vertex, the weight that is exact on
        spheres, or equal weights.
    threads : int, optional
        Maximum number of threads.

    Returns
    -------
    ndarray, shape (n, 3)
        NaN where no normal is defined (isolated vertices, sums that cancel). Faces that
        disagree with the rest of their part are flipped for the computation, with a
        `FairingWarning`.
    """
    warn_of_orientation(self._core)
    return _arrays.unit_or_nan(self._core.vertex_normals(weight, call(threads)))


@ESTIMATOR.takes
@documented
def curvature(
    self: Mesh,
    estimator: Estimator = "adaptive",
    *,
    kind: Kind | None = None,
    threads: int | None = None,
    progress: Progress = None,
    **parameters: Unpack[EstimatorParameters],
) -> Curvature:
    """Estimates curvature at each vertex.

    Parameters
    ----------
    estimator : str
            The estimator; `adaptive` chooses its scale at each vertex:

        {estimators}
    {parameters_of_estimators}
    kind : str, optional
        The Laplacian of the estimator `cotangent`, with its barycentric mass; by default
        cotangents over mixed areas, or robust if a face is too thin.
    {run}

    Returns
    -------
    Curvature
        `mean`, `gaussian`, `kappa1`, `kappa2`, `direction1`, `direction2`, `mean_error`,
        `gaussian_error`, `scale`, `defined`, `boundary`: arrays in the order of the vertices, NaN
        where not `defined`.
        Positive on a sphere whose faces are counter-clockwise seen from outside. Faces that turn
        against the rest of their part are flipped for the computation, with a `FairingWarning`;
        on one-sided parts, such as a Möbius band, values refer to the side on which H is not
        negative.

    Raises
    ------
    ComputationError
        If the faces do not share their corners; see `Mesh.weld`.
    """
    values = ESTIMATOR.values(estimator, parameters, self._core.vertex_count)
    require_welded(self._core)
    warn_of_orientation(self._core)
    found = _core.curvature(self._core, estimator, values, kind, call(threads, progress))
    if found["too_thin"] is not None:
        warn(f"face {found['too_thin']} is too thin for cotangents; the robust operator is used")
    if found["defined"].size and not found["defined"].any():
        warn(f"{estimator} is undefined at every vertex: every value is NaN")
    first, second = found.pop("directions") or (None, None)
    errors = dict(zip(("mean_error", "gaussian_error", "scale"), found.pop("accuracy") or (None,) * 3))
    values = [found[name] for name in ("mean", "gaussian", "kappa1", "kappa2")]
    for array in (*values, first, second, *errors.values()):
        if array is not None:
            array[~found["defined"]] = np.nan
    return Curvature(estimator=estimator, direction1=first, direction2=second, **errors, **found)


@documented
def spectrum(
    self: Mesh,
    k: int = 10,
    kind: Kind = "auto",
    mass: MassKind = "barycentric",
    *,
    boundary: Literal["neumann", "dirichlet"] = "neumann",
    fixed: npt.ArrayLike = (),
    threads: int | None = None,
    progress: Progress = None,
) -> Spectrum:
    """The k smoothest modes of the Laplacian: S φ = ω M φ.

    Parameters
    ----------
    k : int
        Number of modes.
    kind : str
        One of {laplacians}, as in `laplacian`.
    mass : str
        One of {masses}.
    boundary : {'neumann', 'dirichlet'}
        Natural boundary (zero flux), or modes that vanish on the boundary.
    fixed : array_like of int or bool
        Further vertices where modes vanish.
    {run}

    Returns
    -------
    Spectrum
        `values` (k,), ascending, in 1 / squared mesh units; `modes` (n, k), orthonormal in
        the mass; `residuals` (k,); `certified`, true if an inertia count has verified that no
        mode is missing.

    Raises
    ------
    OptionError
        If there are fewer modes than k.
    ComputationError
        For the first face too thin for cotangents, if `kind` requests them, and if the faces
        do not share their corners; see `Mesh.weld`.
    """
    require_welded(self._core)
    pinned = _arrays.numbers(fixed, self._core.vertex_count, "fixed")
    core, taken, note = _core.spectrum(
        self._core, _arrays.whole(k, "k"), kind, mass, boundary, pinned, call(threads, progress)
    )
    if note:
        warn(note)
    return Spectrum._of(core, self._of(self._core), taken)


@documented
def heat(
    self: Mesh,
    temperatures: npt.ArrayLike,
    time: float | None = None,
    kind: Kind = "auto",
    mass: MassKind = "barycentric",
    *,
    steps: int = 1,
    threads: int | None = None,
    progress: Progress = None,
) -> Floats:
    """Diffuses heat by implicit steps: (M + tS) u = M u₀.

    For other fields at the same time, create one `HeatSolver`.

    Parameters
    ----------
    temperatures : array_like, shape (n,) or (n, d)
        Initial temperatures, of one field or of one in each column.
    time : float, optional
        Length of a step, in squared mesh units; by default the squared mean edge length.
    kind : str
        One of {laplacians}.
    mass : str
        One of {masses}.
    steps : int
        Number of steps.
    {run}

    Returns
    -------
    ndarray, shape of temperatures

    Examples
    --------
    >>> import numpy as np, pyfairing as pf
    >>> ball = pf.shapes.icosphere(3)
    >>> bool(np.ptp(ball.heat(ball.vertices), axis=0).max() < 2)   # each coordinate decays
    True
    """
    solver = HeatSolver(self, time, kind, mass, threads=threads)
    return solver.step(temperatures, steps=steps, threads=threads, progress=progress)


@documented
def poisson(
    self: Mesh,
    f: npt.ArrayLike,
    kind: Kind = "auto",
    mass: MassKind = "barycentric",
    *,
    fixed: npt.ArrayLike = (),
    values: npt.ArrayLike = (),
    threads: int | None = None,
    progress: Progress = None,
) -> Floats:
    """Solves -Δu = f with u prescribed at some vertices.

    Parameters
    ----------
    f : float or array_like, shape (n,) or (n, d)
        Pointwise values, of one problem or of one in each column; a number is constant.
    kind : str
        One of {laplacians}.
    mass : str
        One of {masses}.
    fixed : array_like of int, shape (j,)
        The vertices where u is prescribed.
    values : array_like, shape (j,) or (j, d)
        The values of u there, for all columns or for each.
    {run}

    Returns
    -------
    ndarray, shape (n,) or (n, d)
        On components without a fixed vertex the mean of f is subtracted, and u has mean
        zero.
    """
    n = self._core.vertex_count
    vertices = _arrays.numbers(fixed, n, "fixed")
    at_fixed, fixed_flat = _arrays.fields(values, len(vertices), "values")
    fields, flat = _arrays.fields(f, n, "f", constant=True)
    counts = {fields.shape[1], at_fixed.shape[1]} - {1}
    if len(counts) > 1:
        raise _core.OptionError(f"f has {fields.shape[1]} columns, but values {at_fixed.shape[1]}")
    d = counts.pop() if counts else 1
    fields, at_fixed = (np.broadcast_to(a, (len(a), d)) for a in (fields, at_fixed))
    u, note = _core.poisson(self._core, fields, vertices, at_fixed, kind, mass, call(threads, progress))
    if note:
        warn(note)
    return u[:, 0] if flat and fixed_flat else u


@documented
def info(self: Mesh, *, threads: int | None = None) -> dict[str, Any]:
    """Counts, topology, defects and measures, by the names of `fairing info --json`.

    Parameters
    ----------
    threads : int, optional
        Maximum number of threads.

    Returns
    -------
    dict
        Lengths, areas and volumes in mesh units; `genus` and `volume` are None if they are
        not defined. `hints` are remarks on normals and seams; `repair` mends defects.
    """
    return self._core.diagnosis(call(threads))


@documented
def polygon_laplacian(
    vertices: npt.ArrayLike,
    polygons: Any,
    mass: Literal["barycentric", "consistent"] = "barycentric",
    *,
    threads: int | None = None,
    progress: Progress = None,
) -> Laplacian:
    """Stiffness S and mass M of a polygon mesh, without splitting it into triangles.

    Each polygon is refined around one point, an affine combination of its corners; on triangles S is
    the cotangent stiffness. Polygons need not be flat.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Positions, in mesh units.
    polygons : sequence of sequences of int, or array_like of int, shape (m, k)
        The corners of each polygon, counter-clockwise seen from outside.
    mass : {'barycentric', 'consistent'}
        The row sums of the consistent mass, or the consistent mass itself.
    {run}

    Returns
    -------
    Laplacian
        As from `Mesh.laplacian`.

    Raises
    ------
    ComputationError
        For the first polygon that is too thin.
    """
    corners, sizes = _arrays.polygons(*_arrays.flat(polygons))
    stiffness, matrix = _core.polygon_laplacian(
        _arrays.vertices(vertices), corners, sizes, mass, call(threads, progress)
    )
    return Laplacian(_arrays.csr(stiffness), _arrays.mass(matrix), "polygon", "polygon was asked for")


@documented
def compare(
    mesh: Mesh,
    reference: Mesh,
    *,
    hausdorff_tolerance: float = 1e-4,
    unit: Literal["diagonal", "model"] = "diagonal",
    feature_angle: float = 30.0,
    threads: int | None = None,
    progress: Progress = None,
) -> Scores:
    """Scores a mesh against a reference.

    Reports distances between the surfaces in both directions, exact in double precision;
    angles between corresponding normals; changes of volume, area and edge length; flipped
    faces, self-intersections, and sharp edges lost and gained.

    Parameters
    ----------
    mesh, reference : Mesh
        Scores that compare element by element need the same faces.
    hausdorff_tolerance : float
        Largest gap between the two bounds of the Hausdorff distance; at least the rounding of
        the coordinates.
    unit : {'diagonal', 'model'}
        Of the tolerance: diagonals of the bounding box of the reference, or mesh units.
    feature_angle : float
        Smallest dihedral angle of a sharp edge, in degrees.
    {run}

    Returns
    -------
    Scores
        A mapping from the names of `fairing compare --json` to floats, lengths in diagonals
        of the reference. Scores that are not defined are in `Scores.missing`, with the reason.
    """
    if unit not in ("diagonal", "model"):
        raise _core.OptionError(f"unit is {unit!r}, but must be 'diagonal' or 'model'")
    size = reference.diagonal if unit == "model" else 1.0
    tolerance = float(hausdorff_tolerance) / size if size else float(hausdorff_tolerance)
    report, table = _core.compare(
        mesh._core, reference._core, tolerance, float(feature_angle), call(threads, progress)
    )
    return Scores(report, table)
