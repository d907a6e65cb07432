# A solution of ../q4_reconstruction.py.

import numpy as np
import pyfairing as pf
from pyfairing import grade
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import eigsh

mesh = pf.shapes.ellipsoid(1.0, 1.4, 0.7, level=3)
V, F = mesh.vertices, mesh.faces


# %%
def laplacian(V: np.ndarray, F: np.ndarray) -> tuple[csr_matrix, np.ndarray]:
    """S and the areas, as in question 3."""
    p = V[F]
    u, w = np.roll(p, -1, axis=1) - p, np.roll(p, -2, axis=1) - p
    sines = np.linalg.norm(np.cross(u, w), axis=2)
    cot = (u * w).sum(axis=2) / sines
    j, k = np.roll(F, -1, axis=1), np.roll(F, -2, axis=1)
    W = csr_matrix((np.r_[cot, cot].ravel() / 2, (np.r_[j, k].ravel(), np.r_[k, j].ravel())), shape=(len(V), len(V)))
    M = np.zeros(len(V))
    np.add.at(M, F, sines / 6)
    return diags(W.sum(axis=1).A1) - W, M


# %%
def modes(V: np.ndarray, F: np.ndarray, k: int) -> tuple[np.ndarray, np.ndarray]:
    """The k smallest eigenvalues, (k,), and a mode in each column, (n, k)."""
    S, M = laplacian(V, F)
    return eigsh(S, k, diags(M), sigma=-1e-6)


values, phi = modes(V, F, 15)
print(grade.eigenvalues(mesh, values))
print(grade.modes(mesh, phi))


# %%
def reconstruction(V: np.ndarray, F: np.ndarray, k: int) -> np.ndarray:
    """Positions from k modes, (n, 3)."""
    phi = modes(V, F, k)[1]
    return phi @ (phi.T @ (laplacian(V, F)[1][:, None] * V))


print(grade.reconstruction(mesh, reconstruction(V, F, 15), 15))
