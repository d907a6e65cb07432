"""The same numbers as other packages, on the corpus; each is skipped where it is not installed."""

from __future__ import annotations

import warnings

import numpy as np
import pyfairing as pf
import pytest
import scipy.sparse.linalg
from conftest import corpus

CORPUS = corpus()


def loaded(path) -> pf.Mesh:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pf.FairingWarning)
        return pf.read(path)


@pytest.fixture(scope="module", params=CORPUS, ids=lambda p: p.stem)
def mesh(request) -> pf.Mesh:
    mesh = loaded(request.param)
    if 2 * mesh.info()["seam_vertices"] > mesh.n_vertices:
        mesh, _ = mesh.weld()
    if mesh.n_faces > 60_000:
        pytest.skip("too large for the peers")
    return mesh


def sound(mesh: pf.Mesh) -> pf.Mesh:
    info = mesh.info()
    if info["degenerate_faces"] or info["sliver_faces"] or info["isolated_vertices"]:
        pytest.skip("the peers do not take degenerate faces and isolated vertices")
    return mesh


def arrays(mesh: pf.Mesh) -> tuple[np.ndarray, np.ndarray]:
    return np.array(mesh.vertices), mesh.faces


def test_cotangents_of_libigl(mesh: pf.Mesh) -> None:
    igl = pytest.importorskip("igl")
    S, M = sound(mesh).laplacian("cotangent")
    V, F = arrays(mesh)
    # Theirs is negative semi-definite. Cotangents of thin faces are large: relative to the largest.
    assert abs(S + igl.cotmatrix(V, F)).max() <= 1e-9 * abs(S).max()
    theirs = igl.massmatrix(V, F, igl.MASSMATRIX_TYPE_BARYCENTRIC)
    assert abs(M - theirs).max() <= 1e-12 * M.max()
    mixed = mesh.laplacian("cotangent", "mixed").mass
    assert abs(mixed - igl.massmatrix(V, F, igl.MASSMATRIX_TYPE_VORONOI)).max() <= 1e-9 * mixed.max()


def test_gradient_of_libigl(mesh: pf.Mesh) -> None:
    igl = pytest.importorskip("igl")
    V, F = arrays(sound(mesh))
    u = V[:, 0]
    # Theirs has all x, then all y, then all z.
    theirs = (igl.grad(V, F) @ u).reshape(3, -1).T
    np.testing.assert_allclose((mesh.gradient() @ u).reshape(-1, 3), theirs, atol=1e-7)


def test_gaussian_curvature_of_libigl(mesh: pf.Mesh) -> None:
    igl = pytest.importorskip("igl")
    if not mesh.info()["manifold"]:
        pytest.skip("angle defects at edges of three faces are not comparable")
    V, F = arrays(sound(mesh))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pf.FairingWarning)
        c = mesh.curvature("cotangent")
    area = mesh.laplacian("cotangent", "mixed").mass.diagonal()
    # Theirs is 2π − Σθ at the boundary too; ours takes off π there, (e − f)π for e edges and f faces.
    n = mesh.n_vertices
    fans = np.bincount(mesh.edges.ravel(), minlength=n) - np.bincount(F.ravel(), minlength=n)
    np.testing.assert_allclose(c.gaussian * area + np.pi * fans, igl.gaussian_curvature(V, F), atol=1e-6)


def test_the_robust_laplacian_of_its_authors(mesh: pf.Mesh) -> None:
    robust = pytest.importorskip("robust_laplacian")
    info = mesh.info()
    if info["isolated_vertices"]:
        pytest.skip("theirs does not take isolated vertices")
    if info["degenerate_faces"] or info["sliver_faces"]:
        pytest.skip("mollified in another way")
    S, M = mesh.laplacian("robust")
    L, A = robust.mesh_laplacian(*arrays(mesh))
    # Total areas are sums of triangles of the same metric; of faces with four corners on a circle either
    # diagonal is Delaunay, so that single entries may differ, and quadratic forms do not.
    assert M.sum() == pytest.approx(A.sum(), rel=1e-6)
    for f in np.eye(3):
        # Of coordinates far from the origin the rounding of a form would be seen.
        u = (mesh.vertices - mesh.vertices.mean(axis=0)) @ f
        # They mollify all faces by 1e-5 of the mean length, we thin ones only.
        assert u @ (S @ u) == pytest.approx(u @ (L @ u), rel=1e-3)


def test_the_heat_method_of_potpourri3d(mesh: pf.Mesh) -> None:
    pp3d = pytest.importorskip("potpourri3d")
    info = sound(mesh).info()
    if info["components"] != 1:
        pytest.skip("theirs gives no infinity for other components")
    V, F = arrays(mesh)
    theirs = pp3d.MeshHeatMethodDistanceSolver(V, F, use_robust=True).compute_distance(0)
    ours = mesh.geodesic_distance(0, kind="robust")
    # Two approximations of first order: they agree to some edge lengths.
    error = np.abs(ours - (theirs - theirs.min()))
    assert np.median(error) < 0.05 * ours.max() and np.corrcoef(ours, theirs)[0, 1] > 0.99


@pytest.mark.slow
def test_eigenvalues_of_lapy(mesh: pf.Mesh) -> None:
    lapy = pytest.importorskip("lapy")
    if mesh.n_vertices > 20_000 or mesh.n_vertices < 50:
        pytest.skip("of another size than is quick")
    V, F = arrays(sound(mesh))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        values, _ = lapy.Solver(lapy.TriaMesh(V, F), lump=False).eigs(8)
    ours = mesh.spectrum(8, "cotangent", "consistent").values
    np.testing.assert_allclose(ours, values, rtol=1e-4, atol=1e-5 * abs(ours).max())


def test_measures_of_trimesh(mesh: pf.Mesh) -> None:
    pytest.importorskip("trimesh")
    theirs, ours = mesh.to_trimesh(), mesh.info()
    assert ours["area"] == pytest.approx(theirs.area, rel=1e-12)
    # They take the faces as they are wound.
    consistent = not ours["inconsistent_edges"]
    if ours["volume"] is not None and consistent:
        assert ours["volume"] == pytest.approx(theirs.volume, rel=1e-6, abs=1e-9 * ours["area"] ** 1.5)
    assert ours["euler_characteristic"] == theirs.euler_number or not ours["manifold"]
    if not ours["degenerate_faces"] and consistent:
        good = np.linalg.norm(theirs.face_normals, axis=1) > 0.5
        np.testing.assert_allclose(mesh.face_normals[good], theirs.face_normals[good], atol=1e-6)


def test_files_of_trimesh_and_meshio(mesh: pf.Mesh, tmp_path) -> None:
    trimesh = pytest.importorskip("trimesh")
    meshio = pytest.importorskip("meshio")
    for extension in ("ply", "obj", "off"):
        path = tmp_path / f"mesh.{extension}"
        # Meshio reads no second list of a face, as texture coordinates are.
        pf.Mesh(mesh.vertices, mesh.faces).write(path, width="double")
        theirs = trimesh.load(path, process=False, maintain_order=True)
        if len(theirs.vertices) == mesh.n_vertices:
            np.testing.assert_allclose(theirs.vertices, mesh.vertices, atol=1e-6 * mesh.diagonal)
        # A file without faces is a point cloud to them.
        assert (len(theirs.faces) if mesh.n_faces else 0) == mesh.n_faces
        if extension != "off" or mesh.n_vertices < 10_000:
            read = meshio.read(path)
            np.testing.assert_allclose(read.points, mesh.vertices, atol=1e-6 * mesh.diagonal)


def linear(colors: np.ndarray) -> np.ndarray:
    """Colours as GLB holds them, from 0 to 1."""
    c = colors / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def test_glb_in_trimesh(mesh: pf.Mesh, tmp_path) -> None:
    trimesh = pytest.importorskip("trimesh")
    if not mesh.n_faces:
        pytest.skip("points have another type there")
    mesh = pf.Mesh(mesh.vertices, mesh.faces)
    fields = {
        "height": mesh.vertices[:, 2],
        "direction": 2 * mesh.vertices,
        "colors": (np.arange(3 * mesh.n_vertices).reshape(-1, 3) % 256).astype(np.uint8),
    }
    path = tmp_path / "mesh.glb"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pf.FairingWarning)
        mesh.with_fields(fields).write(path)
    theirs = trimesh.load(path, process=False, maintain_order=True, force="mesh")
    # The format has 32 bits.
    np.testing.assert_array_equal(theirs.vertices, mesh.vertices.astype(np.float32))
    np.testing.assert_array_equal(theirs.faces, mesh.faces)
    attributes = theirs.vertex_attributes
    np.testing.assert_array_equal(attributes["_height"].ravel(), fields["height"].astype(np.float32))
    np.testing.assert_array_equal(attributes["_direction"], fields["direction"].astype(np.float32))
    # With a material, as in our files, colours are an attribute there, and lost in a joined mesh.
    (part,) = trimesh.load(path, process=False, maintain_order=True).geometry.values()
    colors = np.asarray(part.visual.vertex_attributes["color"])[:, :3]
    assert np.abs(colors - 65535.0 * linear(fields["colors"])).max() <= 1  # 16 bits, normalised
    # And the file that they write, without nodes that move it.
    again = tmp_path / "again.glb"
    theirs.export(again)
    read = loaded(again)
    np.testing.assert_array_equal(read.vertices, theirs.vertices)
    np.testing.assert_array_equal(read.faces, mesh.faces)


def test_glb_in_pygltflib(mesh: pf.Mesh, tmp_path) -> None:
    pygltflib = pytest.importorskip("pygltflib")
    if not mesh.n_faces:
        pytest.skip("without faces there are no indices")
    path = tmp_path / "mesh.glb"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pf.FairingWarning)
        pf.Mesh(mesh.vertices, mesh.faces).write(path)
    theirs = pygltflib.GLTF2().load(path)
    primitive = theirs.meshes[0].primitives[0]
    positions, indices = (theirs.accessors[k] for k in (primitive.attributes.POSITION, primitive.indices))
    assert (positions.count, indices.count) == (mesh.n_vertices, 3 * mesh.n_faces)
    single = mesh.vertices.astype(np.float32)
    np.testing.assert_array_equal(np.float32(positions.min), single.min(axis=0))
    np.testing.assert_array_equal(np.float32(positions.max), single.max(axis=0))
    view = theirs.bufferViews[positions.bufferView]
    assert view.byteOffset % 4 == 0
    data = theirs.binary_blob()[view.byteOffset : view.byteOffset + view.byteLength]
    np.testing.assert_array_equal(np.frombuffer(data, np.float32).reshape(-1, 3), single)


def test_implicit_smoothing_of_scipy(mesh: pf.Mesh) -> None:
    if mesh.n_vertices > 20_000:
        pytest.skip("slow with scipy")
    S, M = sound(mesh).laplacian("cotangent")
    t = mesh.mean_edge_length**2
    theirs = scipy.sparse.linalg.splu((M + t * S).tocsc()).solve(M @ mesh.vertices)
    ours = mesh.smooth("implicit", time=t, iterations=1, tolerance=1e-12).vertices
    np.testing.assert_allclose(ours, theirs, atol=1e-7 * mesh.diagonal)


def test_principal_curvatures_of_libigl() -> None:
    igl = pytest.importorskip("igl")
    mesh = pf.shapes.ellipsoid(3, 2, 1, level=5)
    V, F = arrays(mesh)
    theirs = np.column_stack(igl.principal_curvature(V, F)[2:4])
    exact = np.column_stack(pf.surfaces.Ellipsoid(3, 2, 1).curvature_at(V))
    c = mesh.curvature("quadric")
    ours = np.column_stack([c.kappa1, c.kappa2])
    assert (theirs > 0).all() and (ours > 0).all()
    error = [np.sqrt(np.mean((x - exact) ** 2)) for x in (ours, theirs)]
    assert error[0] < 0.05 and error[0] < 1.5 * error[1]


def test_there_is_a_corpus() -> None:
    assert CORPUS, "data/ holds no meshes"
