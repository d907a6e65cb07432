//! Algorithms of one kind behind one type.

use crate::algorithm::Algorithm;

/// Algorithms among which programs choose by name: an enum that
/// [`algorithms!`](crate::algorithms) declares.
pub trait Family {
    /// The word for one of them.
    const WHAT: &'static str;

    /// The algorithms, in the order in which they are listed.
    fn algorithms() -> Vec<Algorithm>;
}

/// Declares an enum of algorithms with their options; a line adds one.
///
/// A line names the [`options!`](crate::options) of an algorithm and its function. The enum is
/// written as the name of the algorithm (`Display`), and read from it with default options
/// (`FromStr`).
#[macro_export]
macro_rules! algorithms {
    (
        $(#[$meta:meta])*
        pub enum $Family:ident($what:literal) {
            $($(#[$doc:meta])* $Variant:ident($Options:ty) => $function:expr,)+
        }
        $(#[$run_doc:meta])*
        pub fn $run:ident $(<$life:lifetime>)? (
            $mesh:ident: $Mesh:ty $(, $argument:ident: $Argument:ty)*
        ) -> $Output:ty;
    ) => {
        $(#[$meta])*
        pub enum $Family {
            $($(#[$doc])* $Variant($Options),)+
        }

        impl $Family {
            /// One for every name, with its defaults.
            pub fn all() -> Vec<Self> {
                let mut all = Vec::new();
                $(
                    let entries = <$Options as $crate::Options>::entries().into_iter();
                    all.extend(entries.map(|entry| Self::$Variant(entry.options)));
                )+
                all
            }

            /// The algorithm of that name, with its defaults.
            ///
            /// # Errors
            ///
            /// `ParameterError` with the names that exist.
            pub fn by_name(name: &str) -> Result<Self, $crate::ParameterError> {
                let found = Self::all().into_iter().find(|a| a.name().eq_ignore_ascii_case(name));
                found.ok_or_else(|| {
                    let known = Self::all().iter().map(Self::name).collect();
                    $crate::ParameterError::unknown_name($what, name, known)
                })
            }

            /// The algorithm of that name, with values for some of its parameters: numbers, or
            /// text as on the command line.
            ///
            /// # Errors
            ///
            /// `ParameterError` for unknown names and for values that do not fit.
            pub fn with<V: Clone + Into<$crate::Value>>(
                name: &str,
                values: &[(&str, V)],
            ) -> Result<Self, $crate::ParameterError> {
                $(
                    if let Some(options) = <$Options as $crate::Options>::with(name, values)? {
                        return Ok(Self::$Variant(options));
                    }
                )+
                Self::by_name(name)
            }

            /// The name, description, sources and parameters, with these options as defaults.
            pub fn algorithm(&self) -> $crate::Algorithm {
                match self {
                    $(Self::$Variant(options) => $crate::Options::entry(options).algorithm(),)+
                }
            }

            /// The name on the command line and in tables.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$Variant(options) => $crate::Options::entry(options).name,)+
                }
            }

            /// One-line summary of when to use it.
            pub fn description(&self) -> &'static str {
                match self {
                    $(Self::$Variant(options) => $crate::Options::entry(options).description,)+
                }
            }

            $(#[$run_doc])*
            pub fn $run $(<$life>)? (
                &self,
                $mesh: $Mesh
                $(, $argument: $Argument)*
            ) -> $Output {
                $crate::__run!(self, ($mesh $(, $argument)*), $($Variant $function),+)
            }
        }

        impl $crate::Family for $Family {
            const WHAT: &'static str = $what;

            fn algorithms() -> Vec<$crate::Algorithm> {
                Self::all().iter().map(Self::algorithm).collect()
            }
        }

        impl std::fmt::Display for $Family {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $Family {
            type Err = $crate::ParameterError;

            fn from_str(name: &str) -> Result<Self, $crate::ParameterError> {
                Self::by_name(name)
            }
        }
    };
}

/// Calls the function of the variant: the first argument, the options, the other arguments.
#[doc(hidden)]
#[macro_export]
macro_rules! __run {
    ($self:ident, $arguments:tt, $($Variant:ident $function:expr),+) => {
        match $self {
            $(Self::$Variant(options) => $crate::__run!($function, options, $arguments),)+
        }
    };
    ($function:expr, $options:ident, ($first:ident $(, $other:ident)*)) => {
        ($function)($first, $options $(, $other)*)
    };
}
