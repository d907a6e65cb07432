//! Families of models to test denoisers on: every kind of surface in every kind of triangulation,
//! from a seed and a number of faces.
//!
//! The meshes are the truth: where a surface has a crease, the crease is a line
//! of mesh edges, and vertices lie on the surface to rounding. The seed
//! determines the proportions of a model (such as the number of teeth of a gear) and its
//! triangulation.
//!
//! ```
//! use fairing_study::families::{Family, Triangulation};
//!
//! let gear = Family::Gear.mesh(4000, Triangulation::Irregular, 7);
//! assert!((3600..4400).contains(&gear.face_count()));
//! assert!(gear.topology().is_closed());
//! ```

use fairing_mesh::TriMesh;
mod build;
mod curved;
mod cut;
mod detail;
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
pub use cut::cut;
pub use detail::detailed;
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

fairing_parameters::named!(Kind, "kind of surface",
    Planar: "planar",
    Curved: "curved",
    Smooth: "smooth",
    Detailed: "detailed",
    Thin: "thin",
);

/// A set of families.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Set {
    /// Families on which weights and constants are chosen.
    Development,
    /// Families that are only reported.
    Unseen,
    /// Families on which nothing was trained or chosen.
    Fresh,
}

fairing_parameters::named!(Set, "set of families",
    Development: "development",
    Unseen: "unseen",
    Fresh: "fresh",
);

/// The families, with their set, kind, name and generator. Each set has families of every kind.
macro_rules! families {
    ($($(#[$doc:meta])* $family:ident $set:ident $kind:ident $name:literal $make:path,)*) => {
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

            /// The set that it is in.
            pub fn set(self) -> Set {
                match self {
                    $(Self::$family => Set::$set,)*
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
    Stairs Development Planar "stairs" planar::stairs,
    /// A frame: chamfered corners, a turned window, a slanted top.
    Frame Development Planar "frame" planar::frame,
    /// The common part of half spaces at random.
    Crystal Unseen Planar "crystal" planar::crystal,
    /// A dodecahedron with a pyramid on each face.
    Star Unseen Planar "star" planar::star,
    /// A prism of many sides under a flat roof: creases of 15° to 30°.
    Prism Development Planar "prism" planar::prism,
    /// A gear wheel.
    Gear Development Curved "gear" curved::gear,
    /// A turned part: cylinders, a cone, a fillet, a rounded end.
    Turned Development Curved "turned" curved::turned,
    /// A plate with a cone, a frustum, a dome and a countersink.
    Bosses Development Curved "bosses" curved::bosses,
    /// A bracket with fillets of many radii, and a hole.
    Bracket Unseen Curved "bracket" curved::bracket,
    /// A sphere with grooves.
    Grooves Unseen Curved "grooves" curved::grooves,
    /// Two cylinders that meet at right angles.
    Joint Unseen Curved "joint" curved::joint,
    /// A column of arcs that meet in creases of 15° to 30°.
    Lobes Unseen Curved "lobes" curved::lobes,
    /// Balls that run into each other.
    Blob Development Smooth "blob" smooth::blob,
    /// A part of a triply periodic surface.
    Periodic Development Smooth "periodic" smooth::periodic,
    /// A tube around a trefoil knot.
    Knot Unseen Smooth "knot" smooth::knot,
    /// Minimal surfaces: a patch of Enneper's or of Scherk's.
    Minimal Unseen Smooth "minimal" smooth::minimal,
    /// A sphere with waves of several lengths.
    Relief Development Detailed "relief" detailed::relief,
    /// A woven ring.
    Weave Development Detailed "weave" detailed::weave,
    /// A plate with strokes as those of letters.
    Strokes Unseen Detailed "strokes" detailed::strokes,
    /// A ball with pores.
    Pores Unseen Detailed "pores" detailed::pores,
    /// A bent sheet less than two edges thick.
    Sheet Development Thin "sheet" sheets::sheet,
    /// A piece of cloth with a hole.
    Cloth Development Thin "cloth" sheets::cloth,
    /// A bent profile of sheet metal.
    Channel Unseen Thin "channel" sheets::channel,
    /// An open shell with a jagged border.
    Shell Unseen Thin "shell" sheets::shell,
    /// A house: roofs of slopes of 12° and more that meet in valleys, and a chimney.
    House Fresh Planar "house" fresh_creased::house,
    /// A tower of turned storeys, whose triangles fold inwards and outwards.
    Tower Fresh Planar "tower" fresh_creased::tower,
    /// A bolt: a hexagonal head that a cone chamfers, a shank with a fillet and a groove.
    Bolt Fresh Curved "bolt" fresh_creased::bolt,
    /// A cube with spherical sides, one of them hollow.
    Cushion Fresh Curved "cushion" fresh_creased::cushion,
    /// A vase with lobes that wind around it.
    Vase Fresh Smooth "vase" fresh_smooth::vase,
    /// A plate with two or three holes, round everywhere.
    Pretzel Fresh Smooth "pretzel" fresh_smooth::pretzel,
    /// A fluted column with mouldings.
    Fluted Fresh Detailed "fluted" fresh_smooth::fluted,
    /// A tyre with a tread.
    Tyre Fresh Detailed "tyre" fresh_smooth::tyre,
    /// A flat ring with a ruffled border.
    Ruffle Fresh Thin "ruffle" fresh_smooth::ruffle,
    /// A bowl about an edge thick.
    Bowl Fresh Thin "bowl" fresh_smooth::bowl,
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
