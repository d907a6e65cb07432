//! Memory: what is loaded and computed is freed.

use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use fairing_mesh::io::VertexFields;
use fairing_shapes as shapes;
use serde_json::json;

use super::{open, ply, quiet};
use crate::chrome::Chrome;

/// The memory of the module, and that of the page after a collection.
pub(super) fn flat(chrome: &mut Chrome, report: &Path) -> Result<()> {
    let script = "const Plain = Worker;
      window.Worker = class extends Plain {
        set onmessage(f) {
          super.onmessage = (event) => {
            if (event.data.size) window.size = event.data.size;
            f(event);
          };
        }
      };";
    chrome.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": script}))?;
    open(chrome, report, "")?;
    let [small, large] =
        [4, 5].map(|level| ply(&shapes::icosphere(level), &VertexFields::default()));
    chrome.run(&format!("window.files = ['{}', '{}']; 0", small?, large?))?;
    // Thirty meshes of half a megabyte come and go between two measurements, with their fields and
    // results. An allocator may still grow before it is full; a leak grows every time.
    let mut before = loaded(chrome, 20)?;
    for _ in 0..3 {
        let now = loaded(chrome, 30)?;
        if now[0] - before[0] < 2e6 && now[1] - before[1] < 5e6 {
            return quiet(chrome);
        }
        before = now;
    }
    anyhow::bail!("the module or the page still grows: {before:?}")
}

/// Loads this many files and runs two tasks on each; returns the bytes of the module and, after a
/// collection, of the page.
fn loaded(chrome: &mut Chrome, files: usize) -> Result<[f64; 2]> {
    let mut size = None;
    // A few at a time: the browser must answer within a minute, on slow machines too.
    for _ in 0..files / 5 {
        let found = chrome.run(
            "(async () => {
               for (let i = 0; i < 5; i++) {
                 await drop('ball.ply', files[i % 2]);
                 for (const name of ['curvature', 'smooth']) { task(name); await press('run'); }
               }
               return [laboratory.took < Infinity, size];
             })()",
        )?;
        ensure!(found[0] == true, "a task failed");
        size = found[1].as_f64();
    }
    chrome.call("HeapProfiler.collectGarbage", json!({}))?;
    let heap = chrome.call("Runtime.getHeapUsage", json!({}))?;
    let page = ["usedSize", "backingStorageSize"].map(|key| heap[key].as_f64().unwrap_or(0.0));
    Ok([size.context("no size")?, page[0] + page[1]])
}
