"""The check of lens files: each known mistake is found, and shipped lenses have none of them."""

import dataclasses

import pytest

from aureole import flare, presets
from aureole.flare import lint, paraxial

HELIAR = flare.load("heliar_tronnier_100mm")
INTERPOLATED = ("itoh_wide_zoom_123mm_seed", "nikon_tele_zoom_140mm_seed")


def changed(index, lens=HELIAR, **values):
    surfaces = list(lens.surfaces)
    surfaces[index] = dataclasses.replace(surfaces[index], **values)
    return dataclasses.replace(lens, surfaces=tuple(surfaces))


def scaled(lens, factor, of="semi_aperture"):
    surfaces = tuple(dataclasses.replace(s, **{of: factor * getattr(s, of)}) for s in lens.surfaces)
    return dataclasses.replace(lens, surfaces=surfaces)


def kinds(lens):
    return [found.kind for found in lint.findings(lens)]


@pytest.mark.parametrize("name", presets.names("lenses"))
def test_shipped_lenses_have_no_mistake_but_wide_rims(name):
    """Rims of some published tables cross: their semi-apertures are rounded up or placeholders."""
    found = {found for found in kinds(flare.load(name)) if found != "edge"}
    assert found == ({"focal-length"} if name in INTERPOLATED else set())


@pytest.mark.parametrize("name", ["heliar_tronnier_100mm", "nikkor_50mm_f1_2", "zeiss_biotar_50mm"])
def test_every_wrong_sign_of_a_strong_surface_is_named(name):
    lens = flare.load(name)
    for k, surface in enumerate(lens.surfaces):
        wrong = changed(k, lens, curvature=-surface.curvature)
        if abs(paraxial.focal_length(wrong) / lens.focal_length - 1) < 0.04:
            continue
        found = lint.findings(wrong)
        assert found[0].kind == "focal-length"
        assert k + 1 in [said.surface for said in found if said.kind == "sign"]


def test_a_sensor_off_the_focus_is_found():
    lens = changed(8, thickness=HELIAR.sensor_distance + 2e-3)
    assert [found.text for found in lint.findings(lens)] == [
        "the sensor stands 2 mm behind the focus at 81.315 mm"
    ]
    lens = changed(8, thickness=HELIAR.sensor_distance - 1e-3)
    assert "1 mm before the focus" in lint.findings(lens)[0].text


def test_diameters_for_radii_and_halves_are_found():
    assert [found.text for found in lint.findings(scaled(HELIAR, 2.0)) if found.kind != "edge"] == [
        "semi-apertures look like diameters: they give f/1.72, stated is f/3.5"
    ]
    assert kinds(scaled(HELIAR, 0.5)) == ["semi-aperture"]


def test_bare_rear_sides_and_coated_cement_are_found():
    fronts = HELIAR
    for k, surface in enumerate(HELIAR.surfaces):
        if surface.glass is flare.AIR:
            fronts = changed(k, fronts, coating=None)
    assert [found.text for found in lint.findings(fronts)] == [
        "all 3 surfaces from glass to air are bare, those from air to glass are not"
    ]
    doubled = flare.with_coating(HELIAR, [flare.quarter_wave(1.38, 620e-9)], cemented=True)
    assert [found.surface for found in lint.findings(doubled)] == [2, 8]
    assert kinds(flare.with_coating(HELIAR, ())) == []


def test_a_wrong_unit_is_found():
    lens = dataclasses.replace(HELIAR, focal_length=HELIAR.focal_length * 25.4)
    said = [found.text for found in lint.findings(lens) if found.kind == "unit"]
    assert said == ["lengths are off by a factor of 25.4: inches for millimetres?"]


def test_rims_that_cross_are_found():
    lens = changed(2, thickness=0.5e-3)
    assert ("edge", 3) in [(found.kind, found.surface) for found in lint.findings(lens)]


def test_a_plate_has_no_focus():
    flat = HELIAR
    for k in range(len(HELIAR.surfaces)):
        flat = changed(k, flat, curvature=0.0)
    said = [found.text for found in lint.findings(flat)]
    assert "focal length is stated as 100 mm, the surfaces give none: the lens is afocal" in said
    assert "there is no focus" in said
