"""The closed-form sum over wavelengths against every wavelength transformed by itself."""

import importlib

import numpy as np
import pytest

from aureole import Grid, Refusal, aperture, diffraction, light

starburst = importlib.import_module("aureole.diffraction.starburst")
D = 50e-3 / 16
PITCH = 18.75e-6 / 50e-3
HEPTAGON = aperture.iris(7, D, rotation=0.1)
SHAPES = [
    HEPTAGON,
    aperture.rectangle(D, 0.6 * D),
    aperture.iris(3, D),
    aperture.subtraction(aperture.iris(6, D), aperture.iris(5, 0.4 * D, rotation=0.3)),
]


def decibels(found, truth):
    return 10 * np.log10(np.maximum(found, 1e-20) / np.maximum(truth, 1e-20))


@pytest.fixture(autouse=True)
def _many_wavelengths(monkeypatch):
    # Far out, fringes shift by cycles from one wavelength to the next: the truth needs many.
    monkeypatch.setattr(starburst, "EXACT_WAVELENGTHS", 401)


def sliver(share):
    """What a bar leaves of the heptagon, as a shape of its own and as the heptagon with less light behind."""
    cover = aperture.polygon([[share * D, -D], [2 * D, -D], [2 * D, D], [share * D, D]])
    return aperture.subtraction(HEPTAGON, cover), cover


@pytest.mark.parametrize("share", [-0.43, 0.1])
def test_what_a_bar_leaves_has_the_streaks_of_its_own_edges_alone(share):
    shape, _ = sliver(share)
    grid = Grid((5, 7), (2 * PITCH, 2 * PITCH), (40 * PITCH, 0.0))
    lamp = light.illuminant("D65")
    truth = diffraction.starburst(shape, grid, lamp, "exact").pixels
    found = diffraction.starburst(shape, grid, lamp).pixels
    np.testing.assert_allclose(found.sum((0, 1)), truth.sum((0, 1)), rtol=0.01)
    np.testing.assert_allclose(found, truth, atol=0.02 * truth.max())


def test_edges_that_cancel_are_refused_and_another_method_serves():
    _, cover = sliver(-0.3)
    grey = aperture.subtraction(HEPTAGON, aperture.dimmed(cover, 0.5))
    lamp = light.illuminant("D65")
    assert diffraction.coherence.serves(HEPTAGON, lamp)
    assert not diffraction.coherence.serves(grey, lamp)
    grid = Grid((8, 8), (PITCH, PITCH), (40 * PITCH, 0.0))
    with pytest.raises(Refusal, match="none of them twice in one place"):
        diffraction.starburst(grey, grid, lamp, "coherence")
    truth = diffraction.starburst(grey, grid, lamp, "scaled").pixels
    np.testing.assert_array_equal(diffraction.starburst(grey, grid, lamp).pixels, truth)


@pytest.mark.parametrize("sample", ["point", "area"])
@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.name[:20])
def test_a_patch_away_from_the_core_is_right_to_a_fiftieth_of_a_decibel(shape, sample):
    pitch = PITCH if sample == "area" else PITCH / 3
    grid = Grid((9, 12), (pitch, pitch), (62 * pitch, 5 * pitch))
    lamp = light.illuminant("D65")
    truth = diffraction.starburst(shape, grid, lamp, "exact", sample).pixels
    found = diffraction.starburst(shape, grid, lamp, "coherence", sample).pixels
    error = decibels(found, truth)
    assert np.sqrt((error**2).mean()) < 0.02
    assert np.abs(error).max() < 0.2
    np.testing.assert_allclose(found.sum((0, 1)), truth.sum((0, 1)), rtol=1e-3)


@pytest.mark.parametrize(("angle", "width"), [(0.0, 9), (np.pi / 2, 9)])
def test_across_a_streak_along_an_axis(angle, width):
    # The streak of an edge lies on the axis, where x = q·e passes through zero.
    shape = aperture.iris(6, D, rotation=np.pi / 6 + angle)
    shape_grid = [(PITCH * 0, 70 * PITCH), (70 * PITCH, PITCH * 0)][int(angle > 0)]
    grid = Grid((width, width), (PITCH, PITCH), shape_grid)
    lamp = light.illuminant("E")
    truth = diffraction.starburst(shape, grid, lamp, "exact").pixels
    found = diffraction.starburst(shape, grid, lamp, "coherence").pixels
    assert np.abs(decibels(found, truth)).max() < 0.05


@pytest.mark.parametrize("shape", [(64, 64), (65, 64), (64, 65), (65, 65)])
def test_half_a_plane_mirrored_is_the_whole(shape):
    lamp = light.illuminant("E")
    whole = diffraction.starburst(HEPTAGON, Grid(shape, (PITCH, PITCH)), lamp, "coherence").pixels
    # A centre that is off by next to nothing takes the way without symmetry.
    moved = Grid(shape, (PITCH, PITCH), (1e-9 * PITCH, 0.0))
    np.testing.assert_allclose(
        whole, diffraction.starburst(HEPTAGON, moved, lamp, "coherence").pixels, rtol=2e-3, atol=1e-9
    )


def test_a_whole_starburst_reaches_eighty_decibels():
    # log-PSNR over ten decades, as methods are compared throughout.
    grid = Grid((45, 45), (PITCH, PITCH))
    lamp = light.illuminant("D65")
    truth = diffraction.starburst(HEPTAGON, grid, lamp, "exact").pixels
    found = diffraction.starburst(HEPTAGON, grid, lamp).pixels
    peak = truth[..., 1].max()
    error = np.log10(np.maximum(found / peak, 1e-10)) - np.log10(np.maximum(truth / peak, 1e-10))
    assert np.all(20 * np.log10(10 / np.sqrt((error**2).mean(axis=(0, 1)))) > 80)


def test_dimming_divides_out():
    # Energy fractions do not depend on how much light passes.
    grid = Grid((33, 33), (PITCH, PITCH))
    lamp = light.illuminant("E")
    full = diffraction.starburst(HEPTAGON, grid, lamp, "coherence").pixels
    dim = diffraction.starburst(aperture.dimmed(HEPTAGON, 0.5), grid, lamp, "coherence").pixels
    np.testing.assert_allclose(dim, full, rtol=1e-4)


@pytest.mark.parametrize(
    ("shape", "lamp"),
    [
        (aperture.circle(D), light.illuminant("E")),
        (aperture.iris(7, D, 0.5), light.illuminant("E")),
        (aperture.whirl(D), light.illuminant("E")),
        (HEPTAGON, light.line(550e-9)),
        (aperture.from_mask(np.ones((4, 4)), D), light.illuminant("E")),
    ],
)
def test_what_it_cannot_sum_is_refused_with_the_method_that_can(shape, lamp):
    with pytest.raises(Refusal, match="use method 'scaled'"):
        diffraction.starburst(shape, Grid((9, 9), (PITCH, PITCH)), lamp, "coherence")


@pytest.mark.parametrize("size", [1263, 1265])
def test_the_axis_is_the_cores_even_where_it_is_off_by_rounding(size):
    # 1 / |q|⁴ is huge beside the axis; nothing of it may reach the pixel there.
    pitch = 36e-3 / 1262 / 50e-3
    lamp = light.illuminant("D65")
    found = diffraction.starburst(aperture.iris(7, D), Grid((size, size), (pitch, pitch)), lamp, "coherence")
    total = found.pixels.sum((0, 1), dtype=np.float64)
    np.testing.assert_allclose(total, light.white(lamp), rtol=1e-3)
