"""Docstrings, examples, types."""

from __future__ import annotations

import ast
import doctest
import graphlib
import importlib.util
import inspect
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyfairing as pf
import pytest

HERE = Path(__file__).resolve().parents[1]
MODULES = [m.name for m in pkgutil.iter_modules(pf.__path__) if m.name != "_core"]


@pytest.mark.parametrize("name", ["", *MODULES])
def test_examples_of_docstrings(name: str) -> None:
    # Data sets need dask.
    module = pytest.importorskip(f"pyfairing.{name}".rstrip("."))
    assert doctest.testmod(module).failed == 0


def test_modules_import_in_one_direction() -> None:
    imports: dict[str, set[str]] = {}
    for path in Path(pf.__file__).parent.glob("*.py"):
        tree = ast.parse(path.read_text("utf-8"))
        # Imports for type checkers alone may go in circles.
        tree.body = [node for node in tree.body if not isinstance(node, ast.If)]
        local = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.level == 1]
        names = [[node.module] if node.module else [alias.name for alias in node.names] for node in local]
        imports[path.stem] = {name for each in names for name in each}
    graphlib.TopologicalSorter(imports).prepare()


def public() -> list[tuple[str, object]]:
    found = [(name, getattr(pf, name)) for name in pf.__all__]
    for module in (pf.shapes, pf.surfaces, pf.tasks):
        found += [(f"{module.__name__}.{n}", getattr(module, n)) for n in module.__all__ if n != "Task"]
    solvers = (pf.CholeskyFactor, pf.GeodesicSolver, pf.HeatSolver)
    for cls in (pf.Mesh, pf.Spectrum, *solvers, pf.Curvature, pf.surfaces.Surface):
        found += [(f"{cls.__name__}.{n}", m) for n, m in inspect.getmembers(cls) if not n.startswith("_")]
    return [(n, o) for n, o in found if callable(o) or inspect.ismodule(o) or isinstance(o, property)]


@pytest.mark.parametrize(("name", "thing"), public())
def test_everything_public_is_documented(name: str, thing: object) -> None:
    text = inspect.getdoc(thing) or ""
    assert len(text) > 15, f"{name} has no docstring"
    assert not re.search(
        r"\{[a-z]+\}", re.sub(r"\{'.*?\}", "", text)
    ), f"{name} has a table that is not filled in"
    if not inspect.isfunction(thing) or "Parameters\n---" not in text:
        return
    section = text.split("Parameters\n----------\n")[1].split("\n\nReturns")[0].split("\n\nRaises")[0]
    documented = {
        n.strip(" *")
        for line in re.findall(r"^(\S[^:]*) :|^(\*\*\w+) :", section, re.M)
        for n in line[0].split(",")
        if n
    }
    arguments = {p for p in inspect.signature(thing).parameters if p not in ("self", "cls", "more")}
    assert arguments <= documented, f"{name} does not say what {arguments - documented} is"


def test_docstrings_have_the_tables_of_the_program() -> None:
    for names, method in (
        (pf.ESTIMATORS, pf.Mesh.curvature),
        (pf.METHODS, pf.Mesh.smooth),
        (pf.DENOISERS, pf.Mesh.denoise),
    ):
        assert all(f"`{name}`:" in (method.__doc__ or "") for name in names)


PAGES = [HERE / "README.md", HERE.parent / "docs" / "python.md"]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_first_program_of_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = page.read_text("utf-8").split("```python\n")[1].split("```")[0]
    shutil.copytree(HERE.parent / "data", tmp_path / "data")
    monkeypatch.chdir(tmp_path)
    exec(code, {})
    assert (tmp_path / "out.ply").exists()


def test_session_of_the_readme_prints_what_it_shows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(HERE.parent / "data", tmp_path / "data")
    monkeypatch.chdir(tmp_path)
    code = (HERE.parent / "README.md").read_text("utf-8").split("```python\n")[1].split("```")[0]
    session = doctest.DocTestParser().get_doctest(code, {}, "README", None, None)
    assert doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(session) == (0, 5)


GUIDE = sorted((HERE.parent / "docs" / "guide" / "src").glob("*.md"))


@pytest.mark.parametrize("page", GUIDE, ids=lambda p: p.stem)
def test_programs_of_the_guide_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copytree(HERE.parent / "data", tmp_path / "data")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    missing = set()
    for code in re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), re.M | re.S):
        imported = re.findall(r"^(?:import|from) (\w+)", code, re.M)
        absent = {module for module in imported if importlib.util.find_spec(module) is None}
        if "pyvista" in imported and not absent:
            # An installed package needs no import: `test_pyvista_finds_the_accessor_by_its_entry_point`.
            importlib.import_module("pyfairing._accessor")
        if not absent:
            exec(code, names)
        missing |= absent
    for drawn in tmp_path.glob("*.png"):
        compare_pictures(page.parent / "pictures" / drawn.name, drawn)
    if missing:
        pytest.skip(f"without {', '.join(sorted(missing))}")


def compare_pictures(committed: Path, drawn: Path) -> None:
    """A missing picture is drawn; elsewhere other drivers may draw edges slightly differently."""
    image = pytest.importorskip("PIL.Image")
    if not committed.exists():
        shutil.copy(drawn, committed)
        pytest.fail(f"{committed.name} was missing; look at it and commit it")
    before, after = (np.asarray(image.open(path).convert("RGB"), dtype=float) for path in (committed, drawn))
    assert before.shape == after.shape and np.abs(before - after).mean() < 4, f"{drawn.name} looks different"


def test_kind_and_mass_are_in_one_order() -> None:
    functions = [(name, thing) for name, thing in public() if inspect.isfunction(thing)]
    functions.append(("HeatSolver", pf.HeatSolver.__init__))
    for name, function in functions:
        parameters = inspect.signature(function).parameters
        order = [p for p in parameters if p in ("kind", "mass")]
        if len(order) == 2:
            kinds = [parameters[p].kind for p in order]
            assert order == ["kind", "mass"], name
            assert kinds == [inspect.Parameter.POSITIONAL_OR_KEYWORD] * 2, name


def test_the_tour_runs() -> None:
    done = subprocess.run([sys.executable, HERE / "examples" / "tour.py"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "names vertex 1" in done.stdout


def test_the_program_that_the_laboratory_copies_runs(tmp_path: Path) -> None:
    pf.shapes.cylinder(0.5, 2.0, 24, 20, ends="open").write(tmp_path / "pipe.ply")
    subprocess.run([sys.executable, HERE / "examples" / "laboratory.py"], cwd=tmp_path, check=True)
    result, first = (pf.read(tmp_path / f"pipe-{name}.ply") for name in ("fairing", "0"))
    assert result.volume is not None and first.volume is None
    assert {"mean", "direction1", "distance", "mode"} <= set(result.fields) & set(first.fields)
    assert result.fields["distance"][0] == 0.0 and result.fields["mode"].std() > 0.1


def test_metadata_is_complete() -> None:
    metadata = importlib.import_module("importlib.metadata")
    try:
        found = metadata.metadata("pyfairing")
    except metadata.PackageNotFoundError:
        pytest.skip("the package is not installed")
    assert found["Version"] == pf.__version__ and found["License-Expression"] == "MIT OR Apache-2.0"
    assert found["Requires-Python"] == ">=3.10" and "Laplacian" in found["Summary"]
    required = [r for r in metadata.requires("pyfairing") if "extra ==" not in r]
    assert required == ["numpy>=1.24"]
    (accessor,) = (p for p in metadata.entry_points(group="pyvista.accessors") if p.name == "fairing")
    assert accessor.value == "pyfairing._accessor"


@pytest.mark.slow
@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_types(checker: str, tmp_path) -> None:
    pytest.importorskip(checker)
    tour = tmp_path / "tour.py"
    tour.write_text((HERE / "examples" / "tour.py").read_text())
    arguments = (
        ["--strict", "--ignore-missing-imports", "--cache-dir", str(tmp_path)] if checker == "mypy" else []
    )
    if checker == "pyright":
        arguments = ["--pythonpath", sys.executable]
    command = [sys.executable, "-m", checker, *arguments, str(tour)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    offline = checker == "pyright" and ("nodeenv" in done.stderr or "ENOTFOUND" in done.stderr)
    if offline:
        pytest.skip("pyright cannot fetch its node")
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_type_checkers_see_typos(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    right = ["smooth('taubin', lam=0.3)", "denoise('l0', sparsity=9.0)", "curvature('jet2', rings=3)"]
    wrong = ["smooth('taubn')", "denoise('l0', sparsty=9.0)", "curvature('jet2', rings='3')"]
    calls = [f"mesh.{call}" for call in right + wrong]
    source = tmp_path / "typos.py"
    source.write_text("\n".join(["import pyfairing as pf", "mesh = pf.shapes.icosphere(2)", *calls]))
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path), str(source)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    lines = {int(n) for n in re.findall(r"typos\.py:(\d+): error", done.stdout)}
    assert lines == {6, 7, 8}, done.stdout + done.stderr
