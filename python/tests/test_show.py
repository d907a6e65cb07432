"""Interactive pages: the numbers that they hold, and where they are opened."""

from __future__ import annotations

import base64
import json
import re
import sys
import time
import webbrowser
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pyfairing as pf
import pytest


class Page(HTMLParser):
    """The blocks of a page, by mesh, class and name; fails on an element that is not closed."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[tuple[str, dict[str, str | None]]] = []
        self.meshes: list[dict[tuple[str, str], bytes]] = []
        self.titles: list[str | None] = []
        self.body: dict[str, str | None] = {}
        self.frames: list[str] = []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag not in ("meta", "link", "input"):
            self.open.append((tag, given))
        if tag == "body":
            self.body = given
        if tag == "iframe":
            self.frames.append(given["srcdoc"] or "")
        if given.get("class") == "mesh":
            self.meshes.append({})
            self.titles.append(given["data-title"])

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop()[0] == tag

    def handle_data(self, data: str) -> None:
        if not self.open:
            return
        tag, given = self.open[-1]
        kind = given.get("class")
        if tag == "script" and kind in ("positions", "faces", "field"):
            self.meshes[-1][kind, given["data-name"] or ""] = base64.b64decode(data)


def values(page: Page, mesh: int, name: str) -> np.ndarray:
    return np.frombuffer(page.meshes[mesh]["field", name], "<f8")


def saved(path: Path, *meshes: pf.Mesh, **options: object) -> Page:
    view = meshes[0].show(*meshes[1:], path=path / "view.html", **options)
    assert (path / "view.html").read_text(encoding="utf-8") == view.html
    return Page(view.html)


def test_a_page_holds_the_mesh(tmp_path: Path, bumpy: pf.Mesh) -> None:
    far = bumpy.with_vertices(bumpy.vertices + [1e6, 0, 0]).with_fields(height=bumpy.vertices[:, 1])
    page = saved(tmp_path, far, titles=['a <b> & "c"'])
    assert page.titles == ['a <b> & "c"']
    blocks = page.meshes[0]
    low, high = far.vertices.min(axis=0), far.vertices.max(axis=0)
    center = [float(x) for x in (page.body["data-center"] or "").split()]
    np.testing.assert_array_equal(center, 0.5 * (low + high))
    positions = np.frombuffer(blocks["positions", ""], "<f4").reshape(-1, 3)
    np.testing.assert_array_equal(positions, (far.vertices - center).astype(np.float32))
    faces = np.frombuffer(blocks["faces", ""], "<u4").reshape(-1, 3)
    np.testing.assert_array_equal(faces, far.faces)
    np.testing.assert_array_equal(values(page, 0, "height"), bumpy.vertices[:, 1])
    assert "data-field" not in page.body
    assert "https://" not in "".join(map(str, page.body))


def test_fields_of_several_meshes(tmp_path: Path, patch: pf.Mesh) -> None:
    c = patch.curvature("jet3", kind=None)
    named = patch.with_fields(c.fields())
    hidden = ~c.defined
    assert np.array_equal(np.isnan(c.mean), hidden)
    page = saved(tmp_path, patch, patch, field=c.mean)
    assert page.body["data-field"] == "field" and page.titles == ["mesh 1", "mesh 2"]
    for mesh in (0, 1):
        shown = values(page, mesh, "field")
        np.testing.assert_array_equal(np.isnan(shown), hidden)
        np.testing.assert_array_equal(shown[~hidden], c.mean[~hidden])
    # By name, with undefined values; a mesh without the field has no colours.
    page = saved(tmp_path, patch, named, field="mean")
    assert page.body["data-field"] == "mean" and ("field", "mean") not in page.meshes[0]
    np.testing.assert_array_equal(np.isnan(values(page, 1, "mean")), hidden)
    # One for each mesh; vectors by their length.
    page = saved(tmp_path, patch, patch, field=[patch.vertex_normals(), None])
    np.testing.assert_allclose(values(page, 0, "field"), 1.0)
    assert ("field", "field") not in page.meshes[1]


def test_what_is_refused(tmp_path: Path, sphere: pf.Mesh) -> None:
    n = sphere.n_vertices
    infinite = np.where(np.arange(n) == 7, np.inf, 1.0)
    with pytest.raises(pf.OptionError, match="value 7 is inf, which is not finite"):
        saved(tmp_path, sphere, field=infinite)
    with pytest.raises(pf.OptionError, match="there is no field height; the meshes have none"):
        saved(tmp_path, sphere, field="height")
    with pytest.raises(pf.OptionError, match=r"shape \(3,\)"):
        saved(tmp_path, sphere, field=[1.0, 2.0, 3.0])
    with pytest.raises(pf.OptionError, match="field has 1 arrays, but there are 2 meshes"):
        saved(tmp_path, sphere, sphere, field=[np.ones(n)])
    with pytest.raises(pf.OptionError, match="there are 2 meshes"):
        saved(tmp_path, sphere, sphere, titles=["one"])
    with pytest.raises(pf.ComputationError, match="no face"):
        saved(tmp_path, pf.Mesh(sphere.vertices, np.zeros((0, 3), int)))
    with pytest.raises(pf.OptionError, match="up"):
        saved(tmp_path, sphere, up="x")
    with pytest.raises(TypeError, match="show takes meshes, not int"):
        sphere.show(3)  # type: ignore[arg-type]
    assert not (tmp_path / "view.html").exists()


def test_a_script_opens_the_browser(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, sphere: pf.Mesh) -> None:
    opened: list[str] = []
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(webbrowser, "open", lambda url: opened.append(url) or True)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    view = sphere.show()
    (file,) = tmp_path.iterdir()
    assert opened == [file.as_uri()] and file.suffix == ".html"
    assert file.read_text(encoding="utf-8") == view.html
    monkeypatch.setattr(webbrowser, "open", lambda url: False)
    with pytest.warns(pf.FairingWarning, match="there is no browser to open; the page is .*html"):
        sphere.show()


def test_a_notebook_shows_a_frame(monkeypatch: pytest.MonkeyPatch, sphere: pf.Mesh) -> None:
    def fail(url: str) -> bool:
        raise AssertionError("a notebook opens no browser")

    monkeypatch.setattr(webbrowser, "open", fail)
    shell = SimpleNamespace(kernel=None)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    view = sphere.with_fields({'a"&amp;<b': np.arange(sphere.n_vertices)}).show()
    assert repr(view) == "View(0.1 MB of HTML)"
    assert Page(view._repr_html_()).frames == [view.html]
    assert ("field", 'a"&amp;<b') in Page(view.html).meshes[0]


def test_meshes_side_by_side_with_a_colour_bar(tmp_path: Path, bumpy: pf.Mesh) -> None:
    """One page holds both meshes whole, the field that colours them, and what draws the bar."""
    flat = bumpy.noise(sigma=0.2, seed=1)
    moved = np.linalg.norm(flat.vertices - bumpy.vertices, axis=1)
    page = saved(tmp_path, bumpy, flat, field=[None, moved], titles=["before", "after"])
    assert page.titles == ["before", "after"] and page.body["data-field"] == "field"
    for block in page.meshes:
        assert np.frombuffer(block["faces", ""], "<u4").size == 3 * bumpy.n_faces
        assert np.frombuffer(block["positions", ""], "<f4").size == 3 * bumpy.n_vertices
    assert ("field", "field") not in page.meshes[0]
    np.testing.assert_array_equal(values(page, 1, "field"), moved)
    html = (tmp_path / "view.html").read_text(encoding="utf-8")
    maps = re.search(r'<script id="colour-maps" type="application/json">(.*?)</script>', html)
    assert "function colorBar(" in html and maps is not None and len(json.loads(maps[1])) == 2


@pytest.mark.slow
def test_large_meshes_stay_usable(tmp_path: Path) -> None:
    """Half a million faces: a page that browsers open at once (tests/browser/show.rs), within a few seconds."""
    rows = np.arange(500 * 501).reshape(500, 501)[:, :500].ravel()
    faces = np.concatenate([np.c_[rows, rows + 1, rows + 502], np.c_[rows, rows + 502, rows + 501]])
    x, y = np.meshgrid(np.linspace(0, 1, 501), np.linspace(0, 1, 501))
    mesh = pf.Mesh(np.c_[x.ravel(), y.ravel(), np.sin(x * y).ravel()], faces)
    start = time.perf_counter()
    view = mesh.show(field=mesh.vertices[:, 2], path=tmp_path / "view.html")
    # Half a second on the machine where it was written.
    assert time.perf_counter() - start < 10
    assert 14e6 < len(view.html) < 16e6
