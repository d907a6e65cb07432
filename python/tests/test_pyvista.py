"""The accessor of PyVista, and the filters of ParaView on VTK."""

from __future__ import annotations

import inspect
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pyfairing as pf
import pytest

pv = pytest.importorskip("pyvista", "0.48")
HERE = Path(__file__).resolve().parents[1]


@pytest.fixture
def poly() -> Any:
    """A noisy block of quads with data of points and cells, and a part of its own."""
    __import__("pyfairing._accessor")
    block = pv.Box(level=6).clean()
    block.points = block.points + np.random.default_rng(1).normal(0, 0.02, block.points.shape)
    block = block.append_polydata(pv.Plane(center=(5, 0, 0), i_resolution=3, j_resolution=3))
    block.clear_data()
    block.point_data["height"] = np.r_[np.nan, block.points[1:, 2]]
    block.cell_data["name"] = [f"cell {i}" for i in range(block.n_cells)]
    return block.compute_normals(split_vertices=False, consistent_normals=False)


def bare(poly: Any) -> pf.Mesh:
    return pf.Mesh.from_polygons(poly.points, [cell.point_ids for cell in poly.cell])


def test_results_are_poly_data_with_the_names_of_vtk(poly: Any) -> None:
    before = poly.copy()
    c, plain = poly.fairing.curvature("jet2", rings=3), bare(poly).curvature("jet2", rings=3)
    np.testing.assert_array_equal(c["Mean_Curvature"], plain.mean)
    np.testing.assert_array_equal(c["Gauss_Curvature"], plain.gaussian)
    np.testing.assert_array_equal(c["Maximum_Curvature"], plain.kappa1)
    np.testing.assert_array_equal(c["Minimum_Curvature"], plain.kappa2)
    np.testing.assert_array_equal(c["Maximum_Direction"], plain.direction1)
    # PyVista names its own in the same way.
    assert {f"{name}_Curvature" for name in ("Mean", "Gauss", "Maximum", "Minimum")} < set(
        c.point_data.keys()
    )
    assert c.active_scalars_name == "Mean_Curvature"
    d = poly.fairing.geodesic_distance(0)["Geodesic_Distance"]
    expected = bare(poly).geodesic_distance(0)
    assert np.array_equal(np.isnan(d), np.isinf(expected)) and np.isnan(d).sum() == 16
    np.testing.assert_array_equal(d[:-16], expected[:-16])
    s = poly.fairing.spectrum(4, boundary="dirichlet")
    assert s.field_data["Eigenvalues"].shape == (4,) and {f"Mode_{i}" for i in range(4)} < set(
        s.point_data.keys()
    )
    assert {"height", "Normals"} <= set(c.point_data.keys()) and c.cell_data["name"][3] == "cell 3"
    assert poly == before


def test_what_moves_keeps_cells_and_data(poly: Any) -> None:
    mesh = bare(poly)
    for moved, expected in (
        (poly.fairing.smooth("implicit", lam=2.0), mesh.smooth("implicit", lam=2.0)),
        (poly.fairing.denoise("bilateral-normal"), mesh.denoise("bilateral-normal")),
    ):
        np.testing.assert_array_equal(moved.points, expected.vertices)
        np.testing.assert_array_equal(moved.faces, poly.faces)
        assert list(moved.point_data.keys()) == ["height"] and list(moved.cell_data.keys()) == ["name"]
    with pytest.warns(pf.FairingWarning, match="(height|name) is left out"):
        assert list(poly.fairing.mesh.fields) == ["normal"]
    with pytest.raises(pf.OptionError, match="taubin has no option order"):
        poly.fairing.smooth("taubin", order=3)
    assert "lam" in inspect.signature(poly.fairing.smooth).parameters


def test_pyvista_finds_the_accessor_by_its_entry_point(tmp_path: Path) -> None:
    """Without an import of the package, as from an installed wheel."""
    tomllib = pytest.importorskip("tomllib")
    points = tomllib.loads((HERE / "pyproject.toml").read_text("utf-8"))["project"]["entry-points"]
    info = tmp_path / "pyfairing-0.1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: pyfairing\nVersion: 0.1\n")
    lines = [f"[{group}]\n" + "\n".join(f"{k} = {v}" for k, v in of.items()) for group, of in points.items()]
    (info / "entry_points.txt").write_text("\n".join(lines))
    code = f"""import sys
sys.path[:0] = [{str(tmp_path)!r}, {str(Path(pf.__file__).parents[1])!r}]
import pyvista
ball = pyvista.Sphere()
assert "pyfairing" not in sys.modules and "fairing" in dir(ball)
print(round(float(ball.fairing.curvature()["Mean_Curvature"].mean()), 1))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.stdout == "2.0\n", done.stderr
