"""Answers from arrays and files, with their shapes checked."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .._arrays import Floats
from .._core import OptionError
from .._mesh import Mesh, read

MESHES = (".obj", ".ply", ".off", ".stl", ".vtp", ".glb")
#: Names of answers of one number per vertex.
SCALARS = ("H", "K", "M")
ARRAYS = (".npy", ".npz", ".csv", ".txt", ".mat", ".mtx", ".dat", ".tsv")


def loaded(source: Any, name: str = "the answer") -> Any:
    """An array or a sparse matrix from an array, a mesh, or the path of a file.

    Files are .npy, .npz (of numpy or of scipy.sparse), .csv, .txt, .mat, .mtx, or a mesh, whose
    positions are read, or the field that follows its name and a colon: `out.ply:quality`. In a
    file of several arrays, a colon and a name choose one; else it is the one of this name.
    Scalars (H, K, M) and normals are the only such field of a mesh.
    """
    if isinstance(source, Mesh):
        return source.vertices
    if not isinstance(source, (str, PathLike)):
        if hasattr(source, "tocsr"):
            return source.tocsr().astype(np.float64)
        if hasattr(source, "vertices"):
            source = source.vertices
        try:
            return _numbers(np.asarray(source), name)
        except ValueError as error:
            raise OptionError(f"{name} is no array: {error}") from error
    text = fspath(source)
    path, _, key = text.partition(":") if not Path(text).exists() else (text, "", "")
    if len(path) == 1 and key and Path(path + ":" + key.partition(":")[0]).exists():
        # The colon of a drive.
        path, key = path + ":" + key.partition(":")[0], key.partition(":")[2]
    ending = Path(path.removesuffix(".gz")).suffix.lower()
    if ending in MESHES:
        return _of_mesh(path, key, name)
    if ending not in ARRAYS:
        raise OptionError(
            f"{path} is no .npy, .npz, .csv, .txt, .mat or .mtx file and no mesh" f" ({', '.join(MESHES)})"
        )
    try:
        found = _from_file(path, ending, key, name)
    except (OptionError, OSError, ImportError):
        raise
    except Exception as error:
        # The readers of numpy and scipy raise errors of any kind for broken files.
        raise OptionError(f"{path} cannot be read: {error}") from error
    return found.tocsr().astype(np.float64) if hasattr(found, "tocsr") else _numbers(np.asarray(found), text)


def _from_file(path: str, ending: str, key: str, name: str) -> Any:
    if ending == ".npy":
        return np.load(path, allow_pickle=False)
    if ending == ".npz":
        with np.load(path, allow_pickle=False) as file:
            if "format" in file and "shape" in file:
                from scipy.sparse import load_npz

                return load_npz(path)
            return _chosen({each: file[each] for each in file.files}, path, key, name)
    if ending == ".mat":
        from scipy.io import loadmat

        arrays = {k: v for k, v in loadmat(path).items() if not k.startswith("__")}
        return _chosen(arrays, path, key, name)
    if ending == ".mtx":
        from scipy.io import mmread

        return mmread(path)
    return _text(path)


def _text(path: str) -> Any:
    """Numbers of a text file: by commas, semicolons, tabs or spaces, below a header or none.

    Without points, and with one comma in each word at most, commas are those of decimals.
    """
    text = Path(path).read_text("utf-8-sig").replace(";", " ")
    decimal = "." not in text and all(word.count(",") < 2 for word in text.split())
    rows: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split("#")[0].replace(",", "." if decimal else " ").split()
        if not words:
            continue
        try:
            rows.append([float(word.strip('"[]()')) for word in words])
        except ValueError as error:
            if rows:
                raise OptionError(f"{path}, line {number}: {line.strip()[:40]!r} is no number") from error
    if not rows:
        raise OptionError(f"{path} holds no numbers")
    widths = {len(row) for row in rows}
    if len(widths) > 1:
        raise OptionError(f"{path}: lines of {min(widths)} and of {max(widths)} numbers")
    return np.array(rows)


def _chosen(arrays: dict[str, Any], path: str, key: str, name: str, what: str = "array") -> Any:
    if not arrays:
        raise OptionError(f"{path} has no {what} of numbers for {name}")
    if key and key not in arrays:
        raise OptionError(f"{path} has no {what} {key}, but {', '.join(arrays)}")
    if not key and len(arrays) != 1 and name not in arrays:
        raise OptionError(f"{path} has {len(arrays)} {what}s: choose one, as in {path}:{next(iter(arrays))}")
    return arrays[key or (name if name in arrays else next(iter(arrays)))]


def _of_mesh(path: str, key: str, name: str) -> Floats:
    mesh = read(path)
    if not key and name not in (*SCALARS, "normals"):
        return mesh.vertices
    fields = dict(mesh.fields)
    if not key:
        width = 1 if name in SCALARS else 2
        fields = {k: v for k, v in fields.items() if v.ndim == width and v.dtype.kind == "f"}
    return np.asarray(_chosen(fields, path, key, name, "field"), dtype=np.float64)


def _numbers(array: npt.NDArray[Any], name: str) -> Floats:
    if array.dtype == object and array.ndim == 0:
        raise OptionError(f"{name} is a {type(array.item()).__name__}, not an array")
    if array.dtype.kind == "c" and np.abs(array.imag).max(initial=0.0) <= 1e-9 * np.abs(array).max(
        initial=0.0
    ):
        array = array.real
    if array.dtype.kind not in "fiub":
        raise OptionError(f"{name} must be real numbers, not {array.dtype}")
    return array.astype(np.float64)


def _plural(count: int, word: str) -> str:
    return f"{count} {word}" if count == 1 else f"{count} {word}s"


def _rows(source: Any, n: int, width: int, name: str) -> Floats:
    """A dense array, without a first column that numbers its n rows from 0 or 1."""
    values = loaded(source, name)
    if hasattr(values, "tocsr"):
        values = values.toarray()
    if values.shape == (n, width + 1) and n > 1:
        first = values[:, 0] - np.arange(n)
        if (first == first[0]).all() and first[0] in (0, 1):
            values = values[:, 1:]
    return np.asarray(values)


def scalars(source: Any, mesh: Mesh, name: str) -> Floats:
    """One number per vertex, (n,)."""
    n = mesh.n_vertices
    values = _rows(source, n, 1, name)
    if values.ndim == 2 and 1 in values.shape:
        values = values.reshape(-1)
    if values.shape == (n,):
        return np.asarray(values)
    raise OptionError(
        f"{name} {_shape_in_words(values.shape, mesh)}; one number per vertex is needed, ({n},)"
    )


def _shape_in_words(shape: tuple[int, ...], mesh: Mesh) -> str:
    n, m = mesh.n_vertices, mesh.n_faces
    text = f"has the shape {shape}"
    if len(shape) == 0:
        return "is a single number"
    if shape == (n, 3) or shape == (m, 3):
        of = "vertex" if shape[0] == n else "face"
        return f"{text}, a vector per {of}: take its length or its part along the normal"
    if shape == (n, n):
        return f"{text}, a matrix"
    if shape[0] == m:
        return f"{text}, one entry per face"
    if shape[0] == 3 * m:
        return f"{text}, one entry per corner of a face"
    if shape[0] == len(mesh.edges):
        return f"{text}, one entry per edge"
    if shape[0] == n - int(mesh.boundary_vertices.sum()):
        return f"{text}, one entry per inner vertex: the border is missing"
    if len(shape) == 2 and shape[1] == n:
        return f"{text}: transposed"
    if shape[0] == n:
        return f"{text}, {shape[1]} numbers per vertex"
    if shape[0] < n:
        return f"{text}, too few by {n - shape[0]}; were vertices merged?"
    return f"{text}, too many by {shape[0] - n}"


def vectors(source: Any, mesh: Mesh, name: str, width: int = 3) -> Floats:
    """One row per vertex, (n, width); a transposed array is turned."""
    n = mesh.n_vertices
    values = _rows(source, n, width, name)
    if values.shape == (width, n) and n != width:
        values = values.T
    if values.shape == (n * width,):
        values = values.reshape(n, width)
    if values.shape == (n, width):
        return np.asarray(values)
    words = _shape_in_words(values.shape, mesh)
    if values.shape == (mesh.n_faces, 3):
        words = f"has the shape {values.shape}, one row per face"
    raise OptionError(f"{name} {words}; {_plural(width, 'number')} per vertex are needed, ({n}, {width})")


def square(source: Any, mesh: Mesh, name: str) -> Any:
    """An (n, n) matrix as csr_matrix; triplets (row, column, value) of a text are assembled."""
    from scipy.sparse import csr_matrix

    values = loaded(source, name)
    n = mesh.n_vertices
    if values.shape == (n, n):
        return csr_matrix(values)
    if values.ndim == 2 and values.shape[1] == 3 and values.shape[0] > n and not hasattr(values, "tocsr"):
        rows, columns = (np.rint(values[:, k]).astype(np.int64) for k in (0, 1))
        first = 1 if min(rows.min(), columns.min()) == 1 and max(rows.max(), columns.max()) == n else 0
        if (values[:, :2] == np.rint(values[:, :2])).all() and max(rows.max(), columns.max()) < n + first:
            return csr_matrix((values[:, 2], (rows - first, columns - first)), shape=(n, n))
    words = _shape_in_words(values.shape, mesh)
    raise OptionError(f"{name} {words}; a matrix of ({n}, {n}) is needed")
