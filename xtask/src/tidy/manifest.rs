//! Sections of a manifest with one entry per line.

/// The names and values in a section such as `lints.clippy`.
pub(super) fn entries<'a>(
    manifest: &'a str,
    section: &str,
) -> impl Iterator<Item = (&'a str, &'a str)> {
    let head = format!("[{section}]");
    let lines = manifest.lines().skip_while(move |line| line.trim() != head).skip(1);
    let lines = lines.take_while(|line| !line.starts_with('['));
    lines.filter(|line| !line.starts_with('#')).filter_map(|line| {
        let (name, value) = line.split_once('=')?;
        Some((name.trim().trim_end_matches(".workspace"), value.trim()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_one_section_are_read() {
        let manifest = "[a]\nx = 1\n# no = 2\ny = { path = \"p\" }\n\n[b]\nz = 3\n";
        let found: Vec<_> = entries(manifest, "a").collect();
        assert_eq!(found, [("x", "1"), ("y", "{ path = \"p\" }")]);
        assert_eq!(entries(manifest, "c").count(), 0);
    }
}
