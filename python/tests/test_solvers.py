"""Factorisations and eigenpairs of scipy matrices, against scipy; operators of DiffusionNet."""

from __future__ import annotations

import pickle
from collections.abc import Callable

import numpy as np
import pyfairing as pf
import pytest

sparse = pytest.importorskip("scipy.sparse")
linalg = pytest.importorskip("scipy.sparse.linalg")


def random_symmetric(n: int, seed: int, density: float = 0.05) -> sparse.csr_matrix:
    half = sparse.random(n, n, density, random_state=np.random.default_rng(seed))
    return sparse.csr_matrix(half + half.T)


@pytest.mark.parametrize("kind", [sparse.csr_matrix, sparse.csc_matrix, sparse.coo_array])
def test_a_factor_solves(kind: Callable[[object], object], sphere: pf.Mesh) -> None:
    S, M = sphere.laplacian()
    A = S + 0.3 * M
    factor = pf.cholesky(kind(A))
    b = sphere.vertices
    expected = linalg.spsolve(A.tocsc(), b)
    np.testing.assert_allclose(factor(b), expected, atol=1e-12)
    np.testing.assert_array_equal(factor(b[:, 0]), factor.solve_A(b)[:, 0])
    np.testing.assert_array_equal(factor(b), factor.solve(b))
    np.testing.assert_allclose(factor.logdet(), np.linalg.slogdet(A.toarray())[1], rtol=1e-12)
    again = pickle.loads(pickle.dumps(factor))
    np.testing.assert_array_equal(again(b), factor(b))
    assert repr(again) == "CholeskyFactor(642 rows)"
    np.testing.assert_allclose(pf.cholesky(S, beta=0.5)(S @ b + 0.5 * b), b, atol=1e-12)


def test_a_factor_is_that_of_scikit_sparse(bumpy: pf.Mesh) -> None:
    cholmod = pytest.importorskip("sksparse.cholmod")
    # From 0.5 on `cholesky` returns matrices.
    names = ("cho_factor", "solve") if hasattr(cholmod, "cho_factor") else ("cholesky", "solve_A")
    factorise = getattr(cholmod, names[0])
    S, M = bumpy.laplacian()
    b = bumpy.vertices
    for A, beta in ((S + M, 0.0), (S, 0.1)):
        # It warns of other formats than CSC.
        theirs, ours = (function(A.tocsc(), beta=beta) for function in (factorise, pf.cholesky))
        for right in (b, b[:, 0]):
            solutions = [getattr(factor, names[1])(right) for factor in (theirs, ours)]
            np.testing.assert_allclose(*solutions, rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(ours.logdet(), theirs.logdet(), rtol=1e-12)
    for function, error in ((factorise, cholmod.CholmodError), (pf.cholesky, pf.ComputationError)):
        with pytest.raises(error, match="not positive definite"):
            function((S - M).tocsc())


def test_stored_zeros_and_single_precision_are_fine() -> None:
    A = sparse.coo_matrix(([2, 1, 1, 0, 2], ([0, 0, 1, 0, 1], [0, 1, 0, 1, 1])), dtype=np.float32)
    np.testing.assert_allclose(pf.cholesky(A)([3, 3]), [1, 1])
    lower = sparse.csr_matrix((np.array([1.0, 0.0, 1.0]), ([0, 1, 1], [0, 0, 1])), (2, 2))
    assert pf.cholesky(lower).logdet() == 0


def test_bad_matrices_are_named() -> None:
    good = sparse.identity(3, format="lil")
    lonely, nan, negative, zero = (good.copy() for _ in range(4))
    lonely[0, 2], nan[1, 1], negative[1, 1], zero[2, 2] = 0.5, np.nan, -4.0, 0.0
    for A, error, text in [
        (lonely, pf.OptionError, r"A: entry \(0, 2\) differs from its mirror image by 5e-1"),
        (nan, pf.OptionError, r"A: entry \(1, 1\) is nan"),
        (negative, pf.ComputationError, "A: the matrix is not positive definite: pivot -4e0 in row 1"),
        (zero, pf.ComputationError, "A: the matrix is singular: pivot 0e0 in row 2"),
        (sparse.csr_matrix((2, 3)), pf.OptionError, r"A has the shape \(2, 3\)"),
        (good.astype(complex), TypeError, "A must have real numbers"),
        (np.eye(3), TypeError, "A must be a scipy.sparse matrix"),
    ]:
        with pytest.raises(error, match=text):
            pf.cholesky(A)
    factor = pf.cholesky(good)
    for b, error in [(np.ones(4), pf.OptionError), ([1, np.inf, 2], pf.OptionError), (["a"], TypeError)]:
        with pytest.raises(error, match="b "):
            factor(b)
    with pytest.raises(TypeError, match="b must be real numbers, not a csr_matrix"):
        factor(sparse.csr_matrix((3, 1)))


@pytest.mark.parametrize("n", [30, 450])
@pytest.mark.parametrize("k", [1, 6, 25])
def test_eigenvalues_are_those_of_scipy(n: int, k: int) -> None:
    A, half = random_symmetric(n, 1), random_symmetric(n, 2, 0.01)
    for M in (None, sparse.diags(np.linspace(0.5, 2, n)), half + 10 * sparse.identity(n)):
        values, vectors = pf.eigsh(A, k, M, which="SA")
        dense = np.eye(n) if M is None else M.toarray()
        root = np.linalg.inv(np.linalg.cholesky(dense))
        expected = np.linalg.eigvalsh(root @ A.toarray() @ root.T)[:k]
        np.testing.assert_allclose(values, expected, atol=1e-9)
        np.testing.assert_allclose(vectors.T @ dense @ vectors, np.eye(k), atol=1e-9)
        np.testing.assert_allclose(A @ vectors, dense @ vectors * values, atol=1e-6)
        assert len(pf.eigsh(A, k, M, which="SA", return_eigenvectors=False)) == k


def test_calls_of_scipy_give_the_values_of_scipy(bumpy: pf.Mesh) -> None:
    S, M = bumpy.laplacian()
    for calls in ({"sigma": -1e-2}, {"sigma": 1e-8}, {"which": "SM"}, {"which": "SA"}):
        values, _ = pf.eigsh(S, 12, M, **calls)
        expected = linalg.eigsh(S, 12, M, sigma=-1e-2, return_eigenvectors=False)
        np.testing.assert_allclose(values, np.sort(expected), rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(values, bumpy.spectrum(12).values)


def test_what_is_not_computed_is_named(sphere: pf.Mesh) -> None:
    S, M = sphere.laplacian()
    skew = sparse.lil_matrix(M + 0.1 * S)
    skew[0, 5] += 1.0
    for calls, error, text in [
        ({}, pf.OptionError, "which is 'LM' without sigma"),
        ({"which": "LA"}, pf.OptionError, "which is 'LA'"),
        ({"sigma": 0, "which": "SA"}, pf.OptionError, "which is 'SA' with sigma"),
        ({"sigma": 30.0}, pf.OptionError, "sigma is 30, but the 6 eigenvalues nearest"),
        ({"sigma": 0, "v0": np.ones(642)}, pf.OptionError, "v0 is given"),
        ({"sigma": 0, "ncv": 20}, pf.OptionError, "ncv is given"),
        ({"sigma": 0, "mode": "buckling"}, pf.OptionError, "mode is 'buckling'"),
        ({"sigma": 0, "tol": -1}, pf.OptionError, "tol is -1"),
        ({"sigma": 0, "k": 643}, pf.OptionError, "k is 643"),
        ({"sigma": 0, "k": 0}, pf.OptionError, "k is 0"),
        ({"sigma": 0, "M": sparse.identity(5)}, pf.OptionError, r"M has the shape \(5, 5\)"),
        ({"sigma": 0, "M": -M}, pf.ComputationError, "M: mass -.* of row 0 is not positive"),
        ({"sigma": 0, "M": M - S}, pf.ComputationError, "M: "),
        ({"sigma": 0, "M": skew}, pf.OptionError, r"M: entry \(\d+, \d+\) differs"),
    ]:
        with pytest.raises(error, match=text):
            pf.eigsh(S, **calls)
    with pytest.raises(pf.OptionError, match="sigma is 0, but"):
        pf.eigsh(S - 30 * M, 6, M, which="SM")


def reference(V: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Frames, mass and dense gradients by the formulas of DiffusionNet, vertex by vertex."""
    n = len(V)
    a, b, c = V[F].transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    length = np.linalg.norm(across, axis=1, keepdims=True)
    normals, mass = np.zeros((n, 3)), np.zeros(n)
    for corner in F.T:
        # Their normals are divided by their length plus 1e-6.
        np.add.at(normals, corner, across / (length + 1e-6))
        np.add.at(mass, corner, length[:, 0] / 6)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    mass += 1e-8 * mass.mean()
    gradients, frames = np.zeros((2, n, n)), np.zeros((n, 3, 3))
    for v, normal in enumerate(normals):
        axis = np.array([1.0, 0, 0] if abs(normal[0]) < 0.9 else [0, 1.0, 0])
        x = axis - (axis @ normal) * normal
        x /= np.linalg.norm(x) + 1e-6
        frames[v] = x, np.cross(normal, x), normal
        ring = np.setdiff1d(F[(F == v).any(axis=1)], [v])
        edges = (V[ring] - V[v]) @ frames[v, :2].T
        fit = np.linalg.inv(edges.T @ edges + 1e-5 * np.eye(2)) @ edges.T
        gradients[:, v, ring] = fit
        gradients[:, v, v] = -fit.sum(axis=1)
    return frames, mass, gradients[0], gradients[1]


@pytest.mark.parametrize("name", ["bumpy", "patch"])
def test_diffusion_operators_are_those_of_diffusion_net(name: str, request: pytest.FixtureRequest) -> None:
    mesh: pf.Mesh = request.getfixturevalue(name)
    found = mesh.diffusion_operators(10)
    frames, mass, x, y = reference(mesh.vertices, mesh.faces.astype(int))
    # Their 1e-6 beside the doubled area of a face, here 0.003 and more.
    np.testing.assert_allclose(found.frames, frames, atol=1e-3)
    np.testing.assert_allclose(found.mass, mass, rtol=1e-12)
    for ours, theirs in ((found.gradX, x), (found.gradY, y)):
        assert (ours != 0).nnz <= 2 * len(mesh.edges) + mesh.n_vertices
        np.testing.assert_allclose(ours.toarray(), theirs, atol=1e-3 * abs(theirs).max())
    L = found.L
    np.testing.assert_allclose(L @ found.evecs, found.mass[:, None] * found.evecs * found.evals, atol=1e-6)
    np.testing.assert_allclose(found.evecs.T @ (found.mass[:, None] * found.evecs), np.eye(10), atol=1e-7)
    assert found.evals[0] == 0 and (L @ mesh.vertices * mesh.vertices).sum() > 0


def test_modes_of_diffusion_net(bumpy: pf.Mesh) -> None:
    pp3d = pytest.importorskip("potpourri3d")
    V, F = np.array(bumpy.vertices), bumpy.faces.astype(int)
    L = pp3d.cotan_laplacian(V, F, denom_eps=1e-10)
    mass = pp3d.vertex_areas(V, F)
    mass += 1e-8 * mass.mean()
    theirs = L + 1e-8 * sparse.identity(len(V))
    evals = linalg.eigsh(theirs.tocsc(), 20, sparse.diags(mass), sigma=1e-8)[0]
    found = bumpy.diffusion_operators(20)
    np.testing.assert_allclose(found.mass, mass, rtol=1e-12)
    np.testing.assert_allclose(found.L.toarray(), L.toarray(), atol=1e-9)
    np.testing.assert_allclose(found.evals, np.sort(evals), atol=2e-5)


def test_gradients_without_regularization_are_exact_on_a_plane() -> None:
    plane = pf.shapes.irregular_plane(0.1)
    found = plane.diffusion_operators(0, regularization=1e-13)
    field = plane.vertices @ [2.0, -3.0, 0.0]
    np.testing.assert_allclose(found.gradX @ field, 2.0, rtol=1e-8)
    np.testing.assert_allclose(found.gradY @ field, -3.0, rtol=1e-8)
    assert found.evals.shape == (0,) and found.evecs.shape == (plane.n_vertices, 0)
    with pytest.raises(pf.OptionError, match="regularization is 0"):
        plane.diffusion_operators(0, regularization=0)


def test_isolated_vertices_have_no_gradient(sphere: pf.Mesh) -> None:
    mesh = pf.Mesh(np.vstack([sphere.vertices, [[5, 5, 5]]]), sphere.faces)
    found = mesh.diffusion_operators(3)
    np.testing.assert_array_equal(found.frames[-1], np.eye(3))
    assert found.mass[-1] > 0 and abs(found.gradX[-1]).sum() == 0 and (found.evecs[-1] == 0).all()


def test_a_mass_that_is_not_positive_definite_is_named() -> None:
    a = sparse.csr_matrix([[-1.0, 0.5], [0.5, -1.0]])
    for mass, words in (([[1.0, 2.0], [2.0, 1.0]], "definite: pivot -3e0 in row 1"), (np.ones((2, 2)), "singular")):
        with pytest.raises(pf.ComputationError, match=f"^M: the matrix is .*{words}"):
            pf.eigsh(a, 1, sparse.csr_matrix(mass), which="SA")
