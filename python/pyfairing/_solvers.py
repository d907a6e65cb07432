"""Factorisations and eigenpairs of any symmetric scipy matrix, called as in scikit-sparse and scipy."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Floats
from ._calls import Progress, call, warn
from ._core import OptionError
from ._docs import documented


class CholeskyFactor:
    """A factorised matrix A, made by `cholesky`: `factor(b)` solves A x = b.

    Notes
    -----
    A factor can be pickled; it is factorised again where it is loaded.
    """

    def __init__(self, A: Any, beta: float = 0.0, *, threads: int | None = None) -> None:
        matrix = _square(A, "A")
        if beta:
            from scipy.sparse import identity

            matrix = _square(matrix + float(beta) * identity(matrix.shape[0]), "A")
        self._matrix = matrix
        self._core = _core.Factor(_parts(matrix), call(threads))

    @documented
    def __call__(self, b: npt.ArrayLike, *, threads: int | None = None, progress: Progress = None) -> Floats:
        """Solves A x = b.

        Parameters
        ----------
        b : array_like, shape (n,) or (n, k)
            One right-hand side, or one in each column.
        {run}

        Returns
        -------
        ndarray, shape of b

        Raises
        ------
        OptionError
            For another number of rows than A has, and for a value that is not finite.
        """
        right, flat = _arrays.fields(b, self._matrix.shape[0], "b")
        x = self._core.solve(right, call(threads, progress))
        return x[:, 0] if flat else x

    #: The names in scikit-sparse: until 0.4, and from 0.5 on.
    solve_A = solve = __call__

    def logdet(self) -> float:
        """The logarithm of the determinant of A, which itself may overflow."""
        return self._core.logdet()

    def __repr__(self) -> str:
        return f"CholeskyFactor({self._matrix.shape[0]} rows)"

    def __reduce__(self) -> Any:
        return type(self), (self._matrix,)


def cholesky(A: Any, beta: float = 0.0, *, threads: int | None = None) -> CholeskyFactor:
    """Factorises a sparse symmetric positive definite matrix.

    Called as `cholesky` of scikit-sparse 0.4 and `cho_factor` of 0.5.

    Ordering (nested dissection or minimum degree, by fill) and supernodes are chosen by the matrix.

    Parameters
    ----------
    A : scipy.sparse matrix or array, shape (n, n)
        Real, with both triangles: entries may differ from their mirror image by 1e-10 of the
        larger diagonal entry. scikit-sparse reads one triangle only.
    beta : float
        Factorises A + beta I.
    threads : int, optional
        Maximum number of threads. Results are bitwise equal for any number.

    Returns
    -------
    CholeskyFactor
        `factor(b)`, `factor.solve_A(b)` and `factor.solve(b)` solve A x = b for b of shape (n,)
        or (n, k); `factor.logdet()` is the logarithm of the determinant.

    Raises
    ------
    OptionError
        If A is not square, not symmetric or not finite; the error names row, column and value.
    ComputationError
        If A is not positive definite, or singular to rounding; the error names the row, its pivot
        and its diagonal entry.

    Examples
    --------
    >>> import numpy as np, pyfairing as pf
    >>> S, M = pf.shapes.icosphere(3).laplacian()
    >>> factor = pf.cholesky(S + M)
    >>> x = factor(M @ np.ones(642))                       # S 1 = 0
    >>> bool(abs(x - 1).max() < 1e-12)
    True
    """
    return CholeskyFactor(A, beta, threads=threads)


@documented
def eigsh(
    A: Any,
    k: int = 6,
    M: Any = None,
    sigma: float | None = None,
    which: Literal["LM", "SM", "SA"] = "LM",
    v0: None = None,
    ncv: None = None,
    maxiter: None = None,
    tol: float = 0,
    return_eigenvectors: bool = True,
    Minv: None = None,
    OPinv: None = None,
    mode: Literal["normal"] = "normal",
    *,
    threads: int | None = None,
    progress: Progress = None,
) -> Any:
    """The k smallest eigenvalues of A φ = λ M φ and their vectors, called as `scipy.sparse.linalg.eigsh`.

    An inertia count, the number of negative pivots of a factorisation, verifies that none is
    missing; a `FairingWarning` says if it could not. Other eigenvalues than the smallest are
    refused.

    Parameters
    ----------
    A : scipy.sparse matrix or array, shape (n, n)
        Real and symmetric, with both triangles; may be indefinite.
    k : int
        Number of eigenvalues, from 1 to n.
    M : scipy.sparse matrix or array, shape (n, n), optional
        Symmetric positive definite; by default the identity.
    sigma : float, optional
        Asks for the eigenvalues nearest to it, which must be the k smallest: 0, or any number
        below the spectrum.
    which : {'LM', 'SM', 'SA'}
        'LM' with `sigma`; without it 'SA', the smallest, or 'SM', the nearest to zero, which must
        be the smallest. 'LM' without `sigma`, scipy's default, asks for the largest and is
        refused.
    v0, ncv, maxiter, Minv, OPinv : None
        For scipy's calls; refused.
    tol : float
        The residual ‖A φ - λ M φ‖ in the M⁻¹ norm relative to the largest wanted eigenvalue
        (counted from below the spectrum if A is indefinite); 0 is 1e-9. Eigenvalues are about
        twice as many digits accurate.
    return_eigenvectors : bool
        Return vectors, too.
    mode : {'normal'}
        For scipy's calls.
    {run}

    Returns
    -------
    values : ndarray, shape (k,)
        Ascending.
    vectors : ndarray, shape (n, k)
        One in each column, orthonormal in M; only with `return_eigenvectors`.

    Raises
    ------
    OptionError
        For an argument that asks for what is not computed, by its name; for a matrix that is not
        square, symmetric and finite.
    ComputationError
        If M is not positive definite, or eigenvalues do not converge.

    Examples
    --------
    >>> import pyfairing as pf
    >>> S, M = pf.shapes.icosphere(3).laplacian()
    >>> values, vectors = pf.eigsh(S, 4, M, sigma=0)
    >>> values.round(1).tolist()
    [0.0, 2.0, 2.0, 2.0]
    """
    given = {"v0": v0, "ncv": ncv, "maxiter": maxiter, "Minv": Minv, "OPinv": OPinv}
    for name, value in given.items():
        if value is not None:
            raise OptionError(f"{name} is given, but pyfairing.eigsh makes no use of it")
    if mode != "normal":
        raise OptionError(f"mode is {mode!r}, but must be 'normal'")
    allowed = ("SA", "SM") if sigma is None else ("LM",)
    if which not in allowed:
        kind = "without sigma" if sigma is None else "with sigma"
        text = f"which is {which!r} {kind}, but must be {' or '.join(map(repr, allowed))}"
        raise OptionError(f"{text}: only the smallest eigenvalues are computed")
    if not 0 <= tol < 1:
        raise OptionError(f"tol is {tol}, but must be from 0 to 1")
    matrix = _square(A, "A")
    n, wanted = matrix.shape[0], _arrays.whole(k, "k")
    if not 1 <= wanted <= n:
        raise OptionError(f"k is {wanted}, but must be from 1 to {n}")
    diagonal, full = (None, None) if M is None else _mass(M, n)
    values, vectors, certified, following = _core.eigsh(
        _parts(matrix), diagonal, full, wanted, tol or None, call(threads, progress)
    )
    if sigma is not None or which == "SM":
        _require_nearest(values, following, 0.0 if sigma is None else float(sigma), "sigma")
    if not certified:
        warn("the inertia count is not reliable: an eigenvalue may be missing")
    return (values, vectors) if return_eigenvectors else values


def _require_nearest(values: Floats, following: float, sigma: float, name: str) -> None:
    """Refuses values that are not the nearest to sigma; none that is missing is below `following`."""
    if len(values) and sigma - values[0] > max(following - sigma, 0.0):
        raise OptionError(
            f"{name} is {sigma:g}, but the {len(values)} eigenvalues nearest to it are not the smallest,"
            f" from {values[0]:g} to {values[-1]:g}, which alone are computed"
        )


def _square(A: Any, name: str) -> Any:
    """A copy in CSR with ascending columns, of real numbers, without stored zeros."""
    from scipy.sparse import csr_matrix, issparse

    if not issparse(A):
        raise TypeError(f"{name} must be a scipy.sparse matrix, not {type(A).__name__}")
    if A.dtype.kind not in "fiub":
        raise TypeError(f"{name} must have real numbers, not {A.dtype}")
    if A.shape[0] != A.shape[1]:
        raise OptionError(f"{name} has the shape {A.shape}, but must be square")
    matrix = csr_matrix(A, dtype=np.float64, copy=True)
    matrix.sum_duplicates()
    matrix.eliminate_zeros()
    bad = np.flatnonzero(~np.isfinite(matrix.data))
    if len(bad):
        row = int(np.searchsorted(matrix.indptr, bad[0], side="right")) - 1
        raise OptionError(f"{name}: entry ({row}, {matrix.indices[bad[0]]}) is {matrix.data[bad[0]]}")
    return matrix


def _parts(matrix: Any) -> Any:
    return matrix.indptr.astype(np.uint32), matrix.indices.astype(np.uint32), matrix.data


def _mass(M: Any, n: int) -> tuple[Floats | None, Any]:
    """The diagonal if M has no other entries, or else its parts."""
    matrix = _square(M, "M")
    if matrix.shape[0] != n:
        raise OptionError(f"M has the shape {matrix.shape}, but must have ({n}, {n})")
    diagonal = matrix.diagonal()
    if matrix.nnz == np.count_nonzero(diagonal):
        return diagonal, None
    difference = abs(matrix - matrix.T).tocoo()
    if difference.nnz and difference.data.max() > 1e-10 * abs(diagonal).max():
        worst = int(difference.data.argmax())
        place = int(difference.row[worst]), int(difference.col[worst])
        raise OptionError(f"M: entry {place} differs from its mirror image by {difference.data[worst]:g}")
    try:
        _core.Factor(_parts(matrix), call())
    except _core.ComputationError as error:
        raise _core.ComputationError(str(error).replace("A:", "M:", 1)) from None
    return None, _parts(matrix)
