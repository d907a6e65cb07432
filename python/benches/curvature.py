"""Errors of curvature beside other packages at their defaults: docs/reference/curvature.csv.

python curvature.py OUT.csv CGAL

CGAL is the program of cgal.cpp. Each estimator first has to find H and K of a sphere. An error is
the root mean square of the differences to the exact values at the vertices before noise, over that
of the exact values; of graphs only vertices count that are 0.15 from the border. Prints medians
over surfaces and sizes in percent: H and K, each clean, jittered, and with two levels of noise.
"""

from __future__ import annotations

import csv
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import version
from typing import Any, NamedTuple

import igl
import numpy as np
import numpy.typing as npt
import pyfairing as pf
import pymeshlab
import pyvista
import trimesh

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]
# H and K at each vertex, and their standard errors if there are some; by package and function.
Estimator = Callable[[Floats, Ints], tuple[Floats, ...]]
Estimators = dict[tuple[str, str], Estimator]

# Name, largest shift along the surface over the least height of a face at the vertex, and standard
# deviation of the noise along exact normals in mean edge lengths.
CONDITIONS = {"clean": (0, 0), "jittered": (0.3, 0), "0.03 h": (0.3, 0.03), "0.12 h": (0.3, 0.12)}
COLUMNS = ["surface", "vertices [count]", "condition", "package", "version", "function"]
COLUMNS += ["RMS H [relative]", "RMS K [relative]", "within H [%]", "within K [%]"]
COLUMNS += ["undefined [count]"]


class Surface(NamedTuple):
    """A surface f = 0, meshes of three sizes, and f, its gradient and second derivatives."""

    name: str
    meshes: list[pf.Mesh]
    level_set: Callable[[Floats], tuple[Floats, Floats, Floats]]

    def curvature(self, p: Floats) -> list[Floats]:
        """Exact H and K, the formulas of Goldman for implicit surfaces."""
        _, g, b = self.level_set(p)
        s = (g**2).sum(axis=1)
        h = s * np.trace(b, axis1=1, axis2=2) - np.einsum("ni,nij,nj->n", g, b, g)
        bordered = np.zeros((len(p), 4, 4))
        bordered[:, :3, :3], bordered[:, :3, 3], bordered[:, 3, :3] = b, g, g
        return [h / (2 * s**1.5), -np.linalg.det(bordered) / s**2]


def ellipsoid(a: float, b: float, c: float) -> Surface:
    """x²/a² + y²/b² + z²/c² = 1."""
    w = 1 / np.array([a, b, c]) ** 2
    return Surface(
        f"ellipsoid {a:g} {b:g} {c:g}",
        [pf.shapes.ellipsoid(a, b, c, level) for level in (3, 4, 5)],
        lambda p: (p**2 @ w - 1, 2 * p * w, np.tile(2 * np.diag(w), (len(p), 1, 1))),
    )


def torus(minor: float, around: int, across: int) -> Surface:
    """A tube of radius `minor` about the unit circle."""

    def level_set(p: Floats) -> tuple[Floats, Floats, Floats]:
        d, level = np.hypot(p[:, 0], p[:, 1]), np.diag([1.0, 1.0, 0.0])
        n = p @ level / d[:, None]
        turning = (level - n[:, :, None] * n[:, None, :]) / d[:, None, None]
        return (d - 1) ** 2 + p[:, 2] ** 2 - minor**2, 2 * (p - n), 2 * (np.eye(3) - turning)

    meshes = [pf.shapes.torus(1, minor, around << k, across << k) for k in range(3)]
    return Surface(f"torus 1 {minor:g}", meshes, level_set)


def graph(amplitude: float, waves: float) -> Surface:
    """z = A sin(kx) cos(ky) over the unit square with k = 2π `waves`; up is outside."""
    k = 2 * np.pi * waves

    def level_set(p: Floats) -> tuple[Floats, Floats, Floats]:
        (sx, sy), (cx, cy) = np.sin(k * p[:, :2]).T, np.cos(k * p[:, :2]).T
        z, one = amplitude * sx * cy, np.ones(len(p))
        gradient = np.column_stack([-amplitude * k * cx * cy, amplitude * k * sx * sy, one])
        xx, xy, no = k * k * z, amplitude * k * k * cx * sy, 0 * z
        second = np.array([[xx, xy, no], [xy, xx, no], [no, no, no]])
        return p[:, 2] - z, gradient, np.moveaxis(second, 2, 0)

    def lifted(flat: pf.Mesh) -> pf.Mesh:
        return flat.with_vertices(flat.vertices - np.outer(level_set(flat.vertices)[0], [0, 0, 1]))

    meshes = [lifted(pf.shapes.plane(n, n, "alternating")) for n in (24, 50, 100)]
    return Surface(f"graph {amplitude:g} {waves:g}", meshes, level_set)


def jittered(surface: Surface, mesh: pf.Mesh, amount: float, shifts: Floats) -> Floats:
    """Positions after random shifts of inner vertices, back on the surface by Newton's method."""
    p, f = np.array(mesh.vertices), np.array(mesh.faces)
    longest = np.linalg.norm(p[f] - p[np.roll(f, 1, axis=1)], axis=2).max(axis=1)
    height = np.full(len(p), np.inf)
    np.minimum.at(height, f.ravel(), np.repeat(2 * mesh.face_areas / longest, 3))
    height[mesh.boundary_vertices] = 0
    p += amount * height[:, None] * shifts
    for _ in range(8):
        value, gradient, _ = surface.level_set(p)
        p -= gradient * (value / (gradient**2).sum(axis=1))[:, None]
    return p


def ours(name: Any, v: Floats, f: Ints, **options: Any) -> tuple[Floats, ...]:
    """An estimator of pyfairing."""
    c = pf.Mesh(v, f).curvature(name, **options)
    return c.mean, c.gaussian, *(e for e in (c.mean_error, c.gaussian_error) if e is not None)


def igl_quadrics(v: Floats, f: Ints) -> tuple[Floats, ...]:
    """Quadrics through the vertices of five rings."""
    k = np.array(igl.principal_curvature(v, f)[2:4])
    return k.mean(axis=0), k.prod(axis=0)


def igl_cotangents(v: Floats, f: Ints) -> tuple[Floats, ...]:
    """Half of the Laplacian, its sign from the normals, and angle defects; over mixed areas."""
    area, vector = igl.massmatrix(v, f).diagonal(), -igl.cotmatrix(v, f) @ v / 2
    sign = np.sign((vector * igl.per_vertex_normals(v, f)).sum(axis=1))
    return sign * np.linalg.norm(vector, axis=1) / area, igl.gaussian_curvature(v, f) / area


def vtk_curvatures(v: Floats, f: Ints) -> tuple[Floats, ...]:
    """Mean and Gauss curvature of vtkCurvatures."""
    poly = pyvista.PolyData.from_regular_faces(v, f)
    return np.array(poly.curvature("mean")), np.array(poly.curvature("gaussian"))


def meshlab(name: str, choice: str, v: Floats, f: Ints) -> tuple[Floats, ...]:
    """A filter of MeshLab; the parameter `choice` selects H or K."""
    found, meshes = [], pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(v, f))
    for quantity in ("Mean Curvature", "Gaussian Curvature"):
        meshes.apply_filter(f"compute_{name}_per_vertex", **{choice: quantity})
        found.append(np.array(meshes.current_mesh().vertex_scalar_array()))
    return tuple(found)


def trimesh_measures(v: Floats, f: Ints) -> tuple[Floats, ...]:
    """Integrals over balls of two mean edges, over the area π r² that a sphere has in a ball."""
    mesh, r = trimesh.Trimesh(v, f, process=False), 2 * pf.Mesh(v, f).mean_edge_length
    module: Any = trimesh.curvature
    measures = (module.discrete_mean_curvature_measure, module.discrete_gaussian_curvature_measure)
    return tuple(measure(mesh, v, r) / (np.pi * r * r) for measure in measures)


def cgal(
    program: str, versions: dict[str, str], method: str, v: Floats, f: Ints
) -> tuple[Floats, ...]:
    """A method of the program of cgal.cpp, which also says its version."""
    lines = [[len(v), len(f)], *v.tolist(), *f.tolist()]
    mesh = "\n".join(" ".join(map(repr, line)) for line in lines)
    printed = subprocess.check_output([program, method], input=mesh, text=True)
    versions["CGAL"], *lines = printed.splitlines()
    return tuple(np.loadtxt(lines).T)


def errors(found: tuple[Floats, ...], exact: list[Floats], inner: Bools) -> list[object]:
    """Relative errors of H and K, percentages within the standard errors, undefined values."""
    ok = inner & np.isfinite(found[0]) & np.isfinite(found[1])
    gaps = [np.abs(x - t)[ok] for x, t in zip(found, exact)]
    rms = [np.sqrt((e**2).sum() / (t[ok] ** 2).sum()) for e, t in zip(gaps, exact)]
    within = [f"{100 * (e <= s[ok]).mean():.1f}" for e, s in zip(gaps, found[2:])] or ["", ""]
    return [*(f"{x:.4g}" for x in rms), *within, (inner & ~ok).sum()]


def estimators(program: str, versions: dict[str, str]) -> Estimators:
    """All estimators at their defaults."""
    of_cgal = partial(cgal, program, versions)
    own = ("adaptive", "cotangent", "quadric", "corrected-ball")
    principal, discrete = "curvature_principal_directions", "scalar_by_discrete_curvature"
    return {("pyfairing", name): partial(ours, name) for name in own} | {
        ("libigl", "principal_curvature"): igl_quadrics,
        ("libigl", "cotmatrix, gaussian_curvature"): igl_cotangents,
        ("vtk", "vtkCurvatures"): vtk_curvatures,
        ("pymeshlab", principal): partial(meshlab, principal, "curvcolormethod"),
        ("pymeshlab", discrete): partial(meshlab, discrete, "curvaturetype"),
        ("trimesh", "discrete curvature measures"): trimesh_measures,
        ("CGAL", "interpolated_corrected_curvatures"): partial(of_cgal, "corrected"),
        ("CGAL", "Monge_via_jet_fitting, fewest rings"): partial(of_cgal, "0"),
        ("CGAL", "Monge_via_jet_fitting, two rings"): partial(of_cgal, "2"),
    }


def rows(found: Estimators, versions: dict[str, str]) -> Iterator[list[object]]:
    """The rows of the table, two surfaces of each kind in three sizes; `adaptive` also on waves."""
    surfaces = [ellipsoid(1, 1.5, 2), ellipsoid(1, 0.8, 0.5), torus(0.4, 32, 20)]
    surfaces += [torus(0.25, 48, 13), graph(0.1, 1), graph(0.05, 1.5)]
    for number, surface in enumerate(surfaces):
        for size, mesh in enumerate(surface.meshes):
            rng, f = np.random.default_rng([number, size]), np.array(mesh.faces)
            shifts = rng.normal(size=(len(mesh.vertices), 3))
            shifts *= (rng.random(len(shifts)) ** (1 / 3) / np.linalg.norm(shifts, axis=1))[:, None]
            noise = rng.normal(size=(len(shifts), 1))
            for condition, (jitter, sigma) in CONDITIONS.items():
                on = jittered(surface, mesh, jitter, shifts)
                normals = surface.level_set(on)[1]
                normals /= np.linalg.norm(normals, axis=1)[:, None]
                h, exact = pf.Mesh(on, f).mean_edge_length, surface.curvature(on)
                v = on + sigma * h * noise * normals
                inner = np.abs(on[:, :2] - 0.5).max(axis=1) <= 0.35
                inner |= not surface.name.startswith("graph")
                for (package, function), estimator in found.items():
                    row = [surface.name, len(v), condition, package, versions[package], function]
                    yield [*row, *errors(estimator(v, f), exact, inner)]
            v = pf.Mesh(on, f).noise(0.1, kind="correlated", seed=number).vertices
            for option in ("independent", "correlated"):
                row = [surface.name, len(v), "waves of 0.1 h", "pyfairing", pf.__version__]
                values = ours("adaptive", v, f, noise=option)
                yield [*row, f"adaptive, {option}", *errors(values, exact, inner)]


def main() -> None:
    """Writes the table and prints its medians."""
    out, program = sys.argv[1:]
    versions = {name: version(name) for name in ("libigl", "vtk", "pymeshlab", "trimesh")}
    versions["pyfairing"] = pf.__version__
    found = estimators(program, versions)
    sphere, faces = pf.shapes.icosphere(4), pf.shapes.icosphere(4).faces
    for names, estimator in found.items():
        h, k = np.median(estimator(2 * sphere.vertices, faces)[:2], axis=1)
        # Balls are coarse; a wrong factor or sign would be further away.
        if abs(h / 0.5 - 1) > 0.15 or abs(k / 0.25 - 1) > 0.15:
            raise SystemExit(f"{names}: H {h} and K {k} on a sphere of radius 2")
    kept = list(rows(found, versions))
    with open(out, "w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows([COLUMNS, *kept])
    for names in found:
        mine = np.array([row[6:8] for row in kept if (row[3], row[5]) == names], dtype=float)
        # The conditions of a mesh follow each other.
        medians = 100 * np.median(mine.reshape(-1, len(CONDITIONS), 2), axis=0)
        print(*names, *(f"| {x:.2f}" for x in medians.T.ravel()))


if __name__ == "__main__":
    main()
