//! Values, filters, signatures and heat belong to the surface: not to its numbering, frame or unit.

use fairing_mesh::TriMesh;
use fairing_operators::Laplacian;
use fairing_shapes as shapes;
use fairing_spectral::{
    HeatDiffusion, Rest, Spectrum, SpectrumOptions, heat_kernel_signature, heat_kernel_times,
    spectrum, wave_kernel_energies, wave_kernel_signature,
};
use ndarray::{Array2, Axis};

use crate::meshes::{mapped, relabelled, scaled, turned, union};

/// Quantities that do not depend on a basis, per vertex and as numbers, for a mesh in a unit.
struct Facts {
    values: Vec<f64>,
    /// Energies of a field by cluster.
    energies: Vec<f64>,
    filtered: Array2<f64>,
    heat: Array2<f64>,
    wave: Array2<f64>,
    diffused: Vec<f64>,
}

/// In units of the mesh; `number[v]` is the vertex whose field value v has.
fn facts(mesh: &TriMesh, unit: f64, number: &[usize]) -> Facts {
    let laplacian = Laplacian::cotangent(mesh).unwrap();
    let found: Spectrum = spectrum(&laplacian, 20, &SpectrumOptions::default()).unwrap();
    let k = found.gap_below(20);
    assert!(k >= 15 && found.certified);
    let found = found.truncated(k).unwrap();
    let value = |v: usize| (number[v] % 7) as f64 - 3.0;
    let field = Array2::from_shape_fn((mesh.vertex_count(), 1), |(v, _)| value(v));
    let energies = Spectrum::energies(found.transform(field.view()).unwrap().view());
    let last = found.values[k - 1];
    let filter =
        found.filter(field.view(), |l| (-3.0 * l / last).exp(), Rest::Scaled(0.1)).unwrap();
    let times = heat_kernel_times(&found, 4);
    let start: Vec<f64> = (0..mesh.vertex_count()).map(value).collect();
    let area = unit * unit;
    let (levels, sigma) = wave_kernel_energies(&found, 6).unwrap();
    Facts {
        values: found.values.iter().map(|l| l * area).collect(),
        energies: found
            .clusters()
            .into_iter()
            .map(|c| energies[c].iter().sum::<f64>() / area)
            .collect(),
        filtered: filter.field,
        heat: heat_kernel_signature(&found, &times).unwrap() * area,
        wave: wave_kernel_signature(&found, &levels, sigma).unwrap() * area,
        diffused: HeatDiffusion::new(&laplacian, 0.01 * area).unwrap().step(&start).unwrap(),
    }
}

fn near(
    a: impl IntoIterator<Item = f64>,
    b: impl IntoIterator<Item = f64>,
    share: f64,
    what: &str,
) {
    let (a, b): (Vec<f64>, Vec<f64>) = (a.into_iter().collect(), b.into_iter().collect());
    assert_eq!(a.len(), b.len(), "{what}");
    let size = b.iter().fold(0.0, |m: f64, b| m.max(b.abs()));
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() <= share * size, "{what}: {a} {b} of {size}");
    }
}

fn compare(found: &Facts, expected: &Facts, place: &[usize], share: f64) {
    near(found.values.iter().copied(), expected.values.iter().copied(), share, "values");
    near(found.energies.iter().copied(), expected.energies.iter().copied(), share, "energies");
    let rows = |a: &Array2<f64>| a.select(Axis(0), place).into_iter().collect::<Vec<_>>();
    near(rows(&found.filtered), expected.filtered.iter().copied(), share, "filter");
    near(rows(&found.heat), expected.heat.iter().copied(), share, "heat kernel");
    near(rows(&found.wave), expected.wave.iter().copied(), share, "wave kernel");
    let diffused = place.iter().map(|&v| found.diffused[v]);
    near(diffused, expected.diffused.iter().copied(), share, "diffusion");
}

#[test]
fn nothing_depends_on_the_frame() {
    let torus = shapes::torus(1.0, 0.4, 24, 14);
    let bumpy = shapes::bumpy_sphere(3, 0.15, 4.0);
    let both = union(&mapped(&bumpy, |p| p.map(|x| x + 4.0)), &scaled(&torus, 0.3));
    for mesh in [torus, bumpy, both] {
        let same: Vec<usize> = (0..mesh.vertex_count()).collect();
        let expected = facts(&mesh, 1.0, &same);
        // Residuals of 10⁻⁹ against gaps of 10⁻⁴ at least: 10⁻⁵, and far less as a rule.
        let share = 1e-6;
        for s in [1e-8, 1e8] {
            compare(&facts(&scaled(&mesh, s), s, &same), &expected, &same, share);
        }
        compare(&facts(&turned(&mesh), 1.0, &same), &expected, &same, share);
        let far = mapped(&mesh, |p| [p[0] + 1e5, p[1] - 3e5, p[2]]);
        // Eleven digits are left of the positions, and nine of an area.
        compare(&facts(&far, 1.0, &same), &expected, &same, 1e-5);
        let (other, place) = relabelled(&mesh);
        let mut number = vec![0; place.len()];
        for (v, &p) in place.iter().enumerate() {
            number[p] = v;
        }
        compare(&facts(&other, 1.0, &number), &expected, &place, share);
    }
}
