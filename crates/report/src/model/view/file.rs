//! A view as a file, with every bit of its numbers.
//!
//! The length of a description (64 bits), the description as JSON, and the
//! arrays of each panel one after another: positions, faces, values, exact
//! values, live positions, modes; last, the true positions. Numbers are
//! little-endian.

use anyhow::{Context as _, Result, ensure};
use serde::{Deserialize, Serialize};

use super::View;

/// The view without its arrays, and how long they are.
#[derive(Serialize, Deserialize)]
struct Header {
    view: View,
    counts: Vec<Counts>,
    /// Vertices.
    truth: Option<usize>,
}

/// The lengths of the arrays of a panel.
#[derive(Serialize, Deserialize)]
struct Counts {
    /// Vertices at each stop.
    positions: Vec<usize>,
    faces: usize,
    /// Values at each stop, for each field.
    values: Vec<Vec<usize>>,
    /// Exact values, for each field.
    exact: Vec<Option<usize>>,
    /// Vertices.
    live: Option<usize>,
    /// Values of each mode.
    modes: Vec<usize>,
}

impl View {
    /// The contents of the file.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let counts = self.panels.iter().map(|panel| Counts {
            positions: panel.positions.iter().map(Vec::len).collect(),
            faces: panel.faces.len(),
            values: panel.fields.iter().map(|f| f.values.iter().map(Vec::len).collect()).collect(),
            exact: panel.fields.iter().map(|f| f.exact.as_ref().map(Vec::len)).collect(),
            live: panel.live.as_ref().map(Vec::len),
            modes: panel.modes.iter().flat_map(|m| m.vectors.iter().map(Vec::len)).collect(),
        });
        // Serialising leaves the arrays out.
        let description = serde_json::to_vec(&serde_json::json!({
            "view": self,
            "counts": counts.collect::<Vec<_>>(),
            "truth": self.truth.as_ref().map(Vec::len),
        }))?;
        let mut bytes = (description.len() as u64).to_le_bytes().to_vec();
        bytes.extend(description);
        for panel in &self.panels {
            panel.positions.iter().for_each(|p| doubles(&mut bytes, p.as_flattened()));
            bytes.extend(panel.faces.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
            let values = panel.fields.iter().flat_map(|f| &f.values);
            values.for_each(|v| doubles(&mut bytes, v));
            panel.fields.iter().flat_map(|f| &f.exact).for_each(|v| doubles(&mut bytes, v));
            panel.live.iter().for_each(|p| doubles(&mut bytes, p.as_flattened()));
            panel.modes.iter().flat_map(|m| &m.vectors).for_each(|v| doubles(&mut bytes, v));
        }
        self.truth.iter().for_each(|p| doubles(&mut bytes, p.as_flattened()));
        Ok(bytes)
    }

    /// Reads what [`Self::to_bytes`] has written.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        let mut rest = Rest(bytes);
        let length = u64::from_le_bytes(rest.array()?);
        let description = rest.take(usize::try_from(length)?)?;
        let Header { mut view, counts, truth } = serde_json::from_slice(description)?;
        ensure!(counts.len() == view.panels.len(), "{} counts of panels", counts.len());
        for (panel, counts) in view.panels.iter_mut().zip(counts) {
            panel.positions =
                counts.positions.into_iter().map(|n| rest.points(n)).collect::<Result<_>>()?;
            panel.faces = rest.faces(counts.faces)?;
            ensure!(counts.values.len() == panel.fields.len(), "fields of {}", panel.title);
            for (field, counts) in panel.fields.iter_mut().zip(counts.values) {
                field.values =
                    counts.into_iter().map(|n| rest.doubles(n)).collect::<Result<_>>()?;
            }
            ensure!(counts.exact.len() == panel.fields.len(), "fields of {}", panel.title);
            for (field, count) in panel.fields.iter_mut().zip(counts.exact) {
                field.exact = count.map(|n| rest.doubles(n)).transpose()?;
            }
            panel.live = counts.live.map(|n| rest.points(n)).transpose()?;
            if let Some(modes) = &mut panel.modes {
                modes.vectors =
                    counts.modes.into_iter().map(|n| rest.doubles(n)).collect::<Result<_>>()?;
            }
        }
        view.truth = truth.map(|n| rest.points(n)).transpose()?;
        ensure!(rest.0.is_empty(), "{} bytes are left over", rest.0.len());
        Ok(view)
    }
}

fn doubles(bytes: &mut Vec<u8>, values: &[f64]) {
    bytes.extend(values.iter().flat_map(|x| x.to_le_bytes()));
}

/// The bytes that have not been read.
struct Rest<'a>(&'a [u8]);

impl<'a> Rest<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count).context("the view ends too early")?;
        self.0 = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        Ok(self.take(N)?.try_into()?)
    }

    /// `count` times `N` bytes.
    fn chunks<const N: usize>(&mut self, count: usize) -> Result<&'a [[u8; N]]> {
        let size = count.checked_mul(N).context("the view ends too early")?;
        Ok(self.take(size)?.as_chunks().0)
    }

    fn doubles(&mut self, count: usize) -> Result<Vec<f64>> {
        Ok(self.chunks(count)?.iter().map(|b| f64::from_le_bytes(*b)).collect())
    }

    fn points(&mut self, count: usize) -> Result<Vec<[f64; 3]>> {
        let numbers = self.doubles(count.saturating_mul(3))?;
        Ok(numbers.as_chunks().0.to_vec())
    }

    fn faces(&mut self, count: usize) -> Result<Vec<[u32; 3]>> {
        let numbers = self.chunks(count.saturating_mul(3))?;
        let corners: Vec<u32> = numbers.iter().map(|b| u32::from_le_bytes(*b)).collect();
        Ok(corners.as_chunks().0.to_vec())
    }
}

#[cfg(test)]
mod tests {
    use fairing_mesh::TriMesh;

    use super::*;
    use crate::model::view::{Modes, Panel, Slider};

    fn sample() -> View {
        let positions = vec![[0.1, 0.0, 0.0], [1.0, 1e-300, 0.0], [0.0, 1.0, 1.0 / 3.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let moved = [[0.2; 3]; 3];
        let panel = Panel::moving("p", &mesh, [mesh.positions(), &moved])
            .with_field("f", "m", true, &[0.1, 2.0, f64::NAN])
            .undefined_at([2])
            .exactly(vec![0.3, 0.1, 1e300])
            .with_live_smoothing(&mesh)
            .with_fact("E_a", "°", vec![Some(0.1), None])
            .with_modes(Modes {
                values: vec![0.0, 0.7],
                coefficients: vec![[1.0, 2.0, 3.0], [0.1, 0.2, 0.3]],
                vectors: vec![vec![0.1; 3], vec![0.3, -0.1, 0.0]],
            });
        View {
            id: "v".into(),
            caption: String::new(),
            mesh: "m".into(),
            alt: String::new(),
            fallback: "f".into(),
            z_up: true,
            sliders: vec![Slider::new("k", [1, 2])],
            start: vec![1],
            color: Some("mean".into()),
            panels: vec![panel, Panel::still("q", &mesh)],
            from: Some(1),
            truth: Some(vec![[0.1, 0.2, 0.3]; 3]),
        }
    }

    #[test]
    fn every_bit_comes_back() {
        let view = sample();
        let bytes = view.to_bytes().unwrap();
        let back = View::from_bytes(&bytes).unwrap();
        assert_eq!(back.to_bytes().unwrap(), bytes);
        assert_eq!(back.panels[0].positions, view.panels[0].positions);
        assert_eq!(back.panels[0].fields[0].values[0][..2], [0.1, 2.0]);
        assert_eq!(back.panels[0].fields[0].exact, view.panels[0].fields[0].exact);
        assert_eq!(back.panels[0].modes, view.panels[0].modes);
        assert_eq!((&back.truth, back.from), (&view.truth, view.from));
        assert_eq!(back.panels[1], view.panels[1]);
    }

    #[test]
    fn a_file_that_is_cut_short_or_goes_on_is_refused() {
        let mut bytes = sample().to_bytes().unwrap();
        for cut in [0, 7, 20, bytes.len() - 1] {
            assert!(View::from_bytes(&bytes[..cut]).is_err(), "{cut} bytes");
        }
        bytes.push(0);
        assert!(View::from_bytes(&bytes).is_err());
    }
}
