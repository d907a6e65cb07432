# %% [markdown]
# # 7 Denoising under growing noise
#
# Add Gaussian noise of σ = 0.2 mean edge lengths along each axis, then remove it with your smoothing. Repeat
# with 0.1 and 0.5. State σ in mesh units, in mean edge lengths and in diagonals of the bounding box. When does
# smoothing help, and when does it fail? Compare edges with flat parts.
#
# Task text: CC BY 4.0, the Fairing developers. Code: MIT OR Apache-2.0.

# %%
import numpy as np
import pyfairing as pf
from pyfairing import grade

truth = pf.shapes.ellipsoid(1.0, 1.4, 0.7, level=3)


# %%
def noisy(V: np.ndarray, sigma: float) -> np.ndarray:
    """Positions with noise of the standard deviation sigma, in mesh units, (n, 3)."""
    raise NotImplementedError


sigma = 0.2 * truth.mean_edge_length
mesh = truth.with_vertices(noisy(truth.vertices, sigma))
print(grade.noise(truth, mesh, sigma))


# %%
def denoised(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Positions after smoothing, (n, 3)."""
    raise NotImplementedError


print(grade.denoised(mesh, denoised(mesh.vertices, mesh.faces), truth))
