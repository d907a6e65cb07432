//! The report: `results.json` and the files beside it as Markdown and as a page.
//!
//! [`publish()`] selects the files of a new report and writes `results.json`; [`render()`] needs
//! nothing else.

pub mod mathml;

mod bibliography;
mod html;
mod layout;
mod markdown;
mod notation;
mod numbers;
mod prose;
mod publish;
mod render;
mod snippets;
mod story;
mod thumbnail;

pub use html::laboratory;
pub use publish::publish;
pub use render::render;
