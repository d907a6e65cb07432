//! Values to be shown as colours.

use crate::error::FigureError;

/// The uses of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// Coloured, and part of the range.
    Counted,
    /// Coloured, but the range is found without it.
    Shown,
    /// Grey.
    Undefined,
}

/// One scalar per vertex (or face), some perhaps undefined or kept out of the
/// range of the colours.
#[derive(Debug, Clone)]
pub struct Field<'a> {
    values: &'a [f64],
    marks: Vec<Mark>,
}

impl<'a> Field<'a> {
    /// All values are defined and count.
    pub fn new(values: &'a [f64]) -> Self {
        Self { values, marks: vec![Mark::Counted; values.len()] }
    }

    /// Values where `undefined` holds are drawn grey, whatever they are.
    ///
    /// # Errors
    ///
    /// [`FigureError::Count`] if there are too few or too many flags.
    pub fn undefined_where(self, undefined: &[bool]) -> Result<Self, FigureError> {
        self.mark(undefined, Mark::Undefined)
    }

    /// Excludes values, such as those at the boundary, from the range; they are still coloured.
    ///
    /// # Errors
    ///
    /// [`FigureError::Count`] if there are too few or too many flags.
    pub fn range_without(self, excluded: &[bool]) -> Result<Self, FigureError> {
        self.mark(excluded, Mark::Shown)
    }

    fn mark(mut self, flags: &[bool], mark: Mark) -> Result<Self, FigureError> {
        if flags.len() != self.values.len() {
            return Err(FigureError::Count {
                what: "flags",
                expected: self.values.len(),
                found: flags.len(),
            });
        }
        for (own, _) in self.marks.iter_mut().zip(flags).filter(|(_, flag)| **flag) {
            if *own != Mark::Undefined {
                *own = mark;
            }
        }
        Ok(self)
    }

    /// The number of values.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns true if there is no value.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The values, `None` where undefined.
    pub fn values(&self) -> impl Iterator<Item = Option<f64>> + '_ {
        let pairs = self.values.iter().zip(&self.marks);
        pairs.map(|(&x, &mark)| (mark != Mark::Undefined).then_some(x))
    }

    /// The values that determine the range.
    pub(crate) fn counted(&self) -> impl Iterator<Item = f64> + '_ {
        let pairs = self.values.iter().zip(&self.marks);
        pairs.filter(|(_, mark)| **mark == Mark::Counted).map(|(&x, _)| x)
    }

    /// Refuses values that are not finite, unless marked as undefined.
    pub(crate) fn check(&self) -> Result<(), FigureError> {
        match self.values().position(|x| x.is_some_and(|x| !x.is_finite())) {
            None => Ok(()),
            Some(index) => Err(FigureError::NonFinite { index, value: self.values[index] }),
        }
    }
}
