//! The laboratory from disk: opening, computing, looking, and taking results along.

mod memory;
mod values;

use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use fairing_mesh::io::{self, Format, VertexFields, WriteOptions};
use fairing_mesh::{Diagnosis, TriMesh};
use fairing_shapes as shapes;
use serde_json::{Value, json};

use crate::Test;
use crate::chrome::Chrome;

pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![
        ("fifty_meshes_leave_memory_flat", memory::flat),
        ("every_sample_opens_and_every_task_runs", tasks),
        ("a_dropped_mesh_shows_its_field_with_a_histogram", values::fields),
        ("values_that_are_undefined_are_no_numbers", values::undefined),
        ("a_vertex_is_picked_with_all_its_values", values::picks),
        ("moved_vertices_have_no_values_of_earlier_positions", values::moves),
        ("fields_of_a_file_stay_whatever_their_names", values::provenance),
        ("sliders_and_numbers_move_together_and_take_the_step_again", sliders),
        ("steps_are_undone_and_taken_again", history),
        ("copied_programs_give_the_same_bits", programs),
        ("a_link_takes_the_steps_on_a_sample", links),
        ("every_format_is_downloaded", downloads),
        ("broken_files_are_refused_in_words", broken),
        ("an_address_on_the_same_server_is_opened_and_no_other", addresses),
        ("without_webgl_it_says_so", plain),
    ]
}

/// The page, written beside that of the report.
fn made(report: &Path) -> Result<PathBuf> {
    let page = report.with_file_name("fairing.html");
    if !page.is_file() {
        let module = std::env::var_os("FAIRING_WEB_MODULE").map_or_else(
            || Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/web/assets/fairing.wasm.gz"),
            PathBuf::from,
        );
        std::fs::write(&page, fairing_report::page::laboratory(&std::fs::read(module)?)?)?;
    }
    Ok(page)
}

/// `act` does something and waits for its end; `drop` drops a file whose bytes are in base64.
const HELPERS: &str = "
window.act = async (does) => {
  laboratory.took = null;
  does();
  while (laboratory.took === null || laboratory.busy) await new Promise((go) => setTimeout(go, 5));
  await new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)));
  return laboratory.part.words.textContent;
};
window.drop = (name, text) => act(() => {
  const dataTransfer = new DataTransfer();
  dataTransfer.items.add(new File([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))], name));
  document.dispatchEvent(new DragEvent('drop', {dataTransfer, cancelable: true}));
});
window.press = (name) => act(() => laboratory.part[name].click());
window.sample = (name) => act(() => [...laboratory.part.samples.children].find((b) => b.textContent === name).click());
window.task = (name, values = {}) => {
  laboratory.turnTo(name);
  for (const [key, value] of Object.entries(values)) laboratory.forms[name].inputs.get(key).value = value;
};
window.seen = () => [...document.querySelectorAll('.panels canvas')].map((c) => (
  c.getContext('2d').getImageData(0, 0, c.width, c.height).data
    .reduce((sum, x, i) => (sum * 31 + x * (i % 7)) % 1000000007, 7)));
0";

/// Opens the page; `after` is the part of its address after `#`.
fn open(chrome: &mut Chrome, report: &Path, after: &str) -> Result<()> {
    chrome.open(&format!("file://{}{after}", made(report)?.display()))?;
    chrome.run(HELPERS).map(drop)
}

/// The bytes of a mesh as PLY, in base64.
fn ply(mesh: &TriMesh, fields: &VertexFields) -> Result<String> {
    let bytes = io::to_bytes(Format::Ply, mesh, fields, &WriteOptions::default())?;
    Ok(BASE64.encode(bytes))
}

fn drop_mesh(chrome: &mut Chrome, name: &str, mesh: &TriMesh) -> Result<Value> {
    let bytes = ply(mesh, &VertexFields::default())?;
    chrome.run(&format!("drop({name:?}, '{bytes}')"))
}

/// The mesh of the last step.
fn last(chrome: &mut Chrome) -> Result<TriMesh> {
    let found = chrome.run(
        "(() => { const {positions, faces} = laboratory.last.arrays; return [[...positions], [...faces]]; })()",
    )?;
    let [positions, faces] = [0, 1].map(|k| found[k].as_array().cloned().unwrap_or_default());
    let positions: Vec<f64> = positions.iter().filter_map(Value::as_f64).collect();
    let faces: Vec<u32> = faces.iter().filter_map(|v| v.as_u64().map(|v| v as u32)).collect();
    Ok(TriMesh::new(positions.as_chunks().0.to_vec(), faces.as_chunks().0.to_vec())?)
}

fn quiet(chrome: &Chrome) -> Result<()> {
    ensure!(chrome.complaints.is_empty(), "{:?}", chrome.complaints);
    Ok(())
}

fn tasks(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let samples = chrome.run(
        "(async () => {
           const found = [];
           for (const {textContent: name} of [...laboratory.part.samples.children]) {
             const words = await sample(name);
             found.push([name, words, laboratory.steps.length, laboratory.last.title]);
           }
           return found;
         })()",
    )?;
    let samples = samples.as_array().context("no samples")?;
    ensure!(samples.len() > 5, "{samples:?}");
    for one in samples {
        ensure!(one[1] == "" && one[2] == 1 && one[3] == one[0], "{one}");
    }
    let tasks = chrome.run(
        "(async () => {
           await sample('torus');
           const found = [];
           const verbs = 'noise denoise smooth curvature spectrum reconstruct distance repair compare';
           for (const name of verbs.split(' ')) {
             const before = seen().join();
             task(name, name === 'distance' ? {sources: '0'} : {});
             if (!laboratory.part.add.hidden) await press('add');
             else await press('run');
             found.push([name, laboratory.part.words.className, laboratory.took < Infinity, seen().join() !== before]);
           }
           return [found, laboratory.steps.map((s) => s.request.verb), [...laboratory.last.fields.keys()],
             laboratory.part.info.textContent];
         })()",
    )?;
    for one in tasks[0].as_array().into_iter().flatten() {
        // A comparison is a table, and a repair finds nothing to do.
        let looks = one[0] == "compare" || one[0] == "repair" || one[3] == true;
        ensure!(one[1] == "hint" && one[2] == true && looks, "{one}");
    }
    let taken = json!(["sample", "noise", "denoise", "smooth", "reconstruct", "repair"]);
    ensure!(tasks[1] == taken, "{}", tasks[1]);
    ensure!(tasks[3].as_str().is_some_and(|t| t.contains("Hausdorff")), "{}", tasks[3]);
    chrome.picture("laboratory")?;
    let accepted = chrome.run("laboratory.part.file.accept")?;
    let accepted: Vec<&str> = accepted.as_str().unwrap_or_default().split(',').collect();
    let endings = Format::ALL.iter().flat_map(|format| format.extensions());
    for ending in endings.chain(&["gz"]) {
        ensure!(accepted.contains(&&*format!(".{ending}")), "{ending} is not in {accepted:?}");
    }
    let outside = |url: &&String| !["file:", "data:", "blob:"].iter().any(|s| url.starts_with(s));
    let outside: Vec<_> = chrome.requests.iter().filter(outside).collect();
    ensure!(outside.is_empty(), "{outside:?}");
    quiet(chrome)
}

fn sliders(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let found = chrome.run(
        "(async () => {
           await sample('sphere');
           task('noise');
           await press('run');
           laboratory.took = 0;
           const {place, inputs} = laboratory.forms.noise;
           const [slider, number] = [place.querySelector('input[type=range]'), inputs.get('sigma')];
           const sigma = () => [laboratory.steps.length, laboratory.last.request.values.sigma,
             number.value, Number(slider.value)];
           const move = (input, value, name) => act(() => {
             input.value = value;
             input.dispatchEvent(new Event(name));
           });
           await move(slider, '0.6', 'input');
           const states = [sigma()];
           laboratory.took = 0;
           await move(number, '0.9', 'change');
           return [...states, sigma(), [slider.min, slider.max]];
         })()",
    )?;
    let expected = json!([[2, "0.6", "0.6", 0.6], [2, "0.9", "0.9", 0.9], ["0", "1.2"]]);
    ensure!(found == expected, "{found}");
    quiet(chrome)
}

fn history(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let found = chrome.run(
        "(async () => {
           const settled = async () => {
             for (let before = '', now = `${seen()}`; ; before = now, now = `${seen()}`) {
               if (now === before) return now;
               await new Promise((go) => setTimeout(go, 100));
             }
           };
           const size = () => laboratory.last.arrays.positions.reduce((s, x) => s + x * x, 0);
           const state = async () => `${laboratory.steps.length} ${size()} ${await settled()}`;
           const key = (shiftKey) => act(() => document.body.dispatchEvent(new KeyboardEvent('keydown',
             {key: shiftKey ? 'Z' : 'z', ctrlKey: true, shiftKey, bubbles: true})));
           await sample('block');
           const states = [await state()];
           task('noise');
           await press('run');
           states.push(await state());
           task('smooth', {iterations: '3'});
           await press('run');
           states.push(await state());
           await press('undo');
           states.push(await state());
           await key(false);
           states.push(await state());
           const {undo, redo} = laboratory.part;
           const ends = [undo.disabled, redo.disabled];
           await press('redo');
           states.push(await state());
           await key(true);
           states.push(await state());
           return [states, ends, redo.disabled, laboratory.part.steps.children.length];
         })()",
    )?;
    let states = found[0].as_array().context("no states")?;
    ensure!(states[0] != states[1] && states[1] != states[2], "{found}");
    let again = [3, 4, 5, 6].map(|i| &states[i]);
    ensure!(again == [1, 0, 1, 2].map(|i| &states[i]), "{found}");
    ensure!(found[1] == json!([true, false]) && found[2] == true && found[3] == 3, "{found}");
    quiet(chrome)
}

/// A program that the page copies, as it is.
#[expect(clippy::needless_update, reason = "later versions may have more options")]
#[expect(clippy::too_many_lines, reason = "a program written by the page")]
mod copied {
    include!("copied.txt");

    pub(super) fn run() -> Result<(), Box<dyn std::error::Error>> {
        main()
    }
}

/// Takes the steps of the copied programs on a mesh from a file.
const STEPS: &str = "(async () => {
  task('noise', {sigma: '0.2', seed: '3'});
  await press('run');
  task('smooth', {lambda: '0.3', iterations: '2'});
  await press('run');
  laboratory.forms.denoise.method = 'bilateral-normal';
  laboratory.forms.denoise.build();
  task('denoise');
  await press('run');
  task('repair', {tolerance: '0.01', holes: '30'});
  await press('run');
  task('curvature');
  await press('run');
  task('distance', {sources: '0,5-6'});
  await press('run');
  task('spectrum', {k: '12'});
  await press('run');
  laboratory.part.mode.value = 3;
  await act(() => laboratory.part.mode.dispatchEvent(new Event('input')));
  task('compare', {'feature-angle': '40'});
  await press('run');
  let text;
  navigator.clipboard.writeText = async (given) => { text = given; };
  const all = [];
  for (const language of ['shell', 'rust', 'python']) {
    laboratory.part.language.value = language;
    await laboratory.copy();
    all.push(text);
  }
  const fields = Object.fromEntries([...laboratory.last.fields].map(([name, values]) => [name, [...values]]));
  const listed = [...laboratory.part.steps.lastChild.querySelectorAll('li')].map((li) => li.textContent);
  return [all, laboratory.part.words.textContent,
    laboratory.part.language.querySelector('[value=link]').disabled, fields, listed];
})()";

/// The program and the crates do what the page did. The package for Python runs the third text in
/// its own tests.
fn programs(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let folder = tempfile::tempdir()?;
    let pipe = shapes::cylinder(0.5, 2.0, 24, 20, shapes::Ends::Open);
    io::write(folder.path().join("pipe.ply"), &pipe)?;
    drop_mesh(chrome, "pipe.ply", &pipe)?;
    let found = chrome.run(STEPS)?;
    ensure!(found[1] == "Copied." && found[2] == true, "{found}");
    let listed = json!([
        "Curvature: adaptive",
        "Distance: sources 0,5-6",
        "Modes: k 12",
        "Compare: feature-angle 40"
    ]);
    ensure!(found[4] == listed, "{}", found[4]);
    let [shell, rust, python] = [0, 1, 2].map(|k| found[0][k].as_str().unwrap_or_default());
    ensure!(rust == include_str!("copied.txt"), "{rust}");
    ensure!(python == include_str!("../../../python/examples/laboratory.py"), "{python}");
    let shown = last(chrome)?;
    ensure!(Diagnosis::new(&shown).closed, "the ends of the pipe are open");

    let program = fairing_tests::program();
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let own = program.parent().map(Path::to_path_buf);
    let paths = std::env::join_paths(own.into_iter().chain(std::env::split_paths(&paths)))?;
    let output =
        Command::new("sh").args(["-ec", shell]).env("PATH", paths).current_dir(&folder).output()?;
    ensure!(output.status.success(), "{shell}: {}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    ensure!(printed.contains("Hausdorff"), "{printed}");
    let here = std::env::current_dir()?;
    std::env::set_current_dir(&folder)?;
    let ran = copied::run().map_err(|error| anyhow::anyhow!("{error}"));
    std::env::set_current_dir(here)?;
    ran?;
    for (file, mesh, names) in FILES {
        let read = io::read(folder.path().join(file))?;
        ensure!(read.mesh == *if mesh { &shown } else { &pipe }, "{file} differs");
        for name in names {
            let values = read.fields.scalar(name).with_context(|| format!("{file}: {name}"))?;
            if mesh {
                same_values(name, values, &found[3][name]).context(file)?;
            }
        }
    }
    let modes = fairing_spectral::Spectrum::load(folder.path().join("pipe-4-modes.npz"))?;
    let mode = modes.modes.column(3).to_vec();
    same_values("mode", &mode, &found[3]["mode"])?;
    quiet(chrome)
}

/// The files of the copied programs with their fields: of the result, or of the first mesh.
const FILES: [(&str, bool, &[&str]); 7] = [
    ("pipe-4.ply", true, &[]),
    ("pipe-4-curvature.ply", true, &["mean", "gaussian", "kappa1", "kappa2"]),
    ("pipe-4-distance.ply", true, &["distance"]),
    ("pipe-fairing.ply", true, &["mean", "gaussian", "kappa1", "kappa2", "distance", "mode"]),
    ("pipe-curvature.ply", false, &["mean"]),
    ("pipe-distance.ply", false, &["distance"]),
    ("pipe-0.ply", false, &["mean", "distance", "mode"]),
];

/// Values agree: in all bits, or to the rounding of a factorisation; modes up to their sign.
fn same_values(name: &str, values: &[f64], shown: &Value) -> Result<()> {
    let shown: Vec<f64> =
        shown.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
    ensure!(values.len() == shown.len() && !values.is_empty(), "{name}: {} values", shown.len());
    let off = |sign: f64| {
        let pairs = values.iter().zip(&shown);
        pairs.map(|(a, b)| (sign * a - b).abs()).fold(0.0, f64::max)
    };
    let (off, limit) = match name {
        "distance" => (off(1.0), 1e-8),
        "mode" => (off(1.0).min(off(-1.0)), 1e-6),
        _ => (off(1.0), 0.0),
    };
    ensure!(off <= limit, "{name} is off by {off:e}");
    Ok(())
}

fn links(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let link = chrome.run(
        "(async () => {
           await sample('cube');
           task('noise', {sigma: '0.1'});
           await press('run');
           task('smooth');
           await press('run');
           task('distance', {sources: '7'});
           await press('run');
           return laboratory.written('link');
         })()",
    )?;
    let (_, after) = link.as_str().and_then(|link| link.split_once('#')).context("no link")?;
    let before = last(chrome)?;
    chrome.new_tab()?;
    open(chrome, report, &format!("#{after}"))?;
    ensure!(last(chrome)? == before, "{link} leads elsewhere");
    let zero = chrome.run("laboratory.last.fields.get('distance')[7]")?;
    ensure!(zero.as_f64().is_some_and(|d| d.abs() < 1e-9), "{zero}");
    chrome.new_tab()?;
    open(chrome, report, "#sample=cube&step=smooth~sandpaper")?;
    let words = chrome.run("laboratory.part.words.textContent")?;
    ensure!(words.as_str().is_some_and(|w| w.contains("sandpaper")), "{words}");
    quiet(chrome)
}

fn downloads(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let found = chrome.run(
        "(async () => {
           await sample('torus');
           task('noise');
           await press('run');
           task('curvature');
           await press('run');
           const made = [];
           URL.createObjectURL = (blob) => { made.push(blob); return 'data:,'; };
           HTMLAnchorElement.prototype.click = function () { made.push(this.download); };
           const all = [laboratory.part.format.value];
           for (const {value} of [...laboratory.part.format.options]) {
             laboratory.part.format.value = value;
             laboratory.part.format.dispatchEvent(new Event('input'));
             const lost = laboratory.part.lost.textContent;
             await press('download');
             const [blob, name] = made.splice(0);
             const bytes = new Uint8Array(await blob.arrayBuffer());
             all.push([name, btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join('')), lost]);
           }
           return all;
         })()",
    )?;
    let shown = last(chrome)?;
    let folder = tempfile::tempdir()?;
    let [usual, files @ ..] = &found.as_array().context("no downloads")?[..] else {
        anyhow::bail!("no downloads")
    };
    ensure!(usual == "ply" && files.len() == Format::ALL.len(), "{usual}, {} files", files.len());
    for file in files {
        let name = file[0].as_str().unwrap_or_default();
        ensure!(name.starts_with("torus-fairing."), "{name}");
        let path = folder.path().join(name);
        std::fs::write(&path, BASE64.decode(file[1].as_str().unwrap_or_default())?)?;
        let read = io::read(&path)?;
        let holds = read.report.format.holds();
        ensure!(read.mesh.face_count() == shown.face_count(), "{name} has other faces");
        // Others round to single precision.
        let same = read.mesh == shown || !holds.exact;
        ensure!(same, "{name} holds another mesh");
        // The page has said beforehand what is lost.
        let fields = read.fields.scalars.iter().any(|(name, _)| name == "mean");
        let lost = file[2].as_str().unwrap_or_default();
        ensure!(fields || !name.ends_with(".ply"), "{name} has lost its fields");
        ensure!(fields != lost.contains("mean curvature"), "{name}: {lost}");
        ensure!(lost.contains("32 bits") != holds.exact, "{name}: {lost}");
    }
    quiet(chrome)
}

/// After each, a sample can be opened.
fn broken(chrome: &mut Chrome, report: &Path) -> Result<()> {
    open(chrome, report, "")?;
    let sphere = shapes::icosphere(2);
    let whole = BASE64.decode(ply(&sphere, &VertexFields::default())?)?;
    let noise: Vec<u8> =
        (0..2000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    let files: [(&str, &[u8]); 10] = [
        ("empty.obj", b""),
        ("noise.ply", &noise),
        ("noise.stl", &noise),
        ("noise.bin", &noise),
        ("short.ply", &whole[..whole.len() / 2]),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("number.obj", b"v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        (
            "huge.ply",
            b"ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n",
        ),
        ("letter.off", b"OFF\n3 1 0\na b c\n"),
        ("packed.ply.gz", b"\x1f\x8b\x08\x00garbage"),
    ];
    for (name, bytes) in files {
        let found = chrome.run(&format!(
            "(async () => {{
               const words = await drop('{name}', '{}');
               const kind = laboratory.part.words.className;
               return [words, kind, await sample('cube'), laboratory.steps.length];
             }})()",
            BASE64.encode(bytes)
        ))?;
        let words = found[0].as_str().unwrap_or_default();
        ensure!(words.len() > 10 && found[1] == "error", "{name}: {found}");
        ensure!(!words.contains("defect") && found[2] == "" && found[3] == 1, "{name}: {found}");
    }
    quiet(chrome)
}

/// A server with the page at `/` and a mesh everywhere else, for a number of requests.
fn serve(page: PathBuf, mesh: Vec<u8>) -> Result<u16> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let port = listener.local_addr()?.port();
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let Ok(mut stream) = stream else { return };
            let mut request = [0; 4096];
            let length = stream.read(&mut request).unwrap_or(0);
            let (kind, body) = if request[..length].starts_with(b"GET / ") {
                ("text/html", std::fs::read(&page).unwrap_or_default())
            } else {
                ("application/octet-stream", mesh.clone())
            };
            let head = format!(
                "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
                body.len()
            );
            // The browser may have gone.
            let _ = stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(&body));
        }
    });
    Ok(port)
}

fn addresses(chrome: &mut Chrome, report: &Path) -> Result<()> {
    let sphere = shapes::icosphere(3);
    let bytes = BASE64.decode(ply(&sphere, &VertexFields::default())?)?;
    let port = serve(made(report)?, bytes)?;
    chrome.open(&format!("http://127.0.0.1:{port}/"))?;
    chrome.run(HELPERS)?;
    let paste = |text: &str| {
        format!(
            "(async () => {{
               const clipboardData = new DataTransfer();
               clipboardData.setData('text/plain', '{text}');
               document.body.dispatchEvent(new ClipboardEvent('paste', {{clipboardData, bubbles: true}}));
               const {{words}} = laboratory.part;
               while (!laboratory.last && !words.textContent) await new Promise((go) => setTimeout(go, 5));
               return [words.textContent, laboratory.steps.length];
             }})()"
        )
    };
    let before = chrome.requests.len();
    let refused = chrome.run(&paste("http://example.org/scan.ply"))?;
    let words = refused[0].as_str().unwrap_or_default();
    ensure!(words.contains("not on the server of this page") && refused[1] == 0, "{refused}");
    ensure!(chrome.requests.len() == before, "{:?}", chrome.requests);
    chrome.run("laboratory.say('')")?;
    let opened = chrome.run(&paste("/scans/ball.ply"))?;
    ensure!(opened[1] == 1 && last(chrome)? == sphere, "{opened}");
    let name = chrome.run("laboratory.name")?;
    ensure!(name == "ball.ply", "{name}");
    quiet(chrome)
}

fn plain(chrome: &mut Chrome, report: &Path) -> Result<()> {
    let script = "HTMLCanvasElement.prototype.getContext = () => null;
      OffscreenCanvas.prototype.getContext = () => null;";
    chrome.call("Page.addScriptToEvaluateOnNewDocument", json!({"source": script}))?;
    let url = format!("file://{}", made(report)?.display());
    chrome.call("Page.navigate", json!({"url": url}))?;
    let words = chrome
        .until("document.querySelector('[data-part=loading]')?.textContent ?? ''", |words| {
            words.as_str().is_some_and(|w| w.contains("WebGL"))
        })?;
    ensure!(words.as_str().is_some_and(|w| w.contains("no WebGL 2")), "{words}");
    Ok(())
}
