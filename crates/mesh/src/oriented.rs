//! Consistent orientation of neighbouring faces.

use std::borrow::Cow;

use crate::trimesh::TriMesh;

impl TriMesh {
    /// The mesh with every face flipped that disagrees with its part. Positions, the order of
    /// faces and the first corner of each face do not change.
    ///
    /// Parts are those of [`Orientation`](crate::Orientation). A part takes the winding of most of
    /// its area, or that of its lowest face if both windings have the same area. A consistent part
    /// is never flipped, even inside out. A [one-sided](Self::one_sided_faces) part, which cannot
    /// be oriented, disagrees along one cut. Linear; returns the mesh itself, borrowed, if no face
    /// has to be flipped.
    ///
    /// # Examples
    ///
    /// ```
    /// use fairing_mesh::TriMesh;
    ///
    /// let corners = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.5, 1.5, 0.0]];
    /// let mesh = TriMesh::new(corners, vec![[0, 1, 2], [1, 2, 3]])?;
    /// assert_eq!(mesh.turned_faces(), [1]);
    /// assert_eq!(mesh.oriented().faces(), [[0, 1, 2], [1, 3, 2]]);
    /// # Ok::<(), fairing_mesh::BuildError>(())
    /// ```
    #[doc(alias("bfs_orient", "fix_winding"))]
    pub fn oriented(&self) -> Cow<'_, Self> {
        match self.flips() {
            None => Cow::Borrowed(self),
            Some(flips) => Cow::Owned(self.turned(&flips)),
        }
    }

    /// The faces that [`oriented`](Self::oriented) flips, ascending, except those of one-sided
    /// parts.
    pub fn turned_faces(&self) -> Vec<u32> {
        let Some(flips) = self.flips() else { return vec![] };
        let one_sided = self.topology().orientation().one_sided_faces();
        (0..flips.len() as u32).filter(|&f| flips[f as usize] && !one_sided[f as usize]).collect()
    }

    /// The faces of parts that cannot be oriented, such as Möbius bands, ascending. Normals, signs
    /// of curvature and volumes are undefined there.
    pub fn one_sided_faces(&self) -> Vec<u32> {
        if self.connectivity().is_consistent() {
            return vec![];
        }
        let one_sided = self.topology().orientation().one_sided_faces();
        (0..one_sided.len() as u32).filter(|&f| one_sided[f as usize]).collect()
    }

    /// The faces to flip; `None` if all agree.
    pub(crate) fn flips(&self) -> Option<Vec<bool>> {
        if self.connectivity().is_consistent() {
            return None;
        }
        let flips = self.topology().orientation().majority_flips(|f| self.face_area(f));
        flips.contains(&true).then_some(flips)
    }

    /// The mesh with these faces flipped.
    pub(crate) fn turned(&self, flips: &[bool]) -> Self {
        let turn =
            |(&[a, b, c], &flip): (&[u32; 3], &bool)| if flip { [a, c, b] } else { [a, b, c] };
        let faces = self.faces().iter().zip(flips).map(turn).collect();
        Self::from_checked(self.positions().to_vec(), faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A band of `n` squares, each split into two triangles, with a number of half twists.
    fn band(n: u32, half_turns: u32) -> TriMesh {
        let at = |i: u32, j: u32| {
            let t = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            let (s, w) = (0.5 * f64::from(half_turns) * t, 0.5 * f64::from(j) - 0.25);
            let r = 1.0 + w * s.cos();
            [r * t.cos(), r * t.sin(), w * s.sin()]
        };
        let positions = (0..n).flat_map(|i| [at(i, 0), at(i, 1)]).collect();
        let faces = (0..n).flat_map(|i| {
            let twisted = i + 1 == n && half_turns % 2 == 1;
            let j = (i + 1) % n;
            let (c, d) = if twisted { (2 * j + 1, 2 * j) } else { (2 * j, 2 * j + 1) };
            [[2 * i, c, 2 * i + 1], [2 * i + 1, c, d]]
        });
        TriMesh::new(positions, faces.collect()).unwrap()
    }

    fn with_turned(mesh: &TriMesh, turned: impl Fn(usize) -> bool) -> TriMesh {
        let turn =
            |(f, &[a, b, c]): (usize, &[u32; 3])| if turned(f) { [b, a, c] } else { [a, b, c] };
        let faces = mesh.faces().iter().enumerate().map(turn).collect();
        TriMesh::new(mesh.positions().to_vec(), faces).unwrap()
    }

    #[test]
    fn the_larger_area_decides() {
        let mesh = band(12, 2);
        assert!(matches!(mesh.oriented(), Cow::Borrowed(_)));
        let few = with_turned(&mesh, |f| f % 3 == 1);
        let turned: Vec<u32> = (0..24).filter(|f| f % 3 == 1).collect();
        assert_eq!(few.turned_faces(), turned);
        assert!(few.oriented().topology().orientation().is_consistent());
        // One large face outweighs many small ones, even as the last one.
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -9.0, 0.0]];
        let large = TriMesh::new(corners, vec![[0, 2, 1], [1, 3, 0]]).unwrap();
        assert_eq!(large.turned_faces(), [] as [u32; 0]);
        let large = with_turned(&large, |f| f == 0);
        assert_eq!(large.turned_faces(), [0]);
    }

    /// Two faces with the same corners join the surfaces around them.
    #[test]
    fn a_face_that_occurs_twice_joins_its_surroundings() {
        let corner = |k: usize, x: f64| std::array::from_fn(|i| if i == k { x } else { 0.0 });
        let positions = (0..6).map(|v| corner(v / 2, [1.0, -1.0][v % 2])).collect();
        let half = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
        let faces = half.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, a, 5]]);
        let octahedron = TriMesh::new(positions, faces.collect()).unwrap();
        assert!(matches!(octahedron.oriented(), Cow::Borrowed(_)));
        let twice = [octahedron.faces(), &[octahedron.faces()[6]]].concat();
        let twice = TriMesh::new(octahedron.positions().to_vec(), twice).unwrap();
        for turned in [[0, 6], [0, 8]] {
            let mesh = with_turned(&twice, |f| turned.contains(&(f as u32)));
            assert_eq!(mesh.turned_faces(), turned);
        }
    }

    /// Three sheets at an edge are not joined: any pairing would be arbitrary.
    #[test]
    fn sheets_at_an_edge_stay_as_they_are() {
        let corners = (0..5).map(|i| [f64::from(i), f64::from(i * i), f64::from(i % 2)]).collect();
        let faces = vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]];
        let mesh = TriMesh::new(corners, faces).unwrap();
        assert!(matches!(mesh.oriented(), Cow::Borrowed(_)));
    }

    #[test]
    fn a_moebius_band_disagrees_along_one_cut() {
        for turned in [|_| false, |f| f % 3 == 0] {
            let mesh = with_turned(&band(20, 1), turned);
            assert_eq!(mesh.one_sided_faces().len(), 40);
            assert_eq!(mesh.turned_faces(), [] as [u32; 0]);
            // The edges across the band at one place.
            assert_eq!(mesh.oriented().topology().orientation().inconsistent_edges().len(), 1);
        }
        assert!(band(20, 2).one_sided_faces().is_empty());
    }
}
