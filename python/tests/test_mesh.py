"""The mesh as an object of Python."""

from __future__ import annotations

import copy
import gc
import gzip
import pickle
import warnings
import weakref
from pathlib import Path

import numpy as np
import pyfairing as pf
import pytest

V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.5]])
F = np.array([[0, 1, 2], [1, 3, 2]])


def test_vertices_and_faces_are_not_copied_again() -> None:
    mesh = pf.Mesh(V, F)
    assert mesh.vertices.dtype == np.float64 and mesh.faces.dtype == np.int64
    assert mesh.faces is mesh.faces and not mesh.faces.flags.writeable
    assert mesh.vertices.ctypes.data == mesh.vertices.ctypes.data
    assert np.shares_memory(mesh.vertices, mesh.vertices)
    np.testing.assert_array_equal(mesh.vertices, V)
    np.testing.assert_array_equal(mesh.faces, F)
    with pytest.raises(ValueError, match="read-only"):
        mesh.vertices[0, 0] = 1
    with pytest.raises(ValueError):
        mesh.vertices.flags.writeable = True


def test_a_view_keeps_its_mesh_alive() -> None:
    view = pf.shapes.icosphere(4).vertices
    gc.collect()
    np.testing.assert_allclose(np.linalg.norm(view, axis=1), 1)


def test_a_mesh_does_not_see_later_changes_of_the_arrays() -> None:
    vertices = V.copy()
    mesh = pf.Mesh(vertices, F)
    vertices[0] = 7
    assert mesh.vertices[0, 0] == 0


def test_a_mesh_never_changes() -> None:
    mesh = pf.Mesh(V, F)
    with pytest.raises(AttributeError):
        mesh.vertices = V  # type: ignore[misc]
    with pytest.raises(AttributeError):
        mesh.colour = 1  # type: ignore[attr-defined]
    with pytest.raises(AttributeError):
        del mesh._core
    with pytest.raises(TypeError):
        mesh.fields["x"] = V[:, 0]  # type: ignore[index]


def test_pickle_copy_equality_and_hash() -> None:
    mesh = pf.Mesh(V, F, {"height": V[:, 2], "colors": np.zeros((4, 3), np.uint8)})
    for again in (pickle.loads(pickle.dumps(mesh)), copy.deepcopy(mesh), copy.copy(mesh)):
        assert again == mesh and hash(again) == hash(mesh)
        assert list(again.fields) == ["height", "colors"]
        again.fields["height"][:] = 7
        assert again.fields["height"].tolist() == V[:, 2].tolist()
        assert np.shares_memory(again.fields.view("height"), again.fields.view("height"))
        assert not again.fields.view("height").flags.writeable
    assert mesh != mesh.with_vertices(V + 1)
    assert mesh != 3
    assert len({mesh, pickle.loads(pickle.dumps(mesh))}) == 1


def test_repr_and_html() -> None:
    mesh = pf.Mesh(V, F, {"height": V[:, 2]})
    assert repr(mesh) == "Mesh(4 vertices, 2 faces, fields height)"
    html = mesh._repr_html_()
    assert "data:image/png;base64," in html and "height" in html
    # An empty mesh is drawn without an error.
    assert "no face" in pf.Mesh(V, np.zeros((0, 3), int))._repr_html_()


def test_weak_references() -> None:
    mesh = pf.Mesh(V, F)
    reference = weakref.ref(mesh)
    del mesh
    gc.collect()
    assert reference() is None


@pytest.mark.parametrize("extension", ["ply", "obj", "off", "stl", "ply.gz", "obj.gz"])
def test_files_read_back(tmp_path, sphere: pf.Mesh, extension: str) -> None:
    path = tmp_path / f"mesh.{extension}"
    if extension == "stl":
        with pytest.warns(pf.FairingWarning) as seen:
            sphere.write(path)
        notes = " ".join(str(w.message) for w in seen)
        assert "32 bits" in notes and "first appearance" in notes
    else:
        sphere.write(path)
    again = pf.read(path)
    if extension == "stl":
        # It has 32 bits and no vertices of its own.
        assert again.n_faces == sphere.n_faces and again.n_vertices == sphere.n_vertices
    else:
        assert again == sphere
    assert again.report["format"].lower() == extension.split(".")[0]


def test_fields_read_back(tmp_path, sphere: pf.Mesh) -> None:
    rng = np.random.default_rng(1)
    n = sphere.n_vertices
    fields = {
        "a": rng.normal(size=n),
        "v": rng.normal(size=(n, 3)),
        "colors": rng.integers(0, 255, (n, 3), np.uint8),
    }
    mesh = sphere.with_fields(fields)
    mesh.write(tmp_path / "mesh.ply")
    again = pf.read(tmp_path / "mesh.ply")
    assert list(again.fields) == list(fields)
    for name, values in fields.items():
        np.testing.assert_array_equal(again.fields[name], values)
    with pytest.warns(pf.FairingWarning, match="cannot hold a, v"):
        mesh.write(tmp_path / "mesh.obj")
    assert mesh.smooth().fields.keys() == fields.keys()
    with pytest.raises(pf.OptionError, match="the field b has the shape"):
        sphere.with_fields(b=[1.0])


def test_bytes(sphere: pf.Mesh) -> None:
    assert pf.read_bytes(sphere.to_bytes("off")) == sphere
    assert pf.read_bytes(gzip.compress(sphere.to_bytes("ply")), "x.ply.gz") == sphere


def test_what_a_reader_changes_is_warned_of() -> None:
    square = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 1 2\n"
    with pytest.warns(pf.FairingWarning, match="square.obj") as seen:
        mesh = pf.read_bytes(square, "square.obj")
    assert mesh.report["polygons"] == 1 and mesh.report["left_out_faces"] == 1
    # In the name of the caller.
    assert seen[0].filename == __file__
    with pytest.raises(pf.MeshError, match="strict"):
        pf.read_bytes(square, "square.obj", strict=True)


def test_what_is_broken_is_dropped_on_request(tmp_path) -> None:
    broken = b"v 0 0 0\nv 1 0 0\nv nan 1 0\nv 0 1 0\nf 1 2 4\nf 1 2 3\nf 1 2 9\n"
    (tmp_path / "broken.obj").write_bytes(broken)
    for options in ({}, {"strict": True}):
        with pytest.raises(pf.MeshError, match="vertex 2 has the coordinate NaN"):
            pf.read(tmp_path / "broken.obj", **options)
    for read in (lambda **o: pf.read(tmp_path / "broken.obj", **o), lambda **o: pf.read_bytes(broken, **o)):
        with pytest.warns(pf.FairingWarning, match="1 vertex is not finite"):
            mesh = read(drop_broken=True)
        assert mesh.faces.tolist() == [[0, 1, 3]] and mesh.vertices[2].tolist() == [0, 0, 0]
        assert (mesh.report["broken_vertices"], mesh.report["broken_faces"]) == (1, 2)
        with pytest.raises(pf.OptionError, match="drop_broken"):
            read(drop_broken=True, strict=True)


def test_polygons() -> None:
    mesh = pf.Mesh.from_polygons(V[[0, 1, 3, 2]], [[0, 1, 2, 3]])
    assert mesh.n_faces == 2
    assert [own.tolist() for own in mesh.polygons] == [[0, 1, 2, 3]]
    assert pf.Mesh(V, F).polygons is None
    assert pf.Mesh.from_polygons(V, np.array([[0, 1, 3, 2]])).n_faces == 2
    with pytest.raises(pf.MeshError, match="fewer than three"):
        pf.Mesh.from_polygons(V, [[0, 1]])
    with pytest.raises(pf.MeshError):
        pf.Mesh.from_polygons(V, [[0, 1, -2]])


def test_polygons_stay_until_faces_change(tmp_path) -> None:
    x, y = np.meshgrid(np.arange(6.0), np.arange(5.0))
    v = np.column_stack([x.ravel(), y.ravel(), np.sin(x + y).ravel()])
    quads = [[6 * j + i, 6 * j + i + 1, 6 * j + i + 7, 6 * j + i + 6] for j in range(4) for i in range(5)]
    quads[3:5] = [[3, 4, 5, 11, 10, 9]]
    part = np.repeat(np.arange(19.0), [2] * 3 + [4] + [2] * 15)
    mesh = pf.Mesh.from_polygons(v, quads).with_face_fields(part=part)
    same = [
        mesh.smooth(iterations=1),
        mesh.denoise(),
        mesh.noise(0.1),
        mesh.with_vertices(2 * v),
        mesh.with_fields(z=v[:, 2]),
        pickle.loads(pickle.dumps(mesh.with_vertices(v * [1, 1, -3]))),
    ]
    for other in same:
        assert [own.tolist() for own in other.polygons] == quads
    assert (same[-1].faces == mesh.faces).all()
    for name in ("a.ply", "a.obj", "a.off", "a.vtp"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pf.FairingWarning)
            mesh.write(tmp_path / name)
            again = pf.read(tmp_path / name)
        assert [own.tolist() for own in again.polygons] == quads
        if name[2:] in ("ply", "vtp"):
            assert (again.face_fields["part"] == mesh.face_fields["part"]).all()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", pf.FairingWarning)
        mesh.write(tmp_path / "a.stl")
    assert any("19 polygons are split into triangles" in str(warning.message) for warning in caught)
    assert mesh.subdivide("midpoint").polygons is None


def test_what_numpy_users_expect(sphere: pf.Mesh) -> None:
    """Indices are int64, and what is undefined is NaN."""
    quad = pf.Mesh.from_polygons(V[[0, 1, 3, 2]], [[0, 1, 2, 3]])
    line = sphere.isolines(sphere.vertices[:, 2], 0.5, polylines=True)[0][0]
    parts = sphere.components()
    report = pf.Mesh(V[[0, 1, 2, 0, 1, 3]], [[0, 1, 2], [3, 4, 5]]).repair().report
    for indices in (
        *(quad.faces, *quad.polygons, sphere.edges, sphere.closest(V).face, sphere.weld()[1], line.edges),
        *(sphere.submesh([3])[1], parts.vertices, parts.faces, report["vertices"]),
        *(report["vertex_sources"], report["face_sources"], report["changes"]["merged-vertices"]),
    ):
        assert indices.dtype == np.int64
    flat = pf.Mesh(np.vstack([V, [[2, 2, 2]]]), np.vstack([F, [[0, 1, 1]]])[:2])
    thin = flat.with_vertices(flat.vertices * [[1, 0, 0]])
    assert np.isnan(thin.face_normals).all()
    assert np.isnan(flat.vertex_normals()).any(axis=1).tolist() == [False] * 4 + [True]
    assert np.isinf(flat.geodesic_distance(0)).tolist() == [False] * 4 + [True]


def test_statements_of_obj_stay(tmp_path) -> None:
    lines = [
        "mtllib a.mtl",
        *(f"v {x} {y} {z}" for x, y, z in V),
        "usemtl red",
        "f 1 2 3",
        "usemtl blue",
        "f 1 2 4",
    ]
    (tmp_path / "a.obj").write_text("\n".join(lines) + "\n")
    (tmp_path / "a.mtl").write_text("newmtl red\nnewmtl blue\n")
    mesh = pf.read(tmp_path / "a.obj")
    for other in (mesh, mesh.with_vertices(2 * V), pickle.loads(pickle.dumps(mesh))):
        other.write(tmp_path / "b.obj")
        written = (tmp_path / "b.obj").read_text().splitlines()
        assert [line for line in written if line[0] not in "v#"] == [lines[0], *lines[5:]]


def test_errors_of_files(tmp_path) -> None:
    with pytest.raises(FileNotFoundError) as missing:
        pf.read(tmp_path / "no.ply")
    assert missing.value.filename == str(tmp_path / "no.ply") and missing.value.errno == 2
    with pytest.raises(IsADirectoryError):
        pf.read(tmp_path)
    bad = tmp_path / "bad.obj"
    bad.write_text("v 0 0 0\nv 1 x 0\n")
    with pytest.raises(pf.MeshError, match=r"bad\.obj: line 2: .*found"):
        pf.read(bad)
    with pytest.raises(FileNotFoundError):
        pf.Mesh(V, F).write(tmp_path / "no" / "mesh.ply")
    with pytest.raises(pf.OptionError, match="extension must be"):
        pf.Mesh(V, F).write(tmp_path / "mesh.abc")
    assert not list(tmp_path.glob("mesh*"))


def test_info_and_measures(sphere: pf.Mesh, patch: pf.Mesh) -> None:
    info = sphere.info()
    assert (info["vertices"], info["faces"], info["genus"], info["closed"]) == (642, 1280, 0, True)
    assert info["volume"] == pytest.approx(4 / 3 * np.pi, rel=0.02)
    assert sphere.face_areas.sum() == pytest.approx(info["area"])
    assert sphere.edges.shape == (info["edges"], 2) and (sphere.edges[:, 0] < sphere.edges[:, 1]).all()
    assert not sphere.boundary_vertices.any() and patch.boundary_vertices.any()
    np.testing.assert_allclose(np.linalg.norm(sphere.face_normals, axis=1), 1)
    for weight in ("area", "angle", "sphere", "uniform"):
        assert (np.einsum("ij,ij->i", sphere.vertex_normals(weight), sphere.vertices) > 0.99).all()
    with pytest.raises(pf.OptionError, match="there are area, angle"):
        sphere.vertex_normals("volume")  # type: ignore[arg-type]


def test_subdivision(sphere: pf.Mesh) -> None:
    for scheme in ("loop", "midpoint"):
        assert sphere.subdivide(scheme).n_faces == 4 * sphere.n_faces


def test_other_packages_objects(sphere: pf.Mesh) -> None:
    trimesh = pytest.importorskip("trimesh")
    meshio = pytest.importorskip("meshio")
    assert pf.Mesh(sphere.to_trimesh()) == sphere
    assert pf.Mesh(trimesh.creation.box()).info()["volume"] == pytest.approx(1)
    fielded = sphere.with_fields(height=sphere.vertices[:, 2])
    again = pf.Mesh(fielded.to_meshio())
    assert again == sphere and list(again.fields) == ["height"]
    quads = meshio.Mesh(V[[0, 1, 3, 2]], [("quad", [[0, 1, 2, 3]]), ("line", [[0, 1]])])
    with pytest.warns(pf.FairingWarning, match="line"):
        assert pf.Mesh(quads).n_faces == 2
    assert pf.Mesh(sphere) == sphere
    with pytest.raises(TypeError, match="not of str"):
        pf.Mesh("bunny.ply")


@pytest.mark.parametrize("name", [n for n in pf.shapes.__all__])
def test_shapes(name: str) -> None:
    small = {"creature": {"resolution": 48}, "flower": {"spacing": 0.1}}
    mesh = getattr(pf.shapes, name)(**small.get(name, {}))
    info = mesh.info()
    assert info["manifold"] and info["degenerate_faces"] == 0 and info["isolated_vertices"] == 0
    assert info["orientable"] == (name != "moebius")


def test_bad_shapes() -> None:
    for make in (
        lambda: pf.shapes.icosphere(14),
        lambda: pf.shapes.torus(1, 2),
        lambda: pf.shapes.torus(1e31, 1e30),
        lambda: pf.shapes.ellipsoid(1e-40, 1.0, 1.0),
        lambda: pf.shapes.cylinder(1.0, float("inf")),
        lambda: pf.shapes.helicoid(rise=1e20, turns=1e20),
        lambda: pf.shapes.cylinder(radius=float("nan")),
        lambda: pf.shapes.plane(1 << 20, 1 << 20),
        lambda: pf.shapes.cube(0),
        lambda: pf.shapes.cad_block(1e-9),
        lambda: pf.shapes.icosphere(-1),
    ):
        with pytest.raises(pf.OptionError):
            make()


def test_turned_faces_change_no_result(sphere: pf.Mesh) -> None:
    faces = sphere.faces.copy()
    turned = np.random.default_rng(4).random(len(faces)) < 0.3
    faces[turned] = faces[turned][:, ::-1]
    mixed = pf.Mesh(sphere.vertices, faces)
    assert mixed.info()["turned_faces"] == turned.sum()
    with pytest.warns(pf.FairingWarning, match=f"{turned.sum()} of {len(faces)} faces turn against"):
        found = mixed.curvature()
    expected = sphere.curvature()
    assert np.allclose(found.mean, expected.mean, rtol=1e-9)
    with pytest.warns(pf.FairingWarning, match="turn against"):
        assert np.allclose(mixed.vertex_normals(), sphere.vertex_normals(), atol=1e-12)
    with pytest.warns(pf.FairingWarning, match="turn against"):
        noisy = mixed.noise(0.2)
    assert np.allclose(noisy.vertices, sphere.noise(0.2).vertices, atol=1e-12)
    with pytest.warns(pf.FairingWarning, match="turn against"):
        clean = noisy.denoise()
    assert np.array_equal(clean.faces, mixed.faces)
    # The networks sum in single precision, in the order of the corners.
    assert np.allclose(clean.vertices, sphere.noise(0.2).denoise().vertices, atol=1e-7)


def test_one_sided_parts_are_warned_of() -> None:
    band = pf.shapes.moebius(0.4, 40, 4)
    with pytest.warns(pf.FairingWarning, match="one-sided"):
        found = band.curvature()
    assert (found.mean >= 0).all() and (found.gaussian < 0).any()


def test_faces_with_corners_of_their_own(sphere: pf.Mesh) -> None:
    corners = sphere.vertices[sphere.faces].reshape(-1, 3)
    soup = pf.Mesh(corners, np.arange(len(corners)).reshape(-1, 3))
    for refused in (soup.smooth, soup.denoise, soup.curvature, soup.spectrum):
        with pytest.raises(pf.ComputationError, match="do not share their corners"):
            refused()
    mesh, index = soup.weld()
    assert len(mesh.vertices) == len(sphere.vertices)
    back = soup.with_vertices(mesh.smooth().vertices[index])
    expected = sphere.smooth().vertices[sphere.faces].reshape(-1, 3)
    assert np.allclose(back.vertices, expected, atol=1e-12)


def test_fields_of_faces_survive_a_round_trip(tmp_path: Path) -> None:
    colors = np.array([[255, 0, 1], [2, 3, 4]], np.uint8)
    texture = np.arange(12.0).reshape(2, 3, 2)
    given = {"quality": [0.1, 1e300], "normal": [[0, 0, 1], [0, 1, 0]], "colors": colors, "texture": texture}
    mesh = pf.Mesh(V, F, {"height": V[:, 2]}, given)
    assert repr(mesh).endswith("fields height, face fields quality, normal, colors, texture)")
    mesh.write(tmp_path / "a.ply")
    meshio = pytest.importorskip("meshio")
    for again in (
        pf.read(tmp_path / "a.ply"),
        pf.read_bytes(mesh.to_bytes("ply", ascii=True), "a.ply"),
        pickle.loads(pickle.dumps(mesh)),
        pf.Mesh(mesh),
        pf.Mesh(mesh.to_meshio()),
        pf.Mesh(V, F, {"height": V[:, 2]}).with_face_fields(given),
    ):
        assert list(again.face_fields) == list(given) and list(again.fields) == ["height"]
        for name, values in given.items():
            found = again.face_fields[name]
            np.testing.assert_array_equal(found, values)
            assert found.flags.writeable and found.dtype == (np.uint8 if name == "colors" else np.float64)
    with pytest.warns(pf.FairingWarning, match="cannot hold .*quality of faces"):
        mesh.write(tmp_path / "a.obj")
    assert "normal" not in mesh.with_vertices(V + 1).face_fields and "quality" in mesh.smooth().face_fields
    meshio.write(tmp_path / "b.vtu", mesh.to_meshio())


def test_fields_of_faces_follow_their_faces() -> None:
    texture = np.arange(18.0).reshape(3, 3, 2)
    faces = [[0, 1, 2], [1, 2, 3], [0, 1, 2]]
    mesh = pf.Mesh(V, faces, face_fields={"n": [0, 1, 2], "texture": texture, "normal": np.eye(3)})
    part, _ = mesh.submesh([1])
    assert part.face_fields["n"].tolist() == [1.0]
    np.testing.assert_array_equal(part.face_fields["texture"], texture[1:2])
    # One face is flipped, and the third one dropped.
    whole = mesh.repair()
    assert (whole.faces != faces[:2]).any()
    assert list(whole.face_fields) == ["n", "texture"] and whole.face_fields["n"].tolist() == [0.0, 1.0]
    for face in (0, 1):
        for corner, vertex in enumerate(whole.faces[face]):
            expected = texture[face][faces[face].index(vertex)]
            np.testing.assert_array_equal(whole.face_fields["texture"][face][corner], expected)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"a": [1.0]}, r"the face field a has the shape \(1,\), but must have \(2,\) or \(2, 3\)"),
        ({"a": [1.0, np.nan]}, "the face field a is nan at 1"),
        ({"texture": np.zeros((2, 3))}, r"texture has the shape \(2, 3\), but must have \(2, 3, 2\)"),
        ({"colors": np.zeros((4, 3), np.uint8)}, r"colors are uint8 of shape \(4, 3\)"),
    ],
)
def test_fields_of_faces_are_checked(given: dict[str, object], message: str) -> None:
    with pytest.raises(pf.OptionError, match=message):
        pf.Mesh(V, F, face_fields=given)
