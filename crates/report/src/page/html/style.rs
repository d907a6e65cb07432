//! The style sheet of the report and of the laboratory.

/// The rules of the viewer, then those of the article.
pub(super) const STYLE: &str = concat!(
    include_str!("../../../../figure/viewer/style.css"),
    include_str!("../../../assets/style.css")
);
