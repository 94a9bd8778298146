"""Diffractive surfaces: from a photograph, a grating or a height field to a table, and from it to pictures.

In comes a `DiffractionPattern` at one wavelength (or several, or a formula); out goes a `ScatterTable` over
h = ω_i + ω_o for a whole light, which the renderers read. f_r = diffuse + specular + 4π² F² G S_d(h), with
G = 1 at normal incidence (Stam's own G is 4 there).

- `pattern.py`: a pattern at one wavelength, 1/sr over h.
- `table.py`: the table, its warped axes, look-up at any h, RGB.
- `integrate.py`: from patterns to a table, all wavelengths of a light; METHODS.
- `function.py`: from a formula to a table, sharp orders averaged over cells.
- `albedo.py`: how much light a table sends back, and tables that send back no more than came.
- `pfm.py`: portable float maps.
- `table_files.py`: tables as EXR, PFM and NPZ with a JSON sidecar.
- `geometry.py`: from a photograph's pixels to h, by where camera and lamp stand.
- `hdr_merge.py`: black level, and one linear photograph from a bracket.
- `centre.py`: the zero order's place in a photograph, to a fraction of a pixel.
- `bandwidth.py`: what a filter's width and the lens's blur do to a pattern, and undoing it.
- `zero_order.py`: the zero order told apart from the rest of a pattern.
- `measure.py`: from photographs to a pattern, and to a table.
- `virtual.py`: photographs that a camera would take of a surface whose diffraction is known.
"""

from aureole.surface.albedo import albedo, albedo_bound, normalised
from aureole.surface.bandwidth import sharpen, smeared
from aureole.surface.centre import Centre, find_centre
from aureole.surface.function import table_from_function, table_from_function_stages
from aureole.surface.geometry import BenchGeometry, UniformGeometry
from aureole.surface.hdr_merge import Merged, estimate_black, merge
from aureole.surface.integrate import METHODS, table_from_pattern, table_from_pattern_stages
from aureole.surface.measure import measure_pattern, table_from_photo
from aureole.surface.pattern import DiffractionPattern, diffraction_pattern, on_grid
from aureole.surface.pfm import read_pfm, write_pfm
from aureole.surface.table import MODELS, ScatterTable, lookup, rgb, scatter_table
from aureole.surface.table_files import read_table, sidecar_of, write_table
from aureole.surface.virtual import VirtualCamera, lcd_screen, photograph
from aureole.surface.zero_order import ZeroOrder, split_zero_order

__all__ = [
    "METHODS",
    "MODELS",
    "BenchGeometry",
    "Centre",
    "DiffractionPattern",
    "Merged",
    "ScatterTable",
    "UniformGeometry",
    "VirtualCamera",
    "ZeroOrder",
    "albedo",
    "albedo_bound",
    "diffraction_pattern",
    "estimate_black",
    "find_centre",
    "lcd_screen",
    "lookup",
    "measure_pattern",
    "merge",
    "normalised",
    "on_grid",
    "photograph",
    "read_pfm",
    "read_table",
    "rgb",
    "scatter_table",
    "sharpen",
    "sidecar_of",
    "smeared",
    "split_zero_order",
    "table_from_function",
    "table_from_function_stages",
    "table_from_pattern",
    "table_from_pattern_stages",
    "table_from_photo",
    "write_pfm",
    "write_table",
]
