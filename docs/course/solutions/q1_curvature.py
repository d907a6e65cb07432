# A solution of ../q1_curvature.py.

import numpy as np
import pyfairing as pf
from pyfairing import grade
from scipy.sparse import csr_matrix

mesh = pf.shapes.flower(0.1)
V, F = mesh.vertices, mesh.faces


# %%
def mean_curvature(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """H at each vertex, (n,)."""
    a, b = F, np.roll(F, -1, axis=1)
    A = csr_matrix((np.ones(2 * F.size), (np.r_[a, b].ravel(), np.r_[b, a].ravel())), shape=(len(V), len(V)))
    A.data[:] = 1.0
    cross = np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]])
    normal = np.zeros_like(V)
    np.add.at(normal, F, cross[:, None])
    delta = A @ V / A.sum(axis=1).A1[:, None] - V
    return np.where((delta * normal).sum(axis=1) < 0, 0.5, -0.5) * np.linalg.norm(delta, axis=1)


print(grade.mean_curvature(mesh, mean_curvature(V, F), weights="uniform"))


# %%
def gaussian_curvature(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """K at each vertex, (n,)."""
    p = V[F]
    u, w = np.roll(p, -1, axis=1) - p, np.roll(p, -2, axis=1) - p
    sines = np.linalg.norm(np.cross(u, w), axis=2)
    defect = np.full(len(V), 2 * np.pi)
    edges = np.vstack([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]])
    single, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    defect[np.unique(single[counts == 1])] = np.pi
    np.add.at(defect, F, -np.arctan2(sines, (u * w).sum(axis=2)))
    area = np.zeros(len(V))
    np.add.at(area, F, sines / 6)  # A third of each face: barycentric.
    return defect / area


print(grade.gaussian_curvature(mesh, gaussian_curvature(V, F)))

# %%
print(grade.check(gaussian_curvature, mesh))
