"""The papers' tables and the peers, measured on this machine: what `aureole bench` prints.

In: a frozen record a bench. Out: `Stage`s, the last of which holds a `Report`: tables of plain rows with
what the source prints beside what is measured here, medians of runs taken in turn.

quad_paper        the quad paper's bench, and which of these belongs to it:
quad_counts         Table 1, the number of quads
symmetry            Table 2, symmetry and culling
spectral            Table 3, the spectral sum
quality             Figures 8 and 9, quadtree levels against brute force
progressive         Figure 10, a shadow that moves
stages              Figure 11, where the time of a frame goes
near_field        the bench of the near field, and which of these belongs to it:
near_table          the quad paper's Table 4
near_levels         its Figure 6, coarser quadtrees
near_peers          other libraries on the same plane
near_growth         one mask on finer and finer planes
near_colour         many wavelengths
peers             the bench of other libraries on the same far-field work:
zooms               far fields of masks, finer than the transform's own spacing
starbursts          a whole starburst in colour
peer_ways           which peers are installed, and their ways
peer_*              one file a library
tile_paper        the tile paper's bench, and which of these belongs to it:
tile_tables         its Tables 2 to 8 as printed, and their columns
tile_systems        its lenses, lights and grids of rays
tile_measures       one lens with one light or two
tile_whole          whole pictures against fine grids
area_light        many samples of a light behind occluders: few transforms for all, and one each
bloom             bloom and the full convolution: time, and how far apart what they add is
eye               the eye thesis's bench, and which of these belongs to it:
eye_frames          its Figures 4.1 and 4.2, and its memory
eye_patterns        patterns from scratch, their sum, and CIE 135
surface           the surface paper's bench, and which of these belongs to it:
surface_tables      its lookup table from a photograph, time and memory
surface_frames      frames a second
surface_environment light from all around, beside its prefilter
surface_measured    the measurement of a screen that is known
surface_orders      where orders stand
surface_mitsuba     the same disc by Mitsuba
flare_peers       other ray tracers on the ways of ghosts
lens_rays         rays through a lens as a peer takes them
optics            a far-field and a near-field problem as a peer takes them
convolved         the discrete near field by FFT, in a frame of zeros
fractional        the discrete fractional Fourier transform, and the near field by it
shapes            the quad paper's four apertures
timing            runs in turn, medians, the environment
report            tables and reports
"""

from aureole.bench.area_light import AreaLightBench, run_area_light
from aureole.bench.bloom import BloomBench, run_bloom
from aureole.bench.eye import EyeBench, run_eye
from aureole.bench.flare_peers import FlarePeersBench, run_flare_peers
from aureole.bench.near_field import NearFieldBench, run_near_field
from aureole.bench.peers import PeersBench, run_peers
from aureole.bench.quad_paper import QuadPaperBench, run_quad_paper
from aureole.bench.report import Column, Report, Table, plain
from aureole.bench.surface import SurfaceBench, run_surface
from aureole.bench.tile_paper import TilePaperBench, run_tile_paper

__all__ = [
    "AreaLightBench",
    "BloomBench",
    "Column",
    "EyeBench",
    "FlarePeersBench",
    "NearFieldBench",
    "PeersBench",
    "QuadPaperBench",
    "Report",
    "SurfaceBench",
    "Table",
    "TilePaperBench",
    "plain",
    "run_area_light",
    "run_bloom",
    "run_eye",
    "run_flare_peers",
    "run_near_field",
    "run_peers",
    "run_quad_paper",
    "run_surface",
    "run_tile_paper",
]
