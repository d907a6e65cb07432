"""Filters of ParaView and VTK: curvature, smoothing, denoising and geodesic distance.

ParaView loads this file as a plugin (Tools, Manage Plugins, Load New); its Python must find
`pyfairing`. In VTK the classes are algorithms from `vtkPolyData` to `vtkPolyData`. Points, cells and
data stay; the names of results are those of PyVista's accessor, `poly.fairing`.

Each parameter of each method has a setter, `SetTaubinPassBand` for `pass_band` of `taubin`, and is
ignored by the other methods. Parameters without a default, and lists of points such as `SetSources`,
take text, "" for none.

>>> from vtkmodules.vtkFiltersSources import vtkSphereSource
>>> ball, filter = vtkSphereSource(), FairingSmooth()
>>> filter.SetInputConnection(ball.GetOutputPort())
>>> filter.SetMethod("implicit")
>>> filter.SetImplicitLam(2.0)
>>> _ = filter.Update()
>>> filter.GetOutputDataObject(0).GetNumberOfPoints()
50
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any, ClassVar
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt
from pyfairing import FairingError, Mesh, OptionError
from pyfairing._parameters import DENOISER, ESTIMATOR, METHOD, Family
from pyfairing._results import Curvature
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkIdTypeArray, vtkOutputWindow, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

#: The method of a parameter, None for all, and its keyword.
_Key = tuple["str | None", str]


def _choice(names: list[str], default: str, about: str) -> dict[str, Any]:
    return {"kind": "choice", "default": default, "about": about, "choices": [(name, "") for name in names]}


#: The parameters of geodesic distances, in the form of the tables.
_DISTANCE: Mapping[str, Mapping[str, Any]] = {
    "sources": {"kind": "vertices", "default": "0", "about": "Numbers of the points at distance zero"},
    "kind": _choice(["non-negative", "auto", "cotangent", "robust"], "non-negative", "The Laplacian"),
    "time": {"kind": "number", "default": None, "about": "Diffusion time, in squared units of length"},
}


def _value(of: Mapping[str, Any], value: Any, name: str = "") -> Any:
    """A value as `Mesh` takes it; None for an empty text."""
    if value is None or isinstance(value, str) and not value.strip():
        return None
    kind, text = of["kind"], str(value)
    try:
        if kind == "vertices":
            return [int(number) for number in re.sub(r"[\[\](),;]", " ", text).split()]
        return {"number": float, "count": int, "choice": str}[kind](value)
    except ValueError:
        wanted = {"vertices": "numbers of points, such as '3 8'", "count": "a whole number"}
        raise OptionError(f"{name} is {text!r}, but must be {wanted.get(kind, 'a number')}") from None


class _Filter(VTKPythonAlgorithmBase):
    """A filter with properties from the tables of parameters."""

    label: ClassVar[str]
    properties: ClassVar[dict[str, tuple[_Key, Mapping[str, Any]]]]

    def __init_subclass__(cls, label: str, family: Family | None = None) -> None:
        cls.label, cls.properties = label, {}
        if family is None:
            cls.properties = {_camel(name): ((None, name), of) for name, of in _DISTANCE.items()}
        else:
            first = {"estimator": "adaptive", "method": "taubin", "denoiser": "automatic"}[family.what]
            methods = _choice(list(family.algorithms), first, f"The {family.what}")
            cls.properties["Method"] = (None, "method"), methods
            for method, parameters in family.algorithms.items():
                for name, of in parameters.items():
                    if of["kind"] != "weighted":
                        cls.properties[_camel(f"{method}-{name}")] = (method, name), of
        for name, (key, of) in cls.properties.items():
            setattr(cls, f"Set{name}", _setter(name, key, of))

    def __init__(self) -> None:
        VTKPythonAlgorithmBase.__init__(
            self, nInputPorts=1, inputType="vtkPolyData", nOutputPorts=1, outputType="vtkPolyData"
        )
        self._values: dict[_Key, Any] = {}

    def options(self) -> dict[str, Any]:
        """The keywords of the call: those of the method in use that differ from their defaults."""
        values = {key: _value(of, of["default"]) for key, of in self.properties.values()} | self._values
        method = values.get((None, "method"))
        changed = {
            key[1]: values[key]
            for key, of in self.properties.values()
            if key[0] == method and values[key] != _value(of, of["default"])
        }
        own = {name: value for (of, name), value in values.items() if of is None and name != "method"}
        return {**own, **changed, "progress": self._progress}

    @property
    def method(self) -> Any:
        return self._values.get((None, "method"), self.properties["Method"][1]["default"])

    def _progress(self, stage: str, done: int, total: int | None) -> None:
        self.UpdateProgress(done / total if total else 0.0)

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:
        """Computes, as VTK asks for."""
        source, result = vtkPolyData.GetData(inputs[0]), vtkPolyData.GetData(outputs)
        result.ShallowCopy(source)
        try:
            self.compute(mesh_of(source), result)
        except FairingError as error:
            # VTK may lose exceptions, and shows what is there.
            result.Initialize()
            vtkOutputWindow.GetInstance().DisplayErrorText(f"{self.label}: {error}\n")
            return 0
        return 1

    def compute(self, mesh: Mesh, result: Any) -> None:
        """Writes the result for a mesh without data into a copy of the input."""
        raise NotImplementedError

    @classmethod
    def xml(cls) -> str:
        """The properties as ParaView declares them."""
        entry = ElementTree.Element("InputProperty", name="Input", command="SetInputConnection")
        domain = ElementTree.SubElement(
            entry, "DataTypeDomain", name="input_type", composite_data_supported="0"
        )
        ElementTree.SubElement(domain, "DataType", value="vtkPolyData")
        elements = [entry, *(_declared(name, key, of) for name, (key, of) in cls.properties.items())]
        return "\n".join(ElementTree.tostring(element, "unicode") for element in elements)


def _camel(name: str) -> str:
    return "".join(word.capitalize() for word in name.replace("_", "-").split("-"))


def _setter(name: str, key: _Key, of: Mapping[str, Any]) -> Callable[[_Filter, Any], None]:
    def setter(self: _Filter, value: Any) -> None:
        if self._values.get(key) != (given := _value(of, value, name)):
            self._values[key] = given
            self.Modified()

    return setter


def _declared(name: str, key: _Key, of: Mapping[str, Any]) -> ElementTree.Element:
    """A property of ParaView: only visible for its method, text if it has no default."""
    kind = of["kind"] if of["default"] is not None else "text"
    tag = {"number": "DoubleVectorProperty", "count": "IntVectorProperty"}.get(kind, "StringVectorProperty")
    label = key[1].replace("_", " ")
    default = "" if of["default"] is None else str(of["default"])
    element = ElementTree.Element(
        tag, name=name, label=label, command=f"Set{name}", number_of_elements="1", default_values=default
    )
    bounds = {
        edge: str(of[end]) for edge, end in (("min", "low"), ("max", "high")) if of.get(end) is not None
    }
    if kind == "choice":
        domain = ElementTree.SubElement(element, "StringListDomain", name="list")
        for choice, _ in of["choices"]:
            ElementTree.SubElement(domain, "String", value=choice)
    elif tag != "StringVectorProperty" and bounds:
        ElementTree.SubElement(
            element, tag.replace("VectorProperty", "RangeDomain"), {"name": "range", **bounds}
        )
    about = of["about"] + (f", in {of['unit']}" if of.get("unit") else "")
    ElementTree.SubElement(element, "Documentation").text = about
    if key[0] is not None:
        visible = {"type": "GenericDecorator", "mode": "visibility", "property": "Method", "value": key[0]}
        ElementTree.SubElement(ElementTree.SubElement(element, "Hints"), "PropertyWidgetDecorator", visible)
    return element


def mesh_of(poly: Any) -> Mesh:
    """The mesh of a `vtkPolyData` without its data."""

    def flat(cells: vtkCellArray) -> Any:
        array = vtkIdTypeArray()
        cells.ExportLegacyFormat(array)
        return vtk_to_numpy(array)

    points = poly.GetPoints()
    parts = SimpleNamespace(
        points=np.zeros((0, 3)) if points is None else vtk_to_numpy(points.GetData()),
        faces=flat(poly.GetPolys()),
        strips=flat(poly.GetStrips()),
        n_verts=poly.GetNumberOfVerts(),
        n_lines=poly.GetNumberOfLines(),
        point_data={},
        cell_data={},
    )
    return Mesh(parts)


def move(result: Any, mesh: Mesh) -> None:
    """Sets the points of a `vtkPolyData`, and removes normals."""
    points = vtkPoints()
    points.SetData(numpy_to_vtk(mesh.vertices, deep=True))
    result.SetPoints(points)
    for data in (result.GetPointData(), result.GetCellData()):
        data.RemoveArray("Normals")


def curvatures(c: Curvature) -> dict[str, npt.NDArray[Any]]:
    """Curvature by the names of `vtkCurvatures`, and the principal directions."""
    data = {
        "Mean_Curvature": c.mean,
        "Gauss_Curvature": c.gaussian,
        "Maximum_Curvature": c.kappa1,
        "Minimum_Curvature": c.kappa2,
    }
    if c.direction1 is not None and c.direction2 is not None:
        data |= {"Maximum_Direction": c.direction1, "Minimum_Direction": c.direction2}
    return data


def distances(distance: npt.NDArray[Any]) -> dict[str, npt.NDArray[Any]]:
    """Distances by their name, NaN where there is no source."""
    return {"Geodesic_Distance": np.where(np.isinf(distance), np.nan, distance)}


def add(result: Any, data: Mapping[str, npt.NDArray[Any]]) -> None:
    """Adds point data to a `vtkPolyData`, the first of it active."""
    for name, values in data.items():
        array = numpy_to_vtk(values, deep=True)
        array.SetName(name)
        result.GetPointData().AddArray(array)
    result.GetPointData().SetActiveScalars(next(iter(data)))


class FairingCurvature(_Filter, label="Curvature (Fairing)", family=ESTIMATOR):
    """Curvature at each point, by `Mesh.curvature`."""

    def compute(self, mesh: Mesh, result: Any) -> None:
        add(result, curvatures(mesh.curvature(self.method, **self.options())))


class FairingSmooth(_Filter, label="Smooth (Fairing)", family=METHOD):
    """Smooths by a flow or a filter, by `Mesh.smooth`."""

    def compute(self, mesh: Mesh, result: Any) -> None:
        move(result, mesh.smooth(self.method, **self.options()))


class FairingDenoise(_Filter, label="Denoise (Fairing)", family=DENOISER):
    """Removes noise and keeps creases, by `Mesh.denoise`."""

    def compute(self, mesh: Mesh, result: Any) -> None:
        move(result, mesh.denoise(self.method, **self.options()))


class FairingGeodesicDistance(_Filter, label="Geodesic Distance (Fairing)"):
    """The distance to the nearest source along the surface, by `Mesh.geodesic_distance`."""

    def compute(self, mesh: Mesh, result: Any) -> None:
        add(result, distances(mesh.geodesic_distance(**self.options())))


try:
    from paraview.util.vtkAlgorithm import smproperty, smproxy
except ImportError:
    pass
else:
    for _each in (FairingCurvature, FairingSmooth, FairingDenoise, FairingGeodesicDistance):
        # The decorators note the declaration in the class; what they return is a function.
        smproxy.filter(label=_each.label)(smproperty.xml(_each.xml())(_each))
    # A plugin is all classes that the module names, each as often as it does.
    del _each
