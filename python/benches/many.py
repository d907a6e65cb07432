"""Data sets: overhead for each mesh against a plain loop, and one against two workers.

python many.py [number of meshes]
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import pyfairing as pf


def area(mesh: pf.Mesh) -> dict[str, float]:
    """Next to nothing: what is left is overhead."""
    return {"area": float(mesh.face_areas.sum())}


def clocked(call: object) -> float:
    """Seconds, the better of two."""
    times = []
    for _ in range(2):
        start = time.perf_counter()
        call()  # type: ignore[operator]
        times.append(time.perf_counter() - start)
    return min(times)


def main() -> None:
    """Prints the figures."""
    import distributed

    count = int(sys.argv[1]) if len(sys.argv) > 1 else 2000
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for i in range(count):
            path = Path(folder) / f"{i:05d}.ply"
            pf.shapes.icosphere(3).noise(0.05, seed=i).write(path)
            paths.append(str(path))
        out = f"{folder}/out"
        loop = clocked(lambda: [area(pf.read(p)) for p in paths])
        print(f"plain loop: {1e3 * loop / count:.3f} ms a mesh")
        for workers in (1, 2):
            with (
                distributed.LocalCluster(
                    n_workers=workers, threads_per_worker=1, dashboard_address=None
                ) as cluster,
                distributed.Client(cluster) as client,
            ):
                for name, task in (("area", area), ("shape_dna", pf.tasks.shape_dna)):
                    few = paths if name == "area" else paths[: count // 4]
                    pf.dataset(few[:128], task, out, client=client, resume=False)
                    took = clocked(
                        lambda: pf.dataset(few, task, out, client=client, resume=False)
                    )  # noqa: B023
                    print(f"{workers} workers, {name}: {took:.2f} s, {1e3 * took / len(few):.3f} ms a mesh")


if __name__ == "__main__":
    main()
