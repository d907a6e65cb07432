"""Operators for learning on surfaces, in the conventions of DiffusionNet."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from . import _arrays
from ._arrays import Csr, Floats, Indices
from ._calls import Progress
from ._core import OptionError
from ._docs import documented

if TYPE_CHECKING:
    from ._mesh import Mesh
    from ._names import Kind

#: Fraction of the mean mass that is added to each, as in DiffusionNet.
_ADDED_MASS = 1e-8


class DiffusionOperators(NamedTuple):
    """Operators of a mesh, by the names and in the order of DiffusionNet.

    Attributes
    ----------
    frames : ndarray, shape (n, 3, 3)
        Rows X, Y and unit normal of a right-handed frame at each vertex.
    mass : ndarray, shape (n,)
        Barycentric areas plus 1e-8 of their mean, in squared mesh units; positive.
    L : scipy.sparse.csr_matrix, shape (n, n)
        The stiffness, positive semi-definite; nothing is added.
    evals : ndarray, shape (k,)
        Eigenvalues of `L φ = λ mass φ`, ascending, not negative.
    evecs : ndarray, shape (n, k)
        Their modes, orthonormal in the mass without the addition.
    gradX, gradY : scipy.sparse.csr_matrix, shape (n, n)
        The components of the gradient along X and Y, pointwise, in units of the function per mesh
        unit.
    """

    frames: Floats
    mass: Floats
    L: Csr
    evals: Floats
    evecs: Floats
    gradX: Csr
    gradY: Csr


@documented
def diffusion_operators(
    self: Mesh,
    k: int = 128,
    kind: Kind = "auto",
    *,
    regularization: float = 1e-5,
    threads: int | None = None,
    progress: Progress = None,
) -> DiffusionOperators:
    """Mass, Laplacian, modes and vertex gradients, as DiffusionNet's `get_operators`.

    With n the mean of the unit normals of the faces at a vertex, X is the part of the x axis across
    n (of the y axis if n is within 26° of x), Y = n × X. The gradient at a vertex is the least
    squares fit to the differences along its edges e, in the plane of X and Y:

        (Σ e eᵀ + r I) g = Σ e (u_j - u_i)

    Parameters
    ----------
    k : int
        Number of modes; 0 for none.
    kind : str
        The Laplacian: one of {laplacians}, with its barycentric mass.
    regularization : float
        r, in squared mesh units. DiffusionNet has 1e-5 whatever the size of the mesh, which
        shortens gradients where edges are not long beside 0.003: scale the mesh to a diameter of
        about 1, or choose less.
    {run}

    Returns
    -------
    DiffusionOperators
        `frames, mass, L, evals, evecs, gradX, gradY`: numpy arrays and scipy matrices. An isolated
        vertex has the frame of the axes, no gradient and zero in all modes. The sign and the basis
        of modes are arbitrary.

    Raises
    ------
    OptionError
        If the regularization is not positive, or there are fewer modes than k.
    ComputationError
        As `spectrum`.

    Examples
    --------
    >>> import numpy as np, pyfairing as pf
    >>> ball = pf.shapes.icosphere(3)
    >>> frames, mass, L, evals, evecs, gradX, gradY = ball.diffusion_operators(16)
    >>> z = ball.vertices[:, 2]
    >>> slope = np.hypot(gradX @ z, gradY @ z)             # |∇z| = √(1 - z²)
    >>> bool(abs(slope - np.sqrt(1 - z**2)).max() < 0.03)
    True
    """
    from scipy.sparse import csr_matrix

    if not 0 < regularization < np.inf:
        raise OptionError(f"regularization is {regularization}, but must be positive")
    k = _arrays.whole(k, "k")
    stiffness, matrix = self.laplacian(kind, "barycentric", threads=threads)
    mass = matrix.diagonal()
    mass += _ADDED_MASS * mass.mean()
    n = self.n_vertices
    evals, evecs = np.zeros(0), np.zeros((n, 0))
    if k:
        spectrum = self.spectrum(k, kind, threads=threads, progress=progress)
        evals, evecs = spectrum.values, spectrum.modes

    frames = _frames(self.vertex_normals("uniform", threads=threads))
    ends = self.edges.astype(np.int64)
    start, end = np.concatenate([ends, ends[:, ::-1]]).T
    edges = np.einsum("eij,ej->ei", frames[start, :2], self.vertices[end] - self.vertices[start])
    x, y = edges.T
    xx, xy, yy = (_sums(start, products, n) for products in (x * x, x * y, y * y))
    xx, yy = xx + regularization, yy + regularization
    determinant = xx * yy - xy * xy
    slopes = (
        (yy[start] * x - xy[start] * y) / determinant[start],
        (xx[start] * y - xy[start] * x) / determinant[start],
    )
    own = np.arange(n)
    rows, columns = np.concatenate([own, start]), np.concatenate([own, end])
    gradX, gradY = (
        csr_matrix((np.concatenate([-_sums(start, slope, n), slope]), (rows, columns)), (n, n))
        for slope in slopes
    )
    return DiffusionOperators(frames, mass, stiffness, evals, evecs, gradX, gradY)


def _sums(vertices: Indices, values: Floats, n: int) -> Floats:
    """The sum of the values at each vertex."""
    return np.asarray(np.bincount(vertices, values, minlength=n), dtype=np.float64)


def _frames(normals: Floats) -> Floats:
    """Rows X, Y, normal; the axes where there is no normal."""
    normals = np.where(np.isnan(normals), [0.0, 0.0, 1.0], normals)
    axis = np.where(abs(normals[:, :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    x = axis - np.sum(axis * normals, axis=1, keepdims=True) * normals
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    return np.asarray(np.stack([x, np.cross(normals, x), normals], axis=1), dtype=np.float64)
