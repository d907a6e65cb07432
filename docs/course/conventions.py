"""Draws conventions.png: the same quantities by other conventions."""

import matplotlib.pyplot as plt
import numpy as np
import pyfairing as pf
from PIL import Image

mesh = pf.shapes.flower(0.05)
curvature, border = mesh.curvature("cotangent"), mesh.boundary_vertices
S, M = mesh.laplacian("cotangent", "mixed")
H, K, A = curvature.mean, curvature.gaussian, M.diagonal()
fields = {
    "H": H,
    "H, the length without sign": np.linalg.norm(S @ mesh.vertices, axis=1) / A / 2,
    "H, integrated": H * A,
    "K": K,
    "K, 2π at the border": K + np.pi * border / A,
    "K, integrated": K * A,
}
figure, axes = plt.subplots(2, 3, figsize=(9, 5.2))
for axis, (name, field) in zip(axes.flat, fields.items()):
    axis.imshow(mesh.render(field=field, size=(480, 400), view="front"))
    axis.set_title(name, fontsize=10)
    axis.axis("off")
figure.tight_layout()
figure.savefig("conventions.png", dpi=80)
picture = Image.open("conventions.png").convert("RGB")
picture.quantize(96, dither=Image.Dither.NONE).save("conventions.png", optimize=True)
