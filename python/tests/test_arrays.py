"""Arrays of any kind: a mesh, or an exception that says what is wrong."""

from __future__ import annotations

import numpy as np
import pyfairing as pf
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

QUICK = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])

DTYPES = st.one_of(
    hnp.integer_dtypes(), hnp.unsigned_integer_dtypes(), hnp.floating_dtypes(), hnp.boolean_dtypes(),
    hnp.complex_number_dtypes(), hnp.unicode_string_dtypes(),
)  # fmt: skip
SHAPES = hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=6)
ANYTHING = DTYPES.flatmap(lambda dtype: hnp.arrays(dtype, SHAPES))


@QUICK
@given(ANYTHING, ANYTHING)
def test_any_arrays_make_a_mesh_or_an_error(vertices: np.ndarray, faces: np.ndarray) -> None:
    try:
        mesh = pf.Mesh(vertices, faces)
    except (ValueError, TypeError) as error:
        assert str(error)
        return
    assert np.isfinite(mesh.vertices).all()
    assert mesh.n_faces == 0 or mesh.faces.max() < mesh.n_vertices
    assert mesh.n_vertices == 0 or np.array_equal(mesh.vertices, np.asarray(vertices, float).reshape(-1, 3))


@st.composite
def meshes(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    n = draw(st.integers(3, 12))
    # Zero or far from the least extent of a mesh.
    coordinate = st.floats(-1e3, 1e3, width=32).map(lambda x: x if abs(x) > 1e-20 else 0.0)
    vertices = draw(hnp.arrays(np.float64, (n, 3), elements=coordinate))
    corners = st.lists(st.integers(0, n - 1), min_size=3, max_size=3, unique=True)
    faces = np.array(draw(st.lists(corners, min_size=1, max_size=12)))
    return vertices, faces


@QUICK
@given(meshes(), st.sampled_from(["C", "F", "strided", "reversed", "read-only", "f4", "i2", "big-endian"]))
def test_the_layout_of_arrays_does_not_matter(arrays: tuple[np.ndarray, np.ndarray], how: str) -> None:
    vertices, faces = arrays
    plain = pf.Mesh(vertices, faces)
    if how == "F":
        vertices, faces = np.asfortranarray(vertices), np.asfortranarray(faces)
    elif how == "strided":
        vertices, faces = np.repeat(vertices, 2, axis=0)[::2], np.hstack([faces, faces])[:, :3]
    elif how == "reversed":
        vertices, faces = vertices[::-1].copy()[::-1], faces[:, ::-1].copy()[:, ::-1]
    elif how == "read-only":
        vertices.flags.writeable = faces.flags.writeable = False
    elif how == "f4":
        vertices, faces = vertices.astype("f4"), faces.astype("u1")
    elif how == "i2":
        faces = faces.astype("i2")
    else:
        vertices, faces = vertices.astype(">f8"), faces.astype(">i8")
    assert pf.Mesh(vertices, faces) == plain


@QUICK
@given(meshes())
def test_results_on_any_mesh_are_finite_or_errors(arrays: tuple[np.ndarray, np.ndarray]) -> None:
    mesh = pf.Mesh(*arrays)

    def defined(values: np.ndarray, where: np.ndarray) -> np.ndarray:
        """The values; NaN elsewhere becomes 0, and others infinite."""
        missing = np.isnan(values).reshape(len(values), -1).all(axis=1)
        return np.where(missing & ~where, 0.0, np.where(missing == where, np.inf, values.T))

    def curvature(estimator: str, name: str) -> np.ndarray:
        c = mesh.curvature(estimator)
        return defined(getattr(c, name), c.defined)

    calls = [
        lambda: curvature("cotangent", "mean"),
        lambda: curvature("steiner", "gaussian"),
        lambda: curvature("adaptive", "mean"),
        lambda: mesh.laplacian("robust")[0].data,
        lambda: mesh.laplacian()[0].data,
        lambda: mesh.smooth().vertices,
        lambda: mesh.smooth("implicit", lam=1.0, iterations=2).vertices,
        lambda: mesh.denoise().vertices,
        lambda: defined(mesh.face_normals, mesh.face_areas > 0),
        lambda: mesh.geodesic_distance(0)[np.isfinite(mesh.geodesic_distance(0))],
    ]
    import warnings

    for call in calls:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", pf.FairingWarning)
                assert np.isfinite(call()).all()
        except pf.FairingError as error:
            assert str(error)


@QUICK
@given(ANYTHING)
def test_any_field_is_taken_or_refused(array: np.ndarray) -> None:
    mesh = pf.shapes.icosphere(0)
    spectrum = mesh.spectrum(3)
    for call in (
        lambda: mesh.with_fields(x=array),
        lambda: mesh.render(field=array, size=(8, 8)),
        lambda: mesh.heat(array, 0.1),
        lambda: mesh.poisson(array),
        lambda: mesh.geodesic_distance(array),
        lambda: spectrum.project(array),
        lambda: spectrum.expand(array),
        lambda: spectrum.filter(array, lambda w: np.exp(-w)),
        lambda: spectrum.heat_kernel_signature(array),
        lambda: mesh.smooth(pin=array),
        lambda: mesh.with_vertices(array),
    ):
        try:
            call()
        except (ValueError, TypeError) as error:
            assert str(error)


def test_messages_name_element_and_value() -> None:
    v = np.eye(3)
    cases = [
        ((v, [[0, 1, 5]]), "face 0 names vertex 5, but there are 3 vertices"),
        ((v, [[0, 1, 2], [0, 1, -4]]), "face 1 names vertex -4"),
        ((v, np.array([[0, 1, 2**40]])), "face 0 names vertex 1099511627776"),
        ((v, [[0, 1, 1]]), "face 0 repeats a corner: vertices 0, 1, 1"),
        ((np.array([[0, 0, np.nan]] * 3), [[0, 1, 2]]), "vertex 0 has the coordinates"),
        # The extent along an axis on which all are infinite is not a number.
        ((v + [np.inf, 0, 0], [[0, 1, 2]]), "vertex 0 has the coordinates"),
        ((v - np.inf, [[0, 1, 2]]), "vertex 0 has the coordinates"),
        ((v[:, :1], [[0, 1, 2]]), r"shape \(3, 1\)"),
        ((v, [[0, 1, 2, 0]]), "from_polygons"),
    ]
    for arguments, message in cases:
        with pytest.raises(pf.MeshError, match=message):
            pf.Mesh(*arguments)
    with pytest.raises(TypeError, match="faces must be integers"):
        pf.Mesh(v, [[0.0, 1.0, 2.0]])
    with pytest.raises(TypeError, match="real numbers"):
        pf.Mesh(v.astype(complex), [[0, 1, 2]])
    mesh = pf.Mesh(v, [[0, 1, 2]])
    with pytest.raises(pf.MeshError, match="vertex 0 has the coordinates"):
        mesh.with_vertices(v + [0, np.inf, 0])
    with pytest.raises(pf.OptionError, match=r"the field x is nan at 1"):
        mesh.with_fields(x=[0, np.nan, 0])
    with pytest.raises(pf.OptionError, match="sources names vertex 3, but there are 3"):
        mesh.geodesic_distance(3)
    with pytest.raises(pf.OptionError, match=r"temperatures has the shape \(2,\)"):
        mesh.heat([1, 2], 1.0)


def test_empty_and_masks() -> None:
    empty = pf.Mesh([], [])
    assert empty.n_vertices == 0 and empty.vertices.shape == (0, 3) and empty.faces.shape == (0, 3)
    assert empty.smooth().n_vertices == 0 and empty.info()["faces"] == 0
    sphere = pf.shapes.icosphere(2)
    mask = sphere.vertices[:, 2] > 0.9
    np.testing.assert_array_equal(sphere.geodesic_distance(mask), sphere.geodesic_distance(np.flatnonzero(mask)))
