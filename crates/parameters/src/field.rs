//! Fields of options as parameters.

use crate::algorithm::{Kind, Parameter};
use crate::error::ParameterError;
use crate::range::Range;
use crate::value::Value;
use crate::values::Values;

/// The type of a field of options that [`options!`](crate::options) declares.
///
/// Numbers and choices are one parameter, with the name of the field. Other types name their
/// parameters themselves, and may have several, or none.
pub trait Field {
    /// The parameters, with this value as their default. A field that is one parameter completes
    /// `field`, which has the name, description and range that are declared.
    fn parameters(&self, field: Parameter) -> Vec<Parameter>;

    /// Takes the values that are given; `name` is that of the field.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] for values that contradict each other.
    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError>;

    /// Refuses values outside the range declared for the field.
    ///
    /// # Errors
    ///
    /// [`ParameterError`] with the name of the field.
    fn check(&self, _name: &'static str, _range: Range) -> Result<(), ParameterError> {
        Ok(())
    }
}

impl Field for f64 {
    fn parameters(&self, field: Parameter) -> Vec<Parameter> {
        vec![Parameter { kind: Kind::Number, default: Some(Value::Number(*self)), ..field }]
    }

    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError> {
        *self = values.number(name).unwrap_or(*self);
        Ok(())
    }

    fn check(&self, name: &'static str, range: Range) -> Result<(), ParameterError> {
        range.check(name, *self)
    }
}

impl Field for usize {
    fn parameters(&self, field: Parameter) -> Vec<Parameter> {
        vec![Parameter { kind: Kind::Count, default: Some(Value::Count(*self)), ..field }]
    }

    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError> {
        *self = values.count(name).unwrap_or(*self);
        Ok(())
    }

    fn check(&self, name: &'static str, range: Range) -> Result<(), ParameterError> {
        range.check(name, *self as f64)
    }
}

impl Field for u32 {
    fn parameters(&self, field: Parameter) -> Vec<Parameter> {
        (*self as usize).parameters(field)
    }

    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError> {
        if let Some(count) = values.count(name) {
            *self = count.try_into().map_err(|_| values.refuse(name, "below 2^32"))?;
        }
        Ok(())
    }

    fn check(&self, name: &'static str, range: Range) -> Result<(), ParameterError> {
        range.check(name, f64::from(*self))
    }
}

/// Vertices.
impl Field for Vec<u32> {
    fn parameters(&self, field: Parameter) -> Vec<Parameter> {
        vec![Parameter { kind: Kind::Vertices, ..field }]
    }

    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError> {
        self.extend_from_slice(values.vertices(name));
        Ok(())
    }
}

/// A field that may be left out; without a value it has no default.
impl<T: Field + Default> Field for Option<T> {
    fn parameters(&self, field: Parameter) -> Vec<Parameter> {
        match self {
            Some(value) => value.parameters(field),
            None => {
                let all = T::default().parameters(field).into_iter();
                all.map(|parameter| Parameter { default: None, ..parameter }).collect()
            }
        }
    }

    fn read(&mut self, name: &'static str, values: &Values) -> Result<(), ParameterError> {
        match values.get(name) {
            Some(_) => self.get_or_insert_default().read(name, values),
            None => Ok(()),
        }
    }

    fn check(&self, name: &'static str, range: Range) -> Result<(), ParameterError> {
        self.as_ref().map_or(Ok(()), |value| value.check(name, range))
    }
}
