"""Lens files: read, written back, and hostile ones refused in one line."""

import dataclasses
import re

import pytest

from aureole import flare, presets, refuse
from aureole.flare import paraxial
from aureole.flare.prescription import travelling_layers

HEAD = 'title = "Mine"\nsource = "A drawing of mine"\nfocal_length_mm = 100\nf_number = 4\n'
GOOD = HEAD + (
    "coatings.single = [{ index = 1.38, quarter_wave_nm = 550 }]\n"
    "surfaces = [\n"
    '  { radius_mm = 103.4, thickness_mm = 5, glass = "N-BK7", semi_aperture_mm = 15, coating = "single" },\n'
    "  { radius_mm = -103.4, thickness_mm = 4, semi_aperture_mm = 15 },\n"
    "  { radius_mm = 0, thickness_mm = 95, semi_aperture_mm = 12, stop = true },\n"
    "]\n"
)


@pytest.fixture
def file_of(tmp_path):
    def write(text, name="mine.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


def refused(message):
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


def test_a_lens_of_ones_own(file_of):
    lens = flare.load(file_of(GOOD))
    assert lens.stop == 2
    assert (lens.focal_length, lens.f_number) == (0.1, 4.0)
    assert lens.sensor == pytest.approx((0.036, 0.024))
    first = lens.surfaces[0]
    assert first.curvature == pytest.approx(1 / 0.1034, rel=1e-14)
    assert first.glass is flare.named("N-BK7")
    assert first.coating.layers == (flare.quarter_wave(1.38, 550e-9),)
    assert lens.surfaces[1].glass is flare.AIR
    assert paraxial.focal_length(lens) == pytest.approx(0.1, rel=0.02)


@pytest.mark.parametrize("name", presets.names("lenses"))
def test_shipped_lenses_come_back_from_their_own_text(name, file_of):
    lens = flare.load(name)
    text = flare.to_toml(lens)
    again = flare.load(file_of(text))
    assert flare.to_toml(again) == text
    bare = dataclasses.replace(again, name=name)
    # A quarter wave is written as its thickness, to twelve digits.
    assert flare.with_coating(bare, ()) == flare.with_coating(lens, ())
    for one, other in zip(again.surfaces, lens.surfaces, strict=True):
        assert (one.coating is None) == (other.coating is None)
        if one.coating is not None:
            assert one.coating.layers[0].thickness == pytest.approx(other.coating.layers[0].thickness)


@pytest.mark.parametrize("name", presets.names("lenses"))
def test_shipped_lenses_say_what_they_are(name):
    lens = flare.load(name)
    assert lens.patent
    assert lens.status in ("patent", "textbook", "solved", "interpolated")
    assert len(lens.source) > 20
    # Cemented surfaces are bare; all others of a lens are coated, or none is (before 1935).
    outer = []
    for k, surface in enumerate(lens.surfaces):
        between = flare.AIR not in (lens.glass_before(k), surface.glass)
        if between or surface.stop:
            assert surface.coating is None
        else:
            outer.append(surface.coating is not None)
    assert len(set(outer)) == 1


def test_everything_a_file_may_hold_comes_back(file_of):
    text = GOOD.replace(
        "stop = true", 'stop = true, cylinder = "y", conic = -1.5, asphere_mm = [1e-6, -2e-9]'
    )
    text = text.replace("{ index = 1.38,", '{ glass = "MGF2", thickness_nm = 90 }, { index = 2.1,')
    text += '[[states]]\nname = "far"\nfocal_length_mm = 120\nthicknesses_mm = { 1 = 6, 3 = 90 }\n'
    lens = flare.load(file_of(text))
    stop = lens.surfaces[2]
    assert (stop.cylinder, stop.conic) == ("y", -1.5)
    # r⁴ in mm⁻³, r⁶ in mm⁻⁵.
    assert stop.asphere == pytest.approx((1e-6 * 1e9, -2e-9 * 1e15))
    assert [layer.glass.name for layer in lens.surfaces[0].coating.layers] == ["MGF2", ""]
    again = flare.to_toml(lens)
    assert flare.to_toml(flare.load(file_of(again))) == again
    far = flare.load(file_of(text), "far")
    assert far.surfaces[0].thickness == pytest.approx(6e-3)
    assert far.sensor_distance == pytest.approx(90e-3)
    assert (far.focal_length, far.f_number, far.states) == (0.12, 4.0, ())
    with refused(f"'{lens.name}' has no 'fer'. Did you mean 'far'?"):
        flare.at_state(lens, "fer")


@pytest.mark.parametrize(
    ("zoom", "state", "name"),
    [
        ("canon_tele_zoom_70mm", "135mm", "canon_tele_zoom_135mm"),
        ("canon_tele_zoom_70mm", "200mm", "canon_tele_zoom_200mm"),
        ("nikon_tele_zoom_80mm", "140mm", "nikon_tele_zoom_140mm_solved"),
        ("nikon_tele_zoom_80mm", "200mm", "nikon_tele_zoom_200mm"),
        ("itoh_wide_zoom_100mm", "123mm", "itoh_wide_zoom_123mm_solved"),
        ("itoh_wide_zoom_100mm", "146mm", "itoh_wide_zoom_146mm"),
    ],
)
def test_a_zoom_moved_is_the_lens_that_is_shipped_on_its_own(zoom, state, name):
    found, alone = flare.load(zoom, state), flare.load(name)
    assert found.surfaces == alone.surfaces != flare.load(zoom).surfaces
    assert (found.focal_length, found.f_number) == (alone.focal_length, alone.f_number)
    assert found.states == ()
    assert found.title.endswith(f", moved to {state}")


def test_every_position_of_every_shipped_zoom_is_in_focus():
    zooms = [flare.load(name) for name in presets.names("lenses")]
    states = [(lens, state.name) for lens in zooms for state in lens.states]
    assert len(states) == 6
    for lens, state in states:
        moved = flare.at_state(lens, state)
        assert paraxial.focal_length(moved) == pytest.approx(moved.focal_length, rel=0.01)
        assert paraxial.back_focus(moved) == pytest.approx(moved.sensor_distance, abs=1e-6)


def test_layers_are_met_from_the_side_of_the_lower_index(file_of):
    text = GOOD.replace(
        "quarter_wave_nm = 550 }", "quarter_wave_nm = 550 }, { index = 2.1, thickness_nm = 60 }"
    )
    text = text.replace("-103.4, thickness_mm = 4,", '-103.4, coating = "single", thickness_mm = 4,')
    lens = flare.load(file_of(text))
    listed = lens.surfaces[0].coating.layers
    assert travelling_layers(lens, 0) == travelling_layers(lens, 1, forward=False) == listed
    assert travelling_layers(lens, 1) == travelling_layers(lens, 0, forward=False) == listed[::-1]
    assert travelling_layers(lens, 2) == ()


def test_the_papers_way_coats_cemented_surfaces_too():
    lens = flare.load("heliar_tronnier_100mm")
    layers = [flare.quarter_wave(1.38, 620e-9)]
    without, with_them = flare.with_coating(lens, layers), flare.with_coating(lens, layers, cemented=True)
    assert sum(s.coating is not None for s in without.surfaces) == 6
    assert [s.coating is None for s in with_them.surfaces] == [s.stop for s in with_them.surfaces]
    assert all(s.coating is None for s in flare.with_coating(lens, ()).surfaces)


NAN = "'radius_mm' in surfaces 1 in '{}': input should be a finite number."


@pytest.mark.parametrize(
    ("find", "put", "message"),
    [
        (
            "thickness_mm = 5",
            "thickness_mm = -5",
            "'thickness_mm' in surfaces 1 in '{}': input should be greater than or equal to 0.",
        ),
        (
            "semi_aperture_mm = 15 }",
            "semi_aperture_mm = 104 }",
            "surface 2 of '{}': 'semi_aperture_mm' must be below its radius of curvature 103.4, got 104.",
        ),
        (
            "semi_aperture_mm = 15 }",
            "semi_aperture_mm = 60, conic = 3 }",
            "surface 2 of '{}': 'semi_aperture_mm' must be below the reach of its conic 51.7, got 60.",
        ),
        (
            "radius_mm = 103.4",
            "radius_mm = 1e-300",
            "surface 1 of '{}': 'radius_mm' must be 0 (a plane) or at least 0.0001 long.",
        ),
        (
            "thickness_mm = 4",
            "thickness_mm = 1e300",
            "'thickness_mm' in surfaces 2 in '{}': input should be less than or equal to 10000000.",
        ),
        ("radius_mm = 103.4", "radius_mm = nan", NAN),
        ("radius_mm = 103.4", "radius_mm = -inf", NAN),
        (", stop = true", "", "'{}' has no stop: give one surface 'stop = true'."),
        (
            "semi_aperture_mm = 15 }",
            "semi_aperture_mm = 15, stop = true }",
            "'{}' must have one stop, got 2: surfaces 2, 3.",
        ),
        (
            'glass = "N-BK7"',
            "index = 0.9",
            "'index' in surfaces 1 in '{}': input should be greater than or equal to 1.",
        ),
        (
            "radius_mm = 0",
            "raduis_mm = 0",
            "surfaces 3 in '{}' has no 'raduis_mm'. Did you mean 'radius_mm'?",
        ),
        (
            "thickness_mm = 5",
            "thickness_m = 5",
            "surfaces 1 in '{}' has no 'thickness_m'. Did you mean 'thickness_mm'?",
        ),
        (
            "thickness_mm = 5",
            'thickness_mm = "5mm"',
            "'thickness_mm' in surfaces 1 in '{}': input should be a valid number.",
        ),
        (
            'glass = "N-BK7"',
            'glass = "N-BK77"',
            "the catalogue of glasses has no 'N-BK77'. Did you mean 'N-BK7'?",
        ),
        (
            'glass = "N-BK7"',
            'glass = "N-BK7", index = 1.5',
            "surface 1 of '{}' has a 'glass' by name and numbers for it; give one of them.",
        ),
        ('glass = "N-BK7"', "abbe = 60", "surface 1 of '{}' has an 'abbe' number without an 'index'."),
        (
            'coating = "single"',
            'coating = "singel"',
            "the table of coatings for surface 1 of '{}' has no 'singel'. Did you mean 'single'?",
        ),
        ("{ index = 1.38, ", "{ ", "each layer of coating 'single' needs either 'index' or 'glass'."),
        (
            "quarter_wave_nm = 550 }",
            "quarter_wave_nm = 550, thickness_nm = 90 }",
            "each layer of coating 'single' needs either 'quarter_wave_nm' or 'thickness_nm'.",
        ),
        (
            "thickness_mm = 95",
            "thickness_mm = 0",
            "'{}' must end before the sensor: its last 'thickness_mm' must be > 0.",
        ),
        (
            "stop = true }",
            "stop = true, index = 1.5 }",
            "'{}' must end in air: its last surface has a glass behind it.",
        ),
        ('title = "Mine"', "", "'title' in '{}': field required."),
        (
            "f_number = 4",
            "f_number = 4\nsensor_mm = [36, -1]",
            "'sensor_mm 2' in '{}': input should be greater than 0.",
        ),
        (
            "f_number = 4",
            "f_number = 4\nstates = [{ name = 'a', focal_length_mm = 1, thicknesses_mm = { 4 = 1 } }]",
            "'thicknesses_mm' of state 'a' in '{}' must have the numbers of surfaces, 1 to 3, as keys, "
            "got '4'.",
        ),
    ],
)
def test_hostile_files_are_refused_in_one_line(file_of, find, put, message):
    assert find in GOOD
    path = file_of(GOOD.replace(find, put, 1))
    with refused(message.format(path)):
        flare.load(path)


def test_ten_thousand_surfaces_are_refused(file_of):
    line = "{ radius_mm = 50, thickness_mm = 1, semi_aperture_mm = 5 },\n"
    path = file_of(HEAD + "surfaces = [\n" + line * 10_000 + "]\n")
    with refused(f"'surfaces' in '{path}': list should have at most 200 items after validation, not 10000."):
        flare.load(path)


def test_unknown_lenses_are_refused_with_the_nearest():
    with refused("presets/lenses has no 'heliar_tronier_100mm'. Did you mean 'heliar_tronnier_100mm'?"):
        flare.load("heliar_tronier_100mm")


def test_a_lens_is_written_whole(tmp_path):
    lens = flare.load("cooke_triplet_100mm")
    flare.write(tmp_path / "triplet.toml", lens)
    assert [path.name for path in tmp_path.iterdir()] == ["triplet.toml"]
    assert flare.to_toml(flare.load(tmp_path / "triplet.toml")) == flare.to_toml(lens)
