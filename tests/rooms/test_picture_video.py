"""Videos: read back with what was put in, whole or not there."""

import av
import numpy as np
import pytest

from aureole import Picture, Refusal, jobs, picture
from aureole.picture import video


def frames_of(path):
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        return [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)], stream.average_rate


def test_a_video_holds_every_picture_in_its_order_at_its_pace(tmp_path):
    path, greys = tmp_path / "a.mp4", np.linspace(0.1, 0.9, 9, dtype=np.float32)
    with picture.video_file(path, (48, 64), 12.5) as append:
        for grey in greys:
            append(np.full((48, 64, 3), grey, dtype=np.float32))
    shown, rate = frames_of(path)
    assert (len(shown), rate) == (9, 12.5)
    means = [frame.mean() / 255 for frame in shown]
    np.testing.assert_allclose(means, greys, atol=0.012)


@pytest.mark.parametrize(
    ("rate", "fraction"),
    [(24, (24, 1)), (29.97, (30000, 1001)), (23.976, (24000, 1001)), (23.98, (24000, 1001)), (12.5, (25, 2))],
)
def test_a_rate_is_the_fraction_that_videos_count_with(rate, fraction):
    assert video.frame_rate(rate).as_integer_ratio() == fraction


def test_colours_stay_what_they_were(tmp_path):
    path = tmp_path / "a.mp4"
    colours = np.array([[0.8, 0.1, 0.1], [0.1, 0.7, 0.2], [0.15, 0.2, 0.9], [0.5, 0.5, 0.5]], np.float32)
    pixels = np.repeat(np.repeat(colours[None], 32, axis=0), 32, axis=1).reshape(32, 128, 3)
    with picture.video_file(path, (32, 128), 24) as append:
        append(pixels)
    shown = frames_of(path)[0][0] / 255
    for k, colour in enumerate(colours):
        np.testing.assert_allclose(shown[8:24, 32 * k + 8 : 32 * k + 24].mean(axis=(0, 1)), colour, atol=0.02)


def test_odd_sizes_are_filled_up(tmp_path):
    with picture.video_file(tmp_path / "a.mp4", (33, 47), 24) as append:
        append(np.full((33, 47, 3), 0.5, dtype=np.float32))
    assert frames_of(tmp_path / "a.mp4")[0][0].shape == (34, 48, 3)


def test_a_video_that_fails_leaves_nothing(tmp_path):
    path = tmp_path / "a.mp4"
    pictures = [np.zeros((rows, 32, 3), dtype=np.float32) for rows in (32, 16)]
    with (
        pytest.raises(Refusal, match="'pixels' must be an array of shape"),
        picture.video_file(path, (32, 32), 24) as append,
    ):
        list(map(append, pictures))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("name", "rate", "said"), [("a.avi", 24, "must end in .mp4"), ("a.mp4", 0, "'fps'")])
def test_what_cannot_be_a_video_is_refused(tmp_path, name, rate, said):
    with pytest.raises(Refusal, match=said), picture.video_file(tmp_path / name, (32, 32), rate):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_sequence_is_shown_at_one_exposure(tmp_path):
    """A frame with twice the light is brighter, not brought to the same grey."""
    paths = []
    for k, level in enumerate((0.1, 0.2, 0.1)):
        paths.append(tmp_path / f"f.{k}.exr")
        picture.write(paths[-1], Picture(np.full((32, 32, 3), level, dtype=np.float32)))
    jobs.finish(jobs.video_stages(paths, tmp_path / "a.mp4", 24))
    means = [frame.mean() for frame in frames_of(tmp_path / "a.mp4")[0]]
    expected = 255 * picture.to_display(picture.read(paths[1]), np.log2(1.8)).mean()
    assert means[1] == pytest.approx(expected, abs=3)
    assert means[0] == pytest.approx(means[2], abs=2)
    assert means[1] > means[0] + 20
