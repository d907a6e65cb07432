//! Choices that have names.

use crate::error::ParameterError;

/// The choice of that name.
pub fn by_name<T: Copy>(
    what: &'static str,
    all: &[T],
    name_of: impl Fn(&T) -> &'static str,
    name: &str,
) -> Result<T, ParameterError> {
    let found = all.iter().find(|choice| name_of(choice).eq_ignore_ascii_case(name));
    found.copied().ok_or_else(|| ParameterError::UnknownName {
        what,
        name: name.to_owned(),
        known: all.iter().map(name_of).collect(),
    })
}

/// Makes a type be written as its name (`Display`) and read from it
/// (`FromStr`), from its constant `ALL` and its method `name`. With a list of names it makes these
/// two as well.
#[macro_export]
macro_rules! named {
    ($type:ty, $what:literal, $($variant:ident: $name:literal),+ $(,)?) => {
        impl $type {
            /// All of them.
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$variant),+];

            /// The name on the command line and in tables.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }

        $crate::named!($type, $what);
    };
    ($type:ty, $what:literal) => {
        impl ::std::fmt::Display for $type {
            fn fmt(&self, f: &mut ::std::fmt::Formatter<'_>) -> ::std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl ::std::str::FromStr for $type {
            type Err = $crate::ParameterError;

            fn from_str(name: &str) -> ::std::result::Result<Self, $crate::ParameterError> {
                $crate::by_name($what, &Self::ALL, |choice| choice.name(), name)
            }
        }
    };
}

/// Makes a type be serialized as its name, and deserialized from it.
#[macro_export]
macro_rules! serde_by_name {
    ($type:ty) => {
        impl ::serde::Serialize for $type {
            fn serialize<S: ::serde::Serializer>(
                &self,
                serializer: S,
            ) -> ::std::result::Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> ::serde::Deserialize<'de> for $type {
            fn deserialize<D: ::serde::Deserializer<'de>>(
                deserializer: D,
            ) -> ::std::result::Result<Self, D::Error> {
                let name =
                    <::std::string::String as ::serde::Deserialize>::deserialize(deserializer)?;
                name.parse().map_err(::serde::de::Error::custom)
            }
        }
    };
}

/// Gives an enum without fields the constants `ALL` and `CHOICES` and the method `name`, writes it
/// as its name and reads it from its name, and makes it a parameter of options.
#[macro_export]
macro_rules! choices {
    ($type:ty, $what:literal, $($variant:ident: $name:literal, $about:literal;)*) => {
        $crate::named!($type, $what, $($variant: $name),*);

        impl $type {
            /// Their names, and what they mean.
            pub const CHOICES: &'static [$crate::Choice] = &[$($crate::Choice::new($name, $about)),*];
        }

        impl $crate::Field for $type {
            fn parameters(&self, field: $crate::Parameter) -> Vec<$crate::Parameter> {
                let kind = $crate::Kind::Choice(Self::CHOICES);
                let default = Some($crate::Value::from(self.name()));
                vec![$crate::Parameter { kind, default, ..field }]
            }

            fn read(
                &mut self,
                name: &'static str,
                values: &$crate::Values,
            ) -> Result<(), $crate::ParameterError> {
                *self = values.choice(name).unwrap_or(*self);
                Ok(())
            }
        }
    };
}
