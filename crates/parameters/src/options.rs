//! Options structs whose fields are parameters.

use crate::algorithm::{Algorithm, Parameter};
use crate::error::ParameterError;
use crate::value::Value;
use crate::values::Values;

/// Options of an algorithm, as [`options!`](crate::options) declares them.
pub trait Options: Sized + 'static {
    /// The names of the algorithm, each with the options that it stands for; several if a choice
    /// among the options has a name of its own.
    fn entries() -> Vec<Entry<Self>>;

    /// The parameters, with these options as their defaults.
    fn parameters(&self) -> Vec<Parameter>;

    /// Takes the values that are given.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for values that contradict each other.
    fn read(&mut self, values: &Values) -> Result<(), ParameterError>;

    /// Refuses fields outside their ranges.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for the first such field.
    fn check(&self) -> Result<(), ParameterError>;

    /// The entry of the name that these options have.
    fn entry(&self) -> Entry<Self>;

    /// Options by name, with values for some of their parameters; `None` for a name of another
    /// algorithm.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for values that do not fit.
    fn with<V: Clone + Into<Value>>(
        name: &str,
        values: &[(&str, V)],
    ) -> Result<Option<Self>, ParameterError> {
        let entry = Self::entries().into_iter().find(|e| e.name.eq_ignore_ascii_case(name));
        let Some(entry) = entry else { return Ok(None) };
        let values = Values::new(&entry.algorithm(), values)?;
        let mut options = entry.options;
        options.read(&values)?;
        Ok(Some(options))
    }
}

/// A name of an algorithm, and the options that it stands for.
#[derive(Debug, Clone)]
pub struct Entry<O> {
    /// The name on the command line and in tables.
    pub name: &'static str,
    /// One-line summary of when to use it.
    pub description: &'static str,
    /// Keys of its sources in `docs/bibliography.bib`; empty if it is new.
    pub sources: &'static [&'static str],
    /// Parameters of the options that cannot be set under this name.
    pub without: &'static [&'static str],
    /// The defaults under this name.
    pub options: O,
    /// Returns true if options have this name.
    pub is: fn(&O) -> bool,
}

impl<O: Options> Entry<O> {
    /// The algorithm under this name.
    pub fn algorithm(&self) -> Algorithm {
        let mut parameters = self.options.parameters();
        parameters.retain(|parameter| !self.without.contains(&parameter.name));
        let Self { name, description, sources, .. } = *self;
        Algorithm { name, description, sources, parameters }
    }
}

/// Declares the options of an algorithm: a struct whose fields are parameters.
///
/// A field has a documentation comment, a default, and where it needs them a range
/// ([`Range`](crate::Range)), choices and a unit. The comment is the description in the help of
/// programs. After the struct come the names of the algorithm, each with a one-line summary and its
/// sources; each of several names has the options that it stands for, and a condition that tells it
/// from the others. `also` lists parameters that are no fields, and `then` is called with the
/// options and all values after the fields have been read.
///
/// The struct gets a constant `DEFAULT`, `Default`, and [`Options`](crate::Options).
///
/// ```
/// use fairing_parameters::{Options, Range, options};
///
/// options! {
///     /// Options of a filter.
///     #[derive(Debug, Clone, Copy, PartialEq)]
///     pub struct Filter {
///         /// The radius of the neighbourhood.
///         pub radius: f64 = 2.0, in Range::POSITIVE, unit "mean edge lengths";
///         /// The number of rounds.
///         pub vertex_steps: usize = 10;
///     }
///     "filter": "removes noise", ["taubin1995"];
/// }
///
/// let filter = Filter::with("filter", &[("vertex-steps", "3")])?.unwrap();
/// assert_eq!(filter, Filter { vertex_steps: 3, ..Filter::default() });
/// let [radius, _] = &filter.parameters()[..] else { panic!("two parameters") };
/// assert_eq!(radius.about, "The radius of the neighbourhood");
/// assert_eq!(radius.unit, "mean edge lengths");
/// let error = Filter { radius: 0.0, ..filter }.check().unwrap_err();
/// assert_eq!(error.to_string(), "radius is 0, but must be positive and finite");
/// # Ok::<(), fairing_parameters::ParameterError>(())
/// ```
#[macro_export]
macro_rules! options {
    (
        $(#[$meta:meta])*
        pub struct $Options:ident {
            $(
                $(#[doc = $doc:literal])+
                pub $field:ident: $type:ty = $default:expr
                    $(, in $range:expr)?
                    $(, among $choices:expr)?
                    $(, unit $unit:literal)?
                    $(, name $name:literal)?
                    $(, excludes $excludes:expr)?
                    $(, required $required:literal)?;
            )*
        }
        $(
            $algorithm:literal: $description:literal, $sources:expr
                $(, without $without:expr)?
                $(, with $options:expr, if $is:expr)?;
        )+
        $(also $also:expr;)?
        $(then $then:expr;)?
    ) => {
        $(#[$meta])*
        pub struct $Options {
            $(
                $(#[doc = $doc])+
                #[doc = ""]
                #[doc = concat!("Default: `", stringify!($default), "`" $(, "; in ", $unit)?, ".")]
                pub $field: $type,
            )*
        }

        impl $Options {
            /// The defaults.
            pub const DEFAULT: Self = Self { $($field: $default),* };
        }

        impl Default for $Options {
            fn default() -> Self {
                Self::DEFAULT
            }
        }

        impl $crate::Options for $Options {
            fn entries() -> Vec<$crate::Entry<Self>> {
                vec![$($crate::Entry {
                    name: $algorithm,
                    description: $description,
                    sources: &$sources,
                    without: $crate::__or!(&[] $(, &$without)?),
                    options: $crate::__or!(Self::DEFAULT $(, $options)?),
                    is: $crate::__or!(|_| true $(, $is)?),
                }),+]
            }

            fn entry(&self) -> $crate::Entry<Self> {
                let mut entries = Self::entries();
                let named = entries.iter().position(|entry| (entry.is)(self));
                entries.swap_remove(named.unwrap_or_default())
            }

            fn parameters(&self) -> Vec<$crate::Parameter> {
                let fields: Vec<Vec<$crate::Parameter>> = vec![$($crate::Field::parameters(
                    &self.$field, $crate::Parameter {
                    unit: $crate::__or!("" $(, $unit)?),
                    range: $crate::__or!($crate::Range::FINITE $(, $crate::Range::from($range))?),
                    excludes: $crate::__or!(&[] $(, &$excludes)?),
                    required: $crate::__or!(false $(, $required)?),
                    ..$crate::Parameter::new(
                        $crate::__name!($field $(, $name)?),
                        $crate::__or!($crate::Kind::Number $(, $crate::Kind::Choice($choices))?),
                        $crate::sentence(concat!($($doc),+)),
                    )
                })),*];
                let also: &[$crate::Parameter] = &$crate::__or!([] $(, $also)?);
                [fields.concat().as_slice(), also].concat()
            }

            fn read(&mut self, values: &$crate::Values) -> Result<(), $crate::ParameterError> {
                $($crate::Field::read(&mut self.$field, $crate::__name!($field $(, $name)?), values)?;)*
                $(
                    let then: fn(&mut Self, &$crate::Values) -> Result<(), $crate::ParameterError> = $then;
                    then(self, values)?;
                )?
                Ok(())
            }

            fn check(&self) -> Result<(), $crate::ParameterError> {
                $(
                    let range = $crate::__or!($crate::Range::FINITE $(, $crate::Range::from($range))?);
                    $crate::Field::check(&self.$field, $crate::__name!($field $(, $name)?), range)?;
                )*
                Ok(())
            }
        }
    };
}

/// The second expression if there is one, else the first.
#[doc(hidden)]
#[macro_export]
macro_rules! __or {
    ($default:expr) => {
        $default
    };
    ($default:expr, $given:expr) => {
        $given
    };
}

/// The name of a parameter: that of the field with hyphens, unless another is declared.
#[doc(hidden)]
#[macro_export]
macro_rules! __name {
    ($field:ident) => {{
        const FIELD: &str = stringify!($field);
        const NAME: [u8; FIELD.len()] = $crate::hyphenated(FIELD);
        std::str::from_utf8(&NAME).unwrap_or(FIELD)
    }};
    ($field:ident, $name:literal) => {
        $name
    };
}

/// A name with hyphens in place of underscores.
pub const fn hyphenated<const N: usize>(name: &str) -> [u8; N] {
    let mut bytes = [0; N];
    let mut i = 0;
    while i < N {
        bytes[i] = match name.as_bytes()[i] {
            b'_' => b'-',
            other => other,
        };
        i += 1;
    }
    bytes
}

/// A documentation comment of one sentence, without the full stop.
pub fn sentence(doc: &'static str) -> &'static str {
    doc.trim().trim_end_matches('.')
}
