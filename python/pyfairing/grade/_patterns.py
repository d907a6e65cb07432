"""Names for differences that no convention explains: factors, fields, orders, NaN, places."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from .._arrays import Bools, Floats
from ._engine import RELATIVE, Case, Trial, informative, measured, naming, row_norm, whole
from ._report import Convention, Report, Status

_FRACTIONS = {
    2.0: "2", 0.5: "1/2", 3.0: "3", 1 / 3: "1/3", 4.0: "4", 0.25: "1/4", 6.0: "6", 1 / 6: "1/6",
    1.5: "3/2", 2 / 3: "2/3", 8.0: "8", 0.125: "1/8", 12.0: "12", 1 / 12: "1/12", np.pi: "π",
    2 * np.pi: "2π", 1 / np.pi: "1/π", 0.5 / np.pi: "1/(2π)", 180 / np.pi: "180/π (degrees)",
    np.pi / 180: "π/180 (radians taken for degrees)", 100.0: "100", 0.01: "1/100", 2**0.5: "√2",
}  # fmt: skip


def undefined(case: Case) -> Convention:
    """The pattern of the values that are NaN."""
    bad = ~case.rows
    if case.wild.any():
        count = f"{int(case.wild.sum())} {plural(case.what)}, first at {int(case.wild.argmax())}"
        return Convention(f"values without measure at {count}", "memory that was never set to 0", {})
    masks: dict[str, tuple[Bools, str]] = {}
    facts = case.facts
    if facts is not None and len(bad) == facts.n:
        matrix = facts.stiffness()
        scale = matrix.diagonal() * facts.mesh.mean_edge_length
        flat = row_norm(np.asarray(matrix @ facts.points)) <= 1e-9 * np.abs(scale)
        inner = ~facts.border
        masks = {
            "inside": (inner, "only the branch for the border returns a value"),
            "at the border": (facts.border, "a neighbour or a face that does not exist, or 0/0"),
            "at flat vertices": (flat, "a division 0/0, such as s/|s| for a sign or v/‖v‖ of a zero vector"),
            "at flat vertices inside": (flat & inner, "a division 0/0, such as s/|s| for a sign"),
            "at isolated vertices": (facts.degree == 0, "a division by the area or the degree 0"),
            "where a triangle is obtuse": (facts.obtuse, "the logarithm or root of a negative cotangent"),
        }
        for name, mask in case.masks.items():
            masks[name] = (mask, "a root of a negative number: clamp it at 0")
        smallest = facts.corner_sizes["smallest angle"]
        needles = (smallest < np.deg2rad(1.0)) | (facts.corner_sizes["largest angle"] > np.deg2rad(178))
        masks["at needles"] = (needles, "acos of a number just above 1: clamp it, or take atan2")
    for name, (mask, reason) in masks.items():
        if (mask == bad).all():
            return Convention(f"NaN {name}", reason, {})
    around = [(int(m.sum()), n) for n, (m, _) in masks.items() if not (bad & ~m).any()]
    if around and min(around)[0] <= 4 * bad.sum():
        size, name = min(around)
        return Convention(f"NaN {name}", f"{masks[name][1]} (at {bad.sum()} of {size})", {})
    first = int(np.flatnonzero(bad)[0])
    return Convention(
        f"NaN at {int(bad.sum())} of {len(bad)}, first at {first}", "0/0, or a root below 0", {}
    )


def difference_in_words(case: Case, trial: Trial, wrong: Bools) -> tuple[str, tuple[Convention, ...]]:
    """The wrong values against ours."""
    given = np.asarray(case.given.todense()) if hasattr(case.given, "todense") else np.asarray(case.given)
    ours = np.asarray(trial.values.todense()) if hasattr(trial.values, "todense") else trial.values
    mine, theirs = ours[wrong], given[wrong]
    if not wrong.any():
        return "the values are undefined", ()
    tiny = 1e-9 * np.median(trial.size)
    if (np.abs(theirs) <= tiny).all():
        return "the values are 0", (Convention("0 there", "vertices left out", {}, False),)
    flat, own = theirs.reshape(-1), mine.reshape(-1)
    filled = np.abs(own) > 1e-6 * np.abs(own).max() if np.abs(own).max() > 0 else own > 0
    if filled.any():
        ratios = flat[filled] / own[filled]
        if np.ptp(ratios) < 1e-4 * abs(ratios[0]):
            name = _number(ratios[0])
            return f"the values are ours times {name}", (Convention(f"times {name} there", "there", {}),)
    errors = np.where(wrong, trial.error, 0.0)
    worst = int(np.nan_to_num(errors).argmax())
    if given.ndim == 1:
        return (f"values differ, such as {given[worst]:.4g} for {ours[worst]:.4g} at vertex {worst}", ())
    return f"the values differ, by up to {errors[worst]:.3g} at vertex {worst}", ()


def unexplained(case: Case, trials: list[Trial]) -> Report:
    """The report if no pair of conventions fits everywhere, nor inside."""
    rows: list[tuple[str, Bools]] = [("", case.rows)]
    if case.facts is not None and case.what == "vertex" and len(case.rows) == case.facts.n:
        inner = case.rows & ~case.facts.border
        if inner.sum() > 8 and (inner != case.rows).any():
            rows.append((" inside; the border differs, too", inner))
    simple = [t for t in trials if len(t.conventions) < 2]
    base = simple[0] if simple else None
    near = [t for t in simple if all(c.note or c.base for c in t.conventions)]
    for words, mask in rows:
        for tests, tried in (
            ((_factor, _field, _signs), simple),
            ((_rounded,), near),
            ((_clipped, _rolled, _affine, _monotone, _columns, _directions, _entries_of), near),
        ):
            for trial in tried:
                for test in tests:
                    found = test(case, trial, mask)
                    if found is None:
                        continue
                    names = f"{naming(trial.conventions)} and " if trial.conventions else ""
                    kind: Status = "mistake" if found.fault or trial.faults or words else "convention"
                    start = "mistake" if kind == "mistake" else "right by another convention"
                    text = f"{start}: {names}{found.name} ({found.where}){words}"
                    return measured(case, trial, kind, text, case.table, (found,))
    if base is None:
        return Report(case.quantity, "unexplained", "no formula applies to this mesh")
    for trial in near:
        for found in _structure(case, trial):
            return measured(case, trial, "mistake", f"mistake: {found.name}", case.table, (found,))
    return _places(case, trials)


def _number(value: float) -> str:
    for known, name in _FRACTIONS.items():
        for sign, mark in ((1, ""), (-1, "-")):
            if abs(value - sign * known) < 3e-5 * known:
                return mark + name
    return f"{value:.6g}"


def _entries(case: Case, trial: Trial, mask: Bools) -> tuple[Floats, Floats, Floats] | None:
    """Answer, ours and tolerance of the rows, as dense arrays; None for matrices."""
    if hasattr(case.given, "todense") or np.shape(case.given) != np.shape(trial.values):
        return None
    given, ours = (np.asarray(x, dtype=float)[mask] for x in (case.given, trial.values))
    return given, ours, trial.tolerance[mask]


def _factor(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """A constant factor, with a name if it is a known one."""
    if not np.isfinite(trial.tolerance[mask]).all():
        return None
    if hasattr(case.given, "todense"):
        given, ours = case.given[mask].tocsr(), trial.values.tocsr()[mask]
        square = ours.multiply(ours).sum()
        c = float(given.multiply(ours).sum() / square) if square > 0 else 1.0
        error, scale = row_norm(given - c * ours), row_norm(ours)
    else:
        parts = _entries(case, trial, mask)
        if parts is None:
            return None
        given, ours, _ = parts
        square = float((ours**2).sum())
        c = float((given * ours).sum() / square) if square > 0 else 1.0
        error, scale = row_norm(given - c * ours), row_norm(ours)
    if abs(c) < 1e-12 or abs(c - 1) < 1e-4 or not informative(case, trial, mask) or len(scale) < 4:
        return None
    if not (error <= 3 * RELATIVE * abs(c) * (scale + np.median(scale))).all():
        return None
    return Convention(f"times {_name_of_factor(case, c)}", "a constant factor", {})


def _name_of_factor(case: Case, c: float) -> str:
    name = _number(c)
    if case.facts is None or not name.replace(".", "").replace("-", "").replace("e", "").isalnum():
        return name
    mesh = case.facts.mesh
    known = {
        "the area of the mesh": mesh.area, "the mean edge length h": mesh.mean_edge_length,
        "h²": mesh.mean_edge_length**2, "the diagonal of the box": mesh.diagonal,
        "the number of vertices": float(mesh.n_vertices),
        "the number of faces": float(mesh.n_faces),
        "the area per vertex": mesh.area / mesh.n_vertices,
    }  # fmt: skip
    for text, value in known.items():
        for power, form in ((1, "{}"), (-1, "1 / {}")):
            for k in (1.0, 2.0, 0.5, -1.0):
                if abs(c - k * value**power) < 3e-5 * abs(c):
                    return form.format(text) if k == 1 else f"{_number(k)} times {form.format(text)}"
    return name


def _field(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """A known field of the vertices as a factor, up to a constant."""
    parts, facts = _entries(case, trial, mask), case.facts
    if (
        not np.isfinite(trial.tolerance[mask]).all()
        or parts is None
        or facts is None
        or len(case.rows) != facts.n
    ):
        return None
    given, ours, tolerance = parts
    one, other = (x.reshape(len(x), -1) for x in (given, ours))
    square = (other**2).sum(axis=1)
    clear = square > (100 * tolerance) ** 2
    if clear.sum() < max(4, 0.5 * len(clear)):
        return None
    ratio = (one * other).sum(axis=1)[clear] / square[clear]
    if not ratio.any():
        return None
    off = row_norm(one[clear] - ratio[:, None] * other[clear])
    absent = (row_norm(one) > 100 * tolerance) & ~clear & (square == 0)
    if absent.any() or not (off <= 1e-4 * row_norm(one[clear]) + 30 * tolerance[clear]).all():
        return None
    known: dict[str, Callable[[], Floats]] = {
        "the barycentric area": lambda: facts.area("barycentric"),
        "the mixed area": lambda: facts.area("mixed"),
        "the degree": lambda: facts.degree,
        "the angle sum": lambda: facts.angle_sum,
        "the number of the vertex": lambda: np.arange(facts.n, dtype=float),
        "the number of the vertex, from 1,": lambda: np.arange(1, facts.n + 1, dtype=float),
        "the length of the position": lambda: np.linalg.norm(facts.points, axis=1),
        "the length of the normal": lambda: row_norm(facts.normal_sum("area")),
        "the sum of the cotangents": lambda: facts.stiffness().diagonal(),
    }
    for name, make in known.items():
        values = make()[mask][clear]
        if not (values > 0).all() or np.ptp(values) < 1e-3 * values.mean():
            continue
        for power, form in ((1, "times {}"), (-1, "divided by {}"), (0.5, "times √ of {}"),
                            (-0.5, "divided by √ of {}"), (2, "times {}, squared"),
                            (-2, "divided by {}, squared")):  # fmt: skip
            constant = ratio / values**power
            spread = np.ptp(constant) / (abs(np.median(constant)) or np.inf)
            if spread < min(1e-4, 0.05 * np.ptp(values**power) / np.median(values**power)):
                c = float(np.median(constant))
                more = "" if abs(c - 1) < 1e-4 else f" (and times {_number(c)})"
                return Convention(form.format(name) + more, "a factor of its own at each vertex", {})
    return None


def _signs(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """Right sizes with other signs."""
    parts = _entries(case, trial, mask)
    if parts is None or parts[0].ndim != 1 or case.what == "value":
        return None
    given, ours, tolerance = parts
    wrong = np.abs(given - ours) > tolerance
    clear = np.abs(ours) > 100 * tolerance
    if not (np.abs(np.abs(given) - np.abs(ours)) <= 3 * tolerance).all() or clear.sum() < 4:
        return None
    if (given >= 0).all():
        return Convention("absolute value", "the sign is dropped", {})
    text = f"at {int(wrong.sum())} of {len(wrong)}: one component, or a comparison, decides the sign"
    return Convention("right sizes with wrong signs", text, {})


def _rounded(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """Ours, rounded to decimals, to digits or to half precision."""
    parts = _entries(case, trial, mask)
    if parts is None:
        return None
    given, ours, tolerance = parts
    size = np.maximum(np.abs(given), 1e-300)
    steps: dict[str, Any] = {f"{d} decimals": 10.0**-d for d in range(7)}
    steps |= {f"{d} digits": 10.0 ** (np.floor(np.log10(size)) + 1 - d) for d in range(2, 5)}
    steps["half precision"] = np.maximum(2.0 ** np.floor(np.log2(size)), 2.0**-14) / 2**10
    off = np.abs(given - ours) - tolerance.reshape(-1, *[1] * (given.ndim - 1))
    for name, step in steps.items():
        count = given / step
        whole_steps = np.abs(count - np.round(count)) < 1e-6 * (1 + np.abs(count))
        if whole_steps.all() and (off < step).all() and np.ptp(given) > 0.5 * np.min(step):
            fault = name in ("0 decimals", "1 decimals")
            return Convention(f"rounded to {name}", "the file, or integers", {}, fault)
    return None


def _clipped(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """Ours, cut at the ends."""
    parts = _entries(case, trial, mask)
    if parts is None or parts[0].ndim > 1 or case.what != "vertex":
        return None
    given, ours, tolerance = parts
    low, high = given.min(), given.max()
    cut = np.abs(np.clip(ours, low, high) - given) <= tolerance
    if cut.all() and low < high and 0.2 < ((ours > low) & (ours < high)).mean():
        return Convention(f"cut off at {low:.4g} and {high:.4g}", "values clipped for a picture", {})
    return None


def _rolled(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """Ours at the next vertex."""
    given, ours = case.given, trial.values
    if hasattr(given, "todense") or given.shape != ours.shape or case.what != "vertex" or not mask.all():
        return None
    for shift, words in ((1, "later"), (-1, "earlier")):
        moved = np.roll(ours, shift, axis=0)
        if (row_norm(given - moved) <= np.roll(trial.tolerance, shift))[2:-2].all() and np.ptp(ours) > 0:
            return Convention(f"moved by one vertex, {words}", "indices from 1, or a line skipped", {})
    return None


def _affine(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """A linear function of ours."""
    parts = _entries(case, trial, mask)
    if parts is None or parts[0].ndim > 1 or len(parts[0]) < 6 or case.what != "vertex":
        return None
    given, ours, _ = parts
    a, b = np.polyfit(ours, given, 1) if np.ptp(ours) > 0 else (0.0, 0.0)
    spread = np.ptp(given)
    if a == 0 or spread == 0 or not (np.abs(a * ours + b - given) <= 3 * RELATIVE * spread).all():
        return None
    if abs(a - 1) < 1e-4:
        return Convention(f"plus a constant, {b:.6g}", "an offset", {})
    ends = (round(float(given.min()), 6), round(float(given.max()), 6))
    where = f"{a:.4g} times ours plus {b:.4g}: normalised for a picture"
    return Convention(f"scaled to [{ends[0]:g}, {ends[1]:g}]", where, {})


def _monotone(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """A monotone function of ours."""
    parts = _entries(case, trial, mask)
    if parts is None or parts[0].ndim > 1 or len(parts[0]) < 10 or case.what != "vertex":
        return None
    given, ours, tolerance = parts
    order = np.argsort(ours)
    steps, gaps = np.diff(given[order]), np.diff(ours[order]) > 4 * tolerance[order][1:]
    spread = np.ptp(given)
    if gaps.sum() < 8 or spread == 0 or len(np.unique(given)) < 5:
        return None
    for sign, words in ((1, "rising"), (-1, "falling")):
        if (sign * steps >= -1e-9 * spread)[gaps].all():
            return Convention(
                f"a {words} function of ours", "a logarithm, a root, an equalised histogram or colours", {}
            )
    return None


def _columns(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """Some coordinates right, or in another order."""
    parts = _entries(case, trial, mask)
    if parts is None or parts[0].ndim != 2 or parts[0].shape[1] != 3:
        return None
    given, ours, tolerance = parts
    for order in ((0, 2, 1), (1, 0, 2), (2, 1, 0), (1, 2, 0), (2, 0, 1)):
        for flip in (1.0, -1.0):
            turned = ours[:, list(order)] * [1.0, flip, 1.0]
            if (row_norm(given - turned) <= 3 * tolerance).all() and informative(case, trial, mask):
                return Convention(
                    f"axes in the order {''.join('xyz'[k] for k in order)}", "a file of another tool", {}
                )
    good = [(np.abs(given[:, k] - ours[:, k]) <= tolerance).all() for k in range(3)]
    if any(g and np.ptp(x) > 0 for g, x in zip(good, ours.T)) and not all(good):
        names = "xyz"
        wrong = " and ".join(names[k] for k in range(3) if not good[k])
        still = case.facts is not None and case.facts.points.shape == case.given.shape and all(
            np.abs(given[:, k] - case.facts.points[mask][:, k]).max() <= tolerance.max()
            for k in range(3) if not good[k]
        )  # fmt: skip
        return Convention(
            f"wrong in {wrong} alone", "a coordinate is not moved" if still else "one coordinate", {}
        )
    return None


def _directions(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """Vectors of the right direction, with other lengths or signs."""
    parts = _entries(case, trial, mask)
    if parts is None or parts[0].ndim != 2 or parts[0].shape[1] != 3 or case.quantity != "vertex normals":
        return None
    given, ours, _ = parts
    lengths = row_norm(given)
    if (lengths == 0).any():
        return None
    cosines = (given * ours).sum(axis=1) / lengths / np.maximum(row_norm(ours), 1e-300)
    if not (np.abs(np.abs(cosines) - 1) < 1e-8).all():
        return None
    if (cosines > 0).all() or (cosines < 0).all():
        return Convention("right directions, other lengths", "not normalised", {})
    return Convention(
        "some normals inward", f"{int((cosines < 0).sum())} of {len(cosines)}: not oriented by the faces", {}
    )


def _entries_of(case: Case, trial: Trial, mask: Bools) -> Convention | None:
    """Matrices of which a part is right."""
    given, ours = case.given, trial.values
    if not hasattr(given, "todense") or not mask.all():
        return None
    from scipy.sparse import diags, tril, triu

    def close(a: Any, b: Any) -> bool:
        return bool((row_norm((a - b).tocsr()) <= trial.tolerance).all())

    for name, part in (("upper", triu), ("lower", tril)):
        if close(given, part(ours)):
            return Convention(f"{name} triangle only", "each edge is entered once, not for both vertices", {})
    if close(given, ours.T.tocsr()):
        return Convention("transposed", "rows and columns are exchanged", {})
    own, theirs = ours.diagonal(), given.diagonal()
    if close(given - diags(theirs), ours - diags(own)):
        known = (
            {"the degree": case.facts.degree, "minus the degree": -case.facts.degree} if case.facts else {}
        )
        name = next((n for n, d in known.items() if np.abs(theirs - d).max() < 1e-9), "other values")
        return Convention(f"right but for the diagonal, which has {name}", "the diagonal is the row sum", {})
    return None


def _structure(case: Case, base: Trial) -> Iterator[Convention]:
    """Orders, constants, whole numbers, values of single faces."""
    parts = _entries(case, base, case.rows)
    if parts is None:
        return
    given, ours, _ = parts
    size = float(np.median(base.size)) or 1.0
    rough = 1e-5 * np.abs(ours).max() + 1e-7 * size
    top = np.abs(given).max()
    if top <= 1e-9 * size:
        where = "nothing was added, or an absolute threshold leaves out every triangle: scale the mesh"
        yield Convention("0 everywhere", where, {})
    elif len(given) > 3 and np.ptp(given, axis=0).max() <= 1e-9 * max(size, top):
        where = "a sum over all faces in place of the incident ones, or a mean"
        yield Convention("the same value everywhere", where, {})
    if case.per_corner is not None and case.rows.all() and _one_face(case, rough):
        where = "assigned where it must be added: the last face to be visited wins"
        yield Convention("the value of one incident face", where, {})
    # Signs of numbers may be rounding.
    one, other = (given, ours) if given.ndim > 1 else (np.abs(given), np.abs(ours))
    order = [np.lexsort(x.reshape(len(x), -1).T[::-1].round(9)) for x in (one, other)]
    close = (np.abs(one[order[0]] - other[order[1]]) <= 3 * rough).all()
    if close and case.what == "vertex" and len(given) > 3 and np.ptp(ours, axis=0).max() > 100 * rough:
        where = "vertices were merged, sorted or renumbered"
        yield Convention("our values in another order", where, {})
    shift = np.median(given - ours, axis=0)
    if (row_norm(given - ours - shift) <= 3 * rough).all():
        text = ", ".join(f"{x:.6g}" for x in np.atleast_1d(shift))
        yield Convention(f"plus a constant, {text}", "a centre, a mean or a start value", {})
    sixths, own = given * 6, ours * 6
    if (np.abs(sixths - np.round(sixths)) < 1e-6 * np.abs(given)).all() and top > 0:
        where = "indices or counts in place of measures, or integer division"
        if (np.abs(own - np.round(own)) > 1e-3).any():
            yield Convention("whole numbers (or thirds)", where, {})


def _one_face(case: Case, rough: float) -> bool:
    """True if each value is that of one incident face."""
    assert case.facts is not None
    corners = case.per_corner(case.facts)
    given = np.asarray(case.given, dtype=float).reshape(case.facts.n, -1)
    distance = np.full(case.facts.n, np.inf)
    near = row_norm(corners.reshape(-1, given.shape[1]) - given[case.facts.faces.reshape(-1)])
    np.minimum.at(distance, case.facts.faces.reshape(-1), near)
    return bool((distance[case.facts.degree > 0] <= 3 * rough).all())


def _places(case: Case, trials: list[Trial]) -> Report:
    """Where the difference to the nearest formula begins."""

    # Half of the values right outweighs any nearness of the others.
    ranked = sorted(trials, key=lambda t: (-round(float(t.good.mean()), 2), t.median, len(t.conventions)))
    full = (whole(case, t) for t in ranked[:20])
    best = next((t for t in full if informative(case, t, case.rows)), whole(case, ranked[0]))
    near = f"nearest: {naming(best.conventions)}, right at {100 * best.good.mean():.0f} %"
    correlation = ""
    values, given = best.values, case.given
    if not hasattr(values, "todense") and values.shape == np.shape(given) and case.rows.sum() > 2:
        a, b = np.ravel(np.asarray(given)[case.rows]), np.ravel(values[case.rows])
        if a.std() > 0 and b.std() > 0:
            correlation = f", correlation {np.corrcoef(a, b)[0, 1]:.2f}"
    table = [*case.table, ("nearest", near.removeprefix("nearest: ") + correlation)]
    facts, wrong = case.facts, ~best.good
    place = ""
    if (
        facts is not None
        and case.what == "vertex"
        and len(wrong) == facts.n
        and wrong.any()
        and not wrong.all()
    ):
        place = _separating(facts.border, facts.corner_sizes, wrong)
    found: tuple[Convention, ...] = ()
    if place:
        found = (Convention(f"wrong {place}", "elsewhere the nearest formula fits", {}),)
    if best.good.mean() > 0.5:
        wrong_words = f"wrong at {int(wrong.sum())} of {len(wrong)} {plural(case.what)}"
        verdict = f"{wrong_words}, {place or 'at no particular place'}; {near}"
    elif best.good.mean() > 0.1 or best.median < 0.1:
        verdict = f"no known convention explains the difference ({near})"
    else:
        verdict = "no known convention explains the difference: the answer is near none of ours"
    return measured(case, best, "unexplained", verdict, table, found)


def plural(what: str) -> str:
    return "vertices" if what == "vertex" else f"{what}s"


def _separating(border: Bools, sizes: dict[str, Floats], wrong: Bools) -> str:
    """The property that separates the wrong vertices from the right ones."""
    if not (wrong & ~border).any():
        return "at the border only"
    for name, values in sizes.items():
        in_degrees = np.rad2deg(values) if name.endswith("angle") else values
        low, high = in_degrees[wrong], in_degrees[~wrong]
        if low.max() < high.min():
            return f"where the {name} is at most {low.max():.3g}"
        if low.min() > high.max():
            return f"where the {name} is at least {low.min():.3g}"
    irregular = ~border & (sizes["valence"] != 6)
    if irregular.any() and not (wrong & ~irregular & ~border).any():
        return "where the valence is not 6, and at the border" if (wrong & border).any() else (
            "where the valence is not 6"
        )  # fmt: skip
    return ""
