"""Compiled loops of the near field of straight-edged outlines, lengths in units of √(λz / 2).

A place's field is its winding number less G(h, s₀) − G(h, s₁), summed over the edges; `corner` has G. An
edge's signed distance h is one number wherever its sign counts, so that a place on an edge jumps nowhere.
"""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from aureole.diffraction._kernels_corner import corner_amplitude, edge_wave
from aureole.diffraction._kernels_fresnel import FLAT, turned

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

# Places as near as this to a corner are moved this far from it, which changes the field by as little.
TOUCH = 1e-9


class Polygons(NamedTuple):
    """Rings of straight edges in units of √(λz / 2).

    vertices (V, 2) hold x, y; after and before (V,) the next vertex, to which each one's edge leads, and the
    last; directions (V, 2) that
    edge's unit vector; anchors (V,) the end from which its distance is told, the nearer one to the plane's
    middle; weights (V,) its ring's transmittance, signed by the ring's direction.
    """

    vertices: F64
    after: I64
    before: I64
    directions: F64
    anchors: I64
    weights: F64


class Tables(NamedTuple):
    """What `corner_amplitude` reads: `fresnel.taylor_table`, and both of `corner.corner_table`."""

    taylor: F64
    corner: F64
    orders: I64


@numba.njit(cache=True)
def side_of(h: float, along_x: float, along_y: float) -> bool:
    """Return whether h counts as positive: where it is 0, as from a place a little lower and farther right.

    Parameters
    ----------
    h : float
        Signed distance of an edge.
    along_x, along_y : float
        Its direction.
    """
    if h != 0:
        return h > 0
    return along_x > 0 or (along_x == 0 and along_y < 0)


@numba.njit(cache=True)
def field_at(x: float, y: float, shape: Polygons, scale: float, tables: Tables) -> complex:
    """Return the field at a place, in float64.

    Parameters
    ----------
    x, y : float
        The place.
    shape : Polygons
        As above.
    scale : float
        Of all these lengths.
    tables : Tables
        As above.
    """
    for k in range(len(shape.after)):
        if abs(shape.vertices[k, 0] - x) < TOUCH / scale and abs(shape.vertices[k, 1] - y) < TOUCH / scale:
            x = shape.vertices[k, 0] + TOUCH / scale
            break
    total = 0j
    for k in range(len(shape.after)):
        end = shape.after[k]
        along_x, along_y = shape.directions[k]
        anchor = shape.anchors[k]
        h = (shape.vertices[anchor, 0] - x) * along_y - (shape.vertices[anchor, 1] - y) * along_x
        positive = side_of(h, along_x, along_y)
        # Edges that cross the place's row to its right wind about it.
        low, high = shape.vertices[k, 1] <= y, shape.vertices[end, 1] <= y
        value = complex(1.0 if low and positive else -1.0) if low != high and low == positive else 0j
        h *= scale
        start = scale * (shape.vertices[k, 0] - x), scale * (shape.vertices[k, 1] - y)
        stop = scale * (shape.vertices[end, 0] - x), scale * (shape.vertices[end, 1] - y)
        first = _corner(start[0], start[1], along_x, along_y, h, tables)
        last = _corner(stop[0], stop[1], along_x, along_y, h, tables)
        value -= first - last if positive else last - first
        total += shape.weights[k] * value
    return total


@numba.njit(cache=True)
def _corner(x: float, y: float, along_x: float, along_y: float, h: float, tables: Tables) -> complex:
    """Return G(|h|, s) of an edge's end, which is at x, y as the place sees it."""
    s, size = x * along_x + y * along_y, abs(h)
    real, imag = corner_amplitude(size, abs(s), tables.taylor, tables.corner, tables.orders)
    cosine, sine = turned(0.25 * (x * x + y * y)) if size + abs(s) < FLAT else (1.0, 0.0)
    wave = complex(real * cosine - imag * sine, real * sine + imag * cosine)
    return edge_wave(size, tables.taylor) - wave if s < 0 else wave
