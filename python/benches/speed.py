"""The table of docs/python.md: each call beside the Rust bench and other packages, best of several.

python speed.py MESH.obj [path of bench built with --release] [--without-peers]
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pyfairing as pf

REPEAT = 5


def best(call: Callable[[], object]) -> float:
    """Milliseconds, the best of several after one that warms up."""
    call()
    times = []
    for _ in range(REPEAT):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
        if sum(times) > 20:
            break
    return 1e3 * min(times)


def rust(program: str | None, task: str, path: str, *more: str) -> float | None:
    """Milliseconds of the bench of the workspace."""
    if program is None:
        return None
    command = [program, task, "--in", path, "--repeat", str(REPEAT + 1), "--json", *more]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        return None
    found = json.loads(done.stdout.splitlines()[-1])
    runs = [sum(t for name, t in run.items() if not name.startswith("_")) for run in found["runs"]]
    # The first warms up, as here.
    return 1e3 * min(runs[1:])


def peers(V: np.ndarray, F: np.ndarray, path: str) -> dict[str, dict[str, Callable[[], object]]]:
    """The same computations by other packages."""
    found: dict[str, dict[str, Callable[[], object]]] = {}

    def add(row: str, name: str, call: Callable[[], object]) -> None:
        found.setdefault(row, {})[name] = call

    try:
        import igl

        add(
            "Laplacian",
            "libigl",
            lambda: (igl.cotmatrix(V, F), igl.massmatrix(V, F, igl.MASSMATRIX_TYPE_BARYCENTRIC)),
        )
        add("curvature, quadric", "libigl", lambda: igl.principal_curvature(V, F))
        add("read OBJ", "libigl", lambda: igl.read_triangle_mesh(path))
    except ImportError:
        pass
    try:
        import robust_laplacian

        add("robust Laplacian", "robust_laplacian", lambda: robust_laplacian.mesh_laplacian(V, F))
    except ImportError:
        pass
    try:
        import potpourri3d as pp3d

        add(
            "geodesic distance",
            "potpourri3d",
            lambda: pp3d.MeshHeatMethodDistanceSolver(V, F).compute_distance(0),
        )
    except ImportError:
        pass
    try:
        import trimesh

        mesh = trimesh.Trimesh(V, F, process=False)
        add("read OBJ", "trimesh", lambda: trimesh.load(path, process=False))
        add(
            "Taubin, 10 pairs", "trimesh", lambda: trimesh.smoothing.filter_taubin(mesh.copy(), iterations=20)
        )
    except ImportError:
        pass
    try:
        import lapy

        add("15 eigenpairs", "LaPy", lambda: lapy.Solver(lapy.TriaMesh(V, F), lump=True).eigs(15))
    except ImportError:
        pass
    try:
        import scipy.sparse.linalg as linalg

        S, M = pf.Mesh(V, F).laplacian("cotangent")
        add("15 eigenpairs", "scipy", lambda: linalg.eigsh(S, 15, M, sigma=-0.01))
        t = 5 * pf.Mesh(V, F).mean_edge_length ** 2
        add("implicit, 10 steps", "scipy", lambda: _steps(linalg, S, M, t, V))
    except ImportError:
        pass
    return found


def _steps(linalg: Any, S: Any, M: Any, t: float, V: np.ndarray) -> None:
    factor = linalg.splu((M + t * S).tocsc())
    for _ in range(10):
        V = factor.solve(M @ V)


def main() -> None:
    """Prints the table."""
    arguments = [a for a in sys.argv[1:] if not a.startswith("--")]
    path = arguments[0]
    program = arguments[1] if len(arguments) > 1 else None
    warnings.simplefilter("ignore")
    mesh = pf.read(path)
    V, F = np.array(mesh.vertices), np.array(mesh.faces)
    ours: dict[str, tuple[Callable[[], object], tuple[str, ...]]] = {
        "read OBJ": (lambda: pf.read(path), ("load_obj",)),
        "Mesh(V, F)": (lambda: pf.Mesh(V, F), ()),
        "Laplacian": (lambda: mesh.laplacian("cotangent"), ("laplacian",)),
        "robust Laplacian": (lambda: mesh.laplacian("robust"), ()),
        "curvature, quadric": (lambda: mesh.curvature("quadric"), ("principal", "--estimator", "quadric")),
        "curvature, jet3": (lambda: mesh.curvature("jet3"), ("principal", "--estimator", "jet3")),
        "Taubin, 10 pairs": (lambda: mesh.smooth("taubin"), ("taubin", "--iters", "10")),
        "explicit, 10 steps": (
            lambda: mesh.smooth("explicit", weights="uniform", lam=0.5),
            ("explicit_uniform", "--iters", "10", "--lambda", "0.5"),
        ),
        "implicit, 10 steps": (
            lambda: mesh.smooth("implicit", weights="cotangent", lam=5.0),
            ("implicit_cotan", "--iters", "10", "--lambda", "5"),
        ),
        "15 eigenpairs": (lambda: mesh.spectrum(15, "cotangent"), ("eigs", "--k", "15")),
        "geodesic distance": (lambda: mesh.geodesic_distance(0, "cotangent"), ()),
        "denoise": (lambda: mesh.denoise(), ()),
        "render 800 × 600": (lambda: mesh.render(), ()),
    }
    others = {} if "--without-peers" in sys.argv else peers(V, F, path)
    print("| Call | pyfairing | Rust bench | Other packages |\n|---|--:|--:|---|")
    for row, (call, task) in ours.items():
        # Taken in turn, so that a machine that is busy is busy for both.
        rounds = [(best(call), rust(program, task[0], path, *task[1:]) if task else None) for _ in range(2)]
        time_ours = min(a for a, _ in rounds)
        bench = min((b for _, b in rounds if b is not None), default=None)
        theirs = ", ".join(f"{name} {best(peer):.0f} ms" for name, peer in others.get(row, {}).items())
        print(
            f"| {row} | {time_ours:.1f} ms | {'' if bench is None else f'{bench:.1f} ms'} | {theirs} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
