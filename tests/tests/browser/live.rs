//! Smoothing in the page, compared with the solvers of the library.

use std::path::Path;

use anyhow::{Result, ensure};
use fairing_smoothing::{
    Diffusion, Explicit, Implicit, Stability, explicit, implicit, largest_eigenvalue,
};
use serde_json::json;

use crate::Test;
use crate::chrome::Chrome;
use crate::{report, scene};

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("live_smoothing_agrees_with_the_library", agrees),
        ("live_smoothing_shows", shows),
        ("live_flows_are_compared_with_the_input", compares),
    ]
}

/// The mesh computed by the library.
fn smoothed(flow: &str, lambda: f64, count: usize) -> Result<Vec<[f64; 3]>> {
    let (diffusion, mesh) = (Diffusion::uniform(lambda), scene::noisy());
    let smoothed = match flow {
        "explicit" => {
            let stability = Stability::Allow;
            let options = Explicit { iterations: count, stability, ..Explicit::new(diffusion) };
            explicit(&mesh, &options, None)?
        }
        _ => implicit(&mesh, &Implicit { iterations: count, ..Implicit::new(diffusion) }, None)?,
    };
    Ok(smoothed.mesh.into_positions())
}

/// The page asks its module for the flow, λ and number of steps that the sliders say.
#[expect(clippy::disallowed_methods, reason = "the page has its own power")]
fn agrees(chrome: &mut Chrome, page: &Path) -> Result<()> {
    report::open(chrome, page)?;
    for (flow, exponent, count) in [("implicit", 1.0, 10), ("explicit", -0.5, 20)] {
        let lambda = 10_f64.powf(exponent);
        let found = chrome.run(&format!(
            "(async () => {{
               const {{live}} = fairing.views.get('q5-flow');
               live.lambda.value = {exponent};
               live.count.value = {count};
               await live.run();
               return [...live.results.{flow}.positions];
             }})()"
        ))?;
        let expected = smoothed(flow, lambda, count)?;
        let found: Vec<f64> =
            found.as_array().into_iter().flatten().filter_map(|x| x.as_f64()).collect();
        ensure!(found.len() == 3 * expected.len(), "{} coordinates came back", found.len());
        let pairs = found.iter().zip(expected.as_flattened());
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Conjugate gradients end at a residual of 10⁻⁸, by sums in another order.
        ensure!(off < 1e-7, "{flow}, λ = {lambda}, {count} steps: off by {off:e}");
        let input = scene::noisy();
        let moved = input.positions().as_flattened().iter().zip(&found);
        let moved = moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        ensure!(moved > 1e-3, "{flow}, λ = {lambda}, {count} steps: nothing has moved");
    }
    let mu = chrome.number("fairing.views.get('q5-flow').live.roughest")?;
    let exact = -largest_eigenvalue(&scene::noisy(), Diffusion::uniform(1.0))?;
    ensure!((mu / exact - 1.0).abs() < 1e-9, "μ = {exact}, the page says {mu}");
    Ok(())
}

/// The digests of the visible panels of the view, with their titles.
const SEEN: &str =
    "() => fairing.views.get('q5-flow').shown.filter((s) => !s.panel.hidden).map((s) => {
  const d = s.target.getImageData(0, 0, s.canvas.width, s.canvas.height).data;
  return [s.title.textContent, d.reduce((sum, x, i) => (sum * 31 + x * (i % 7)) % 1000000007, 7)];
})";

/// The input stays visible, explicit and implicit steps are side by side, and a text compares λ
/// with the limit.
fn compares(chrome: &mut Chrome, page: &Path) -> Result<()> {
    report::open(chrome, page)?;
    let set = |exponent: f64| {
        format!(
            "(async () => {{
               const live = fairing.views.get('q5-flow').live;
               live.lambda.value = {exponent};
               live.count.value = 12;
               await live.run();
               return [({SEEN})(), document.querySelector('#q5-flow .factors').textContent,
                       live.lambda.getAttribute('aria-valuetext')];
             }})()"
        )
    };
    let calm = chrome.run(&set(0.0))?;
    ensure!(calm[0].as_array().is_some_and(|p| p.len() == 3), "{calm}");
    let still = chrome.run(
        "(() => {
           const v = fairing.views.get('q5-flow');
           const [{mesh, panel}] = v.shown;
           return [mesh.title, panel.hidden, v.positions(mesh) === mesh.stops[0]];
         })()",
    )?;
    ensure!(still == serde_json::json!(["noisy", false, true]), "the input has changed: {still}");
    ensure!(calm[0][1][1] != calm[0][2][1], "explicit and implicit look the same");
    ensure!(calm[0][1][0] == "explicit, 12 × 1" && calm[0][2][0] == "implicit, 12 × 1", "{calm}");
    ensure!(calm[1].as_str().is_some_and(|w| w.contains("no mode grows")), "{calm}");
    ensure!(calm[2] == "λ = 1", "the slider announces {}", calm[2]);
    // 10^0.3 is just below 2, beyond every limit.
    let wild = chrome.run(&set(0.3))?;
    ensure!(wild[1].as_str().is_some_and(|w| w.contains("the mode grows")), "{wild}");
    ensure!(wild[0][0] == calm[0][0] && wild[0][1][1] != calm[0][1][1], "{wild}");
    chrome.picture("beyond")
}

/// Waits until the address contains λ = 10 after ten steps.
const ADDRESS: &str = "async () => {
  for (let i = 0; i < 400; i++) {
    const state = new URLSearchParams(location.hash.slice(1)).get('q5-flow');
    if (state && state.endsWith('!1~10')) return location.href;
    await new Promise((go) => setTimeout(go, 50));
  }
  return '';
}";

/// Waits until the page has smoothed.
const WAIT: &str = "async () => {
  for (let i = 0; i < 900; i++) {
    const words = document.querySelector('#q5-flow .status').textContent;
    if (words.startsWith('Moved')) return words;
    await new Promise((go) => setTimeout(go, 50));
  }
  return '';
}";

fn shows(chrome: &mut Chrome, page: &Path) -> Result<()> {
    report::open(chrome, page)?;
    chrome.run(
        "(() => {
           const s = document.querySelectorAll('#q5-flow .slider.live input');
           s[0].value = 1;
           s[1].value = 10;
           s[1].dispatchEvent(new Event('input'));
         })()",
    )?;
    let words = chrome.run(&format!("({WAIT})()"))?;
    ensure!(words.as_str().is_some_and(|w| w.starts_with("Moved by")), "{words}");
    let live = chrome.run("fairing.views.get('q5-flow').live.on")?;
    ensure!(live == true, "the result is not shown");
    chrome.picture("live")?;
    // The address restores the state, and the button leaves it.
    let address = chrome.run(&format!("({ADDRESS})()"))?;
    ensure!(address != "", "the address does not hold the live result");
    chrome.call("Page.navigate", json!({"url": "about:blank"}))?;
    chrome.open(address.as_str().unwrap_or_default())?;
    chrome.run("fairing.openAll()")?;
    let back = chrome.run(&format!("({WAIT})()"))?;
    ensure!(
        back.as_str().is_some_and(|w| w.starts_with("Moved by")),
        "it did not come back: {back}"
    );
    let live = chrome.run(
        "(() => {
           const {live} = fairing.views.get('q5-flow');
           live.button.click();
           return live.on;
         })()",
    )?;
    ensure!(live == false, "the button does not put the live result away");
    Ok(())
}
