//! The committed report, as a person who has cloned the repository opens it.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};

use crate::Test;
use crate::chrome::Chrome;

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("loads_without_complaint", loads),
        ("every_view_draws_and_every_slider_moves_it", draws),
        ("prints_every_view", prints),
    ]
}

/// Where it is; there need not be one.
pub(crate) fn page() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/report/report.html")
}

fn open(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let page = page.canonicalize()?;
    chrome.open(&format!("file://{}", page.display()))
}

/// No error, no request to anywhere, and every picture is there and described.
fn loads(chrome: &mut Chrome, page: &Path) -> Result<()> {
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

/// Looks at the pixels of all canvases, and moves each slider to its end.
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

/// Opens a view; says what is wrong with it.
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

/// Paper shows views that nobody has opened.
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
