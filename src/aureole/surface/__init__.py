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
"""

from aureole.surface.albedo import albedo, albedo_bound, normalised
from aureole.surface.function import table_from_function, table_from_function_stages
from aureole.surface.integrate import METHODS, table_from_pattern, table_from_pattern_stages
from aureole.surface.pattern import DiffractionPattern, diffraction_pattern
from aureole.surface.pfm import read_pfm, write_pfm
from aureole.surface.table import MODELS, ScatterTable, lookup, rgb, scatter_table
from aureole.surface.table_files import read_table, sidecar_of, write_table

__all__ = [
    "METHODS",
    "MODELS",
    "DiffractionPattern",
    "ScatterTable",
    "albedo",
    "albedo_bound",
    "diffraction_pattern",
    "lookup",
    "normalised",
    "read_pfm",
    "read_table",
    "rgb",
    "scatter_table",
    "sidecar_of",
    "table_from_function",
    "table_from_function_stages",
    "table_from_pattern",
    "table_from_pattern_stages",
    "write_pfm",
    "write_table",
]
