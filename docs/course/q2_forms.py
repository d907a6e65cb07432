# %% [markdown]
# # 2 Fundamental forms of an ellipsoid
#
# p(u, v) = (a cos u sin v, b sin u sin v, c cos v) has the first form E du² + 2F du dv + G dv² and the second
# form L du² + 2M du dv + N dv². Derive both at any point, then write them as functions of u and v. State which
# way your normal points.
#
# Then find the normal curvature at (a, 0, 0) in every tangent direction. Which way do du and dv run there? Why
# are the forms of the pole (0, 0, c) of no use for it?
#
# Task text: CC BY 4.0, the Fairing developers. Code: MIT OR Apache-2.0.

# %%
import numpy as np
from pyfairing import grade

a, b, c = 3.0, 2.0, 1.0


# %%
def forms(u: float, v: float) -> tuple[float, float, float, float, float, float]:
    """E, F, G, L, M, N at a point."""
    raise NotImplementedError


print(grade.fundamental_forms((a, b, c), forms))


# %%
def normal_curvature(theta: np.ndarray) -> np.ndarray:
    """At (a, 0, 0), in the direction at the angle theta from +y towards +z."""
    raise NotImplementedError


print(normal_curvature(np.deg2rad([0, 30, 60, 90])))
