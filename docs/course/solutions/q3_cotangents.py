# A solution of ../q3_cotangents.py.

import numpy as np
import pyfairing as pf
from pyfairing import grade
from scipy.sparse import csr_matrix, diags

mesh = pf.shapes.flower(0.1)
V, F = mesh.vertices, mesh.faces


# %%
def laplacian(V: np.ndarray, F: np.ndarray) -> tuple[csr_matrix, np.ndarray]:
    """S, (n, n), and the areas on the diagonal of M, (n,)."""
    p = V[F]
    u, w = np.roll(p, -1, axis=1) - p, np.roll(p, -2, axis=1) - p
    sines = np.linalg.norm(np.cross(u, w), axis=2)
    cot = (u * w).sum(axis=2) / sines
    j, k = np.roll(F, -1, axis=1), np.roll(F, -2, axis=1)
    W = csr_matrix((np.r_[cot, cot].ravel() / 2, (np.r_[j, k].ravel(), np.r_[k, j].ravel())), shape=(len(V), len(V)))
    M = np.zeros(len(V))
    np.add.at(M, F, sines / 6)
    return diags(W.sum(axis=1).A1) - W, M


S, M = laplacian(V, F)
print(grade.laplacian(mesh, S, M))


# %%
def mean_curvature(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """H at each vertex, (n,)."""
    cross = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    normal = np.zeros_like(V)
    np.add.at(normal, F, cross[:, None])
    S, M = laplacian(V, F)
    vector = S @ V / M[:, None] / 2
    return (vector * normal).sum(axis=1) / np.linalg.norm(normal, axis=1)


print(grade.mean_curvature(mesh, mean_curvature(V, F)))
