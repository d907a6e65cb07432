"""Geometry processing on triangle meshes with the Laplacian.

>>> import pyfairing as pf
>>> mesh = pf.shapes.icosphere(3)                  # or pf.read("bunny.ply"), pf.Mesh(V, F)
>>> S, M = mesh.laplacian(kind="cotangent")
>>> c = mesh.curvature()
>>> bool(c.defined.all())
True

Everything is a method of `Mesh` or a function of two meshes. Arrays are numpy arrays, sparse
matrices scipy matrices. Lengths are in mesh units, as in the file; angles in options are in
degrees. Results are bitwise equal for any number of threads.
"""

from __future__ import annotations

from . import grade, shapes, surfaces, tasks
from ._calls import FairingWarning
from ._computing import compare, polygon_laplacian
from ._core import (
    ComputationError,
    FairingError,
    FlowError,
    InternalError,
    MeshError,
    OptionError,
    __version__,
)
from ._dataset import dataset
from ._diffusion import DiffusionOperators
from ._docs import COLOR_MAPS, DENOISERS, ESTIMATORS, LAPLACIANS, MASSES, METHODS
from ._elements import Moments
from ._geodesic import GeodesicSolver, Polyline
from ._heat import HeatSolver
from ._mesh import Mesh, read, read_bytes
from ._parts import Closest, Components
from ._pictures import View
from ._results import Curvature, Laplacian, NoiseLevel, Scores
from ._solvers import CholeskyFactor, cholesky, eigsh
from ._spectrum import Spectrum

__all__ = [
    "COLOR_MAPS",
    "DENOISERS",
    "ESTIMATORS",
    "LAPLACIANS",
    "MASSES",
    "METHODS",
    "CholeskyFactor",
    "Closest",
    "Components",
    "ComputationError",
    "Curvature",
    "DiffusionOperators",
    "FairingError",
    "FairingWarning",
    "FlowError",
    "GeodesicSolver",
    "HeatSolver",
    "InternalError",
    "Laplacian",
    "Mesh",
    "MeshError",
    "Moments",
    "NoiseLevel",
    "OptionError",
    "Polyline",
    "Scores",
    "Spectrum",
    "View",
    "__version__",
    "cholesky",
    "compare",
    "dataset",
    "eigsh",
    "grade",
    "polygon_laplacian",
    "read",
    "read_bytes",
    "shapes",
    "surfaces",
    "tasks",
]
