//! Interactive pages of meshes, as `mesh.show()` makes them in Python.

use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use fairing_figure::{Exhibit, Field, Up, page};
use fairing_shapes as shapes;

use crate::chrome::Chrome;
use crate::{Test, scene};

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("meshes_are_drawn_without_complaint_or_request", draws),
        ("one_camera_turns_all_meshes", turns),
        ("frames_in_one_document_do_not_meet", frames),
        ("half_a_million_faces_open_and_turn_quickly", large),
    ]
}

/// The page of two meshes, one with a field that is undefined at some vertices.
fn made() -> Result<String> {
    let (noisy, truth) = (scene::noisy(), scene::truth());
    let heights: Vec<f64> = noisy.positions().iter().map(|p| p[1]).collect();
    let hidden: Vec<bool> = noisy.positions().iter().map(|p| p[0] > 0.5).collect();
    let height = Field::new(&heights).undefined_where(&hidden)?;
    let exhibits = [
        Exhibit { title: "noisy".into(), mesh: &noisy, fields: vec![("height".into(), height)] },
        Exhibit { title: "truth".into(), mesh: &truth, fields: vec![] },
    ];
    Ok(page(&exhibits, Some("height"), Up::Y)?)
}

/// Opens a document, which stands beside the page of the report.
fn open(chrome: &mut Chrome, page: &Path, html: &str) -> Result<()> {
    let file = page.with_file_name("show.html");
    std::fs::write(&file, html)?;
    chrome.open(&format!("file://{}", file.display()))
}

/// Of each canvas the fraction of pixels that are drawn, the fraction of those that have a colour,
/// and a digest.
fn pictures(chrome: &mut Chrome) -> Result<Vec<[f64; 3]>> {
    let value = chrome.run(
        "(async () => {
           await new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)));
           return [...document.querySelectorAll('canvas')].map((c) => {
             const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
             let [drawn, colored, digest] = [0, 0, 0];
             for (let i = 0; i < d.length; i += 4) {
               if (d[i + 3] > 128) drawn += 1;
               if (Math.max(d[i], d[i + 1], d[i + 2]) - Math.min(d[i], d[i + 1], d[i + 2]) > 60) colored += 1;
               digest = (digest * 31 + d[i] + 3 * d[i + 1] + 7 * d[i + 2]) % 1000000007;
             }
             return [drawn / (c.width * c.height), colored / drawn, digest];
           });
         })()",
    )?;
    Ok(serde_json::from_value(value)?)
}

fn draws(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, &made()?)?;
    let seen = pictures(chrome)?;
    let [noisy, truth] = seen[..].try_into().context("not two pictures")?;
    ensure!([noisy, truth].iter().all(|p| (0.05..0.8).contains(&p[0])), "{seen:?}");
    // One mesh has a colour, but for its grey part.
    ensure!((0.1..0.95).contains(&noisy[1]) && truth[1] < 0.01, "{seen:?}");
    let words = chrome.run(
        "[document.querySelectorAll('.bar svg').length, document.querySelector('.bar .name').textContent,
          document.querySelector('[data-part=field]').value]",
    )?;
    ensure!(words[0] == 1 && words[2] == "height", "{words}");
    ensure!(words[1].as_str().is_some_and(|w| w.contains("undefined")), "{words}");
    chrome.picture("show")?;
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    let outside = |url: &&String| !url.starts_with("file:") && !url.starts_with("data:");
    let outside: Vec<_> = chrome.requests.iter().filter(outside).collect();
    ensure!(outside.is_empty(), "{outside:?}");
    Ok(())
}

fn turns(chrome: &mut Chrome, page: &Path) -> Result<()> {
    open(chrome, page, &made()?)?;
    let before = pictures(chrome)?;
    chrome.run(
        "document.querySelector('canvas').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'}))",
    )?;
    let after = pictures(chrome)?;
    ensure!(before.iter().zip(&after).all(|(a, b)| a[2] != b[2]), "{before:?}, {after:?}");
    chrome.run(
        "document.querySelector('canvas').dispatchEvent(new KeyboardEvent('keydown', {key: 'n'}))",
    )?;
    let words = chrome.run("document.querySelector('[data-part=words]').textContent")?;
    let words = words.as_str().unwrap_or_default();
    ensure!(words.starts_with("Vertex 0. noisy: (") && words.contains(". truth: ("), "{words}");
    Ok(())
}

/// Limits are several times the seconds taken where a processor draws in place of a graphics card.
fn large(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let ring = shapes::torus(1.0, 0.4, 1000, 250);
    let heights: Vec<f64> = ring.positions().iter().map(|p| p[1]).collect();
    let fields = vec![("height".to_owned(), Field::new(&heights))];
    let exhibits = [Exhibit { title: "ring".into(), mesh: &ring, fields }];
    let html = fairing_figure::page(&exhibits, Some("height"), Up::Y)?;
    ensure!((14e6..16e6).contains(&(html.len() as f64)), "{} bytes", html.len());
    let start = Instant::now();
    open(chrome, page, &html)?;
    let seen = pictures(chrome)?;
    let opened = start.elapsed().as_secs_f64();
    ensure!(seen.len() == 1 && seen[0][1] > 0.5, "{seen:?}");
    let start = Instant::now();
    chrome.run(
        "document.querySelector('canvas').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft'}))",
    )?;
    let turned = pictures(chrome)?;
    let turning = start.elapsed().as_secs_f64();
    ensure!(turned[0][2] != seen[0][2], "{turned:?}");
    ensure!(opened < 20.0 && turning < 10.0, "{opened:.1} s to open, {turning:.1} s to turn");
    Ok(())
}

/// Two cells of a notebook with a dark ground.
fn frames(chrome: &mut Chrome, page: &Path) -> Result<()> {
    let escaped = made()?.replace('&', "&amp;").replace('"', "&quot;");
    let frame =
        format!("<iframe style=\"width: 600px; height: 400px\" srcdoc=\"{escaped}\"></iframe>");
    let html = format!(
        "<!DOCTYPE html><html data-ready=\"1\"><head><meta charset=\"utf-8\"></head>\
         <body style=\"background: #111\">{frame}{frame}</body></html>"
    );
    open(chrome, page, &html)?;
    let ready = chrome.until(
        "[...document.querySelectorAll('iframe')].map((f) => f.contentDocument?.documentElement?.dataset)
           .map((d) => `${d?.ready} ${d?.theme}`).join()",
        |value| *value == "1 dark,1 dark",
    )?;
    ensure!(ready == "1 dark,1 dark", "{ready}");
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}
