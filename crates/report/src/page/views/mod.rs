//! The data of interactive views in the page: a description and compressed arrays.

mod frame;
mod pack;
mod script;

use crate::model::view::{Modes, Panel, View};
use anyhow::{Context as _, Result, ensure};
use fairing_figure::Occlusion;
use fairing_mesh::TriMesh;
use serde_json::{Value, json};

use frame::{Frame, reach};
use pack::{Pack, Quantiser};
pub(crate) use script::Packed;

/// Packs a view; `id` is unique on the page.
pub(crate) fn pack(view: &View, id: &str) -> Result<Packed> {
    let (about, data) = describe(view).with_context(|| format!("view {id}"))?;
    Ok(Packed { about, data })
}

/// The description and the packed data.
fn describe(view: &View) -> Result<(Value, String)> {
    ensure!(!view.panels.is_empty(), "there is no panel");
    for panel in &view.panels {
        check(panel, view.combinations()).with_context(|| format!("panel {}", panel.title))?;
        let truth = view.truth.iter().all(|truth| truth.len() == panel.positions[0].len());
        ensure!(truth, "panel {} has not as many vertices as the truth", panel.title);
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
    let describe = |(i, panel): (usize, &Panel)| {
        let faces = lists.iter().position(|l| *l == panel.faces).unwrap_or_default();
        describe_panel(panel, &view.panels[..i], faces, &frame, &mut pack)
    };
    let panels: Vec<Value> = view.panels.iter().enumerate().map(describe).collect::<Result<_>>()?;
    let truth = view.truth.as_ref().map(|truth| describe_truth(truth, view, &mut pack));
    let mut fields: Vec<Value> = Vec::new();
    for field in view.panels.iter().flat_map(|p| &p.fields) {
        if fields.iter().all(|known| known["name"] != field.name.as_str()) {
            let entry = json!({"name": field.name, "unit": field.unit, "signed": field.signed});
            fields.push(entry);
        }
    }
    let mut about = json!({
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
    begin(view, &mut about)?;
    if let Some(truth) = truth {
        about["truth"] = truth;
    }
    Ok((about, pack.finish()?))
}

/// The initial state of a view: the stops of its sliders, the reference of displacements, and its
/// colours.
fn begin(view: &View, about: &mut Value) -> Result<()> {
    if !view.start.is_empty() {
        let stops: Vec<usize> = view.sliders.iter().map(|slider| slider.stops.len()).collect();
        let fit =
            view.start.len() == stops.len() && view.start.iter().zip(&stops).all(|(a, b)| a < b);
        ensure!(fit, "sliders of {stops:?} stops cannot begin at {:?}", view.start);
        about["start"] = json!(view.start);
    }
    if let Some(from) = view.from {
        ensure!(
            from < view.panels.len(),
            "displacement counts from panel {from}, which is not there"
        );
        about["from"] = from.into();
    }
    if let Some(color) = &view.color {
        about["color"] = color.as_str().into();
    }
    Ok(())
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
        let exact = field.exact.iter().all(|exact| exact.len() == count);
        ensure!(exact, "{} has no exact value for each of {count} vertices", field.name);
    }
    for fact in &panel.facts {
        ensure!(
            fits(fact.values.len()),
            "{} of {stops} values of {}",
            fact.values.len(),
            fact.name
        );
    }
    if let Some(modes) = &panel.modes {
        let k = modes.vectors.len();
        let counts = [modes.values.len(), modes.coefficients.len()];
        ensure!(counts == [k; 2], "{k} modes with {counts:?} eigenvalues and coefficients");
        let whole = |mode: &Vec<f64>| mode.len() == count && mode.iter().all(|x| x.is_finite());
        let all = modes.vectors.iter().all(whole);
        ensure!(all, "a mode has no finite value for each of {count} vertices");
    }
    if let Some(input) = &panel.live {
        ensure!(input.len() == count, "the live input has {} of {count} vertices", input.len());
        ensure!(input.as_flattened().iter().all(|x| x.is_finite()), "the live input is not finite");
    }
    Ok(())
}

/// True positions: those of a panel that shows them, or of their own.
fn describe_truth(truth: &Vec<[f64; 3]>, view: &View, pack: &mut Pack) -> Value {
    for (i, panel) in view.panels.iter().enumerate() {
        if let Some(stop) = panel.positions.iter().position(|p| p == truth) {
            return json!({"panel": i, "stop": stop});
        }
    }
    let place = Frame::new(truth);
    pack.shorts(&truth.iter().map(|&p| place.code(p)).collect::<Vec<_>>());
    json!({"low": place.low, "size": place.size(), "vertices": truth.len()})
}

/// `before` are the panels to its left, whose positions are not stored again.
fn describe_panel(
    panel: &Panel,
    before: &[Panel],
    faces: usize,
    frame: &Frame,
    pack: &mut Pack,
) -> Result<Value> {
    let mut stops = Vec::new();
    let mut last: Option<Vec<[u16; 3]>> = None;
    for (s, positions) in panel.positions.iter().enumerate() {
        // A panel that only one of the sliders moves.
        if let Some(first) = panel.positions[..s].iter().position(|p| p == positions) {
            stops.push(json!({"same": first}));
            continue;
        }
        let known = |other: &Panel| other.positions.iter().position(|p| p == positions);
        if let Some((i, stop)) =
            before.iter().enumerate().find_map(|(i, other)| Some((i, known(other)?)))
        {
            stops.push(json!({"same": stop, "panel": i}));
            continue;
        }
        // A stop that leaves the common box by far, as unstable flows do, has
        // a box of its own and takes no precision from the others.
        let own = Frame::new(positions);
        let stray = !frame.nearly_holds(&own);
        let place = if stray { own } else { frame.enlarged() };
        let codes: Vec<[u16; 3]> = positions.iter().map(|&p| place.code(p)).collect();
        let follows = !stray && last.is_some();
        match &last {
            Some(last) if follows => {
                let step =
                    |(a, b): (&[u16; 3], &[u16; 3])| [0, 1, 2].map(|k| a[k].wrapping_sub(b[k]));
                pack.shorts(&codes.iter().zip(last).map(step).collect::<Vec<_>>());
            }
            _ => pack.shorts(&codes),
        }
        last = (!stray).then_some(codes);
        stops.push(json!({"low": place.low, "size": place.size(), "follows": follows}));
    }
    pack.raw(occlusion(panel)?);
    let fields = describe_fields(panel, pack);
    if let Some(input) = &panel.live {
        // Single precision takes half of the bytes, and is off by less than 10⁻⁷ of the size.
        let single = |p: &[f64; 3]| p.map(|x| f64::from(x as f32));
        pack.doubles(&input.iter().map(single).collect::<Vec<_>>());
    }
    let mut about = json!({
        "title": panel.title,
        "vertices": panel.positions[0].len(),
        "faces": faces,
        "stops": stops,
        "fields": fields,
        "live": panel.live.is_some(),
    });
    if let Some(modes) = &panel.modes {
        about["modes"] = describe_modes(modes, pack);
    }
    if !panel.facts.is_empty() {
        about["facts"] = json!(panel.facts);
    }
    Ok(about)
}

/// Each mode has 65535 steps from minus its largest size to plus.
fn describe_modes(modes: &Modes, pack: &mut Pack) -> Value {
    let mut sizes = vec![];
    for vector in &modes.vectors {
        let most = vector.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let size = if most > 0.0 { most } else { 1.0 };
        let code = |x: &f64| ((x / size + 1.0) * 32_767.0).round() as u16;
        pack.shorts(&vector.iter().map(|x| [code(x)]).collect::<Vec<_>>());
        sizes.push(size);
    }
    // More digits than the positions have.
    let brief = |x: f64| f64::from(x as f32);
    json!({
        "values": modes.values.iter().copied().map(brief).collect::<Vec<_>>(),
        "coefficients": modes.coefficients.iter().map(|c| c.map(brief)).collect::<Vec<_>>(),
        "sizes": sizes.into_iter().map(brief).collect::<Vec<_>>(),
    })
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
        let all = field.values.iter().chain(&field.exact);
        let all = all.flat_map(|v| v.iter().zip(&defined).map(value));
        let quantiser = Quantiser::fit(all);
        for values in field.values.iter().chain(&field.exact) {
            let codes = values.iter().zip(&defined).map(value).map(|x| [quantiser.code(x)]);
            pack.shorts(&codes.collect::<Vec<_>>());
        }
        fields.push(json!({
            "name": field.name,
            "unit": field.unit,
            "signed": field.signed,
            "stops": field.values.len(),
            "exact": field.exact.is_some(),
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
