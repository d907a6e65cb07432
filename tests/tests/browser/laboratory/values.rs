//! Values at vertices: shown, picked, and gone once their vertices have moved.

use std::path::Path;

use anyhow::{Result, ensure};
use fairing_mesh::TriMesh;
use fairing_mesh::io::VertexFields;
use fairing_shapes as shapes;
use serde_json::{Value, json};

use super::{drop_mesh, open, ply, quiet};
use crate::chrome::Chrome;

pub(super) fn fields(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let mesh = shapes::torus(1.0, 0.4, 40, 20);
    let heights: Vec<f64> = mesh.positions().iter().map(|p| p[2]).collect();
    let bytes = ply(&mesh, &VertexFields::default().with_scalar("height", heights))?;
    let found = chrome.run(&format!(
        "(async () => {{
           await drop('ring.ply', '{bytes}');
           const {{part}} = laboratory;
           const set = (name, value) => {{
             Object.assign(part[name], value);
             part[name].dispatchEvent(new Event('input'));
           }};
           const pictures = [seen().join()];
           const drawn = () => new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)));
           set('field', {{value: 'height'}});
           await drawn();
           const bars = [...document.querySelectorAll('.bar .count')].map((bar) => Number(bar.getAttribute('height')));
           for (const name of ['lines', 'wire', 'flat']) {{
             pictures.push(seen().join());
             set(name, {{checked: true}});
             await drawn();
           }}
           pictures.push(seen().join());
           return [laboratory.last.arrays.positions.length, part.info.textContent, bars, new Set(pictures).size,
             document.querySelector('.bar .name').textContent];
         }})()"
    ))?;
    ensure!(found[0] == 3 * mesh.vertex_count(), "{}", found[0]);
    ensure!(found[1].as_str().is_some_and(|t| t.contains("genus1")), "{}", found[1]);
    // A ring of twenty segments has eleven heights, of which the extreme ones occur half as often.
    let bars = found[2].as_array().into_iter().flatten().filter_map(Value::as_f64);
    let bars: Vec<f64> = bars.filter(|&height| height > 0.0).collect();
    ensure!(bars.len() == 11 && bars[0] == 12.0 && bars[5] == 24.0, "{bars:?}");
    ensure!(found[3] == 5, "{} pictures differ", found[3]);
    ensure!(found[4].as_str().is_some_and(|t| t.contains("height")), "{}", found[4]);
    chrome.picture("laboratory-field")?;
    quiet(chrome)
}

/// A ring and a face beside it, which the distances of the ring do not reach.
pub(super) fn undefined(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let ring = shapes::torus(1.0, 0.4, 40, 20);
    let n = ring.vertex_count() as u32;
    let corners = [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.0, 1.0, 0.0]];
    let positions = [ring.positions(), &corners].concat();
    let faces = [ring.faces(), &[[n, n + 1, n + 2]]].concat();
    drop_mesh(chrome, "parts.ply", &TriMesh::new(positions, faces)?)?;
    let found = chrome.run(
        "(async () => {
           task('distance', {sources: '0'});
           await press('run');
           const bar = () => document.querySelector('.bar svg').textContent;
           const words = [bar()];
           laboratory.forms.curvature.method = 'jet2';
           laboratory.forms.curvature.build();
           task('curvature');
           await press('run');
           words.push(bar());
           const kept = [...laboratory.last.fields.get('mean')].filter(Number.isFinite).length;
           return [words, kept];
         })()",
    )?;
    let words = |k: usize| found[0][k].as_str().unwrap_or_default();
    for (k, label) in
        ["geodesic distance (file units)", "mean curvature (1/file unit)"].iter().enumerate()
    {
        ensure!(words(k).contains(label) && words(k).contains("3 undefined"), "{found}");
    }
    ensure!(found[1] == n, "{found}");
    quiet(chrome)
}

pub(super) fn picks(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let place = chrome.run(
        "(async () => {
           await sample('sphere');
           task('curvature');
           await press('run');
           const canvas = document.querySelector('.panels canvas');
           canvas.scrollIntoView();
           const {left, top, width, height} = canvas.getBoundingClientRect();
           return [left + width / 2, top + height / 2];
         })()",
    )?;
    let [x, y] = [0, 1].map(|k| place[k].as_f64().unwrap_or_default());
    chrome.drag([x, y], [x, y])?;
    let words = chrome.run("laboratory.part.words.textContent")?;
    let words = words.as_str().unwrap_or_default();
    ensure!(words.starts_with("Vertex "), "{words}");
    let labels = ["mean curvature 1", "Gaussian curvature ", "curvature κ₁ ", "curvature κ₂ "];
    for name in labels {
        ensure!(words.contains(name), "no {name} in {words}");
    }
    // Keys pick the next one, and a picked vertex is the source of distances.
    let next = chrome.run(
        "(async () => {
           task('distance');
           const canvas = document.querySelector('.panels canvas');
           return await act(() => canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'n'})));
         })()",
    )?;
    ensure!(next != words, "{next}");
    let zero = chrome.run("laboratory.last.fields.get('distance')[laboratory.viewer.picked]")?;
    ensure!(zero.as_f64().is_some_and(|d| d.abs() < 1e-6), "{zero}");
    quiet(chrome)
}

/// A step that moves vertices computes the curvature that is shown again, or removes it if that
/// takes long, and removes distances: in the page and in the file.
pub(super) fn moves(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let found = chrome.run(
        "(async () => {
           await sample('torus');
           task('noise');
           await press('run');
           task('distance', {sources: '0'});
           await press('run');
           task('curvature');
           await press('run');
           const {part, viewer} = laboratory;
           const mean = () => laboratory.last.fields.get('mean');
           const before = mean();
           task('smooth');
           laboratory.curvature.took = 0;
           const words = [await press('run')];
           const after = mean();
           const {mesh, fields} = laboratory.last;
           const names = [...fields.keys()];
           await laboratory.client.call({verb: 'curvature', mesh, method: laboratory.forms.curvature.method});
           const fresh = await laboratory.client.field(mesh, 'mean');
           const same = [after.every((x, v) => x === fresh[v]), after.every((x, v) => x === before[v])];
           laboratory.curvature.took = Infinity;
           words.push(await press('add'));
           const made = [];
           URL.createObjectURL = (blob) => { made.push(blob); return 'data:,'; };
           HTMLAnchorElement.prototype.click = function () { made.push(this.download); };
           await press('download');
           const [blob, name] = made;
           const header = (await blob.text()).split('end_header')[0];
           const bars = document.querySelectorAll('.bar svg').length;
           await press('undo');
           return {words, names, same, left: [...laboratory.steps.at(-1).fields.keys()],
             name, header, bars, field: viewer.state.field};
         })()",
    )?;
    let words = |k: usize| found["words"][k].as_str().unwrap_or_default();
    ensure!(words(0).contains("Removed") && words(0).contains("geodesic distance"), "{found}");
    ensure!(!words(0).contains("mean curvature") && words(1).contains("mean curvature"), "{found}");
    let names = found["names"].to_string();
    ensure!(names.contains("kappa1") && !names.contains("distance"), "{found}");
    ensure!(found["same"] == json!([true, false]), "{found}");
    // The original keeps its colours; the result of the second step has no values.
    ensure!(found["bars"] == 1 && found["field"] == "mean", "{found}");
    let header = found["header"].as_str().unwrap_or_default();
    ensure!(found["name"] == "torus-fairing.ply" && header.starts_with("ply"), "{found}");
    ensure!(!header.contains("mean") && !header.contains("distance"), "{found}");
    ensure!(found["left"].to_string().contains("mean"), "{found}");
    quiet(chrome)
}

/// Fields of a file are values of the file, whatever their names; computed ones are not.
pub(super) fn provenance(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let mesh = shapes::torus(1.0, 0.4, 40, 20);
    let heights: Vec<f64> = mesh.positions().iter().map(|p| p[2]).collect();
    let fields = ["mean", "distance", "defined"].into_iter();
    let fields =
        fields.fold(VertexFields::default(), |all, name| all.with_scalar(name, heights.clone()));
    let found = chrome.run(&format!(
        "(async () => {{
           await drop('ring.ply', '{}');
           const {{part}} = laboratory;
           const names = () => [...laboratory.last.fields.keys()];
           const label = () => part.field.querySelector('[value=mean]').textContent;
           const all = [names(), label(), [...laboratory.last.fields.get('mean')]];
           task('smooth');
           all.push(await press('run'), names());
           task('distance', {{sources: '0'}});
           all.push(await press('run'), names());
           task('noise');
           all.push(await press('run'), names());
           return all;
         }})()",
        ply(&mesh, &fields)?
    ))?;
    let own = json!(["mean", "distance", "defined"]);
    ensure!(found[0] == own && found[1] == "mean", "{}, {}", found[0], found[1]);
    // A whole number comes back without its point.
    let values: Vec<f64> =
        found[2].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    ensure!(values == heights, "{}", found[2]);
    let words = |k: usize| found[k].as_str().unwrap_or_default();
    ensure!(!words(3).contains("Removed") && found[4] == own, "{}, {}", found[3], found[4]);
    ensure!(words(5).contains("Replaced fields of the file: distance."), "{}", found[5]);
    ensure!(words(7).contains("Removed") && words(7).contains("geodesic distance"), "{}", found[7]);
    ensure!(found[8] == json!(["mean", "defined"]), "{}", found[8]);
    quiet(chrome)
}
