"""The names and parameters in `_names.py` are those of the library.

Run as a program it writes the file.
"""

from __future__ import annotations

import ast
import inspect
import pickle
import sys
from pathlib import Path

import numpy as np
import pyfairing as pf
import pytest
from pyfairing import _core, _names
from pyfairing._parameters import DENOISER, ESTIMATOR, METHOD, Family

TYPES = {
    "number": "float",
    "count": "int",
    "vertices": "npt.ArrayLike",
    "weighted": "Soft",
}
HEADER = '''"""Names and parameters, for type checkers: written and checked by `tests/test_names.py`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias, TypedDict

import numpy.typing as npt

#: A vertex, its weight, and its target position, by default its own.
Soft: TypeAlias = "Iterable[tuple[int, float] | tuple[int, float, npt.ArrayLike]]"
'''


def literal(name: str, choices: list[str]) -> str:
    line = f"{name} = Literal[" + ", ".join(f'"{choice}"' for choice in choices) + "]"
    if len(line) <= 110:
        return line
    return f"{name} = Literal[" + "".join(f'\n    "{choice}",' for choice in choices) + "\n]"


def static_type(family: Family, name: str) -> str:
    of = family.parameters[name].values()
    names = list(dict.fromkeys(choice for parameter in of for choice, _ in parameter["choices"]))
    if names:
        return "Literal[" + ", ".join(f'"{name}"' for name in names) + "]"
    (kind,) = {parameter["kind"] for parameter in of}
    return TYPES[kind]


def declarations() -> str:
    tables = _core.tables()
    names = {
        "Estimator": list(ESTIMATOR.algorithms),
        "Method": list(METHOD.algorithms),
        "Denoiser": list(DENOISER.algorithms),
        "Kind": tables["laplacians"],
        "MassKind": tables["masses"],
        "ColorMap": tables["color_maps"],
        "NoiseKind": tables["noise_kinds"],
    }
    text = HEADER
    for name, choices in names.items():
        text += f"\n{literal(name, choices)}\n"
    for family in (ESTIMATOR, METHOD, DENOISER):
        title = family.what.capitalize()
        text += f"\n\nclass {title}Parameters(TypedDict, total=False):\n"
        text += f'    """Parameters of {family.what}s."""\n\n'
        for name in family.parameters:
            text += f"    {name}: {static_type(family, name)} | None\n"
    return text


def test_names_are_those_of_the_library() -> None:
    package = Path(_names.__file__)
    command = f"PYTHONPATH={package.parents[1]} {sys.executable} {__file__}"
    assert package.read_text("utf-8") == declarations(), f"write it again by {command}"


def test_the_stub_declares_the_extension() -> None:
    """Classes, functions, properties, and the names of arguments."""

    def declared(node: ast.ClassDef | ast.FunctionDef) -> object:
        if isinstance(node, ast.ClassDef):
            own = [n for n in node.body if isinstance(n, (ast.ClassDef, ast.FunctionDef))]
            return {n.name: declared(n) for n in own if n.name != "__new__"}
        if any(isinstance(d, ast.Name) and d.id == "property" for d in node.decorator_list):
            return "property"
        return [argument.arg for argument in node.args.args]

    def present(thing: object) -> object:
        if inspect.isclass(thing):
            return {n: present(t) for n, t in vars(thing).items() if not n.startswith("__")}
        return "property" if inspect.isdatadescriptor(thing) else list(inspect.signature(thing).parameters)

    stub = ast.parse(Path(_names.__file__).with_name("_core.pyi").read_text("utf-8"))
    expected = {n.name: declared(n) for n in stub.body if isinstance(n, (ast.ClassDef, ast.FunctionDef))}
    assert expected == {n: present(t) for n, t in vars(_core).items() if not n.startswith("__")}


@pytest.mark.parametrize(
    ("family", "function"),
    [(ESTIMATOR, pf.Mesh.curvature), (METHOD, pf.Mesh.smooth), (DENOISER, pf.Mesh.denoise)],
)
def test_signatures_have_every_parameter(family: Family, function: object) -> None:
    signature = inspect.signature(function)  # type: ignore[arg-type]
    assert set(family.parameters) <= set(signature.parameters)
    assert not any(p.kind is p.VAR_KEYWORD for p in signature.parameters.values())
    for name, of in family.parameters.items():
        assert f"\n{name} : " in inspect.getdoc(function)  # type: ignore[operator]
        assert all(f"`{algorithm}`" in inspect.getdoc(function) for algorithm in of)  # type: ignore[operator]


@pytest.mark.parametrize("family", [ESTIMATOR, METHOD, DENOISER])
def test_defaults_change_nothing(family: Family, bumpy: pf.Mesh) -> None:
    """Each default is accepted, one by one, and gives what leaving it out gives."""
    noisy = bumpy.noise(0.1)
    call = {"estimator": noisy.curvature, "method": noisy.smooth, "denoiser": noisy.denoise}[family.what]
    read = {"number": float, "count": int, "choice": str}
    # These parameters require others: cotangent weights, or a cutoff.
    dependent = ("area", "kind", "order", "time") if family is METHOD else ()
    for algorithm, parameters in family.algorithms.items():
        if algorithm == "automatic" or not parameters:
            continue
        needs = {"vertices": range(9)} if algorithm == "region" else {}
        given = {
            name: read[p["kind"]](p["default"])
            for name, p in parameters.items()
            if p["default"] is not None and name not in dependent
        }
        plain, same = call(algorithm, **needs), call(algorithm, **needs, **given)
        one, other = (x.vertices if isinstance(x, pf.Mesh) else x.mean for x in (plain, same))
        np.testing.assert_array_equal(one, other, err_msg=f"{algorithm} {given}")


def test_parameters_reach_the_algorithms(bumpy: pf.Mesh) -> None:
    noisy = bumpy.noise(0.2)
    assert noisy.denoise("bilateral", iterations=1) != noisy.denoise("bilateral", iterations=5)
    assert noisy.denoise("l0", sparsity=5.0) != noisy.denoise("l0")
    assert noisy.denoise(strength=0.5) != noisy.denoise()
    wide = noisy.curvature("jet3", gaussian=0.5)
    assert (wide.mean != noisy.curvature("jet3").mean).any()
    for call, text in [
        (lambda: noisy.denoise("bilateral", iterations=-1), "must not be negative"),
        (lambda: noisy.denoise("bilateral", spatial=-1.0), "spatial is -1"),
        (lambda: noisy.denoise("bilateral", strength=2.0), "bilateral has no option strength"),
        (lambda: noisy.denoise("newest"), "there is no denoiser"),
        (lambda: noisy.curvature("jet3", rings=2, radius=2.0), "rings or radius, not both|radius or rings"),
        (lambda: noisy.curvature("corrected", normals="equal"), "one of area, angle"),
    ]:
        with pytest.raises(pf.OptionError, match=text):
            call()
    with pytest.raises(TypeError, match="there is no option lambda_"):
        noisy.smooth("taubin", lambda_=0.3)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="must be a name"):
        noisy.smooth("implicit", weights=3)  # type: ignore[arg-type]


@pytest.mark.filterwarnings("ignore::pyfairing.FairingWarning")
def test_a_mask_moves_only_what_it_selects(patch: pf.Mesh) -> None:
    where = patch.vertices[:, 0] > 0.5
    kept = patch.vertices[~where]
    for moved in (
        *(
            patch.smooth(method, where=where, **({"vertices": range(60)} if method == "region" else {}))
            for method in pf.METHODS
            # Conformal flow needs a closed mesh.
            if method != "conformal"
        ),
        patch.smooth("low-pass", modes=20, where=np.flatnonzero(where)),
        patch.smooth("taubin", pin=[3], where=where),
        patch.noise(0.1, where=where),
    ):
        np.testing.assert_array_equal(moved.vertices[~where], kept)
    noisy = patch.noise(0.2)
    for denoiser in pf.DENOISERS:
        part = noisy.denoise(denoiser, where=where, pin=[3])
        fixed = ~where
        fixed[3] = True
        np.testing.assert_array_equal(part.vertices[fixed], noisy.vertices[fixed])
        assert (part.vertices[~fixed] != noisy.vertices[~fixed]).any()
        assert noisy.denoise(denoiser, pin=fixed) == part
    # Flows keep the other vertices fixed in every step, like pins.
    held = patch.smooth("implicit", lam=2.0, where=where)
    np.testing.assert_array_equal(held.vertices, patch.smooth("implicit", lam=2.0, pin=~where).vertices)
    with pytest.raises(pf.OptionError, match="where is a mask of shape"):
        patch.smooth(where=[True])
    with pytest.raises(pf.OptionError, match="pin names vertex"):
        noisy.denoise(pin=[10**6])


def test_wave_kernels_have_energies_and_a_deviation(sphere: pf.Mesh) -> None:
    s = sphere.spectrum(20)
    energies, sigma = s.wave_kernel_energies(30)
    assert len(energies) == 30 and sigma == pytest.approx(7 * (energies[1] - energies[0]))
    np.testing.assert_array_equal(s.wave_kernel_signature(30), s.wave_kernel_signature(energies, sigma))
    narrow = s.wave_kernel_signature(energies[:3], sigma=0.1)
    np.testing.assert_allclose(s.mass @ narrow @ np.ones(3) @ np.ones(642), 3)
    for call, text in [
        (lambda: s.wave_kernel_signature(1), "at least 2"),
        (lambda: s.wave_kernel_signature(energies), "sigma"),
        (lambda: s.wave_kernel_signature(energies, -1.0), "sigma is -1"),
    ]:
        with pytest.raises(pf.OptionError, match=text):
            call()


def test_results_have_reprs_and_are_pickled(sphere: pf.Mesh) -> None:
    for thing in (
        sphere,
        sphere.spectrum(5),
        sphere.curvature(),
        sphere.laplacian(),
        sphere.components(),
        sphere.closest([[0, 0, 2.0]]),
        pf.GeodesicSolver(sphere),
        pf.HeatSolver(sphere, 0.1),
        sphere.noise(0.2).noise_level(),
        pf.compare(sphere, sphere),
        pf.surfaces.Torus() if hasattr(pf.surfaces, "Torus") else sphere,
    ):
        text = repr(thing)
        assert " object at " not in text and "array(" not in text and len(text) < 3000, text
        assert repr(pickle.loads(pickle.dumps(thing))) == text


if __name__ == "__main__":
    (Path(__file__).parents[1] / "pyfairing" / "_names.py").write_text(declarations(), "utf-8")
