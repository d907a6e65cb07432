"""The filters of ParaView, on VTK alone."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pyfairing as pf
import pytest
from pyfairing._parameters import DENOISER, ESTIMATOR, METHOD

sources = pytest.importorskip("vtkmodules.vtkFiltersSources")
from pyfairing import paraview_filters as filters  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402

ALL = [
    filters.FairingCurvature,
    filters.FairingSmooth,
    filters.FairingDenoise,
    filters.FairingGeodesicDistance,
]


@pytest.fixture
def ball() -> Any:
    ball = sources.vtkSphereSource()
    ball.SetThetaResolution(24)
    ball.SetPhiResolution(16)
    return ball


def run(algorithm: Any, source: Any) -> Any:
    algorithm.SetInputConnection(source.GetOutputPort())
    algorithm.Update()
    return algorithm.GetOutputDataObject(0)


def mesh_of(poly: Any) -> pf.Mesh:
    faces = [
        [poly.GetCell(i).GetPointId(k) for k in range(poly.GetCell(i).GetNumberOfPoints())]
        for i in range(poly.GetNumberOfCells())
    ]
    return pf.Mesh.from_polygons([poly.GetPoint(i) for i in range(poly.GetNumberOfPoints())], faces)


def points(poly: Any) -> np.ndarray:
    return vtk_to_numpy(poly.GetPoints().GetData())


def data(poly: Any, name: str) -> np.ndarray:
    return vtk_to_numpy(poly.GetPointData().GetArray(name))


def test_filters_return_what_the_mesh_returns(ball: Any) -> None:
    ball.Update()
    mesh = mesh_of(ball.GetOutput())
    curvature = filters.FairingCurvature()
    curvature.SetMethod("jet2")
    curvature.SetJet2Rings(3)
    result, c = run(curvature, ball), mesh.curvature("jet2", rings=3)
    np.testing.assert_array_equal(data(result, "Mean_Curvature"), c.mean)
    np.testing.assert_array_equal(data(result, "Minimum_Direction"), c.direction2)
    assert result.GetPointData().GetScalars().GetName() == "Mean_Curvature"
    assert result.GetPointData().GetArray("Normals") is not None
    smooth = filters.FairingSmooth()
    result = run(smooth, ball)
    np.testing.assert_array_equal(points(result), mesh.smooth("taubin").vertices)
    assert result.GetPointData().GetArray("Normals") is None
    # Another method does not see the options of this one, and a change computes again.
    smooth.SetTaubinMu("-0.6")
    smooth.SetTaubinPin("0 7 9")
    np.testing.assert_array_equal(points(run(smooth, ball)), mesh.smooth(mu=-0.6, pin=[0, 7, 9]).vertices)
    smooth.SetMethod("implicit")
    smooth.SetImplicitTime(0.01)
    smooth.SetImplicitWeights("cotangent")
    expected = mesh.smooth("implicit", time=0.01, weights="cotangent").vertices
    np.testing.assert_array_equal(points(run(smooth, ball)), expected)
    denoise = filters.FairingDenoise()
    denoise.SetMethod("bilateral")
    np.testing.assert_array_equal(points(run(denoise, ball)), mesh.denoise("bilateral").vertices)
    distance = filters.FairingGeodesicDistance()
    distance.SetSources("3 8")
    expected = mesh.geodesic_distance([3, 8])
    np.testing.assert_array_equal(data(run(distance, ball), "Geodesic_Distance"), expected)


def test_polygons_and_parts_without_a_source() -> None:
    cube, plane = sources.vtkCubeSource(), sources.vtkPlaneSource()
    plane.SetXResolution(2)
    append = pytest.importorskip("vtkmodules.vtkFiltersCore").vtkAppendPolyData()
    for source in (plane, cube):
        append.AddInputConnection(source.GetOutputPort())
    result = run(filters.FairingGeodesicDistance(), append)
    distance = data(result, "Geodesic_Distance")
    assert result.GetNumberOfCells() == 8 and np.isnan(distance[6:]).all()
    np.testing.assert_array_equal(distance[:6], mesh_of(result).geodesic_distance(0)[:6])


def test_errors_reach_the_output_window(ball: Any) -> None:
    """ParaView shows it; VTK has no exceptions."""
    seen: list[str] = []

    def note(window: Any, event: str, text: str) -> None:
        seen.append(text)

    note.CallDataType = "string0"  # type: ignore[attr-defined]
    window = filters.vtkOutputWindow.GetInstance()
    observer = window.AddObserver("ErrorEvent", note)
    smooth = filters.FairingSmooth()
    smooth.SetTaubinLam(-1.0)
    # No surface that looks like a result.
    assert run(smooth, ball).GetNumberOfPoints() == 0
    window.RemoveObserver(observer)
    assert any("Smooth (Fairing): " in text and "lambda is -1" in text for text in seen), seen
    smooth.SetTaubinLam(0.5)
    assert run(smooth, ball).GetNumberOfPoints() == ball.GetOutput().GetNumberOfPoints()
    for name, value, words in (
        ("Pin", "many", "numbers of points"), ("Lam", "a", "a number"), ("Iterations", "2.5", "a whole number"),
    ):  # fmt: skip
        with pytest.raises(pf.OptionError, match=f"Taubin{name} is '{value}', but must be {words}"):
            getattr(smooth, f"SetTaubin{name}")(value)
    for value in ("3, 8", [3, 8], (3, 8), np.array([3, 8])):
        smooth.SetTaubinPin(value)
        assert smooth.options()["pin"] == [3, 8]


@pytest.mark.parametrize(("cls", "family"), [*zip(ALL, (ESTIMATOR, METHOD, DENOISER))])
def test_properties_are_those_of_the_tables(cls: Any, family: Any) -> None:
    declared = list(ElementTree.fromstring(f"<all>{cls.xml()}</all>"))
    assert [p.tag for p in declared[:2]] == ["InputProperty", "StringVectorProperty"]
    methods = [choice.get("value") for choice in declared[1].iter("String")]
    assert methods == list(family.algorithms)
    found: dict[str, dict[str, Any]] = {method: {} for method in family.algorithms}
    for element, (key, of) in zip(declared[2:], list(cls.properties.values())[1:], strict=True):
        hint = element.find("Hints/PropertyWidgetDecorator")
        assert (
            hint is not None
            and hint.get("value") == key[0]
            and callable(getattr(cls, element.get("command")))
        )
        assert element.get("default_values") == (of["default"] or "") and element.findtext("Documentation")
        found[key[0]][key[1]] = of
    for method, parameters in family.algorithms.items():
        assert found[method] == {n: of for n, of in parameters.items() if of["kind"] != "weighted"}
    # ParaView sets every property, also those that the user has left alone.
    algorithm = cls()
    for element in declared[1:]:
        getattr(algorithm, element.get("command"))(element.get("default_values"))
    assert list(algorithm.options()) == ["progress"]


def test_paraview_registers_the_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """With decorators of the form that ParaView has: they note what they get, and return functions."""

    def note(name: str, value: Any) -> Any:
        def decorator(cls: Any) -> Any:
            target = getattr(cls, "original", cls)
            target.noted = {**vars(target).get("noted", {}), name: value}
            wrapper = lambda: target()  # noqa: E731
            wrapper.original = target  # type: ignore[attr-defined]
            return wrapper

        return decorator

    module: Any = ModuleType("paraview.util.vtkAlgorithm")
    module.smproxy = SimpleNamespace(filter=lambda label: note("label", label))
    module.smproperty = SimpleNamespace(xml=lambda text: note("xml", text))
    for name in ("paraview", "paraview.util"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    monkeypatch.setitem(sys.modules, module.__name__, module)
    spec = importlib.util.spec_from_file_location("paraview_filters", Path(filters.__file__))
    assert spec is not None and spec.loader is not None
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    noted = [cls.noted for cls in vars(loaded).values() if hasattr(cls, "noted")]
    assert [each["label"] for each in noted] == [cls.label for cls in ALL]
    assert [each["xml"] for each in noted] == [cls.xml() for cls in ALL]
