# %% [markdown]
# # 3 Curvature from cotangents
#
# The stiffness S has the entries -½ (cot α + cot β) for the edge of two vertices, α and β the angles opposite
# it, and the row sums on its diagonal with the other sign; an edge of the border has one angle. The mass M has
# an area of each vertex. Then Δ = -M⁻¹ S, and Δx = -2Hn.
#
# Write S and M, then H. Does the estimate improve on that of the uniform Laplacian? What happens at the border?
#
# Task text: CC BY 4.0, the Fairing developers. Code: MIT OR Apache-2.0.

# %%
import numpy as np
import pyfairing as pf
from pyfairing import grade
from scipy.sparse import csr_matrix

mesh = pf.shapes.flower(0.1)
V, F = mesh.vertices, mesh.faces


# %%
def laplacian(V: np.ndarray, F: np.ndarray) -> tuple[csr_matrix, np.ndarray]:
    """S, (n, n), and the areas on the diagonal of M, (n,)."""
    raise NotImplementedError


S, M = laplacian(V, F)
print(grade.laplacian(mesh, S, M))


# %%
def mean_curvature(V: np.ndarray, F: np.ndarray) -> np.ndarray:
    """H at each vertex, (n,)."""
    raise NotImplementedError


print(grade.mean_curvature(mesh, mean_curvature(V, F)))
