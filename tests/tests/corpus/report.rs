//! The report over the assignment's meshes.

use std::path::Path;

use fairing_report::experiments;
use fairing_report::model::results::Form;
use fairing_report::run::{Plan, reproduce};
use libtest_mimic::Failed;

use crate::Test;

/// The tests of this area.
pub(crate) fn trials() -> Vec<(&'static str, Test)> {
    vec![("all_or_some_of_the_meshes_make_a_report", forms)]
}

/// Questions 5 and 7 read the same part from different files, which quick runs coarsen.
fn forms(meshes: &Path) -> Result<(), Failed> {
    let folder = tempfile::tempdir()?;
    let some = folder.path().join("some");
    std::fs::create_dir(&some)?;
    std::fs::copy(meshes.join("reference/fandisk.off"), some.join("fandisk.off"))?;
    std::fs::copy(meshes.join("assignment/other-years/cube.obj"), some.join("cube.obj"))?;
    for (meshes, real) in [(meshes, ["cube.obj", "fandisk_ns.obj"]), (&some, ["cube.obj"; 2])] {
        let plan = Plan {
            root: Path::new(env!("CARGO_MANIFEST_DIR")).join(".."),
            only: vec!["q5".into(), "q7".into()],
            meshes: Some(meshes.into()),
            out: folder.path().join("report"),
            cache: folder.path().join("kept"),
            quick: true,
            fresh: false,
            form: Form::Whole,
        };
        let results = reproduce(experiments::ALL, &plan)?;
        for record in &results.experiments {
            if let Some(error) = &record.error {
                return Err(format!("{}: {error}", record.id).into());
            }
        }
        let q5 = &results.experiments[0].inputs;
        let is_real =
            |name: &&str| q5.iter().any(|source| source.file == *name && !source.stand_in);
        assert!(real.iter().all(is_real), "{q5:?}");
        let half = q5.iter().filter(|source| source.stands_for.starts_with("fandisk"));
        assert!(half.clone().all(|a| half.clone().all(|b| a.stand_in == b.stand_in)), "{q5:?}");
    }
    Ok(())
}
