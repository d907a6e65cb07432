"""Each computation against something known."""

from __future__ import annotations

import pickle

import numpy as np
import pyfairing as pf
import pytest
import scipy.sparse
import scipy.sparse.linalg
from conftest import corpus


def test_laplacian_is_a_pair_of_csr_matrices(sphere: pf.Mesh) -> None:
    n = sphere.n_vertices
    for kind in pf.LAPLACIANS:
        S, M = pair = sphere.laplacian(kind=kind, mass="barycentric")  # type: ignore[arg-type]
        for matrix in pair:
            assert isinstance(matrix, scipy.sparse.csr_matrix) and matrix.shape == (n, n)
            assert matrix.indices.dtype == np.int32
            matrix.check_format(full_check=True)
        assert abs(S - S.T).max() < 1e-12 and abs(S @ np.ones(n)).max() < 1e-12
        assert pair.stiffness is S and pair.mass is M and pair.kind != "auto"
        assert M.sum() == pytest.approx(sphere.info()["area"])
        assert (pickle.loads(pickle.dumps(pair))[0] != S).nnz == 0
    for mass in pf.MASSES:
        assert (sphere.laplacian("cotangent", mass).mass.diagonal() > 0).all()  # type: ignore[arg-type]
    with pytest.raises(pf.OptionError, match="only the barycentric"):
        sphere.laplacian("robust", "consistent")
    with pytest.raises(pf.OptionError, match='there is no Laplacian "cotan"'):
        sphere.laplacian("cotan")  # type: ignore[arg-type]


def test_thin_faces() -> None:
    # The last triangle has next to no height.
    v = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, -1e-13, 0]])
    mesh = pf.Mesh(v, [[0, 1, 2], [1, 0, 3]])
    with pytest.raises(pf.ComputationError, match="face 1 is degenerate: area"):
        mesh.laplacian("cotangent")
    # Every automatic method takes the robust Laplacian, with a warning.
    for robust in (
        lambda: mesh.laplacian("auto").kind == "robust",
        lambda: mesh.laplacian("non-negative").kind == "robust",
        lambda: mesh.spectrum(2).kind == "robust",
        lambda: mesh.curvature("cotangent").too_thin == 1,
        lambda: mesh.curvature("cotangent", kind="auto").too_thin == 1,
        lambda: pf.GeodesicSolver(mesh).kind == "robust",
        lambda: mesh.geodesic_distance(0)[0] == 0,
        lambda: mesh.heat([1, 0, 0, 0], 0.1).sum() < 2,
        lambda: mesh.poisson(np.zeros(4), fixed=[0], values=[1.0])[1] == pytest.approx(1),
        lambda: mesh.smooth("implicit", weights="cotangent").report["too_thin"] == 1,
        lambda: mesh.smooth("explicit", weights="cotangent", lam=1e-4).report["too_thin"] == 1,
        lambda: mesh.smooth("low-pass", time=0.01).report["too_thin"] == 1,
    ):
        with pytest.warns(pf.FairingWarning, match="face 1 is too thin for cotangents.* robust"):
            assert robust()


def obtuse_meshes() -> list[pf.Mesh]:
    """Ordinary meshes with edges that are not Delaunay."""
    sheet = pf.shapes.irregular_plane(0.08)
    x, y, _ = sheet.vertices.T
    meshes = [
        pf.shapes.bumpy_sphere(3, 0.3, 5.0),
        pf.shapes.ellipsoid(3, 2, 0.5, level=3),
        pf.shapes.torus(1, 0.3, 12, 40),
        sheet.with_vertices(np.column_stack([x + 2 * y, y, 0.1 * np.sin(5 * x)])),
        pf.shapes.icosphere(3).noise(0.2),
        pf.shapes.creature(24),
    ]
    return [mesh for mesh in meshes if mesh.laplacian("non-negative").kind == "robust"]


def check_one_rule(mesh: pf.Mesh) -> None:
    S, M = found = mesh.laplacian()
    s = mesh.spectrum(min(20, mesh.n_vertices - mesh.info()["isolated_vertices"]))
    assert found.kind == s.kind
    assert abs(s.mass - M).max() == 0
    # Residuals in the inverse norm of the mass, against the largest eigenvalue asked for.
    used = M.diagonal() > 0
    r = (S @ s.modes - (M @ s.modes) * s.values)[used]
    residuals = np.sqrt((r**2 / M.diagonal()[used, None]).sum(axis=0))
    # The solver's own tolerance, and the rounding of the products here.
    rounding = 1e-13 * (S.diagonal()[used] / M.diagonal()[used]).max()
    assert (residuals <= 2 * s.residuals + 1e-8 * s.values[-1] + rounding).all(), (mesh, residuals)
    if s.kind == "cotangent":
        assert (mesh.laplacian("cotangent").stiffness != S).nnz == 0
        u = np.sin(np.arange(mesh.n_vertices))
        t = mesh.mean_edge_length**2
        np.testing.assert_array_equal(mesh.heat(u, t), mesh.heat(u, t, "cotangent"))
        np.testing.assert_array_equal(mesh.poisson(u), mesh.poisson(u, kind="cotangent"))
        steps = {"weights": "cotangent", "iterations": 2}
        assert mesh.smooth("implicit", **steps) == mesh.smooth("implicit", kind="cotangent", **steps)


def test_auto_is_one_rule() -> None:
    meshes = obtuse_meshes()
    assert len(meshes) >= 4 and all(mesh.laplacian().kind == "cotangent" for mesh in meshes)
    for mesh in meshes:
        check_one_rule(mesh)


@pytest.mark.parametrize("path", corpus(), ids=lambda p: p.stem)
@pytest.mark.filterwarnings("ignore::pyfairing.FairingWarning")
def test_auto_is_one_rule_on_the_corpus(path) -> None:
    mesh = pf.read(path)
    if not 20 < mesh.n_vertices < 20_000 or not mesh.n_faces:
        pytest.skip("of another size than is quick")
    if 2 * mesh.info()["seam_vertices"] > mesh.n_vertices:
        mesh, _ = mesh.weld()
    check_one_rule(mesh)


def test_distances_have_a_rule_of_their_own() -> None:
    for mesh in obtuse_meshes():
        assert pf.GeodesicSolver(mesh).kind == "robust"
        np.testing.assert_array_equal(mesh.geodesic_distance(0), mesh.geodesic_distance(0, "robust"))
        assert pf.GeodesicSolver(mesh, "auto").kind == "cotangent"
    sphere = pf.shapes.icosphere(3)
    assert pf.GeodesicSolver(sphere).kind == "cotangent" == sphere.laplacian("non-negative").kind


def test_gradient_and_divergence(patch: pf.Mesh) -> None:
    G, D = patch.gradient(), patch.divergence()
    S, _ = patch.laplacian("cotangent")
    assert abs(D @ G + S).max() < 1e-12
    x = (G @ patch.vertices[:, 0]).reshape(-1, 3)
    n = patch.face_normals
    np.testing.assert_allclose(x, np.eye(3)[0] - n * n[:, :1], atol=1e-12)


@pytest.mark.parametrize("estimator", pf.ESTIMATORS)
def test_curvature_of_a_sphere(sphere: pf.Mesh, estimator: str) -> None:
    c = sphere.with_vertices(2 * sphere.vertices).curvature(estimator)
    assert c.defined.all() and not c.boundary.any() and len(c) == sphere.n_vertices
    # A coarse sphere; a jet of degree 3 over three rings of it is off by 12 % in K.
    for values, expected in [(c.mean, 0.5), (c.gaussian, 0.25), (c.kappa1, 0.5), (c.kappa2, 0.5)]:
        assert np.median(values) == pytest.approx(expected, rel=0.15)
    assert (c.kappa1 >= c.kappa2).all()
    assert (c.direction1 is None) == (estimator == "cotangent")
    assert c.curvedness == pytest.approx(np.full(len(c), 0.5), rel=0.3)


def test_curvature_options(bumpy: pf.Mesh) -> None:
    wide = bumpy.curvature("normal-cycle", radius=4.0)
    assert not np.array_equal(wide.mean, bumpy.curvature("normal-cycle").mean)
    assert bumpy.curvature("jet2", rings=3).defined.all()
    for bad in ({"radius": -1.0}, {"rings": 0}, {"rings": 2, "radius": 1.0}):
        with pytest.raises(pf.OptionError):
            bumpy.curvature("jet3", **bad)
    with pytest.raises(pf.OptionError, match="steiner has no option rings; those that have it are quadric"):
        bumpy.curvature("steiner", rings=2)
    with pytest.raises(pf.OptionError, match="there is no estimator"):
        bumpy.curvature("jet5")
    robust = bumpy.curvature("cotangent", kind="robust")
    assert robust.mean.shape == (bumpy.n_vertices,)


def test_spectrum_of_a_sphere(sphere: pf.Mesh, tmp_path) -> None:
    s = sphere.spectrum(k=9, kind="robust")
    expected = [0, 2, 2, 2, 6, 6, 6, 6, 6]
    np.testing.assert_allclose(s.values, expected, rtol=0.02, atol=1e-9)
    M = s.mass
    np.testing.assert_allclose(s.modes.T @ (M @ s.modes), np.eye(9), atol=1e-10)
    assert s.certified and (s.residuals < 1e-6).all() and not s.modes.flags.writeable
    assert [len(c) for c in s.clusters()] == [1, 3, 5]
    assert s.split(3) == (1, 4) and s.split(4) is None
    x = sphere.vertices[:, 0]
    c = s.project(x)
    assert c.shape == (9,) and s.project(sphere.vertices).shape == (9, 3)
    np.testing.assert_allclose(s.expand(c), x, atol=1e-2)
    np.testing.assert_allclose(s.project(s.expand(c)), c, atol=1e-10)
    assert s.truncation_errors(sphere.vertices).shape == (10,)
    np.testing.assert_allclose(s.reconstruct(9).vertices, sphere.vertices, atol=1e-2)
    with pytest.warns(pf.FairingWarning, match="k=1 and k=4 do not"):
        s.reconstruct(2)
    filtered = s.filter(x, lambda w: np.exp(-w))
    np.testing.assert_allclose(filtered, np.exp(-2) * x, atol=0.01)
    np.testing.assert_allclose(s.filter(x, np.exp(-s.values), rest=0.0), filtered)
    assert s.heat_kernel_signature([0.1, 1.0]).shape == (642, 2)
    assert s.heat_kernel_signature().shape == (642, 100)
    assert s.wave_kernel_signature(7).shape == (642, 7)
    assert s.global_point_signature().shape == (642, 8)
    np.testing.assert_allclose(s.shape_dna(), s.values * s.area)
    s.save(tmp_path / "modes.npz")
    with np.load(tmp_path / "modes.npz") as arrays:
        np.testing.assert_array_equal(arrays["modes"], s.modes)
    for again in (pf.Spectrum.load(tmp_path / "modes.npz", sphere), pickle.loads(pickle.dumps(s))):
        np.testing.assert_array_equal(again.modes, s.modes)
        assert again.split(3) == s.split(3) and again.reconstruct(9) == s.reconstruct(9)
    with pytest.raises(FileNotFoundError):
        pf.Spectrum.load(tmp_path / "no.npz")
    (tmp_path / "bad.npz").write_bytes(b"no")
    with pytest.raises(pf.MeshError):
        pf.Spectrum.load(tmp_path / "bad.npz")


def test_spectrum_options(patch: pf.Mesh) -> None:
    free, fixed = patch.spectrum(4), patch.spectrum(4, boundary="dirichlet")
    assert free.values[0] == 0 and fixed.values[0] > 1
    assert (fixed.modes[patch.boundary_vertices] == 0).all()
    some = patch.spectrum(4, fixed=[3, 5], mass="consistent")
    assert (some.modes[[3, 5]] == 0).all() and some.mass.nnz > patch.n_vertices
    for bad in ({"k": 0}, {"k": 10**6}, {"k": -1}, {"boundary": "robin"}):
        with pytest.raises(pf.OptionError):
            patch.spectrum(**{"k": 3, **bad})


def test_eigenvalues_are_those_of_scipy(patch: pf.Mesh) -> None:
    S, M = patch.laplacian("cotangent")
    theirs = scipy.sparse.linalg.eigsh(S, 8, M, sigma=-0.01, return_eigenvectors=False)
    np.testing.assert_allclose(patch.spectrum(8, "cotangent").values, np.sort(theirs), atol=1e-8)


def test_heat_geodesics_and_poisson(sphere: pf.Mesh) -> None:
    d = sphere.geodesic_distance([0], kind="robust")
    exact = np.arccos(np.clip(sphere.vertices @ sphere.vertices[0], -1, 1))
    assert d.shape == (642,) and d[0] == 0 and np.abs(d - exact).max() < 0.1
    solver = pf.GeodesicSolver(sphere, "robust")
    np.testing.assert_array_equal(solver.distance(0), d)
    assert solver.kind == "robust"
    # Two components: the other is not reached.
    two = pf.Mesh(
        np.vstack([sphere.vertices, sphere.vertices + 5]), np.vstack([sphere.faces, sphere.faces + 642])
    )
    far = two.geodesic_distance(0)
    assert np.isinf(far[642:]).all() and np.isfinite(far[:642]).all()
    z = sphere.vertices[:, 2]
    np.testing.assert_allclose(sphere.heat(z, 0.5), z / 2, atol=0.01)
    np.testing.assert_allclose(sphere.heat(z, 0.5, steps=2), z / 4, atol=0.01)
    S, M = sphere.laplacian("cotangent")
    theirs = scipy.sparse.linalg.spsolve((M + 0.5 * S).tocsc(), M @ z)
    np.testing.assert_allclose(pf.HeatSolver(sphere, 0.5, "cotangent").step(z), theirs, atol=1e-12)
    np.testing.assert_allclose(sphere.poisson(2 * z), z, atol=0.02)
    u = sphere.poisson(np.zeros(642), fixed=[0, 3], values=[0.0, 1.0])
    assert u[0] == 0 and u[3] == 1 and u.min() > -1e-9 and u.max() < 1 + 1e-9


@pytest.mark.parametrize("method", pf.METHODS)
def test_every_flow(bumpy: pf.Mesh, method: str) -> None:
    options = {"vertices": range(40)} if method == "region" else {}
    smooth = bumpy.smooth(method, **options)
    assert smooth.report["method"] == method and np.array_equal(smooth.faces, bumpy.faces)
    assert not np.array_equal(smooth.vertices, bumpy.vertices)


def test_options_of_flows(bumpy: pf.Mesh, patch: pf.Mesh) -> None:
    pinned = patch.smooth("implicit", boundary="pinned", lam=2.0)
    border = patch.boundary_vertices
    np.testing.assert_array_equal(pinned.vertices[border], patch.vertices[border])
    volume = bumpy.info()["volume"]
    kept = bumpy.smooth("implicit", lam=5.0, volume="rescale")
    assert kept.info()["volume"] == pytest.approx(volume)
    fixed = bumpy.smooth("implicit", pin=[7])
    np.testing.assert_array_equal(fixed.vertices[7], bumpy.vertices[7])
    drawn = bumpy.smooth("implicit", soft=[(7, 1e9, [9.0, 0, 0])])
    np.testing.assert_allclose(drawn.vertices[7], [9, 0, 0], atol=1e-3)
    with pytest.raises(pf.OptionError, match="beyond the stable limit"):
        bumpy.smooth("explicit", lam=2.0)
    with pytest.warns(pf.FairingWarning, match="stable limit"):
        bumpy.smooth("explicit", lam=1.6, unstable="warn")
    for method, options, text in [
        ("taubin", {"cutoff": 1.0}, "the method taubin has no option cutoff"),
        ("implicit", {"lam": 1.0, "time": 1.0}, "lam or time, not both"),
        ("implicit", {"lam": -1.0}, "-1"),
        ("implicit", {"lam": float("nan")}, "NaN"),
        ("implicit", {"weights": "equal"}, 'weights is "equal"'),
        ("region", {}, "vertices"),
        ("laplace", {}, "there is no method"),
        ("implicit", {"pin": [10**6]}, "pin names vertex 1000000"),
        ("implicit", {"iterations": -1}, "must not be negative"),
    ]:
        with pytest.raises(pf.OptionError, match=text):
            bumpy.smooth(method, **options)


def test_the_selection_is_the_region() -> None:
    sphere = pf.shapes.icosphere(3)
    cap = sphere.vertices[:, 2] > 0.7
    flat = sphere.smooth("region", where=cap, order=1)
    assert flat == sphere.smooth("region", vertices=cap, order=1)
    assert (flat.vertices[cap, 2] < 0.75).all()
    both = sphere.smooth("region", where=cap, vertices=np.arange(200), order=1)
    assert both == sphere.smooth("region", vertices=np.flatnonzero(cap[:200]), order=1)


def test_a_flow_that_fails_gives_the_last_good_mesh() -> None:
    # Mean curvature flow of a thin torus pinches.
    ring = pf.shapes.torus(1.0, 0.1, 60, 12)
    with pytest.raises(pf.FlowError) as failed:
        ring.smooth("mean-curvature", time=0.002, iterations=50)
    assert failed.value.iteration > 1
    assert np.isfinite(failed.value.last_good.vertices).all()
    assert failed.value.last_good.info()["faces"] == ring.n_faces


def test_noise_denoise_compare() -> None:
    cube = pf.shapes.cube(12)
    noisy = cube.noise(sigma=0.2, unit="edge", seed=1)
    assert noisy == cube.noise(0.2) and noisy != cube.noise(0.2, seed=2)
    level = noisy.noise_level()
    assert level is not None and level.sigma == pytest.approx(0.2 * cube.mean_edge_length, rel=0.3)
    assert -0.5 < level.correlation < 0.1 and 0.5 < level.low_ratio < 1.5 and not level.impulsive
    assert 1.0 <= level.two_ring_ratio < 1.2
    clean = noisy.denoise()
    assert clean.report["surface"] == "creased"
    assert 0.1 < clean.report["expected_error"] < 5.0
    assert all(
        clean.report[name] == getattr(level, name) for name in ("sigma", "correlation_length", "wide_sigma")
    )
    none = pf.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).denoise().report
    assert none["sigma"] is None and none["correlation_length"] is None and none["wide_sigma"] is None
    before, after = pf.compare(noisy, cube), pf.compare(clean, cube)
    assert after["normal_mean"] < 0.5 * before["normal_mean"]
    assert all(isinstance(value, float) for value in after.values())
    assert after.units["normal_mean"] == "°" and "normal angle" in repr(after)
    other = pf.compare(pf.shapes.icosphere(2), cube)
    assert "normal_mean" in other.missing and "normal_mean" not in other
    kinds = ("normal", "axes", "direction", "uniform", "impulsive", "correlated", "varying", "rays")
    for kind in (*kinds, "depth-camera", "fused"):
        assert cube.noise(0.1, kind=kind) != cube  # type: ignore[arg-type]
    given = cube.noise(0.1, kind="impulsive", fraction=0.25), cube.noise(0.1, kind="fused", length=25)
    assert given == (cube.noise(0.1, kind="impulsive"), cube.noise(0.1, kind="fused"))
    camera = np.array([1.0, 2.0, 9.0])
    moved = cube.noise(0.1, kind="rays", camera=camera).vertices - cube.vertices
    assert np.abs(np.cross(moved, cube.vertices - camera)).max() < 1e-12
    for bad in (
        {"sigma": -1.0},
        {"sigma": float("nan")},
        {"sigma": 1.0, "unit": "inch"},
        {"sigma": 1.0, "seed": -1},
        {"sigma": 1.0, "fraction": 0.5},
        {"sigma": 1.0, "kind": "fused", "length": 0.0},
        {"sigma": 1.0, "kind": "fused", "camera": [0, 0, 9]},
        {"sigma": 1.0, "kind": "rays", "camera": [0, 0]},
    ):
        with pytest.raises(pf.OptionError):
            cube.noise(**bad)


def test_scan() -> None:
    sphere = pf.shapes.icosphere(4)
    truth = sphere.scan([3, 1, 2], size=(80, 60))
    assert truth.report["camera"] == [3.0, 1.0, 2.0]
    radius = np.linalg.norm(truth.vertices, axis=1)
    assert 0.99 < radius.min() and radius.max() < 1 + 1e-12
    noisy = truth.noise(0.67, kind="depth-camera", camera=truth.report["camera"], seed=3)
    moved = np.linalg.norm(noisy.vertices - truth.vertices, axis=1)
    assert np.sqrt((moved**2).mean()) == pytest.approx(0.67 * truth.mean_edge_length, rel=0.02)
    assert sphere.scan() == sphere.scan([0, 0, 3 * sphere.diagonal], [0, 0, 0], threads=1)
    for bad in ({"size": (1, 60)}, {"field_of_view": 180}, {"jump": 0}, {"camera": [1, 2]}):
        with pytest.raises(pf.OptionError):
            sphere.scan(**bad)
    with pytest.raises(pf.ComputationError, match="inside of the mesh"):
        sphere.scan([0.1, 0, 0], field_of_view=60)


@pytest.mark.parametrize("method", pf.DENOISERS)
def test_every_denoiser(method: str) -> None:
    noisy = pf.shapes.cube(6).noise(0.2)
    assert np.isfinite(noisy.denoise(method).vertices).all()


def test_render(bumpy: pf.Mesh) -> None:
    c = bumpy.curvature()
    image = bumpy.render(field=c.mean, size=(64, 48))
    assert image.shape == (48, 64, 4) and image.dtype == np.uint8 and image[0, 0, 3] == 255
    assert bumpy.render(size=(8, 8), transparent=True)[0, 0, 3] == 0
    grey = bumpy.render(size=(64, 48))
    assert not np.array_equal(image, grey)
    named = bumpy.with_fields(c.fields())
    np.testing.assert_array_equal(named.render("mean", size=(64, 48)), image)
    for options in ({"map": "magma"}, {"equalize": True}, {"range": (0, 1)}, {"view": (10, 20)}, {"up": "z"}):
        assert bumpy.render(field=c.mean, size=(16, 16), **options).any()
    for bad in (
        {"map": "jet"},
        {"view": "inside"},
        {"size": (0, 5)},
        {"field": "x"},
        {"size": (10**6, 10**6)},
    ):
        with pytest.raises(pf.FairingError):
            bumpy.render(**{"field": c.mean, **bad})


def test_what_is_undefined_has_no_colour() -> None:
    """Triangles of their own have no curvature: NaN, which is grey, and zero in files."""
    ball = pf.shapes.icosphere(2)
    lone = np.array([[5.0, 0, 0], [6, 0, 0], [5, 1, 0]])
    mesh = pf.Mesh(np.vstack([ball.vertices, lone]), np.vstack([ball.faces, [[162, 163, 164]]]))
    c = mesh.curvature("jet3")
    assert c.defined.sum() == 162
    directions = (c.direction1, c.direction2)
    for values in (c.mean, c.gaussian, c.kappa1, c.kappa2, c.shape_index, c.curvedness, *directions):
        assert np.array_equal(np.isnan(values).reshape(165, -1).any(axis=1), ~c.defined)
    errors = pf.Mesh(np.vstack([ball.vertices, [[9, 9, 9]]]), ball.faces).curvature()
    for values in (errors.mean_error, errors.gaussian_error, errors.scale):
        assert np.array_equal(np.isnan(values), ~errors.defined) and not errors.defined.all()
    shown = mesh.render(field=c.mean, size=(64, 48))
    zero = np.nan_to_num(c.mean)
    np.testing.assert_array_equal(mesh.render(field=zero, defined=c.defined, size=(64, 48)), shown)
    masked = np.ma.array(zero, mask=~c.defined)
    np.testing.assert_array_equal(mesh.render(field=masked, size=(64, 48)), shown)
    np.testing.assert_array_equal(mesh.with_fields(c.fields()).render("mean", size=(64, 48)), shown)
    assert not np.array_equal(mesh.render(field=zero, size=(64, 48)), shown)
    soup = pf.Mesh(lone, [[0, 1, 2]])
    with pytest.warns(pf.FairingWarning, match="undefined at every vertex"):
        c = soup.curvature("jet3")
    with pytest.raises(pf.OptionError, match="undefined everywhere"):
        soup.render(field=c.mean)


def test_surfaces() -> None:
    u, v = np.meshgrid(np.linspace(0.1, 6, 7), np.linspace(0.1, 3, 5))
    for surface, mean, gaussian in [
        (pf.surfaces.Sphere(2), 0.5, 0.25),
        (pf.surfaces.Ellipsoid(2, 2, 2), 0.5, 0.25),
        (pf.surfaces.Cylinder(2), 0.25, 0.0),
        (pf.surfaces.Helicoid(1), 0.0, None),
    ]:
        np.testing.assert_allclose(surface.mean_curvature(u, v), np.full(u.shape, mean), atol=1e-12)
        if gaussian is not None:
            np.testing.assert_allclose(
                surface.gaussian_curvature(u, v), np.full(u.shape, gaussian), atol=1e-12
            )
    for surface in (pf.surfaces.Torus(2, 0.5), pf.surfaces.Ellipsoid(1, 2, 3), pf.surfaces.WavyGraph()):
        E, F, G = np.moveaxis(surface.first_form(u, v), -1, 0)
        L, M, N = np.moveaxis(surface.second_form(u, v), -1, 0)
        np.testing.assert_allclose(
            surface.gaussian_curvature(u, v), (L * N - M * M) / (E * G - F * F), atol=1e-9
        )
        p = surface.principal(u, v)
        np.testing.assert_allclose((p.kappa1 + p.kappa2) / 2, surface.mean_curvature(u, v), atol=1e-9)
        np.testing.assert_allclose(np.einsum("...k,...k", p.direction1, surface.normal(u, v)), 0, atol=1e-12)
        k1, _ = surface.curvature_at(surface.point(u, v).reshape(-1, 3))
        np.testing.assert_allclose(k1, p.kappa1.reshape(-1), atol=1e-9)
    ellipsoid = pf.surfaces.Ellipsoid(1, 2, 3)
    assert ellipsoid.mean_curvature(0, 0).shape == () and repr(ellipsoid) == "Ellipsoid(1, 2, 3)"
    with pytest.raises(pf.ComputationError, match="singular at u = 0"):
        ellipsoid.normal(0, 0)
    for make in (
        lambda: pf.surfaces.Torus(1, 2),
        lambda: pf.surfaces.Sphere(-1),
        lambda: pf.surfaces.Helicoid(0),
    ):
        with pytest.raises(pf.OptionError):
            make()


def test_polygons() -> None:
    # A grid of unit squares in a plane: S is exact on linear functions, and M sums to the area.
    n = 5
    x, y = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)])
    corner = (x[:-1, :-1] * n + y[:-1, :-1]).ravel()
    squares = np.column_stack([corner, corner + n, corner + n + 1, corner + 1])
    S, M = pf.polygon_laplacian(vertices, squares)
    inside = ((x > 0) & (x < n - 1) & (y > 0) & (y < n - 1)).ravel()
    np.testing.assert_allclose((S @ vertices[:, 0])[inside], 0, atol=1e-14)
    np.testing.assert_allclose(vertices[:, 0] @ S @ vertices[:, 0], 16, rtol=1e-14)
    np.testing.assert_allclose(M.sum(), 16, rtol=1e-14)
    assert pf.polygon_laplacian(vertices, squares, "consistent").mass.nnz > n * n
    # On triangles it is the Laplacian of cotangents.
    sphere = pf.shapes.icosphere(2)
    same = pf.polygon_laplacian(sphere.vertices, sphere.faces)
    difference = same.stiffness - sphere.laplacian("cotangent").stiffness
    assert abs(difference).max() < 1e-12 and same.kind == "polygon"
    with pytest.raises(pf.OptionError):
        pf.polygon_laplacian(vertices, squares, "mixed")  # type: ignore[arg-type]
    with pytest.raises(pf.MeshError, match="25"):
        pf.polygon_laplacian(vertices, [[0, 1, 25]])
    with pytest.raises(TypeError):
        pf.polygon_laplacian(vertices, [[0, 1, 2.5]])
