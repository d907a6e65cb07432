"""Curvature, areas and normals: the formulas, and the conventions that people confuse."""

from __future__ import annotations

from typing import Any

import numpy as np

from .._arrays import Floats
from ._engine import Answer, row_norm
from ._facts import Facts
from ._report import Convention


def usual(name: str, where: str, **change: object) -> Convention:
    """A convention of textbooks."""
    return Convention(name, where, change, fault=False)


def same(name: str, where: str, **change: object) -> Convention:
    """A variant that is the standard answer as much as ours."""
    return Convention(name, where, change, fault=False, note=True)


def common(name: str, where: str, **change: object) -> Convention:
    """A convention of textbooks that many follow: pairs of others are tried beside it."""
    return Convention(name, where, change, fault=False, base=True)


def slip(name: str, where: str, **change: object) -> Convention:
    """A mistake."""
    return Convention(name, where, change)


# Steps that several formulas share.

AREAS = (
    usual("barycentric areas", "the area of a vertex is a third of its faces", area="barycentric"),
    usual("mixed areas", "circumcentric areas with the rule for obtuse triangles", area="mixed"),
    usual("circumcentric (Voronoi) areas", "circumcentres also in obtuse triangles",
          area="voronoi"),
    slip("areas of whole faces", "the third is missing in the area", area="barycentric",
         area_factor=3.0),
    usual("two thirds of the faces", "the parallelogram of a face in place of its area",
          area="barycentric", area_factor=2.0),
    slip("circumcentric areas of absolute cotangents", "the cotangent of an obtuse angle loses its "
         "sign", area="absolute voronoi"),
    slip("areas with triangles outside of the border (own row)", "the outer half-edge of the "
         "border is taken for a triangle", area="outer own"),
    slip("areas with triangles outside of the border", "the outer half-edge of the border is taken "
         "for a triangle, at all its corners", area="outer all"),
    slip("area of the last face", "the area is assigned, not added: the last face wins",
         area="last face"),
    slip("area of the first face", "the area is assigned at the first face", area="first face"),
    slip("components of the cross product summed", "x + y + z in place of the norm: changes with "
         "the axes", area="components"),
    slip("absolute components of the cross product summed", "|x| + |y| + |z| in place of the norm: "
         "changes with the axes", area="absolute components"),
    slip("mean area of the faces", "a mean in place of a third of the sum", area="mean"),
    slip("the degree in place of the area", "the number of neighbours is divided by",
         area="degree"),
)  # fmt: skip

BORDERS = (usual("0 at the border", "border vertices are left out", border="zero"),)


def bordered(facts: Facts, values: Floats, border: str) -> Floats:
    if border == "zero":
        values = values.copy()
        values[facts.border] = 0.0
    return values


def divisor(facts: Facts, area: str, area_factor: float, measure: str) -> Floats:
    return area_factor * facts.area(area) if measure == "pointwise" else np.ones(facts.n)


# Mean curvature.


def mean_curvature(
    facts: Facts,
    *,
    weights: str = "cotangent",
    area: str = "mixed",
    area_factor: float = 1.0,
    measure: str = "pointwise",
    side: str = "left",
    read: str = "part",
    normal: str = "area",
    factor: float = 1.0,
    border: str = "",
) -> Answer:
    """H as the part of ½ M⁻¹ S x along the normal, and variants."""
    if weights in ("dihedral", "dihedral flat"):
        over = divisor(facts, area, area_factor, measure)
        size = facts.gather(np.linalg.norm(facts.sides, axis=2)) / over
        values = facts.dihedral_sum / 4 / over
        if read in ("length", "absolute"):
            values = np.abs(values)
        return bordered(facts, factor * values, border), np.abs(factor) * size
    key = ("vector", weights, area, area_factor, measure, side)
    vector, size = facts.remember(key, lambda: _vector(facts, weights, area, area_factor, measure, side))
    values = bordered(facts, factor * _read(facts, vector, read, normal), border)
    if read not in ("signed", "uniform sign", "one component", "any component"):
        return values, np.abs(factor) * size
    # At a vertex of one face the vector is tangential, and its sign is rounding.
    along = np.abs((vector * facts.normal_sum(normal)).sum(axis=1))
    free = along <= 1e-9 * row_norm(vector) * row_norm(facts.normal_sum(normal))
    return values, np.abs(factor) * size, free


def _vector(
    facts: Facts, weights: str, area: str, area_factor: float, measure: str, side: str
) -> tuple[Floats, Floats]:
    """½ M⁻¹ S x or ½ (x - mean), and the size of its terms."""
    matrix = facts.stiffness(weights)
    if weights in ("uniform", "faces", "lengths"):
        total = np.where(matrix.diagonal() > 0, matrix.diagonal(), 1.0)
        over = total if measure == "pointwise" else np.ones(facts.n)
    else:
        over = divisor(facts, area, area_factor, measure)
    x = facts.points
    spread = facts.gather(np.linalg.norm(facts.sides, axis=2)) / np.maximum(facts.degree, 1)
    size = abs(matrix).diagonal() * spread / np.abs(over) / 2
    if side == "right":
        return matrix @ (x / over[:, None]) / 2, size
    return matrix @ x / over[:, None] / 2, size


def _read(facts: Facts, vector: Floats, read: str, normal: str) -> Floats:
    """A number from the mean curvature vector."""
    sums = facts.normal_sum(normal)
    n = sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-300)[:, None]
    along: Floats = (vector * n).sum(axis=1)
    length = row_norm(vector)
    if read == "part":
        return along
    if read == "absolute":
        return np.asarray(np.abs(along))
    if read == "length":
        return length
    if read == "signed":
        return np.where(along < 0, -length, length)
    if read == "one component":
        return np.where(vector[:, 0] * n[:, 0] < 0, -length, length)
    if read == "any component":
        return np.where((vector * n > 0).any(axis=1), length, -length)
    if read == "uniform sign":
        matrix = facts.stiffness("uniform")
        return np.where(((matrix @ facts.points) * n).sum(axis=1) < 0, -length, length)
    if read == "components":
        total: Floats = vector.sum(axis=1)
        return total
    if read == "faces":
        counts = facts.stiffness("faces") @ facts.points
        return np.where((counts * n).sum(axis=1) < 0, -length, length)
    raise ValueError(f"there is no reading {read}")


OUTER = tuple(
    slip("outer half-edge of the border taken for a triangle", f"cotangents at the border{more}",
         weights=weights)
    for weights, more in (
        ("outer triangles", ": a triangle with the two neighbours along the border"),
        ("outer next", ": the angle after the edge"),
        ("outer previous", ": the angle before the edge"),
        ("outer loop", ": the angle between the edges before and after"),
    )
) + (
    slip("ring of neighbours closed across the border", "the last neighbour is followed by the "
         "first", weights="outer ring"),
)  # fmt: skip

WEIGHTS = (
    usual("uniform weights", "the mean of the neighbours in place of cotangents",
          weights="uniform"),
    usual("cotangent weights", "cotangents in place of the mean of the neighbours",
          weights="cotangent"),
    slip("neighbours counted once for each face", "inner neighbours twice, border ones once",
         weights="faces"),
    slip("absolute cotangents", "the cosine is made positive: cotangents of obtuse angles lose "
         "their sign", weights="absolute"),
    slip("cotangents of obtuse angles set to 0", "negative cotangents are cut off",
         weights="clamped"),
    slip("tangent in place of cotangent", "the weight of an edge", weights="tangent"),
    slip("cotangent of another corner", "the angle at the edge, not the one opposite",
         weights="swapped"),
    slip("cotangents at the ends of an edge", "the angles at the edge, not those opposite",
         weights="ends"),
    slip("one of the two angles of an edge", "only one of the two faces adds", weights="one side"),
    usual("weights of inverse lengths", "1 / length of the edge", weights="lengths"),
    *OUTER,
)  # fmt: skip

MEAN = (
    Convention("signed length of the vector", "‖½ M⁻¹ S x‖ with the sign of the part along the "
               "normal, in place of that part", {"read": "signed"}, fault=False,
               note=True, base=True),
    same("length of the vector, with a sign by the mean of the neighbours",
         "normal · (mean - vertex)", read="uniform sign"),
    same("part along the angle-weighted normal", "the weights of the normal", normal="angle"),
    common("length of the vector, without sign", "‖½ M⁻¹ S x‖ ≥ 0 in place of the part along the "
           "normal", read="length"),
    usual("part along the equally weighted normal", "the weights of the normal", normal="uniform"),
    usual("absolute value", "the sign of the part along the normal is dropped", read="absolute"),
    usual("the other sign, negative on spheres", "the sign of Δx = -2Hn", factor=-1.0),
    slip("2H instead of H", "the last ½", factor=2.0),
    slip("H/2 instead of H", "a factor ½ is taken twice", factor=0.5),
    slip("4H instead of H", "two factors ½ are missing", factor=4.0),
    usual("integrated instead of pointwise", "the division by the area is missing",
          measure="integrated"),
    usual("half the sum of length times dihedral angle, twice the integral of H",
          "H of an edge is shared by two vertices: a quarter of the sum is the integral",
          weights="dihedral", measure="integrated", factor=2.0),
    usual("dihedral angles in place of the vector", "a quarter of length times dihedral angle over "
          "the area", weights="dihedral"),
    slip("transposed: S M⁻¹ x in place of M⁻¹ S x", "the inverse mass stands on the wrong side",
         side="right"),
    slip("sign from one component", "the first component of Δx over that of n",
         read="one component"),
    slip("positive as soon as one component agrees", "the sign", read="any component"),
    slip("components of the vector summed", "x + y + z in place of the length: changes with the "
         "axes", read="components"),
    *WEIGHTS, *AREAS, *BORDERS,
)  # fmt: skip


# Gaussian curvature.


def gaussian_curvature(
    facts: Facts,
    *,
    full: float = 2 * np.pi,
    edge: float = np.pi,
    ring: str = "",
    unit: str = "radians",
    area: str = "mixed",
    area_factor: float = 1.0,
    measure: str = "pointwise",
    factor: float = 1.0,
    border: str = "",
) -> Answer:
    """K as the angle defect over the area, and variants."""
    angles = facts.angle_sum
    if ring:
        angles = angles + facts.outer_angle
        area = "outer own" if ring == "area" else area
    if unit == "mixed":
        angles = np.rad2deg(angles)
    defect = np.where(facts.border, edge, full) - angles
    if border == "flat sign":
        defect = np.where(facts.border, -defect, defect)
    over = divisor(facts, area, area_factor, measure)
    values = bordered(facts, factor * defect / over, border)
    return values, np.abs(factor * 2 * np.pi / over)


GAUSSIAN = (
    common("2π at the border, too", "the full angle: π is the one of a border vertex",
           edge=2 * np.pi),
    usual("integrated instead of pointwise", "the angle defect is not divided by the area",
          measure="integrated"),
    slip("the other sign", "sum of angles minus 2π", factor=-1.0),
    slip("twice K", "a factor 2", factor=2.0),
    slip("half of K", "a factor ½", factor=0.5),
    slip("π everywhere", "the full angle: the test for the border is always true", full=np.pi),
    slip("full angle 0", "the sum of angles is not subtracted from 2π", full=0.0, edge=0.0),
    slip("ring of neighbours closed across the border", "the angle and the area of a triangle that "
         "does not exist", ring="area", edge=2 * np.pi),
    slip("ring of neighbours closed across the border, π", "the angle and the area of a triangle "
         "that does not exist", ring="area"),
    slip("ring closed across the border (angle only)", "the angle of a triangle that does not "
         "exist", ring="angle", edge=2 * np.pi),
    slip("ring closed across the border (angle only), π", "the angle of a triangle that does not "
         "exist", ring="angle"),
    slip("degrees", "the angles", factor=180 / np.pi),
    slip("2π minus degrees", "the angles are in degrees, the full angle is not", unit="mixed"),
    slip("three times the value", "the third in the area is a factor", factor=3.0),
    *AREAS, *BORDERS,
)  # fmt: skip


# Principal curvatures.


def principal_curvatures(
    facts: Facts,
    *,
    order: str = "descending",
    root: str = "clamped",
    area: str = "mixed",
    k_area: str = "",
    **change: Any,
) -> Answer:
    """H ± √(H² - K), and variants; (n, 2)."""
    edge, measure = change.pop("edge", np.pi), change.get("measure", "pointwise")
    mean, size, *free = mean_curvature(facts, area=area, **change)
    gauss, _ = gaussian_curvature(facts, area=k_area or area, edge=edge, measure=measure)
    inside = mean**2 - gauss
    if root == "absolute":
        inside = np.abs(inside)
    half = np.sqrt(np.maximum(inside, 0))
    if root == "missing":
        half = inside
    one, two = mean + half, mean - half
    if order == "ascending":
        one, two = two, one
    elif order == "magnitude":
        swap = np.abs(two) > np.abs(one)
        one, two = np.where(swap, two, one), np.where(swap, one, two)
    # The root magnifies the rounding of H² - K.
    return np.column_stack([one, two]), size * 10, *free


PRINCIPAL = (
    usual("smallest first", "the order of the two", order="ascending"),
    usual("largest absolute value first", "the order of the two", order="magnitude"),
    slip("half the sum of length times dihedral angle for H, doubled",
         "H of the dihedral angles is twice too large, over the area", weights="dihedral",
         factor=2.0),
    slip("integrated H and K", "neither is divided by the area", measure="integrated"),
    slip("integrated H and K, H of dihedral angles doubled", "neither is divided by the area",
         measure="integrated", weights="dihedral", factor=2.0),
    slip("absolute value under the root", "H² - K below 0 must be 0", root="absolute"),
    slip("the root is missing", "H ± (H² - K)", root="missing"),
    usual("2π at the border, too", "the angle defect in K", edge=2 * np.pi),
    usual("barycentric areas for K", "the area of K alone", k_area="barycentric"),
    *MEAN[:11], *WEIGHTS, *AREAS,
)  # fmt: skip


# Areas and normals.


def mass(
    facts: Facts, *, area: str = "barycentric", area_factor: float = 1.0, power: float = 1.0,
    total: str = "", border: str = "",
) -> Answer:  # fmt: skip
    """The area of each vertex, and variants."""
    values = area_factor * facts.area(area)
    if total == "one":
        values = values / values.sum()
    elif total == "n":
        values = values / values.mean()
    with np.errstate(all="ignore"):
        values = np.sign(values) * np.abs(values) ** power
    return bordered(facts, values, border), np.abs(values)


MASS = (
    slip("inverse areas", "1 / A in place of A", power=-1.0),
    slip("roots of areas", "√A in place of A", power=0.5),
    usual("areas that sum to 1", "normalised", total="one"),
    usual("areas with mean 1", "normalised", total="n"),
    slip("one sixth of the faces", "half of the third", area_factor=0.5),
    *AREAS, *BORDERS,
)  # fmt: skip


def vertex_normals(
    facts: Facts, *, weight: str = "area", length: str = "unit", factor: float = 1.0, border: str = ""
) -> Answer:
    """Outward unit normals, and variants; (n, 3)."""
    if weight == "mean curvature":
        vector = facts.stiffness() @ facts.points
        away = (vector * facts.normal_sum("area")).sum(axis=1) < 0
        sums: Floats = np.where(away[:, None], -vector, vector)
    elif weight == "raw mean curvature":
        sums = facts.stiffness() @ facts.points
    elif weight == "all":
        sums = np.repeat(facts.cross.sum(axis=0)[None] / 2, facts.n, axis=0)
    elif weight == "position":
        sums = facts.points - facts.points.mean(axis=0)
    else:
        sums = facts.normal_sum(weight)
    lengths = np.linalg.norm(sums, axis=1)[:, None]
    if length == "unit":
        sums = sums / np.where(lengths > 0, lengths, 1.0)
    elif length == "mean":
        sums = sums / np.maximum(np.asarray(facts.by_faces.sum(axis=1)).reshape(-1, 1) / 2, 1)
    elif length == "square":
        sums = sums / np.where(lengths > 0, lengths, 1.0) ** 2
    elif length == "largest":
        sums = sums / np.maximum(np.abs(sums).max(axis=1), 1e-300)[:, None]
    values = bordered(facts, factor * sums, border)
    return values, np.maximum(row_norm(values), 1e-9)


NORMALS = (
    same("weights by angle", "the weight of a face", weight="angle"),
    same("weights exact on spheres", "the weight of a face", weight="sphere"),
    usual("equal weights", "every face counts the same", weight="uniform"),
    usual("weights by inverse lengths", "the weight of a face", weight="inverse lengths"),
    slip("weights by inverse area", "the weight of a face", weight="inverse area"),
    slip("weights by squared area", "the cross product times its length", weight="squared area"),
    slip("normal of the last face", "assigned, not added: the last face wins", weight="last face"),
    slip("normal of the first face", "assigned at the first face", weight="first face"),
    slip("mean of unit normals, not normalised", "the last division by the length is missing",
         weight="uniform", length="mean"),
    slip("not normalised", "the last division by the length is missing", length="sum"),
    slip("mean, not normalised", "divided by the number of faces, not by the length",
         length="mean"),
    slip("divided by the squared length", "the norm", length="square"),
    slip("divided by the largest component", "the norm", length="largest"),
    slip("sum over all faces at every vertex", "no test whether a face is incident", weight="all"),
    slip("direction from the centre", "the position in place of a normal", weight="position"),
    usual("direction of the mean curvature vector", "Δx in place of the mean of face normals",
          weight="mean curvature"),
    usual("direction of S x", "the mean curvature vector, not turned outwards",
          weight="raw mean curvature"),
    usual("inward", "the sign, or the order of the corners in the cross product", factor=-1.0),
    *BORDERS,
)  # fmt: skip
