# %% [markdown]
# # 4 Reconstruction from the smallest modes
#
# Solve S φ = ω M φ for the k smallest eigenvalues. Modes are orthonormal in the mass: φᵀ M φ = 1. Project the
# positions on them, x ≈ Σ φᵢ φᵢᵀ M x, for k = 5, 15 and 100. Does a larger k help? What is left out?
#
# Task text: CC BY 4.0, the Fairing developers. Code: MIT OR Apache-2.0.

# %%
import numpy as np
import pyfairing as pf
from pyfairing import grade

mesh = pf.shapes.ellipsoid(1.0, 1.4, 0.7, level=3)
V, F = mesh.vertices, mesh.faces


# %%
def modes(V: np.ndarray, F: np.ndarray, k: int) -> tuple[np.ndarray, np.ndarray]:
    """The k smallest eigenvalues, (k,), and a mode in each column, (n, k)."""
    raise NotImplementedError


values, phi = modes(V, F, 15)
print(grade.eigenvalues(mesh, values))
print(grade.modes(mesh, phi))


# %%
def reconstruction(V: np.ndarray, F: np.ndarray, k: int) -> np.ndarray:
    """Positions from k modes, (n, 3)."""
    raise NotImplementedError


print(grade.reconstruction(mesh, reconstruction(V, F, 15), 15))
