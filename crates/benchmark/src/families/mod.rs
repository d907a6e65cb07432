//! Families of models to test denoisers on: every kind of surface in every kind of triangulation,
//! from a seed and a number of faces.
//!
//! The meshes are the truth: where a surface has a crease, the crease is a line
//! of mesh edges, and vertices lie on the surface to rounding. The seed
//! determines the proportions of a model (such as the number of teeth of a gear) and its
//! triangulation.
//!
//! ```
//! use fairing_benchmark::families::{Family, Triangulation};
//!
//! let gear = Family::Gear.mesh(4000, Triangulation::Irregular, 7);
//! assert!((3600..4400).contains(&gear.face_count()));
//! assert!(gear.topology().is_closed());
//! ```

use fairing_mesh::TriMesh;
mod build;
mod curved;
mod detailed;
mod extrude;
mod fresh_creased;
mod fresh_smooth;
mod models;
mod planar;
mod polyhedron;
mod random;
mod random_smooth;
mod revolve;
mod sheets;
mod smooth;
mod solid;
#[cfg(test)]
mod surfaces;
#[cfg(test)]
mod tests;
mod tube;
mod warp;

use build::{Build, sized};

pub use build::Triangulation;
pub use random::RandomModel;
pub use warp::warped;

/// The kind of surface of a family.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Planes that meet in creases.
    Planar,
    /// Planes, cylinders, cones, spheres and tori that meet in creases.
    Curved,
    /// Smooth everywhere.
    Smooth,
    /// Smooth with details a few edges wide.
    Detailed,
    /// Thin or open.
    Thin,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] =
        [Self::Planar, Self::Curved, Self::Smooth, Self::Detailed, Self::Thin];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Planar => "planar",
            Self::Curved => "curved",
            Self::Smooth => "smooth",
            Self::Detailed => "detailed",
            Self::Thin => "thin",
        }
    }
}

fairing_parameters::named!(Kind, "kind of surface");

/// The families, with their kind, name and generator.
macro_rules! families {
    ($($(#[$doc:meta])* $family:ident $kind:ident $name:literal $make:path,)*) => {
        /// A family of models, about two across.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Family {
            $($(#[$doc])* $family,)*
        }

        impl Family {
            /// All families. Families of a kind are adjacent, apart from the last ten, which are
            /// grouped by kind in turn.
            pub const ALL: &'static [Self] = &[$(Self::$family),*];

            /// The name in tables.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$family => $name,)*
                }
            }

            /// The kind of surface.
            pub fn kind(self) -> Kind {
                match self {
                    $(Self::$family => Kind::$kind,)*
                }
            }

            fn make(self, build: Build) -> TriMesh {
                match self {
                    $(Self::$family => $make(build),)*
                }
            }
        }
    };
}

families! {
    /// A staircase with a slanted side.
    Stairs Planar "stairs" planar::stairs,
    /// A frame: chamfered corners, a turned window, a slanted top.
    Frame Planar "frame" planar::frame,
    /// The common part of half spaces at random.
    Crystal Planar "crystal" planar::crystal,
    /// A dodecahedron with a pyramid on each face.
    Star Planar "star" planar::star,
    /// A prism of many sides under a flat roof: creases of 15° to 30°.
    Prism Planar "prism" planar::prism,
    /// A gear wheel.
    Gear Curved "gear" curved::gear,
    /// A turned part: cylinders, a cone, a fillet, a rounded end.
    Turned Curved "turned" curved::turned,
    /// A plate with a cone, a frustum, a dome and a countersink.
    Bosses Curved "bosses" curved::bosses,
    /// A bracket with fillets of many radii, and a hole.
    Bracket Curved "bracket" curved::bracket,
    /// A sphere with grooves.
    Grooves Curved "grooves" curved::grooves,
    /// Two cylinders that meet at right angles.
    Joint Curved "joint" curved::joint,
    /// A column of arcs that meet in creases of 15° to 30°.
    Lobes Curved "lobes" curved::lobes,
    /// Balls that run into each other.
    Blob Smooth "blob" smooth::blob,
    /// A part of a triply periodic surface.
    Periodic Smooth "periodic" smooth::periodic,
    /// A tube around a trefoil knot.
    Knot Smooth "knot" smooth::knot,
    /// Minimal surfaces: a patch of Enneper's or of Scherk's.
    Minimal Smooth "minimal" smooth::minimal,
    /// A sphere with waves of several lengths.
    Relief Detailed "relief" detailed::relief,
    /// A woven ring.
    Weave Detailed "weave" detailed::weave,
    /// A plate with strokes as those of letters.
    Strokes Detailed "strokes" detailed::strokes,
    /// A ball with pores.
    Pores Detailed "pores" detailed::pores,
    /// A bent sheet less than two edges thick.
    Sheet Thin "sheet" sheets::sheet,
    /// A piece of cloth with a hole.
    Cloth Thin "cloth" sheets::cloth,
    /// A bent profile of sheet metal.
    Channel Thin "channel" sheets::channel,
    /// An open shell with a jagged border.
    Shell Thin "shell" sheets::shell,
    /// A house: roofs of slopes of 12° and more that meet in valleys, and a chimney.
    House Planar "house" fresh_creased::house,
    /// A tower of turned storeys, whose triangles fold inwards and outwards.
    Tower Planar "tower" fresh_creased::tower,
    /// A bolt: a hexagonal head that a cone chamfers, a shank with a fillet and a groove.
    Bolt Curved "bolt" fresh_creased::bolt,
    /// A cube with spherical sides, one of them hollow.
    Cushion Curved "cushion" fresh_creased::cushion,
    /// A vase with lobes that wind around it.
    Vase Smooth "vase" fresh_smooth::vase,
    /// A plate with two or three holes, round everywhere.
    Pretzel Smooth "pretzel" fresh_smooth::pretzel,
    /// A fluted column with mouldings.
    Fluted Detailed "fluted" fresh_smooth::fluted,
    /// A tyre with a tread.
    Tyre Detailed "tyre" fresh_smooth::tyre,
    /// A flat ring with a ruffled border.
    Ruffle Thin "ruffle" fresh_smooth::ruffle,
    /// A bowl about an edge thick.
    Bowl Thin "bowl" fresh_smooth::bowl,
}

fairing_parameters::named!(Family, "family");

impl Family {
    /// A model with about this many faces (within a fifth: small models consist of few curves),
    /// oriented outwards or upwards.
    ///
    /// # Panics
    ///
    /// Unless `faces` is from 2000 to 100 thousand: coarser triangles miss the
    /// details.
    pub fn mesh(self, faces: usize, triangulation: Triangulation, seed: u64) -> TriMesh {
        sized(|build| self.make(build), faces, triangulation, seed)
    }
}
