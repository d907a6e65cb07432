//! Constraints on the movement of vertices.

use fairing_mesh::TriMesh;
use fairing_parameters::{Field, Kind, Parameter, ParameterError, Range, Values, WeightedVertex};

use crate::engine::arrangement::Arrangement;
use crate::engine::error::FlowFailure;
use crate::engine::sliding::Sliding;

/// Treatment of the boundary of an open mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Boundary {
    /// Boundary vertices move like all others. Their neighbours lie on one side only, so the
    /// boundary shrinks.
    #[default]
    Free,
    /// Boundary vertices are fixed.
    Pinned,
    /// Boundary vertices slide along the boundary curve of the input; corners, where the curve
    /// turns by more than 45°, and vertices where boundary curves meet are fixed.
    Sliding,
}

fairing_parameters::choices!(Boundary, "treatment of the boundary",
    Free: "free", "Not constrained: the boundary shrinks";
    Pinned: "pinned", "Boundary vertices are fixed";
    Sliding: "sliding", "Boundary vertices slide along the boundary curve";
);
#[cfg(feature = "serde")]
fairing_parameters::serde_by_name!(Boundary);

/// A vertex drawn towards a target.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct SoftConstraint {
    /// The vertex.
    pub vertex: u32,
    /// The target position, in mesh units; the position in the input if `None`.
    pub target: Option<[f64; 3]>,
    /// The weight of the target, dimensionless: a step ends at the weighted mean of the
    /// unconstrained result (weight 1) and the target (this weight); implicit methods include it in
    /// the linear system.
    pub weight: f64,
}

/// Constraints of a flow; none by default.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Constraints {
    /// Treatment of the boundary.
    pub boundary: Boundary,
    /// Fixed vertices, on the boundary or in the interior.
    pub pinned: Vec<u32>,
    /// Vertices drawn towards targets; the last constraint of a vertex counts.
    pub soft: Vec<SoftConstraint>,
}

const BOUNDARY: &str = "boundary";
const PIN: &str = "pin";
pub(crate) const SOFT: &str = "soft";

impl Field for Constraints {
    fn parameters(&self, _: Parameter) -> Vec<Parameter> {
        let about = "The treatment of the boundary of an open mesh";
        let boundary = Parameter::new(BOUNDARY, Kind::Choice(Boundary::CHOICES), about);
        let about = "Fixed vertices";
        let pin = Parameter::new(PIN, Kind::Vertices, about);
        let about = "Vertices drawn to their input positions or to given points; a weight of 1 ends \
                     a step half-way between the flow and the point";
        let soft = Parameter::new(SOFT, Kind::Weighted, about);
        [self.boundary.parameters(boundary), vec![pin, soft]].concat()
    }

    fn read(&mut self, _: &'static str, values: &Values) -> Result<(), ParameterError> {
        self.boundary.read(BOUNDARY, values)?;
        self.pinned.extend_from_slice(values.vertices(PIN));
        let soft = values.weighted(SOFT).iter();
        self.soft.extend(soft.map(|&WeightedVertex { vertex, weight, target }| SoftConstraint {
            vertex,
            target,
            weight,
        }));
        Ok(())
    }
}

impl Constraints {
    /// No constraints.
    pub const NONE: Self = Self { boundary: Boundary::Free, pinned: Vec::new(), soft: Vec::new() };

    /// A treatment of the boundary without further constraints.
    pub fn boundary(boundary: Boundary) -> Self {
        Self { boundary, ..Self::NONE }
    }

    /// Returns true if nothing is constrained.
    pub fn is_free(&self) -> bool {
        *self == Self::default()
    }
}

/// Constraints in the order of an arrangement.
pub(crate) struct Freedom {
    /// True for fixed vertices.
    pub(crate) fixed: Vec<bool>,
    /// Weight and target of each vertex, if there are soft constraints.
    pub(crate) soft: Option<(Vec<f64>, Vec<[f64; 3]>)>,
    /// Boundary curves with sliding vertices.
    pub(crate) sliding: Option<Sliding>,
}

impl Freedom {
    pub(crate) fn new(
        arrangement: &Arrangement,
        constraints: &Constraints,
    ) -> Result<Self, FlowFailure> {
        let mesh = arrangement.mesh();
        let n = mesh.vertex_count();
        let check = |vertex: u32| {
            if (vertex as usize) < n {
                Ok(vertex as usize)
            } else {
                Err(FlowFailure::NoSuchVertex { vertex, vertex_count: n })
            }
        };
        let mut fixed = vec![false; n];
        if !constraints.pinned.is_empty() {
            for &v in &constraints.pinned {
                fixed[check(v)?] = true;
            }
            fixed = arrangement.arrange(&fixed);
        }
        if constraints.boundary == Boundary::Pinned {
            for (fixed, &boundary) in fixed.iter_mut().zip(mesh.topology().boundary_vertices()) {
                *fixed |= boundary;
            }
        }
        let sliding = (constraints.boundary == Boundary::Sliding)
            .then(|| Sliding::new(mesh, &mut fixed))
            .filter(|sliding| !sliding.is_empty());
        let mut soft = None;
        if !constraints.soft.is_empty() {
            let (mut weights, mut targets) = (vec![0.0; n], vec![Some([0.0; 3]); n]);
            for constraint in &constraints.soft {
                let v = check(constraint.vertex)?;
                Range::NOT_NEGATIVE.check("weight of a soft constraint", constraint.weight)?;
                for x in constraint.target.into_iter().flatten() {
                    let option = "target of a soft constraint";
                    ParameterError::require(x.is_finite(), option, x, "finite")?;
                }
                weights[v] = constraint.weight;
                targets[v] = constraint.target;
            }
            let targets = arrangement.arrange(&targets);
            let targets = targets.iter().zip(mesh.positions()).map(|(t, &own)| t.unwrap_or(own));
            soft = Some((arrangement.arrange(&weights), targets.collect()));
        }
        Ok(Self { fixed, soft, sliding })
    }

    /// Returns true if every vertex is either fixed or free, so that a step is linear in the
    /// positions.
    pub(crate) fn is_linear(&self) -> bool {
        self.soft.is_none() && self.sliding.is_none()
    }

    /// Weight and target of the soft constraint at vertex `i`; weight 0 if there is none.
    #[inline(always)]
    pub(crate) fn pull(&self, i: usize) -> (f64, [f64; 3]) {
        match &self.soft {
            None => (0.0, [0.0; 3]),
            Some((w, t)) => (w[i], t[i]),
        }
    }

    /// The component of a displacement of vertex `i` that the constraints allow.
    #[inline(always)]
    pub(crate) fn project(&self, i: usize, d: [f64; 3]) -> [f64; 3] {
        if self.fixed[i] {
            return [0.0; 3];
        }
        match &self.sliding {
            None => d,
            Some(sliding) => sliding.project(i, d),
        }
    }

    /// Updates the tangents of the boundary curves at the positions of `mesh`.
    pub(crate) fn begin_step(&mut self, mesh: &TriMesh) {
        if let Some(sliding) = &mut self.sliding {
            sliding.take_tangents(mesh.positions());
        }
    }

    /// Returns sliding vertices to their curves after a step along the tangents.
    pub(crate) fn end_step(&mut self, positions: &mut [[f64; 3]]) {
        if let Some(sliding) = &mut self.sliding {
            sliding.retract(positions);
        }
    }
}
