"""Meshes of other packages, in and out; each test is skipped where the package is not installed."""

from __future__ import annotations

import sys
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyfairing as pf
import pytest

V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5], [2, 0, 0], [2, 1, 0.25]])
#: A quad and two triangles: faces 0 and 1 are parts of the quad.
POLYGONS = [[0, 1, 3, 2], [1, 4, 5], [1, 5, 3]]
PACKAGES = ["pyvista", "trimesh", "meshio", "open3d"]


@pytest.fixture
def mesh() -> pf.Mesh:
    """Polygons with every kind of field."""
    rng = np.random.default_rng(1)
    fields = {"a": rng.normal(size=6), "v": rng.normal(size=(6, 3)), "normal": rng.normal(size=(6, 3))}
    mesh = pf.Mesh.from_polygons(V, POLYGONS, fields | {"colors": rng.integers(0, 256, (6, 3), np.uint8)})
    part = [0, 0, 1, 2]
    colors = rng.integers(0, 256, (3, 3), np.uint8)[part]
    return mesh.with_face_fields(q=[0.5, 0.5, -1, 2], normal=np.eye(3)[part], colors=colors)


def triangles(mesh: pf.Mesh) -> pf.Mesh:
    texture = np.random.default_rng(2).random((mesh.n_faces, 3, 2))
    return pf.Mesh(mesh.vertices, mesh.faces, mesh.fields, mesh.face_fields).with_face_fields(texture=texture)


def assert_same(found: pf.Mesh, expected: pf.Mesh, without: tuple[str, ...] = ()) -> None:
    """The same numbers of the same types, bit by bit."""
    assert found == expected
    for one, other in ((found.fields, expected.fields), (found.face_fields, expected.face_fields)):
        assert set(one) == set(other) - set(without)
        for name, values in one.items():
            np.testing.assert_array_equal(values, other[name], strict=True)


@pytest.mark.parametrize("package", PACKAGES)
def test_triangles_and_their_fields_return(mesh: pf.Mesh, package: str) -> None:
    pytest.importorskip(package)
    mesh = triangles(mesh)
    if package == "open3d":
        assert_same(pf.Mesh(mesh.to_open3d(tensor=True)), mesh)
        with pytest.warns(pf.FairingWarning, match="cannot hold a, v, q of faces, colors of faces"):
            theirs = mesh.to_open3d()
        rest = pf.Mesh(mesh.vertices, mesh.faces, {n: mesh.fields[n] for n in ("normal", "colors")})
        assert_same(
            pf.Mesh(theirs), rest.with_face_fields({n: mesh.face_fields[n] for n in ("normal", "texture")})
        )
    else:
        assert_same(pf.Mesh(getattr(mesh, f"to_{package}")()), mesh)


@pytest.mark.parametrize("package", ["pyvista", "meshio"])
def test_polygons_and_their_fields_return(mesh: pf.Mesh, package: str) -> None:
    pytest.importorskip(package)
    convert = f"to_{package}"
    again = pf.Mesh(getattr(mesh, convert)())
    assert_same(again, mesh)
    assert again.polygons is not None and [p.tolist() for p in again.polygons] == POLYGONS
    with pytest.warns(pf.FairingWarning, match="face field q is left out: it differs within polygons"):
        again = pf.Mesh(getattr(mesh.with_face_fields(q=range(4)), convert)())
    assert_same(again, mesh, without=("q",))
    empty = pf.Mesh(V, np.zeros((0, 3), int))
    assert_same(pf.Mesh(getattr(empty, convert)()), empty)


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_that_is_missing_is_named(
    mesh: pf.Mesh, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=f"pip install {package}"):
        getattr(mesh, f"to_{package}")()


def test_tuples() -> None:
    faces = [[0, 1, 2], [1, 3, 2]]
    assert pf.Mesh((V, faces)) == pf.Mesh(V, faces)
    napari = pf.Mesh((V, faces, V[:, 2]))
    np.testing.assert_array_equal(napari.fields["values"], V[:, 2])
    with pytest.raises(TypeError, match=r"a tuple is \(vertices, faces\) or .*, not of 4"):
        pf.Mesh((V, faces, 1, 2))
    with pytest.raises(pf.OptionError, match=r"the field values has the shape \(2,\)"):
        pf.Mesh((V, faces, [1.0, 2.0]))
    with pytest.raises(pf.MeshError, match="face 1 names vertex 9"):
        pf.Mesh((V, [[0, 1, 2], [1, 9, 2]]))


def test_meshes_of_pyvista() -> None:
    pv = pytest.importorskip("pyvista")
    ball = pv.Sphere()
    mesh = pf.Mesh(ball)
    assert list(mesh.fields) == ["normal"] and mesh.n_vertices == ball.n_points
    np.testing.assert_array_equal(mesh.faces, ball.regular_faces)
    # Strips become triangles of the same orientation, with the data of their strips.
    strips = ball.strip()
    strips.cell_data["strip"] = np.arange(strips.n_cells)
    cut = pf.Mesh(strips)
    assert strips.n_strips and cut.volume == pytest.approx(mesh.volume) and cut.n_faces == mesh.n_faces
    assert (np.diff(cut.face_fields["strip"]) >= 0).all()
    assert len(np.unique(cut.face_fields["strip"])) == strips.n_cells
    with pytest.warns(pf.FairingWarning, match="TCoords is left out"):
        cube = pf.Mesh(pv.Cube())
    assert cube.polygons is not None and len(cube.polygons) == 6 and cube.volume == pytest.approx(1)
    np.testing.assert_array_equal(cube.face_fields["FaceIndex"], np.repeat(pv.Cube()["FaceIndex"], 2))
    mixed = pv.PolyData(V, faces=np.hstack([[len(p), *p] for p in POLYGONS]), lines=[2, 0, 5])
    mixed.cell_data["n"] = [7, 0, 1, 2]
    with pytest.warns(pf.FairingWarning, match="no faces are left out: 1 vertices and lines"):
        taken = pf.Mesh(mixed)
    assert taken.polygons is not None and [p.tolist() for p in taken.polygons] == POLYGONS
    assert taken.face_fields["n"].tolist() == [0, 0, 1, 2]
    with pytest.raises(TypeError, match=r"UnstructuredGrid is no surface, .* extract_surface\(\)"):
        pf.Mesh(ball.cast_to_unstructured_grid())


def test_meshes_of_vedo() -> None:
    vedo = pytest.importorskip("vedo")
    ball = vedo.Sphere(res=8)
    ball.pointdata["height"] = ball.vertices[:, 2]
    mesh = pf.Mesh(ball)
    np.testing.assert_array_equal(mesh.faces, ball.cells)
    np.testing.assert_array_equal(mesh.fields["height"], ball.vertices[:, 2])
    cube = pf.Mesh(vedo.Cube())
    assert cube.polygons is not None and len(cube.polygons) == 6


def test_meshes_of_open3d(mesh: pf.Mesh) -> None:
    o3d = pytest.importorskip("open3d")
    ball = o3d.geometry.TriangleMesh.create_sphere()
    ball.paint_uniform_color([1, 0.5, 0])
    taken = pf.Mesh(ball)
    np.testing.assert_array_equal(taken.faces, ball.triangles)
    assert taken.fields["colors"][0].tolist() == [255, 128, 0]
    new = o3d.t.geometry.TriangleMesh.from_legacy(ball)
    new.vertex["quality"] = o3d.core.Tensor(np.arange(len(taken.vertices))[:, None])
    found = pf.Mesh(new)
    np.testing.assert_allclose(found.vertices, taken.vertices, atol=1e-6)
    np.testing.assert_array_equal(found.fields["colors"], taken.fields["colors"])
    np.testing.assert_array_equal(found.fields["quality"], np.arange(found.n_vertices))
    new.vertex["colors"] = o3d.core.Tensor(taken.fields["colors"])
    np.testing.assert_array_equal(pf.Mesh(new).fields["colors"], taken.fields["colors"])
    assert pf.Mesh(o3d.t.geometry.TriangleMesh()).n_vertices == 0
    empty = pf.Mesh(V, np.zeros((0, 3), int))
    assert_same(pf.Mesh(empty.to_open3d()), empty)
    with pytest.raises(pf.OptionError, match="rename the field positions"):
        mesh.with_fields(positions=np.ones(6)).to_open3d(tensor=True)


def test_attributes_of_open3d_suffice(mesh: pf.Mesh) -> None:
    """The package is large, and often absent."""
    mesh = triangles(mesh)
    theirs: Any = SimpleNamespace(
        vertices=mesh.vertices,
        triangles=mesh.faces,
        vertex_normals=mesh.fields["normal"],
        vertex_colors=mesh.fields["colors"] / 255,
        triangle_normals=mesh.face_fields["normal"],
        triangle_uvs=mesh.face_fields["texture"].reshape(-1, 2),
    )
    found = pf.Mesh(theirs)
    assert found == mesh and set(found.fields) == {"normal", "colors"}
    np.testing.assert_array_equal(found.fields["colors"], mesh.fields["colors"])
    np.testing.assert_array_equal(found.face_fields["texture"], mesh.face_fields["texture"])


def test_colours_and_texture_of_trimesh() -> None:
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box()
    box.visual.face_colors = np.arange(48).reshape(12, 4)
    np.testing.assert_array_equal(pf.Mesh(box).face_fields["colors"], np.arange(48).reshape(12, 4)[:, :3])
    uv = np.random.default_rng(1).random((8, 2))
    box = trimesh.Trimesh(box.vertices, box.faces, process=False, visual=trimesh.visual.TextureVisuals(uv=uv))
    np.testing.assert_array_equal(pf.Mesh(box).face_fields["texture"], uv[box.faces])
