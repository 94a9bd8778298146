"""Real rays through every shipped lens, beside what another ray tracer of ours found for the same numbers.

The figures were made once, before this tracer was written, by skew rays in double precision with Cauchy's
dispersion; lengths are per mille or per cent of the focal length. A lens whose signs, order, indices or Abbe
numbers are wrong has other ones.
"""

from functools import cache

import numpy as np
import pytest

from aureole import flare, presets
from aureole.flare import glass, paraxial, rays

load = cache(flare.load)
# Axial colour and change of the focal length from C to F in per cent; root mean square spot in per mille, on
# the axis at f/8 and at half the field wide open; distortion there in per cent; f-number from the traced
# pupil's area; how much of the pupil is left at half the field.
FIGURES = {
    "angenieux_double_gauss_100mm": (-0.281, -0.092, 0.004, 0.600, -0.28, 1.19, 0.84),
    "canon_tele_zoom_135mm": (-0.069, -0.111, 0.004, 0.124, 0.23, 2.80, 1.01),
    "canon_tele_zoom_200mm": (-0.022, 0.016, 0.001, 0.043, 0.45, 2.79, 0.85),
    "canon_tele_zoom_70mm": (-0.214, -0.253, 0.028, 0.243, -0.77, 2.75, 0.99),
    "cooke_triplet_100mm": (-0.249, -0.281, 0.089, 0.183, -0.03, 7.95, 0.76),
    "heliar_tronnier_100mm": (-0.157, -0.162, 0.102, 0.509, -0.01, 3.48, 0.92),
    "itoh_wide_zoom_100mm": (-0.776, -0.479, 0.045, 3.404, -2.07, 3.50, 1.09),
    "itoh_wide_zoom_123mm_seed": (-0.513, -0.338, 0.004, 2.367, -1.12, 3.73, 1.04),
    "itoh_wide_zoom_123mm_solved": (-0.457, -0.305, 0.010, 2.230, -0.98, 3.80, 1.04),
    "itoh_wide_zoom_146mm": (-0.194, -0.134, 0.097, 1.591, -0.57, 4.08, 1.00),
    "kodak_symmetric_100mm": (0.520, 0.075, 0.080, 3.619, 2.35, 3.68, 0.73),
    "leica_summicron_r_50mm": (-0.254, -0.192, 0.017, 0.258, -0.28, 2.08, 0.76),
    "leica_summilux_35mm": (-0.164, -0.236, 0.204, 40.624, 2.35, 1.45, 0.80),
    "nikkor_50mm_f1_2": (-0.174, -0.221, 0.007, 1.017, -0.82, 1.37, 0.86),
    "nikon_28_70mm_28mm": (-0.661, -0.324, 0.243, 9.433, -3.61, 2.93, 0.78),
    "nikon_tele_zoom_140mm_seed": (-0.252, -0.244, 0.028, 0.201, 0.07, 3.05, 0.87),
    "nikon_tele_zoom_140mm_solved": (-0.223, -0.109, 0.017, 0.162, 0.27, 2.79, 0.87),
    "nikon_tele_zoom_200mm": (-0.168, -0.089, 0.009, 0.066, 0.45, 2.79, 0.83),
    "nikon_tele_zoom_80mm": (-0.403, -0.413, 0.036, 0.251, -0.75, 2.80, 0.80),
    "rudolph_planar_50mm": (-1.661, -1.647, 0.285, 1.539, -0.03, 4.66, 0.74),
    "tronnier_double_gauss_100mm": (-0.132, -0.113, 0.013, 0.700, -0.37, 2.02, 0.66),
    "zeiss_biotar_50mm": (-0.289, -0.365, 0.010, 0.927, -0.73, 1.53, 0.85),
    "zeiss_master_prime_50mm": (-0.161, -0.076, 0.057, 7.891, 0.38, 1.39, 0.81),
    "zeiss_sonnar_50mm": (-0.197, -0.015, 0.023, 0.967, 1.19, 1.68, 0.89),
}


def traced(lens, box, slope=0.0, count=61):
    """Return rays through a box (x0, x1, y0, y1) of the first surface's plane, where, and each one's area."""
    across, down = (low + (high - low) * (np.arange(count) + 0.5) / count for low, high in (box[:2], box[2:]))
    points = np.stack(np.meshgrid(across, down), axis=-1).reshape(-1, 2)
    directions = np.tile([0.0, slope, 1.0], (len(points), 1))
    origins = np.column_stack([points, np.zeros(len(points))]) - 0.05 * directions
    area = (box[1] - box[0]) * (box[3] - box[2]) / count**2
    return rays.trace_reference(lens, (), origins, directions), points, area


@cache
def pupil(lens, slope=0.0):
    """Return the rays that pass, traced a second time in the box that holds them."""
    wide = lens.surfaces[0].semi_aperture
    found, points, _ = traced(lens, (-wide, wide, -wide, wide), slope, 31)
    inside = points[found.passed]
    (x0, y0), (x1, y1), margin = inside.min(axis=0), inside.max(axis=0), 2 * wide / 31
    return traced(lens, (x0 - margin, x1 + margin, y0 - margin, y1 + margin), slope)


def spot(positions):
    """Return the root mean square distance from the middle, metres."""
    return np.sqrt(np.mean(np.sum((positions - positions.mean(axis=0)) ** 2, axis=1)))


def half_field(lens):
    """Return the slope of light that an ideal lens brings to half of the way to the picture's corner."""
    return 0.25 * np.hypot(*lens.sensor) / paraxial.focal_length(lens)


def test_all_but_the_cylinders_are_listed():
    assert set(presets.names("lenses")) - set(FIGURES) == {"schneider_anamorphic_31mm"}


@pytest.mark.parametrize("name", FIGURES)
def test_colour_near_the_axis(name):
    lens, (axial, lateral, *_) = load(name), FIGURES[name]
    assert 100 * paraxial.axial_colour(lens) == pytest.approx(axial, abs=0.001)
    blue, red = (paraxial.focal_length(lens, wavelength=line) for line in (glass.F_LINE, glass.C_LINE))
    assert 100 * (blue - red) / paraxial.focal_length(lens) == pytest.approx(lateral, abs=0.001)


@pytest.mark.parametrize("name", FIGURES)
def test_rays_on_the_axis(name):
    lens, (_, _, sharp, _, _, f_number, _) = load(name), FIGURES[name]
    length = paraxial.focal_length(lens)
    radius = min(length / 16, paraxial.entrance_radius(lens)[0])
    found, points, _ = traced(lens, (-radius, radius, -radius, radius))
    at_8 = found.passed & (np.hypot(*points.T) <= radius)
    assert 1e3 * spot(found.positions[at_8, :2]) / length == pytest.approx(sharp, rel=0.05, abs=0.0007)
    wide, _, area = pupil(lens)
    diameter = 2 * np.sqrt(wide.passed.sum() * area / np.pi)
    assert length / diameter == pytest.approx(f_number, rel=0.007)


@pytest.mark.parametrize("name", FIGURES)
def test_rays_at_half_the_field(name):
    lens, (*_, blurred, distortion, _, left) = load(name), FIGURES[name]
    length, slope = paraxial.focal_length(lens), half_field(lens)
    found, _, area = pupil(lens, slope)
    on_axis, _, area_on_axis = pupil(lens)
    part = found.passed.sum() * area / (on_axis.passed.sum() * area_on_axis)
    assert part == pytest.approx(left, abs=0.02)
    positions = found.positions[found.passed, :2]
    assert 1e3 * spot(positions) / length == pytest.approx(blurred, rel=0.03)
    # Of the middle of the spot.
    assert 100 * (positions[:, 1].mean() / (length * slope) - 1) == pytest.approx(distortion, abs=0.08)
