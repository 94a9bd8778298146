"""Diffractive surfaces: from a photograph, a grating or a height field to a table, and from it to pictures.

In comes a `DiffractionPattern` at one wavelength (or several, or a formula); out goes a `ScatterTable` over
h = ω_i + ω_o for a whole light, which the renderers read. f_r = diffuse + specular + 4π² F² G S_d(h), with
G = 1 at normal incidence (Stam's own G is 4 there).

The table:
- `pattern.py`: a pattern at one wavelength, 1/sr over h.
- `table.py`: the table, its warped axes, look-up at any h, RGB.
- `integrate.py`: from patterns to a table, all wavelengths of a light; METHODS.
- `cell_means.py`: means of a pattern over a table's cells.
- `function.py`: from a formula to a table, sharp orders averaged over cells.
- `albedo.py`: how much light a table sends back, and tables that send back no more than came.
- `report.py`: a table in numbers.
- `resampling.py`: a table on even steps of h, and back.
- `pfm.py`: portable float maps.
- `table_files.py`: tables as EXR, PFM and NPZ with a JSON sidecar.

Measured:
- `geometry.py`: from a photograph's pixels to h, by where camera and lamp stand.
- `photographs.py`: photographs from files, with the exposures that they say.
- `response.py`: a camera's response from a bracket, where files are not linear in light.
- `hdr_merge.py`: black level, and one linear photograph from a bracket.
- `centre.py`: the zero order's place in a photograph, to a fraction of a pixel.
- `bandwidth.py`: what a filter's width and the lens's blur do to a pattern, and undoing it.
- `period.py`: a grating's period from its orders, and what they say against a measurement.
- `zero_order.py`: the zero order told apart from the rest of a pattern.
- `measure.py`: from photographs to a pattern.
- `colour_photos.py`: a pattern for each channel of a colour photograph.
- `photo_tables.py`: from photographs, or several measured patterns, to a table.
- `virtual.py`: photographs that a camera would take of a surface whose diffraction is known.
- `bokeh.py`: steps from a photograph of an out-of-focus highlight to heights, and how far a lens sees.
- `bokeh_photo.py`: all of them: `Bokeh`, its heights, lines and the number of lit slits.

From formulas and heights:
- `slits.py`: lines in one direction: slits, grooves, blazed facets; exact means over intervals of h.
- `gratings.py`: `Grating` from lines: discs, displays, blazed, crossed, radial; where orders go.
- `grating_tables.py`: from a grating to a table.
- `height.py`: what a height field sends where, at one wavelength; how wrong a series is.
- `order_sums.py`: lobes of a field's orders added up over all wavelengths.
- `height_tables.py`: from a height field to a table.
- `taylor_tables.py`: from a height field to Dhillon's tables of a Taylor series, one for each power of w.

Drawn:
- `views.py`: where a picture is taken from.
- `shapes.py`: plane, disc, cylinder, mesh; in: a shape and a view, out: `Seen`, a frame for each sample.
- `meshes.py`: in: an OBJ or PLY file, or arrays, out: a `Mesh` with a tangent at each corner.
- `lamps.py`: near and distant lamps, areas.
- `material.py`: diffuse and mirror-like parts, Fresnel's factor, the window over a table.
- `rasters.py`: the triangles of a mesh that a view sees.
- `shading.py`: tables, material and maps made ready once: `Shader`, `shade`.
- `shadows.py`: which samples a lamp reaches.
- `around.py`: light from all around in a picture.
- `scene.py`: `render`: lamps, view, material, table and shape in, a `Picture` out.
- `focus.py`: depth of field: views through a lens's points, or a picture's layers blurred by their depths.
- `environment.py`: light from all around on a flat sample, towards all views by one correlation.
- `close_reflection.py`: the same towards a camera's part of the views, sharp orders resolved.
- `quadrature.py`: the same by the full integral over all directions: the reference.
- `prefilter.py`: the same by the surface paper's reflection map, for comparison.
- `surroundings.py`: light from all around on samples of any shape; blurred copies of the light.
- `table_cells.py`: a table cut into small lobes, for that.
- `rooms.py`: a room with lamps and windows, made by code.
- `complex_lights.py`: a lamp's shape from its mirror image, and the table of the whole lamp.
- `_kernels*.py`: the heavy loops.

Elsewhere:
- `export_web.py`: a table as one HTML page (WebGL 2), as a GLSL function.
- `export_gltf.py`: a table as extras of a glTF material.
- `mitsuba.py`: a table, or patterns by wavelength, as a BSDF of Mitsuba 3, where that is installed.
- `mitsuba_lobes.py`: what that BSDF does to light.
- `mitsuba_scenes.py`: a `Scene` as a scene of Mitsuba, or as its file.
"""

from aureole.surface.albedo import albedo, albedo_bound, normalised
from aureole.surface.bandwidth import band_of, sharpen, smeared
from aureole.surface.bokeh import (
    abbe_limit,
    abbe_note,
    bokeh_profile,
    count_lines,
    fit_heights,
    pixel_pitch,
    richardson_lucy,
)
from aureole.surface.bokeh_photo import Bokeh, heights_from_bokeh, heights_from_bokeh_stages
from aureole.surface.centre import Centre, find_centre
from aureole.surface.close_reflection import CloseLight, CloseReflection
from aureole.surface.colour_photos import assumed_sensitivities, measure_channels, measure_channels_stages
from aureole.surface.complex_lights import LampShape, convolved, lamp_from_reflection
from aureole.surface.environment import (
    Environment,
    EnvironmentReflection,
    HemisphereMap,
    ReflectedLight,
    environment_from_picture,
    frame_of,
    hemisphere,
    reflect,
    rotated,
)
from aureole.surface.export_gltf import gltf_extras, write_gltf
from aureole.surface.export_web import WebView, web_view, write_glsl, write_page
from aureole.surface.focus import ThinLens, circle_of_confusion, defocus, lens_views
from aureole.surface.function import table_from_function, table_from_function_stages
from aureole.surface.geometry import BenchGeometry, UniformGeometry
from aureole.surface.grating_tables import table_from_grating, table_from_grating_stages
from aureole.surface.gratings import (
    Grating,
    blazed_grating,
    crossed_grating,
    display_grating,
    grating,
    groove_grating,
    littrow_angle,
    multislit_grating,
    orders,
    radial_grating,
)
from aureole.surface.hdr_merge import Merged, estimate_black, merge
from aureole.surface.height import HeightField, height_field, taylor_error, taylor_order
from aureole.surface.height_tables import (
    height_pattern,
    series_tables,
    table_from_height,
    table_from_height_stages,
)
from aureole.surface.integrate import METHODS, table_from_pattern, table_from_pattern_stages
from aureole.surface.lamps import Lamp, area_lamp, distant_lamp, point_lamp
from aureole.surface.material import Material, conductor, material_of, schlick
from aureole.surface.measure import Processing, measure_pattern, measure_pattern_stages
from aureole.surface.meshes import mesh_of, read_mesh
from aureole.surface.mitsuba_scenes import mitsuba_scene, write_mitsuba
from aureole.surface.pattern import DiffractionPattern, diffraction_pattern, on_grid
from aureole.surface.period import OrderRow, order_notes, period_of
from aureole.surface.pfm import read_pfm, write_pfm
from aureole.surface.photo_tables import (
    table_from_measured,
    table_from_measured_stages,
    table_from_photo,
    table_from_photo_stages,
)
from aureole.surface.photographs import Photographs, exposure_said, read_photographs
from aureole.surface.prefilter import prefiltered
from aureole.surface.quadrature import Quadrature, quadrature
from aureole.surface.report import describe
from aureole.surface.response import Response, camera_response
from aureole.surface.rooms import lamps_and_windows
from aureole.surface.scene import Scene, render, render_stages
from aureole.surface.shading import Shader, shade, shader
from aureole.surface.shapes import Cylinder, Disc, Mesh, Plane, Pose, Seen, pose_of, see
from aureole.surface.slits import Lines, multislit
from aureole.surface.surroundings import (
    Surroundings,
    environment_light,
    irradiance,
    mirror_light,
    surroundings,
)
from aureole.surface.table import MODELS, ScatterTable, lookup, rgb, scatter_table
from aureole.surface.table_cells import table_cells
from aureole.surface.table_files import read_table, sidecar_of, write_table
from aureole.surface.taylor_tables import TaylorTables, taylor_tables, taylor_tables_stages
from aureole.surface.views import View, view_from
from aureole.surface.virtual import VirtualCamera, gaussian_filter_spectrum, lcd_screen, photograph
from aureole.surface.zero_order import ZeroOrder, split_zero_order

__all__ = [
    "METHODS",
    "MODELS",
    "BenchGeometry",
    "Bokeh",
    "Centre",
    "CloseLight",
    "CloseReflection",
    "Cylinder",
    "DiffractionPattern",
    "Disc",
    "Environment",
    "EnvironmentReflection",
    "Grating",
    "HeightField",
    "HemisphereMap",
    "Lamp",
    "LampShape",
    "Lines",
    "Material",
    "Merged",
    "Mesh",
    "OrderRow",
    "Photographs",
    "Plane",
    "Pose",
    "Processing",
    "Quadrature",
    "ReflectedLight",
    "Response",
    "ScatterTable",
    "Scene",
    "Seen",
    "Shader",
    "Surroundings",
    "TaylorTables",
    "ThinLens",
    "UniformGeometry",
    "View",
    "VirtualCamera",
    "WebView",
    "ZeroOrder",
    "abbe_limit",
    "abbe_note",
    "albedo",
    "albedo_bound",
    "area_lamp",
    "assumed_sensitivities",
    "band_of",
    "blazed_grating",
    "bokeh_profile",
    "camera_response",
    "circle_of_confusion",
    "conductor",
    "convolved",
    "count_lines",
    "crossed_grating",
    "defocus",
    "describe",
    "diffraction_pattern",
    "display_grating",
    "distant_lamp",
    "environment_from_picture",
    "environment_light",
    "estimate_black",
    "exposure_said",
    "find_centre",
    "fit_heights",
    "frame_of",
    "gaussian_filter_spectrum",
    "gltf_extras",
    "grating",
    "groove_grating",
    "height_field",
    "height_pattern",
    "heights_from_bokeh",
    "heights_from_bokeh_stages",
    "hemisphere",
    "irradiance",
    "lamp_from_reflection",
    "lamps_and_windows",
    "lcd_screen",
    "lens_views",
    "littrow_angle",
    "lookup",
    "material_of",
    "measure_channels",
    "measure_channels_stages",
    "measure_pattern",
    "measure_pattern_stages",
    "merge",
    "mesh_of",
    "mirror_light",
    "mitsuba_scene",
    "multislit",
    "multislit_grating",
    "normalised",
    "on_grid",
    "order_notes",
    "orders",
    "period_of",
    "photograph",
    "pixel_pitch",
    "point_lamp",
    "pose_of",
    "prefiltered",
    "quadrature",
    "radial_grating",
    "read_mesh",
    "read_pfm",
    "read_photographs",
    "read_table",
    "reflect",
    "render",
    "render_stages",
    "rgb",
    "richardson_lucy",
    "rotated",
    "scatter_table",
    "schlick",
    "see",
    "series_tables",
    "shade",
    "shader",
    "sharpen",
    "sidecar_of",
    "smeared",
    "split_zero_order",
    "surroundings",
    "table_cells",
    "table_from_function",
    "table_from_function_stages",
    "table_from_grating",
    "table_from_grating_stages",
    "table_from_height",
    "table_from_height_stages",
    "table_from_measured",
    "table_from_measured_stages",
    "table_from_pattern",
    "table_from_pattern_stages",
    "table_from_photo",
    "table_from_photo_stages",
    "taylor_error",
    "taylor_order",
    "taylor_tables",
    "taylor_tables_stages",
    "view_from",
    "web_view",
    "write_glsl",
    "write_gltf",
    "write_mitsuba",
    "write_page",
    "write_pfm",
    "write_table",
]
