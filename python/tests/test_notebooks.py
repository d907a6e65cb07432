"""Notebooks run: those of the package end in a picture, the solutions of the course are right."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "python" / "notebooks").glob("*.ipynb"))
SHEETS = sorted((ROOT / "docs" / "course").glob("*.ipynb"))


def read(path: Path) -> Any:
    """A valid notebook without outputs, of whose cells Jupyter changes no byte."""
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert [cell.id for cell in notebook.cells] == [f"c{i}" for i in range(len(notebook.cells))]
    for cell in notebook.cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None, "committed without outputs"
    assert path.read_text("utf-8") == nbformat.writes(notebook) + "\n", "save it by Jupyter or nbformat"
    return notebook


def run(notebook: Any, folder: Path) -> None:
    nbclient.NotebookClient(notebook, timeout=60, resources={"metadata": {"path": str(folder)}}).execute()


def test_there_are_all() -> None:
    assert len(NOTEBOOKS) == 5 and len(SHEETS) == 7


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_notebook(path: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    notebook = read(path)
    started = time.perf_counter()
    run(notebook, tmp_path)
    assert time.perf_counter() - started < 60
    pictures = [o for o in notebook.cells[-1].outputs if "image/png" in o.get("data", {})]
    assert pictures, "the last cell shows no picture"


@pytest.mark.slow
@pytest.mark.parametrize("path", SHEETS, ids=lambda p: p.stem)
def test_sheet_of_the_course(path: Path, tmp_path: Path) -> None:
    """The empty sheet stops at its first function; its solution is right in every call of the judge."""
    code = "\n".join(cell.source for cell in read(path).cells if cell.cell_type == "code")
    with pytest.raises(NotImplementedError):
        exec(compile(code, path.name, "exec"), {})
    solution = read(path.parent / "solutions" / path.name)
    run(solution, tmp_path)
    printed = "".join(o.get("text", "") for cell in solution.cells for o in cell.get("outputs", []))
    verdicts = [
        line for line in printed.splitlines() if line.startswith(("right", "mistake", "wrong", "no "))
    ]
    assert verdicts and all(line.startswith("right") for line in verdicts), printed
