"""Reports of the judge."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

Status: TypeAlias = Literal["right", "convention", "border", "obtuse", "mistake", "unexplained", "unreadable"]


@dataclass(frozen=True)
class Convention:
    """One way in which formulas differ.

    Attributes
    ----------
    name : str
        Short name, as in "2H instead of H".
    where : str
        The place in the formula.
    change : dict
        Arguments of the formula that differ from ours.
    fault : bool
        False for conventions that textbooks use, True for mistakes.
    note : bool
        True for variants that are the standard answer as much as ours.
    base : bool
        True for the commonest, beside which pairs of others are tried.
    """

    name: str
    where: str
    change: dict[str, object]
    fault: bool = True
    note: bool = False
    base: bool = False


@dataclass(frozen=True, repr=False)
class Report:
    """A verdict on a student's answer; printed, it is a sentence, then a table.

    Attributes
    ----------
    quantity : str
        The judged quantity.
    status : str
        `right`; `convention` (right by another convention); `border` and `obtuse` (right except
        there); `mistake` (explained by the named mistakes); `unexplained`; `unreadable`.
    verdict : str
        One sentence.
    conventions : tuple of Convention
        Conventions and mistakes that explain the answer.
    largest, rms : float or None
        Errors against our answer under these conventions, in units of the quantity.
    tolerance : float or None
        The largest error that counts as rounding.
    vertex : int or None
        The vertex (or entry) of the largest error.
    table : tuple of (str, str)
        Further rows.
    """

    quantity: str
    status: Status
    verdict: str
    conventions: tuple[Convention, ...] = ()
    largest: float | None = None
    rms: float | None = None
    tolerance: float | None = None
    vertex: int | None = None
    table: tuple[tuple[str, str], ...] = field(default=())

    @property
    def right(self) -> bool:
        """True if the answer is right, by our convention or another usual one."""
        return self.status in ("right", "convention")

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the conventions and mistakes."""
        return tuple(c.name for c in self.conventions)

    def __repr__(self) -> str:
        rows = [("judged", self.quantity)]
        rows += [(c.name, c.where) for c in self.conventions]
        if self.largest is not None:
            place = "" if self.vertex is None else f" at {self.vertex}"
            rows.append(("largest error", f"{self.largest:.3g}{place}"))
        if self.rms is not None:
            rows.append(("RMS error", f"{self.rms:.3g}"))
        if self.tolerance is not None:
            rows.append(("tolerance", f"{self.tolerance:.3g}"))
        rows += self.table
        width = max(len(name) for name, _ in rows)
        return "\n".join([self.verdict, "", *(f"  {name:<{width}}  {text}" for name, text in rows)])
