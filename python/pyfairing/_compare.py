"""Scores of a mesh against a reference."""

from __future__ import annotations

from . import _core
from ._calls import Progress, running
from ._docs import documented
from ._mesh import Mesh
from ._results import Scores


@documented
def compare(
    mesh: Mesh,
    reference: Mesh,
    *,
    hausdorff_tolerance: float = 1e-4,
    feature_angle: float = 30.0,
    threads: int | None = None,
    progress: Progress = None,
) -> Scores:
    """Scores a mesh against a reference.

    Reports distances between the surfaces in both directions, exact in double precision;
    angles between corresponding normals; changes of volume, area and edge length; flipped
    faces, self-intersections, and sharp edges lost and gained.

    Parameters
    ----------
    mesh, reference : Mesh
        Scores that compare element by element need the same faces.
    hausdorff_tolerance : float
        Largest gap between the two bounds of the Hausdorff distance, in diagonals; at least
        the rounding of the coordinates.
    feature_angle : float
        Smallest dihedral angle of a sharp edge, in degrees.
    {run}

    Returns
    -------
    Scores
        A mapping from the names of `fairing compare --json` to floats, lengths in diagonals
        of the reference. Scores that are not defined are in `Scores.missing`, with the reason.
    """
    with running(threads, progress) as call:
        report, table = _core.compare(
            mesh._core, reference._core, float(hausdorff_tolerance), float(feature_angle), call
        )
    return Scores(report, table)
