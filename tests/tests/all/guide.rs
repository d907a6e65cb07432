//! The guide and the README: their commands print what they show and draw their pictures.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use fairing_operators::curvature::Estimator;

use crate::command_line::program;

/// The largest mean difference of a colour channel between a picture and its command, of 255: the
/// renderer may change slightly before pictures have to be drawn again.
const MAX_DIFFERENCE: f64 = 2.0;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The paths of the README and of the guide's pages with their texts, in the order of their names.
fn pages() -> Vec<(PathBuf, String)> {
    let entries = fs::read_dir(root().join("docs/guide/src")).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path()).chain([root().join("README.md")]);
    let pages = paths.filter(|path| path.extension().is_some_and(|e| e == "md"));
    let mut pages: Vec<(PathBuf, String)> = pages.map(|page| (page.clone(), read(&page))).collect();
    pages.sort();
    pages
}

fn read(page: &Path) -> String {
    fs::read_to_string(page).unwrap().replace("\r\n", "\n")
}

/// The blocks of code, each with its language.
fn blocks(text: &str) -> Vec<(&str, &str)> {
    let fences = text.split("```").skip(1).step_by(2);
    fences.map(|block| block.split_once('\n').unwrap_or((block, ""))).collect()
}

/// The commands of a block, each with the lines shown below it.
fn commands(block: &str) -> Vec<(&str, Vec<&str>)> {
    let mut found: Vec<(&str, Vec<&str>)> = vec![];
    for line in block.lines() {
        match (line.strip_prefix("$ "), found.last_mut()) {
            (Some(command), _) => found.push((command, vec![])),
            (None, Some((_, shown))) => shown.push(line),
            (None, None) => panic!("a listing begins with `{line}`, not with a command"),
        }
    }
    found
}

/// The words of a command as a shell splits them: quotes hold a word together, and one star in a
/// word stands for the files of a folder.
fn words(command: &str, folder: &Path) -> Vec<String> {
    let mut words = vec![];
    for (i, piece) in command.split('\'').enumerate() {
        if i % 2 == 1 {
            words.push(piece.to_owned());
            continue;
        }
        for word in piece.split_whitespace() {
            let Some((before, after)) = word.split_once('*') else {
                words.push(word.to_owned());
                continue;
            };
            let inside = before.trim_end_matches(|c| c != '/');
            let entries = fs::read_dir(folder.join(inside)).unwrap();
            let mut files: Vec<String> = entries
                .map(|entry| format!("{inside}{}", entry.unwrap().file_name().to_str().unwrap()))
                .filter(|file| file.starts_with(before) && file.ends_with(after))
                .collect();
            assert!(!files.is_empty(), "`{command}`: no file is {word}");
            files.sort();
            words.extend(files);
        }
    }
    words
}

/// Returns true if the lines are the shown ones, in which `…` stands for any text, and alone for
/// any lines.
fn fits(shown: &[&str], lines: &[&str]) -> bool {
    match shown.split_first() {
        None => lines.is_empty(),
        Some((&"…", rest)) => (0..=lines.len()).any(|n| fits(rest, &lines[n..])),
        Some((first, rest)) => lines
            .split_first()
            .is_some_and(|(line, more)| line_fits(first, line) && fits(rest, more)),
    }
}

fn line_fits(shown: &str, line: &str) -> bool {
    let Some((head, tail)) = shown.split_once('…') else { return shown == line };
    let Some(rest) = line.strip_prefix(head) else { return false };
    let ends = rest.char_indices().map(|(i, _)| i).chain([rest.len()]);
    ends.into_iter().any(|end| line_fits(tail, &rest[end..]))
}

/// Runs a command of the program, or makes a folder, and compares the output with the shown lines;
/// returns the fault, if any. A command fails exactly if an error is shown.
fn fault(folder: &Path, command: &str, shown: &[&str]) -> Option<String> {
    let words = words(command, folder);
    match words.first().map(String::as_str) {
        Some("fairing") => {}
        Some("mkdir") => {
            return fs::create_dir(folder.join(&words[1])).err().map(|e| e.to_string());
        }
        _ => return Some(format!("`{command}` is not run by any test")),
    }
    // Both streams in one file, in their order, as on a terminal.
    let path = folder.join("output.txt");
    let file = fs::File::create(&path).unwrap();
    let status = Command::new(program())
        .args(&words[1..])
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(file.try_clone().unwrap())
        .stderr(file)
        .status()
        .expect("the program runs");
    let output = fs::read_to_string(&path).unwrap();
    fs::remove_file(&path).unwrap();
    let lines: Vec<&str> = output.lines().map(str::trim_end).collect();
    let fails = shown.iter().any(|line| line.contains("error: "));
    let as_shown = shown.is_empty() || fits(shown, &lines);
    (status.success() == fails || !as_shown)
        .then(|| format!("`{command}` prints\n{output}and not\n{}\n", shown.join("\n")))
}

fn decode(path: &Path) -> (png::OutputInfo, Vec<u8>) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    (info, pixels)
}

/// Compares a committed picture with the one that the commands of its page have drawn; returns the
/// fault, if any. A missing picture is drawn.
fn picture_fault(folder: &Path, committed: &Path) -> Option<String> {
    let name = committed.file_name().unwrap().to_str().unwrap();
    let drawn = folder.join(name);
    if !drawn.is_file() {
        return Some(format!("no command of the page draws {name}"));
    }
    if !committed.is_file() {
        fs::copy(&drawn, committed).unwrap();
        return Some(format!("{name} was missing; look at it and commit it"));
    }
    let ((old, before), (new, after)) = (decode(committed), decode(&drawn));
    let sum: f64 = before.iter().zip(&after).map(|(a, b)| f64::from(a.abs_diff(*b))).sum();
    let is_same = old == new && sum <= MAX_DIFFERENCE * before.len() as f64;
    (!is_same).then(|| format!("{name} looks different; delete it, and this test draws it again"))
}

/// All commands of the guide, its pictures too: ten seconds, because no other test runs what a page
/// shows.
#[test]
fn commands_print_what_their_pages_show() {
    let mut faults = vec![];
    for (page, text) in pages() {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().join("data");
        fs::create_dir(&data).unwrap();
        for entry in fs::read_dir(root().join("data")).unwrap() {
            let path = entry.unwrap().path();
            fs::copy(&path, data.join(path.file_name().unwrap())).unwrap();
        }
        let mut found = vec![];
        for (language, block) in blocks(&text) {
            match language {
                "console" => found.extend(
                    commands(block)
                        .iter()
                        .filter_map(|(command, shown)| fault(folder.path(), command, shown)),
                ),
                // Doc tests and tests of the Python package; the others are not programs.
                "rust" | "python" | "text" | "sh" => {}
                _ => found.push(format!("no test runs code in `{language}`")),
            }
        }
        let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        // Pictures of other packages are compared by the tests of the Python package.
        let pictures = targets.filter(|target| {
            let name = target.trim_start_matches("pictures/");
            let is_python =
                |(language, code): &(&str, &str)| *language == "python" && code.contains(name);
            target.ends_with(".png") && !blocks(&text).iter().any(is_python)
        });
        let pictures = pictures.map(|target| page.with_file_name(target));
        found.extend(pictures.filter_map(|picture| picture_fault(folder.path(), &picture)));
        faults.extend(found.into_iter().map(|fault| format!("{}: {fault}", page.display())));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn an_ellipsis_stands_for_any_text_and_any_lines() {
    let lines = ["mean 1.5", "least 0", "greatest 3"];
    assert!(fits(&["mean …", "…"], &lines) && fits(&["…", "… 3"], &lines) && fits(&["…"], &lines));
    assert!(!fits(&["mean …"], &lines) && !fits(&["…", "… 4"], &lines) && !fits(&[], &lines));
}

/// The rows of a table of the report, each a name and numbers.
fn table(path: &str) -> Vec<(String, Vec<f64>)> {
    let text = fs::read_to_string(root().join("docs/report").join(path)).unwrap();
    let row = |line: &str| {
        let (name, numbers) = line.split_once(',').unwrap();
        (name.to_owned(), numbers.split(',').map(|x| x.parse().unwrap()).collect())
    };
    text.lines().skip(1).map(row).collect()
}

/// The cells of the row of a page that begins with this name.
fn cells<'a>(page: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!("| `{name}` |");
    let line = page.lines().find(|line| line.starts_with(&start));
    let line = line.unwrap_or_else(|| panic!("no row {name}"));
    line.split('|').map(str::trim).skip(2).collect()
}

/// The recommendations, by default and in words, are the best of the report's table, and the guide
/// shows its numbers to two digits.
#[test]
fn advice_on_estimators_is_that_of_the_table() {
    let page = fs::read_to_string(root().join("docs/guide/src/choosing.md")).unwrap();
    let rows = table("estimators/choice.csv");
    assert_eq!(rows.len(), Estimator::all().len());
    let shown = |x: f64| match x {
        x if x >= 9.95 => format!("{x:.0}"),
        x if x < 0.995 => format!("{x:.2}"),
        x => format!("{x:.1}"),
    };
    for (name, numbers) in &rows {
        let cells = cells(&page, name);
        assert_eq!(cells[..2], [shown(numbers[0]), shown(numbers[1])], "{name}");
    }
    let best = |column: usize, among: &dyn Fn(&str) -> bool| {
        let rows = rows.iter().filter(|(name, _)| among(name));
        rows.min_by(|a, b| a.1[column].total_cmp(&b.1[column])).unwrap().0.clone()
    };
    let recommended = Estimator::RECOMMENDED.name();
    for column in 0..3 {
        assert_eq!(best(column, &|_| true), recommended);
    }
    for (column, words) in
        [(0, "best of fixed size on fine, clean"), (1, "best of fixed size under noise")]
    {
        let name = best(column, &|name| name != recommended);
        for estimator in Estimator::all() {
            let says = estimator.description().contains(words);
            assert_eq!(says, estimator.name() == name, "{estimator}: {words}");
        }
    }
}

/// The default weight of vertex normals is within 15 % of the best on clean and on noisy meshes.
#[test]
fn the_default_weight_of_normals_is_near_the_best() {
    let page = fs::read_to_string(root().join("docs/guide/src/defaults.md")).unwrap();
    for (name, numbers) in table("estimators/normals.csv") {
        let shown = numbers.iter().map(|x| format!("{x:.2}")).collect::<Vec<_>>();
        assert_eq!(cells(&page, &name)[..2], shown, "{name}");
        let is_near = numbers.iter().all(|x| *x < 1.15);
        assert!(is_near || !["angle", "sphere"].contains(&&name[..]), "{name}: {numbers:?}");
    }
}
