"""Many meshes: in this process, and on a cluster of worker processes."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
import textwrap
import time
import types
from pathlib import Path

import numpy as np
import pyfairing as pf
import pytest

pytest.importorskip("dask.dataframe")
pytest.importorskip("pyarrow")
distributed = pytest.importorskip("distributed")

from distributed.scheduler import KilledWorker  # noqa: E402
from pyfairing import _plan  # noqa: E402

#: Meshes of the corpus of these tests.
COUNT = int(os.environ.get("PYFAIRING_DATASET_MESHES", "2000"))
#: One in this number of files is broken.
BROKEN = 50


@pytest.fixture(scope="session")
def corpus(tmp_path_factory) -> list[str]:
    """Small meshes of many shapes, sizes and formats, some of them broken."""
    folder = tmp_path_factory.mktemp("corpus")
    kinds = [
        pf.shapes.icosphere(1),
        pf.shapes.torus(around=12, across=8),
        pf.shapes.cube(3),
        pf.shapes.irregular_plane(0.15),
        pf.shapes.moebius(0.3, 16, 2),
    ]
    paths = []
    for i in range(COUNT):
        path = folder / f"{i:05d}.{('ply', 'obj', 'off')[i % 3]}"
        if i % BROKEN == 7:
            path.write_text("v 0 0 0\nv 1 0\n")
        else:
            path.write_bytes(kinds[i % len(kinds)].noise(0.05, kind="axes", seed=i).to_bytes(path.suffix[1:]))
        paths.append(str(path))
    return paths


def area(mesh: pf.Mesh) -> dict[str, float]:
    return {"area": float(mesh.face_areas.sum())}


def expected(paths: list[str]) -> list[float | None]:
    return [None if i % BROKEN == 7 else float(pf.read(p).face_areas.sum()) for i, p in enumerate(paths)]


def check(found, paths: list[str]) -> None:
    """Every mesh once, in its place, with its value or its error."""
    table = found.compute().sort_index()
    assert list(table.index) == list(range(len(paths)))
    assert list(table["path"]) == paths
    values = table["area"].to_numpy(dtype=float, na_value=np.nan)
    wanted = np.array([np.nan if a is None else a for a in expected(paths)])
    np.testing.assert_array_equal(values, wanted)
    broken = np.isnan(wanted)
    assert list(table["error"].isna()) == list(~broken)
    assert all("MeshError: " in e for e in table["error"][broken])


@pytest.fixture(scope="module")
def cluster():
    import dask

    # One more try than the first, so that the tests need not wait for three. A local cluster looks for a
    # worker some time after it ended, and closes it for good if it restarts just then: never here.
    settings = {
        "distributed.scheduler.allowed-failures": 1,
        "distributed.deploy.lost-worker-timeout": "1 hour",
    }
    with (
        dask.config.set(settings),
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, memory_limit="900MB", dashboard_address=None
        ) as cluster,
    ):
        yield cluster


@pytest.fixture
def client(cluster):
    with distributed.Client(cluster) as client:
        client.wait_for_workers(2)
        yield client


def test_without_a_cluster(corpus: list[str], tmp_path) -> None:
    few = corpus[:150]
    lazy = pf.dataset(few, area)
    assert lazy.npartitions == 3 and lazy.known_divisions
    check(lazy, few)
    told: list[tuple] = []
    check(pf.dataset(few, area, tmp_path / "out", progress=lambda *step: told.append(step)), few)
    assert told[-1] == ("meshes", 150, 150)
    # Nothing is left to do.
    before = {p.name: p.stat().st_mtime_ns for p in (tmp_path / "out").iterdir()}
    check(pf.dataset(few, area, tmp_path / "out"), few)
    assert {p.name: p.stat().st_mtime_ns for p in (tmp_path / "out").iterdir()} == before


def test_globs_tables_and_addresses(corpus: list[str], tmp_path) -> None:
    import fsspec
    import pandas as pd

    folder = Path(corpus[0]).parent
    ply = [p for p in corpus if p.endswith(".ply")]
    assert list(pf.dataset(f"{folder}/0000*.ply", area).compute()["path"]) == [p for p in ply if "/0000" in p]
    labels = pd.DataFrame({"path": ply[:4], "label": list("abcd")})
    found = pf.dataset(labels, area).compute()
    assert list(found["label"]) == list("abcd") and found["area"].notna().all()
    memory = fsspec.filesystem("memory")
    memory.pipe("/meshes/one.ply", Path(ply[0]).read_bytes())
    memory.pipe("/meshes/two.ply", Path(ply[1]).read_bytes())
    found = pf.dataset("memory://meshes/*.ply", area, "memory://out").compute()
    assert list(found["area"]) == [float(pf.read(p).face_areas.sum()) for p in ply[:2]]
    with pytest.raises(ValueError, match="no column path"):
        pf.dataset(pd.DataFrame({"file": []}), area)
    assert len(pf.dataset([], area).compute()) == 0
    for glob in (f"{folder}/*.nothing", "memory://meshes/*.obj"):
        with pytest.raises(FileNotFoundError, match="no file matches .*(nothing|obj)"):
            pf.dataset(glob, area, tmp_path / "none")
    assert not (tmp_path / "none").exists()
    # A name that only looks like a glob.
    odd = tmp_path / "a[1].ply"
    odd.write_bytes(Path(ply[0]).read_bytes())
    assert list(pf.dataset(str(odd), area).compute()["path"]) == [str(odd)]


def test_tasks_of_the_package(corpus: list[str]) -> None:
    few = corpus[:15]
    for task in (pf.tasks.diagnosis, pf.tasks.curvature, functools.partial(pf.tasks.shape_dna, k=5)):
        table = pf.dataset(few, task).compute()
        assert list(table["error"].isna()) == [i != 7 for i in range(15)], table["error"]
    assert len(table["shape_dna"][0]) == 5


def test_bad_tasks(corpus: list[str], tmp_path) -> None:
    with pytest.raises(ValueError, match="fails on a small sphere"):
        pf.dataset(corpus[:2], lambda mesh: 1 / 0)
    with pytest.raises(ValueError, match="returns row, which"):
        pf.dataset(corpus[:2], lambda mesh: {"row": 1})
    table = pf.dataset(corpus[:3], lambda m: {"a": 1 if m.n_vertices == 162 else "x"}).compute()
    assert all("a is a str, but int64" in e for e in table["error"])
    pf.dataset(corpus[:3], area, tmp_path / "out")
    with pytest.raises(ValueError, match="holds another run: it has a row for .*00002.off"):
        pf.dataset(corpus[:2], area, tmp_path / "out")
    with pytest.raises(ValueError, match="holds another run .other columns or task"):
        pf.dataset(corpus[:3], pf.tasks.diagnosis, tmp_path / "out")
    check(pf.dataset(corpus[:2], area, tmp_path / "out", resume=False), corpus[:2])
    with pytest.raises(ValueError, match="x as float64 of 3 dimensions"):
        pf.dataset(corpus[:2], lambda mesh: {"x": np.zeros((2, 2, 2))})


def test_files_that_are_added_are_done_alone(corpus: list[str], tmp_path) -> None:
    import pandas as pd

    done: list[str] = []

    def noted(mesh: pf.Mesh, path: str) -> dict[str, float]:
        done.append(Path(path).name)
        return area(mesh)

    columns = {"area": "float64"}
    out = tmp_path / "out"
    check(pf.dataset(corpus[2:6], noted, out, columns=columns), corpus[2:6])
    done.clear()
    # Before, between and after those that are there.
    added = [corpus[0], *corpus[2:4], corpus[10], *corpus[4:6], corpus[11]]
    order = [*corpus[2:6], corpus[0], *corpus[10:12]]
    labels = pd.DataFrame({"path": added, "label": [Path(p).stem for p in added]})
    found = pf.dataset(labels, noted, out, columns=columns).compute().sort_index()
    assert list(found["path"]) == order and list(found["label"]) == [Path(p).stem for p in order]
    assert sorted(done) == sorted(Path(p).name for p in (corpus[0], *corpus[10:12]))
    assert list(found["area"]) == expected(order)
    done.clear()
    pf.dataset(list(reversed(added)), noted, out, columns=columns)
    assert done == []
    # A file that has changed is another run.
    changed = tmp_path / "changed.ply"
    pf.shapes.cube(2).write(changed)
    pf.dataset([changed], area, tmp_path / "b")
    pf.shapes.cube(3).write(changed)
    with pytest.raises(ValueError, match="changed.ply has [0-9]+ bytes, and had"):
        pf.dataset([changed], area, tmp_path / "b")


def test_a_task_with_a_path_writes_a_file_for_each_mesh(corpus: list[str], tmp_path) -> None:
    def smoothed(mesh: pf.Mesh, factor: float, path: str) -> dict[str, object]:
        smooth = mesh.smooth("taubin", iterations=2)
        smooth.write(tmp_path / f"{Path(path).stem}.ply")
        return {"area": factor * smooth.area, "path_length": len(path)}

    few = corpus[5:10]
    found = pf.dataset(few, functools.partial(smoothed, factor=2.0), tmp_path / "out").compute()
    assert [Path(p).stem for p, e in zip(few, found["error"].isna(), strict=True) if e] == sorted(
        p.stem for p in tmp_path.glob("*.ply")
    )
    assert found["area"][5 - 5] == 2 * pf.read(tmp_path / f"{Path(few[0]).stem}.ply").area


def test_results_of_two_dimensions_keep_their_shape(corpus: list[str], tmp_path) -> None:
    def corners(mesh: pf.Mesh) -> dict[str, object]:
        return {"box": [mesh.vertices.min(0), mesh.vertices.max(0)], "first": mesh.vertices[0]}

    found = pf.dataset(corpus[:9], corners, tmp_path / "out").compute()
    for row, path in enumerate(corpus[:9]):
        if row == 7:
            assert found["box"].isna()[row]
            continue
        vertices = pf.read(path).vertices
        box = np.stack(found["box"][row])
        np.testing.assert_array_equal(box, [vertices.min(0), vertices.max(0)])
        np.testing.assert_array_equal(found["first"][row], vertices[0])
    odd = pf.dataset(corpus[:1], lambda m: {"x": np.zeros(3) if m.n_vertices != 162 else np.zeros((1, 3))})
    assert "x has 1 dimensions, but 2 for other meshes" in odd.compute()["error"][0]


def test_estimates_come_from_headers(tmp_path) -> None:
    mesh = pf.shapes.icosphere(4)
    for extension in ("ply", "off", "stl", "obj"):
        data = mesh.to_bytes(extension)
        assert 0.4 * 2562 < _plan.estimate(f"a.{extension}", len(data), data[:1024]) < 4 * 2562
    # No count is trusted beyond the bytes.
    lie = b"ply\nformat ascii 1.0\nelement vertex 4000000000\n"
    assert _plan.estimate("a.ply", len(lie), lie) < 100


@pytest.mark.cluster
def test_two_thousand_meshes_on_a_cluster(corpus: list[str], client, tmp_path) -> None:
    check(pf.dataset(corpus, area, tmp_path / "out", client=client), corpus)
    # The collection without a folder runs on the cluster as well.
    check(pf.dataset(corpus[:130], area), corpus[:130])


def slow_area(mesh: pf.Mesh) -> dict[str, float]:
    time.sleep(0.004)
    return area(mesh)


@pytest.mark.cluster
def test_a_killed_worker_loses_nothing(corpus: list[str], client, tmp_path) -> None:
    killed: list[int] = []

    def kill(_stage: str, done: int, total: int | None) -> None:
        # Mid-way, once.
        if not killed and done > COUNT // 4:
            pid = next(iter(client.run(os.getpid).values()))
            killed.append(pid)
            os.kill(pid, signal.SIGKILL)

    check(pf.dataset(corpus, slow_area, tmp_path / "out", client=client, progress=kill), corpus)
    assert killed


def poison(mesh: pf.Mesh) -> dict[str, float]:
    # The 11th file of the corpus, and no other mesh.
    if mesh.n_vertices == 42 and mesh == _POISON:
        os.kill(os.getpid(), signal.SIGKILL)
    return area(mesh)


_POISON = pf.read_bytes(pf.shapes.icosphere(1).noise(0.05, kind="axes", seed=10).to_bytes("obj"), "a.obj")


@pytest.mark.cluster
def test_a_poisoned_file_is_a_row_with_its_error(corpus: list[str], client, tmp_path) -> None:
    few = corpus[:20]
    table = pf.dataset(few, poison, tmp_path / "out", client=client).compute()
    assert list(table.index) == list(range(20))
    assert [i for i in range(20) if table["error"].notna()[i]] == [7, 10]
    assert table["error"][10].startswith("KilledWorker")


class OneWorker:
    """A cluster of one worker, which ends with all that is on it when one of its meshes is the poisoned one.

    At first it has no worker at all.
    """

    def __init__(self, poisoned: str, late: int) -> None:
        self.poisoned, self.late = poisoned, late

    def nthreads(self) -> dict[str, int]:
        return {} if self.late > 0 else {"tcp://here": 1}

    def submit(self, task, batch, *rest, **_):
        run = functools.partial(task, batch, *rest)
        return types.SimpleNamespace(key=object(), batch=batch, run=run, release=lambda: None)

    def wait(self, futures, timeout, return_when):
        if self.late > 0:
            self.late -= 1
            raise distributed.TimeoutError
        if any(s.path == self.poisoned for future in futures for s in future.batch.sources):
            ended, error = futures, KilledWorker("run", None, 1)
        else:
            ended, error = futures[:1], None
            futures[0].run()
        for future in ended:
            future.exception = lambda: error
        return types.SimpleNamespace(done=ended)


def test_what_was_on_the_worker_of_a_poisoned_file_is_done(corpus: list[str], tmp_path, monkeypatch) -> None:
    few = corpus[8:48]
    cluster = OneWorker(few[2], late=15)
    monkeypatch.setattr(distributed, "wait", cluster.wait)
    with pytest.warns(RuntimeWarning, match="no workers for 60 s"):
        table = pf.dataset(few, area, tmp_path / "out", client=cluster).compute()
    assert [i for i in range(40) if table["error"].notna()[i]] == [2]
    assert table["error"][2].startswith("KilledWorker")
    assert list(table.index) == list(range(40))


def hungry(mesh: pf.Mesh) -> dict[str, float]:
    if mesh.n_vertices > 1000:
        memory = np.ones(1200 << 20, dtype=np.uint8)
        time.sleep(20)
        return {"area": float(memory[-1])}
    return area(mesh)


@pytest.mark.cluster
def test_a_file_that_needs_more_memory_than_a_worker_has(corpus: list[str], client, tmp_path) -> None:
    large = tmp_path / "large.ply"
    pf.shapes.icosphere(6).write(large)
    few = [*corpus[:5], str(large), *corpus[8:12]]
    # The estimate says it: the mesh is not tried.
    table = pf.dataset(few, area, tmp_path / "a", client=client, bytes_per_vertex=40_000).compute()
    assert "MemoryError: about 40962 vertices" in table["error"][5]
    assert table["error"].notna().sum() == 1
    # The estimate does not know it: the worker ends again and again, and the others are done.
    table = pf.dataset(few, hungry, tmp_path / "b", client=client).compute()
    assert table["error"][5].startswith("KilledWorker")
    assert table["error"].notna().sum() == 1 and list(table.index) == list(range(10))


@pytest.mark.cluster
def test_an_interrupted_run_goes_on(corpus: list[str], tmp_path) -> None:
    code = f"""
    import sys, time
    sys.path[:0] = {[str(Path(__file__).parent), *sys.path]!r}
    if __name__ == "__main__":
        import distributed, pyfairing as pf, test_dataset
        from pathlib import Path
        paths = Path({str(tmp_path / "paths")!r}).read_text().split()
        with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as c:
            with distributed.Client(c) as client:
                tell = lambda stage, done, total: print(done, flush=True)
                pf.dataset(paths, test_dataset.slow_area, {str(tmp_path / "out")!r}, client=client, progress=tell)
    """
    (tmp_path / "paths").write_text("\n".join(corpus))
    script = tmp_path / "run.py"
    script.write_text(textwrap.dedent(code))
    process = subprocess.Popen(
        [sys.executable, str(script)], stdout=subprocess.PIPE, text=True, start_new_session=True
    )
    assert process.stdout is not None
    for line in process.stdout:
        if int(line) > COUNT // 4:
            break
    # Client, scheduler and workers, all at once.
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    parts = {p.name: p.stat().st_mtime_ns for p in (tmp_path / "out").glob("part-*")}
    assert 0 < len(parts) < len(_plan.batches(_plan.describe(corpus)))
    found = pf.dataset(corpus, slow_area, tmp_path / "out")
    check(found, corpus)
    # What was written is not done again.
    assert all((tmp_path / "out" / name).stat().st_mtime_ns == at for name, at in parts.items())


def test_parts_that_came_twice_are_dropped(corpus: list[str], tmp_path) -> None:
    few = corpus[:6]
    pf.dataset(few, area, tmp_path / "out")
    whole = tmp_path / "out" / _plan.Batch(tuple(_plan.describe(few))).part
    # A worker that was given up, and wrote after all.
    (tmp_path / "out" / "part-000000002-000000003.parquet").write_bytes(whole.read_bytes())
    check(pf.dataset(few, area, tmp_path / "out"), few)
