"""The Laplacian as a matrix: formula and conventions."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._arrays import Csr, Floats
from ._engine import Answer, row_norm
from ._facts import Facts
from ._pointwise import AREAS, WEIGHTS, common, slip, usual
from ._report import Convention


def laplacian(
    facts: Facts,
    *,
    weights: str = "cotangent",
    scaled: str = "no",
    area: str = "barycentric",
    area_factor: float = 1.0,
    factor: float = 1.0,
    sign: float = 1.0,
    diagonal: str = "row sums",
    border: str = "",
) -> Answer:
    """S, or M⁻¹ S and other products of S with areas or degrees; (n, n) sparse."""
    matrix = _operator(facts, weights, scaled, area, area_factor, diagonal, border)
    matrix = sign * factor * matrix
    if border == "identity" or border == "one on the diagonal":
        matrix = matrix + facts.diagonal(facts.border.astype(np.float64))
    return matrix, row_norm(matrix)


def _operator(
    facts: Facts, weights: str, scaled: str, area: str, area_factor: float, diagonal: str, border: str
) -> Csr:
    matrix = facts.stiffness(weights)
    over = area_factor * facts.area(area)
    inverse = np.divide(1.0, over, out=np.zeros_like(over), where=over != 0)
    d = facts.diagonal
    own = matrix.diagonal()
    safe = np.where(own != 0, own, 1.0)
    if diagonal == "with itself":
        # The mean over the neighbours and the vertex itself.
        count = facts.degree + 1
        matrix = d(1 / count) @ facts.stiffness("uniform")
    elif scaled == "left":
        matrix = d(inverse) @ matrix
    elif scaled == "right":
        matrix = matrix @ d(inverse)
    elif scaled == "multiplied":
        matrix = d(over) @ matrix
    elif scaled == "symmetric":
        matrix = d(np.sqrt(np.abs(inverse))) @ matrix @ d(np.sqrt(np.abs(inverse)))
    elif scaled == "symmetric weights":
        matrix = _of_weights(facts, matrix, np.sqrt(np.abs(inverse)))
    elif scaled == "symmetric multiplied":
        matrix = _of_weights(facts, matrix, np.sqrt(np.abs(over)))
    elif scaled == "own":
        matrix = d(1 / safe) @ matrix
    elif scaled == "own symmetric":
        matrix = d(1 / np.sqrt(np.abs(safe))) @ matrix @ d(1 / np.sqrt(np.abs(safe)))
    elif scaled == "degree":
        matrix = d(1 / np.maximum(facts.degree, 1)) @ matrix
    if diagonal == "none":
        matrix = matrix - d(matrix.diagonal())
    elif diagonal == "weights":
        matrix = d(matrix.diagonal()) - (matrix - d(matrix.diagonal()))
    elif diagonal == "shifted":
        matrix = matrix + d(np.ones(facts.n))
    if border in ("zero", "identity"):
        matrix = d((~facts.border).astype(np.float64)) @ matrix
    elif border == "both":
        keep = d((~facts.border).astype(np.float64))
        matrix = keep @ matrix @ keep
    return matrix.tocsr()


def _of_weights(facts: Facts, matrix: Csr, factors: Floats) -> Csr:
    """Weights times factors of both ends, the diagonal the row sum."""
    weights = facts.diagonal(matrix.diagonal()) - matrix
    return facts.with_row_sums(facts.diagonal(factors) @ weights @ facts.diagonal(factors))


OPERATOR: tuple[Convention, ...] = (
    common("the other sign", "semi-definite the other way: S or -S, Δ = -M⁻¹ S", factor=-1.0),
    common("rows divided by the area", "M⁻¹ S in place of S", scaled="left"),
    usual("uniform Laplacian D⁻¹A - I", "equal weights in place of cotangents", weights="uniform",
          scaled="own", sign=-1.0),
    usual("cotangent Laplacian S", "cotangents in place of equal weights", weights="cotangent",
          scaled="no", sign=1.0),
    usual("rows divided by the diagonal", "weights divided by their sum", scaled="own"),
    usual("rows times the degree", "D - W in place of I - D⁻¹ W", scaled="no"),
    usual("symmetric form", "M^-½ S M^-½", scaled="symmetric"),
    usual("symmetric form by degrees", "D^-½ (D - W) D^-½", scaled="own symmetric"),
    slip("½ missing in the cotangents: times 2", "S is half the sum of the cotangents", factor=2.0),
    slip("½ twice: half of the weights", "the factor ½ of the cotangents, or 2A in the division",
         factor=0.5),
    slip("transposed: inverse mass on the right", "S M⁻¹ in place of M⁻¹ S", scaled="right"),
    slip("multiplied by the area", "M S in place of M⁻¹ S", scaled="multiplied"),
    slip("divided by the degree", "the cotangent weights are averaged over the neighbours",
         scaled="degree"),
    slip("weights divided by √(AᵢAⱼ), diagonal the row sum", "the diagonal of M^-½ S M^-½ is not "
         "the row sum", scaled="symmetric weights"),
    slip("weights multiplied by √(AᵢAⱼ), diagonal the row sum", "multiplied in place of divided",
         scaled="symmetric multiplied"),
    slip("the mean includes the vertex itself", "degree + 1 in place of the degree",
         diagonal="with itself"),
    slip("no diagonal", "the row sums are missing on the diagonal", diagonal="none"),
    slip("diagonal of the other sign", "the row sum has the sign of the weights",
         diagonal="weights"),
    slip("plus the identity", "1 is added on the diagonal", diagonal="shifted"),
    usual("border rows 0", "border vertices do not move", border="zero"),
    usual("border rows and columns 0", "border vertices do not move", border="both"),
    slip("border rows of the identity", "an implicit step scales the border by 1 / (1 - λ)",
         border="identity"),
    slip("1 added on the diagonal of border rows", "the border", border="one on the diagonal"),
    *WEIGHTS, *AREAS,
)  # fmt: skip


def sparse(values: Any) -> Csr:
    """A square matrix as csr_matrix."""
    from scipy.sparse import csr_matrix

    return csr_matrix(values)
