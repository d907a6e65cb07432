"""Parameters of algorithms, as the crates declare them."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from . import _arrays, _core
from ._core import OptionError

F = TypeVar("F", bound=Callable[..., object])

#: A parameter as the extension describes it.
Parameter = Mapping[str, Any]

_TYPES = {
    "number": "float",
    "count": "int",
    "vertices": "array_like of int or bool",
    "weighted": "iterable of (vertex, weight) or (vertex, weight, target)",
}


def python_name(name: str) -> str:
    """The name of a parameter, where `lambda` is a word of the language and `kind` is that of Laplacians."""
    return {"lambda": "lam", "operator": "kind"}.get(name, name.replace("-", "_"))


def _parameter(of: Parameter) -> Parameter:
    """A parameter with its name in Python and its name in the crates, the `key`."""
    bounded = of["high"] is not None or of["low"] not in (None, 0.0)
    return {
        **of,
        "name": python_name(of["name"]),
        "key": of["name"],
        "range": of["range"] if bounded else None,
        "default": of["default"] or None,
        "choices": [(choice["name"], choice["about"]) for choice in of["choices"]],
        "excludes": [python_name(name) for name in of["excludes"]],
    }


class Family:
    """The algorithms of one kind, with their parameters."""

    def __init__(self, what: str) -> None:
        self.what = what
        methods: list[dict[str, Any]] = _core.tables()[what]
        self.descriptions: dict[str, str] = {method["name"]: method["about"] for method in methods}
        self.algorithms: dict[str, dict[str, Parameter]] = {
            method["name"]: {python_name(p["name"]): _parameter(p) for p in method["parameters"]}
            for method in methods
        }
        #: Each parameter by name, with the algorithms that have it.
        self.parameters: dict[str, dict[str, Parameter]] = {}
        for name, parameters in self.algorithms.items():
            for parameter in parameters.values():
                self.parameters.setdefault(parameter["name"], {})[name] = parameter

    def values(self, algorithm: str, options: Mapping[str, Any], n: int) -> list[tuple[str, Any]]:
        """The given options by the names of the crates; `n` is the number of vertices."""
        for option in options:
            if option not in self.parameters:
                raise TypeError(f"there is no option {option} of any {self.what}")
        known = self.algorithms.get(algorithm)
        given = {option: value for option, value in options.items() if value is not None}
        if known is None:
            # The extension refuses the name and lists the known ones.
            return []
        for option in given:
            if option not in known:
                names = ", ".join(self.parameters[option])
                raise OptionError(
                    f"the {self.what} {algorithm} has no option {option}; those that have it are {names}"
                )
            for other in known[option]["excludes"]:
                if other in given:
                    raise OptionError(f"give {option} or {other}, not both")
        return [(known[option]["key"], _value(known[option], value, n)) for option, value in given.items()]

    def documentation(self) -> str:
        """The parameters as a section of a docstring."""
        return "\n".join(_entry(name, of) for name, of in self.parameters.items())

    def takes(self, function: F) -> F:
        """Replaces the keywords in the signature of a function by the parameters."""
        signature = inspect.signature(function)
        keywords = [
            inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=_type(of))
            for name, of in self.parameters.items()
        ]
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        places = [i for i, p in enumerate(own) if p.kind is inspect.Parameter.KEYWORD_ONLY]
        first = places[0] if places else len(own)
        parameters = [*own[:first], *keywords, *own[first:]]
        function.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        return function


def _value(parameter: Parameter, value: Any, n: int) -> Any:
    name, kind = parameter["name"], parameter["kind"]
    if kind == "number":
        return float(value)
    if kind == "count":
        return _arrays.whole(value, name)
    if kind == "vertices":
        return _arrays.numbers(value, n, name)
    if kind == "weighted":
        return [_weighted(name, *entry) for entry in value]
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a name, not {type(value).__name__}")
    return value


def _weighted(name: str, vertex: int, weight: float, target: Any = None) -> Any:
    point = None if target is None else _arrays.point(target, f"a target of {name}")
    return _arrays.whole(vertex, f"a vertex of {name}"), float(weight), point


def _type(of: Mapping[str, Parameter]) -> str:
    """The type for a docstring, with the choices of all algorithms."""
    names = [name for parameter in of.values() for name, _ in parameter["choices"]]
    if names:
        return "{" + ", ".join(f"'{name}'" for name in dict.fromkeys(names)) + "}"
    (kind,) = {_TYPES[parameter["kind"]] for parameter in of.values()}
    return kind


def _entry(name: str, of: Mapping[str, Parameter]) -> str:
    """The entry of a docstring: each meaning with the algorithms that have it and their defaults."""
    meanings: dict[str, list[str]] = {}
    for algorithm, parameter in of.items():
        parts = (parameter["about"], parameter["unit"] and f"in {parameter['unit']}", parameter["range"])
        meaning = ", ".join(part for part in parts if part)
        default = parameter["default"]
        meanings.setdefault(meaning, []).append(
            f"`{algorithm}`" + ("" if default is None else f" ({default})")
        )
    lines = [f"{name} : {_type(of)}, optional"]
    for meaning, names in meanings.items():
        text = f"{meaning}: {', '.join(names)}."
        wrapped = textwrap.wrap(text, 84, break_on_hyphens=False)
        lines += [f"    {line}" for line in wrapped]
    return "\n".join(lines)


ESTIMATOR = Family("estimator")
METHOD = Family("method")
DENOISER = Family("denoiser")
