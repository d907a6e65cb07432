//! Interaction with the page.

use std::path::Path;

use anyhow::{Result, ensure};
use serde_json::json;

use crate::chrome::Chrome;
use crate::{Test, scene};

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("loads_without_complaint_or_request", loads),
        ("every_view_draws", draws),
        ("the_slider_changes_the_picture", slides),
        ("two_sliders_make_combinations", combines),
        ("dragging_turns_all_panels", turns),
        ("picking_shows_the_values_of_a_vertex", picks),
        ("choices_change_the_picture", chooses),
        ("the_address_brings_the_view_back", remembers),
        ("dark_mode_changes_the_colours", darkens),
        ("fits_a_telephone", fits),
        ("without_webgl_the_figure_stands_in", stands_in),
        ("the_keyboard_turns_and_zooms", keys),
    ]
}

/// Opens the page with all of its views.
pub(crate) fn open(chrome: &mut Chrome, page: &Path) -> Result<()> {
    chrome.open(&format!("file://{}", page.display()))?;
    chrome.run("fairing.openAll()")?;
    Ok(())
}

/// The fraction of pixels that are drawn, and a digest of all, for one canvas.
fn picture(chrome: &mut Chrome, canvas: usize) -> Result<(f64, f64)> {
    let value = chrome.run(&format!(
        "(() => {{
           const c = document.querySelectorAll('figure.view .panel:not([hidden]) canvas')[{canvas}];
           const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
           let [drawn, digest] = [0, 0];
           for (let i = 0; i < d.length; i += 4) {{
             if (d[i + 3] > 128) drawn += 1;
             digest = (digest * 31 + d[i] + 3 * d[i + 1] + 7 * d[i + 2] + 11 * d[i + 3]) % 1000000007;
           }}
           return [drawn / (c.width * c.height), digest];
         }})()"
    ))?;
    Ok((value[0].as_f64().unwrap_or(0.0), value[1].as_f64().unwrap_or(0.0)))
}

/// Waits until the requested pictures are drawn.
fn settle(chrome: &mut Chrome) -> Result<()> {
    chrome.run("new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)))")?;
    Ok(())
}

/// The centre of a canvas in pixels of the window, once the folds around it are open and the
/// playgrounds in sight have their full height.
fn middle(chrome: &mut Chrome, canvas: usize) -> Result<[f64; 2]> {
    let place = chrome.run(&format!(
        "(async () => {{
           const c = document.querySelectorAll('figure.view .panel:not([hidden]) canvas')[{canvas}];
           for (let k = 0; k < 3; k++) {{
             c.scrollIntoView({{block: 'center'}});
             await new Promise((go) => requestAnimationFrame(() => setTimeout(go, 0)));
             await Promise.all([...fairing.views.values()].map((view) => view.opened));
           }}
           const r = c.getBoundingClientRect();
           return [r.x + r.width / 2, r.y + r.height / 2];
         }})()"
    ))?;
    Ok([0, 1].map(|k| place[k].as_f64().unwrap_or(0.0)))
}

fn loads(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    let outside: Vec<&String> = chrome
        .requests
        .iter()
        .filter(|url| !["file:", "data:", "blob:", "about:"].iter().any(|s| url.starts_with(s)))
        .collect();
    ensure!(outside.is_empty(), "{outside:?}");
    let files = chrome.requests.iter().filter(|url| url.starts_with("file:")).count();
    ensure!(files == 1, "the page loads other files: {:?}", chrome.requests);
    chrome.picture("top")?;
    middle(chrome, 0)?;
    chrome.picture("flow")?;
    middle(chrome, 2)?;
    chrome.picture("open")
}

/// A bumpy sphere covers about half of its canvas, a flower less.
fn draws(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let count = chrome
        .number("document.querySelectorAll('figure.view .panel:not([hidden]) canvas').length")?;
    ensure!(count == 6.0, "{count} canvases");
    for canvas in 0..4 {
        let (drawn, _) = picture(chrome, canvas)?;
        ensure!((0.15..0.75).contains(&drawn), "canvas {canvas}: {drawn} of it is drawn");
    }
    Ok(())
}

fn slides(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let before = [picture(chrome, 0)?, picture(chrome, 1)?];
    let words = chrome.run(
        "(() => {
           const s = document.querySelector('#q5-flow .slider input');
           s.value = 5;
           s.dispatchEvent(new Event('input'));
           return document.querySelector('#q5-flow .slider output').textContent;
         })()",
    )?;
    ensure!(words == "iterations = 5", "{words}");
    ensure!(picture(chrome, 0)?.1 == before[0].1, "the still panel has changed");
    ensure!(picture(chrome, 1)?.1 != before[1].1, "the moving panel has not changed");
    chrome.picture("slid")
}

/// Each combination shows the ellipsoid that it names.
fn combines(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    for (i, width) in scene::WIDTHS.into_iter().enumerate() {
        for (j, height) in scene::HEIGHTS.into_iter().enumerate() {
            let found = chrome.run(&format!(
                "(() => {{
                   const s = document.querySelectorAll('#q5-grid .slider input');
                   [{i}, {j}].forEach((value, k) => {{
                     s[k].value = value;
                     s[k].dispatchEvent(new Event('input'));
                   }});
                   const v = fairing.views.get('q5-grid');
                   const p = v.positions(v.meshes[0]);
                   const reach = (k) => Math.max(...p.filter((_, i) => i % 3 === k));
                   const words = [...document.querySelectorAll('#q5-grid .slider output')];
                   return [reach(0), reach(1), ...words.map((w) => w.textContent)];
                 }})()"
            ))?;
            // Positions after the first are rounded to 2⁻¹⁴ of the extent.
            for (k, expected) in [width, height].into_iter().enumerate() {
                let reach = found[k].as_f64().unwrap_or(0.0);
                ensure!((reach - expected).abs() < 1e-3, "{i}, {j}: {found}");
            }
            ensure!(found[2] == format!("width = {width}").as_str(), "{found}");
            ensure!(found[3] == format!("height = {height}").as_str(), "{found}");
        }
    }
    chrome.picture("grid")
}

fn turns(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let [x, y] = middle(chrome, 0)?;
    let before = [picture(chrome, 0)?, picture(chrome, 1)?];
    chrome.drag([x, y], [x + 120.0, y + 30.0])?;
    settle(chrome)?;
    for canvas in 0..2 {
        ensure!(picture(chrome, canvas)?.1 != before[canvas].1, "panel {canvas} has not turned");
    }
    chrome.picture("turned")
}

fn picks(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let [x, y] = middle(chrome, 1)?;
    chrome.drag([x, y], [x, y])?;
    settle(chrome)?;
    let words = chrome.run("document.querySelector('#q5-flow .picked').textContent")?;
    let words = words.as_str().unwrap_or_default();
    ensure!(words.starts_with("Vertex ") && words.contains("displacement"), "{words}");
    // The vertex must be the one closest to the centre on the screen.
    let off = chrome.number(
        "(() => {
           const v = fairing.views.get('q5-flow');
           const {canvas} = v.shown[1];
           const [x, y] = v.place(v.shown[1], v.state.picked);
           return Math.hypot(x - canvas.width / 2, y - canvas.height / 2) / canvas.height;
         })()",
    )?;
    ensure!(off < 0.05, "the picked vertex is {off} of the height away");
    chrome.picture("picked")?;
    // There is nothing to pick in the corner.
    let nothing = chrome.number(
        "(() => { const v = fairing.views.get('q5-flow'); return v.pick(v.shown[0], 0.01, 0.01); })()",
    )?;
    ensure!(nothing == -1.0, "picked {nothing} in the empty corner");
    Ok(())
}

fn chooses(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let mut last = picture(chrome, 1)?.1;
    for change in [
        "{field: 'displacement'}",
        "{wire: true}",
        "{wire: false, lines: true}",
        "{lines: false, flat: false}",
        "{field: null}",
    ] {
        // Without values, only another stop changes the picture.
        chrome.run(&format!("fairing.views.get('q5-flow').change({{stops: [2], ...{change}}})"))?;
        let now = picture(chrome, 1)?.1;
        ensure!(now != last, "{change} changes nothing");
        last = now;
    }
    let undefined = chrome.run("document.querySelector('#q5-open .bar').textContent")?;
    let words = undefined.as_str().unwrap_or_default();
    ensure!(words.contains("undefined"), "the bar does not count the border: {words}");
    chrome.picture("chosen")
}

fn remembers(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    chrome.run(
        "(() => {
           const v = fairing.views.get('q5-flow');
           v.camera.turn(40, 10);
           v.change({stops: [3], field: 'displacement', wire: true});
         })()",
    )?;
    let before = [picture(chrome, 0)?, picture(chrome, 1)?];
    let address = chrome.until("location.href", |address| {
        address.as_str().is_some_and(|a| a.contains("#q5-flow="))
    })?;
    let address = address.as_str().unwrap_or_default().to_string();
    ensure!(address.contains("#q5-flow="), "{address}");
    chrome.call("Page.navigate", json!({"url": "about:blank"}))?;
    chrome.open(&address)?;
    chrome.run("fairing.openAll()")?;
    for canvas in 0..2 {
        ensure!(picture(chrome, canvas)?.1 == before[canvas].1, "panel {canvas} came back changed");
    }
    // An invalid address must not break the page.
    chrome.run("location.hash = '#q5-flow=!9e9!x!NaN~1!-7!!&nobody=1'; 0")?;
    settle(chrome)?;
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

fn darkens(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let scheme =
        |value: &str| json!({"features": [{"name": "prefers-color-scheme", "value": value}]});
    let paper = "getComputedStyle(document.body).backgroundColor";
    chrome.call("Emulation.setEmulatedMedia", scheme("light"))?;
    open(chrome, page)?;
    let light = chrome.run(paper)?;
    chrome.call("Emulation.setEmulatedMedia", scheme("dark"))?;
    let dark = chrome.run(paper)?;
    ensure!(light != dark, "both are {light}");
    middle(chrome, 0)?;
    chrome.picture("dark")?;
    chrome.run("document.getElementById('theme').click()")?;
    ensure!(chrome.run(paper)? == light, "the button does not bring the light back");
    Ok(())
}

fn fits(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let telephone = json!({"width": 390, "height": 800, "deviceScaleFactor": 2, "mobile": true});
    chrome.call("Emulation.setDeviceMetricsOverride", telephone)?;
    open(chrome, page)?;
    let width = chrome.number("document.documentElement.scrollWidth")?;
    ensure!(width <= 390.0, "the page is {width} pixels wide");
    middle(chrome, 0)?;
    chrome.picture("telephone")
}

fn stands_in(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let script = "HTMLCanvasElement.prototype.getContext = () => null;";
    chrome.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": script}))?;
    chrome.open(&format!("file://{}", page.display()))?;
    let pictures = chrome.number(
        "[...document.querySelectorAll('figure.view img')].filter((p) => p.offsetWidth > 0).length",
    )?;
    ensure!(pictures == 4.0, "{pictures} of 4 views show their figure");
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

fn keys(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    chrome.run("document.querySelectorAll('figure.view canvas')[0].focus()")?;
    let mut last = picture(chrome, 0)?.1;
    for key in ["ArrowLeft", "ArrowUp", "-", "0"] {
        for kind in ["keyDown", "keyUp"] {
            chrome.call("Input.dispatchKeyEvent", json!({"type": kind, "key": key}))?;
        }
        settle(chrome)?;
        let now = picture(chrome, 0)?.1;
        ensure!(now != last, "{key} changes nothing");
        last = now;
    }
    let label = chrome.run("document.activeElement.getAttribute('aria-label')")?;
    ensure!(label.as_str().is_some_and(|l| l.contains("bumpy")), "{label}");
    Ok(())
}
