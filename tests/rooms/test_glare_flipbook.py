"""Flipbooks: frames are exact at their nodes and blended between them; files give them back."""

import json
import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from eye_patterns import NODES, SHARES, lights, patterns

from aureole import glare, refuse
from aureole.glare import (
    FRAMES,
    Eye,
    EyeState,
    RealTimeGlare,
    load_flipbooks,
    make_flipbooks,
    make_flipbooks_stages,
    save_flipbooks,
)
from aureole.glare.flipbook import RANGES
from aureole.glare.glare_frames import GlareFrames

SHAPE, FIELD = (20, 31), math.radians(40)
STATE = EyeState(pupil_diameter=6e-3, vitreous_angle=0.1, lid_opening=0.6)


@pytest.fixture(scope="module")
def flipbooks():
    return make_flipbooks(shape=SHAPE, field_of_view=FIELD, frames=NODES, patterns=patterns(SHAPE))


def mixed(flipbooks, state):
    return dict(flipbooks.mix(state))


def test_weights_are_the_shares_of_the_light(flipbooks):
    state = replace(STATE, pupil_diameter=8e-3, lid_opening=1.0)
    found = mixed(flipbooks, state)
    assert math.fsum(found.values()) == pytest.approx(1, abs=1e-12)
    for name, share in SHARES.items():
        book = flipbooks.books[name]
        part = [w for place, w in found.items() if book.first <= place < book.first + len(book.shares)]
        assert math.fsum(part) == pytest.approx(share, rel=1e-9), name


def test_at_a_node_one_frame_of_each_component_counts(flipbooks):
    state = EyeState(pupil_diameter=8e-3, vitreous_angle=0.0, lid_opening=1.0)
    assert len(mixed(flipbooks, state)) == 4
    assert len(mixed(flipbooks, replace(state, pupil_diameter=7e-3))) == 2 + 2 + 2 + 1


def test_between_nodes_frames_are_blended_by_straight_lines(flipbooks):
    picture, live = lights(SHAPE), RealTimeGlare(flipbooks, border="lose")
    state = replace(STATE, pupil_diameter=8e-3)
    ends = [live(picture, replace(state, vitreous_angle=angle)) for angle in (0.0, 0.1)]
    middle = live(picture, replace(state, vitreous_angle=0.025))
    wanted = 0.75 * ends[0] + 0.25 * ends[1]
    glare = np.sqrt(np.mean((wanted - picture) ** 2))
    assert np.sqrt(np.mean((middle - wanted) ** 2)) < 2e-4 * glare
    assert np.sqrt(np.mean((ends[0] - ends[1]) ** 2)) > 5e-3 * glare


@pytest.mark.parametrize("field", ["pupil_diameter", "vitreous_angle", "lid_opening"])
def test_beyond_its_ends_an_axis_stays_at_its_last_frame(flipbooks, field):
    low, high = {"pupil_diameter": (1e-3, 2e-3), "vitreous_angle": (-3, -0.1), "lid_opening": (0, 0.2)}[field]
    assert mixed(flipbooks, replace(STATE, **{field: low})) == mixed(
        flipbooks, replace(STATE, **{field: high})
    )


def test_motion_is_continuous(flipbooks):
    """A hundredth of the way between nodes changes the frame by a hundredth of their difference, no more."""
    picture, live = lights(SHAPE), RealTimeGlare(flipbooks, border="lose")
    angles = np.linspace(-0.12, 0.12, 121)
    found = np.stack([live(picture, replace(STATE, vitreous_angle=float(a))) for a in angles])
    steps = np.abs(np.diff(found, axis=0)).mean(axis=(1, 2, 3))
    whole = np.abs(found[0] - found[60]).mean()
    assert steps.max() < 2.5 * whole / 50


def test_closed_lids_let_nothing_through_and_open_ones_nearly_all(flipbooks):
    shares = [flipbooks.open_share(replace(STATE, lid_opening=lids)) for lids in np.linspace(0, 1, 21)]
    assert shares[0] == 0
    assert all(b >= a for a, b in pairwise(shares))
    assert shares[-1] > 0.98
    # Between nodes, too, it is what is measured on the parts themselves.
    half = replace(STATE, lid_opening=0.38, pupil_diameter=3e-3)
    assert flipbooks.open_share(half) == pytest.approx(glare.open_share(half), abs=0.03)


def test_the_halo_starts_where_the_pupil_reaches_the_fibres():
    make = patterns(SHAPE)
    few = {name: axes for name, axes in NODES.items() if name != "halo"}
    for annulus in ((1.5e-3, 3e-3), (2.25e-3, 4e-3)):
        found = make_flipbooks(Eye(fibre_annulus=annulus), SHAPE, FIELD, frames=few, patterns=make)
        ((axis, nodes),) = found.books["halo"].axes
        assert axis == "pupil_diameter"
        assert nodes[0] == pytest.approx(2 * annulus[0])
        assert nodes[-1] == 8e-3


def test_the_default_frames_of_the_thesis_window_fit_in_400_megabytes():
    count = 0
    for axes in FRAMES.values():
        count += math.prod(nodes if isinstance(nodes, int) else len(nodes) for nodes in axes.values())
    one = GlareFrames.empty((512, 910), math.radians(60), "full", 1).nbytes
    assert one * count < 400e6
    half = GlareFrames.empty((512, 910), math.radians(60), "half", 1).nbytes
    assert half * count < 115e6


def test_every_axis_is_a_field_of_the_state():
    for axes in FRAMES.values():
        assert set(axes) <= set(RANGES)
    for axis, (low, high) in RANGES.items():
        assert low < high
        assert hasattr(STATE, axis)


def test_the_last_stage_is_the_flipbooks(flipbooks):
    stages = list(
        make_flipbooks_stages(shape=SHAPE, field_of_view=FIELD, frames=NODES, patterns=patterns(SHAPE))
    )
    assert [stage.fraction for stage in stages] == sorted(stage.fraction for stage in stages)
    assert stages[-1].fraction == 1
    assert all(stage.result is None for stage in stages[:-1])
    np.testing.assert_array_equal(stages[-1].result.frames.kernels.spectra, flipbooks.frames.kernels.spectra)


def test_a_file_gives_the_flipbooks_back(flipbooks, tmp_path):
    path = tmp_path / "eye.npz"
    save_flipbooks(flipbooks, path)
    found, picture = load_flipbooks(path), lights(SHAPE)
    assert found.eye == flipbooks.eye
    assert found.nbytes == flipbooks.nbytes
    np.testing.assert_array_equal(
        RealTimeGlare(found)(picture, STATE), RealTimeGlare(flipbooks)(picture, STATE)
    )
    assert found.open_share(STATE) == flipbooks.open_share(STATE)
    assert [entry.name for entry in tmp_path.iterdir()] == ["eye.npz"]


def test_an_eye_with_zernike_terms_comes_back(tmp_path):
    eye = Eye(age=70, zernike={"coma-x": 4e-8, (4, 0): 2e-8})
    whole = make_flipbooks(eye, SHAPE, FIELD, frames=NODES, patterns=patterns(SHAPE))
    assert not whole.frames.kernels.is_even
    save_flipbooks(whole, tmp_path / "a.npz")
    assert load_flipbooks(tmp_path / "a.npz").eye == eye


def test_files_that_hold_no_flipbooks_are_refused(flipbooks, tmp_path):
    with pytest.raises(refuse.Refusal, match="There is no file"):
        load_flipbooks(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("no archive")
    with pytest.raises(refuse.Refusal, match="holds no flipbooks"):
        load_flipbooks(tmp_path / "text.npz")
    np.savez(tmp_path / "other.npz", head=np.array(json.dumps({"version": 1})))
    with pytest.raises(refuse.Refusal, match="holds no flipbooks"):
        load_flipbooks(tmp_path / "other.npz")
    save_flipbooks(flipbooks, tmp_path / "whole.npz")
    (tmp_path / "cut.npz").write_bytes((tmp_path / "whole.npz").read_bytes()[:5000])
    with pytest.raises(refuse.Refusal, match="holds no flipbooks"):
        load_flipbooks(tmp_path / "cut.npz")
    with pytest.raises(refuse.Refusal, match=r"must end in '\.npz'"):
        save_flipbooks(flipbooks, tmp_path / "eye.exr")


def test_more_than_fits_into_memory_is_refused_before_the_work():
    with pytest.raises(refuse.Refusal, match=r"60 patterns for 40000 x 30000 pixels\) need .* GB of memory"):
        make_flipbooks(shape=(30000, 40000), field_of_view=FIELD)


@pytest.mark.parametrize(
    ("frames", "words"),
    [
        ({"blom": {"pupil_diameter": 2}}, "'frames' must be one of"),
        ({"bloom": {"pupil": 2}}, "'axis of 'frames'' must be one of|'pupil_diameter'"),
        ({"bloom": {"pupil_diameter": 0}}, "must be an integer >= 1, got 0"),
        ({"bloom": {"pupil_diameter": (3e-3, 2e-3)}}, "must rise, got 0.003, 0.002"),
        ({"bloom": {"pupil_diameter": ()}}, "must rise"),
    ],
)
def test_refusals(frames, words):
    with pytest.raises(refuse.Refusal, match=words):
        make_flipbooks(shape=SHAPE, field_of_view=FIELD, frames=frames, patterns=patterns(SHAPE))
