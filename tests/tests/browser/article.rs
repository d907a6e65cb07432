//! The page of all experiments, as the step `browser` of `cargo xtask ci` writes it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use fairing_report::model::results::Results;
use serde_json::json;

use crate::Test;
use crate::chrome::Chrome;

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("loads_without_complaint", loads),
        ("every_view_draws_and_every_slider_moves_it", draws),
        ("prints_every_view", prints),
        ("is_at_most_25_screens_of_a_desk", height),
        ("figures_are_numbered", numbered),
        ("figures_of_the_original_report_have_counterparts", mapped),
        ("every_claim_opens_what_decides_it", claims),
        ("pictures_in_columns_keep_their_size_on_a_telephone", keeps),
        ("ids_are_plain_and_captions_begin_with_what_to_see", plain),
    ]
}

/// The page of the last quick run, if there is one.
pub(crate) fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../target/quick-report/report.html")
}

fn open(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let page = page.canonicalize()?;
    chrome.open(&format!("file://{}", page.display()))
}

/// The titles over the columns of a picture would be too small to read, so it scrolls in its own
/// box, which says so; the page does not.
fn keeps(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let screen = json!({"width": 390, "height": 800, "deviceScaleFactor": 1, "mobile": true});
    chrome.call("Emulation.setDeviceMetricsOverride", screen)?;
    open(chrome, page)?;
    let found = chrome.run(
        "(() => {
           document.querySelectorAll('details').forEach((d) => { d.open = true; });
           dispatchEvent(new Event('resize'));
           const pictures = [...document.querySelectorAll('figure.picture > img')];
           const small = pictures.filter((p) => p.clientWidth < p.getAttribute('width') * 0.99);
           const wide = pictures.filter((p) => p.clientWidth > 390);
           const unsaid = wide.filter((p) => !p.parentNode.classList.contains('scrolls'));
           return [small.length, wide.length, unsaid.length, document.documentElement.scrollWidth];
         })()",
    )?;
    ensure!(found[1].as_u64() > Some(0), "no picture is wide: the test shows nothing");
    ensure!(found == json!([0, found[1], 0, 390]), "small, wide, unsaid, width: {found}");
    Ok(())
}

/// No error and no request; every picture exists and has a description. One file below 12 MB.
fn loads(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let bytes = std::fs::metadata(page)?.len();
    ensure!(bytes < 12_000_000, "{bytes} bytes");
    open(chrome, page)?;
    let missing = chrome.run(
        "(async () => {
           const pictures = [...document.querySelectorAll('img')];
           for (const p of pictures) p.loading = 'eager';
           await Promise.all(pictures.map((p) => p.decode().catch(() => 0)));
           const bad = pictures.filter((p) => !p.naturalWidth || !p.alt).map((p) => p.src);
           return [pictures.length, ...bad];
         })()",
    )?;
    let count = missing[0].as_u64().unwrap_or(0);
    ensure!(count > 0 && missing.as_array().is_some_and(|m| m.len() == 1), "{missing}");
    let links = chrome.run(
        "[...document.querySelectorAll('a[href^=\"#\"]')].map((a) => a.getAttribute('href').slice(1))
           .filter((id) => !document.getElementById(id.split('=')[0]))",
    )?;
    ensure!(links.as_array().is_some_and(Vec::is_empty), "links that lead nowhere: {links}");
    let outside: Vec<&String> = chrome
        .requests
        .iter()
        .filter(|url| !["file:", "data:", "blob:", "about:"].iter().any(|s| url.starts_with(s)))
        .collect();
    ensure!(outside.is_empty(), "{outside:?}");
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

/// Digests of the pixels of all canvases, after each slider has moved to its end.
fn draws(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let ids = chrome.run("[...document.querySelectorAll('figure.view')].map((f) => f.id)")?;
    let ids: Vec<&str> =
        ids.as_array().into_iter().flatten().filter_map(|id| id.as_str()).collect();
    ensure!(!ids.is_empty(), "the report has no views");
    for id in ids {
        let found = chrome.run(&format!("({LOOK})('{id}')"))?;
        ensure!(found == "", "{found}");
    }
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

/// Opens a view; returns its problems.
const LOOK: &str = "async (id) => {
  const view = fairing.views.get(id);
  await view.open();
  const look = ({canvas}) => {
    const {width, height} = canvas;
    const d = canvas.getContext('2d').getImageData(0, 0, width, height).data;
    let [drawn, digest] = [0, 0];
    for (let i = 0; i < d.length; i += 4) {
      if (d[i + 3] > 128) drawn += 1;
      digest = (digest * 31 + d[i] + 3 * d[i + 1] + 7 * d[i + 2] + 11 * d[i + 3]) % 1000000007;
    }
    return {share: drawn / (width * height), digest};
  };
  const open = () => view.shown.filter((s) => !s.panel?.hidden);
  const seen = () => open().map((s) => look(s).digest).join();
  for (const shown of open()) {
    const {share} = look(shown);
    if (share < 0.02 || share > 0.95) return `${id}, ${shown.mesh.title}: ${share} of it is drawn`;
  }
  for (const {name, stops, input} of view.sliders) {
    const before = seen();
    const start = Number(input.value);
    const move = (value) => {
      input.value = value;
      input.dispatchEvent(new Event('input'));
    };
    move(start === stops.length - 1 ? 0 : stops.length - 1);
    if (seen() === before) return `${id}: the slider over ${name} changes nothing`;
    move(start);
    if (seen() !== before) return `${id}: the slider over ${name} does not come back`;
  }
  return '';
}";

/// Printing includes views that were never opened.
fn prints(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    chrome.run(
        "(async () => { dispatchEvent(new Event('beforeprint')); await fairing.openAll(); })()",
    )?;
    let closed = chrome.number("document.querySelectorAll('figure.view:not(.open)').length")?;
    ensure!(closed == 0.0, "{closed} views are not on the paper");
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

/// Folds are closed at first, and nothing is wider than the text.
fn height(chrome: &mut Chrome, page: &Path) -> Result<()> {
    const SCREEN: [f64; 2] = [1300.0, 900.0];
    let [width, height] = SCREEN;
    let desk = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
    chrome.call("Emulation.setDeviceMetricsOverride", desk)?;
    open(chrome, page)?;
    let found = chrome.run(
        "(() => {
           const root = document.documentElement;
           const cut = [...document.querySelectorAll('.wide')]
             .filter((w) => w.checkVisibility() && w.scrollWidth > w.clientWidth);
           return [root.scrollHeight, root.scrollWidth, cut.length];
         })()",
    )?;
    let screens = found[0].as_f64().unwrap_or(f64::INFINITY) / height;
    ensure!(screens < 25.0, "the page is {screens:.1} screens long");
    ensure!(found[1] == width && found[2] == 0, "width and tables that are cut: {found}");
    Ok(())
}

/// Figures are numbered from 1 without a gap, in the order of the page. A caption is more than a
/// title.
fn numbered(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let found = chrome.run(
        "(() => {
           const captions = [...document.querySelectorAll('figcaption')].slice(1).map((c) => c.textContent);
           const numbers = captions.map((c) => Number(/^Figure (\\d+)\\./.exec(c)?.[1]));
           return [numbers.every((n, i) => n === i + 1), numbers.length, captions.filter((c) => c.length < 60)];
         })()",
    )?;
    ensure!(found[0] == true && found[1].as_u64() > Some(30), "{found}");
    ensure!(found[2] == json!([]), "{}", found[2]);
    Ok(())
}

/// Every row of the table of claims has a link to a view or a playground in the state that the link
/// names, or to a figure, which is unfolded and marked with its line.
fn claims(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let links = chrome.run(
        "[...document.querySelectorAll('table.claims tr')].filter((row) => row.querySelector('td')).map((row) => (
           [row.querySelector('a').textContent, row.querySelector('a.shown')?.getAttribute('href') ?? '']))",
    )?;
    let links = links.as_array().context("no table of claims")?;
    ensure!(links.len() > 12, "{links:?}");
    for link in links {
        let [claim, href] = [0, 1].map(|k| link[k].as_str().unwrap_or_default());
        ensure!(!href.is_empty(), "claim {claim} shows nothing");
        let found = chrome.run(&format!("({SEE})('{href}')"))?;
        ensure!(found == "", "claim {claim}, {href}: {found}");
    }
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

/// Follows a link; returns the problems at its target.
const SEE: &str = "async (href) => {
  const link = [...document.querySelectorAll('.claim a.shown')].find((a) => a.getAttribute('href') === href);
  if (!link) return 'the claim itself has no link';
  link.click();
  const [id, text] = [...new URLSearchParams(href.slice(1))][0];
  const figure = document.getElementById(id);
  const view = fairing.views.get(id);
  await view?.open();
  for (let k = 0; k < 100; k++) {
    const {top, bottom} = figure.getBoundingClientRect();
    const there = view || figure.classList.contains('marked');
    if (there && top < innerHeight && bottom > 0 && figure.checkVisibility()) break;
    if (k === 99) return there ? 'it is not on the screen' : 'the figure is not marked';
    await new Promise((go) => setTimeout(go, 50));
  }
  if (!view) {
    const tip = figure.querySelector('.tip');
    return !text || (!tip.hidden && tip.textContent.includes(text)) 
      ? '' : `the line is not marked: ${tip?.textContent}`;
  }
  if (view.stages) return view.toText().startsWith(text) ? '' : view.toText();
  const [, stops, field, , , , k] = text.split('!');
  if (stops && stops !== view.state.stops.join('~')) return `stops ${view.state.stops}`;
  if (field && view.chosen()?.name !== field) return `coloured by ${view.chosen()?.name}`;
  return k && Number(view.sum.toText()) !== Number(k) ? `k = ${view.sum.toText()}` : '';
}";

/// Ids are unique and consist of letters, digits and dashes. No caption begins with an instruction.
fn plain(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page)?;
    let found = chrome.run(
        "(() => {
           const ids = [...document.querySelectorAll('[id]')].map((e) => e.id);
           const odd = ids.filter((id) => !/^[A-Za-z][A-Za-z0-9-]*$/.test(id)
             || ids.indexOf(id) !== ids.lastIndexOf(id));
           const captions = [...document.querySelectorAll('figcaption')]
             .map((c) => c.textContent.replace(/^Figure \\d+\\. /, ''));
           return [odd, captions.filter((c) => /^(Compare|Drag|Look|Move|Turn|Watch|Click|See)\\b/.test(c))];
         })()",
    )?;
    ensure!(found == json!([[], []]), "{found}");
    Ok(())
}

/// Each of the twelve figures of the original report has a counterpart that names it.
fn mapped(_: &mut Chrome, page: &Path) -> Result<()> {
    let results = Results::read(&page.with_file_name("results.json"))?;
    let mut named = BTreeSet::new();
    for record in &results.experiments {
        let captions = record.figures.iter().map(|f| &f.caption);
        for caption in captions.chain(record.views.iter().map(|v| &v.caption)) {
            named.extend(theirs(caption));
        }
    }
    ensure!(named == (1..=12).collect(), "{named:?}");
    Ok(())
}

/// The numbers in `Figures 5 to 7 of the original`.
fn theirs(caption: &str) -> Vec<u32> {
    let parts: Vec<&str> = caption.split(" of the original").collect();
    let before = parts[..parts.len() - 1].iter().filter_map(|part| {
        let (_, numbers) = part.rsplit_once("Figure")?;
        let numbers = numbers.trim_start_matches('s').split_whitespace();
        let numbers: Vec<u32> = numbers.filter_map(|word| word.parse().ok()).collect();
        Some(*numbers.first()?..=*numbers.last()?)
    });
    before.flatten().collect()
}
