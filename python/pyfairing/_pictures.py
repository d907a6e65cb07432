"""Pictures and interactive pages of meshes: `Mesh.render`, `Mesh.show` and the view in notebooks."""

from __future__ import annotations

import base64
import html
import sys
import tempfile
import webbrowser
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _arrays, _core
from ._arrays import Bools, Bytes, Floats
from ._calls import Progress, call, warn
from ._docs import documented

if TYPE_CHECKING:
    from ._mesh import Mesh
    from ._names import ColorMap

#: A field as the extension takes it: values, and where they are undefined.
_Values: TypeAlias = "tuple[Floats, Bools | None]"

#: Height of a page in a notebook, in pixels.
_HEIGHT = 520


class View:
    """An interactive page of meshes, from `Mesh.show`.

    Attributes
    ----------
    html : str
        The page: one HTML file that requests nothing and opens from disk.
    """

    __slots__ = ("html",)

    html: str

    def __init__(self, html: str) -> None:
        self.html = html

    def __repr__(self) -> str:
        return f"View({len(self.html) / 1e6:.1f} MB of HTML)"

    def _repr_html_(self) -> str:
        """The page in a frame, isolated from the other cells of the notebook."""
        style = f"width:100%;height:{_HEIGHT}px;border:0"
        return f'<iframe title="meshes" style="{style}" srcdoc="{html.escape(self.html)}"></iframe>'


@documented
def render(
    self: Mesh,
    field: npt.ArrayLike | str | None = None,
    *,
    defined: npt.ArrayLike | None = None,
    map: ColorMap | None = None,
    range: tuple[float, float] | None = None,
    equalize: bool = False,
    view: str | tuple[float, float] = "three-quarter",
    up: Literal["y", "z"] = "y",
    size: tuple[int, int] = (800, 600),
    samples: int = 3,
    wireframe: bool = False,
    shading: Literal["creased", "smooth", "flat"] = "creased",
    transparent: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Bytes:
    """Draws the mesh, coloured by a field.

    Parameters
    ----------
    field : array_like, shape (n,) or (n, 3), or str, optional
        Values, or the name of a field; vectors are shown by their length. By default the
        colours of the mesh, if any.
    defined : array_like of bool, shape (n,), optional
        Vertices with a value; others, and NaN, are grey and do not affect the range. By default
        the field `defined` of the mesh for fields by name, and the mask of masked arrays.
    map : str, optional
        One of {maps}; `coolwarm` about zero for signed fields, else `viridis`.
    range : (float, float), optional
        The values at the two ends of the map; by default the 2nd and 98th percentile.
    equalize : bool
        Equalise the histogram: each colour covers the same number of vertices.
    view : str or (float, float)
        `three-quarter`, `behind`, `front`, `back`, `left`, `right`, `top`, `bottom`, or
        azimuth and elevation in degrees.
    up : {'y', 'z'}
        The axis that points up in the picture.
    size : (int, int)
        Width and height in pixels.
    samples : int
        Samples along each side of a pixel (1 to 8).
    wireframe : bool
        Draw the edges.
    shading : {'creased', 'smooth', 'flat'}
        Normals used for shading.
    transparent : bool
        Leave the background transparent instead of white.
    {run}

    Returns
    -------
    ndarray of uint8, shape (height, width, 4)
        Red, green, blue, alpha, as for `matplotlib.pyplot.imshow`.
    """
    values, undefined = (None, None) if field is None else _field_to_show(self, field, defined)
    colors = None if values is not None else self._fields.get("colors")
    coloring = {
        "map": map,
        "range": None if range is None else (float(range[0]), float(range[1])),
        "equalize": bool(equalize),
    }
    style = {
        "view": view if isinstance(view, str) else (float(view[0]), float(view[1])),
        "up": up,
        "size": (_arrays.whole(size[0], "width"), _arrays.whole(size[1], "height")),
        "samples": _arrays.whole(samples, "samples"),
        "wireframe": bool(wireframe),
        "shading": shading,
        "transparent": bool(transparent),
        "shadows": True,
    }
    image, _ = _core.render_mesh(
        self._core, values, undefined, colors, coloring, style, call(threads, progress)
    )
    return image


@documented
def show(
    self: Mesh,
    *others: Mesh,
    field: npt.ArrayLike | str | Sequence[npt.ArrayLike | None] | None = None,
    defined: npt.ArrayLike | None = None,
    titles: Sequence[str] | None = None,
    up: Literal["y", "z"] = "y",
    path: str | PathLike[str] | None = None,
) -> View:
    """Shows the mesh, and others beside it under the same camera, in a notebook or a browser.

    In a notebook the result, as the last expression of a cell, is the picture. Elsewhere the
    default browser opens a temporary file, which is not deleted, or `path` is written. The
    page needs neither a server nor an extension nor a connection, only WebGL 2.

    Parameters
    ----------
    *others : Mesh
        Meshes to show beside this one.
    field : array_like, shape (n,) or (n, 3), str, or a sequence of arrays, optional
        The values that colour the meshes at first: an array for every mesh, a sequence with an
        array or None for each mesh, or the name of a field. Vectors are shown by their
        length. The scalar fields of the meshes can be chosen in the page.
    defined : array_like of bool, shape (n,), optional
        Vertices with a value, if `field` is an array; others, and NaN, are grey. By default the
        field `defined` of the mesh for fields by name, and the mask of masked arrays.
    titles : sequence of str, optional
        The lines above the pictures.
    up : {'y', 'z'}
        The axis that points up.
    path : str or path, optional
        An HTML file to write instead of opening a browser.

    Returns
    -------
    View
        The page, as its attribute `html`. It has 24 bytes a face and 11 bytes a value of a
        field; positions are rounded to single precision. Vertex colours are not shown.

    Examples
    --------
    >>> import pyfairing as pf
    >>> mesh = pf.shapes.icosphere(3)
    >>> flat = mesh.noise(sigma=0.2, seed=1)
    >>> mesh.show(flat, titles=["before", "after"], path="view.html")  # doctest: +SKIP
    View(0.1 MB of HTML)
    """
    meshes = [self, *others]
    for mesh in others:
        if not isinstance(getattr(mesh, "_core", None), _core.Mesh):
            raise TypeError(f"show takes meshes, not {type(mesh).__name__}")
    if titles is None:
        titles = [f"mesh {i + 1}" for i in range(len(meshes))] if others else ["mesh"]
    if isinstance(titles, str) or len(titles) != len(meshes):
        raise _core.OptionError(f"titles has {len(titles)} of them, but there are {len(meshes)} meshes")
    name, shown = _shown(meshes, field, defined)
    given = []
    for mesh, title, own in zip(meshes, titles, shown, strict=True):
        fields = {n: _field_to_show(mesh, n, None) for n, v in mesh._fields.items() if v.ndim == 1}
        if own is not None and name is not None:
            # The given field replaces a field of the same name.
            fields = {name: own, **{n: f for n, f in fields.items() if n != name}}
        flat = [(n, values, undefined) for n, (values, undefined) in fields.items()]
        given.append((mesh._core, str(title), flat))
    view = View(_core.viewer_page(given, name, up, call()))
    if path is not None:
        Path(path).write_text(view.html, encoding="utf-8")
    elif not _in_notebook():
        _open(view)
    return view


def repr_html(self: Mesh) -> str:
    """A picture and a table, for notebooks."""
    info = self._core.diagnosis(call())
    positions = self._core.vertices
    extent = [f"{x:.6g}" for x in np.ptp(positions, axis=0)] if len(positions) else ["none"]
    rows = {
        "vertices": info["vertices"],
        "faces": info["faces"],
        "components": info["components"],
        "boundary loops": info["boundary_loops"],
        "genus": "undefined" if info["genus"] is None else info["genus"],
        "area": f"{info['area']:.6g}",
        "volume": "undefined" if info["volume"] is None else f"{info['volume']:.6g}",
        "extent": " × ".join(extent),
        "fields": ", ".join(self._fields) or "none",
    }
    cells = "".join(
        f"<tr><th style='text-align:left'>{name}</th><td>{html.escape(str(value))}</td></tr>"
        for name, value in rows.items()
    )
    table = f"<table>{cells}</table>"
    coloring = {"map": None, "range": None, "equalize": False}
    style = {
        "view": "three-quarter",
        "up": "y",
        "size": (480, 360),
        "samples": 2,
        "wireframe": False,
        "shading": "creased",
        "transparent": True,
        # Shadows of larger meshes take a second.
        "shadows": self._core.vertex_count < 50_000,
    }
    colors = self._fields.get("colors")
    try:
        image, _ = _core.render_mesh(self._core, None, None, colors, coloring, style, call())
    except _core.FairingError as error:
        return f"<div>{table}<p>{html.escape(str(error))}</p></div>"
    data = base64.b64encode(_core.png(image)).decode()
    picture = f"<img width='360' alt='{html.escape(repr(self))}' src='data:image/png;base64,{data}'>"
    return f"<div style='display:flex;align-items:center;gap:1em'>{picture}{table}</div>"


def _field_to_show(mesh: Mesh, field: npt.ArrayLike | str, defined: npt.ArrayLike | None) -> _Values:
    n = mesh._core.vertex_count
    undefined = None
    if defined is not None:
        mask = np.asarray(defined)
        if mask.dtype.kind != "b" or mask.shape != (n,):
            raise _core.OptionError(
                f"defined is {mask.dtype} of shape {mask.shape}, but must be bool of ({n},)"
            )
        undefined = np.ascontiguousarray(~mask)
    if isinstance(field, str):
        if field not in mesh._fields:
            known = ", ".join(mesh._fields) or "none"
            raise _core.OptionError(f"there is no field {field}; the mesh has {known}")
        if undefined is None and "defined" in mesh._fields and field not in ("defined", "boundary"):
            undefined = np.asarray(mesh._fields["defined"] == 0)
        field = mesh._fields[field]
    if undefined is None and isinstance(field, np.ma.MaskedArray):
        hidden = np.ma.getmaskarray(field).reshape(len(field), -1).any(axis=1)
        field, undefined = field.filled(0.0), np.asarray(hidden)
    values = _arrays.floats(field, "field")
    if values.shape == (n, 3):
        values = np.linalg.norm(values, axis=1)
    if values.shape != (n,):
        raise _core.OptionError(f"field has the shape {values.shape}, but must have ({n},) or ({n}, 3)")
    missing = np.isnan(values) if undefined is None else np.isnan(values) | undefined
    if undefined is not None or missing.any():
        values, undefined = np.where(missing, 0.0, values), missing
    return np.ascontiguousarray(values), undefined


def _shown(
    meshes: list[Mesh],
    field: npt.ArrayLike | str | Sequence[npt.ArrayLike | None] | None,
    defined: npt.ArrayLike | None,
) -> tuple[str | None, list[_Values | None]]:
    """The name of the field that colours the meshes, and its values on each of them."""
    if field is None:
        return None, [None] * len(meshes)
    if isinstance(field, str):
        if not any(field in mesh._fields for mesh in meshes):
            known = ", ".join(dict.fromkeys(n for mesh in meshes for n in mesh._fields)) or "none"
            raise _core.OptionError(f"there is no field {field}; the meshes have {known}")
        return field, [
            _field_to_show(mesh, field, defined) if field in mesh._fields else None for mesh in meshes
        ]
    each: list[Any] = [field] * len(meshes)
    if isinstance(field, (list, tuple)) and any(values is None or np.ndim(values) for values in field):
        if len(field) != len(meshes):
            raise _core.OptionError(f"field has {len(field)} arrays, but there are {len(meshes)} meshes")
        each = list(field)
    return "field", [
        None if values is None else _field_to_show(mesh, values, defined)
        for mesh, values in zip(meshes, each, strict=True)
    ]


def _in_notebook() -> bool:
    """True in a kernel of Jupyter, whose front end shows HTML."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return hasattr(shell, "kernel")


def _open(view: View) -> None:
    with tempfile.NamedTemporaryFile(
        "w", prefix="pyfairing-", suffix=".html", delete=False, encoding="utf-8"
    ) as file:
        file.write(view.html)
    if not webbrowser.open(Path(file.name).as_uri()):
        warn(f"there is no browser to open; the page is {file.name}")
