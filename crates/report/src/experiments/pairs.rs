//! Denoisers on the public pairs of the literature: the results that the study keeps.

use anyhow::{Context as _, Result};
use fairing_denoising::{AutomaticOptions, Denoiser};

use super::families::TEXT;
use super::restoring::Method;
use crate::experiment::text::values;
use crate::model::table::{Cell, Table, Tables, Unit};
use crate::row;

/// The normal error of every method on every pair.
const MEASURED: &str = include_str!("../../../../study/results/pairs.csv");

/// The beginning of the name of a result that the authors of a method published.
const AUTHORS: &str = "authors: ";

/// The stored results, cells as texts.
fn measured() -> Result<Table> {
    let columns = ["pair", "faces", "method", "angle", "flipped", "seconds", "megabytes"];
    Table::new("measured", "", &columns.map(|name| (name, Unit::Label))).filled(MEASURED)
}

/// The automatic denoiser on each pair, the result that authors published, and the best of the
/// published methods at their defaults.
pub(super) fn table() -> Result<Table> {
    let measured = measured()?;
    let mut table = Table::new(
        "pairs",
        &TEXT.say("table pairs", &[])?,
        &[
            ("pair", Unit::Label),
            ("noisy", Unit::Degrees),
            ("automatic", Unit::Degrees),
            ("authors' result", Unit::Degrees),
            ("their method", Unit::Label),
            ("best default", Unit::Degrees),
            ("its method", Unit::Label),
        ],
    );
    let own = Denoiser::Automatic(AutomaticOptions::DEFAULT).name();
    for pair in measured.labels("pair")? {
        let rows = measured.only(&[("pair", pair.as_str().into())])?;
        let (method, angle) = (rows.index("method")?, rows.index("angle")?);
        let (mut noisy, mut automatic, mut authors) = (None, None, None);
        let mut best = (f64::INFINITY, String::new());
        for row in &rows.rows {
            let (name, error) = (row[method].to_string(), row[angle].to_string());
            let error: f64 = error.parse().with_context(|| format!("{pair}, {name}: {error}"))?;
            match name.strip_prefix(AUTHORS) {
                Some(method) => authors = Some((error, method.to_string())),
                None if name == "noisy" => noisy = Some(error),
                None if name == own => automatic = Some(error),
                // With another strength.
                None if name.starts_with(own) => {}
                None if error < best.0 => best = (error, name),
                None => {}
            }
        }
        let (theirs, method) = authors.unzip();
        table.push(row![
            pair,
            noisy,
            automatic,
            theirs,
            method.map_or(Cell::Missing, Cell::from),
            best.0,
            best.1,
        ]);
    }
    Ok(table)
}

/// Results on the pairs in a few numbers.
pub(super) struct Standing {
    /// The arithmetic mean of the normal error of the automatic denoiser, in degrees.
    pub(super) mean: f64,
    /// The pairs on which a published method at its defaults is better.
    pub(super) lost: usize,
    /// The same in words.
    pub(super) words: String,
}

/// Sums up; `None` where the results are left out.
pub(super) fn standing(tables: Tables<'_>) -> Result<Option<Standing>> {
    let Ok(table) = tables.get("pairs") else { return Ok(None) };
    let (own, best) = (table.column("automatic")?, table.column("best default")?);
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let lost = own.iter().zip(&best).filter(|(own, best)| own > best).count();
    let theirs = table.index("authors' result")?;
    let theirs: Vec<Option<f64>> = table.rows.iter().map(|row| row[theirs].number()).collect();
    let known: Vec<bool> =
        theirs.iter().zip(&own).filter_map(|(theirs, own)| Some(*own < (*theirs)?)).collect();
    let values = values! {
        count: own.len(), own: format!("{:.1}", mean(&own)), best: format!("{:.1}", mean(&best)),
        lost, known: known.len(), wins: known.iter().filter(|wins| **wins).count(),
        published: published(),
    };
    let words = TEXT.say("automatic on pairs", values)?;
    Ok(Some(Standing { mean: mean(&own), lost, words }))
}

/// Number of published methods that are compared.
pub(super) fn published() -> usize {
    let is_published = |d: &Denoiser| !Method::Denoiser(*d).is_trained();
    Denoiser::all().iter().filter(|d| is_published(d)).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stored results have a row for every method, and the table one for every pair.
    #[test]
    fn every_pair_has_its_best() {
        let table = table().unwrap();
        assert_eq!(table.rows.len(), 12);
        for (noisy, best) in
            table.column("noisy").unwrap().iter().zip(table.column("best default").unwrap())
        {
            assert!(best.is_finite() && best < *noisy);
        }
        let standing = standing(Tables(&[table])).unwrap().unwrap();
        assert!(standing.words.contains("On 12 public pairs"), "{}", standing.words);
    }

    /// The text recommends twice the strength for laser scans.
    #[test]
    fn twice_the_strength_is_better_on_laser_scans() {
        let measured = measured().unwrap();
        for pair in ["ScanBunny090", "ScanDragon0"] {
            let error = |method: &str| {
                let row = [("pair", pair.into()), ("method", method.into())];
                let rows = measured.only(&row).unwrap();
                rows.labels("angle").unwrap().concat().parse::<f64>().unwrap()
            };
            assert!(error("automatic, strength 2") < error("automatic"), "{pair}");
        }
    }
}
