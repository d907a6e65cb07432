//! Symbols of the report: one meaning each on the whole page.

use crate::model::results::Record;

/// A symbol, or several that belong together.
pub(crate) struct Symbol {
    /// The spelling in text; several are separated by commas.
    pub(crate) sign: &'static str,
    /// Its meaning, wherever it is used.
    pub(crate) meaning: &'static str,
    /// The spelling in formulas: characters or commands of TeX.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare it with formulas"))]
    tex: &'static [&'static str],
}

const fn symbol(sign: &'static str, meaning: &'static str, tex: &'static [&'static str]) -> Symbol {
    Symbol { sign, meaning, tex }
}

/// The symbols in the order of first use.
pub(crate) const SYMBOLS: [Symbol; 30] = [
    symbol("x, X", "position of a vertex; of all vertices", &["x", "X"]),
    symbol("i, j", "numbers of vertices or modes", &["i", "j"]),
    symbol("d", "in du and dv: small steps of u and v", &["d"]),
    symbol("T", "triangle", &["T"]),
    symbol("A", "area of a vertex or a triangle", &["A"]),
    symbol("α, β", "angles of triangles, at a vertex or opposite an edge", &["\\alpha", "\\beta"]),
    symbol("H, K", "mean and Gaussian curvature, positive on a sphere", &["H", "K"]),
    symbol("κ", "normal curvature; κ₁ and κ₂ are the principal ones", &["\\kappa"]),
    symbol("n", "unit normal; a hat marks that of the truth", &["n"]),
    symbol("a, b, c", "half axes of an ellipsoid", &["a", "b", "c"]),
    symbol("u, v", "parameters of a surface", &["u", "v"]),
    symbol("E, F, G", "coefficients of the first fundamental form", &["E", "F", "G"]),
    symbol("e, f, g", "coefficients of the second fundamental form", &["e", "f", "g"]),
    symbol("θ", "angle of a tangent direction", &["\\theta"]),
    symbol("Δ", "Laplacian of a surface", &["\\Delta"]),
    symbol(
        "h",
        "mean length of the sides of all faces, of each mesh or of the one that the section names",
        &["h"],
    ),
    symbol("σ", "standard deviation of noise", &["\\sigma"]),
    symbol("ε", "error", &["\\varepsilon"]),
    symbol("S", "cotangent stiffness matrix", &["S"]),
    symbol("M", "mass matrix: areas of vertices on its diagonal", &["M"]),
    symbol("φ", "mode: eigenvector of S φ = ω M φ", &["\\varphi"]),
    symbol("ω", "its eigenvalue, a squared frequency", &["\\omega"]),
    symbol("δ", "1 where both indices are equal, else 0", &["\\delta"]),
    symbol("k", "number of modes", &["k"]),
    symbol("L", "uniform Laplacian D⁻¹W − I", &["L"]),
    symbol(
        "D, W, I",
        "numbers of neighbours on the diagonal; 1 for each edge; unit matrix",
        &["D", "W", "I"],
    ),
    symbol("μ", "eigenvalue of L, from −2 to 0; least for the roughest mode", &["\\mu"]),
    symbol(
        "λ, s",
        "length of a step, number of steps; s λ is the diffusion time",
        &["\\lambda", "s"],
    ),
    symbol("t, r", "time; radius, of a sphere or of curvature", &["t", "r"]),
    symbol("E_a, E_v", "normal error, in degrees; vertex error, in h", &["E_a", "E_v"]),
];

/// The sentence that defines h for a section; `None` if it does not use h.
pub(crate) fn reference(record: &Record) -> Option<String> {
    let mesh = &record.section.edge_lengths_of;
    (!mesh.is_empty()).then(|| format!("Here h is the mean edge length of {mesh}."))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::model::results::Results;
    use crate::model::table::Unit;

    use super::*;

    fn committed() -> Results {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report/results.json");
        Results::read(&path).unwrap()
    }

    /// Returns true if a text has this letter as a word: `0.5 h`, `σ/h`, but not `the`.
    fn has(text: &str, letter: char) -> bool {
        let part = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        text.char_indices().any(|(at, c)| {
            let after = &text[at + c.len_utf8()..];
            c == letter && !part(text[..at].chars().next_back()) && !part(after.chars().next())
        })
    }

    /// All words of a section.
    fn words(record: &Record) -> Vec<&str> {
        let mut all: Vec<&str> = vec![&record.question, &record.method];
        for claim in &record.claims {
            all.extend([&claim.claim[..], &claim.reason, &claim.finding]);
        }
        all.extend(record.figures.iter().map(|f| &f.caption[..]));
        all.extend(record.views.iter().map(|v| &v.caption[..]));
        for table in &record.tables {
            all.push(&table.caption);
            all.extend(table.columns.iter().map(|c| &c.name[..]));
        }
        all.extend(record.parameters.iter().flat_map(|p| [&p.name[..], &p.value]));
        all.extend(record.notes.iter().map(|n| &n[..]));
        all
    }

    #[test]
    fn sections_that_use_h_say_of_which_mesh() {
        for record in &committed().experiments {
            let in_words = words(record).iter().any(|text| has(text, 'h'));
            let units = record.tables.iter().flat_map(|t| &t.columns).map(|c| c.unit);
            let mut units =
                units.chain(record.claims.iter().flat_map(|c| &c.numbers).map(|n| n.unit));
            if in_words || units.any(|unit| unit == Unit::EdgeLengths) {
                assert!(reference(record).is_some(), "{} does not say what h refers to", record.id);
            }
        }
    }

    /// The letters of a formula: characters and commands, an index that is part of a name with
    /// them.
    fn letters(formula: &str) -> Vec<String> {
        const SETTING: [&str; 18] = [
            "frac", "tfrac", "Big", "big", "left", "right", "qquad", "quad", "sum", "log", "cos",
            "sin", "cot", "arccos", "sqrt", "partial", "text", "hat",
        ];
        const SIGNS: [&str; 8] = ["sim", "cdot", "pi", "ge", "le", "top", "approx", "circ"];
        let mut found = vec![];
        let mut rest = formula;
        while let Some(c) = rest.chars().next() {
            let after = &rest[c.len_utf8()..];
            if c == '\\' {
                let end = after.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(after.len());
                let command = &after[..end];
                rest = &after[end.max(usize::from(end == 0 && !after.is_empty()))..];
                if command == "text" {
                    // Words, not letters.
                    rest = rest.split_once('}').map_or("", |(_, rest)| rest);
                } else if !command.is_empty()
                    && !SETTING.contains(&command)
                    && !SIGNS.contains(&command)
                {
                    found.push(format!("\\{command}"));
                }
                continue;
            }
            let named = ["E_a", "E_v"].into_iter().find(|name| rest.starts_with(name));
            rest = &rest[named.map_or(c.len_utf8(), str::len)..];
            match named {
                Some(name) => found.push(name.into()),
                None if c.is_ascii_alphabetic() => found.push(c.into()),
                None => {}
            }
        }
        found
    }

    /// A letter of a formula is in the list, for this section: another meaning needs another
    /// letter.
    #[test]
    fn formulas_use_letters_in_one_meaning() {
        assert_eq!(
            letters(r"E_a = \text{mean} \frac{\kappa_n}{2}\,x_i^\top"),
            ["E_a", "\\kappa", "n", "x", "i"]
        );
        for record in &committed().experiments {
            for letter in record.formulas.iter().flat_map(|formula| letters(formula)) {
                let known = SYMBOLS.iter().find(|l| l.tex.contains(&&letter[..]));
                let known =
                    known.unwrap_or_else(|| panic!("{letter} of {} is not explained", record.id));
                assert!(
                    record.section.notation.contains(&letter),
                    "{letter} of {}: {}",
                    record.id,
                    known.meaning
                );
            }
        }
    }

    #[test]
    fn every_letter_has_one_meaning() {
        let mut signs: Vec<&str> = SYMBOLS.iter().flat_map(|l| l.sign.split(", ")).collect();
        signs.sort_unstable();
        for pair in signs.windows(2) {
            assert_ne!(pair[0], pair[1], "{} stands for two things", pair[0]);
        }
        let mut tex: Vec<&str> = SYMBOLS.iter().flat_map(|l| l.tex).copied().collect();
        tex.sort_unstable();
        assert!(tex.windows(2).all(|pair| pair[0] != pair[1]));
        for letter in &SYMBOLS {
            assert!(!letter.meaning.contains("elsewhere"), "{}", letter.sign);
        }
    }

    /// Capitals that are matrices or forms are theirs in words, too.
    #[test]
    fn words_use_capitals_in_one_meaning() {
        for letter in ['N', 'M', 'S', 'L', 'G', 'F', 'W'] {
            let has_it = |r: &&Record| !r.section.notation.iter().any(|s| *s == letter.to_string());
            for record in committed().experiments.iter().filter(has_it) {
                for text in words(record) {
                    // The original report's letters are named once; the F-score is a name.
                    let text = text.replace("L, M and N", "").replace("F-score", "");
                    assert!(!has(&text, letter), "{letter} in {}: {text}", record.id);
                }
            }
        }
    }
}
