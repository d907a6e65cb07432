//! Views as the page reads them.

use std::collections::HashMap;
use std::io::Write as _;

use anyhow::{Context as _, Result, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Value, json};

use super::{Field, Modes, Panel, View};

/// Bits of a displacement beside the extent of its mesh.
const BITS: f64 = 14.0;

impl View {
    /// The view as JSON for the page, which `crates/report/assets/view.mjs` reads.
    ///
    /// Where the view has an array of numbers, the JSON has its index in `arrays`: a text in
    /// base64, compressed by gzip, of little-endian numbers, `u32` for faces and `f32` for all
    /// others, NaN for an undefined value. Equal arrays are stored once. The second and later
    /// positions of a panel are displacements from the first ones, rounded to 2⁻¹⁴ of the extent of
    /// the mesh.
    ///
    /// # Errors
    ///
    /// If counts do not fit together, a face has a vertex that is not there, or a position or a
    /// mode is not finite.
    pub fn to_json(&self) -> Result<String> {
        self.describe().with_context(|| format!("view {}", self.id))
    }

    fn describe(&self) -> Result<String> {
        let Self { sliders, start, panels, from, .. } = self;
        let counts: Vec<usize> = sliders.iter().map(|slider| slider.stops.len()).collect();
        let starts = start.len() == counts.len() && start.iter().zip(&counts).all(|(a, b)| a < b);
        ensure!(
            start.is_empty() || starts,
            "sliders of {counts:?} stops cannot begin at {start:?}"
        );
        ensure!(
            from.is_none_or(|from| from < panels.len()),
            "displacement counts from panel {from:?} of {}",
            panels.len()
        );
        let stops = counts.iter().product();
        let mut arrays = Arrays::default();
        let mut described = vec![];
        for panel in panels {
            described.push(arrays.panel(panel, stops).with_context(|| panel.title.clone())?);
            let fits = self.truth.iter().all(|truth| truth.len() == panel.positions[0].len());
            ensure!(fits, "{} has not as many vertices as the truth", panel.title);
        }
        ensure!(!panels.is_empty(), "there is no panel");
        let truth = self.truth.as_ref().map(|truth| arrays.points(truth, truth.len()));
        let view = json!({
            "alt": self.alt,
            "zUp": self.z_up,
            "sliders": sliders,
            "start": start,
            "color": self.color,
            "from": from,
            "truth": truth.transpose().context("truth")?,
            "panels": described,
            "arrays": arrays.texts,
        });
        Ok(view.to_string())
    }
}

/// Different arrays of a view.
#[derive(Default)]
struct Arrays {
    texts: Vec<String>,
    known: HashMap<Vec<u8>, usize>,
}

impl Arrays {
    /// The index of an array.
    fn add(&mut self, bytes: Vec<u8>) -> Result<usize> {
        if let Some(&index) = self.known.get(&bytes) {
            return Ok(index);
        }
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(&bytes)?;
        self.texts.push(BASE64.encode(encoder.finish()?));
        self.known.insert(bytes, self.texts.len() - 1);
        Ok(self.texts.len() - 1)
    }

    /// `count` values.
    fn floats(&mut self, values: &[f64], count: usize) -> Result<usize> {
        ensure!(values.len() == count, "{} values instead of {count}", values.len());
        self.add(values.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect())
    }

    /// `count` points, all of them finite in single precision.
    fn points(&mut self, points: &[[f64; 3]], count: usize) -> Result<usize> {
        let bad = points.iter().position(|p| !p.iter().all(|&x| (x as f32).is_finite()));
        if let Some(v) = bad {
            anyhow::bail!("vertex {v} is at {:?}", points[v]);
        }
        self.floats(points.as_flattened(), 3 * count)
    }

    fn panel(&mut self, panel: &Panel, stops: usize) -> Result<Value> {
        let Panel { title, positions, faces, fields, live, modes, facts } = panel;
        let count = positions.first().context("there are no positions")?.len();
        ensure!(!faces.is_empty(), "there are no faces");
        let corners = faces.as_flattened();
        let beyond = corners.iter().find(|&&v| v as usize >= count);
        ensure!(beyond.is_none(), "a face names vertex {beyond:?} of {count}");
        let entries = [("positions", positions.len())]
            .into_iter()
            .chain(fields.iter().map(|f| (&f.name[..], f.values.len())))
            .chain(facts.iter().map(|f| (&f.name[..], f.values.len())));
        for (name, length) in entries {
            ensure!(length == 1 || length == stops, "{name}: {length} entries for {stops} stops");
        }
        let describe = |field: &Field| self.field(field, count).context(field.name.clone());
        let fields = fields.iter().map(describe).collect::<Result<Vec<_>>>()?;
        let modes = modes.as_ref().map(|modes| self.modes(modes, count)).transpose()?;
        Ok(json!({
            "title": title,
            "vertices": count,
            "faces": self.add(corners.iter().flat_map(|v| v.to_le_bytes()).collect())?,
            "positions": self.positions(positions, count)?,
            "fields": fields,
            "live": live,
            "modes": modes,
            "facts": facts,
        }))
    }

    fn positions(&mut self, stops: &[Vec<[f64; 3]>], count: usize) -> Result<Vec<usize>> {
        let first = &stops[0];
        let mut indices = vec![self.points(first, count).context("stop 0")?];
        let step = step(first);
        let round = |x: f64, from: f64| ((x - from) / step).round() * step;
        for (k, stop) in stops.iter().enumerate().skip(1) {
            ensure!(stop.len() == count, "stop {k} has {} of {count} vertices", stop.len());
            let moved = stop.iter().zip(first);
            let moved = moved.map(|(p, from)| [0, 1, 2].map(|k| round(p[k], from[k])));
            let moved: Vec<[f64; 3]> = moved.collect();
            indices.push(self.points(&moved, count).with_context(|| format!("stop {k}"))?);
        }
        Ok(indices)
    }

    fn field(&mut self, field: &Field, count: usize) -> Result<Value> {
        let Field { name, unit, signed, values, undefined, exact } = field;
        let mut add = |values: &Vec<f64>| {
            let mut values = values.clone();
            for &v in undefined {
                *values.get_mut(v as usize).context("an undefined vertex is not there")? = f64::NAN;
            }
            self.floats(&values, count)
        };
        let values = values.iter().map(&mut add).collect::<Result<Vec<_>>>()?;
        let exact = exact.as_ref().map(add).transpose()?;
        Ok(json!({"name": name, "unit": unit, "signed": signed, "values": values, "exact": exact}))
    }

    fn modes(&mut self, modes: &Modes, count: usize) -> Result<Value> {
        let Modes { values, coefficients, vectors } = modes;
        let counts = [values.len(), coefficients.len(), vectors.len()];
        ensure!(counts == [counts[0]; 3], "eigenvalues, coefficients and modes: {counts:?}");
        let finite = vectors.iter().flatten().all(|x| x.is_finite());
        ensure!(finite, "a mode has a value that is not finite");
        let vectors = vectors.iter().map(|vector| self.floats(vector, count));
        let vectors = vectors.collect::<Result<Vec<_>>>()?;
        Ok(json!({"values": values, "coefficients": coefficients, "vectors": vectors}))
    }
}

/// The power of two that is [`BITS`] bits below the extent of a mesh; 1 for a point.
fn step(positions: &[[f64; 3]]) -> f64 {
    let size = |k: usize| {
        let coordinates = positions.iter().map(|p| p[k]);
        let ends = coordinates.fold([f64::MAX, f64::MIN], |[a, b], x| [a.min(x), b.max(x)]);
        ends[1] - ends[0]
    };
    let extent = [0, 1, 2].map(size).into_iter().fold(0.0, f64::max);
    if extent > 0.0 { libm::exp2(libm::floor(libm::log2(extent)) - BITS) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use fairing_mesh::TriMesh;
    use flate2::read::GzDecoder;

    use super::*;
    use crate::model::view::Slider;

    fn sample() -> View {
        let positions = vec![[0.1, 0.0, 0.0], [1.0, 1e-30, 0.0], [0.0, 1.0, 1.0 / 3.0]];
        let mesh = TriMesh::new(positions, vec![[0, 1, 2]]).unwrap();
        let moved = [[0.2; 3]; 3];
        let panel = Panel::moving("p", &mesh, [mesh.positions(), &moved])
            .with_field("f", "m", true, &[0.1, 2.0, 5.0])
            .undefined_at([2])
            .exactly(vec![0.3, 0.1, 1e30])
            .with_fact("E_a", "°", vec![Some(0.1), None])
            .with_modes(Modes {
                values: vec![0.0, 0.7],
                coefficients: vec![[1.0, 2.0, 3.0], [0.1, 0.2, 0.3]],
                vectors: vec![vec![0.1; 3], vec![0.3, -0.1, 0.0]],
            });
        View {
            sliders: vec![Slider::new("k", [1, 2])],
            start: vec![1],
            truth: Some(mesh.positions().to_vec()),
            panels: vec![panel, Panel::still("q", &mesh)],
            from: Some(1),
            ..View::default()
        }
    }

    fn numbers(view: &Value, index: &Value) -> Vec<f32> {
        let text = view["arrays"][index.as_u64().unwrap() as usize].as_str().unwrap();
        let mut bytes = vec![];
        GzDecoder::new(&BASE64.decode(text).unwrap()[..]).read_to_end(&mut bytes).unwrap();
        bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect()
    }

    #[test]
    fn arrays_are_single_precision_and_stored_once() {
        let view: Value = serde_json::from_str(&sample().to_json().unwrap()).unwrap();
        let panels = &view["panels"];
        let first = &panels[0]["positions"][0];
        assert_eq!(numbers(&view, first)[8], 1.0 / 3.0);
        assert_eq!([first; 2], [&panels[1]["positions"][0], &view["truth"]]);
        assert_eq!(panels[0]["faces"], panels[1]["faces"]);
        let moved = numbers(&view, &panels[0]["positions"][1]);
        assert!((moved[0] - 0.1).abs() < 4e-5 && (moved[0] * 16_384.0).fract() == 0.0, "{moved:?}");
        let values = numbers(&view, &panels[0]["fields"][0]["values"][0]);
        assert!(values[..2] == [0.1, 2.0] && values[2].is_nan(), "{values:?}");
        assert_eq!(numbers(&view, &panels[0]["modes"]["vectors"][1]), [0.3, -0.1, 0.0]);
    }

    #[test]
    fn views_that_do_not_fit_together_are_refused() {
        let refused = |change: fn(&mut View)| {
            let mut view = sample();
            change(&mut view);
            format!("{:#}", view.to_json().unwrap_err())
        };
        let errors = [
            refused(|view| view.start = vec![2]),
            refused(|view| view.from = Some(2)),
            refused(|view| view.panels[0].positions[1][2][0] = 1e300),
            refused(|view| _ = view.panels[0].positions[1].pop()),
            refused(|view| view.panels[1].faces[0][1] = 3),
            refused(|view| view.truth = Some(vec![])),
        ];
        for (error, words) in errors.iter().zip(["[2]", "Some(2)", "1e300", "2 of 3", "3", "truth"])
        {
            assert!(error.contains(words), "{error}");
        }
    }
}
