"""Repair, components, submeshes, closest points, geodesic paths and isolines."""

from __future__ import annotations

import pickle

import numpy as np
import pyfairing as pf
import pytest


def broken(sphere: pf.Mesh) -> pf.Mesh:
    """A sphere without two faces, one of them turned, with a vertex of its own in one face."""
    faces = np.delete(sphere.faces, [0, 700], axis=0)
    faces[5] = faces[5][::-1]
    n = sphere.n_vertices
    vertices = np.vstack([sphere.vertices, sphere.vertices[faces[9, 0]], [[9, 9, 9]]])
    faces[9, 0] = n
    height = np.arange(n + 2.0)
    return pf.Mesh(vertices, faces, {"height": height, "normal": vertices})


def test_repair_mends_and_says_what(sphere: pf.Mesh) -> None:
    mesh = broken(sphere)
    n = sphere.n_vertices
    mended = mesh.repair(holes=10)
    info, report = mended.info(), mended.report
    assert info["closed"] and info["manifold"] and info["volume"] > 0 and not report["unchanged"]
    changes = {step: elements.tolist() for step, elements in report["changes"].items()}
    assert changes["merged-vertices"] == [n] and changes["turned-faces"] == [5]
    assert changes["isolated-vertices"] == [n + 1] and len(changes["filled-holes"]) == 2
    twin = int((mesh.vertices[:n] == mesh.vertices[n]).all(axis=1).argmax())
    assert report["vertices"][n + 1] == -1 and report["vertices"][n] == report["vertices"][twin]
    kept = report["vertex_sources"] >= 0
    np.testing.assert_array_equal(mended.vertices[kept], mesh.vertices[report["vertex_sources"][kept]])
    np.testing.assert_array_equal(mended.fields["height"][kept], report["vertex_sources"][kept])
    assert "normal" not in mended.fields and report["flat_patches"] is None
    assert (report["face_sources"] == -1).sum() == mended.n_faces - (report["face_sources"] >= 0).sum() > 0
    again = mended.repair(holes=10)
    assert again == mended and again.report["unchanged"] and again.report["changes"] == {}
    assert (pickle.loads(pickle.dumps(mended)).report["vertices"] == report["vertices"]).all()


def test_patches_continue_the_surface(sphere: pf.Mesh) -> None:
    low = sphere.vertices[:, 2] < 0.8
    open_, _ = sphere.submesh(low[sphere.faces].all(axis=1))
    z = open_.vertices[:, 2]
    mended = open_.with_fields(z=z).repair(holes=100)
    new = mended.report["vertex_sources"] == -1
    assert mended.info()["closed"] and new.sum() > 5
    # Not flat, but round, and with the fields of the rim.
    assert mended.vertices[new, 2].max() > 0.95 and mended.volume == pytest.approx(sphere.volume, rel=0.01)
    assert mended.fields["z"][new].min() > 0.5


def test_steps_can_be_left_out(sphere: pf.Mesh) -> None:
    mesh = broken(sphere)
    steps = {"merge": "merged-vertices", "orient": "turned-faces", "isolated": "isolated-vertices"}
    for step, name in steps.items():
        assert name in mesh.repair().report["changes"]
        assert name not in mesh.repair(**{step: False}).report["changes"]  # type: ignore[arg-type]
    with pytest.raises(pf.OptionError, match="tolerance is 2"):
        mesh.repair(tolerance=2)
    with pytest.raises(pf.OptionError, match="holes"):
        mesh.repair(holes=5000)
    with pytest.raises(pf.OptionError, match="unit"):
        mesh.repair(tolerance=0.1, unit="inch")  # type: ignore[arg-type]
    assert "normal" in sphere.with_fields(normal=sphere.vertices).repair().fields


def test_corners_that_differ_by_rounding_are_merged(sphere: pf.Mesh) -> None:
    corners = sphere.vertices[sphere.faces].reshape(-1, 3)
    off = 1e-9 * np.sin(np.arange(corners.size)).reshape(-1, 3)
    soup = pf.Mesh(corners + off, np.arange(len(corners)).reshape(-1, 3))
    count = soup.info()["rounded_vertices"]
    mended = soup.repair()
    assert mended.n_vertices == sphere.n_vertices and len(mended.report["changes"]["moved-vertices"]) == count > 0
    assert soup.repair(tolerance=0).n_vertices == soup.n_vertices
    assert soup.repair(tolerance=1e-8, unit="model").n_vertices == sphere.n_vertices
    assert soup.repair(tolerance=1e-10, unit="model").n_vertices > sphere.n_vertices


def test_a_solid_within_a_solid_stays_and_is_named(sphere: pf.Mesh) -> None:
    n, m = sphere.n_vertices, sphere.n_faces
    faces = np.vstack([sphere.faces, sphere.faces + n])
    both = pf.Mesh(np.vstack([sphere.vertices, 0.3 * sphere.vertices]), faces)
    kept, turned = both.repair(), both.repair(cavities=True)
    assert kept.volume == both.volume and kept.report["unchanged"]
    assert kept.report["changes"]["nested-parts"].tolist() == [m]
    assert turned.volume == pytest.approx(sphere.volume * (1 - 0.027))
    mirrored = pf.Mesh(turned.vertices, turned.faces[:, ::-1]).repair()
    assert mirrored.volume == pytest.approx(turned.volume)


def test_holes_that_stay_open_are_named(sphere: pf.Mesh) -> None:
    open_, _ = sphere.submesh((sphere.vertices[:, 2] < 0.8)[sphere.faces].all(axis=1))
    report = open_.repair(holes=3).report
    [(vertex, edges, reason)] = report["open_holes"]
    assert edges > 3 and reason == "too-large" and report["changes"]["open-holes"].tolist() == [vertex]
    assert open_.repair().report["open_holes"] == []


def test_info_has_hints(sphere: pf.Mesh) -> None:
    assert sphere.info()["hints"] == []
    inwards = pf.Mesh(sphere.vertices, sphere.faces[:, ::-1])
    assert any("inwards" in hint for hint in inwards.info()["hints"])


def test_components_and_submeshes(sphere: pf.Mesh) -> None:
    n, m = sphere.n_vertices, sphere.n_faces
    two = pf.Mesh(
        np.vstack([sphere.vertices, sphere.vertices + 3, [[0, 0, 0]]]),
        np.vstack([sphere.faces, sphere.faces + n]),
        {"x": np.arange(2.0 * n + 1)},
    )
    parts = two.components()
    assert parts.n_components == 2 and parts.vertices[-1] == -1
    assert (parts.vertices[:n] == 0).all() and (parts.faces == np.repeat([0, 1], m)).all()
    second, index = two.submesh(parts.faces == 1)
    assert second == pf.Mesh(two.vertices[n:-1], sphere.faces)
    np.testing.assert_array_equal(index, np.arange(n, 2 * n))
    np.testing.assert_array_equal(second.fields["x"], index)
    one, _ = two.submesh([7])
    assert (one.n_vertices, one.n_faces) == (3, 1)
    np.testing.assert_array_equal(one.vertices[one.faces[0]], two.vertices[two.faces[7]])
    assert two.submesh([])[0].n_faces == 0
    with pytest.raises(pf.OptionError, match=f"names face {2 * m}, but there are {2 * m} faces"):
        two.submesh(2 * m)
    assert pf.Mesh(np.zeros((2, 3)), []).components().n_components == 0


def test_closest_points_of_a_sphere(sphere: pf.Mesh) -> None:
    points = np.array([[0, 0, 0.3], [0, 2.0, 0], [0.1, 0.2, -0.1]])
    near = sphere.closest(points, signed=True)
    exact = np.linalg.norm(points, axis=1) - 1
    np.testing.assert_allclose(near.distance, exact, atol=0.01)
    np.testing.assert_allclose(np.linalg.norm(points - near.point, axis=1), np.abs(near.distance))
    np.testing.assert_array_equal(sphere.closest(points).distance, np.abs(near.distance))
    corners = sphere.vertices[sphere.faces[near.face]]
    assert (np.linalg.norm(corners.mean(axis=1) - near.point, axis=1) < sphere.mean_edge_length).all()
    assert sphere.closest(np.zeros((0, 3))).distance.shape == (0,)
    with pytest.raises(pf.ComputationError, match="no faces"):
        pf.Mesh([[0, 0, 0]], []).closest(points)
    with pytest.raises(pf.OptionError, match="not finite"):
        sphere.closest([[0, 0, np.nan]])


def test_area_and_volume(sphere: pf.Mesh, patch: pf.Mesh) -> None:
    assert sphere.area == pytest.approx(sphere.face_areas.sum())
    assert sphere.volume == pytest.approx(4 / 3 * np.pi, rel=0.02) and patch.volume is None


def test_sources_are_vertices_points_or_places_on_faces(sphere: pf.Mesh) -> None:
    d = sphere.geodesic_distance([3, 7])
    np.testing.assert_array_equal(sphere.geodesic_distance(sphere.vertices[[3, 7]]), d)
    corner = (sphere.faces == 3).argmax() // 3, np.eye(3)[(sphere.faces == 3).argmax() % 3]
    np.testing.assert_array_equal(sphere.geodesic_distance(corner), sphere.geodesic_distance(3))
    exact = np.arccos(np.clip(sphere.vertices @ [0.6, 0, 0.8], -1, 1))
    found = sphere.geodesic_distance([0.6, 0.0, 0.8])
    # Of first order: half an edge.
    assert np.abs(found - exact).max() < 0.5 * sphere.mean_edge_length
    on_faces = sphere.geodesic_distance(([4, 5], [[1, 1, 1], [0, 1, 2]]))
    assert np.isfinite(on_faces).all()
    with pytest.raises(pf.OptionError, match="names face 1280"):
        sphere.geodesic_distance((1280, [1, 0, 0]))
    with pytest.raises(pf.OptionError, match="1 barycentric coordinates for 2 faces"):
        sphere.geodesic_distance(([1, 2], [1, 0, 0]))
    with pytest.raises(pf.OptionError, match="is -1"):
        sphere.geodesic_distance((1, [-1, 1, 1]))


def test_paths_lead_to_the_source(sphere: pf.Mesh) -> None:
    d = sphere.geodesic_distance(0)
    start = int(d.argmax())
    path = sphere.geodesic_path(start, 0)
    np.testing.assert_array_equal(path[[0, -1]], sphere.vertices[[start, 0]])
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert length == pytest.approx(np.pi, rel=0.02)
    np.testing.assert_array_equal(pf.GeodesicSolver(sphere).path(start, 0), path)
    faces = np.vstack([sphere.faces, sphere.faces + 642])
    two = pf.Mesh(np.vstack([sphere.vertices, sphere.vertices + 3]), faces)
    with pytest.raises(pf.ComputationError, match="vertex 700 has no distance"):
        two.geodesic_path(700, 0)


def test_isolines_are_circles(sphere: pf.Mesh) -> None:
    d = sphere.geodesic_distance(0)
    lines = sphere.isolines(d, [0.5, 1.5, 9.0])
    assert [line.shape[1:] for line in lines] == [(2, 3)] * 3 and len(lines[2]) == 0
    for line, level in zip(lines, (0.5, 1.5), strict=False):
        length = np.linalg.norm(line[:, 0] - line[:, 1], axis=1).sum()
        assert length == pytest.approx(2 * np.pi * np.sin(level), rel=0.1)
    assert len(sphere.isolines(np.full(642, np.inf), 1.0)[0]) == 0
    unknown, infinite = (np.where(np.arange(642) == 2, x, sphere.vertices[:, 2]) for x in (np.nan, np.inf))
    at = sphere.vertices[2, 2] - 0.01
    found, expected = (sphere.isolines(values, at)[0] for values in (unknown, infinite))
    assert 0 < len(found) < len(sphere.isolines(sphere.vertices[:, 2], at)[0])
    np.testing.assert_array_equal(found, expected)


def test_isolines_through_vertices_and_along_edges() -> None:
    n = 5
    points = np.array([(i, j, 0.0) for i in range(n) for j in range(n)])
    corners = [i * n + j for i in range(n - 1) for j in range(n - 1)]
    faces = [t for a in corners for t in ((a, a + n, a + n + 1), (a, a + n + 1, a + 1))]
    grid = pf.Mesh(points, faces)
    for lines in grid.isolines(points[:, 0], [0.0, 2.0, 4.0], polylines=True):
        (line,) = lines
        assert not line.closed and len(line.points) == n and (line.edges[:, 0] == line.edges[:, 1]).all()
        np.testing.assert_array_equal(line.points, points[line.edges[:, 0]])
    segments = grid.isolines(points[:, 0] + points[:, 1], 2.0)[0]
    assert np.linalg.norm(segments[:, 0] - segments[:, 1], axis=1).min() > 0
    assert len(np.unique(np.sort(segments, axis=1), axis=0)) == len(segments) == 4


def test_solvers_can_be_pickled(sphere: pf.Mesh) -> None:
    solver = pickle.loads(pickle.dumps(pf.GeodesicSolver(sphere, "robust", time=0.01)))
    assert repr(solver) == "GeodesicSolver(642 vertices, robust)"
    np.testing.assert_array_equal(solver.distance(0), sphere.geodesic_distance(0, "robust", time=0.01))
    heat = pf.HeatSolver(sphere, 0.5, "cotangent", "mixed")
    again = pickle.loads(pickle.dumps(heat))
    z = sphere.vertices[:, 2]
    np.testing.assert_array_equal(again.step(z), heat.step(z))
    assert repr(again) == repr(heat) == "HeatSolver(642 vertices, time 0.5, cotangent, mixed)"
