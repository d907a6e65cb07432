//! The denoisers by name.

use fairing_mesh::TriMesh;

use super::{
    DenoiseError, automatic, bilateral, bilateral_normal, bilateral_normal_global, fast_effective,
    guided_normal, l0, non_iterative, total_variation,
};

/// A denoiser with its default options.
///
/// Written as its name (`Display`), and read from it (`FromStr`).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Denoiser {
    /// [`automatic`].
    Automatic,
    /// [`bilateral`].
    Bilateral,
    /// [`non_iterative`].
    NonIterative,
    /// [`fast_effective`].
    FastEffective,
    /// [`bilateral_normal`].
    BilateralNormal,
    /// [`bilateral_normal_global`].
    BilateralNormalGlobal,
    /// [`l0`].
    L0,
    /// [`total_variation`].
    TotalVariation,
    /// [`guided_normal`].
    GuidedNormal,
}

impl Denoiser {
    /// All denoisers: ours, then the others in the order they were published.
    pub const ALL: [Self; 9] = [
        Self::Automatic,
        Self::Bilateral,
        Self::NonIterative,
        Self::FastEffective,
        Self::BilateralNormal,
        Self::BilateralNormalGlobal,
        Self::L0,
        Self::TotalVariation,
        Self::GuidedNormal,
    ];

    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Automatic => "automatic",
            Self::Bilateral => "bilateral",
            Self::NonIterative => "non-iterative",
            Self::FastEffective => "fast-effective",
            Self::BilateralNormal => "bilateral-normal",
            Self::BilateralNormalGlobal => "bilateral-normal-global",
            Self::L0 => "l0",
            Self::TotalVariation => "total-variation",
            Self::GuidedNormal => "guided-normal",
        }
    }

    /// One line: what it does, and its source.
    pub fn description(self) -> &'static str {
        match self {
            Self::Automatic => "all estimated from the mesh; creases kept where there are any",
            Self::Bilateral => "bilateral filter of vertices (Fleishman et al. 2003)",
            Self::NonIterative => "robust averages of predictions by faces (Jones et al. 2003)",
            Self::FastEffective => "weighted averages of normals, cut off (Sun et al. 2007)",
            Self::BilateralNormal => "bilateral filter of normals, repeated (Zheng et al. 2011)",
            Self::BilateralNormalGlobal => {
                "bilateral filter of normals, one system (Zheng et al. 2011)"
            }
            Self::L0 => "as few bent edges as possible (He and Schaefer 2013)",
            Self::TotalVariation => "total variation of normals (Zhang et al. 2015)",
            Self::GuidedNormal => {
                "bilateral filter of normals guided by patches (Zhang et al. 2015)"
            }
        }
    }

    /// Denoises with the default options; the result has the same faces.
    ///
    /// # Errors
    ///
    /// Those of the function of the same name.
    pub fn denoise(self, mesh: &TriMesh) -> Result<TriMesh, DenoiseError> {
        match self {
            Self::Automatic => Ok(automatic(mesh)?.mesh),
            Self::Bilateral => bilateral(mesh, &Default::default()),
            Self::NonIterative => non_iterative(mesh, &Default::default()),
            Self::FastEffective => fast_effective(mesh, &Default::default()),
            Self::BilateralNormal => bilateral_normal(mesh, &Default::default()),
            Self::BilateralNormalGlobal => bilateral_normal_global(mesh, &Default::default()),
            Self::L0 => l0(mesh, &Default::default()),
            Self::TotalVariation => total_variation(mesh, &Default::default()),
            Self::GuidedNormal => guided_normal(mesh, &Default::default()),
        }
    }
}

fairing_mesh::named!(Denoiser, "denoiser");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for denoiser in Denoiser::ALL {
            assert_eq!(denoiser.name().parse(), Ok(denoiser));
        }
        let error = "laplace".parse::<Denoiser>().unwrap_err().to_string();
        assert!(error.contains("laplace") && error.contains("guided-normal"), "{error}");
    }
}
