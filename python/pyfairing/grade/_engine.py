"""Search for the conventions that explain an answer.

A formula is a function of the mesh with an argument for each step at which people differ. A
convention changes arguments. All conventions are tried alone and in pairs, and the answers are
compared row by row; then patterns of the difference are named.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import combinations, product
from typing import Any, TypeAlias

import numpy as np

from .._arrays import Bools, Floats
from .._core import FairingError
from ._facts import Facts
from ._report import Convention, Report, Status

#: Values, a size of each row whose rounding is tolerated, and the rows whose sign is rounding.
Answer: TypeAlias = "tuple[Any, ...]"
Formula: TypeAlias = Callable[..., Answer]

#: Tolerances: of the value itself (six digits in text files), and of the terms that it sums.
RELATIVE, ROUNDING = 1e-5, 2e-7
#: Rounding of terms in single precision.
SINGLE = 4e-6

#: Arguments that several conventions may change together; their values are multiplied.
FACTORS = ("factor", "mass_factor", "step")


@dataclass
class Case:
    """An answer, with the formula and the conventions to try.

    `per_corner` gives the candidates for the value of a single incident face, (m, 3) or (m, 3, d);
    `masks` name places where NaN is expected; `hook` is asked after single ones.
    """

    quantity: str
    given: Any
    facts: Facts | None
    formula: Formula
    conventions: tuple[Convention, ...]
    what: str = "vertex"
    table: list[tuple[str, str]] = field(default_factory=list)
    pairs: bool = True
    masks: dict[str, Bools] = field(default_factory=dict)
    per_corner: Any = None
    hook: Callable[[Case], Report | None] | None = None
    rows: Bools = field(init=False)
    wild: Bools = field(init=False)

    def __post_init__(self) -> None:
        self.rows = finite_rows(self.given)
        self.wild = np.zeros_like(self.rows)


@dataclass
class Trial:
    """One combination of conventions, compared with the answer."""

    conventions: tuple[Convention, ...]
    error: Any
    tolerance: Any
    values: Any
    size: Any
    good: Bools
    median: float = 0.0

    @property
    def faults(self) -> int:
        return sum(c.fault for c in self.conventions)

    @property
    def names(self) -> frozenset[str]:
        return frozenset(c.name for c in self.conventions)


def row_norm(values: Any) -> Floats:
    """The length of each row; for matrices the largest entry."""
    if hasattr(values, "tocsr"):
        rows = values.tocsr()
        largest: Floats = np.zeros(rows.shape[0])
        filled = np.diff(rows.indptr) > 0
        if filled.any():
            starts = rows.indptr[:-1][filled]
            largest[filled] = np.maximum.reduceat(np.abs(rows.data), starts)
        return largest
    if values.ndim == 1:
        return np.asarray(np.abs(values))
    if values.ndim == 2 and values.shape[1] > 6:
        return np.asarray(np.abs(values).max(axis=1))
    return np.asarray(np.sqrt((values**2).sum(axis=1)))


def finite_rows(values: Any) -> Bools:
    if hasattr(values, "tocsr"):
        with np.errstate(invalid="ignore"):
            return np.asarray(np.isfinite(np.asarray(values.sum(axis=1)))).reshape(-1)
    return np.asarray(np.isfinite(values).reshape(len(values), -1).all(axis=1))


def attempt(case: Case, conventions: tuple[Convention, ...]) -> Trial | None:
    """Compares the answer with the formula under these conventions; None if they contradict."""
    change: dict[str, Any] = {}
    for convention in conventions:
        for name, value in convention.change.items():
            if name in FACTORS:
                change[name] = change.get(name, 1.0) * value
            elif name in change:
                return None
            else:
                change[name] = value
    try:
        with np.errstate(all="ignore"):
            values, size, *free = case.formula(case.facts, **change)
    except (FairingError, ValueError, ArithmeticError, np.linalg.LinAlgError, RuntimeError):
        return None
    return compared(case, conventions, values, size, *free)


def compared(
    case: Case, conventions: tuple[Convention, ...], values: Any, size: Any, free: Bools | None = None
) -> Trial:
    with np.errstate(all="ignore"):
        if hasattr(values, "tocsr") or values.ndim < 2:
            difference = row_norm(case.given - values)
        else:
            difference = row_norm(np.asarray(case.given) - values)
        if free is not None:
            # The other sign of H turns round the two of H ± √(H² - K), too.
            sizes, expected = (np.sort(np.abs(x).reshape(len(x), -1)) for x in (case.given, values))
            unsigned = np.minimum(row_norm(sizes - expected), row_norm(sizes))
            difference = np.where(free, unsigned, difference)
            if values.ndim == 1:
                values = np.where(free, np.copysign(values, case.given), values)
        own = row_norm(values)
        tolerance = RELATIVE * own + ROUNDING * np.abs(size)
        good = (difference <= tolerance) & np.isfinite(tolerance)
        relative = difference / (own + 1e-3 * np.median(own) + 1e-300)
        median = float(np.median(np.nan_to_num(relative[case.rows], nan=np.inf)))
    return Trial(conventions, difference, tolerance, values, np.abs(size), good | ~case.rows, median)


def combined(case: Case, count: int) -> Iterator[Trial]:
    """All combinations of `count` conventions; pairs that do not fit keep no values."""
    closed = case.facts is not None and not case.facts.border.any()
    tried = [c for c in case.conventions if not (closed and "border" in c.change)]
    common = [c for c in tried if c.base]
    beside = [b for size in range(3) for b in combinations(common, size)] if count > 1 else [()]
    for base, chosen in product(beside, combinations(tried, count)):
        if any(c in chosen for c in base):
            continue
        conventions = base + chosen
        trial = attempt(case, conventions)
        if trial is None:
            continue
        if count > 1 and not trial.good.all():
            trial.error = trial.tolerance = trial.values = trial.size = None
        yield trial


def whole(case: Case, trial: Trial) -> Trial:
    """The trial with its values."""
    if trial.values is None:
        again = attempt(case, trial.conventions)
        assert again is not None
        return again
    return trial


def exclude_wild(case: Case) -> None:
    """Leaves out values beyond all measure: memory that was never set holds numbers of any size."""
    base = attempt(case, ()) if case.rows.any() else None
    if base is None:
        return
    size = row_norm(case.given)
    scale = max(float(np.median(size[case.rows])), float(np.median(base.size)))
    case.wild = case.rows & (size > 1e9 * scale) & (scale > 0)
    case.rows &= ~case.wild


def judge(case: Case) -> Report:
    """The report on an answer."""
    exclude_wild(case)
    if not case.rows.any():
        return Report(
            case.quantity,
            "mistake",
            f"mistake: every {case.what} has the value NaN or infinity",
            (Convention("NaN everywhere", "integers for lengths, 0/0, or nothing returned", {}),),
            table=tuple(case.table),
        )
    trials: list[Trial] = []
    for count in range(3 if case.pairs else 2):
        new = list(combined(case, count))
        fits = [t for t in new if t.good.all() and informative(case, t, case.rows)]
        if fits:
            return explained(case, fits)
        trials += new
        special = case.hook(case) if case.hook is not None and count == 1 else None
        if special is not None:
            return special
    loose = [t for t in trials if len(t.conventions) < 2 and rounds(case, t)]
    if loose:
        return explained(case, loose[:1], " (to single precision)")
    report = partly(case, trials)
    if report is not None:
        return report
    from ._patterns import unexplained

    return unexplained(case, trials)


def rounds(case: Case, trial: Trial) -> bool:
    """True if the difference is that of single precision."""
    with np.errstate(invalid="ignore"):
        good = trial.error <= 3 * trial.tolerance + SINGLE * trial.size
    small = np.median(row_norm(trial.values)) > 100 * SINGLE * np.median(trial.size)
    return bool((good | ~case.rows).all() and small)


def explained(case: Case, fits: list[Trial], more: str = "") -> Report:
    """The report for conventions that fit everywhere (NaN apart)."""
    best = min(fits, key=lambda t: t.faults)
    # Each set of conventions once, without those that contain the best one and more.
    sets = {t.names: t for t in reversed(fits) if t.faults == best.faults}
    others = [t for names, t in sets.items() if not names >= best.names]
    table = list(case.table)
    if others:
        table.append(("fits as well", "; ".join(naming(t.conventions) for t in others[:-4:-1])))
    if not case.rows.all():
        from ._patterns import undefined

        found = undefined(case)
        return measured(
            case,
            best,
            "mistake",
            f"mistake: {found.name} ({found.where}); elsewhere {said(best)}{more}",
            table,
            (found,),
        )
    return measured(case, best, status(best), said(best) + more, table)


def status(trial: Trial) -> Status:
    if trial.faults:
        return "mistake"
    return "right" if all(c.note for c in trial.conventions) else "convention"


def said(trial: Trial) -> str:
    """The verdict in words."""
    if not trial.conventions:
        return "right"
    kind = status(trial)
    if kind == "right":
        return f"right ({naming(trial.conventions)})"
    if kind == "convention":
        return f"right by another convention: {naming(trial.conventions)}"
    return accused(trial.conventions)


def accused(conventions: tuple[Convention, ...]) -> str:
    """Mistakes with their places, then the conventions beside them."""
    faults = " and ".join(f"{c.name} ({c.where})" if c.where else c.name for c in conventions if c.fault)
    plain = naming(tuple(c for c in conventions if not c.fault))
    return f"mistake: {faults}" + (f"; by convention: {plain}" if plain != "our formula" else "")


def naming(conventions: tuple[Convention, ...]) -> str:
    """The names; those that are the standard answer, too, come last."""
    return " and ".join(c.name for c in sorted(conventions, key=lambda c: c.note)) or "our formula"


def measured(
    case: Case,
    trial: Trial,
    kind: Status,
    verdict: str,
    table: list[tuple[str, str]],
    found: tuple[Convention, ...] = (),
) -> Report:
    """A report with the errors of a trial."""
    error = np.where(case.rows, trial.error, 0.0)
    error = np.where(np.isfinite(error), error, np.inf)
    worst = int(error.argmax())
    return Report(
        case.quantity,
        kind,
        verdict,
        found + trial.conventions,
        float(error[worst]),
        float(np.sqrt((error[case.rows] ** 2).mean())),
        float(trial.tolerance[worst]),
        worst,
        tuple(table),
    )


def partly(case: Case, trials: list[Trial]) -> Report | None:
    """Right inside, right except where triangles are obtuse, or both."""
    facts = case.facts
    if facts is None or case.what != "vertex" or len(case.rows) != facts.n:
        return None
    regions: list[tuple[Status, str, Bools]] = [
        ("border", "at the border", facts.border),
        ("obtuse", "where a triangle is obtuse", facts.obtuse),
        ("border", "at the border and where a triangle is obtuse", facts.border | facts.obtuse),
    ]
    for kind, words, region in regions:
        rest = ~region & case.rows
        # A handful of vertices would fit too much.
        if not region.any() or rest.sum() < max(4, 0.02 * facts.n):
            continue
        telling = [whole(case, t) for t in trials if t.good[rest].all()]
        telling = [t for t in telling if informative(case, t, rest)]
        if not telling:
            continue
        best = min(telling, key=lambda t: (len(t.conventions) + t.faults, -int(t.good.sum())))
        extended = [attempt(case, (*best.conventions, c)) for c in case.conventions]
        fits = [t for t in extended if t is not None and t.good.all()]
        if fits:
            return explained(case, fits)
        return _partly(case, best, kind, words, region)
    return None


def informative(case: Case, trial: Trial, rest: Bools) -> bool:
    """False if what is compared is zero, or below the tolerance: any factor explains that."""
    if not trial.conventions:
        return True
    tolerance = trial.tolerance[rest]
    sizes = (row_norm(values)[rest] for values in (trial.values, case.given))
    return all(bool((size > tolerance).any()) for size in sizes)


def _partly(case: Case, best: Trial, kind: Status, words: str, region: Bools) -> Report:
    from ._patterns import difference_in_words

    wrong = region & ~best.good & case.rows
    detail, found = difference_in_words(case, best, wrong)
    undefined = int((~case.rows).sum())
    if undefined:
        words += f" (and NaN at {undefined})"
    names = f" ({naming(best.conventions)})" if best.conventions else ""
    verdict = f"right inside{names}; {words} {detail}"
    if kind == "obtuse":
        verdict = f"right except {words}{names}: {detail}"
    if best.faults:
        verdict = f"mistake: {naming(best.conventions)}; besides, {words} {detail}"
        kind = "mistake"
    counts = f"{int(wrong.sum())} of {int(region.sum())} such vertices"
    table = [*case.table, ("wrong", counts)]
    return measured(case, best, kind, verdict, table, found)
