# A solution of ../q7_denoising.py.

import numpy as np
import pyfairing as pf
from pyfairing import grade
from scipy.sparse import csr_matrix

truth = pf.shapes.ellipsoid(1.0, 1.4, 0.7, level=3)


# %%
def noisy(V: np.ndarray, sigma: float) -> np.ndarray:
    """Positions with noise of the standard deviation sigma, in mesh units, (n, 3)."""
    return V + sigma * np.random.default_rng(1).normal(size=V.shape)


sigma = 0.2 * truth.mean_edge_length
mesh = truth.with_vertices(noisy(truth.vertices, sigma))
print(grade.noise(truth, mesh, sigma))


# %%
def denoised(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Positions after smoothing, (n, 3)."""
    a, b = F, np.roll(F, -1, axis=1)
    A = csr_matrix((np.ones(2 * F.size), (np.r_[a, b].ravel(), np.r_[b, a].ravel())), shape=(len(V), len(V)))
    A.data[:] = 1.0
    x = V
    for _ in range(3):
        x = x + 0.3 * (A @ x / A.sum(axis=1).A1[:, None] - x)
    return x


print(grade.denoised(mesh, denoised(mesh.vertices, mesh.faces), truth))
