//! The tables of the report: families, sets, the worst cases, and what the denoiser leaves on the
//! models in `data`.

use std::fmt::Write as _;

use anyhow::{Context as _, Result};
use fairing_evaluation::{NoiseKind, NoiseLevel, add_noise, normal_error};
use fairing_mesh::TriMesh;

use crate::cases::cases;
use crate::families::{Family, Set, Triangulation};
use crate::measure::{Found, summary};
use crate::published::denoiser;
use crate::table::Published;

/// Number of worst cases named for each set.
const NAMED: usize = 5;

/// The models of the experiment "denoisers", of families on which nothing was trained or chosen.
pub const MODELS: [Family; 3] = [Family::Bolt, Family::Vase, Family::Fluted];

/// The noise of the models in mean edge lengths, and its seed, as in the experiment.
const NOISE: (f64, u64) = (0.3, 3);

/// A model of the experiment, in single precision as its file has it.
pub fn model(family: Family) -> Result<TriMesh> {
    let model = family.mesh(4000, Triangulation::Irregular, 77);
    let single = |x: f64| f64::from(x as f32);
    Ok(model.with_positions(model.positions().iter().map(|p| p.map(single)).collect())?)
}

/// The tables by name, as comma-separated values, from results on all cases.
pub fn tables(found: &[Found], published: &Published) -> Result<Vec<(&'static str, String)>> {
    let all = cases();
    let of = |set: Set| -> Vec<(Family, &Found)> {
        let cases = all.iter().filter(|c| c.set() == set);
        let result = |name: String| found.iter().find(|f| f.case == name);
        cases.filter_map(|c| Some((c.family, result(c.name())?))).collect()
    };
    let mut ratios = String::from("set,ratio [1]\n");
    let mut families = String::from(
        "set,kind,family,cases [count],median [1],worst [1],worst case,normal error [°],best published [°]\n",
    );
    let mut sets = String::from(
        "set,cases [count],compared [count],median ratio [1],worst ratio [1],above 1.1 [count],\
         worse than a default [count],normals worse than noisy [count],\
         positions worse than noisy [count],flipped before [count],flipped [count],\
         more crossings [count],volume from truth [%],volume from noisy [%]\n",
    );
    let mut lost = String::from(
        "set,case,noisy [°],automatic [°],best published [°],ratio [1],method,parameters\n",
    );
    for set in Set::ALL {
        let mine = of(set);
        let results: Vec<Found> = mine.iter().map(|(_, f)| (*f).clone()).collect();
        let mut sorted: Vec<&Found> = results.iter().filter(|f| f.ratio().is_some()).collect();
        sorted.sort_by(|a, b| ratio(a).total_cmp(&ratio(b)));
        for f in &sorted {
            writeln!(ratios, "{set},{:.4}", ratio(f))?;
        }
        for f in sorted.iter().rev().take(NAMED) {
            let best = published.best(&f.case).context("a case without published results")?;
            let (case, tuned) = (&f.case, best.tuned);
            write!(lost, "{set},{case},{:.3},{:.3},{tuned:.3},", f.noisy, f.angle)?;
            writeln!(lost, "{:.4},{},{}", ratio(f), best.method, best.parameters)?;
        }
        let mut names: Vec<Family> = mine.iter().map(|(family, _)| *family).collect();
        names.sort_unstable();
        names.dedup();
        for family in names {
            let results = mine.iter().filter(|(f, _)| *f == family).map(|(_, f)| (*f).clone());
            let results: Vec<Found> = results.collect();
            let s = summary(&results);
            let worst = results.iter().max_by(|a, b| ratio(a).total_cmp(&ratio(b)));
            let worst = worst.context("a family without results")?;
            let (median, most) = s.median.zip(s.worst).context("no published results")?;
            let case = worst.case.strip_prefix(family.name()).unwrap_or(&worst.case).trim();
            let best = worst.best.as_ref().context("no published results")?.0;
            write!(families, "{set},{},{family},{},", family.kind(), s.cases)?;
            writeln!(families, "{median:.4},{most:.4},{case},{:.3},{best:.3}", worst.angle)?;
        }
        let s = summary(&results);
        let (median, most) = s.median.zip(s.worst).context("no published results")?;
        write!(sets, "{set},{},{},{median:.4},{most:.4},", s.cases, s.compared)?;
        write!(sets, "{},{},", s.beyond_bar, s.worse_than_default)?;
        write!(sets, "{},{},", s.worse_normals, s.worse_positions)?;
        write!(sets, "{},{},{},", s.flipped[0], s.flipped[1], s.more_intersections)?;
        writeln!(sets, "{:.4},{:.4}", 100.0 * s.volume[0], 100.0 * s.volume[1])?;
    }
    Ok(vec![
        ("ratios", ratios),
        ("families", families),
        ("sets", sets),
        ("lost", lost),
        ("models", models()?),
    ])
}

/// The normal error that the denoiser of these results leaves on each model, by which the
/// experiment knows whether the tables are those of its denoiser.
fn models() -> Result<String> {
    let automatic = denoiser("automatic")?;
    let mut table = String::from("mesh,normal error [°]\n");
    for family in MODELS {
        let (truth, (level, seed)) = (model(family)?, NOISE);
        let level = NoiseLevel::EdgeLengths(level);
        let noisy = add_noise(&truth, NoiseKind::GaussianAlongNormals, level, seed)?;
        let error = normal_error(&automatic(&noisy)?, &truth)?.mean;
        writeln!(table, "{family},{error:.3}")?;
    }
    Ok(table)
}

/// The ratio to the best published result; zero where none is known.
fn ratio(found: &Found) -> f64 {
    found.ratio().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// The committed models are those of their families.
    #[test]
    fn committed_models_are_those_of_their_families() {
        for family in MODELS {
            let file = Path::new("../data").join(format!("{family}.ply"));
            let kept = fairing_mesh::io::read(&file).unwrap().mesh;
            assert_eq!(kept, model(family).unwrap(), "{family}");
        }
    }
}
