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
const PLAYS: [Play; 3] = [
    Play {
        section: "q2",
        kind: "ellipsoid",
        caption: "Drag a, b, c and the direction: the blue circle hugs the ellipsoid at (a, 0, 0), the red one of the \
            original report does not, unless the three axes are equal and the direction is y. The section along the \
            normal shows both at scale; the plot shows all directions.",
        alt: "An ellipsoid with two circles at the end of its first axis: one fits the surface, one does not.",
    },
    Play {
        section: "q5",
        kind: "diffusion",
        caption: "Drag λ through 4/3: the roughest mode of this mesh has μ = −3/2, the least that a closed mesh can \
            have, and from there on explicit steps amplify it. Implicit steps of the same λ and number, so of the same \
            diffusion time, stay calm. Below: the factor of one step, and the size of each mode before and after.",
        alt: "A noisy ball three times: as it is, after explicit steps and after implicit steps, with the factors and \
            the spectrum as plots.",
    },
    Play {
        section: "noise",
        kind: "noise",
        caption: "Drag the noise: K breaks before H. Both surfaces show the error of the estimate in the same colours, \
            over the root mean square of the exact curvature; the numbers count along, and the sum of all angle \
            defects never moves. A click shows exact value, estimate and error at a vertex.",
        alt: "A torus or a sphere twice, with noise, coloured by the errors of its mean and of its Gaussian curvature.",
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
