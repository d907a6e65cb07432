"""Meshes that the tests share."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import numpy as np
import pyfairing as pf
import pytest

# A job in the background of a shell begins with SIGINT ignored, and Python then leaves it so.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = Path(__file__).resolve().parents[2]
#: What the repository generates; the same for everybody.
DATA = ROOT / "data"


def corpus() -> list[Path]:
    """The meshes of the repository, and the real ones where `FAIRING_MESHES` names their folder."""
    folders = [DATA, Path(os.environ.get("FAIRING_MESHES") or "/nonexistent")]
    extensions = {".obj", ".ply", ".off", ".stl"}
    found = [
        p for folder in folders if folder.is_dir() for p in sorted(folder.rglob("*")) if p.suffix in extensions
    ]
    # Those that the tests can afford.
    return [p for p in found if p.stat().st_size < 4 << 20]


@pytest.fixture(scope="session")
def sphere() -> pf.Mesh:
    return pf.shapes.icosphere(3)


@pytest.fixture(scope="session")
def patch() -> pf.Mesh:
    """Open, irregular, not flat."""
    plane = pf.shapes.irregular_plane(0.06)
    x, y, _ = plane.vertices.T
    return plane.with_vertices(np.column_stack([x, y, 0.2 * np.sin(4 * x) * np.cos(3 * y)]))


@pytest.fixture(scope="session")
def bumpy() -> pf.Mesh:
    return pf.shapes.bumpy_sphere(3, 0.1, 5.0)
