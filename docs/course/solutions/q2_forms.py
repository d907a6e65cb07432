# A solution of ../q2_forms.py.

import numpy as np
from pyfairing import grade

a, b, c = 3.0, 2.0, 1.0


# %%
def forms(u: float, v: float) -> tuple[float, float, float, float, float, float]:
    """E, F, G, L, M, N at a point."""
    pu = np.array([-a * np.sin(u) * np.sin(v), b * np.cos(u) * np.sin(v), 0.0])
    pv = np.array([a * np.cos(u) * np.cos(v), b * np.sin(u) * np.cos(v), -c * np.sin(v)])
    puu = np.array([-a * np.cos(u) * np.sin(v), -b * np.sin(u) * np.sin(v), 0.0])
    puv = np.array([-a * np.sin(u) * np.cos(v), b * np.cos(u) * np.cos(v), 0.0])
    pvv = -np.array([a * np.cos(u) * np.sin(v), b * np.sin(u) * np.sin(v), c * np.cos(v)])
    inward = np.cross(pu, pv)
    n = inward / np.linalg.norm(inward)
    return pu @ pu, pu @ pv, pv @ pv, puu @ n, puv @ n, pvv @ n


print(grade.fundamental_forms((a, b, c), forms))


# %%
def normal_curvature(theta: np.ndarray) -> np.ndarray:
    """At (a, 0, 0), in the direction at the angle theta from +y towards +z."""
    # du runs along +y, dv along -z: E = b², G = c², L = N = a, F = M = 0. At the pole E = 0: no chart there.
    return a * (np.cos(theta) ** 2 / b**2 + np.sin(theta) ** 2 / c**2)


print(normal_curvature(np.deg2rad([0, 30, 60, 90])))
