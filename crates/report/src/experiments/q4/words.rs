//! The words of question 4.

use crate::experiment::text::Text;

pub(in crate::experiments) static TEXT: Text = Text::new("q4", include_str!("../../../text/q4.md"));
