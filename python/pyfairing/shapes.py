"""Meshes made by formula: closed and open, smooth and sharp.

All are manifold, without isolated vertices or faces without area, and counter-clockwise seen from
outside. Random shapes take a seed.
"""

from __future__ import annotations

from typing import Literal

from . import _core
from ._arrays import whole
from ._calls import call
from ._mesh import Mesh

__all__ = [
    "bumpy_sphere",
    "cad_block",
    "creature",
    "cube",
    "cylinder",
    "ellipsoid",
    "flower",
    "helicoid",
    "icosphere",
    "irregular_plane",
    "moebius",
    "plane",
    "torus",
    "uv_sphere",
]

Diagonals = Literal["regular", "alternating"]


def _make(name: str, lengths: list[float], counts: list[int], word: str = "", seed: int = 0) -> Mesh:
    numbers = [whole(count, name) for count in counts]
    core = _core.shape(name, [float(x) for x in lengths], numbers, word, whole(seed, "seed"), call())
    return Mesh._of(core)


def icosphere(level: int = 3) -> Mesh:
    """The unit sphere from an icosahedron; each level quadruples the faces: 10 · 4ˡ + 2 vertices."""
    return _make("icosphere", [], [level])


def uv_sphere(around: int = 64, across: int = 32) -> Mesh:
    """The unit sphere from meridians and bands, with two poles."""
    return _make("uv_sphere", [], [around, across])


def bumpy_sphere(level: int = 4, amplitude: float = 0.1, frequency: float = 7.0) -> Mesh:
    """A sphere with waves on it."""
    return _make("bumpy_sphere", [amplitude, frequency], [level])


def ellipsoid(a: float = 1.0, b: float = 1.0, c: float = 1.0, level: int = 4) -> Mesh:
    """An icosphere scaled to the half-axes a, b, c along x, y, z, in mesh units."""
    return _make("ellipsoid", [a, b, c], [level])


def torus(major: float = 1.0, minor: float = 0.4, around: int = 96, across: int = 40) -> Mesh:
    """A torus about z: `major` to the middle of the tube, `minor` the radius of the tube."""
    return _make("torus", [major, minor], [around, across])


def cylinder(
    radius: float = 1.0,
    height: float = 2.0,
    around: int = 64,
    along: int = 32,
    ends: Literal["closed", "open"] = "closed",
) -> Mesh:
    """A cylinder about z, with flat lids or open."""
    return _make("cylinder", [radius, height], [around, along], ends)


def plane(columns: int = 32, rows: int = 32, diagonals: Diagonals = "regular") -> Mesh:
    """The unit square in the plane z = 0, divided into squares that are cut along a diagonal."""
    return _make("plane", [], [columns, rows], diagonals)


def irregular_plane(spacing: float = 0.03, seed: int = 1) -> Mesh:
    """The unit square with random points about `spacing` apart, in a Delaunay triangulation."""
    return _make("irregular_plane", [spacing], [], seed=seed)


def cube(squares: int = 16, diagonals: Diagonals = "regular") -> Mesh:
    """A cube whose faces are divided into `squares` × `squares` squares."""
    return _make("cube", [], [squares], diagonals)


def cad_block(spacing: float = 0.05) -> Mesh:
    """A machined block with sharp edges, faces about `spacing` wide."""
    return _make("cad_block", [spacing], [])


def creature(resolution: int = 96) -> Mesh:
    """A smooth animal with thin parts, from an implicit surface on a grid."""
    return _make("creature", [], [resolution])


def flower(spacing: float = 0.02, seed: int = 1) -> Mesh:
    """An open, wavy disc with dense and sparse regions."""
    return _make("flower", [spacing], [], seed=seed)


def moebius(width: float = 0.3, around: int = 96, across: int = 8) -> Mesh:
    """A Möbius band of half-width `width` about the unit circle: not orientable."""
    return _make("moebius", [width], [around, across])


def helicoid(
    rise: float = 0.3,
    radii: tuple[float, float] = (0.2, 1.0),
    turns: float = 1.0,
    across: int = 16,
    along: int = 64,
) -> Mesh:
    """A helicoid about z that rises by `rise` mesh units per radian, a minimal surface."""
    return _make("helicoid", [rise, radii[0], radii[1], turns], [across, along])
