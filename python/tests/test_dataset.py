"""Many meshes: in this process, and on a cluster of worker processes."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from concurrent.futures import Executor, Future
from pathlib import Path

import numpy as np
import pyfairing as pf
import pytest

pytest.importorskip("dask.dataframe")
pytest.importorskip("pyarrow")
distributed = pytest.importorskip("distributed")

from distributed.scheduler import KilledWorker  # noqa: E402
from pyfairing import _batch, _runs  # noqa: E402

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

    # One retry, so that tests need not wait for three. A local cluster looks for a worker some time after it
    # ended, and would close it for good if it restarts just then.
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
    assert all("a is of type string, but int64" in e for e in table["error"])
    pf.dataset(corpus[:3], area, tmp_path / "out")
    with pytest.raises(ValueError, match="holds another run .*: it has a row for .*00002.off"):
        pf.dataset(corpus[:2], area, tmp_path / "out")
    with pytest.raises(ValueError, match="holds another run .*: its columns or its task"):
        pf.dataset(corpus[:3], pf.tasks.diagnosis, tmp_path / "out")
    check(pf.dataset(corpus[:2], area, tmp_path / "out", resume=False), corpus[:2])
    with pytest.raises(ValueError, match="x as float64 of 3 dimensions"):
        pf.dataset(corpus[:2], lambda mesh: {"x": np.zeros((2, 2, 2))})


def test_only_added_files_are_computed(corpus: list[str], tmp_path) -> None:
    import pandas as pd

    done: list[str] = []

    def noted(mesh: pf.Mesh, path: str) -> dict[str, float]:
        done.append(Path(path).name)
        return area(mesh)

    columns = {"area": "float64"}
    out = tmp_path / "out"
    check(pf.dataset(corpus[2:6], noted, out, columns=columns), corpus[2:6])
    done.clear()
    # Before, between and after the known files.
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
    # Rows that were not written keep their places.
    (first,) = out.glob("part-000000000-*")
    first.unlink()
    found = pf.dataset(list(reversed(added)), noted, out, columns=columns).compute().sort_index()
    assert list(found["path"]) == order and sorted(done) == sorted(Path(p).name for p in corpus[2:6])
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
    assert "x is of type list, but matrix for other meshes" in odd.compute()["error"][0]


def test_batches_are_of_consecutive_files() -> None:
    sizes = [1, 2, None, _runs.BATCH_BYTES, 1] + [1] * 80
    sources = [_batch.Source(row, row, f"{row}.ply", size) for row, size in enumerate(sizes)]
    made = _runs.batches(source for source in sources if source.row != 40)
    rows = [(batch[0].row, batch[-1].row + 1) for batch in made]
    assert rows == [(0, 3), (3, 4), (4, 40), (41, 85)]
    assert [len(batch) for batch in _runs.batches(sources[4:])] == [64, 17]


def test_large_meshes_of_a_process_wait_for_each_other(corpus: list[str], tmp_path, monkeypatch) -> None:
    at_once, most = 0, 0

    def counted(mesh: pf.Mesh) -> dict[str, float]:
        nonlocal at_once, most
        at_once += 1
        most = max(most, at_once)
        time.sleep(0.001)
        at_once -= 1
        return area(mesh)

    # A worker whose threads have no memory of their own.
    monkeypatch.setattr(_batch, "_memory", lambda: (1e9, 0.0))
    check(pf.dataset(corpus[:130], counted, tmp_path / "out", columns={"area": "float64"}), corpus[:130])
    assert most == 1


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


class OneWorker(Executor):
    """A cluster of one worker, which ends with all that is on it when one of its meshes is the poisoned one."""

    def __init__(self, poisoned: str) -> None:
        self.poisoned, self.given, self.lock = poisoned, [], threading.Lock()

    def get_executor(self, pure: bool) -> Executor:
        return self

    def submit(self, run, batch, *rest):
        future: Future = Future()
        self.given.append((future, batch, functools.partial(run, batch, *rest)))
        threading.Timer(0.1, self.work).start()
        return future

    def work(self) -> None:
        with self.lock:
            given, self.given = self.given, []
            ends = any(source.path == self.poisoned for _, batch, _ in given for source in batch)
            for future, _, run in given:
                if ends:
                    future.set_exception(KilledWorker("run", None, 1))
                else:
                    future.set_result(run())


def test_other_meshes_on_the_worker_of_a_poisoned_file_are_computed(corpus: list[str], tmp_path) -> None:
    few = corpus[8:48]
    table = pf.dataset(few, area, tmp_path / "out", client=OneWorker(few[2])).compute()
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
    # The mesh is read, but not computed.
    table = pf.dataset(few, area, tmp_path / "a", client=client, bytes_per_vertex=40_000).compute()
    assert "MemoryError: 40962 vertices" in table["error"][5]
    assert table["error"].notna().sum() == 1
    # The task needs more than it declares: its workers end, and the other meshes are computed.
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
    assert 0 < len(parts) < len(_runs.batches(_runs.listed(corpus)[0]))
    found = pf.dataset(corpus, slow_area, tmp_path / "out")
    check(found, corpus)
    # Written batches are not computed again.
    assert all((tmp_path / "out" / name).stat().st_mtime_ns == at for name, at in parts.items())


def test_parts_that_came_twice_are_dropped(corpus: list[str], tmp_path) -> None:
    few = corpus[:6]
    pf.dataset(few, area, tmp_path / "out")
    (whole,) = (tmp_path / "out").glob("part-*")
    # A worker believed lost has written its batch.
    late = Path(_batch.part_name(str(tmp_path / "out"), 2, 3))
    late.write_bytes(whole.read_bytes())
    check(pf.dataset(few, area, tmp_path / "out"), few)
    assert not late.exists()
