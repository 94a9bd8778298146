"""The near-field jobs give what the library gives, at one distance and at many, and refuse what clashes."""

import math

import numpy as np
import pytest

from aureole import Grid, Refusal, aperture, diffraction, jobs, light
from aureole.jobs import NearFieldJob, NearSectionJob, NearSweepJob, Opening, Sweep

WAVELENGTH = 550e-9
CIRCLE = Opening(shape="circle", width=2e-3)
SLIT = Opening(shape="rectangle", width=2e-3, height=1e-3)


def done(job):
    return jobs.finish(jobs.run(job))


def at(number, width=2e-3):
    return (width / 2) ** 2 / (WAVELENGTH * number)


def test_a_plane_holds_the_librarys_irradiance():
    result = done(NearFieldJob(SLIT, distance=0.5, extent=4e-3, shape=(30, 40), centre=(1e-4, -3e-4)))
    assert result.grid == Grid((30, 40), (1e-4, 1e-4), (-3e-4, 1e-4))
    wanted = diffraction.near_power(aperture.rectangle(2e-3, 1e-3), result.grid, 0.5, WAVELENGTH)
    np.testing.assert_array_equal(result.irradiance, wanted)
    for channel in range(3):
        np.testing.assert_array_equal(result.picture.pixels[..., channel], wanted)
    assert result.report["largest_irradiance"] == wanted.max()
    assert result.report["fresnel_number"] == pytest.approx(1e-6 / (WAVELENGTH * 0.5))


def test_a_fresnel_number_says_the_distance():
    result = done(NearFieldJob(CIRCLE, fresnel_number=3.0, shape=(9, 9)))
    assert result.report["distance_m"] == pytest.approx(at(3.0))
    assert result.report["fresnel_number"] == pytest.approx(3.0)
    assert result.report["plane_m"] == pytest.approx([4e-3, 4e-3])
    # A circle's axis: 4 sin²(πN/2); the raster of an outline is off by 1e-2 at most here.
    assert result.report["irradiance_on_axis"] == pytest.approx(4.0, abs=2e-2)


def test_the_size_is_the_default_cameras_where_none_is_given():
    report = done(NearFieldJob(Opening(), distance=0.5, shape=(5, 5))).report
    assert report["aperture_width_m"] == pytest.approx(50e-3 / 16)
    assert report["aperture"] == "iris of 7 blades"


def test_energy_goes_through_the_plane_whatever_its_distance():
    for number in (5.0, 20.0):
        report = done(NearFieldJob(CIRCLE, fresnel_number=number, extent=12e-3, shape=(300, 300))).report
        assert report["energy_through_plane"] == pytest.approx(1, abs=0.015)


def test_an_obstacle_and_its_opening_add_up_to_the_free_wave():
    """Babinet, and Arago's spot: behind a disc the axis is as bright as without it."""
    common = {"distance": at(4.0), "shape": (31, 32), "amplitude": True}
    open_, blocked = (done(NearFieldJob(CIRCLE, obstacle=o, **common)) for o in (False, True))
    total = open_.amplitude.amplitude + blocked.amplitude.amplitude
    np.testing.assert_allclose(total, 1, atol=1e-6)
    np.testing.assert_allclose(blocked.irradiance, np.abs(blocked.amplitude.amplitude) ** 2, rtol=1e-6)
    assert blocked.report["irradiance_on_axis"] == pytest.approx(1, abs=1e-2)
    assert "energy_through_plane" not in blocked.report


@pytest.mark.parametrize("rotation", [0.0, 0.4, math.pi])
def test_a_straight_edge_halves_the_amplitude_on_it(rotation):
    """Sommerfeld: 1/4 on the edge, 1.370 at the first maximum, 0.8604 √(λz) from it on the lit side."""
    edge = Opening(shape="half-plane", rotation=rotation)
    step = math.sqrt(WAVELENGTH * 0.5) / 500
    result = done(NearFieldJob(edge, distance=0.5, extent=1001 * step, shape=(1001, 1001)))
    assert result.report["irradiance_on_axis"] == pytest.approx(0.25, abs=1e-6)
    assert result.report["largest_irradiance"] == pytest.approx(1.3704, abs=1e-3)
    lit = 0.8604 * 500 * np.array([-math.cos(rotation), math.sin(rotation)])
    column, row = (round(500 + value) for value in lit)
    assert result.irradiance[row, column] == pytest.approx(1.3704, abs=1e-3)
    for name in ("fresnel_number", "aperture_width_m", "energy_through_plane"):
        assert name not in result.report


def test_behind_a_straight_edge_the_plane_is_some_fringes_wide():
    edge = Opening(shape="half-plane")
    report = done(NearFieldJob(edge, distance=2.0, shape=(4, 8))).report
    assert report["plane_m"] == pytest.approx([10 * math.sqrt(WAVELENGTH * 2), 5 * math.sqrt(WAVELENGTH * 2)])
    # As an obstacle it is the other half.
    common = {"distance": 2.0, "extent": 1e-2, "shape": (1, 33)}
    both = [done(NearFieldJob(edge, obstacle=o, **common)).irradiance[0] for o in (False, True)]
    np.testing.assert_allclose(both[0], both[1][::-1], atol=1e-5)


def test_a_cats_eye_is_what_both_circles_leave():
    """Two circles of radius r, r apart, share r² (2π/3 − √3/2)."""
    eye = Opening(shape="circle", width=2e-3, housing=(0.5, 0.0, 1.0))
    report = done(NearFieldJob(eye, fresnel_number=100.0, extent=4e-3, shape=(401, 401))).report
    share = (2 * math.pi / 3 - math.sqrt(3) / 2) * 1e-6
    assert report["energy_through_plane"] == pytest.approx(1, abs=0.01)
    assert report["mean_irradiance"] * 16e-6 == pytest.approx(share, rel=0.01)
    assert report["aperture"] == "circle within a housing"


def test_colour_where_nothing_is_in_the_way_is_white():
    """A thousandth of a millimetre blocks nothing of a plane ten metres away."""
    speck = Opening(shape="circle", width=1e-6)
    result = done(
        NearFieldJob(speck, obstacle=True, illuminant="A", distance=10.0, extent=1e-3, shape=(4, 6))
    )
    np.testing.assert_allclose(result.picture.pixels, 1, atol=1e-4)
    np.testing.assert_allclose(result.irradiance, 1, atol=1e-4)


def test_colour_is_the_sum_of_its_wavelengths():
    job = NearFieldJob(SLIT, illuminant="E", samples=5, fresnel_number=3.0, shape=(12, 13))
    result = done(job)
    wavelengths, weights = light.quadrature(light.illuminant("E"), 5)
    shape = aperture.rectangle(2e-3, 1e-3)
    xyz = sum(
        diffraction.near_power(shape, result.grid, at(3.0), float(one))[..., None] * weight
        for one, weight in zip(wavelengths, weights, strict=True)
    )
    wanted = light.from_xyz(xyz, "rec709", white=light.white(light.illuminant("E")))
    np.testing.assert_allclose(result.picture.pixels, wanted, atol=2e-5)
    np.testing.assert_allclose(result.irradiance, xyz[..., 1], atol=2e-5)
    assert np.ptp(result.picture.pixels, axis=2).max() > 0.1


@pytest.mark.parametrize("spectral", ["exact", "approximate"])
def test_colour_is_the_librarys(spectral):
    common = {"illuminant": "A", "samples": 7, "distance": 0.3, "extent": 3e-3, "shape": (11, 12)}
    result = done(NearFieldJob(SLIT, spectral=spectral, method="polygons", **common))
    shape, lamp = aperture.rectangle(2e-3, 1e-3), light.illuminant("A")
    xyz = diffraction.near_picture(shape, result.grid, 0.3, lamp, spectral, 7, field_method="polygons")
    np.testing.assert_array_equal(result.irradiance, xyz.pixels[..., 1])
    np.testing.assert_allclose(result.picture.pixels, light.convert(xyz, "rec709").pixels, atol=1e-6)
    assert result.report["spectral"] == spectral


def test_colour_round_an_obstacle_of_edges_is_that_round_its_pixels():
    common = {"obstacle": True, "illuminant": "D65", "samples": 4, "distance": 0.4, "shape": (16, 17)}
    found = [done(NearFieldJob(SLIT, method=name, **common)) for name in ("polygons", "rows")]
    np.testing.assert_allclose(found[0].picture.pixels, found[1].picture.pixels, atol=2e-4)


def test_a_line_is_one_wavelength():
    found = done(NearFieldJob(SLIT, illuminant="line:633nm", distance=0.3, shape=(8, 8)))
    wanted = done(NearFieldJob(SLIT, wavelength=633e-9, distance=0.3, shape=(8, 8)))
    np.testing.assert_array_equal(found.picture.pixels, wanted.picture.pixels)


def test_a_wavefront_focuses():
    """One wave of defocus bends the wave to a focus at (width/2)² / (2 W20)."""
    w20 = -2 * WAVELENGTH
    focus = (1e-3) ** 2 / (2 * -w20)
    bent = Opening(shape="circle", width=2e-3, defocus=w20)
    found = done(NearFieldJob(bent, distance=focus, extent=1e-4, shape=(3, 3))).report["irradiance_on_axis"]
    assert found == pytest.approx((math.pi * 1e-6 / (WAVELENGTH * focus)) ** 2, rel=0.02)


@pytest.mark.parametrize(
    ("spacing", "value"), [("log", math.log), ("distance", float), ("fresnel-number", lambda z: 1 / z)]
)
def test_distances_are_evenly_spaced_in_what_is_asked(spacing, value):
    for ends in ((0.05, 2.0), (2.0, 0.05), (1e-300, 1e300)):
        if ends[0] < 1e-200 and spacing != "log":
            continue
        found = Sweep(*ends, spacing).distances(7)
        assert (found[0], found[-1]) == ends
        steps = np.diff([value(z) for z in found])
        np.testing.assert_allclose(steps, steps[0], rtol=1e-9)


def frames_of(job):
    return [stage.result for stage in jobs.run(job) if isinstance(stage.result, jobs.NearFrame)]


SWEEP = Sweep(0.1, 1.6)
PLANE = NearFieldJob(SLIT, extent=4e-3, shape=(20, 24))


def test_each_plane_of_a_sweep_is_the_plane_of_its_distance():
    frames = frames_of(NearSweepJob(PLANE, SWEEP, 5))
    assert [frame.number for frame in frames] == [1, 2, 3, 4, 5]
    for frame, distance in zip(frames, (0.1, 0.2, 0.4, 0.8, 1.6), strict=True):
        assert frame.plane.report["distance_m"] == pytest.approx(distance)
        job = NearFieldJob(SLIT, extent=4e-3, shape=(20, 24), distance=frame.plane.report["distance_m"])
        alone = done(job)
        np.testing.assert_array_equal(frame.plane.picture.pixels, alone.picture.pixels)
        assert frame.plane.description == alone.description


def test_stages_rise_to_one_and_tell_every_plane():
    stages = list(jobs.run(NearSweepJob(PLANE, SWEEP, 3, strip=True)))
    fractions = [stage.fraction for stage in stages]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1
    report = stages[-1].result.report
    assert [one["number"] for one in report["frames"]] == [1, 2, 3]
    assert [one["kept"] for one in report["frames"]] == [False] * 3
    assert report["first_fresnel_number"] == pytest.approx(1e-6 / (WAVELENGTH * 0.1))


def test_planes_that_are_done_are_not_made_again():
    asked = []

    def is_done(number, description):
        asked.append((number, description))
        return number == 2

    job = NearSweepJob(PLANE, SWEEP, 4, numbers=(4, 2, 1), is_done=is_done)
    assert [frame.number for frame in frames_of(job)] == [1, 4]
    assert [number for number, _ in asked] == [1, 2, 4]
    assert len({words for _, words in asked}) == 3


def test_a_strip_shows_all_planes_at_their_mean():
    job = NearSweepJob(NearFieldJob(SLIT, extent=4e-3, shape=(320, 480)), SWEEP, 9, strip=True)
    strip = done(job).strip.pixels
    rows, columns = 107, 160
    assert strip.shape == (2 * rows + 4, 8 * columns + 7 * 4, 3)
    for frame in frames_of(job):
        row, column = divmod(frame.number - 1, 8)
        tile = strip[row * (rows + 4) :, column * (columns + 4) :][:rows, :columns]
        # Each pixel stands for the mean of three by three, or four here and there.
        np.testing.assert_allclose(tile.mean(), frame.plane.irradiance.mean(), rtol=0.01)
        np.testing.assert_allclose(
            tile[-1, :2, 0], frame.plane.irradiance[-3:, :6].reshape(3, 2, 3).mean(axis=(0, 2)), atol=1e-5
        )


def test_a_section_is_the_line_across_each_plane():
    plane = NearFieldJob(SLIT, extent=4e-3, shape=(4, 24), centre=(0.0, 3e-4))
    section = done(NearSectionJob(plane, SWEEP)).picture.pixels
    for row, distance in zip(section, SWEEP.distances(4), strict=True):
        grid = Grid((1, 24), (4e-3 / 24, 4e-3 / 24), (3e-4, 0.0))
        wanted = diffraction.near_power(aperture.rectangle(2e-3, 1e-3), grid, distance, WAVELENGTH)
        np.testing.assert_allclose(row[..., 1], wanted[0], atol=1e-6)


def test_planes_may_grow_as_their_light_spreads():
    """Far away the far field keeps its place on a plane that grows with the distance."""
    plane = NearFieldJob(CIRCLE, extent=1e-9, shape=(41, 41))
    far = [at(0.01), at(0.001)]
    frames = frames_of(NearSweepJob(plane, Sweep(*far), 2, zoom=True))
    for frame, distance in zip(frames, far, strict=True):
        assert frame.plane.report["plane_m"][0] == pytest.approx(8 * WAVELENGTH * distance / 2e-3, rel=1e-3)
    shown = [frame.plane.irradiance / frame.plane.irradiance.max() for frame in frames]
    np.testing.assert_allclose(shown[0], shown[1], atol=2e-3)
    same = frames_of(NearSweepJob(plane, Sweep(*far), 2))
    assert same[0].plane.grid == same[1].plane.grid


def test_another_job_has_another_description():
    same = {"extent": 1e-3, "shape": (3, 3), "distance": 0.5}
    jobs_ = [
        NearFieldJob(SLIT, **same),
        NearFieldJob(CIRCLE, **same),
        NearFieldJob(SLIT, **same | {"distance": 0.5000001}),
        NearFieldJob(SLIT, **same | {"extent": 1.1e-3}),
        NearFieldJob(SLIT, **same, wavelength=551e-9),
        NearFieldJob(SLIT, **same, obstacle=True),
        NearFieldJob(Opening(shape="rectangle", width=2e-3, height=1e-3, scratches=3), **same),
        NearFieldJob(Opening(shape="rectangle", width=2e-3, height=1e-3, scratches=3, seed=2), **same),
    ]
    found = [done(job).description for job in jobs_]
    assert len(set(found)) == len(found)
    again = [done(job).description for job in jobs_]
    assert found == again
    # Memory changes no number.
    assert done(NearFieldJob(SLIT, **same, memory=10**10)).description == found[0]


BAD = [
    (NearFieldJob(), "'distance' and 'fresnel_number' are both missing; give one of them."),
    (
        NearFieldJob(distance=1.0, fresnel_number=2.0),
        "'distance' and 'fresnel_number' both say where the plane is; give one of them.",
    ),
    (NearFieldJob(distance=0.0), "'distance' must be a finite number > 0, got 0."),
    (NearFieldJob(fresnel_number=-1.0), "'fresnel_number' must be a finite number > 0, got -1."),
    (NearFieldJob(distance=1.0, extent=0.0), "'extent' must be a finite number > 0, got 0."),
    (NearFieldJob(distance=1.0, shape=(0, 5)), "'size' must be an integer >= 1, got 0."),
    (NearFieldJob(distance=1.0, wavelength=math.nan), "'wavelength' must be a finite number > 0, got nan."),
    (
        NearFieldJob(distance=1.0, wavelength=5e-7, illuminant="E"),
        "'wavelength' and 'illuminant' both say the light; give one of them.",
    ),
    (NearFieldJob(distance=1.0, illuminant="D66"), "Did you mean 'D65'?"),
    (NearFieldJob(distance=1.0, samples=3), "'samples' is for light of many wavelengths"),
    (NearFieldJob(distance=1.0, spectral="approximate"), "'spectral' is for light of many wavelengths"),
    (NearFieldJob(distance=1.0, spectral="fast"), "'spectral' must be one of 'exact', 'approximate'"),
    (NearFieldJob(distance=1.0, illuminant="E", cull=1e-6), "'cull' is for one wavelength"),
    (NearFieldJob(distance=1.0, illuminant="E", amplitude=True), "'amplitude' is for one wavelength"),
    (NearFieldJob(distance=1.0, cull=1e-6, obstacle=True), "'cull' does not go with 'obstacle'"),
    (
        NearFieldJob(Opening(dust=0.1), distance=1.0, obstacle=True, illuminant="E", spectral="approximate"),
        "'approximate' does not serve an obstacle of pixels",
    ),
    (NearFieldJob(distance=1.0, method="row"), "Did you mean 'rows'?"),
    (NearFieldJob(distance=1.0, finest="thirds"), "'finest' must be one of 'full', 'half'"),
    (NearFieldJob(distance=1.0, colour_space="srgb"), "'colour_space' must be one of"),
    (NearFieldJob(Opening(shape="hexagon"), distance=1.0), "'aperture' must be one of 'iris', 'circle'"),
    (
        NearFieldJob(Opening(shape="half-plane"), fresnel_number=1.0),
        "a half plane has no width and so no Fresnel number; give 'distance'.",
    ),
    (
        NearFieldJob(Opening(shape="half-plane", dust=0.1), distance=1.0),
        "'dust' does not go with aperture 'half-plane', which is one straight edge.",
    ),
    (
        NearFieldJob(Opening(shape="half-plane"), distance=1.0, method="rows"),
        "a half plane has no end and so no pixels; use method 'polygons'.",
    ),
    (NearFieldJob(Opening(housing=(2.0, 0.0, 1.0)), distance=1.0), "lets no light through."),
    (NearFieldJob(Opening(defocus=1e-7), distance=1.0, obstacle=True), "an obstacle has no wavefront"),
    (NearFieldJob(distance=1.0, shape=(100_000, 100_000)), "GB are allowed; see --memory and --size."),
    (NearSweepJob(NearFieldJob(distance=1.0), SWEEP, 3), "'distance' does not go with 'sweep'"),
    (NearSweepJob(NearFieldJob(fresnel_number=1.0), SWEEP, 3), "'fresnel_number' does not go with 'sweep'"),
    (NearSweepJob(NearFieldJob(amplitude=True), SWEEP, 3), "'amplitude' is for one plane"),
    (NearSweepJob(NearFieldJob(), SWEEP, 1), "'count' must be an integer >= 2, got 1."),
    (NearSweepJob(NearFieldJob(), Sweep(1.0, 1.0), 3), "'sweep' must end at another distance than 1 m."),
    (
        NearSweepJob(NearFieldJob(), Sweep(0.0, 1.0), 3),
        "'first distance' must be a finite number > 0, got 0.",
    ),
    (NearSweepJob(NearFieldJob(), Sweep(1.0, 2.0, "lin"), 3), "'sweep_by' must be one of 'log', 'distance'"),
    (NearSweepJob(NearFieldJob(), SWEEP, 3, (2, 4)), "'frames' must lie from 1 to 3, got 4."),
    (NearSectionJob(NearFieldJob(shape=(1, 8)), SWEEP), "'count' must be an integer >= 2, got 1."),
]


@pytest.mark.parametrize(("job", "text"), BAD, ids=[text for _, text in BAD])
def test_what_does_not_fit_is_refused(job, text):
    with pytest.raises(Refusal) as refused:
        done(job)
    assert text in str(refused.value)
