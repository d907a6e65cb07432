"""The rows of "Coming from other packages" in docs/python.md, run as the page has them.

The numbers of both sides are compared with their signs; a row is skipped where its package is not installed.
"""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pyfairing as pf
import pytest
from conftest import ROOT

Side = Callable[..., Any]


def table() -> dict[str, str]:
    """The first piece of code in both cells of each row."""
    section = (ROOT / "docs/python.md").read_text("utf-8").split("## Coming from other packages\n")[1]
    rows = [line.split(" | ") for line in section.split("\n## ")[0].split("\n") if line.startswith("| ")]
    codes = [[re.search("`(.*?)`", cell) for cell in row] for row in rows[1:]]
    assert all(len(row) == 2 and all(row) for row in codes)
    return {theirs[1]: ours[1] for theirs, ours in codes}


TABLE = table()
TESTED: set[str] = set()


def row(
    beginning: str, needs: str | None = None
) -> Callable[[Callable[[Side, Side], None]], Callable[[], None]]:
    """The test of the row whose left side begins so: it is called with both sides."""
    (code,) = [code for code in TABLE if code.startswith(beginning)]
    TESTED.add(code)

    def decorate(test: Callable[[Side, Side], None]) -> Callable[[], None]:
        def run() -> None:
            if needs:
                pytest.importorskip(needs)
            test(side(code, needs), side(TABLE[code], needs))

        return run

    return decorate


def side(code: str, module: str | None) -> Side:
    """Evaluates a cell with names for what it mentions."""
    known: dict[str, Any] = {"np": np, "pf": pf}
    if module:
        known[{"potpourri3d": "pp3d"}.get(module, module.split(".")[0])] = sys.modules[module.split(".")[0]]
    return lambda **names: eval(code, known | names)


def arrays(mesh: pf.Mesh) -> dict[str, Any]:
    return {"mesh": mesh, "V": np.array(mesh.vertices), "F": mesh.faces}


def inverted(mesh: pf.Mesh) -> pf.Mesh:
    return pf.Mesh(mesh.vertices, mesh.faces[:, ::-1])


def closed() -> list[pf.Mesh]:
    """Curved both ways, irregular, turned inside out."""
    bumpy = pf.shapes.bumpy_sphere(3, 0.2, 5.0)
    return [bumpy, pf.shapes.torus(2, 0.5, 60, 20), pf.shapes.creature(24), inverted(bumpy)]


def opened() -> list[pf.Mesh]:
    """With boundaries, and edges that are not Delaunay."""
    plane = pf.shapes.irregular_plane(0.08)
    x, y, _ = plane.vertices.T
    return [
        plane.with_vertices(np.column_stack([x + 0.8 * y, y, 0.2 * np.sin(4 * x)])),
        pf.shapes.helicoid(),
        pf.shapes.cylinder(1.0, 2.0, 20, 9, ends="open"),
    ]


def off_by(a: Any, b: Any) -> float:
    """The root mean square of the difference, relative to that of b."""
    return float(np.sqrt(np.mean((np.asarray(a) - b) ** 2) / np.mean(np.asarray(b) ** 2)))


def trimesh_of(mesh: pf.Mesh) -> Any:
    import trimesh

    return trimesh.Trimesh(np.array(mesh.vertices), mesh.faces, process=False)


def lapy_of(mesh: pf.Mesh) -> Any:
    import lapy

    return lapy.TriaMesh(np.array(mesh.vertices), mesh.faces)


@row("igl.read_triangle_mesh", needs="igl")
def test_read_triangle_mesh(theirs: Side, ours: Side) -> None:
    for f in sorted((ROOT / "data").glob("*.ply"))[:3]:
        V, F = theirs(f=str(f))
        mesh = ours(f=f)
        # Theirs may read single precision.
        np.testing.assert_allclose(mesh.vertices, V, atol=1e-6 * mesh.diagonal)
        np.testing.assert_array_equal(mesh.faces, F)


@row("igl.cotmatrix", needs="igl")
def test_cotmatrix(theirs: Side, ours: Side) -> None:
    for mesh in closed() + opened():
        expected = theirs(**arrays(mesh))
        assert abs(ours(mesh=mesh) - expected).max() < 1e-11 * abs(expected).max()


@row("igl.massmatrix", needs="igl")
def test_massmatrix(theirs: Side, ours: Side) -> None:
    for mesh in closed() + opened():
        expected = theirs(**arrays(mesh))
        assert abs(ours(mesh=mesh) - expected).max() < 1e-12 * expected.max()


@row("igl.grad", needs="igl")
def test_grad(theirs: Side, ours: Side) -> None:
    for mesh in closed() + opened():
        u = np.sin(3 * mesh.vertices[:, 0])
        expected = (theirs(**arrays(mesh)) @ u).reshape(3, -1).T
        found = (ours(mesh=mesh) @ u).reshape(-1, 3)
        np.testing.assert_allclose(found, expected, atol=1e-10 * abs(expected).max())


@row("igl.gaussian_curvature", needs="igl")
def test_gaussian_curvature(theirs: Side, ours: Side) -> None:
    for mesh in closed() + opened():
        area = mesh.laplacian("cotangent", "mixed").mass.diagonal()
        boundary = mesh.curvature("cotangent").boundary
        found = ours(mesh=mesh) * area + np.pi * boundary
        np.testing.assert_allclose(found, theirs(**arrays(mesh)), atol=1e-10)
    assert boundary.any()


@row("igl.principal_curvature", needs="igl")
def test_principal_curvature(theirs: Side, ours: Side) -> None:
    # Smooth meshes, as they fit over five rings and we over fewer.
    bumpy = pf.shapes.bumpy_sphere(5, 0.1, 3.0)
    ellipsoid = pf.shapes.ellipsoid(3, 2, 1, level=5)
    torus = pf.shapes.torus(2, 0.5, 160, 80)
    for mesh in (bumpy, ellipsoid, torus, inverted(bumpy), inverted(ellipsoid), inverted(torus)):
        c = ours(mesh=mesh)
        PV1, PV2 = theirs(**arrays(mesh))
        assert off_by(c.kappa1, PV1) < 0.1 and off_by(c.kappa2, PV2) < 0.1
        H = (PV1 + PV2) / 2
        assert off_by(c.mean, H) < 0.05
        large = abs(H) > 0.1 * abs(H).max()
        assert (np.sign(c.mean) == np.sign(H))[large].all()
    assert (ours(mesh=ellipsoid).mean > 0).all() and (ours(mesh=inverted(ellipsoid)).mean < 0).all()


@row("igl.per_vertex_normals", needs="igl")
def test_per_vertex_normals(theirs: Side, ours: Side) -> None:
    for mesh in closed() + opened():
        np.testing.assert_allclose(ours(mesh=mesh), theirs(**arrays(mesh)), atol=1e-12)


@row("igl.hausdorff", needs="igl")
def test_hausdorff(theirs: Side, ours: Side) -> None:
    for other in closed():
        mesh = other.noise(0.1, seed=3)
        d = theirs(W=np.array(other.vertices), **arrays(mesh)) / other.diagonal
        # Theirs looks at vertices only, ours is an upper bound with a tolerance of 1e-3 diagonals at most.
        found = ours(mesh=mesh, other=other)
        assert d <= found * (1 + 1e-12) and found < d + 2e-3


@row("robust_laplacian.mesh_laplacian", needs="robust_laplacian")
def test_robust_laplacian(theirs: Side, ours: Side) -> None:
    for mesh in closed() + opened():
        L, A = theirs(**arrays(mesh))
        S, M = ours(mesh=mesh)
        # Theirs lengthens all sides by 1e-5 of the mean length, ours those of thin faces.
        np.testing.assert_allclose(M.diagonal(), A.diagonal(), rtol=1e-3)
        for k in range(3):
            u = mesh.vertices[:, k]
            np.testing.assert_allclose(S @ u, L @ u, atol=1e-3 * abs(L @ u).max())


@row("pp3d.MeshHeatMethodDistanceSolver", needs="potpourri3d")
def test_heat_method_solver(theirs: Side, ours: Side) -> None:
    for mesh in closed()[:2] + opened():
        expected = theirs(**arrays(mesh)).compute_distance(7)
        found = ours(mesh=mesh).distance(7)
        assert np.abs(found - expected).max() < 0.02 * found.max()


@row("pp3d.compute_distance", needs="potpourri3d")
def test_heat_method(theirs: Side, ours: Side) -> None:
    for mesh in closed()[:2] + opened():
        expected, found = theirs(i=7, **arrays(mesh)), ours(i=7, mesh=mesh)
        assert np.abs(found - expected).max() < 0.02 * found.max()


@row("trimesh.load", needs="trimesh")
def test_load(theirs: Side, ours: Side) -> None:
    for f in sorted((ROOT / "data").glob("*.ply"))[:3]:
        expected, mesh = theirs(f=f), ours(f=f)
        np.testing.assert_array_equal(mesh.vertices, expected.vertices)
        np.testing.assert_array_equal(mesh.faces, expected.faces)
        assert pf.Mesh(expected) == pf.Mesh(mesh.vertices, mesh.faces)


@row("tm.area", needs="trimesh")
def test_measures(theirs: Side, ours: Side) -> None:
    for mesh in closed() + opened():
        tm = trimesh_of(mesh)
        assert ours(mesh=mesh) == pytest.approx(theirs(tm=tm), rel=1e-12)
        assert mesh.info()["euler_characteristic"] == tm.euler_number
        if mesh.boundary_vertices.any():
            assert mesh.volume is None
        else:
            assert mesh.volume == pytest.approx(tm.volume, rel=1e-12)


@row("igl.vertex_components", needs="igl")
def test_components(theirs: Side, ours: Side) -> None:
    a, b = closed()[0], opened()[0]
    n = a.n_vertices
    mesh = pf.Mesh(np.vstack([a.vertices, b.vertices + 9]), np.vstack([a.faces, b.faces + n]))
    np.testing.assert_array_equal(ours(mesh=mesh), theirs(**arrays(mesh)))


@row("igl.signed_distance", needs="igl")
def test_signed_distance(theirs: Side, ours: Side) -> None:
    for mesh in closed()[:3]:
        P = np.random.default_rng(1).uniform(-1, 1, (500, 3)) * mesh.diagonal / 2
        distance, _, points = theirs(P=P, **arrays(mesh))[:3]
        found = ours(mesh=mesh, P=P)
        np.testing.assert_allclose(found.distance, distance, atol=1e-9)
        np.testing.assert_allclose(found.point, points, atol=1e-6)


def with_all_neighbours(mesh: pf.Mesh) -> Any:
    """The operator of trimesh's filters, with the neighbours at the boundary that its own leaves out."""
    import scipy.sparse

    i, j = mesh.edges.T
    ones = np.ones(2 * len(i))
    adjacent = scipy.sparse.csr_matrix((ones, (np.r_[i, j], np.r_[j, i])))
    return scipy.sparse.diags(1 / np.asarray(adjacent.sum(axis=1)).ravel()) @ adjacent


@row("trimesh.smoothing.filter_taubin", needs="trimesh")
def test_filter_taubin(theirs: Side, ours: Side) -> None:
    import trimesh

    for mesh in closed():
        tm = theirs(tm=trimesh_of(mesh))
        # One series for all pairs, to 2e-10.
        np.testing.assert_allclose(ours(mesh=mesh).vertices, tm.vertices, atol=1e-9)
    for mesh in opened():
        whole = {"lamb": 0.5, "nu": 0.53, "iterations": 20}
        tm = trimesh_of(mesh)
        trimesh.smoothing.filter_taubin(tm, laplacian_operator=with_all_neighbours(mesh), **whole)
        np.testing.assert_allclose(ours(mesh=mesh).vertices, tm.vertices, atol=1e-9)


@row("trimesh.smoothing.filter_humphrey", needs="trimesh")
def test_filter_humphrey(theirs: Side, ours: Side) -> None:
    import trimesh

    for mesh in closed():
        tm = theirs(tm=trimesh_of(mesh))
        np.testing.assert_allclose(ours(mesh=mesh).vertices, tm.vertices, atol=1e-13)
    for mesh in opened():
        tm = trimesh_of(mesh)
        trimesh.smoothing.filter_humphrey(tm, laplacian_operator=with_all_neighbours(mesh))
        np.testing.assert_allclose(ours(mesh=mesh).vertices, tm.vertices, atol=1e-13)


@row("trimesh.curvature.discrete_gaussian_curvature_measure", needs="trimesh")
def test_gaussian_curvature_measure(theirs: Side, ours: Side) -> None:
    sphere = pf.shapes.icosphere(4)
    large = sphere.with_vertices(5 * sphere.vertices)
    torus = pf.shapes.torus(2, 0.5, 120, 40)
    for mesh in (sphere, large, torus, inverted(torus)):
        r = 3 * mesh.mean_edge_length
        expected = theirs(tm=trimesh_of(mesh), V=np.array(mesh.vertices), r=r)
        found = ours(mesh=mesh, r=r) * np.pi * r**2
        assert off_by(found, expected) < 0.05
        curved = abs(expected) > 0.1 * abs(expected).max()
        assert (np.sign(found) == np.sign(expected))[curved].all()
    assert (expected < 0).any() and (expected > 0).any()


@row("lapy.Solver(geom).eigs", needs="lapy")
def test_eigs(theirs: Side, ours: Side) -> None:
    for mesh in [closed()[2], *opened()[:2]]:
        values, modes = theirs(geom=lapy_of(mesh), k=8)
        s = ours(mesh=mesh, k=8)
        np.testing.assert_allclose(s.values, values, atol=1e-8 * values[-1])
        # Both are orthonormal in the mass; the sign of a mode is arbitrary, and the basis of equal eigenvalues.
        overlap = modes.T @ (s.mass @ s.modes)
        for cluster in s.clusters():
            found = overlap[cluster.start : cluster.stop, cluster.start : cluster.stop]
            if cluster.stop < 8:
                np.testing.assert_allclose(found @ found.T, np.eye(len(cluster)), atol=1e-6)


@row("lapy.Solver(geom).poisson", needs="lapy")
def test_poisson(theirs: Side, ours: Side) -> None:
    dtup = (np.array([3, 10, 100]), np.array([1.0, -1.0, 2.0]))
    meshes = closed() + opened()
    # The robust Laplacian would give other values here.
    assert any(mesh.laplacian("non-negative").kind == "robust" for mesh in meshes)
    for mesh in meshes:
        geom = lapy_of(mesh)
        for h in (1.0, 0.0, -2, np.cos(2 * mesh.vertices[:, 1])):
            expected = theirs(geom=geom, h=h, dtup=dtup)
            found = ours(mesh=mesh, h=h, dtup=dtup)
            np.testing.assert_allclose(found, expected, atol=1e-9 * abs(expected).max())


@row("lapy.shapedna.compute_shapedna", needs="lapy.shapedna")
def test_compute_shapedna(theirs: Side, ours: Side) -> None:
    for mesh in [closed()[2], *opened()[:2]]:
        expected = theirs(geom=lapy_of(mesh), k=10)
        np.testing.assert_allclose(ours(mesh=mesh, k=10), expected, atol=1e-8 * expected[-1])


@row("lapy.shapedna.normalize_ev", needs="lapy.shapedna")
def test_normalize_ev(theirs: Side, ours: Side) -> None:
    for mesh in [closed()[2], *opened()[:2]]:
        geom = lapy_of(mesh)
        values, _ = sys.modules["lapy"].Solver(geom).eigs(10)
        expected = theirs(geom=geom, eigenvalues=values)
        np.testing.assert_allclose(ours(mesh=mesh, k=10), expected, atol=1e-8 * expected[-1])


@row("meshio.read", needs="meshio")
def test_meshio(theirs: Side, ours: Side) -> None:
    for f in sorted((ROOT / "data").glob("*.ply"))[:3]:
        expected, mesh = theirs(f=f), ours(f=f)
        np.testing.assert_array_equal(mesh.vertices, expected.points)
        np.testing.assert_array_equal(mesh.faces, expected.cells_dict["triangle"])
        assert pf.Mesh(expected) == pf.Mesh(mesh.vertices, mesh.faces)


@row("HKS(evals, evects, t)")
def test_hks(theirs: Side, ours: Side) -> None:
    def hks(evals: Any, evects: Any, t: Any) -> Any:
        """The formula of pyFM.signatures.HKS, which scales nothing unless asked to."""
        return np.square(evects) @ np.exp(-np.outer(t, evals)).T

    s = closed()[0].spectrum(20)
    t = np.array([0.01, 0.1, 1.0])
    expected = theirs(HKS=hks, evals=s.values, evects=s.modes, t=t)
    np.testing.assert_allclose(ours(s=s, t=t), expected, rtol=1e-12)


def test_every_row_is_tested() -> None:
    assert set(TABLE) == TESTED and len(TABLE) == 24
