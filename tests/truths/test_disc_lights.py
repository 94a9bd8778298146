"""Disc-shaped lights: each point of the disc makes the point light's starburst, moved."""

import math

import numpy as np
import pytest

from aureole import Grid, Refusal, aperture, diffraction, glare, light

D = 1e-3
PIXEL = 2.15 * 529e-9 / D
HEPTAGON = aperture.iris(7, D, rotation=0.1)
LAMP = light.illuminant("D65")


def over_the_disc(shape, grid, radius, method, rings=5, spokes=20):
    """Average point lights over a disc: Gauss's rule in the squared radius, equal angles."""
    squares, weights = np.polynomial.legendre.leggauss(rings)
    total = 0.0
    for ring, (square, weight) in enumerate(zip(squares, weights, strict=True)):
        at = radius * math.sqrt((square + 1) / 2)
        for spoke in range(spokes):
            angle = 2 * math.pi * (spoke + ring / 2) / spokes
            y, x = grid.centre[0] - at * math.sin(angle), grid.centre[1] - at * math.cos(angle)
            moved = Grid(grid.shape, grid.spacing, (y, x))
            total = total + weight / 2 / spokes * diffraction.starburst(shape, moved, LAMP, method).pixels
    return total


@pytest.mark.parametrize(("radius", "rms"), [(0.3, 0.02), (1.0, 0.02), (3.0, 0.15)])
@pytest.mark.parametrize("centre", [(0, 0), (30, 12), (90, 20)])
def test_the_closed_form_is_the_mean_of_points(radius, rms, centre):
    grid = Grid((7, 8), (PIXEL, PIXEL), (centre[0] * PIXEL, centre[1] * PIXEL))
    wanted = over_the_disc(HEPTAGON, grid, radius * PIXEL, "coherence")
    found = diffraction.starburst(HEPTAGON, grid, LAMP, light_radius=radius * PIXEL).pixels
    error = 10 * np.log10(found / wanted)
    assert np.sqrt((error**2).mean()) < rms
    np.testing.assert_allclose(found.sum((0, 1)), wanted.sum((0, 1)), rtol=5e-3)


def test_a_small_disc_by_nodes_is_the_mean_of_points():
    grid = Grid((6, 7), (PIXEL, PIXEL), (3 * PIXEL, 0.0))
    shape = aperture.circle(D)
    wanted = over_the_disc(shape, grid, 0.4 * PIXEL, "scaled", rings=3, spokes=12)
    found = diffraction.starburst(shape, grid, LAMP, "scaled", light_radius=0.4 * PIXEL).pixels
    np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-3 * wanted.max())


@pytest.mark.parametrize("method", ["scaled", "coherence"])
@pytest.mark.parametrize("radius", [0.5, 6.0])
def test_size_keeps_energy(method, radius):
    grid = Grid((161, 160), (PIXEL, PIXEL))
    found = diffraction.starburst(HEPTAGON, grid, LAMP, method, light_radius=radius * PIXEL).pixels
    point = diffraction.starburst(HEPTAGON, grid, LAMP, method).pixels
    np.testing.assert_allclose(found.sum((0, 1)), point.sum((0, 1)), rtol=2e-3)
    assert found.min() >= 0


@pytest.mark.parametrize("method", ["scaled", "coherence"])
def test_a_mean_over_the_disc_is_nowhere_below_its_least(method):
    """Between the rays, nine decades below the disc itself, rounding must not show."""
    point, wide = Grid((181, 181), (PIXEL, PIXEL)), Grid((161, 161), (PIXEL, PIXEL))
    least = diffraction.starburst(HEPTAGON, point, LAMP, method).pixels.min()
    found = diffraction.starburst(HEPTAGON, wide, LAMP, method, light_radius=8 * PIXEL).pixels
    assert found.min() > 0.9 * least
    assert found.max() > 1e5 * found.min()


def test_a_wide_disc_is_seen_as_a_disc():
    # Nearly all light lies within the disc's own picture, evenly: 1 / (π r²) of it a pixel.
    radius = 12.0
    grid = Grid((41, 41), (PIXEL, PIXEL))
    y = diffraction.starburst(aperture.iris(7, 20 * D), grid, LAMP, light_radius=radius * PIXEL).pixels[
        ..., 1
    ]
    assert y[20, 20] == pytest.approx(1 / (math.pi * radius**2), rel=0.01)
    assert y[20, 20 + 8] == pytest.approx(y[20, 20], rel=0.01)
    assert y[20, 20 + 16] < 0.02 * y[20, 20]


def test_next_to_no_size_is_a_point():
    grid = Grid((65, 65), (PIXEL, PIXEL))
    small = diffraction.starburst(HEPTAGON, grid, LAMP, light_radius=1e-4 * PIXEL).pixels
    np.testing.assert_allclose(
        small, diffraction.starburst(HEPTAGON, grid, LAMP).pixels, rtol=2e-3, atol=1e-9
    )


def test_a_camera_takes_the_angle_across():
    camera = glare.camera(50e-3, 16, HEPTAGON, resolution=(40, 60))
    angle = 0.53 * math.pi / 180
    psf = glare.camera_psf(camera, (65, 65), LAMP, light_size=angle, border_fade=0.0)
    pitch = camera.pixel_pitch[0] / camera.focal_length
    wanted = diffraction.starburst(
        glare.pupil(camera), Grid((65, 65), (pitch, pitch)), LAMP, light_radius=math.sin(angle / 2)
    )
    assert psf.pixels[..., 1].sum() == pytest.approx(wanted.pixels[..., 1].sum(), rel=1e-3)


@pytest.mark.parametrize("radius", [-1e-3, 1.5, math.nan])
def test_sizes_out_of_range_are_refused(radius):
    with pytest.raises(Refusal, match="light_radius"):
        diffraction.starburst(HEPTAGON, Grid((5, 5), (PIXEL, PIXEL)), LAMP, light_radius=radius)


def test_points_of_a_disc_are_refused():
    with pytest.raises(Refusal, match="use sample 'area'"):
        diffraction.starburst(
            HEPTAGON, Grid((5, 5), (PIXEL, PIXEL)), LAMP, sample="point", light_radius=PIXEL
        )
