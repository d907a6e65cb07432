//! The page around the views: printing, formulas, colour bars, sizes, keys, and drawing speed.

use std::path::Path;

use anyhow::{Result, ensure};
use serde_json::json;

use crate::Test;
use crate::chrome::Chrome;
use crate::report;

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("paper_shows_pictures_of_views_that_were_not_opened", prints),
        ("a_section_shows_one_view_and_one_plot_and_folds_the_rest", folds),
        ("paper_shows_what_is_folded", unfolds),
        ("a_view_begins_in_its_colour", colours),
        ("the_opening_comes_before_the_verdicts", opens),
        ("formulas_scroll_by_themselves", formulas),
        ("captions_of_tables_fit_a_telephone", captions),
        ("plots_of_a_figure_are_stacked_on_a_telephone", stacks),
        ("colour_bars_keep_the_size_of_their_words", words),
        ("the_page_does_not_jump", sizes),
        ("the_theme_is_remembered", themes),
        ("vertices_are_picked_by_keyboard", picks),
        ("the_contents_mark_the_section_that_is_read", follows),
        ("dragging_is_drawn_fast", fast),
    ]
}

/// Opens the page without its views.
fn open(chrome: &mut Chrome, page: &Path) -> Result<()> {
    chrome.open(&format!("file://{}", page.display()))
}

/// Printing needs no opened views, and tables are not cut.
fn prints(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    chrome.call("Emulation.setEmulatedMedia", json!({"media": "print"}))?;
    let found = chrome.run(
        "(() => {
           const seen = (e) => e.getClientRects().length > 0;
           const stages = [...document.querySelectorAll('.view .stage')].filter(seen).length;
           const pictures = [...document.querySelectorAll('.view .paper img')].filter(seen).length;
           const cut = [...document.querySelectorAll('.wide')]
             .filter((w) => getComputedStyle(w).overflowX !== 'visible').length;
           // The caption is that of the picture on paper.
           const captions = [...document.querySelectorAll('.view')].filter((view) =>
             [...view.querySelectorAll('figcaption, .paper > p')].filter(seen).length !== 1).length;
           return [stages, pictures, cut, captions];
         })()",
    )?;
    // One picture stands for all four views of the scene.
    ensure!(found == json!([0, 1, 0, 0]), "stages, pictures, cut tables, captions: {found}");
    chrome.picture("paper")
}

/// The line of each fold describes its content.
fn folds(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let found = chrome.run(
        "(() => {
           const q5 = document.getElementById('q5');
           const seen = (what) => [...q5.querySelectorAll(what)]
             .filter((e) => e.checkVisibility()).map((e) => e.id || e.dataset.section);
           const lines = [...q5.querySelectorAll('details > summary')].map((s) => s.textContent);
           return [seen('figure.view, figure.play'), seen('svg.figure'), lines,
             q5.querySelectorAll('details[open]').length];
         })()",
    )?;
    ensure!(found[0] == json!(["play-diffusion", "q5-flow"]), "views that are seen: {found}");
    ensure!(found[1] == json!(["q5"]), "plots that are seen: {found}");
    let lines: Vec<&str> =
        found[2].as_array().into_iter().flatten().filter_map(|l| l.as_str()).collect();
    ensure!(lines.contains(&"3 figures: open; grid; sum"), "{lines:?}");
    ensure!(lines.contains(&"In Rust and on the command line"), "{lines:?}");
    ensure!(found[3] == 0, "{} folds are open", found[3]);
    let commands = chrome
        .run("[...document.querySelectorAll('#q5 pre')].map((p) => p.textContent).join('\\n')")?;
    let commands = commands.as_str().unwrap_or_default();
    ensure!(
        commands.contains("explicit(mesh") && commands.contains("fairing smooth "),
        "{commands}"
    );
    Ok(())
}

/// Printing unfolds by style alone or, in browsers without support for it, by the event before
/// printing; the screen does not change.
fn unfolds(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let hidden = "(() => {
       const folds = [...document.querySelectorAll('main details:not(.rows)')];
       const closed = folds.filter((d) => ![...d.children].slice(1)
         .every((e) => e.checkVisibility() && e.getBoundingClientRect().height > 0));
       return [folds.length, closed.length, folds.filter((d) => d.open).length];
     })()";
    let screen = chrome.run(hidden)?;
    ensure!(screen[0].as_u64() > Some(3) && screen[1] == screen[0], "on the screen: {screen}");
    chrome.call("Emulation.setEmulatedMedia", json!({"media": "print"}))?;
    let paper = chrome.run(hidden)?;
    ensure!(paper[0] == screen[0] && paper[1] == 0, "on paper: {paper}");
    chrome.picture("unfolded")?;
    chrome.call("Emulation.setEmulatedMedia", json!({"media": ""}))?;
    chrome.run("dispatchEvent(new Event('beforeprint'))")?;
    let asked = chrome.run(hidden)?;
    ensure!(asked[2] == screen[0], "before printing: {asked}");
    chrome.run("dispatchEvent(new Event('afterprint'))")?;
    let after = chrome.run(hidden)?;
    ensure!(after[2] == 0, "after printing: {after}");
    Ok(())
}

/// The view names the mesh, though the page computes it.
fn colours(chrome: &mut Chrome, page: &Path) -> Result<()> {
    report::open(chrome, page)?;
    let field = chrome.run(
        "(() => { const v = fairing.views.get('q5-grid'); return v.state.field ?? 'nothing'; })()",
    )?;
    ensure!(field == "mean curvature", "{field}");
    let named = chrome.run("document.querySelector('#q5-grid .bar').textContent")?;
    ensure!(named.as_str().is_some_and(|n| n.contains("mean curvature")), "{named}");
    Ok(())
}

/// A formula that is too wide scrolls inside its own box, and no part of it is lost.
fn formulas(chrome: &mut Chrome, page: &Path) -> Result<()> {
    telephone(chrome)?;
    open(chrome, page)?;
    let found = chrome.run(
        "(() => {
           const box = document.querySelector('.formula');
           const height = (e) => e.getBoundingClientRect().height;
           const parts = [...box.querySelectorAll('math')];
           const tall = parts.map((math) => Math.max(...[...math.querySelectorAll('mo')].map(height)) / height(math));
           return [document.documentElement.scrollWidth, box.scrollWidth > box.clientWidth,
                   Math.max(...tall), box.textContent,
                   new Set(parts.map((math) => math.getBoundingClientRect().top)).size, parts.length,
                   getComputedStyle(box).overflowY, box.scrollHeight - box.clientHeight];
         })()",
    )?;
    ensure!(found[0].as_f64().is_some_and(|w| w <= 390.0), "{found}");
    ensure!(found[1] == true, "the formula is not wider than the screen: the test shows nothing");
    ensure!(found[2].as_f64().is_some_and(|part| part <= 1.01), "parentheses stick out: {found}");
    let text = found[3].as_str().unwrap_or_default();
    ensure!(text.contains('φ') && text.contains('δ') && text.contains('κ'), "{text}");
    // No vertical scroll bar, and no hidden overflow.
    ensure!(found[6] == "hidden" && found[7].as_f64().is_some_and(|over| over <= 1.0), "{found}");
    // Parts that do not fit side by side are stacked.
    ensure!(found[5].as_u64() > Some(1) && found[4].as_u64() > Some(1), "{found}");
    Ok(())
}

/// The opening has the question and the number of claims; the rules follow, then the table of
/// claims, which has the verdicts. A link to a source opens the fold that holds it.
fn opens(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let found = chrome.run(
        "[document.querySelector('.opening').textContent,
           document.querySelector('.opening + #rules + #claims').textContent,
           document.querySelectorAll('.opening .verdict').length,
           document.querySelector('#rules').textContent]",
    )?;
    let [opening, claims] = [0, 1].map(|k| found[k].as_str().unwrap_or_default());
    ensure!(opening.contains("one claim is half right."), "{opening}");
    ensure!(found[3].as_str().is_some_and(|rules| rules.contains("claim 5a")), "{found}");
    ensure!(claims.contains("λ = 0.05 is best") && found[2] == 0, "{found}");
    let source = chrome.run(
        "(() => {
           const link = document.querySelector('#q5 a[href^=\"#source-\"]');
           link?.click();
           return link?.hash ?? '';
         })()",
    )?;
    let id = source.as_str().unwrap_or_default();
    let seen = format!("document.querySelector('{id}')?.checkVisibility()");
    ensure!(!id.is_empty() && chrome.until(&seen, |seen| *seen == true)? == true, "{id} is folded");
    Ok(())
}

/// A width of 390 pixels.
fn telephone(chrome: &mut Chrome) -> Result<()> {
    let screen = json!({"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": true});
    chrome.call("Emulation.setDeviceMetricsOverride", screen).map(drop)
}

/// A wide table scrolls; its caption does not.
fn captions(chrome: &mut Chrome, page: &Path) -> Result<()> {
    telephone(chrome)?;
    open(chrome, page)?;
    let found = chrome.run(
        "(() => {
           const box = document.querySelector('#q5 .wide:has(caption)');
           box.scrollLeft = 10000;
           const {left, right} = box.querySelector('caption > span').getBoundingClientRect();
           return [box.scrollLeft > 0, left >= 0 && right <= innerWidth, [left, right]];
         })()",
    )?;
    ensure!(found[0] == true, "the table is not wider than the screen: the test shows nothing");
    ensure!(found[1] == true, "the caption goes from {} to the right", found[2]);
    Ok(())
}

/// Two plots side by side are stacked in full width; on a wider screen they are side by side.
fn stacks(chrome: &mut Chrome, page: &Path) -> Result<()> {
    telephone(chrome)?;
    open(chrome, page)?;
    let places = "(() => {
       const svg = document.querySelector('#q5 svg.figure');
       const plots = [...svg.querySelectorAll('metadata')].map((m) => m.parentNode.getBoundingClientRect());
       return [plots[1].top >= plots[0].bottom, plots[1].left >= plots[0].right,
               plots.every((p) => p.left >= 0 && p.right <= innerWidth), svg.getAttribute('viewBox')];
     })()";
    let narrow = chrome.run(places)?;
    ensure!(narrow[0] == true && narrow[1] == false && narrow[2] == true, "{narrow}");
    chrome.picture("stacked")?;
    let desk = json!({"width": 1300, "height": 900, "deviceScaleFactor": 1, "mobile": false});
    chrome.call("Emulation.setDeviceMetricsOverride", desk)?;
    let wide = chrome.until(places, |wide| wide[1] == true)?;
    ensure!(wide[0] == false && wide[1] == true && wide[3] != narrow[3], "{wide}");
    Ok(())
}

/// No text of a colour bar is drawn smaller than its size, even in a narrow panel.
fn words(chrome: &mut Chrome, page: &Path) -> Result<()> {
    telephone(chrome)?;
    report::open(chrome, page)?;
    let sizes = chrome.run(
        "[...document.querySelectorAll('.panel:not([hidden]) .bar svg')].map((svg) => svg.getScreenCTM().a)",
    )?;
    let sizes: Vec<f64> =
        sizes.as_array().into_iter().flatten().filter_map(|x| x.as_f64()).collect();
    ensure!(!sizes.is_empty() && sizes.iter().all(|size| *size > 0.95), "{sizes:?}");
    Ok(())
}

fn sizes(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let unknown = chrome.number(
        "[...document.querySelectorAll('img')]
           .filter((p) => !(p.getAttribute('width') > 0 && p.getAttribute('height') > 0)).length",
    )?;
    ensure!(unknown == 0.0, "{unknown} pictures without width and height");
    Ok(())
}

fn themes(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let theme = "document.documentElement.dataset.theme ?? ''";
    chrome.run("document.getElementById('theme').click()")?;
    let chosen = chrome.run(theme)?;
    ensure!(chosen != "", "the button chooses nothing");
    open(chrome, page)?;
    let again = chrome.run(theme)?;
    chrome.run("localStorage.clear()")?;
    ensure!(again == chosen, "{chosen} became {again}");
    Ok(())
}

/// The vertex alone is compared: its values are computed apart and may come later.
fn picks(chrome: &mut Chrome, page: &Path) -> Result<()> {
    report::open(chrome, page)?;
    chrome.run("document.querySelector('#q5-flow canvas').focus()")?;
    let vertex = "document.querySelector('#q5-flow .picked').textContent.split('.')[0]";
    let mut picked = vec![];
    for key in ["Enter", "n", "p"] {
        for kind in ["keyDown", "keyUp"] {
            chrome.call("Input.dispatchKeyEvent", json!({"type": kind, "key": key}))?;
        }
        let before = picked.last().cloned().unwrap_or_else(|| json!(""));
        picked.push(chrome.until(vertex, |now| *now != before)?);
    }
    ensure!(picked[0].as_str().is_some_and(|w| w.starts_with("Vertex ")), "{picked:?}");
    ensure!(picked[1] != picked[0] && picked[2] == picked[0], "{picked:?}");
    Ok(())
}

fn follows(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    chrome.run("document.getElementById('q5').scrollIntoView()")?;
    let marked = "[...document.querySelectorAll('nav a[aria-current]')].map((a) => a.hash)";
    let marked = chrome.until(marked, |marked| *marked == json!(["#q5"]))?;
    ensure!(marked == json!(["#q5"]), "{marked}");
    Ok(())
}

/// The milliseconds of the fastest of several frames: two panels of 35 thousand faces, at rest and
/// moving. Other programs slow some frames, so frames are drawn until one is fast enough.
const FRAMES: &str = "() => {
  const [m, n] = [132, 132];
  const points = new Float32Array(4 * m * n);
  const faces = [];
  for (let i = 0; i < m; i++) {
    for (let j = 0; j < n; j++) {
      const [u, v] = [(2 * Math.PI * i) / m, (2 * Math.PI * j) / n];
      const r = 0.65 + 0.3 * Math.cos(v);
      points.set([r * Math.cos(u), r * Math.sin(u), 0.3 * Math.sin(v), 1], 4 * (i * n + j));
      const at = (k, l) => ((i + k) % m) * n + ((j + l) % n);
      faces.push(at(0, 0), at(1, 0), at(0, 1), at(1, 0), at(1, 1), at(0, 1));
    }
  }
  const camera = new fairing.Camera(30, 20);
  const lookup = new Uint8Array(3 * 1024);
  const panels = [0, 1].map(() => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [550, 412];
    const mesh = {vertices: m * n, faces: Uint32Array.from(faces)};
    const scene = {mesh, shape: {points, normals: points}, values: null, camera, lookup, range: [0, 1], pixel: 1};
    return [canvas.getContext('2d'), scene];
  });
  const least = (part, wanted, most) => {
    let best = Infinity;
    for (let k = 0; k < most && best > wanted; k++) {
      camera.turn(3, 1);
      const start = performance.now();
      if (part < 1) fairing.Renderer.drawMoving(panels.map(([target, scene]) => ({target, scene})), part);
      else for (const [target, scene] of panels) fairing.Renderer.draw(target, scene);
      for (const [target] of panels) target.getImageData(0, 0, 1, 1);
      best = Math.min(best, performance.now() - start);
    }
    return best;
  };
  const coarse = () => panels.map(([, {mesh}]) => mesh.coarseFaces.length / 3);
  return [least(1, 0, 12), least(0.5, 30, 300), ...coarse()];
}";

/// A moving picture takes at most 33 ms in software, and a third of the time of one at rest: it has
/// a quarter of the pixels, a sixth of the faces, and no antialiasing.
fn fast(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let found = chrome.run(&format!("({FRAMES})()"))?;
    let [rest, moving] = [0, 1].map(|k| found[k].as_f64().unwrap_or(f64::INFINITY));
    eprintln!("a frame takes {moving:.1} ms while it moves, {rest:.1} ms at rest");
    ensure!(moving < 33.0, "a moving frame takes {moving} ms");
    ensure!(moving < rest / 3.0, "a moving frame takes {moving} ms, one at rest {rest} ms");
    for coarse in [&found[2], &found[3]] {
        ensure!(coarse.as_f64().is_some_and(|n| n < 6000.0), "a moving panel has {coarse} faces");
    }
    Ok(())
}
