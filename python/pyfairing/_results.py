"""Results of computations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ._arrays import Bools, Csr, Floats


class Laplacian(tuple[Csr, Csr]):
    """Stiffness S and mass M as a pair, with their kind.

    Attributes
    ----------
    stiffness : scipy.sparse.csr_matrix, shape (n, n)
        S, symmetric, positive semi-definite, row sums zero, dimensionless.
    mass : scipy.sparse.csr_matrix, shape (n, n)
        M, in squared mesh units (dimensionless for `degree` and `unit`).
    kind : str
        The kind in use, never `auto` or `non-negative`.
    reason : str
        The reason for this kind.
    """

    kind: str
    reason: str

    def __new__(cls, stiffness: Csr, mass: Csr, kind: str, reason: str) -> Laplacian:
        pair = super().__new__(cls, (stiffness, mass))
        pair.kind = kind
        pair.reason = reason
        return pair

    def __getnewargs__(self) -> tuple[Csr, Csr, str, str]:
        return (self[0], self[1], self.kind, self.reason)

    @property
    def stiffness(self) -> Csr:
        """S."""
        return self[0]

    @property
    def mass(self) -> Csr:
        """M."""
        return self[1]

    def __repr__(self) -> str:
        return f"Laplacian({self.kind}, {self[0].shape[0]} vertices: {self.reason})"


@dataclass(frozen=True, eq=False, repr=False)
class Curvature:
    """Pointwise curvature at each vertex, positive on a sphere; NaN where it is not `defined`.

    Attributes
    ----------
    mean, gaussian : ndarray, shape (n,)
        H in 1 / mesh units, K in 1 / squared mesh units.
    kappa1, kappa2 : ndarray, shape (n,)
        Principal curvatures, kappa1 >= kappa2, in 1 / mesh units.
    direction1, direction2 : ndarray, shape (n, 3), or None
        Principal unit directions; None if the estimator provides none.
    mean_error, gaussian_error : ndarray, shape (n,), or None
        Standard errors of H and K; None if the estimator provides none.
    scale : ndarray, shape (n,), or None
            The radius with the largest weight in H, in mesh units.
    defined : ndarray of bool, shape (n,)
        Mask of the vertices with a value.
    boundary : ndarray of bool, shape (n,)
        Mask of the boundary vertices, where values are one-sided.
    too_thin : int or None
        The first face too thin for cotangents, if it led to the robust operator.
    narrowed : int
        Number of vertices where a fit took fewer rings or a lower degree, because its neighbourhood
        turns by more than 60 degrees.
    """

    estimator: str
    mean: Floats
    gaussian: Floats
    kappa1: Floats
    kappa2: Floats
    direction1: Floats | None
    direction2: Floats | None
    mean_error: Floats | None
    gaussian_error: Floats | None
    scale: Floats | None
    defined: Bools
    boundary: Bools
    too_thin: int | None
    narrowed: int

    @property
    def interior(self) -> Bools:
        """Mask of the vertices whose values are defined and not one-sided."""
        return self.defined & ~self.boundary

    @property
    def shape_index(self) -> Floats:
        """2/pi arctan((k1 + k2) / (k1 - k2)): 1 for a cap, 0 for a saddle, -1 for a cup.

        0 if flat.
        """
        k1, k2 = self.kappa1, self.kappa2
        index: Floats = np.arctan2(k1 + k2, k1 - k2) * (2 / np.pi)
        index[(k1 == 0) & (k2 == 0)] = 0.0
        return index

    @property
    def curvedness(self) -> Floats:
        """sqrt((k1**2 + k2**2) / 2), in 1 / mesh units."""
        curvedness: Floats = np.hypot(self.kappa1, self.kappa2) / np.sqrt(2)
        return curvedness

    def fields(self) -> dict[str, Floats]:
        """The fields that `fairing curvature` writes: `mesh.with_fields(c.fields())`.

        Fields hold no NaN: values are 0 where the field `defined` is.
        """
        names: dict[str, Floats] = {
            name: getattr(self, name) for name in ("mean", "gaussian", "kappa1", "kappa2")
        }
        names["defined"] = self.defined.astype(np.float64)
        names["boundary"] = self.boundary.astype(np.float64)
        if self.direction1 is not None and self.direction2 is not None:
            names |= {"direction1": self.direction1, "direction2": self.direction2}
        errors = {"mean_error": self.mean_error, "gaussian_error": self.gaussian_error, "scale": self.scale}
        names |= {name: values for name, values in errors.items() if values is not None}
        return {name: np.where(np.isnan(values), 0.0, values) for name, values in names.items()}

    def __len__(self) -> int:
        return len(self.mean)

    def __repr__(self) -> str:
        undefined = int((~self.defined).sum())
        text = f"Curvature({self.estimator}, {len(self)} vertices"
        if undefined:
            text += f", {undefined} undefined"
        inside = self.mean[self.interior]
        if inside.size:
            text += f", mean from {inside.min():.4g} to {inside.max():.4g}"
        return text + ")"


class NoiseLevel(NamedTuple):
    """An estimate of the noise along the normals.

    Attributes
    ----------
    sigma : float
        The standard deviation, in mesh units.
    tail_ratio : float
        1 for Gaussian noise, more if a fraction of the vertices is displaced further than the rest.
    impulsive : bool
        True if the tails are those of impulsive noise.
    samples : int
        The number of vertices used for the estimate.
    low_ratio : float
        1 for Gaussian noise, less if the level varies over the surface.
    correlation : float
        The correlation of residuals across edges, from -1 to 1: about -0.27 for independent
        noise, slightly more for correlated noise.
    two_ring_ratio : float
        The noise level from quadrics over two-rings, relative to `sigma`: 1 or slightly more on
        smooth surfaces with independent noise, more if creases and details are as dense as
        two-rings or the noise is correlated.
    correlation_length : float
        The distance in mean edge lengths over which the noise is correlated, like that of a depth
        camera: 0 for none, 4 or 8. Smooth noise without a rough part looks like shape and is not
        found.
    wide_sigma : float
        The noise level at the scale of `correlation_length`, in mesh units; `sigma` without
        correlation.
    """

    sigma: float
    tail_ratio: float
    impulsive: bool
    samples: int
    low_ratio: float
    correlation: float
    two_ring_ratio: float
    correlation_length: float
    wide_sigma: float


class Scores(Mapping[str, float]):
    """The defined scores, by the names of `fairing compare --json`.

    Attributes
    ----------
    diagonal : float
        The diagonal of the bounding box of the reference, in mesh units: the unit of lengths.
    units : mapping of str to str
        The unit of each score.
    labels : mapping of str to str
        A readable name.
    missing : mapping of str to str
        Scores that are not defined for these meshes, with the reason.
    """

    def __init__(self, report: Mapping[str, Any], table: str) -> None:
        scores = report["scores"]
        self.diagonal: float = report["diagonal"]
        self.labels = {score["name"]: score["label"] for score in scores}
        self.units = {score["name"]: score["unit"] for score in scores}
        self.missing = {score["name"]: score["reason"] for score in scores if "reason" in score}
        self._values: dict[str, float] = {
            score["name"]: score["value"] for score in scores if "value" in score
        }
        self._table = table

    def __getitem__(self, name: str) -> float:
        if name in self.missing:
            raise KeyError(f"{name}: {self.missing[name]}")
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __repr__(self) -> str:
        return self._table.rstrip()
