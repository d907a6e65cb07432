# %% [markdown]
# # 5 Explicit smoothing
#
# Take steps x ← x + λ L x, with L the uniform Laplacian. Which λ is good? Try 0.01, 0.05, 1 and 2: what happens
# beyond the largest stable step, and why? (The eigenvalues of L are between -2 and 0.)
#
# Task text: CC BY 4.0, the Fairing developers. Code: MIT OR Apache-2.0.

# %%
import numpy as np
import pyfairing as pf
from pyfairing import grade

mesh = pf.shapes.cube(6).noise(0.2, seed=1)
V, F = mesh.vertices, mesh.faces


# %%
def explicit(V: np.ndarray, F: np.ndarray, lam: float, steps: int) -> np.ndarray:
    """Positions after the steps, (n, 3)."""
    raise NotImplementedError


print(grade.smoothed(mesh, explicit(V, F, 0.3, 10), "explicit", lam=0.3, iterations=10))
