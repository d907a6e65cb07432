import pyfairing as pf

mesh = pf.read("pipe.ply")
mesh = mesh.noise(sigma=0.2, seed=3, kind="normal")
mesh = mesh.smooth("taubin", lam=0.3, iterations=2)
mesh = mesh.denoise("bilateral-normal")
mesh = mesh.repair(tolerance=0.01, holes=30)
mesh.write("pipe-fairing.ply")
