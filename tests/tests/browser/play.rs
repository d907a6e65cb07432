//! Playgrounds and computations of views, compared with the library.

use std::path::Path;
use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use fairing_denoising::{BilateralNormalOptions, bilateral_normal};
use fairing_evaluation::{drift, feature_edges, normal_error};
use fairing_mesh::TriMesh;
use fairing_operators::LumpedArea;
use fairing_operators::curvature::{angle_defect, gaussian_curvature, mean_curvature};
use fairing_operators::surface::{Ellipsoid, ParametricSurface as _};
use fairing_smoothing::{
    Diffusion, Explicit, Implicit, Stability, explicit, implicit, largest_eigenvalue,
};
use serde_json::{Value, json};

use crate::chrome::Chrome;
use crate::{Test, scene};

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("the_ellipsoid_has_its_normal_curvature", ellipsoid),
        ("diffusion_goes_through_four_thirds", diffusion),
        ("noise_counts_the_errors_of_known_curvature", noise),
        ("denoising_counts_what_the_library_measures", denoising),
        ("modes_are_summed_continuously", modes),
        ("facts_follow_the_sliders", facts),
        ("views_are_coloured_by_what_they_compute", derived),
        ("picking_shows_exact_value_estimate_and_error", exact),
        ("a_claim_opens_the_view_that_decides_it", claims),
        ("points_of_plots_move_their_view", points),
        ("playgrounds_work_without_webgl_and_by_keyboard", plain),
    ]
}

/// Opens the page at this view or playground.
fn open(chrome: &mut Chrome, page: &Path, id: &str) -> Result<()> {
    chrome.open(&format!("file://{}", page.display()))?;
    chrome.run(&format!("fairing.views.get('{id}').figure.scrollIntoView()"))?;
    chrome.run(&format!("(async () => fairing.views.get('{id}').open())()"))?;
    Ok(())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// A mesh of the page.
fn mesh(value: &Value) -> Result<TriMesh> {
    let positions = numbers(&value[0]);
    let faces: Vec<u32> = numbers(&value[1]).into_iter().map(|v| v as u32).collect();
    ensure!(!faces.is_empty(), "no mesh came back");
    Ok(TriMesh::new(positions.as_chunks().0.to_vec(), faces.as_chunks().0.to_vec())?)
}

/// The largest difference, relative to the largest expected value.
fn gap(found: &[f64], expected: &[f64]) -> f64 {
    let most = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if found.len() == expected.len() { off / most } else { f64::INFINITY }
}

/// Our curvature is that of the closed forms, the original report's that of its coefficients.
#[expect(clippy::disallowed_methods, reason = "tests do not need the same bits")]
fn ellipsoid(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "play-ellipsoid")?;
    let set = |a: f64, b: f64, c: f64, degrees: f64| {
        format!(
            "(async () => {{
               const p = fairing.views.get('play-ellipsoid');
               await p.fromText('{a}~{b}~{c}~{degrees}');
               const {{exact, source}} = p.curvatures({degrees} * Math.PI / 180);
               const d = p.solid.target.getImageData(0, 0, p.solid.canvas.width, p.solid.canvas.height).data;
               let blue = 0;
               for (let i = 0; i < d.length; i += 4) if (d[i + 3] > 128 && d[i + 2] > d[i] + 60) blue += 1;
               return [exact, source, p.result.textContent, blue, p.plots.querySelectorAll('path.curve').length];
             }})()"
        )
    };
    for (a, b, c, degrees) in [(2.0, 1.0, 0.7, 0.0), (1.2, 1.6, 0.8, 35.0), (0.5, 2.0, 1.5, 90.0)] {
        let found = chrome.run(&set(a, b, c, degrees))?;
        let theta = f64::to_radians(degrees);
        let forms = Ellipsoid { a, b, c }.forms(0.0, std::f64::consts::FRAC_PI_2)?;
        let (sin, cos) = theta.sin_cos();
        let kappa = forms.normal_curvature([cos / b, -sin / c]);
        let kappa = kappa.context("no direction")?;
        let source = -cos * cos / c;
        ensure!(
            found[0].as_f64().is_some_and(|k| (k / kappa - 1.0).abs() < 1e-12),
            "{found}, {kappa}"
        );
        ensure!(found[1].as_f64().is_some_and(|k| (k - source).abs() < 1e-12), "{found}, {source}");
        ensure!(found[3].as_f64().is_some_and(|n| n > 50.0), "no circle is drawn: {found}");
        let curves = if source.abs() > 0.02 { 5.0 } else { 4.0 };
        ensure!(found[4] == curves, "{found}");
    }
    let sphere = chrome.run(&set(1.0, 1.0, 1.0, 0.0))?;
    ensure!(sphere[2].as_str().is_some_and(|w| w.contains("the same size")), "{sphere}");
    chrome.picture("ellipsoid")
}

/// The module takes the steps of the sliders. The mesh attains the bound of closed meshes, −3/2.
fn diffusion(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "play-diffusion")?;
    let input = chrome.run(
        "(() => { const p = fairing.views.get('play-diffusion'); return [[...p.positions], [...p.faces]]; })()",
    )?;
    let input = mesh(&input)?;
    let mu = chrome.number("fairing.views.get('play-diffusion').roughest")?;
    let known = -largest_eigenvalue(&input, Diffusion::uniform(1.0))?;
    ensure!((mu + 1.5).abs() < 1e-12 && (known - mu).abs() < 1e-3, "{mu}, {known}");
    for (lambda, count) in [(0.5, 20), (1.45, 12), (2.0, 6)] {
        let found = chrome.run(&format!(
            "(async () => {{
               const p = fairing.views.get('play-diffusion');
               await p.fromText('{lambda}~{count}');
               const {{explicit, implicit}} = p.now.results;
               return [[...explicit], [...implicit], p.result.textContent];
             }})()"
        ))?;
        let diffusion = Diffusion::uniform(lambda);
        let stability = Stability::Allow;
        let options = Explicit { iterations: count, stability, ..Explicit::new(diffusion) };
        let one = explicit(&input, &options, None)?.mesh;
        let options = Implicit { iterations: count, ..Implicit::new(diffusion) };
        let other = implicit(&input, &options, None)?.mesh;
        for (k, expected) in [one, other].iter().enumerate() {
            let off = gap(&numbers(&found[k]), expected.positions().as_flattened());
            ensure!(off < 1e-9, "λ = {lambda}, {count} steps, flow {k}: off by {off:e}");
        }
        let words = found[2].as_str().unwrap_or_default();
        let expected = if lambda > 4.0 / 3.0 { "beyond the limit" } else { "below the limit" };
        ensure!(words.contains(expected), "{words}");
        ensure!(words.contains("no mesh is safe") == (lambda >= 2.0), "{words}");
    }
    chrome.picture("diffusion")
}

/// The curvature of the page equals that of the library, and noise affects K more than H.
fn noise(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "play-noise")?;
    for (surface, euler) in [("torus", 0.0), ("sphere", 2.0)] {
        let found = chrome.run(&format!(
            "(async () => {{
               const p = fairing.views.get('play-noise');
               await p.fromText('0.1~8~{surface}~error');
               const n = p.now;
               return [[...n.positions], [...p.mesh.faces], [...n.mean], [...n.gaussian], n.total,
                 p.errors(n), p.result.textContent];
             }})()"
        ))?;
        let noisy = mesh(&found)?;
        let mean = mean_curvature(&noisy, LumpedArea::Mixed)?.signed;
        let gaussian = gaussian_curvature(&noisy, LumpedArea::Mixed)?.values;
        for (k, expected) in [(2, mean), (3, gaussian)] {
            let off = gap(&numbers(&found[k]), &expected);
            ensure!(off < 1e-9, "{surface}, field {k}: off by {off:e}");
        }
        let total: f64 = angle_defect(&noisy).iter().sum();
        ensure!(found[4].as_f64().is_some_and(|t| (t - total).abs() < 1e-9), "{total}");
        ensure!((total - std::f64::consts::TAU * euler).abs() < 1e-9, "{total}");
        let errors = numbers(&found[5]);
        ensure!(errors[1] > errors[0] && errors[0] > 0.05, "{errors:?}");
        ensure!(found[6].as_str().is_some_and(|w| w.contains("times as much")), "{}", found[6]);
    }
    let words = chrome.run(
        "(() => { const p = fairing.views.get('play-noise'); p.step(p.shown[0], 1); return p.words.textContent; })()",
    )?;
    let words = words.as_str().unwrap_or_default();
    ensure!(["exact", "estimate", "error"].iter().all(|w| words.contains(w)), "{words}");
    chrome.picture("noise")
}

/// Both methods and all scores equal those of the library for the same noise: positions to 10⁻⁹ of
/// the size of the part, angles to 10⁻⁶ degrees, volumes to 10⁻⁹ per cent, creases to one.
fn denoising(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "play-denoising")?;
    for (sigma, steps, rounds) in [(0.0, 0, 20), (0.2, 8, 20), (0.45, 3, 7)] {
        let found = chrome.run(&format!(
            "(async () => {{
               const p = fairing.views.get('play-denoising');
               const start = performance.now();
               await p.fromText('{sigma}~{steps}~{rounds}');
               const time = performance.now() - start;
               const scores = p.now.found.map((s) => [s.angle, s.volume, s.creases]);
               const words = [...p.figure.querySelectorAll('.facts-line')].map((f) => f.textContent);
               return [[[...p.truth], [...p.faces]], p.now.found.map((x) => [...x.positions]), scores, words, time];
             }})()"
        ))?;
        let truth = mesh(&found[0])?;
        ensure!(truth.topology().is_closed() && truth.signed_volume() > 0.0, "the part is open");
        let of = |k: usize| -> Result<TriMesh> {
            Ok(truth.with_positions(numbers(&found[1][k]).as_chunks().0.to_vec())?)
        };
        let noisy = of(0)?;
        let options = Explicit { iterations: steps, ..Explicit::new(Diffusion::uniform(0.5)) };
        let filter = BilateralNormalOptions { iterations: rounds, ..Default::default() };
        let expected = [
            noisy.clone(),
            explicit(&noisy, &options, None)?.mesh,
            bilateral_normal(&noisy, &filter)?,
        ];
        for (k, expected) in expected.iter().enumerate() {
            let off = gap(of(k)?.positions().as_flattened(), expected.positions().as_flattened());
            ensure!(off < 1e-9, "σ = {sigma}, panel {k}: off by {off:e}");
            let creases = feature_edges(expected, &truth, 30.0)?;
            let scores = numbers(&found[2][k]);
            let volume = 100.0 * drift(expected, &truth).volume.context("no volume")?;
            let score = 100.0 * creases.f_score().context("no creases")?;
            let off = [
                (scores[0] - normal_error(expected, &truth)?.mean).abs() / 1e-6,
                (scores[1] - volume).abs() / 1e-9,
                (scores[2] - score).abs() / (101.0 / creases.expected as f64),
            ];
            ensure!(
                off.iter().all(|off| *off <= 1.0),
                "σ = {sigma}, panel {k}: {scores:?}, {off:?}"
            );
            let words = found[3][k].as_str().unwrap_or_default();
            ensure!(
                ["normal error", "volume", "F-score"].iter().all(|w| words.contains(w)),
                "{words}"
            );
        }
        // A tenth of this on an idle machine.
        ensure!(found[4].as_f64().is_some_and(|ms| ms < 2000.0), "{} ms", found[4]);
    }
    // At first the filter keeps creases that diffusion does not.
    chrome.run("fairing.views.get('play-denoising').fromText('0.2~8~20')")?;
    let kept = chrome.run("fairing.views.get('play-denoising').now.found.map((s) => s.creases)")?;
    let kept = numbers(&kept);
    ensure!(kept[2] > 60.0 && kept[1] < 10.0, "{kept:?}");
    caption_of_denoising(chrome)?;
    chrome.picture("denoising")
}

/// The caption: with more noise than about a third of an edge, diffusion is the better one.
fn caption_of_denoising(chrome: &mut Chrome) -> Result<()> {
    for (sigma, is_filter_better) in [(0.2, true), (0.5, false)] {
        let angles = chrome.run(&format!(
            "(async () => {{
               const p = fairing.views.get('play-denoising');
               await p.fromText('{sigma}~8~20');
               return p.now.found.map((s) => s.angle);
             }})()"
        ))?;
        let angles = numbers(&angles);
        ensure!((angles[2] < angles[1]) == is_filter_better, "σ = {sigma}: {angles:?}");
    }
    Ok(())
}

/// An integer number of modes gives the projection; in between, the next mode is weighted.
fn modes(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "q5-sum")?;
    let (ball, modes) = scene::modes()?;
    for k in [1.0, 4.0, 9.0, 9.5, 16.0] {
        let found = chrome.run(&format!(
            "(() => {{
               const v = fairing.views.get('q5-sum');
               v.fromText('!!!!!!{k}');
               v.settle();
               return [[...v.positions(v.meshes[0])], v.sum.slider.words?.textContent ?? '',
                 v.shown[0].bar.textContent];
             }})()"
        ))?;
        let mut expected = vec![[0.0; 3]; ball.vertex_count()];
        for (i, (vector, c)) in modes.vectors.iter().zip(&modes.coefficients).enumerate() {
            let part = (k - i as f64).clamp(0.0, 1.0);
            for (x, phi) in expected.iter_mut().zip(vector) {
                (0..3).for_each(|d| x[d] += part * phi * c[d]);
            }
        }
        let off = gap(&numbers(&found[0]), expected.as_flattened());
        ensure!(off < 1e-6, "k = {k}: off by {off:e}");
        ensure!(found[2].as_str().is_some_and(|w| w.contains("mode")), "{}", found[2]);
    }
    chrome.picture("modes")
}

/// The numbers under a panel are those of its current state.
fn facts(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "q5-grid")?;
    for (k, expected) in scene::FACTS.into_iter().enumerate() {
        let found = chrome.run(&format!(
            "(() => {{
               const v = fairing.views.get('q5-grid');
               v.change({{stops: [{}, {}]}});
               return document.querySelector('#q5-grid .facts-line').textContent;
             }})()",
            k / 3,
            k % 3
        ))?;
        let words = expected.map_or(String::new(), |x| format!("E_a {x}°"));
        ensure!(found == words.as_str(), "combination {k}: {found}, not {words}");
    }
    Ok(())
}

/// Displacement, distance from the truth and mean curvature, computed from positions.
fn derived(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "q5-flow")?;
    let found = chrome.run(
        "(async () => {
           const v = fairing.views.get('q5-flow');
           v.change({stops: [3]});
           const mesh = v.meshes[1];
           const of = async (name) => {
             v.change({field: name});
             await v.asked;
             const {target, canvas} = v.shown[1];
             const picture = target.getImageData(0, 0, canvas.width, canvas.height).data;
             const digest = picture.reduce((sum, x, i) => (sum * 31 + x * (i % 7)) % 1000000007, 7);
             return [name, [...v.values(mesh)], digest, v.shown[1].bar.textContent];
           };
           const all = [];
           const names = ['displacement', 'distance off the truth', 'normal error', 'mean curvature'];
           for (const name of names) all.push(await of(name));
           return [...all, [[...v.positions(mesh)], [...mesh.faces]]];
         })()",
    )?;
    let shown = mesh(&found[4])?;
    let (noisy, truth) = (scene::noisy(), scene::truth());
    let distance = |(p, q): (&[f64; 3], &[f64; 3])| glam::DVec3::from(*p).distance((*q).into());
    let moved: Vec<f64> = shown.positions().iter().zip(noisy.positions()).map(distance).collect();
    // Displacements are rounded to 2⁻¹⁴ of the power of two below the extent.
    let off = gap(&numbers(&found[0][1]), &moved);
    ensure!(off < 3e-3, "displacement: off by {off:e}");
    let off = numbers(&found[1][1]);
    let bound: Vec<f64> = shown.positions().iter().zip(truth.positions()).map(distance).collect();
    ensure!(
        off.iter().zip(&bound).all(|(a, b)| a.abs() <= b + 1e-4),
        "off the truth by more than the distance"
    );
    ensure!(off.iter().any(|x| *x > 1e-3) && off.iter().any(|x| *x < -1e-3), "{:?}", &off[..9]);
    let angles = numbers(&found[2][1]);
    ensure!(
        angles.iter().all(|a| (0.0..90.0).contains(a)) && angles.iter().any(|a| *a > 1.0),
        "{:?}",
        &angles[..9]
    );
    let mean = mean_curvature(&shown, LumpedArea::Mixed)?.signed;
    ensure!(gap(&numbers(&found[3][1]), &mean) < 1e-6, "mean curvature");
    let digests: std::collections::BTreeSet<String> =
        (0..4).map(|k| found[k][2].to_string()).collect();
    ensure!(digests.len() == 4, "fields look alike: {digests:?}");
    chrome.picture("derived")
}

/// A field with exact values can be coloured by its error, and a click shows the value, the exact
/// value and the error.
fn exact(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "q5-sum")?;
    let found = chrome.run(
        "(() => {
           const v = fairing.views.get('q5-sum');
           v.change({field: 'error of height', picked: 5});
           return [v.values(v.meshes[1])[5], v.words.textContent];
         })()",
    )?;
    ensure!(found[0].as_f64().is_some_and(|e| (e - scene::SLOPE).abs() < 1e-3), "{found}");
    let words = found[1].as_str().unwrap_or_default();
    ensure!(
        words.contains("height: exact")
            && words.contains("estimate")
            && words.contains("error 0.25"),
        "{words}"
    );
    Ok(())
}

fn claims(chrome: &mut Chrome, page: &Path) -> Result<()> {
    chrome.open(&format!("file://{}", page.display()))?;
    let found = chrome.run(
        "(async () => {
           const links = [...document.querySelectorAll('a.shown')];
           links[0].click();
           await fairing.views.get('q5-flow').open();
           return links.length;
         })()",
    )?;
    // In the table of claims and at the claim itself.
    ensure!(found == 2, "{found} links");
    let state = "(() => {
       const v = fairing.views.get('q5-flow');
       const box = v.figure.getBoundingClientRect();
       return [v.state.stops[0], v.chosen()?.name, box.top < innerHeight && box.bottom > 0];
     })()";
    let wanted = json!([4, "displacement", true]);
    let found = chrome.until(state, |found| *found == wanted)?;
    ensure!(found == wanted, "{found}");
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

/// Hovering over a point shows its values and moves the slider of the view; so do the arrow keys.
fn points(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, "q5-flow")?;
    let place = "(() => {
       const svg = document.querySelector('svg.figure');
       svg.scrollIntoView({block: 'center'});
       const data = svg.querySelector('metadata');
       const [x, y] = JSON.parse(data.textContent).series[0].points[2];
       const at = svg.createSVGPoint();
       [at.x, at.y] = [x, y];
       const seen = at.matrixTransform(data.parentNode.getScreenCTM());
       return [seen.x + 2, seen.y - 2];
     })()";
    let state = "[fairing.views.get('q5-flow').state.stops[0],
       document.querySelector('svg.figure + .tip')?.textContent ?? '', document.querySelectorAll('.pointed').length]";
    let mut found = Value::Null;
    // Folds that open above may move the plot away from the pointer.
    for _ in 0..50 {
        let place = chrome.run(place)?;
        let [x, y] = [0, 1].map(|k| place[k].as_f64().unwrap_or(0.0));
        // A click would open the view.
        let pointed = json!({"type": "mouseMoved", "x": x, "y": y, "button": "none", "buttons": 0});
        chrome.call("Input.dispatchMouseEvent", pointed)?;
        std::thread::sleep(Duration::from_millis(50));
        found = chrome.run(state)?;
        if found[0] == 3 && found[2] == 1 {
            break;
        }
    }
    ensure!(found[0] == 3 && found[2] == 1, "{found}");
    ensure!(found[1].as_str().is_some_and(|w| w.contains("iterations 3, 0.25")), "{found}");
    let key = "new KeyboardEvent('keydown', {key: 'ArrowRight'})";
    chrome.run(&format!("document.querySelector('svg.figure').dispatchEvent({key})"))?;
    let next = chrome.until(state, |next| next[0] == 4)?;
    ensure!(next[0] == 4 && next[1] != found[1] && next[2] == 1, "{next}");
    chrome.picture("pointed")
}

/// Plots and numbers work without WebGL, and sliders move by keys.
fn plain(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let script = "const before = HTMLCanvasElement.prototype.getContext;
      HTMLCanvasElement.prototype.getContext = function (kind) {
        return kind === '2d' ? before.apply(this, arguments) : null;
      };";
    chrome.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": script}))?;
    chrome.open(&format!("file://{}", page.display()))?;
    let before = chrome.run(
        "(async () => {
           const p = fairing.views.get('play-diffusion');
           await p.open();
           p.lambda.input.scrollIntoView();
           p.lambda.input.focus();
           const seen = [...p.figure.querySelectorAll('canvas')].filter((c) => c.offsetWidth > 0).length;
           return [p.figure.querySelectorAll('svg.plot').length, seen, p.result.textContent];
         })()",
    )?;
    ensure!(before[0] == 2 && before[1] == 0, "plots, canvases: {before}");
    for kind in ["keyDown", "keyUp"] {
        let key = json!({"type": kind, "key": "ArrowLeft", "code": "ArrowLeft", "windowsVirtualKeyCode": 37});
        chrome.call("Input.dispatchKeyEvent", key)?;
    }
    let words = "fairing.views.get('play-diffusion').result.textContent";
    let after = chrome.until(words, |after| *after != before[2])?;
    ensure!(after != before[2], "the arrow key changes nothing: {after}");
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}
