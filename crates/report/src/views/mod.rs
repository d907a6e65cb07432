//! The data of interactive views as the page carries them: a description, and
//! arrays in few bytes.

mod pack;
mod script;

use anyhow::{Context as _, Result, ensure};
use fairing_figure::Occlusion;
use fairing_mesh::TriMesh;
use fairing_results::results::Form;
use fairing_results::view::{Panel, View};
use serde_json::{Value, json};

use pack::{Pack, Quantiser};
pub(crate) use script::Packed;

/// Packs a view; `id` is unique on the page. In a small report positions have
/// 12 bits instead of 16.
///
/// # Errors
///
/// If a panel is empty, has positions that are not finite, or values that do
/// not match its vertices.
pub(crate) fn pack(view: &View, id: &str, form: Form) -> Result<Packed> {
    let step = match form {
        Form::Whole => 1,
        Form::Small => 16,
    };
    let (about, data) = describe(view, step).with_context(|| format!("view {id}"))?;
    Ok(Packed { id: id.into(), about, data })
}

/// The description and the packed data.
fn describe(view: &View, step: u16) -> Result<(Value, String)> {
    ensure!(!view.panels.is_empty(), "there is no panel");
    for panel in &view.panels {
        check(panel, view.combinations()).with_context(|| format!("panel {}", panel.title))?;
    }
    let frame = Frame::around(&view.panels);
    let mut pack = Pack::default();
    let mut lists: Vec<&[[u32; 3]]> = Vec::new();
    for panel in &view.panels {
        if !lists.contains(&&panel.faces[..]) {
            lists.push(&panel.faces);
            pack.integers(panel.faces.as_flattened());
        }
    }
    let panels: Vec<Value> = view
        .panels
        .iter()
        .map(|panel| {
            let faces = lists.iter().position(|l| *l == panel.faces).unwrap_or_default();
            describe_panel(panel, faces, &frame, step, &mut pack)
        })
        .collect::<Result<_>>()?;
    let mut fields: Vec<Value> = Vec::new();
    for field in view.panels.iter().flat_map(|p| &p.fields) {
        if fields.iter().all(|known| known["name"] != field.name.as_str()) {
            let entry = json!({"name": field.name, "unit": field.unit, "signed": field.signed});
            fields.push(entry);
        }
    }
    let about = json!({
        "alt": view.alt,
        "zUp": view.z_up,
        "angles": frame.angles(view.z_up),
        "ball": {"center": frame.center(), "radius": reach(&view.panels, frame.center())},
        "flat": view.panels.iter().any(|p| p.positions.len() > 1),
        "sliders": view.sliders.iter().map(|slider| {
            json!({"name": slider.name, "stops": slider.stops})
        }).collect::<Vec<_>>(),
        "faceLists": lists.iter().map(|l| l.len()).collect::<Vec<_>>(),
        "fields": fields,
        "panels": panels,
    });
    Ok((about, pack.finish()?))
}

fn check(panel: &Panel, stops: usize) -> Result<()> {
    let count = panel.positions.first().context("there are no positions")?.len();
    ensure!(!panel.faces.is_empty(), "there are no faces");
    ensure!(
        panel.faces.as_flattened().iter().all(|&v| (v as usize) < count),
        "a face names a vertex beyond the {count} there are"
    );
    for (s, positions) in panel.positions.iter().enumerate() {
        ensure!(positions.len() == count, "stop {s} has {} of {count} vertices", positions.len());
        if let Some(v) = positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            anyhow::bail!("vertex {v} is at {:?} at stop {s}", positions[v]);
        }
    }
    let fits = |entries: usize| entries == 1 || entries == stops;
    ensure!(fits(panel.positions.len()), "{} positions for {stops} stops", panel.positions.len());
    for field in &panel.fields {
        ensure!(
            fits(field.values.len()),
            "{} has {} of {stops} stops",
            field.name,
            field.values.len()
        );
        for values in &field.values {
            ensure!(values.len() == count, "{} has {} of {count} values", field.name, values.len());
        }
    }
    if let Some(input) = &panel.live {
        ensure!(input.len() == count, "the live input has {} of {count} vertices", input.len());
        ensure!(input.as_flattened().iter().all(|x| x.is_finite()), "the live input is not finite");
    }
    Ok(())
}

fn describe_panel(
    panel: &Panel,
    faces: usize,
    frame: &Frame,
    step: u16,
    pack: &mut Pack,
) -> Result<Value> {
    let mut stops = Vec::new();
    let mut before: Option<Vec<[u16; 3]>> = None;
    for (s, positions) in panel.positions.iter().enumerate() {
        // A panel that only one of the sliders moves.
        if let Some(first) = panel.positions[..s].iter().position(|p| p == positions) {
            stops.push(json!({"same": first}));
            continue;
        }
        // A stop that leaves the common box by far, as unstable flows do, has
        // a box of its own and takes no precision from the others.
        let own = Frame::of(positions);
        let stray = !frame.nearly_holds(&own);
        let place = if stray { own } else { frame.enlarged() };
        let codes: Vec<[u16; 3]> = positions.iter().map(|&p| place.code(p, step)).collect();
        let follows = !stray && before.is_some();
        match &before {
            Some(last) if follows => {
                let step =
                    |(a, b): (&[u16; 3], &[u16; 3])| [0, 1, 2].map(|k| a[k].wrapping_sub(b[k]));
                pack.shorts(&codes.iter().zip(last).map(step).collect::<Vec<_>>());
            }
            _ => pack.shorts(&codes),
        }
        before = (!stray).then_some(codes);
        let size = [0, 1, 2].map(|k| place.high[k] - place.low[k]);
        stops.push(json!({"low": place.low, "size": size, "follows": follows}));
    }
    pack.raw(occlusion(panel)?);
    let fields = describe_fields(panel, pack);
    if let Some(input) = &panel.live {
        // In a small report single precision, which takes half of the bytes.
        let single = |p: &[f64; 3]| p.map(|x| f64::from(x as f32));
        match step {
            1 => pack.doubles(input),
            _ => pack.doubles(&input.iter().map(single).collect::<Vec<_>>()),
        }
    }
    Ok(json!({
        "title": panel.title,
        "vertices": panel.positions[0].len(),
        "faces": faces,
        "stops": stops,
        "fields": fields,
        "live": panel.live.is_some(),
    }))
}

/// Packs the fields of a panel.
fn describe_fields(panel: &Panel, pack: &mut Pack) -> Vec<Value> {
    let mut fields = Vec::new();
    for field in &panel.fields {
        let mut defined = vec![true; panel.positions[0].len()];
        for &v in &field.undefined {
            if let Some(d) = defined.get_mut(v as usize) {
                *d = false;
            }
        }
        let value = |(&x, &d): (&f64, &bool)| if d { x } else { f64::NAN };
        let all = field.values.iter().flat_map(|v| v.iter().zip(&defined).map(value));
        let quantiser = Quantiser::fit(all);
        for values in &field.values {
            let codes = values.iter().zip(&defined).map(value).map(|x| [quantiser.code(x)]);
            pack.shorts(&codes.collect::<Vec<_>>());
        }
        fields.push(json!({
            "name": field.name,
            "unit": field.unit,
            "signed": field.signed,
            "stops": field.values.len(),
            "scale": quantiser.scale,
            "low": quantiser.low,
            "high": quantiser.high,
        }));
    }
    fields
}

/// Occlusion for all stops, from the one with the least area: noise, which
/// only adds area, would cast shadows on every other. Stops that have shrunk
/// to less than half of the largest area do not count.
fn occlusion(panel: &Panel) -> Result<Vec<u8>> {
    let meshes: Vec<TriMesh> = panel
        .positions
        .iter()
        .map(|p| Ok(TriMesh::new(p.clone(), panel.faces.clone())?))
        .collect::<Result<_>>()?;
    let areas: Vec<f64> =
        meshes.iter().map(|m| (0..m.face_count()).map(|f| m.face_area(f)).sum()).collect();
    // Diverged stops have huge areas: the middle one is the measure.
    let mut sorted = areas.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let least = 0.5 * sorted[(sorted.len() - 1) / 2];
    let smoothest = (0..areas.len())
        .filter(|&s| areas[s] >= least)
        .min_by(|&a, &b| areas[a].total_cmp(&areas[b]))
        .unwrap_or(0);
    let baked = Occlusion::bake(&meshes[smoothest]);
    Ok(baked.front().iter().map(|x| (x * 255.0).round() as u8).collect())
}

/// The largest distance from `center` at the first stops; 1 if it is zero.
fn reach(panels: &[Panel], center: [f64; 3]) -> f64 {
    let distance = |p: &[f64; 3]| fairing_mesh::vec3::distance(*p, center);
    let far = panels.iter().flat_map(|p| &p.positions[0]).map(distance).fold(0.0, f64::max);
    if far > 0.0 { far } else { 1.0 }
}

/// A box around positions.
#[derive(Debug, Clone, Copy)]
struct Frame {
    low: [f64; 3],
    high: [f64; 3],
}

impl Frame {
    fn of(positions: &[[f64; 3]]) -> Self {
        let empty = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        positions.iter().fold(empty, |frame, p| Self {
            low: [0, 1, 2].map(|k| p[k].min(frame.low[k])),
            high: [0, 1, 2].map(|k| p[k].max(frame.high[k])),
        })
    }

    /// The box of all panels at their first stops: what the camera looks at.
    fn around(panels: &[Panel]) -> Self {
        let boxes = panels.iter().map(|p| Self::of(&p.positions[0]));
        boxes
            .reduce(|a, b| Self {
                low: [0, 1, 2].map(|k| a.low[k].min(b.low[k])),
                high: [0, 1, 2].map(|k| a.high[k].max(b.high[k])),
            })
            .unwrap_or(Self { low: [0.0; 3], high: [0.0; 3] })
    }

    fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| 0.5 * (self.low[k] + self.high[k]))
    }

    /// Half the diagonal; 1 for a point.
    fn radius(&self) -> f64 {
        let diagonal = fairing_mesh::vec3::distance(self.low, self.high);
        if diagonal > 0.0 { 0.5 * diagonal } else { 1.0 }
    }

    /// The same with a margin of half the radius.
    fn enlarged(&self) -> Self {
        let margin = 0.5 * self.radius();
        Self { low: self.low.map(|x| x - margin), high: self.high.map(|x| x + margin) }
    }

    fn nearly_holds(&self, other: &Self) -> bool {
        let own = self.enlarged();
        (0..3).all(|k| own.low[k] <= other.low[k] && other.high[k] <= own.high[k])
    }

    /// Where in the box, in 65535ths, to the next multiple of `step`.
    fn code(&self, p: [f64; 3], step: u16) -> [u16; 3] {
        let (step, last) = (f64::from(step), f64::from(u16::MAX));
        [0, 1, 2].map(|k| {
            let size = self.high[k] - self.low[k];
            let t = if size > 0.0 { (p[k] - self.low[k]) / size } else { 0.0 };
            (step * (t * last / step).round()).min(last) as u16
        })
    }

    /// Azimuth and elevation at which the view begins, in degrees: what is
    /// nearly flat is seen almost face on, everything else a little from the
    /// side and above.
    fn angles(&self, z_up: bool) -> [f64; 2] {
        // Sideways, up, towards the camera.
        let axes = if z_up { [0, 2, 1] } else { [0, 1, 2] };
        let size = axes.map(|k| self.high[k] - self.low[k]);
        let thin = 0.1 * self.radius();
        match size.iter().position(|&s| s < thin) {
            Some(0) => [70.0, 15.0],
            Some(1) => [20.0, 65.0],
            Some(_) => [20.0, 20.0],
            None => [30.0, 20.0],
        }
    }
}
