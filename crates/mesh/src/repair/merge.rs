//! Vertices at one position, and faces that agree.

use std::collections::HashMap;

use fairing_watch as watch;
use fairing_watch::parallel;
use rayon::prelude::*;

use super::copies::without_copies;
use super::rounding::within;
use super::{RepairOptions, RepairStep, Tolerance, Work, rounding, split};
use crate::trimesh::TriMesh;
use crate::weld::places_of;

impl Work {
    /// Merges vertices, drops faces that collapse or occur twice, turns faces that disagree, and
    /// separates sheets.
    ///
    /// One step, because merging joins what splitting has separated: only the outcome is noted. A
    /// sheet takes the first of the vertices that it had before, so that sheets which are separate
    /// stay as they are.
    pub(super) fn sew(&mut self, options: &RepairOptions) {
        let places = self.places(options);
        let place = |v: u32| places[v as usize];
        let faces = self.mesh.faces();
        let joined = parallel::map(faces.len(), 4096, |f| faces[f].map(place));
        let whole = parallel::map(joined.len(), 4096, |i| {
            let [a, b, c] = joined[i];
            a != b && b != c && c != a
        });
        let mut keep: Vec<bool> = whole;
        let mut corners = super::kept(self.mesh.faces(), &keep);
        let mut joined = super::kept(&joined, &keep);
        self.keep_faces(RepairStep::CollapsedFaces, &keep);
        if options.duplicates {
            keep = without_copies(&joined);
            corners = super::kept(&corners, &keep);
            joined = super::kept(&joined, &keep);
            self.keep_faces(RepairStep::DuplicateFaces, &keep);
        }
        watch::check();
        let mut surface = TriMesh::from_checked(self.mesh.positions().to_vec(), joined);
        if options.orient
            && let Some(flips) = surface.flips()
        {
            for (f, _) in flips.iter().enumerate().filter(|(_, flip)| **flip) {
                corners[f].swap(1, 2);
                self.turned[f] ^= true;
            }
            surface = surface.turned(&flips);
        }
        watch::check();
        let sheets = if options.split { split::sheets(&surface) } else { surface.faces().to_vec() };
        self.renumber(&places, &corners, &sheets);
    }

    /// The first vertex at the place of each vertex.
    pub(super) fn places(&self, options: &RepairOptions) -> Vec<u32> {
        let positions = self.mesh.positions();
        if !options.merge {
            return (0..positions.len() as u32).collect();
        }
        match options.tolerance {
            Tolerance::Rounding => rounding::places(&self.mesh, self.distance),
            _ if self.distance > 0.0 => {
                let all: Vec<u32> = (0..positions.len() as u32).collect();
                within(positions, &all, self.distance, |_| self.distance)
            }
            _ => places_of(positions),
        }
    }

    /// Gives each sheet the first of its vertices that no earlier sheet has, or a new one.
    fn renumber(&mut self, places: &[u32], corners: &[[u32; 3]], sheets: &[[u32; 3]]) {
        let mut members: Vec<(u32, u32)> = sheets
            .as_flattened()
            .iter()
            .copied()
            .zip(corners.as_flattened().iter().copied())
            .collect();
        members.par_sort_unstable();
        members.dedup();
        // Sheets in the order of their first vertices.
        let mut groups: Vec<&[(u32, u32)]> = members.chunk_by(|x, y| x.0 == y.0).collect();
        groups.sort_by_key(|group| group[0].1);

        let mut positions = self.mesh.positions().to_vec();
        let mut taken = vec![false; positions.len()];
        let mut used = taken.clone();
        members.iter().for_each(|&(_, v)| used[v as usize] = true);
        let mut vertex_of = HashMap::with_capacity(groups.len());
        let mut copied = vec![];
        for group in groups {
            let (sheet, first) = group[0];
            let free = group.iter().find(|(_, v)| !taken[*v as usize]);
            let place = positions[places[first as usize] as usize];
            let vertex = match free {
                Some(&(_, v)) => v,
                None => {
                    copied.push(self.vertex_sources[first as usize]);
                    self.vertex_sources.push(self.vertex_sources[first as usize]);
                    positions.push(place);
                    taken.push(false);
                    taken.len() as u32 - 1
                }
            };
            taken[vertex as usize] = true;
            // −0 and 0 are one place.
            if positions[vertex as usize] != place {
                positions[vertex as usize] = place;
            }
            vertex_of.insert(sheet, vertex);
        }
        let faces: Vec<[u32; 3]> = sheets.iter().map(|face| face.map(|s| vertex_of[&s])).collect();
        let stays = |v: usize| match used.get(v) {
            Some(true) => taken[v],
            Some(false) => places[v] as usize == v,
            None => true,
        };
        let keep: Vec<bool> = (0..taken.len()).map(stays).collect();
        self.note(RepairStep::SplitVertices, copied);
        self.note_merged(places, corners, &faces, &used, &keep);
        self.mesh = TriMesh::from_checked(positions, faces);
        if keep.contains(&false) {
            self.keep_vertices(&keep);
        }
    }

    /// Notes the vertices that are not kept, with those that have taken their corners or, without a
    /// face, their place.
    fn note_merged(
        &mut self,
        places: &[u32],
        corners: &[[u32; 3]],
        faces: &[[u32; 3]],
        used: &[bool],
        keep: &[bool],
    ) {
        let mut merged = vec![];
        for (&v, &w) in corners.as_flattened().iter().zip(faces.as_flattened()) {
            if !keep[v as usize] {
                merged.push((v, w));
            }
        }
        merged.extend(
            (0..used.len()).filter(|&v| !keep[v] && !used[v]).map(|v| (v as u32, places[v])),
        );
        merged.sort_unstable();
        merged.dedup_by_key(|(v, _)| *v);
        for (v, into) in merged {
            let [v, into] = [v, into].map(|v| self.vertex_sources[v as usize]);
            self.note(RepairStep::MergedVertices, [v]);
            self.merged_into.extend(v.zip(into));
        }
    }
}
