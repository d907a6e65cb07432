"""Values of the options of algorithms, as the tables of the crates name and read them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from . import _arrays, _core
from ._core import OptionError

_OF_METHODS: dict[str, list[str]] = dict(_core.tables()["parameters_of_methods"])

#: Options with another name in Python, where `lambda` is a word of the language, and
#: `kind` is that of every Laplacian.
_OTHER = {"lam": "lambda", "kind": "operator"}
#: Options that are whole numbers.
_WHOLE = ("iterations", "degree", "order", "modes")


def _name(option: str) -> str:
    return _OTHER.get(option, option.replace("_", "-"))


def _value(option: str, value: Any) -> Any:
    if isinstance(value, (str, list)):
        return value
    return _arrays.whole(value, option) if option in _WHOLE else float(value)


def parameters(method: str, options: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """The options that are given, by the names of the tables."""
    given = {o: v for o, v in options.items() if v is not None and (not isinstance(v, list) or v)}
    if method in _OF_METHODS:
        for option in given:
            if _name(option) not in _OF_METHODS[method]:
                names = ", ".join(m for m, of in _OF_METHODS.items() if _name(option) in of)
                raise OptionError(
                    f"the method {method} has no option {option}; those that have it are {names}"
                )
    for a, b in (("lam", "time"), ("mu", "pass_band"), ("time", "cutoff"), ("cutoff", "modes")):
        if a in given and b in given:
            raise OptionError(f"give {a} or {b}, not both")
    return [(_name(option), _value(option, value)) for option, value in given.items()]
