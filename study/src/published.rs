//! The published methods, and the values of their parameters in the search.

use anyhow::{Context as _, Result, bail};
use fairing_denoising::{
    BilateralNormalGlobalOptions, BilateralNormalOptions, BilateralOptions, DenoiseError, Denoiser,
    FastEffectiveOptions, GuidedNormalOptions, L0Options, NonIterativeOptions,
    TotalGeneralisedVariationOptions, TotalVariationOptions, bilateral, bilateral_normal,
    bilateral_normal_global, fast_effective, guided_normal, l0, non_iterative,
    total_generalised_variation, total_variation,
};
use fairing_mesh::TriMesh;

/// A published method.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Its name is the denoiser's.
    pub denoiser: Denoiser,
    /// Its parameters, those that matter most first.
    axes: &'static [Axis],
    /// Starting points of the search beside the defaults: indices of values.
    starts: &'static [&'static [usize]],
    /// The largest number of runs of the search from each start.
    pub runs: usize,
    run: fn(&TriMesh, &[f64]) -> Result<TriMesh, DenoiseError>,
}

/// A parameter with the values that are tried, ascending.
#[derive(Debug)]
struct Axis {
    name: &'static str,
    values: &'static [f64],
    /// The index of the value that is the default.
    default: usize,
}

/// The parameters of a run: for each axis the index of the value.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Setting(Vec<usize>);

const fn axis(name: &'static str, values: &'static [f64], default: usize) -> Axis {
    Axis { name, values, default }
}

const COUNTS: &[f64] = &[1.0, 2.0, 3.0, 5.0, 8.0, 12.0, 20.0, 40.0, 75.0];
const STEPS: &[f64] = &[5.0, 10.0, 20.0, 50.0];

impl Method {
    /// All published methods, in the order of their publication.
    pub const ALL: [Self; 9] = [
        Self {
            denoiser: Denoiser::Bilateral(BilateralOptions::DEFAULT),
            axes: &[
                axis("iterations", COUNTS, 2),
                axis("range", &[0.5, 0.7, 1.0, 1.5, 2.5, 5.0], 2),
                axis("spatial", &[0.5, 0.7, 1.0, 1.5, 2.0, 3.0], 2),
            ],
            starts: &[&[0, 4, 1]],
            runs: 12,
            run: |mesh, p| {
                let iterations = p[0] as usize;
                bilateral(mesh, &BilateralOptions { iterations, range: p[1], spatial: p[2] })
            },
        },
        Self {
            denoiser: Denoiser::NonIterative(NonIterativeOptions::DEFAULT),
            axes: &[
                axis("influence", &[0.1, 0.2, 0.3, 0.5, 0.8, 1.5], 3),
                axis("spatial", &[0.7, 1.0, 1.5, 2.0, 3.0, 4.0], 3),
            ],
            starts: &[],
            runs: 9,
            run: |mesh, p| {
                non_iterative(mesh, &NonIterativeOptions { influence: p[0], spatial: p[1] })
            },
        },
        Self {
            denoiser: Denoiser::FastEffective(FastEffectiveOptions::DEFAULT),
            axes: &[
                axis("threshold", &[-0.5, 0.0, 0.3, 0.5, 0.65, 0.8, 0.9], 3),
                axis("iterations", COUNTS, 6),
                axis("steps", STEPS, 3),
            ],
            starts: &[&[5, 3, 1]],
            runs: 12,
            run: |mesh, p| {
                let (threshold, iterations, vertex_steps) = (p[0], p[1] as usize, p[2] as usize);
                fast_effective(mesh, &FastEffectiveOptions { threshold, iterations, vertex_steps })
            },
        },
        Self {
            denoiser: Denoiser::BilateralNormal(BilateralNormalOptions::DEFAULT),
            axes: &[
                axis("iterations", COUNTS, 6),
                axis("range", &[0.2, 0.3, 0.45, 0.6, 0.8, 1.1, 1.6], 2),
                axis("steps", STEPS, 1),
                axis("spatial", &[0.7, 1.0, 2.0], 1),
            ],
            starts: &[&[3, 4, 1, 1]],
            runs: 12,
            run: |mesh, p| {
                let (iterations, vertex_steps) = (p[0] as usize, p[2] as usize);
                let (range, spatial) = (p[1], p[3]);
                let options = BilateralNormalOptions { spatial, range, iterations, vertex_steps };
                bilateral_normal(mesh, &options)
            },
        },
        Self {
            denoiser: Denoiser::BilateralNormalGlobal(BilateralNormalGlobalOptions::DEFAULT),
            axes: &[
                axis("fidelity", &[0.001, 0.003, 0.01, 0.03, 0.1, 0.3], 2),
                axis("range", &[0.2, 0.3, 0.45, 0.6, 0.8, 1.1, 1.6], 2),
                axis("steps", STEPS, 1),
            ],
            starts: &[],
            runs: 12,
            run: |mesh, p| {
                let (fidelity, range, vertex_steps) = (p[0], p[1], p[2] as usize);
                let options =
                    BilateralNormalGlobalOptions { spatial: 1.0, range, fidelity, vertex_steps };
                bilateral_normal_global(mesh, &options)
            },
        },
        Self {
            denoiser: Denoiser::L0(L0Options::DEFAULT),
            axes: &[
                axis("sparsity", &[0.5, 1.5, 5.0, 15.0, 40.0, 100.0], 3),
                axis("regularity", &[0.3, 1.0, 3.0], 1),
            ],
            starts: &[],
            runs: 6,
            run: |mesh, p| {
                let options = L0Options { sparsity: p[0], regularity: p[1], ..Default::default() };
                l0(mesh, &options)
            },
        },
        Self {
            denoiser: Denoiser::TotalVariation(TotalVariationOptions::DEFAULT),
            axes: &[
                axis("weight", &[0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5], 5),
                axis("steps", STEPS, 2),
            ],
            starts: &[],
            runs: 10,
            run: |mesh, p| {
                let (weight, vertex_steps) = (p[0], p[1] as usize);
                let options = TotalVariationOptions { weight, iterations: 40, vertex_steps };
                total_variation(mesh, &options)
            },
        },
        Self {
            denoiser: Denoiser::GuidedNormal(GuidedNormalOptions::DEFAULT),
            axes: &[
                axis("range", &[0.15, 0.2, 0.25, 0.3, 0.35, 0.45, 0.6, 0.9], 4),
                axis("iterations", COUNTS, 6),
                axis("steps", STEPS, 1),
            ],
            starts: &[],
            runs: 11,
            run: |mesh, p| {
                let (range, iterations, vertex_steps) = (p[0], p[1] as usize, p[2] as usize);
                let defaults = GuidedNormalOptions::default();
                let options = GuidedNormalOptions { range, iterations, vertex_steps, ..defaults };
                guided_normal(mesh, &options)
            },
        },
        Self {
            denoiser: Denoiser::TotalGeneralisedVariation(
                TotalGeneralisedVariationOptions::DEFAULT,
            ),
            axes: &[
                axis("weight", &[0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5], 4),
                axis("ratio", &[0.2, 0.3, 0.4, 0.5, 0.7, 1.0], 3),
                axis("steps", &[5.0, 10.0, 20.0, 50.0, 100.0], 3),
            ],
            starts: &[],
            runs: 11,
            run: |mesh, p| {
                let (weight, ratio, vertex_steps) = (p[0], p[1], p[2] as usize);
                let defaults = TotalGeneralisedVariationOptions::default();
                let options =
                    TotalGeneralisedVariationOptions { weight, ratio, vertex_steps, ..defaults };
                total_generalised_variation(mesh, &options)
            },
        },
    ];

    /// The method of this name.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|m| m.denoiser.name() == name);
        found.with_context(|| format!("there is no published method {name}"))
    }

    /// Its default parameters.
    pub fn defaults(&self) -> Setting {
        Setting(self.axes.iter().map(|a| a.default).collect())
    }

    /// Starting points of the search, the defaults first.
    pub(super) fn starts(&self) -> Vec<Setting> {
        let more = self.starts.iter().map(|indices| Setting(indices.to_vec()));
        std::iter::once(self.defaults()).chain(more).collect()
    }

    /// The settings one value away from this one, axis by axis, upwards first.
    pub(super) fn neighbours(&self, setting: &Setting, axis: usize) -> Vec<Setting> {
        let moved = |to: usize| {
            let mut moved = setting.clone();
            moved.0[axis] = to;
            moved
        };
        let at = setting.0[axis];
        let up = (at + 1 < self.axes[axis].values.len()).then(|| moved(at + 1));
        let down = at.checked_sub(1).map(moved);
        up.into_iter().chain(down).collect()
    }

    /// The setting one value further in the direction from `from` to `to`.
    pub(super) fn beyond(&self, from: &Setting, to: &Setting, axis: usize) -> Option<Setting> {
        let next = 2 * to.0[axis] as isize - from.0[axis] as isize;
        let inside = 0 <= next && (next as usize) < self.axes[axis].values.len();
        inside.then(|| {
            let mut moved = to.clone();
            moved.0[axis] = next as usize;
            moved
        })
    }

    /// The number of parameters.
    pub(super) fn dimension(&self) -> usize {
        self.axes.len()
    }

    /// Denoises with these parameters.
    pub fn run(&self, mesh: &TriMesh, setting: &Setting) -> Result<TriMesh, DenoiseError> {
        let values = self.axes.iter().zip(&setting.0).map(|(a, &i)| a.values[i]);
        (self.run)(mesh, &values.collect::<Vec<_>>())
    }

    /// The parameters as text: `iterations 5, range 0.8`.
    pub fn text(&self, setting: &Setting) -> String {
        let parts = self.axes.iter().zip(&setting.0);
        let parts = parts.map(|(a, &i)| format!("{} {}", a.name, a.values[i]));
        parts.collect::<Vec<_>>().join("; ")
    }

    /// The parameters from their text.
    pub fn parsed(&self, text: &str) -> Result<Setting> {
        let parts: Vec<&str> = text.split("; ").collect();
        if parts.len() != self.axes.len() {
            bail!("{}: {} parameters in {text:?}", self.denoiser, parts.len());
        }
        let mut setting = vec![];
        for (axis, part) in self.axes.iter().zip(parts) {
            let value = part.strip_prefix(axis.name).map(str::trim);
            let value: Option<f64> = value.and_then(|v| v.parse().ok());
            let index = value.and_then(|v| axis.values.iter().position(|x| *x == v));
            setting.push(index.with_context(|| format!("{}: {part:?}", self.denoiser))?);
        }
        Ok(Setting(setting))
    }
}

/// The denoiser of this name with its defaults, as a function.
pub fn denoiser(name: &str) -> Result<impl Fn(&TriMesh) -> Result<TriMesh, DenoiseError>> {
    let denoiser: Denoiser = name.parse()?;
    Ok(move |mesh: &TriMesh| denoiser.denoise(mesh))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first run of every search is the one that users get.
    #[test]
    fn defaults_are_those_of_the_denoisers() {
        let mesh = fairing_shapes::jittered(&fairing_shapes::icosphere(2), 0.2, 3, |p| p);
        for method in Method::ALL {
            let ours = method.run(&mesh, &method.defaults()).unwrap();
            assert_eq!(ours, method.denoiser.denoise(&mesh).unwrap(), "{}", method.denoiser);
        }
        let published =
            Denoiser::all().into_iter().filter(|d| !matches!(d, Denoiser::Automatic(_)));
        assert!(published.eq(Method::ALL.iter().map(|m| m.denoiser)));
    }

    #[test]
    fn parameters_are_read_back() {
        for method in Method::ALL {
            for start in method.starts() {
                assert_eq!(method.parsed(&method.text(&start)).unwrap(), start);
            }
            for axis in 0..method.dimension() {
                for setting in method.neighbours(&method.defaults(), axis) {
                    assert_eq!(method.parsed(&method.text(&setting)).unwrap(), setting);
                }
            }
            assert!(method.parsed("colour 3").is_err());
        }
    }
}
