"""Edges, loops, neighbours, angles and moments; fields of several columns; meshes in a plane."""

from __future__ import annotations

import numpy as np
import pyfairing as pf
import pytest


@pytest.fixture(scope="module")
def pipe() -> pf.Mesh:
    return pf.shapes.cylinder(0.5, 2.0, 24, 20, ends="open")


def rows(array: np.ndarray) -> set[tuple[int, ...]]:
    return {tuple(row) for row in array.tolist()}


def test_loops_and_edges_of_a_pipe(pipe: pf.Mesh) -> None:
    loops = pipe.boundary_loops
    assert [len(loop) for loop in loops] == [24, 24] and loops[0].dtype == np.int64
    around = np.concatenate([np.column_stack([loop, np.roll(loop, -1)]) for loop in loops])
    # Each side has its face on the left, so the face runs along it.
    directed = rows(np.concatenate([pipe.faces[:, [k, (k + 1) % 3]] for k in range(3)]).astype(int))
    assert rows(around) <= directed
    assert rows(np.sort(around, axis=1)) == rows(pipe.boundary_edges)
    assert pipe.boundary_edges.dtype == np.int64 and len(pipe.nonmanifold_edges) == 0
    assert pf.shapes.icosphere(1).boundary_loops == []


def test_edges_of_three_faces_are_named() -> None:
    V = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]]
    book = pf.Mesh(V, [[0, 1, 2], [1, 0, 3], [0, 1, 4]])
    assert book.nonmanifold_edges.tolist() == [[0, 1]]
    assert (book.face_neighbors == -1).all()
    assert np.isnan(book.dihedral_angles).all()


def test_neighbors_share_the_edge_opposite_their_column(pipe: pf.Mesh) -> None:
    beside, faces = pipe.face_neighbors, pipe.faces.astype(int)
    assert beside.shape == faces.shape and (beside == -1).sum() == len(pipe.boundary_edges)
    for k in range(3):
        inside = beside[:, k] >= 0
        ends = faces[inside][:, [(k + 1) % 3, (k + 2) % 3]]
        others = faces[beside[inside, k]]
        assert all(set(pair) <= set(other) for pair, other in zip(ends, others, strict=True))


def test_angles_follow_the_laws(bumpy: pf.Mesh) -> None:
    angles = bumpy.corner_angles
    np.testing.assert_allclose(angles.sum(axis=1), np.pi, rtol=1e-14)
    defect = 2 * np.pi - np.bincount(bumpy.faces.ravel(), angles.ravel())
    assert defect.sum() == pytest.approx(4 * np.pi)
    # Integrated mean curvature: ½ Σ θ ℓ, on the unit sphere 4π.
    ball = pf.shapes.icosphere(4)
    ends = ball.vertices[ball.edges]
    lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
    assert ball.dihedral_angles @ lengths / 2 == pytest.approx(4 * np.pi, rel=2e-3)


def test_features_are_convex_or_concave() -> None:
    can = pf.shapes.cylinder(0.5, 2.0, 24, 20)
    inside_out = pf.Mesh(can.vertices, can.faces[:, ::-1])
    for mesh, sign in [(can, 1.0), (inside_out, -1.0)]:
        rims = mesh.feature_edges(60)
        assert rims.shape == (48, 2)
        heights = mesh.vertices[rims][:, :, 2]
        np.testing.assert_allclose(abs(heights - can.vertices[:, 2].mean()), 1.0)
        assert np.nanmax(sign * mesh.dihedral_angles) == pytest.approx(np.pi / 2)
    assert len(can.feature_edges(0)) == len(can.edges) and len(can.feature_edges(91)) == 0
    with pytest.raises(pf.OptionError, match="angle is 181"):
        can.feature_edges(181)


def test_moments_of_a_shifted_ball() -> None:
    ball = pf.shapes.icosphere(5)
    moved = ball.with_vertices(2 * ball.vertices + [3, -4, 5])
    solid, shell = moved.moments("volume"), moved.moments()
    assert solid.measure == pytest.approx(moved.volume) and shell.measure == pytest.approx(moved.area)
    for found in (solid, shell):
        np.testing.assert_allclose(found.centroid, [3, -4, 5], atol=1e-12)
    np.testing.assert_array_equal(moved.centroid, shell.centroid)
    # ⅖ m r² and ⅔ m r².
    np.testing.assert_allclose(solid.inertia, np.eye(3) * 0.4 * solid.measure * 4, rtol=2e-3, atol=1e-10)
    np.testing.assert_allclose(shell.inertia, np.eye(3) * 2 / 3 * shell.measure * 4, rtol=2e-3, atol=1e-10)


def test_moments_that_are_not_there_say_why(pipe: pf.Mesh) -> None:
    with pytest.raises(pf.ComputationError, match=r"open: edge \[0, 1\] has one face"):
        pipe.moments("volume")
    line = pf.Mesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]])
    with pytest.raises(pf.ComputationError, match="no area"):
        line.moments()
    assert np.isnan(line.centroid).all()
    with pytest.raises(pf.OptionError, match="of is 'solid'"):
        pipe.moments("solid")  # type: ignore[arg-type]


def test_peers_agree() -> None:
    trimesh = pytest.importorskip("trimesh")
    mesh = pf.shapes.bumpy_sphere(3, 0.2, 4.0)
    mesh = mesh.with_vertices(mesh.vertices * [1, 2, 3] + [1, 0, 0])
    theirs = trimesh.Trimesh(mesh.vertices, mesh.faces.astype(int), process=False)
    np.testing.assert_allclose(mesh.centroid, theirs.centroid, atol=1e-12)
    solid = mesh.moments("volume")
    np.testing.assert_allclose(solid.centroid, theirs.center_mass, atol=1e-12)
    np.testing.assert_allclose(solid.inertia, theirs.moment_inertia, atol=1e-9)
    np.testing.assert_allclose(mesh.corner_angles, theirs.face_angles, atol=1e-12)
    places = {tuple(sorted(pair)): i for i, pair in enumerate(theirs.face_adjacency_edges.tolist())}
    order = [places[tuple(pair)] for pair in mesh.edges.tolist()]
    angles = np.where(theirs.face_adjacency_convex[order], 1, -1) * theirs.face_adjacency_angles[order]
    np.testing.assert_allclose(mesh.dihedral_angles, angles, atol=1e-7)


def test_plane_meshes_have_two_coordinates() -> None:
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    mesh = pf.Mesh(square, [[0, 1, 2], [0, 2, 3]])
    assert mesh.vertices.shape == (4, 3) and mesh.area == 1 and (mesh.vertices[:, 2] == 0).all()
    assert pf.Mesh.from_polygons(square, [[0, 1, 2, 3]]).area == 1
    assert mesh.with_vertices(2.0 * np.array(square)).area == 4
    with pytest.raises(pf.MeshError, match="must have"):
        pf.Mesh(np.zeros((4, 4)), [[0, 1, 2]])
    with pytest.raises(pf.MeshError, match="must have"):
        mesh.closest([[0.0, 0.0]])


def test_columns_are_solved_one_by_one(bumpy: pf.Mesh) -> None:
    X = bumpy.vertices
    together = bumpy.heat(X, 0.1, steps=2)
    apart = np.column_stack([bumpy.heat(x, 0.1, steps=2) for x in X.T])
    np.testing.assert_array_equal(together, apart)
    np.testing.assert_array_equal(bumpy.heat(X), bumpy.heat(X, bumpy.mean_edge_length**2))
    assert bumpy.heat(X[:, :1]).shape == (len(X), 1)

    values = np.array([[1.0, 2.0, 3.0], [0.0, 1.0, -1.0]])
    together = bumpy.poisson(X, fixed=[3, 8], values=values)
    apart = np.column_stack([bumpy.poisson(X[:, j], fixed=[3, 8], values=values[:, j]) for j in range(3)])
    np.testing.assert_array_equal(together, apart)
    np.testing.assert_array_equal(bumpy.poisson(0, fixed=[3, 8], values=values)[[3, 8]], values)
    one = bumpy.poisson(X, fixed=[3], values=[2.0])
    np.testing.assert_array_equal(one[3], [2.0] * 3)
    with pytest.raises(pf.OptionError, match="f has 3 columns, but values 2"):
        bumpy.poisson(X, fixed=[3, 8], values=values[:, :2])
    with pytest.raises(pf.OptionError, match="temperatures has the shape"):
        bumpy.heat(X[1:])


def test_tolerances_are_in_mesh_units() -> None:
    ball = pf.shapes.icosphere(3)
    gaps = 1e-4 * np.random.default_rng(0).uniform(-1, 1, (3 * ball.n_faces, 3))
    soup = pf.Mesh(
        ball.vertices[ball.faces].reshape(-1, 3) + gaps, np.arange(3 * ball.n_faces).reshape(-1, 3)
    )
    assert soup.weld()[0].n_vertices == soup.n_vertices
    mesh, index = soup.weld(1e-3)
    assert mesh.n_vertices == ball.n_vertices and mesh.n_faces == ball.n_faces
    np.testing.assert_array_equal(index[soup.faces], mesh.faces)
    large = soup.with_vertices(1000 * soup.vertices)
    assert large.weld(1e-3)[0].n_vertices == large.n_vertices
    with pytest.raises(pf.OptionError, match="tolerance"):
        soup.weld(-1.0)
    fine = pf.compare(mesh, ball, hausdorff_tolerance=1e-4)
    same = pf.compare(mesh, ball, hausdorff_tolerance=1e-4 * ball.diagonal, unit="model")
    assert dict(fine) == pytest.approx(dict(same), rel=1e-9)
    with pytest.raises(pf.OptionError, match="unit is 'edge'"):
        pf.compare(mesh, ball, unit="edge")  # type: ignore[arg-type]
