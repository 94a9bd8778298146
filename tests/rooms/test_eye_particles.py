"""The eye's particles: their closed form against CIE 135, overlap by brute force, layers, refusals."""

import math

import numpy as np
import pytest

from aureole import refuse
from aureole.glare import eye_particles, veil

EYES = [(20, 0), (20, 1.2), (35, 0.5), (70, 0.5), (80, 0), (80, 1.2)]


@pytest.mark.parametrize(("age", "pigment"), EYES)
def test_particles_scatter_what_the_total_glare_function_says(age, pigment):
    particles = eye_particles.populations(age, pigment)
    for low, high, tolerance in ((0.1, 3, 0.15), (3, 8, 0.2)):
        angles = np.radians(np.geomspace(low, high, 200))
        pupil = 575e-9 / (np.pi**3 * 5e-3 * np.sin(angles) ** 3)
        found = eye_particles.scattered_density(particles, angles) + pupil
        np.testing.assert_allclose(found / veil.cie_135(angles, age, pigment), 1, atol=tolerance)


def test_older_and_lighter_eyes_scatter_more():
    shares = [eye_particles.scattered_share(eye_particles.populations(age)) for age in (20, 40, 60, 80)]
    assert shares == sorted(shares)
    assert eye_particles.scattered_share(eye_particles.populations(35, 1.2)) > shares[0]
    wide = math.radians(5)
    by_age = [eye_particles.scattered_density(eye_particles.populations(age), wide) for age in (25, 70)]
    assert by_age[1] / by_age[0] == pytest.approx(
        float(veil.cie_135(wide, 70) / veil.cie_135(wide, 25)), rel=0.1
    )


@pytest.mark.parametrize("factor", [0.25, 1.0, 2.0])
def test_a_factor_scatters_so_many_times_the_light(factor):
    once = eye_particles.scattered_share(eye_particles.populations(50))
    found = eye_particles.scattered_share(eye_particles.populations(50, factor=factor))
    assert found == pytest.approx(factor * once, rel=1e-9)
    assert eye_particles.populations(50, factor=0) == ()


def test_the_covered_part_is_that_of_discs_thrown_at_random():
    # Discs thrown on a torus of 1 mm; the share of places under none is exp(−n π r²).
    rng, side = np.random.default_rng(3), 1e-3
    particles = (
        eye_particles.Population("lens", 40e-6, 40e6),
        eye_particles.Population("cornea", 15e-6, 200e6),
    )
    places = rng.random((20000, 2)) * side
    free = np.ones(len(places), bool)
    for one in particles:
        for centre in rng.random((round(one.density * side**2), 2)) * side:
            apart = np.abs(places - centre)
            free &= np.hypot(*np.minimum(apart, side - apart).T) > one.radius
    assert 1 - free.mean() == pytest.approx(eye_particles.covered(particles), abs=0.03)


def test_scattered_light_over_all_angles_is_the_scattered_share():
    # Discs much larger than a wavelength: nearly all of their light stays within a right angle.
    particles = (eye_particles.Population("lens", 20e-6, 40e6),)
    whole = veil.hemisphere_energy(lambda angle: eye_particles.scattered_density(particles, angle))
    assert whole == pytest.approx(eye_particles.scattered_share(particles), rel=0.02)


@pytest.mark.parametrize(("age", "pigment"), EYES)
def test_layers_share_the_light_and_the_cornea_has_the_largest(age, pigment):
    particles = eye_particles.populations(age, pigment)
    light = {
        layer: sum(one.density * one.radius**2 for one in particles if one.layer == layer)
        for layer in eye_particles.LAYERS
    }
    whole = sum(light.values())
    assert light["cornea"] / whole == pytest.approx(0.27, abs=1e-9)
    assert light["lens"] == pytest.approx(4 * light["vitreous"], rel=1e-9)
    corneal = [one.radius for one in particles if one.layer == "cornea"]
    others = [one.radius for one in particles if one.layer != "cornea"]
    assert min(corneal) >= max(others) * (1 - 1e-12)
    assert sum(one.density for one in particles if one.layer == "lens") > 0.5 * sum(
        one.density for one in particles
    )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((-1,), "'age' must be a number from 0 to 120"),
        ((30, 1.5), "'pigment' must be a number from 0 to 1.2"),
        ((30, 0.5, -1), "'factor' must be a number from 0 to 100"),
        ((30, 0.5, 5), "the most is"),
    ],
)
def test_particles_refuse_what_no_eye_has(arguments, said):
    with pytest.raises(refuse.Refusal, match=said):
        eye_particles.populations(*arguments)
