# A solution of ../q6_implicit.py.

import numpy as np
import pyfairing as pf
from pyfairing import grade
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import splu

mesh = pf.shapes.cube(6).noise(0.2, seed=1)
V, F = mesh.vertices, mesh.faces


# %%
def implicit(V: np.ndarray, F: np.ndarray, lam: float, steps: int) -> np.ndarray:
    """Positions after the steps, (n, 3)."""
    a, b = F, np.roll(F, -1, axis=1)
    A = csr_matrix((np.ones(2 * F.size), (np.r_[a, b].ravel(), np.r_[b, a].ravel())), shape=(len(V), len(V)))
    A.data[:] = 1.0
    D = diags(A.sum(axis=1).A1)
    solver = splu((D - lam * (A - D)).tocsc())  # Times D, so that the matrix is symmetric.
    x = V
    for _ in range(steps):
        x = solver.solve(D @ x)
    return x


print(grade.smoothed(mesh, implicit(V, F, 5.0, 10), "implicit", lam=5.0, iterations=10))
