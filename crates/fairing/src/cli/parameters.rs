//! Flags made from the tables of algorithms.
//!
//! A verb that runs one of several algorithms takes the parameters of all of them as flags. The
//! help of a flag names the algorithms that have it; so does the error for a flag that the chosen
//! algorithm does not have.

use std::marker::PhantomData;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};
use fairing::parameters::{Algorithm, Family, Kind, Parameter, Range, Value};

use super::context::Failure;
use super::table::Table;

/// Values given to the parameters of a family, each with the name of its parameter.
pub(crate) struct Parameters<F> {
    given: Vec<(&'static str, Value)>,
    family: PhantomData<F>,
}

impl<F: Family> Parameters<F> {
    /// The values, with the names of their parameters.
    pub(crate) fn given(&self) -> &[(&'static str, Value)] {
        &self.given
    }

    /// The value of a parameter, if it is given.
    pub(crate) fn get(&self, name: &str) -> Option<&Value> {
        self.given.iter().find(|(given, _)| *given == name).map(|(_, value)| value)
    }

    /// The algorithm of that name. Fails for a given parameter that it does not have and for a
    /// missing one that it requires.
    pub(crate) fn check(&self, name: &str) -> Result<Algorithm, Failure> {
        self.check_but(name, None)
    }

    /// [`check`](Self::check) where another flag stands for a parameter.
    pub(crate) fn check_but(&self, name: &str, given: Option<&str>) -> Result<Algorithm, Failure> {
        let what = F::WHAT;
        let mut all = F::algorithms().into_iter();
        let algorithm = all.find(|algorithm| algorithm.name == name);
        let algorithm =
            algorithm.ok_or_else(|| Failure::usage(format_args!("there is no {what} {name}")))?;
        if let Some((flag, _)) = self.given.iter().find(|(g, _)| algorithm.parameter(g).is_none()) {
            return Err(foreign::<F>(name, flag, |algorithm| algorithm.parameter(flag).is_some()));
        }
        let mut needed = algorithm.parameters.iter().filter(|parameter| parameter.required);
        if let Some(Parameter { name: flag, about, .. }) =
            needed.find(|p| self.get(p.name).is_none() && given != Some(p.name))
        {
            return Err(Failure::usage(format_args!("the {what} {name} needs --{flag}: {about}")));
        }
        Ok(algorithm)
    }
}

/// The error for a flag that an algorithm does not have, naming those that do.
pub(crate) fn foreign<F: Family>(
    name: &str,
    flag: &str,
    has: impl Fn(&Algorithm) -> bool,
) -> Failure {
    let mut all = F::algorithms();
    all.retain(|algorithm| has(algorithm));
    let names: Vec<&str> = all.iter().map(|algorithm| algorithm.name).collect();
    let (what, names) = (F::WHAT, names.join(", "));
    Failure::usage(format_args!("the {what} {name} has no --{flag}; it belongs to {names}"))
}

/// The algorithms with their uses, parameters and defaults.
pub(crate) fn list<F: Family>() -> Table {
    let mut table = Table::new();
    for algorithm in F::algorithms() {
        let about = format!("{}: {}", algorithm.name, algorithm.description);
        let flag = |parameter: &Parameter| match &parameter.default {
            None => format!("--{}", parameter.name),
            Some(default) => format!("--{} {default}", parameter.name),
        };
        let flags: Vec<String> = algorithm.parameters.iter().map(flag).collect();
        table.row([about]);
        if !flags.is_empty() {
            table.row([format!("    {}", flags.join(", "))]);
        }
    }
    table
}

/// The names of algorithms as values of a flag, each with its description.
pub(crate) fn names<F: Family>() -> PossibleValuesParser {
    let value = |of: Algorithm| PossibleValue::new(of.name).help(of.description);
    PossibleValuesParser::new(F::algorithms().into_iter().map(value))
}

/// A parameter, and the names of all algorithms that have it.
type Shared = Vec<(&'static str, Parameter)>;

/// The parameters of all algorithms; those of the same name are one flag.
fn shared<F: Family>() -> Vec<Shared> {
    let mut all: Vec<Shared> = Vec::new();
    for algorithm in F::algorithms() {
        for parameter in algorithm.parameters {
            match all.iter_mut().find(|same| same[0].1.name == parameter.name) {
                Some(same) => same.push((algorithm.name, parameter)),
                None => all.push(vec![(algorithm.name, parameter)]),
            }
        }
    }
    all
}

/// Short and long help of a parameter: its meaning, algorithms and defaults.
fn help(same: &Shared) -> (String, String) {
    let mut meanings: Vec<(String, Vec<String>)> = Vec::new();
    let first = &same[0].1.default;
    let alone = same.iter().all(|(_, parameter)| parameter.default == *first);
    for (algorithm, parameter) in same {
        let about = match parameter.unit {
            "" => parameter.about.to_owned(),
            unit => format!("{}, in {unit}", parameter.about),
        };
        let plain = [Range::FINITE, Range::POSITIVE, Range::NOT_NEGATIVE];
        let is_plain = plain.contains(&parameter.range);
        let about = if is_plain { about } else { format!("{about}, {}", parameter.range) };
        let taker = match &parameter.default {
            Some(default) if !alone => format!("{algorithm} ({default})"),
            _ => (*algorithm).to_owned(),
        };
        match meanings.iter_mut().find(|(known, _)| *known == about) {
            Some((_, takers)) => takers.push(taker),
            None => meanings.push((about, vec![taker])),
        }
    }
    let default = match first {
        Some(default) if alone => format!("; {default} unless set"),
        _ => String::new(),
    };
    let short: Vec<&str> = meanings.iter().map(|(about, _)| about.as_str()).collect();
    let short = format!("{}{default}", short.join("; or: "));
    let long: Vec<String> =
        meanings.iter().map(|(about, takers)| format!("{about} [{}]", takers.join(", "))).collect();
    (short, format!("{}{default}", long.join("\n")))
}

fn flag(same: &Shared) -> Arg {
    let parameter = &same[0].1;
    let (mut short, mut long) = help(same);
    if parameter.kind == Kind::Vertices {
        let syntax = ": numbers from 0 and ranges such as 10-19, separated by commas";
        short += syntax;
        long += syntax;
    }
    let arg = Arg::new(parameter.name).long(parameter.name).help(short).long_help(long);
    let conflicts = same.iter().flat_map(|(_, parameter)| parameter.excludes);
    let arg = arg.conflicts_with_all(conflicts.copied());
    let kind = parameter.kind;
    let read = move |text: &str| {
        kind.read(text.into()).map_err(|expected| format!("it must be {expected}"))
    };
    match kind {
        Kind::Number => arg.value_name("X").allow_negative_numbers(true).value_parser(read),
        Kind::Count => arg.value_name("N").value_parser(read),
        Kind::Choice(choices) => {
            let values =
                choices.iter().map(|choice| PossibleValue::new(choice.name).help(choice.about));
            let names = PossibleValuesParser::new(values);
            arg.value_parser(names.map(|name| Value::from(name.as_str())))
        }
        list => {
            let name = if list == Kind::Vertices { "LIST" } else { "V:W[:X:Y:Z]" };
            let arg = arg.value_name(name).allow_hyphen_values(list != Kind::Vertices);
            arg.action(ArgAction::Append).value_parser(read)
        }
    }
}

impl<F: Family> Args for Parameters<F> {
    fn augment_args(command: Command) -> Command {
        command.args(shared::<F>().iter().map(flag))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<F: Family> FromArgMatches for Parameters<F> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut given = Vec::new();
        for same in shared::<F>() {
            let name = same[0].1.name;
            let values = matches.get_many::<Value>(name).into_iter().flatten().cloned();
            given.extend(values.reduce(Value::and).map(|value| (name, value)));
        }
        Ok(Self { given, family: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
