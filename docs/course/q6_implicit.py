# %% [markdown]
# # 6 Implicit smoothing
#
# Take steps (I - λL) x' = x, with L the uniform Laplacian: a linear system each. Which λ is good? Compare λ = 5
# at 10 and 50 steps with explicit steps of the same total time. Where does the shape go for λ = 100?
#
# Task text: CC BY 4.0, the Fairing developers. Code: MIT OR Apache-2.0.

# %%
import numpy as np
import pyfairing as pf
from pyfairing import grade

mesh = pf.shapes.cube(6).noise(0.2, seed=1)
V, F = mesh.vertices, mesh.faces


# %%
def implicit(V: np.ndarray, F: np.ndarray, lam: float, steps: int) -> np.ndarray:
    """Positions after the steps, (n, 3)."""
    raise NotImplementedError


print(grade.smoothed(mesh, implicit(V, F, 5.0, 10), "implicit", lam=5.0, iterations=10))
