import numpy as np
import pyfairing as pf

mesh = pf.read("pipe.ply")
fields = {}
fields |= mesh.curvature("adaptive").fields()
# Components without a source have no distance.
fields["distance"] = np.nan_to_num(mesh.geodesic_distance([0, 5, 6]), posinf=-1.0)
modes = mesh.spectrum(12, "auto").modes
fields["mode"] = modes[:, 3]
mesh.with_fields(fields).write("pipe-0.ply")
mesh = mesh.noise(sigma=0.2, seed=3, kind="normal")
mesh = mesh.smooth("taubin", lam=0.3, iterations=2)
mesh = mesh.denoise("bilateral-normal")
mesh = mesh.repair(tolerance=0.01, holes=30)
print(pf.compare(mesh, pf.read("pipe.ply"), hausdorff_tolerance=0.001, feature_angle=40))
fields = {}
fields |= mesh.curvature("adaptive").fields()
# Components without a source have no distance.
fields["distance"] = np.nan_to_num(mesh.geodesic_distance([0, 5, 6]), posinf=-1.0)
modes = mesh.spectrum(12, "auto").modes
fields["mode"] = modes[:, 3]
mesh.with_fields(fields).write("pipe-fairing.ply")
