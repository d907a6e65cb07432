//! Where numbers come from: the code, the machine, the seed, the day.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::model::provenance::Provenance;

/// The libraries worth naming.
const LIBRARIES: [&str; 6] = ["faer", "ndarray", "sprs", "rand_chacha", "rayon", "tiny-skia"];

/// Asks git, cargo, the lock file and the system.
pub fn gather(root: &Path, seed: u64, quick: bool) -> Provenance {
    let run = |program: &str, arguments: &[&str]| -> Option<String> {
        let output = Command::new(program).args(arguments).current_dir(root).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?;
        output.status.success().then(|| text.trim().to_string())
    };
    let unknown = || "unknown".to_string();
    Provenance {
        program: format!("fairing {}", env!("CARGO_PKG_VERSION")),
        commit: run("git", &["rev-parse", "HEAD"]).unwrap_or_else(unknown),
        dirty: run("git", &["status", "--porcelain"]).is_none_or(|changes| !changes.is_empty()),
        compiler: run("rustc", &["--version"]).unwrap_or_else(unknown),
        libraries: locked_versions(&root.join("Cargo.lock")),
        system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
        processor: processor().unwrap_or_else(unknown),
        threads: rayon::current_num_threads(),
        seed,
        quick,
        date: date(SystemTime::now()),
    }
}

/// `name version` of the libraries worth naming, from the lock file.
fn locked_versions(lock: &Path) -> Vec<String> {
    let text = fs::read_to_string(lock).unwrap_or_default();
    let parsed: toml::Table = text.parse().unwrap_or_default();
    let packages = parsed.get("package").and_then(|p| p.as_array());
    let named = packages.into_iter().flatten().filter_map(|p| {
        let name = p.get("name")?.as_str()?;
        LIBRARIES
            .contains(&name)
            .then(|| Some(format!("{name} {}", p.get("version")?.as_str()?)))?
    });
    named.collect()
}

/// The processor's name, where Linux tells it.
fn processor() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_string())
}

/// The date in UTC as year-month-day, by the usual count of days in eras of
/// 400 years.
fn date(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let days = seconds / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn dates_follow_the_calendar() {
        for (seconds, expected) in [
            (0, "1970-01-01"),
            (951_782_400, "2000-02-29"),
            (951_868_800, "2000-03-01"),
            (1_767_225_599, "2025-12-31"),
        ] {
            assert_eq!(date(UNIX_EPOCH + Duration::from_secs(seconds)), expected);
        }
    }
}
