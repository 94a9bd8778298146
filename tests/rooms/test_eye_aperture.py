"""The eye's parts: seeds obeyed, layers moved, lids closing, shadows moving, refusals."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from aureole import Grid, aperture, diffraction, glare, refuse
from aureole.glare.eye_aperture import FIELD_RADIUS, lash_shadows, moved_particles, state_fibres
from aureole.glare.eye_particles import populations

SIZE, WIDTH = 192, 8e-3
STATE = glare.EyeState(pupil_diameter=7e-3)
SCATTERED_OF_SEED_1_2_3 = [
    [0.6275742787596101, 0.5259494151446681],
    [-0.44251545597189346, 0.5618622194282697],
]


def parts(state=STATE, size=SIZE, **more):
    return glare.eye_parts(state, size, WIDTH, **more)


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def test_parts_have_the_components_names_and_stay_in_their_ranges():
    made = parts()
    assert tuple(made) == glare.COMPONENTS == ("bloom", "halo", "corona", "streaks")
    for name, most in (("bloom", 1), ("halo", STATE.eye.fibre_depth), ("corona", 2), ("streaks", 1)):
        assert made[name].shape == (SIZE, SIZE)
        assert made[name].dtype == np.float32
        assert made[name].min() == 0
        assert 0.5 * most < made[name].max() <= most or name == "halo"


def test_the_pupil_has_its_area_and_is_round():
    bloom = parts()["bloom"]
    assert bloom.sum(dtype=float) * (WIDTH / SIZE) ** 2 == pytest.approx(math.pi * 3.5e-3**2, rel=1e-6)
    np.testing.assert_allclose(bloom, bloom.T, atol=1e-6)
    np.testing.assert_allclose(bloom, bloom[::-1], atol=1e-6)


def test_the_aperture_is_the_product_of_what_the_parts_leave():
    made = parts()
    whole = glare.eye_aperture(STATE, SIZE, WIDTH)
    expected = made["bloom"] * (1 - made["halo"]) * (1 - made["corona"]) * (1 - made["streaks"])
    np.testing.assert_allclose(whole.mask, expected, atol=1e-6)
    assert whole.width == WIDTH
    assert whole.wavefront is None
    assert -1 <= whole.mask.min() < 0


def test_an_eye_without_fibres_particles_and_lashes_is_its_pupil():
    plain = replace(STATE, eye=glare.Eye(fibre_depth=0.0, particles=0.0, lashes=0))
    np.testing.assert_array_equal(glare.eye_aperture(plain, SIZE, WIDTH).mask, parts()["bloom"])


def test_the_same_seed_makes_the_same_eye_and_another_one_another():
    again, other = parts(), parts(replace(STATE, eye=glare.Eye(seed=2)))
    for name, first in parts().items():
        np.testing.assert_array_equal(first, again[name])
        if name != "bloom":
            assert not np.array_equal(first, other[name])


def test_one_seed_means_the_same_places_on_every_machine():
    lot = aperture.scattered(2, 1e-6, 1.0, (1, 2, 3))
    np.testing.assert_allclose(lot.centres, SCATTERED_OF_SEED_1_2_3, atol=1e-12)


def test_what_the_iris_hides_is_left_out_and_nothing_else():
    """Of fibres and particles the pixels of the pupil, partly covered ones too, miss nothing."""
    small = replace(STATE, pupil_diameter=5e-3)
    made = parts(small)
    passing = made["bloom"] > 0
    whole = aperture.disc_coverage(aperture.joined(moved_particles(small)), SIZE, WIDTH)
    np.testing.assert_allclose(made["corona"][passing], 2 * whole[passing], atol=1e-6)
    fibres = small.eye.fibre_depth * aperture.fibre_coverage(state_fibres(small), SIZE, WIDTH)
    np.testing.assert_allclose(made["halo"][passing], fibres[passing], atol=1e-6)
    outside = aperture.disc_coverage(aperture.Discs(np.zeros((1, 2)), np.array([2.8e-3])), SIZE, WIDTH) == 0
    assert not made["corona"][outside].any()
    assert not made["halo"][outside].any()
    assert whole[outside].any()


def test_age_adds_particles_and_leaves_those_that_were():
    for young, old in zip(
        moved_particles(STATE), moved_particles(replace(STATE, eye=glare.Eye(age=70.0))), strict=True
    ):
        for radius in np.unique(young.radii):
            few, many = (lot.centres[lot.radii == radius] for lot in (young, old))
            common = min(len(few), len(many))
            np.testing.assert_array_equal(few[:common], many[:common])
        assert len(old.radii) > len(young.radii)


def test_particles_are_as_dense_as_their_populations_say():
    counted = sum(len(layer.radii) for layer in moved_particles(STATE))
    wanted = sum(one.density for one in populations(30.0, 0.5))
    assert counted == pytest.approx(wanted * math.pi * FIELD_RADIUS**2, rel=1e-3)
    for layer in moved_particles(STATE):
        distances = np.hypot(*layer.centres.T)
        assert distances.max() <= FIELD_RADIUS
        assert len(np.unique(layer.centres, axis=0)) == len(distances)
        # Half of an even disc lies within √½ of its radius.
        assert np.mean(distances < FIELD_RADIUS / math.sqrt(2)) == pytest.approx(
            0.5, abs=2 / math.sqrt(len(distances))
        )


def test_turning_the_vitreous_by_a_right_angle_turns_its_picture():
    vitreous = moved_particles(STATE)[2]
    still = aperture.disc_coverage(vitreous, SIZE, WIDTH)
    turned = aperture.disc_coverage(aperture.turned(vitreous, math.pi / 2), SIZE, WIDTH)
    np.testing.assert_allclose(turned, np.rot90(still), atol=1e-5)


def test_only_the_vitreous_turns_with_the_head_and_only_the_lens_stretches():
    turned, stretched = replace(STATE, vitreous_angle=0.3), replace(STATE, lens_stretch=0.02)
    for index, (rest, one, two) in enumerate(
        zip(moved_particles(STATE), moved_particles(turned), moved_particles(stretched), strict=True)
    ):
        assert np.array_equal(rest.centres, one.centres) == (index != 2)
        assert np.array_equal(rest.centres, two.centres) == (index != 1)


def test_the_lens_stretches_from_the_axis_by_its_stretch_and_a_little_unevenly():
    lens = moved_particles(STATE)[1]
    moved = aperture.stretched(lens, 0.02, 5, FIELD_RADIUS)
    np.testing.assert_array_equal(moved.radii, lens.radii)
    radial = np.sum(moved.centres * lens.centres) / np.sum(lens.centres**2)
    assert radial == pytest.approx(1.02, abs=0.01)
    uneven = moved.centres - 1.02 * lens.centres
    assert np.sqrt(np.mean(uneven**2)) == pytest.approx(0.3 * 0.02 * FIELD_RADIUS / math.sqrt(2), rel=0.5)
    # Neighbours move together.
    order = np.argsort(lens.centres[:, 0] + 1j * lens.centres[:, 1])
    near = np.hypot(*np.diff(lens.centres[order], axis=0).T) < 1e-4
    assert np.abs(np.diff(uneven[order], axis=0)[near]).max() < 0.05 * 0.02 * FIELD_RADIUS
    even = aperture.stretched(lens, 0.02, 5, FIELD_RADIUS, unevenness=0.0)
    np.testing.assert_allclose(even.centres, 1.02 * lens.centres, rtol=1e-12)


def test_fibres_stretch_with_the_lens():
    rest = aperture.fibres((2e-3, 3e-3), width=50e-6)
    wide = aperture.stretched_fibres(rest, 0.1)
    np.testing.assert_allclose(wide.radii, 1.1 * rest.radii)
    np.testing.assert_allclose(
        aperture.fibre_coverage(wide, SIZE, 1.1 * WIDTH),
        aperture.fibre_coverage(rest, SIZE, WIDTH),
        atol=1e-5,
    )


def test_fibres_of_a_width_are_as_many_as_fit_in_each_shell():
    """The real ones: 7 shells of about 0.25 mm, about 1850 fibres of 10.2 µm at a radius of 3 mm."""
    made = aperture.fibres((2.25e-3, 4e-3), width=10.2e-6)
    assert len(made.counts) == 7
    assert (made.radii[0], made.radii[-1]) == (2.25e-3, 4e-3)
    np.testing.assert_allclose(np.diff(made.radii), 0.25e-3, atol=0.7 * 0.25e-3)
    middles = (made.radii[1:] + made.radii[:-1]) / 2
    np.testing.assert_array_equal(made.counts, np.rint(2 * np.pi * middles / 10.2e-6))
    assert np.interp(3e-3, middles, made.counts) == pytest.approx(1848, abs=1)


def test_neighbouring_shells_differ_by_different_numbers_of_fibres():
    """Equal differences would beat all at once, as a comb of so many teeth in the ring of light."""
    steps = np.diff(aperture.fibres((2.25e-3, 4e-3), width=10.2e-6).counts)
    assert np.ptp(steps) > 30
    assert (steps > 0).all()


def test_lids_close_monotonically_until_nothing_passes():
    openings = np.linspace(0, 1, 11)
    shares = [glare.open_share(replace(STATE, lid_opening=opening), size=64) for opening in openings]
    assert shares[0] == 0
    assert np.all(np.diff(shares) > 0)
    assert shares[-1] > 0.97
    for opening, later in ((0.0, 0.2), (0.2, 0.5), (0.5, 1.0)):
        narrow, wide = (parts(replace(STATE, lid_opening=one))["bloom"] for one in (opening, later))
        assert np.all(narrow <= wide)


def test_closed_lids_leave_nothing_for_any_pupil_and_source():
    for diameter in (2e-3, 9e-3):
        for source in ((0.0, 0.0), (0.4, -0.5)):
            closed = glare.EyeState(pupil_diameter=diameter, lid_opening=0.0)
            assert not glare.eye_aperture(closed, 64, 1e-2, source).mask.any()


def test_open_lids_clear_the_widest_pupil():
    wide = glare.EyeState(pupil_diameter=9e-3)
    assert parts(wide)["bloom"].sum() > 0
    bloom = glare.eye_parts(wide, SIZE, 9.5e-3)["bloom"]
    assert bloom.sum(dtype=float) * (9.5e-3 / SIZE) ** 2 == pytest.approx(math.pi * 4.5e-3**2, rel=1e-5)


@pytest.mark.parametrize("opening", [0.003, 0.05, 0.4])
def test_lids_leave_the_area_between_their_parabolas(opening):
    mask = np.ones((300, 300), dtype=np.float32)
    margins = aperture.lids(opening)
    aperture.close_lids(mask, margins, 10e-3)
    x = np.linspace(-5e-3, 5e-3, 20001)
    upper, lower = (height + curvature * x**2 / 2 for height, curvature in (margins.upper, margins.lower))
    exact = np.trapezoid(lower - upper, x)
    assert mask.sum(dtype=float) * (10e-3 / 300) ** 2 == pytest.approx(exact, rel=1e-5)


def test_lashes_hang_over_the_top_of_a_wide_pupil_and_leave_a_small_one():
    streaks = parts()["streaks"] * parts()["bloom"]
    assert streaks[: SIZE // 2].any()
    assert not streaks[SIZE // 2 :].any()
    assert glare.open_share(replace(STATE, pupil_diameter=2.5e-3)) == pytest.approx(1, abs=1e-6)


def test_lashes_cover_their_own_area_and_taper():
    one = aperture.lashes(6, 0.0, 100e-6, 1.0, 1)
    clear = one[len(one) // 2]
    assert np.hypot(*(clear.vertices[0] - clear.vertices[3])) == pytest.approx(100e-6)
    assert np.hypot(*(clear.vertices[1] - clear.vertices[2])) == pytest.approx(25e-6)
    covered = aperture.lash_coverage([clear], 512, 40e-3)
    assert covered.sum(dtype=float) * (40e-3 / 512) ** 2 == pytest.approx(
        abs(aperture.ring_moments(clear)[0]), rel=1e-4
    )


def test_a_small_square_shows_the_middle_of_a_larger_one():
    shadows = aperture.lashes(6, 0.5, 80e-6, 0.5, 4, (0.0, 1e-3), (0.0, 1.5e-3))
    for pixels in (20, 60, 150):
        middle = aperture.lash_coverage(shadows, pixels, pixels * 30e-6)
        whole = aperture.lash_coverage(shadows, pixels + 300, (pixels + 300) * 30e-6)
        np.testing.assert_allclose(middle, whole[150:-150, 150:-150], atol=1e-6)
        assert middle.any()


def test_lashes_without_spread_stand_upright_on_the_margin():
    for opening in (0.2, 1.0):
        curvature = aperture.lids(opening).upper[1]
        for ring in aperture.lashes(6, 0.0, 80e-6, opening, 1):
            root, tip = ring.vertices[[0, 3]].mean(axis=0), ring.vertices[[1, 2]].mean(axis=0)
            tangent = np.array([1.0, curvature * root[0]])
            assert abs((tip - root) @ tangent) < 1e-12
            assert tip[1] > root[1]


def test_lashes_bend_as_the_lids_close():
    bulges = [
        np.mean([abs(ring.bulges[0]) for ring in lash_shadows(replace(STATE, lid_opening=o))])
        for o in (1, 0.5, 0)
    ]
    assert bulges[0] < 0.1 < bulges[1] < bulges[2]


def test_as_many_lashes_hang_over_six_millimetres_as_asked_for():
    roots = np.array([ring.vertices[[0, 3]].mean(axis=0) for ring in aperture.lashes(8, 0.3, 8e-5, 1.0, 1)])
    assert np.mean(np.histogram(roots[:, 0], bins=4, range=(-12e-3, 12e-3))[0]) == pytest.approx(8, abs=1)
    directions = [
        math.atan2(*(ring.vertices[[1, 2]].mean(axis=0) - ring.vertices[[0, 3]].mean(axis=0)))
        for seed in range(20)
        for ring in aperture.lashes(8, 0.3, 8e-5, 1.0, seed)
        if abs(ring.vertices[0, 0]) < 2e-3
    ]
    assert np.mean(directions) == pytest.approx(0, abs=0.1)
    assert np.std(directions) == pytest.approx(0.3, rel=0.2)


def test_a_source_moves_the_shadows_of_lids_and_lashes_the_other_way():
    source = (math.radians(20), math.radians(-10))
    still, moved = lash_shadows(STATE), lash_shadows(STATE, source)
    for one, other in zip(still, moved, strict=True):
        shift = other.vertices - one.vertices
        far = -12e-3 * np.tan(source)
        near = -3e-3 * np.tan(source)
        # Corners lie within the lash's breadth of its axis, whose ends move.
        np.testing.assert_allclose(shift[[1, 2]].mean(axis=0), far, atol=1e-9)
        np.testing.assert_allclose(shift[[0, 3]].mean(axis=0), near, atol=1e-9)
    low = replace(STATE, lid_opening=0.7)
    open_rows = [parts(low, source=(0.0, angle))["bloom"].sum() for angle in (0.0, -0.3)]
    assert open_rows[1] < open_rows[0]


def test_layers_of_the_corona_divide_its_particles():
    layers = glare.corona_layers(STATE, SIZE, WIDTH)
    assert tuple(layers) == ("inner", "outer")
    both = 1 - (1 - layers["inner"] / 2) * (1 - layers["outer"] / 2)
    np.testing.assert_allclose(2 * both, parts()["corona"], atol=1e-5)
    assert layers["inner"].mean() > layers["outer"].mean() > 0


def test_a_defocused_eye_has_a_wavefront_also_where_its_amplitude_is_negative():
    short = replace(STATE, eye=glare.Eye(defocus=-1.0), accommodation=0.5)
    made = glare.eye_aperture(short, SIZE, WIDTH)
    centres = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * WIDTH
    expected = -1.5 * (centres[:, None] ** 2 + centres**2) / 2
    lit = made.mask != 0
    np.testing.assert_allclose(made.wavefront[lit], expected[lit], atol=1e-11)
    assert made.mask[lit].min() < 0
    assert not made.wavefront[~lit].any()
    wave = aperture.transmittance(made, 550e-9)
    np.testing.assert_allclose(np.abs(wave), np.abs(made.mask), atol=1e-6)


def test_light_half_a_wave_late_counts_as_light():
    """A mask of −1 is resampled, has a wavefront's root mean square, and a far field, as one of 1 has."""
    late = glare.eye_aperture(replace(STATE, eye=glare.Eye(defocus=-0.5)), 48, WIDTH)
    turned = replace(late, mask=-late.mask)
    assert aperture.wavefront_rms(turned) == pytest.approx(aperture.wavefront_rms(late), rel=1e-12)
    assert aperture.wavefront_rms(late) > 1e-7
    half = aperture.rasterize(turned, 24)
    np.testing.assert_allclose(half, -late.mask.reshape(24, 2, -1, 2).mean(axis=(1, 3)), atol=1e-6)
    flat, grid = replace(late, wavefront=None), Grid((9, 8), (200.0, 150.0))
    exact = diffraction.far_field(flat, grid, "reference").amplitude
    for method in ("quads", "rows", "chirpz"):
        found = diffraction.far_field(flat, grid, method).amplitude
        np.testing.assert_allclose(found, exact, atol=2e-6 * np.abs(exact).max())


def test_zernike_terms_stand_on_their_own_disc():
    eye = glare.Eye(
        zernike={"spherical": 2e-7}, zernike_diameter=6e-3, particles=0.0, lashes=0, fibre_depth=0.0
    )
    made = glare.eye_aperture(replace(STATE, eye=eye), SIZE, WIDTH)
    row = made.wavefront[SIZE // 2]
    centres = ((np.arange(SIZE) + 0.5) / SIZE - 0.5) * WIDTH
    inside = np.abs(centres) < 3.4e-3
    expected = 2e-7 * aperture.zernike("spherical", centres / 3e-3, np.full(SIZE, 0.5 * WIDTH / SIZE / 3e-3))
    np.testing.assert_allclose(row[inside], expected[inside], atol=1e-12)


def test_the_picture_of_an_eye_shows_pupil_iris_and_lids():
    shown = glare.eye_picture(replace(STATE, eye=glare.Eye(particles=0.0, lashes=0, fibre_depth=0.0)), 96)
    assert shown.pixels.shape == (96, 96, 3)
    assert shown.pixels.dtype == np.float32
    middle, iris, skin = shown.pixels[48, 48], shown.pixels[84, 48], shown.pixels[0, 48]
    assert middle.min() > 0.8
    assert iris.max() < 0.2
    assert skin[0] > 1.5 * skin[2]
    closed = glare.eye_picture(replace(STATE, lid_opening=0.0, eye=glare.Eye(lashes=0)), 64).pixels
    assert np.ptp(closed, axis=(0, 1)).max() < 1e-6


def test_what_cannot_be_is_refused():
    with refused("'size' must be an integer >= 1, got 0."):
        parts(size=0)
    with refused("'width' must be a finite number > 0, got 0."):
        glare.eye_parts(STATE, 8, 0.0)
    with refused("'opening' must be a number from 0 to 1, got 1.5."):
        parts(replace(STATE, lid_opening=1.5))
    with refused("'source' must be a number from -1.39626 to 1.39626, got 1.5."):
        parts(source=(0.0, 1.5))
    with refused("'pupil_diameter' must be a finite number > 0, got -1."):
        parts(replace(STATE, pupil_diameter=-1.0))
    with refused("'annulus' must have an outer radius above 0.002 m, got 0.001 m."):
        aperture.fibres((2e-3, 1e-3), count=10)
    with refused("fibres need either a 'width' or a 'count'."):
        aperture.fibres((1e-3, 2e-3))
    with refused("'stretch' must be a number from -0.5 to 1, got 2."):
        aperture.stretched(moved_particles(STATE)[1], 2.0, 1, FIELD_RADIUS)
