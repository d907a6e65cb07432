//! The report: `results.json` and the files beside it as Markdown and as a page.
//!
//! [`render()`] needs nothing else, so a report can be rendered again without running any
//! experiment. [`publish()`] comes before it: it selects the files of a new report and writes
//! `results.json`.

#![cfg_attr(test, expect(clippy::disallowed_methods, reason = "tests do not need the same bits"))]

pub mod mathml;

mod bibliography;
mod layout;
mod markdown;
mod notation;
mod numbers;
mod page;
mod publish;
mod render;
mod snippets;
mod story;
mod thumbnail;

pub use markdown::{claim_table, summary};
pub use page::laboratory;
pub use publish::publish;
pub use render::render;
