//! Smoothing by the page itself, held against the solver of the library.

use std::path::Path;

use anyhow::{Result, ensure};
use fairing_smoothing::{Diffusion, Implicit, implicit};
use serde_json::json;

use crate::Test;
use crate::chrome::Chrome;
use crate::{report, scene};

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![("live_smoothing_agrees_with_the_library", agrees), ("live_smoothing_shows", shows)]
}

/// What the library computes.
fn smoothed(lambda: f64, count: usize) -> Result<Vec<[f64; 3]>> {
    let diffusion = Diffusion::uniform(lambda);
    let options = Implicit { iterations: count, ..Implicit::new(diffusion) };
    Ok(implicit(&scene::noisy(), &options, None)?.mesh.into_positions())
}

/// Both solve the same equations in double precision, the page to a relative
/// residual of 10⁻¹³; the report promises 10⁻⁶ of the mesh's radius, 1.
fn agrees(chrome: &mut Chrome, page: &Path) -> Result<()> {
    report::open(chrome, page)?;
    for (lambda, count) in [(0.1, 1), (5.0, 10), (100.0, 3), (1000.0, 50)] {
        let found = chrome.run(&format!(
            "fairing.views.get('q5-flow').smooth({lambda}, {count}).then((x) => Array.from(x))"
        ))?;
        let expected = smoothed(lambda, count)?;
        let found: Vec<f64> =
            found.as_array().into_iter().flatten().filter_map(|x| x.as_f64()).collect();
        ensure!(found.len() == 3 * expected.len(), "{} coordinates came back", found.len());
        let pairs = found.iter().zip(expected.as_flattened());
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        ensure!(off < 1e-6, "λ = {lambda}, {count} steps: off by {off:e}");
        let input = scene::noisy();
        let moved = input.positions().as_flattened().iter().zip(&found);
        let moved = moved.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        ensure!(moved > 1e-3, "λ = {lambda}, {count} steps: nothing has moved");
    }
    Ok(())
}

/// Waits until the page has smoothed.
const WAIT: &str = "async () => {
  for (let i = 0; i < 200; i++) {
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
    let live = chrome.run("fairing.views.get('q5-flow').live !== null")?;
    ensure!(live == true, "the result is not shown");
    chrome.picture("live")?;
    // The address brings it back, and the other slider puts it away.
    std::thread::sleep(std::time::Duration::from_millis(400));
    let address = chrome.run("location.href")?;
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
           const s = document.querySelector('#q5-flow .slider input');
           s.dispatchEvent(new Event('input'));
           return fairing.views.get('q5-flow').live;
         })()",
    )?;
    ensure!(live.is_null(), "the live result stays over the slider's");
    Ok(())
}
