"""Names and parameters, for type checkers: written and checked by `tests/test_names.py`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias, TypedDict

import numpy.typing as npt

#: A vertex, its weight, and its target position, by default its own.
Soft: TypeAlias = "Iterable[tuple[int, float] | tuple[int, float, npt.ArrayLike]]"

Estimator = Literal[
    "adaptive",
    "cotangent",
    "steiner",
    "normal-cycle",
    "corrected",
    "corrected-ball",
    "face-tensor",
    "quadric",
    "jet2",
    "jet3",
    "jet4",
]

Method = Literal[
    "explicit",
    "implicit",
    "mean-curvature",
    "conformal",
    "taubin",
    "windowed-sinc",
    "hc",
    "scale-dependent",
    "low-pass",
    "region",
]

Denoiser = Literal[
    "automatic",
    "bilateral",
    "non-iterative",
    "fast-effective",
    "bilateral-normal",
    "bilateral-normal-global",
    "l0",
    "total-variation",
    "guided-normal",
    "total-generalised-variation",
]

Kind = Literal["auto", "non-negative", "uniform", "cotangent", "robust", "polygon"]

MassKind = Literal["barycentric", "mixed", "voronoi", "consistent", "degree", "unit"]

ColorMap = Literal["viridis", "cividis", "magma", "turbo", "coolwarm", "hue"]

NoiseKind = Literal[
    "normal",
    "axes",
    "direction",
    "uniform",
    "impulsive",
    "correlated",
    "varying",
    "rays",
    "depth-camera",
    "fused",
]


class EstimatorParameters(TypedDict, total=False):
    """Parameters of estimators."""

    noise: Literal["independent", "correlated"] | None
    area: Literal["barycentric", "voronoi", "mixed"] | None
    radius: float | None
    normals: Literal["area", "angle", "sphere", "uniform"] | None
    rings: int | None
    gaussian: float | None


class MethodParameters(TypedDict, total=False):
    """Parameters of methods."""

    weights: Literal["uniform", "cotangent"] | None
    lam: float | None
    time: float | None
    area: Literal["barycentric", "voronoi", "mixed"] | None
    kind: Literal["auto", "cotangent", "robust"] | None
    iterations: int | None
    boundary: Literal["free", "pinned", "sliding"] | None
    pin: npt.ArrayLike | None
    soft: Soft | None
    volume: Literal["drift", "rescale", "offset"] | None
    unstable: Literal["refuse", "warn", "allow"] | None
    update: Literal["never", "mass", "both"] | None
    tolerance: float | None
    settled: float | None
    pass_band: float | None
    mu: float | None
    degree: int | None
    window: Literal["hanning", "hamming", "blackman", "nuttall"] | None
    alpha: float | None
    beta: float | None
    fraction: float | None
    cutoff: float | None
    order: int | None
    modes: int | None
    vertices: npt.ArrayLike | None


class DenoiserParameters(TypedDict, total=False):
    """Parameters of denoisers."""

    strength: float | None
    spatial: float | None
    range: float | None
    iterations: int | None
    influence: float | None
    threshold: float | None
    vertex_steps: int | None
    fidelity: float | None
    sparsity: float | None
    regularity: float | None
    growth: float | None
    last_beta: float | None
    weight: float | None
    radius: float | None
    ratio: float | None
