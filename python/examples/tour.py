"""A tour of the package: what type checkers and the tests run."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyfairing as pf


def main() -> None:
    """Does a little of everything."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "blob.ply"
        pf.shapes.bumpy_sphere(4).write(path)
        mesh = pf.read(path)
    vertices: npt.NDArray[np.float64] = mesh.vertices
    faces: npt.NDArray[np.int64] = mesh.faces
    print(mesh, vertices.shape, faces.shape)

    S, M = mesh.laplacian(kind="cotangent", mass="barycentric")
    print(S.shape, M.sum())

    c = mesh.curvature()
    mean: npt.NDArray[np.float64] = c.mean
    print(c, mean[c.defined].mean())

    s = mesh.spectrum(k=16, kind="robust")
    f = vertices[:, 2]
    print(s, s.project(f)[:3], s.reconstruct(16).n_vertices)
    print(s.heat_kernel_signature([0.1, 1.0]).shape, s.certified)

    d = mesh.geodesic_distance([0], kind="robust")
    way = mesh.geodesic_path(7, (12, [0.2, 0.3, 0.5]))
    print(float(d.max()), way.shape, [len(line) for line in mesh.isolines(d, [0.5, 1.0])])

    far, _ = mesh.submesh((d > 0.3)[faces].all(axis=1))
    mended = far.repair(holes=100)
    parts = mended.components()
    near = mended.closest(vertices, signed=True)
    print(mended.report["unchanged"], parts.n_components, near.distance.max())

    flat = mesh.smooth("implicit", weights="uniform", lam=5.0, iterations=10)
    noisy = mesh.noise(sigma=0.2, unit="edge", seed=1, where=d > 0.5)
    clean = noisy.denoise("bilateral-normal", range=0.5, vertex_steps=5)
    scores = pf.compare(clean, mesh)
    print(flat.report["approach"], scores["distance_rms"])

    image: npt.NDArray[np.uint8] = clean.render(field=c.mean, size=(160, 120))
    print(image.shape)

    ellipsoid = pf.surfaces.Ellipsoid(3.0, 2.0, 1.0)
    u, v = np.meshgrid(np.linspace(0, 6, 5), np.linspace(0.1, 3, 4))
    print(ellipsoid.mean_curvature(u, v).shape)

    try:
        pf.Mesh([[0.0, 0.0, 0.0]], [[0, 1, 2]])
    except pf.MeshError as error:
        print(error)


if __name__ == "__main__":
    main()
