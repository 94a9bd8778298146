"""Lights through a shot: each keeps its number while it moves, hides, meets others, and the camera turns."""

import json

import numpy as np
import pytest

from aureole import glare, refuse
from aureole.glare import Lamp, LampList, Sighting


def lamp(x, y, flux=100.0, half=3, colour=(1.0, 1.0, 1.0)):
    x, y = float(x), float(y)
    box = (int(x) - half, int(y) - half, int(x) + half + 1, int(y) + half + 1)
    return Lamp((x, y), flux, colour, 2.0 * half, box, flux / 10)


def ids(sightings, frame):
    return [seen.id for seen in sightings if seen.frame == frame]


def test_a_light_that_crosses_the_frame_keeps_its_number():
    frames = [(n, [lamp(5 + 20 * n, 30 + 3 * n)]) for n in range(1, 40)]
    assert {seen.id for seen in glare.track_lamps(frames)} == {1}


def test_lights_that_cross_do_not_swap():
    frames = [(n, [lamp(10 + 4 * n, 50), lamp(250 - 4 * n, 53)]) for n in range(1, 60)]
    # The order in which lights are found says nothing.
    frames = [(n, lamps[:: 1 if n % 3 else -1]) for n, lamps in frames]
    found = glare.track_lamps(frames)
    first = {seen.id: seen.lamp.place[1] for seen in found if seen.frame == 1}
    assert all(seen.lamp.place[1] == first[seen.id] for seen in found)
    assert len(first) == 2


def test_a_hidden_light_keeps_its_number_for_so_many_frames():
    def frames(gap):
        return [(n, [] if 20 <= n < 20 + gap else [lamp(10 + 6 * n, 40)]) for n in range(1, 60)]

    assert {seen.id for seen in glare.track_lamps(frames(5), patience=5)} == {1}
    assert {seen.id for seen in glare.track_lamps(frames(6), patience=5)} == {1, 2}


def test_births_are_numbered_in_order_and_short_ones_can_be_left_out():
    frames = [
        (1, [lamp(50, 50)]),
        (2, [lamp(51, 50), lamp(200, 90, 30)]),
        (3, [lamp(52, 50), lamp(300, 10, 50)]),
        (4, [lamp(53, 50), lamp(300, 10, 50)]),
    ]
    found = glare.track_lamps(frames)
    assert [ids(found, n) for n in (1, 2, 3, 4)] == [[1], [1, 2], [1, 3], [1, 3]]
    assert {seen.id for seen in glare.track_lamps(frames, least=2)} == {1, 3}


def test_a_turn_of_the_camera_moves_all_together():
    """A jerk further than the lights stand apart would swap all numbers, were each looked for alone."""
    generator = np.random.default_rng(7)
    places = generator.uniform(100, 900, (12, 2))
    fluxes = np.geomspace(20, 4000, 12)
    jerks = {1: (0, 0), 2: (0, 0), 3: (70, -40), 4: (70, -40), 5: (-90, 15)}
    frames = [
        (n, [lamp(x + jerk[0], y + jerk[1], flux) for (x, y), flux in zip(places, fluxes, strict=True)])
        for n, jerk in jerks.items()
    ]
    found = glare.track_lamps(frames)
    assert len({seen.id for seen in found}) == 12
    for number in range(1, 13):
        assert len({seen.lamp.flux for seen in found if seen.id == number}) == 1


def test_lights_that_run_together_part_as_the_two_that_they_were():
    frames = []
    for n in range(1, 61):
        one, other = lamp(100 + 3 * n, 60, 400), lamp(280 - 3 * n, 62, 150)
        if abs(one.place[0] - other.place[0]) > 10:
            frames.append((n, [one, other]))
            continue
        flux = one.flux + other.flux
        middle = [(one.flux * p + other.flux * q) / flux for p, q in zip(one.place, other.place, strict=True)]
        frames.append((n, [lamp(*middle, flux, half=8)]))
    found = glare.track_lamps(frames)
    assert {seen.id for seen in found} == {1, 2}
    joined = [seen for seen in found if seen.merged]
    assert joined
    assert all(seen.id == 1 and seen.merged == (2,) for seen in joined)
    assert all(seen.lamp.flux == {1: 400, 2: 150}[seen.id] for seen in found if not seen.merged)


def test_every_light_of_a_frame_has_one_number_of_its_own():
    generator = np.random.default_rng(11)
    for seed in range(5):
        frames = [
            (n, [lamp(*generator.uniform(0, 120, 2), generator.uniform(1, 50)) for _ in range(9)])
            for n in range(1, 12)
        ]
        found = glare.track_lamps(frames)
        assert len(found) == 99
        for n in range(1, 12):
            assert len(set(ids(found, n))) == 9, seed


def test_a_fading_light_stays_itself():
    """As behind a railing: the flux goes from all to a hundredth and back within a few frames."""
    frames = [(n, [lamp(10 + 8 * n, 40, 100 * (0.505 + 0.495 * np.cos(n)))]) for n in range(1, 50)]
    assert {seen.id for seen in glare.track_lamps(frames)} == {1}


def test_files_come_back_as_they_were(tmp_path):
    seen = (
        Sighting(None, 1, lamp(5.25, 7.125)),
        Sighting(1001, 2, lamp(-3, 8, 2.5, colour=(1.5, 0.9, 0.1)), (3, 4)),
        Sighting(1002, 2, lamp(-2, 8, 2.5)),
    )
    given = LampList(seen, (1080, 1920), "acescg", 12.5, (1001, 1002, 1003), 3)
    glare.write_lamps(tmp_path / "a.jsonl", given)
    assert glare.read_lamps(tmp_path / "a.jsonl") == given
    assert [one.id for one in given.at(1001)] == [1, 2]
    assert [one.id for one in given.at(1003)] == [1]


def test_files_written_by_hand_need_places_only(tmp_path):
    path = tmp_path / "hand.jsonl"
    path.write_text('{"x": 3, "y": 4}\n\n{"x": 5, "y": 6.5, "flux": 20, "frame": 7}\n', encoding="utf-8")
    found = glare.read_lamps(path)
    assert [(seen.frame, seen.id, seen.lamp.place, seen.lamp.flux) for seen in found.sightings] == [
        (None, 1, (3.0, 4.0), 0.0),
        (7, 1, (5.0, 6.5), 20.0),
    ]
    assert found.shape is None


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("{", "line 2: must be a JSON object"),
        ("[1, 2]", "line 2: must be a JSON object"),
        ({"x": 3}, "line 2: 'y' is missing"),
        ({"x": 3, "y": "a"}, "line 2: y' must be a finite number, got 'a'"),
        ({"x": 3, "y": 4, "flux": 0}, "line 2: flux' must be a finite number > 0, got 0"),
        ({"x": 3, "y": 4, "flxu": 1}, "line 2 has no 'flxu'. Did you mean 'flux'"),
        ({"x": 3, "y": 4, "frame": 1.5}, "line 2: frame' must be an integer >= 0"),
        ({"x": 3, "y": 4, "colour": [1, 2]}, "line 2: 'colour' must be a list of 3 numbers"),
        ({"x": 3, "y": 4, "box": [1, 2, 3, 0.5]}, "line 2: box' must be an integer"),
        ({"x": 3, "y": 4, "size": -1}, "line 2: size' must be a number from 0"),
        ({"lamps": 1}, "line 2 has no 'lamps'"),
    ],
)
def test_a_line_that_is_no_light_is_named(line, words, tmp_path):
    path = tmp_path / "bad.jsonl"
    text = line if isinstance(line, str) else json.dumps(line)
    path.write_text(f'{{"x": 1, "y": 2}}\n{text}\n', encoding="utf-8")
    with pytest.raises(refuse.Refusal, match=words):
        glare.read_lamps(path)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ({"lamps": 2}, "reads lamps 1, got 2"),
        ({"lamps": 1, "width": 20}, "line 1: 'height' is missing"),
        ({"lamps": 1, "colour_space": "srgb"}, "line 1: colour_space' must be one of"),
        ({"lamps": 1, "thresh": 3}, "line 1 has no 'thresh'. Did you mean 'threshold'"),
    ],
)
def test_a_first_line_that_cannot_be_served_is_refused(line, words, tmp_path):
    path = tmp_path / "bad.jsonl"
    path.write_text(json.dumps(line) + "\n", encoding="utf-8")
    with pytest.raises(refuse.Refusal, match=words):
        glare.read_lamps(path)


def test_refusals(tmp_path):
    with pytest.raises(refuse.Refusal, match="'frame' must be above 3, got 3"):
        glare.track_lamps([(3, []), (3, [])])
    with pytest.raises(refuse.Refusal, match="'reach' must be a finite number > 0"):
        glare.LampTracker(reach=0)
    with pytest.raises(refuse.Refusal, match="'patience' must be an integer >= 0"):
        glare.LampTracker(patience=-1)
    with pytest.raises(refuse.Refusal, match="'least' must be an integer >= 1"):
        glare.track_lamps([], least=0)
    with pytest.raises(refuse.Refusal, match="cannot be read: No such file"):
        glare.read_lamps(tmp_path / "none.jsonl")
    (tmp_path / "bytes.jsonl").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(refuse.Refusal, match="it is no text"):
        glare.read_lamps(tmp_path / "bytes.jsonl")


def test_lights_of_a_proxy_stand_in_the_full_picture():
    given = LampList((Sighting(1, 4, lamp(100.5, 50.25, 10.0)),), (540, 960), "rec709", 2.0, (1,))
    (seen,) = given.scaled_to((1080, 1920)).sightings
    assert seen.lamp.place == (201.0, 100.5)
    assert seen.lamp.flux == 40.0
    assert seen.lamp.size == 12.0
    assert seen.lamp.box == (194, 94, 208, 108)
    assert given.scaled_to((540, 960)) is given
    with pytest.raises(refuse.Refusal, match="960 x 540 pixels, whose proportions 1920 x 1200"):
        given.scaled_to((1200, 1920))
