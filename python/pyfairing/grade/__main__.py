"""`python -m pyfairing.grade QUESTION MESH ANSWER`: the judge as a command."""

from __future__ import annotations

import argparse
import sys
from dataclasses import fields
from pathlib import Path

from .._mesh import read
from ._folder import Options, graded, judges, table

_TEXT = """\
questions: q1 H of the uniform Laplacian, or K (by the name of the file); q2 rows of u, v, E, F, G,
L, M, N; q3 H of the cotangent Laplacian; q4 reconstruction; q5 explicit and q6 implicit smoothing;
q7 denoising. Also mean, gaussian, principal, normals, mass, laplacian, eigenvalues, modes.

ANSWER is a .npy, .npz, .csv, .txt, .mat or .mtx file, a mesh, a mesh with a field
(out.ply:quality), or a folder, which gives a table with a row for each file.

exit status: 0 right, 1 not, 2 unreadable; 0 for folders
"""


def main(arguments: list[str] | None = None) -> int:
    """Runs the command; returns its exit status."""
    parser = argparse.ArgumentParser(
        "python -m pyfairing.grade",
        description="Judges answers to exercises on the Laplacian.",
        epilog=_TEXT,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("question", choices=sorted(judges(Options())))
    parser.add_argument("mesh", help="the mesh of the question (any mesh for q2)")
    parser.add_argument("answer", help="a file, or a folder of submissions")
    parser.add_argument("-o", "--output", help="CSV file of a folder; by default the screen")
    parser.add_argument(
        "--only", default="", metavar="NAME", help="end of the names of the files in a folder"
    )
    parser.add_argument("--k", type=int, default=15, help="modes of a reconstruction (15)")
    parser.add_argument("--lam", type=float, help="step of smoothing (0.5 explicit, 5 implicit)")
    parser.add_argument("--time", type=float, help="step for cotangents, in squared mesh units")
    parser.add_argument("--iterations", type=int, default=10, help="steps of smoothing (10)")
    parser.add_argument("--weights", choices=["uniform", "cotangent"], help="weights of the Laplacian")
    parser.add_argument("--truth", help="mesh without noise, for q7")
    parser.add_argument("--mass", help="file of the mass beside a Laplacian")
    parser.add_argument("--axes", type=float, nargs=3, default=(3, 2, 1), help="half-axes of q2 (3 2 1)")
    given = parser.parse_args(arguments)
    options = Options(**{field.name: getattr(given, field.name) for field in fields(Options)})
    judge, answer = judges(options)[given.question], Path(given.answer)
    try:
        mesh = read(given.mesh)
    except (OSError, ValueError) as error:
        print(f"{given.mesh}: {error}", file=sys.stderr)
        return 2
    if answer.is_dir():
        if given.output is None:
            table(judge, mesh, answer, given.only, sys.stdout)
            return 0
        with open(given.output, "w", encoding="utf-8", newline="") as file:
            count = table(judge, mesh, answer, given.only, file)
        print(f"{count} files graded: {given.output}")
        return 0
    report = graded(judge, mesh, given.answer)
    print(report)
    return 2 if report.status == "unreadable" else 0 if report.right else 1


if __name__ == "__main__":
    sys.exit(main())
