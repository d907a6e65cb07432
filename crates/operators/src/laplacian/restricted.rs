//! A Laplacian without its fixed vertices.

use std::borrow::Cow;

use fairing_sparse::{SparseMatrix, combine, principal_submatrix};

use super::{Laplacian, MassMatrix, mass};
use crate::error::OperatorError;

/// The place of a vertex that has no row.
const NONE: u32 = u32::MAX;

/// The rows and columns of the free vertices of a [`Laplacian`].
///
/// With r the free vertices and o the others, `S u = b` with `u_o` given is
///
/// ```text
/// S_rr u_r = b_r − S_ro u_o
/// ```
///
/// [`stiffness`](Self::stiffness) is `S_rr`, [`coupling`](Self::coupling) is
/// `S_ro u_o`, and [`extended`](Self::extended) puts `u_r` back.
#[derive(Debug, Clone)]
pub struct Restricted<'a> {
    whole: &'a Laplacian,
    free: Vec<u32>,
    place: Vec<u32>,
    stiffness: Cow<'a, SparseMatrix>,
    mass: Cow<'a, MassMatrix>,
}

impl Laplacian {
    /// Removes the rows and columns of the vertices `fixed`, in any order, and of
    /// isolated vertices, which have no equation. Copies nothing if no vertex is
    /// removed.
    ///
    /// # Errors
    ///
    /// [`OperatorError::NoSuchVertex`]; [`OperatorError::Mass`] for the first
    /// free vertex whose mass is not positive.
    pub fn restricted(&self, fixed: &[u32]) -> Result<Restricted<'_>, OperatorError> {
        let n = self.vertex_count();
        let mut place = vec![0; n];
        for &vertex in fixed {
            let no = OperatorError::NoSuchVertex { vertex, vertices: n };
            *place.get_mut(vertex as usize).ok_or(no)? = NONE;
        }
        for &vertex in &self.isolated {
            place[vertex as usize] = NONE;
        }
        let free: Vec<u32> = (0..n as u32).filter(|&v| place[v as usize] != NONE).collect();
        for (row, &v) in free.iter().enumerate() {
            place[v as usize] = row as u32;
        }
        let diagonal = self.mass.as_mass().diagonal();
        for &v in &free {
            mass::positive(v, diagonal[v as usize])?;
        }
        let (stiffness, mass) = if free.len() == n {
            (Cow::Borrowed(&self.stiffness), Cow::Borrowed(&self.mass))
        } else {
            let mass = match &self.mass {
                MassMatrix::Lumped(_) => {
                    MassMatrix::Lumped(free.iter().map(|&v| diagonal[v as usize]).collect())
                }
                MassMatrix::Consistent(m) => MassMatrix::Consistent(principal_submatrix(m, &free)),
            };
            (Cow::Owned(principal_submatrix(&self.stiffness, &free)), Cow::Owned(mass))
        };
        Ok(Restricted { whole: self, free, place, stiffness, mass })
    }
}

impl Restricted<'_> {
    /// The free vertices, ascending: row i belongs to `free()[i]`.
    pub fn free(&self) -> &[u32] {
        &self.free
    }

    /// Returns true if the vertex is free.
    pub fn is_free(&self, vertex: u32) -> bool {
        self.place.get(vertex as usize).is_some_and(|&place| place != NONE)
    }

    /// `S_rr`, positive definite where every component has a fixed vertex.
    pub fn stiffness(&self) -> &SparseMatrix {
        &self.stiffness
    }

    /// `M_rr`.
    pub fn mass(&self) -> &MassMatrix {
        &self.mass
    }

    /// `M_rr + t S_rr`, for a time t in squared mesh units.
    pub fn shifted(&self, time: f64) -> SparseMatrix {
        combine(1.0, self.mass.as_mass(), time, &self.stiffness)
    }

    /// `S_ro u_o`, one number for each free vertex: the contribution of the values
    /// at the other vertices to the equations. Takes a value for each vertex of
    /// the mesh and ignores those at free vertices.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Length`].
    pub fn coupling(&self, values: &[f64]) -> Result<Vec<f64>, OperatorError> {
        self.whole.check_length(values.len())?;
        let (starts, columns, data) = parts(&self.whole.stiffness);
        let row = |&v: &u32| {
            let row = starts[v as usize] as usize..starts[v as usize + 1] as usize;
            let entries = columns[row.clone()].iter().zip(&data[row]);
            entries
                .filter(|(j, _)| self.place[**j as usize] == NONE)
                .map(|(&j, s)| s * values[j as usize])
                .sum()
        };
        Ok(self.free.iter().map(row).collect())
    }

    /// The values at the free vertices, from values at all vertices.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Length`] if there is not one value per vertex.
    pub fn gathered<T: Copy>(&self, values: &[T]) -> Result<Vec<T>, OperatorError> {
        self.whole.check_length(values.len())?;
        Ok(self.free.iter().map(|&v| values[v as usize]).collect())
    }

    /// Values at all vertices: `free` at the free vertices, `values` elsewhere.
    ///
    /// # Errors
    ///
    /// [`OperatorError::Length`] if there is not one value per free vertex and one
    /// per vertex.
    pub fn extended<T: Copy>(&self, free: &[T], values: &[T]) -> Result<Vec<T>, OperatorError> {
        self.whole.check_length(values.len())?;
        if free.len() != self.free.len() {
            let (found, expected) = (free.len(), self.free.len());
            return Err(OperatorError::Length { found, expected });
        }
        let mut all = values.to_vec();
        for (&v, &value) in self.free.iter().zip(free) {
            all[v as usize] = value;
        }
        Ok(all)
    }
}

type Parts<'a> = (&'a [u32], &'a [u32], &'a [f64]);

fn parts(matrix: &SparseMatrix) -> Parts<'_> {
    (matrix.indptr().into_raw_storage(), matrix.indices(), matrix.data())
}
