# %% [markdown]
# # 1 Curvature from the uniform Laplacian
#
# Write both functions with numpy loops or sparse matrices. Do not call a library for the Laplacian or for
# curvature.
#
# * Mean curvature: the uniform Laplacian of a vertex is the mean of its neighbours minus the vertex; H is half
#   of its length, positive where the surface bends away from its outward normal, as on a sphere.
# * Gaussian curvature: 2π (at the border π) minus the sum of the angles at the vertex, over an area of the
#   vertex. Say which area you take.
#
# Is either a good approximation of the curvature of the smooth surface? Try finer meshes.
#
# Task text: CC BY 4.0, the Fairing developers. Code: MIT OR Apache-2.0.

# %%
import numpy as np
import pyfairing as pf
from pyfairing import grade

mesh = pf.shapes.flower(0.1)
V, F = mesh.vertices, mesh.faces


# %%
def mean_curvature(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """H at each vertex, (n,)."""
    raise NotImplementedError


print(grade.mean_curvature(mesh, mean_curvature(V, F), weights="uniform"))


# %%
def gaussian_curvature(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """K at each vertex, (n,)."""
    raise NotImplementedError


print(grade.gaussian_curvature(mesh, gaussian_curvature(V, F)))

# %% [markdown]
# Does the answer depend on the order of the faces, on the numbers of the vertices, on the axes?

# %%
print(grade.check(gaussian_curvature, mesh))
