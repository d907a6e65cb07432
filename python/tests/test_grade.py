"""The judge: inputs, shapes, the command, folders, and functions that are called."""

from __future__ import annotations

import csv
import doctest
import inspect
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyfairing as pf
import pytest
import scipy.io
import scipy.sparse
from pyfairing import grade
from pyfairing.grade.__main__ import main


@pytest.fixture(scope="module")
def mesh(patch: pf.Mesh) -> pf.Mesh:
    return patch


def curvature(mesh: pf.Mesh) -> Any:
    return mesh.curvature("cotangent").mean


def smooth(mesh: pf.Mesh, method: Any, **more: Any) -> Any:
    return mesh.smooth(method, **more).vertices


@pytest.mark.parametrize("shape", ["patch", "sphere", "bumpy", "torus", "plane", "block"])
def test_answers_of_this_package_are_right(shape: str, request: pytest.FixtureRequest) -> None:
    """The formulas of the judge are those of `Mesh`, on open, closed, flat and sharp meshes."""
    made = {
        "torus": pf.shapes.torus(1.0, 0.4, 24, 12),
        "plane": pf.shapes.plane(9, 9),
        "block": pf.shapes.cube(4),
    }
    mesh = made[shape] if shape in made else request.getfixturevalue(shape)
    c = mesh.curvature("cotangent")
    S, M = mesh.laplacian("cotangent")
    k = 9 if shape in ("sphere", "bumpy") else 6
    s = mesh.spectrum(k, "cotangent")
    x = mesh.vertices[:, 0] ** 2
    reports = [
        grade.mean_curvature(mesh, c.mean),
        grade.gaussian_curvature(mesh, c.gaussian),
        grade.principal_curvatures(mesh, np.column_stack([c.kappa1, c.kappa2])),
        *(grade.vertex_normals(mesh, mesh.vertex_normals(w)) for w in ("area", "angle", "sphere")),
        grade.mass(mesh, M),
        grade.mass(mesh, mesh.laplacian("uniform", "consistent").mass),
        grade.laplacian(mesh, S),
        grade.laplacian(mesh, S, M),
        grade.eigenvalues(mesh, s.values),
        grade.modes(mesh, s.modes),
        grade.smoothed(mesh, smooth(mesh, "explicit"), "explicit"),
        grade.smoothed(mesh, smooth(mesh, "implicit"), "implicit"),
        grade.smoothed(
            mesh,
            smooth(mesh, "implicit", weights="cotangent", lam=2.0),
            lam=2.0,
            weights="cotangent",
        ),
        grade.smoothed(mesh, smooth(mesh, "implicit", boundary="pinned"), boundary="pinned"),
        grade.heat(mesh, mesh.heat(x, 0.01, "cotangent"), x, 0.01),
        grade.poisson(mesh, mesh.poisson(x, "cotangent"), x),
    ]
    for report in reports:
        assert report.status == "right", report
        assert str(report).startswith("right"), report


def test_reports_are_a_sentence_and_a_table(mesh: pf.Mesh) -> None:
    report = grade.mean_curvature(mesh, -2 * curvature(mesh))
    assert repr(report) == str(report)
    verdict, empty, *rows = str(report).splitlines()
    assert (
        verdict.startswith("mistake: 2H instead of H (the last ½") and "the other sign" in verdict
    )
    assert empty == "" and any(row.split("  ")[1].startswith("tolerance") for row in rows)
    assert report.status == "mistake" and not report.right and len(report.names) == 2
    assert (
        report.largest is not None
        and report.tolerance is not None
        and report.largest < report.tolerance
    )
    worse = curvature(mesh).copy()
    worse[17] += 1.0
    report = grade.mean_curvature(mesh, worse)
    assert report.vertex == 17 and report.largest == pytest.approx(1.0)
    assert report.verdict.startswith(
        ("wrong at 1 of 405 vertices", "right inside; at the border")
    ), report


def test_inputs_of_all_kinds_are_read(mesh: pf.Mesh, tmp_path: Path) -> None:
    H = curvature(mesh)
    np.save(tmp_path / "H.npy", H[:, None].astype(np.float32))
    np.savez(tmp_path / "one.npz", H=H)
    np.savez(tmp_path / "two.npz", H=H, K=H**2)
    np.savetxt(tmp_path / "H.csv", H, header="mean", comments="")
    np.savetxt(tmp_path / "H.txt", H[None], fmt="%.9g")
    scipy.io.savemat(tmp_path / "H.mat", {"H": H})
    mesh.with_fields(quality=H).write(tmp_path / "H.ply")
    mesh.with_fields(H=H, other=H**2).write(tmp_path / "two.ply")
    np.savetxt(tmp_path / "index.csv", np.column_stack([np.arange(len(H)) + 1, H]), "%.9g", ",")
    (tmp_path / "comma.csv").write_text("".join(f"{h:.9f}\n" for h in H).replace(".", ","))
    for name in (
        "H.npy", "one.npz", "two.npz:H", "two.npz", "H.csv", "H.txt", "H.mat", "H.ply:quality", "H.ply",
        "two.ply", "index.csv", "comma.csv",
    ):  # fmt: skip
        report = grade.mean_curvature(mesh, str(tmp_path / name))
        assert report.status == "right", (name, report)
    assert grade.mean_curvature(mesh, list(H)).right
    mesh.with_fields(normal=mesh.vertex_normals()).write(tmp_path / "n.ply")
    assert grade.vertex_normals(mesh, tmp_path / "n.ply").right
    np.savetxt(tmp_path / "x.txt", np.column_stack([np.arange(len(H)), mesh.smooth("explicit").vertices]))
    assert grade.smoothed(mesh, tmp_path / "x.txt", "explicit").right
    S, M = mesh.laplacian("cotangent")
    scipy.io.mmwrite(tmp_path / "S.mtx", S)
    scipy.sparse.save_npz(tmp_path / "S.npz", S)
    np.save(tmp_path / "S.npy", S.toarray())
    triplets = S.tocoo()
    np.savetxt(
        tmp_path / "S.txt", np.column_stack([triplets.row + 1, triplets.col + 1, triplets.data])
    )
    for name in ("S.mtx", "S.npz", "S.npy", "S.txt"):
        assert grade.laplacian(mesh, tmp_path / name, M).status == "right", name
    smoothed = mesh.smooth("explicit")
    smoothed.write(tmp_path / "out.obj")
    assert grade.smoothed(mesh, tmp_path / "out.obj", "explicit").right
    assert grade.smoothed(mesh, smoothed, "explicit").right
    assert grade.smoothed(mesh, smoothed.vertices.T, "explicit").right


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (lambda m: np.ones(m.n_faces), "one entry per face"),
        (lambda m: np.ones(3 * m.n_faces), "one entry per corner"),
        (lambda m: np.ones(m.n_vertices - 2), "too few by 2"),
        (lambda m: np.ones(m.n_vertices + 1), "too many by 1"),
        (lambda m: np.ones(m.n_vertices - int(m.boundary_vertices.sum())), "the border is missing"),
        (lambda m: np.eye(m.n_vertices), "a matrix"),
        (lambda m: np.ones((m.n_vertices, 2)), "2 numbers per vertex"),
        (lambda m: 3.0, "a single number"),
        (lambda m: np.ones((m.n_faces, 3)), "a vector per face"),
        (lambda m: np.array(["a"] * m.n_vertices), "real numbers"),
        (lambda m: "missing.npy", "missing.npy"),
        (lambda m: "H.docx", "is no .npy"),
    ],
)
def test_shapes_are_named_in_words(
    answer: Callable[[pf.Mesh], Any], words: str, mesh: pf.Mesh
) -> None:
    with pytest.raises((pf.OptionError, OSError), match=words):
        grade.gaussian_curvature(mesh, answer(mesh))


def test_broken_files_are_named(mesh: pf.Mesh, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x\n1\n2\nthree\n")
    (tmp_path / "b.csv").write_text("1 2\n3\n")
    np.savez(tmp_path / "c.npz", a=np.ones(2), b=np.ones(2))
    mesh.write(tmp_path / "mesh.ply")
    for name in ("empty.npy", "empty.npz", "empty.mat", "empty.mtx"):
        (tmp_path / name).write_bytes(b"")
    (tmp_path / "cut.npz").write_bytes((tmp_path / "c.npz").read_bytes()[:50])
    for name, words in (
        ("empty.npy", "empty.npy cannot be read"),
        ("empty.npz", "empty.npz cannot be read"),
        ("empty.mat", "empty.mat cannot be read"),
        ("empty.mtx", "empty.mtx cannot be read"),
        ("cut.npz", "cut.npz cannot be read"),
        ("mesh.ply", "mesh.ply has no field of numbers for H"),
        ("a.csv", "line 4"),
        ("b.csv", "lines of 1 and of 2"),
        ("c.npz", "choose one"),
        ("c.npz:d", "no array d"),
    ):
        with pytest.raises(pf.OptionError, match=words):
            grade.mean_curvature(mesh, str(tmp_path / name))
    with pytest.raises(pf.OptionError, match="at most"):
        grade.eigenvalues(mesh, np.ones(1000))
    with pytest.raises(pf.OptionError, match="one row per face"):
        grade.vertex_normals(mesh, mesh.face_normals)


def test_modes_are_free_in_sign_and_basis(sphere: pf.Mesh) -> None:
    """Three eigenvalues of the sphere coincide: any basis of their space is right."""
    s = sphere.spectrum(9, "cotangent")
    modes = s.modes.copy()
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    modes[:, 1:4] = modes[:, 1:4] @ turn
    modes[:, 5] *= -1
    assert grade.modes(sphere, modes).status == "right"
    modes[:, 2] = modes[:, 1]
    assert "dependent" in grade.modes(sphere, modes).verdict
    report = grade.reconstruction(sphere, s.reconstruct(4).vertices, 4)
    assert report.status == "right", report
    cut = grade.reconstruction(sphere, 1.1 * sphere.vertices, 3)
    assert cut.status == "unexplained" and "take k = 1 or 4" in cut.verdict, cut


def test_forms_of_functions_and_arrays() -> None:
    e = pf.surfaces.Ellipsoid(3, 2, 1)

    def forms(u: Any, v: Any) -> Any:
        return (*np.moveaxis(e.first_form(u, v), -1, 0), *np.moveaxis(e.second_form(u, v), -1, 0))

    def matrices(u: float, v: float) -> Any:
        E, F, G, L, M, N = (float(x) for x in forms(u, v))
        return np.array([[E, F], [F, G]]), np.array([[L, M], [M, N]])

    assert grade.fundamental_forms((3, 2, 1), forms).status == "right"
    assert grade.fundamental_forms(e, matrices).status == "right"
    u = np.linspace(0.1, 1.0, 7)
    table = np.column_stack(forms(u, u))
    assert grade.fundamental_forms(e, table, u, u).status == "right"
    for change, name in (
        ([1, 1, 1, -1, -1, -1], "outward normal"),
        ([1, 2, 1, 1, 2, 1], "2F and 2M"),
    ):
        report = grade.fundamental_forms(e, table * change, u, u)
        assert report.status == "convention" and name in report.verdict
    root = np.sqrt(table[:, 0] * table[:, 2] - table[:, 1] ** 2)[:, None]
    wrong = np.hstack([table[:, :3], table[:, 3:] * root])
    assert "not normalised" in grade.fundamental_forms(e, wrong, u, u).verdict
    with pytest.raises(pf.OptionError, match="need u and v"):
        grade.fundamental_forms(e, table)


def test_denoising_is_scored(sphere: pf.Mesh) -> None:
    noisy = sphere.noise(0.2, seed=3)
    good = grade.denoised(noisy, noisy.denoise(), sphere)
    assert good.status == "right" and "normal error" in str(good)
    for answer, name in (
        (noisy, "nothing was moved"),
        (sphere, "the truth itself"),
        (0.5 * noisy.vertices, "shrunk"),
        (noisy.vertices + 1.0, "shifted"),
        (noisy.vertices[::-1], "another order"),
        (noisy.noise(0.2, seed=4), "both errors rise"),
    ):
        report = grade.denoised(noisy, answer, sphere)
        assert report.status == "mistake" and name in report.verdict, report


def last_face(vertices: Any, faces: Any) -> Any:
    area = np.zeros(len(vertices))
    for a, b, c in faces:
        area[[a, b, c]] = (
            np.linalg.norm(np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a])) / 6
        )
    return area


@pytest.mark.parametrize(
    ("function", "name"),
    [
        (last_face, "order of faces"),
        (lambda v, f: v @ [1.0, 1.0, 1.0], "depends on the axes"),
        (lambda v, f: np.arange(len(v)), "numbers of vertices"),
        (lambda v, f: (f.astype(float) @ [1, 0, 0])[:1], "first corner|order of faces"),
        (
            lambda m: np.where(m.face_areas.mean() < 1e-6, 0, m.curvature("cotangent").mean),
            "depends on the unit",
        ),
        (lambda v, f: 1 / 0 if np.ptp(v) < 0.1 else np.ones(len(v)), "fails if scaled"),
        (lambda v, f: np.random.default_rng().normal(size=len(v)), "from call to call"),
    ],
)
def test_functions_are_called_on_changed_meshes(function: Any, name: str, mesh: pf.Mesh) -> None:
    report = grade.check(function, mesh)
    assert report.status == "mistake" and any(n in report.verdict for n in name.split("|")), report


def test_right_functions_are_right(mesh: pf.Mesh, sphere: pf.Mesh) -> None:
    for m in (mesh, sphere):
        report = grade.check(curvature, m, grade.mean_curvature)
        assert report.status == "right", report
        assert grade.check(lambda m: m.vertex_normals("angle"), m).right
        assert grade.check(lambda m: m.laplacian("cotangent").stiffness, m, grade.laplacian).right
        assert grade.check(lambda m: m.smooth("explicit"), m).right
    doubled = grade.check(lambda m: 2 * curvature(m), mesh, grade.mean_curvature)
    assert doubled.status == "mistake" and "2H instead of H" in doubled.verdict


def test_the_command_judges_a_file(
    mesh: pf.Mesh, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh.write(tmp_path / "patch.ply")
    mesh = pf.read(tmp_path / "patch.ply")
    np.save(tmp_path / "H.npy", curvature(mesh))
    np.save(tmp_path / "bad.npy", -2 * curvature(mesh))
    np.save(tmp_path / "K_short.npy", np.ones(3))
    name = str(tmp_path / "patch.ply")
    assert main(["q3", name, str(tmp_path / "H.npy")]) == 0
    assert capsys.readouterr().out.startswith("right\n")
    assert main(["q3", name, str(tmp_path / "bad.npy")]) == 1
    assert "2H instead of H" in capsys.readouterr().out
    assert main(["q1", name, str(tmp_path / "K_short.npy")]) == 2
    assert "too few" in capsys.readouterr().out
    assert main(["q3", "missing.obj", "H.npy"]) == 2
    done = subprocess.run(
        [sys.executable, "-m", "pyfairing.grade", "q3", name, str(tmp_path / "H.npy")],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0 and done.stdout.startswith("right\n"), done.stderr


def test_twenty_submissions_are_graded_by_one_command(
    mesh: pf.Mesh, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh.write(tmp_path / "patch.ply")
    mesh = pf.read(tmp_path / "patch.ply")
    H, K = curvature(mesh), mesh.curvature("cotangent").gaussian
    answers = [
        H,
        -H,
        2 * H,
        np.abs(H),
        K,
        H[:5],
        np.full_like(H, np.nan),
        np.where(mesh.boundary_vertices, 0, H),
    ]
    for i in range(20):
        folder = tmp_path / "in" / f"student{i:02}"
        folder.mkdir(parents=True)
        np.save(folder / "H.npy", answers[i % len(answers)])
    (tmp_path / "in" / "student03" / "readme.md").write_text("hello")
    (tmp_path / "in" / "student04" / "H.npy").write_bytes(b"")
    (tmp_path / "in" / "student20").mkdir()
    (tmp_path / "in" / "student20" / "report.docx").write_text("2H")
    out = tmp_path / "table.csv"
    assert main(["q3", str(tmp_path / "patch.ply"), str(tmp_path / "in"), "-o", str(out)]) == 0
    assert "20 files" in capsys.readouterr().out
    with out.open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    assert [row["submission"] for row in table] == [f"student{i:02}" for i in range(21)]
    assert [row["status"] for row in table[:8]] == [
        "right", "convention", "mistake", "convention", "unreadable", "unreadable", "mistake", "convention",
    ]  # fmt: skip
    assert table[12]["status"] == "unexplained"
    assert table[20]["status"] == "unreadable" and "no .npy, .npz" in table[20]["verdict"]
    assert "2H instead of H" in table[2]["verdict"] and "too few" in table[5]["verdict"]


def test_questions_of_the_command(
    mesh: pf.Mesh, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh.write(tmp_path / "patch.ply")
    mesh = pf.read(tmp_path / "patch.ply")
    noisy = mesh.noise(0.1, seed=2)
    noisy.write(tmp_path / "noisy.ply")
    e, u = pf.surfaces.Ellipsoid(3, 2, 1), np.linspace(0.2, 1.2, 9)
    np.savetxt(
        tmp_path / "forms.csv", np.column_stack([u, u, e.first_form(u, u), e.second_form(u, u)])
    )
    x, s = mesh.vertices, mesh.spectrum(6, "cotangent")
    half = (
        0.5
        * (mesh.laplacian("uniform", "degree").stiffness @ x)
        / mesh.laplacian("uniform", "degree").mass.diagonal()[:, None]
    )
    np.save(tmp_path / "H.npy", np.linalg.norm(half, axis=1))
    np.save(tmp_path / "K.npy", mesh.curvature("cotangent").gaussian)
    np.save(tmp_path / "four.npy", s.reconstruct().vertices)
    np.save(tmp_path / "five.npy", mesh.smooth("explicit", lam=0.3, iterations=4).vertices)
    np.save(tmp_path / "six.npy", mesh.smooth("implicit", iterations=4).vertices)
    np.save(tmp_path / "seven.npy", noisy.denoise("bilateral-normal").vertices)
    np.save(tmp_path / "modes.npy", s.modes)
    scipy.sparse.save_npz(tmp_path / "S.npz", mesh.laplacian("cotangent").stiffness)
    np.save(tmp_path / "M.npy", mesh.laplacian("cotangent").mass.diagonal())
    for question, file, *options in (
        ["q1", "H.npy"], ["q1", "K.npy"], ["q2", "forms.csv"], ["q4", "four.npy", "--k", "6"],
        ["q5", "five.npy", "--lam", "0.3", "--iterations", "4"], ["q6", "six.npy", "--iterations", "4"],
        ["q7", "seven.npy", "--truth", str(tmp_path / "patch.ply")], ["modes", "modes.npy"],
        ["laplacian", "S.npz", "--mass", str(tmp_path / "M.npy")],
    ):  # fmt: skip
        which = "noisy.ply" if question == "q7" else "patch.ply"
        status = main([question, str(tmp_path / which), str(tmp_path / file), *options])
        assert status == 0, (question, file, capsys.readouterr().out)


@pytest.mark.parametrize("name", [n for n in grade.__all__ if n[0].islower()])
def test_functions_are_documented(name: str) -> None:
    text = inspect.getdoc(getattr(grade, name)) or ""
    assert "Parameters\n----------\n" in text
    for parameter in inspect.signature(getattr(grade, name)).parameters:
        assert re.search(rf"^(\w+, )*{parameter}(, \w+)* :", text, re.M), (name, parameter)


def test_examples_of_docstrings() -> None:
    for module in (grade, grade._invariance):
        assert doctest.testmod(module).failed == 0
