//! The playgrounds of the page, which compute everything in the page itself.

/// Something to play with in the section of an experiment.
pub(crate) struct Play {
    /// The experiment.
    pub(crate) section: &'static str,
    /// Its kind, which names the script that brings it to life; its id on the page begins with `play-`.
    pub(crate) kind: &'static str,
    /// The caption.
    pub(crate) caption: &'static str,
    /// What a person who cannot see it is told.
    pub(crate) alt: &'static str,
}

/// Those of the page, in its order.
const PLAYS: [Play; 4] = [
    Play {
        section: "q2",
        kind: "ellipsoid",
        caption: "The blue circle hugs the ellipsoid at (a, 0, 0); the red one of the original report does not, unless the \
            three axes are equal and the direction is y. The section along the normal shows both at scale, the plot \
            all directions. Drag a, b, c and the direction.",
        alt: "An ellipsoid with two circles at the end of its first axis: one fits the surface, one does not.",
    },
    Play {
        section: "q5",
        kind: "diffusion",
        caption: "Beyond λ = 4/3 explicit steps amplify the roughest mode; implicit steps of the same diffusion time stay \
            calm. This mesh has a mode of μ = −3/2, the least that a closed mesh can have. Below: the factor of one \
            step, and the size of each mode before and after. Drag λ through 4/3.",
        alt: "A noisy ball three times: as it is, after explicit steps and after implicit steps, with the factors and \
            the spectrum as plots.",
    },
    Play {
        section: "noise",
        kind: "noise",
        caption: "K breaks before H as the noise grows, and the sum of all angle defects never moves. Both surfaces show \
            the error of the estimate in the same colours, over the root mean square of the exact curvature. Drag the \
            noise; a click shows exact value, estimate and error at a vertex.",
        alt: "A torus or a sphere twice, with noise, coloured by the errors of its mean and of its Gaussian curvature.",
    },
    Play {
        section: "denoisers",
        kind: "denoising",
        caption: "The filter of normals keeps the creases that diffusion rounds off; once the noise is more than about a third \
            of an edge, diffusion is the better of the two. The colours are the angles between the normals and the true \
            ones. The filter is the local bilateral one of Zheng et al. (2011), diffusion has uniform weights. Drag the \
            noise, and the numbers under the panels count along.",
        alt: "A turned part three times: noisy, after diffusion, and after a filter of normals, with its errors as numbers.",
    },
];

/// The playgrounds of an experiment's section.
pub(crate) fn for_section(section: &str) -> impl Iterator<Item = &'static Play> {
    PLAYS.iter().filter(move |play| play.section == section)
}

impl Play {
    /// Its id on the page.
    pub(crate) fn id(&self) -> String {
        format!("play-{}", self.kind)
    }
}
