"""A judge for exercises on the Laplacian: answers against ours, and what explains a difference.

>>> import pyfairing as pf
>>> mesh = pf.shapes.torus()
>>> H = mesh.curvature("cotangent").mean
>>> print(pf.grade.mean_curvature(mesh, H).verdict)
right
>>> print(pf.grade.mean_curvature(mesh, -2 * H).verdict)
mistake: 2H instead of H (the last ½); by convention: the other sign, negative on spheres

Every function takes the mesh and the answer: an array, or the path of a .npy, .npz, .csv, .txt,
.mat or .mtx file, or of a mesh with a field, as in `out.ply:quality`. It returns a `Report`, whose
text begins with the verdict. Conventions are tried alone and in pairs; the first that bring the
difference to rounding are named, with their place in the formula. `right` and `right by another
convention` are no mistakes. Tolerance: 10⁻⁵ of the value plus 2 · 10⁻⁷ of the terms that it sums.
Errors in the shape of an answer raise an `OptionError`.

`python -m pyfairing.grade q3 mesh.obj H.npy` is the same as a command; with a folder in place of
the file it grades every submission and writes a table.
"""

from __future__ import annotations

from ._global import eigenvalues, fundamental_forms, heat, modes, poisson, reconstruction, smoothed
from ._invariance import check
from ._local import gaussian_curvature, laplacian, mass, mean_curvature, principal_curvatures, vertex_normals
from ._moved import denoised, noise
from ._report import Convention, Report

__all__ = [
    "Convention",
    "Report",
    "check",
    "denoised",
    "eigenvalues",
    "fundamental_forms",
    "gaussian_curvature",
    "heat",
    "laplacian",
    "mass",
    "mean_curvature",
    "modes",
    "noise",
    "poisson",
    "principal_curvatures",
    "reconstruction",
    "smoothed",
    "vertex_normals",
]
