"""The convolution's doors: methods agree, shapes and types come out as promised, refusals say why."""

import numpy as np
import pytest
import scipy.signal

from aureole import refuse
from aureole.picture import convolution

SINGLE = 2e-6  # of the largest value, over all shapes here
DOUBLE = 1e-14

SHAPES = [
    # picture, kernel: odd and even, one sample, one row, larger kernels, sizes of every radix
    ((1, 1), (1, 1)),
    ((1, 1), (4, 5)),
    ((1, 9), (1, 4)),
    ((9, 1), (3, 3)),
    ((1, 300), (1, 601)),
    ((8, 8), (8, 8)),
    ((8, 9), (9, 8)),
    ((9, 8), (8, 9)),
    ((9, 9), (9, 9)),
    ((7, 10), (2, 2)),
    ((7, 10), (3, 1)),
    ((12, 15), (40, 31)),
    ((15, 12), (33, 50)),
    ((130, 140), (5, 6)),
    ((129, 35), (33, 69)),
    ((257, 20), (256, 7)),
]


def random_pair(shape, kernel_shape, channels=2, seed=5):
    generator = np.random.default_rng(seed)
    picture = generator.random((*shape, channels), dtype=np.float32)
    kernel = generator.standard_normal((*kernel_shape, channels)).astype(np.float32)
    return picture, kernel


def direct(picture, kernel):
    """The whole convolution by SciPy's direct sum, of which the part round the centre is kept."""
    layers = []
    for channel in range(picture.shape[2]):
        response = kernel[:, :, min(channel, kernel.shape[2] - 1)].astype(np.float64)
        whole = scipy.signal.convolve(picture[:, :, channel].astype(np.float64), response, method="direct")
        top, left = kernel.shape[0] // 2, kernel.shape[1] // 2
        layers.append(whole[top : top + picture.shape[0], left : left + picture.shape[1]])
    return np.stack(layers, axis=2)


@pytest.mark.parametrize(("shape", "kernel_shape"), SHAPES)
@pytest.mark.parametrize("method", convolution.METHODS)
def test_every_method_is_the_direct_sum(method, shape, kernel_shape):
    picture, kernel = random_pair(shape, kernel_shape)
    wanted = direct(picture, kernel)
    found = convolution.convolve(picture, kernel, method)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, wanted, rtol=0, atol=SINGLE * np.abs(wanted).max())


@pytest.mark.parametrize(("shape", "kernel_shape"), [((9, 8), (8, 9)), ((31, 70), (70, 31))])
def test_double_precision_on_request(shape, kernel_shape):
    picture, kernel = random_pair(shape, kernel_shape)
    wanted = direct(picture, kernel)
    found = convolution.convolve(picture, kernel, "fft", precision="double")
    assert found.dtype == np.float64
    np.testing.assert_allclose(found, wanted, rtol=0, atol=DOUBLE * np.abs(wanted).max())


@pytest.mark.parametrize("n", range(1, 25))
@pytest.mark.parametrize("k", [1, 2, 3, 4, 7, 8, 23, 24, 25, 49, 60])
def test_wrapping_round_never_reaches_the_kept_part(n, k):
    picture, kernel = random_pair((n, 3), (k, 2), 1)
    wanted = direct(picture, kernel)
    found = convolution.convolve(picture, kernel, "fft")
    np.testing.assert_allclose(found, wanted, rtol=0, atol=SINGLE * np.abs(wanted).max())


@pytest.mark.parametrize(("shape", "kernel_shape"), [((40, 51), (33, 20)), ((6, 7), (30, 31))])
def test_a_prepared_kernel_gives_the_same_to_the_last_bit(shape, kernel_shape):
    picture, kernel = random_pair(shape, kernel_shape, 3)
    prepared = convolution.Convolver(kernel, shape)
    for frame in (picture, picture[::-1].copy()):
        np.testing.assert_array_equal(prepared(frame), convolution.convolve(frame, kernel, "fft"))


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_the_number_of_threads_changes_nothing(threads):
    picture, kernel = random_pair((300, 40), (31, 30))
    wanted = convolution.convolve(picture, kernel, "fft", threads=1)
    np.testing.assert_array_equal(convolution.convolve(picture, kernel, "fft", threads=threads), wanted)


@pytest.mark.parametrize("method", convolution.METHODS)
def test_one_channel_of_the_kernel_serves_all(method):
    picture, kernel = random_pair((20, 30), (9, 8), 3)
    one = kernel[:, :, 0]
    each = convolution.convolve(picture, np.repeat(one[:, :, None], 3, axis=2), method)
    np.testing.assert_array_equal(convolution.convolve(picture, one, method), each)
    np.testing.assert_array_equal(convolution.convolve(picture, one[:, :, None], method), each)


def test_a_prepared_kernel_of_one_channel_serves_any_number():
    picture, kernel = random_pair((20, 30), (9, 8), 3)
    prepared = convolution.Convolver(kernel[:, :, 0], picture.shape)
    assert prepared(picture).shape == (20, 30, 3)
    np.testing.assert_array_equal(prepared(picture[:, :, 1]), prepared(picture)[:, :, 1])


@pytest.mark.parametrize("method", ["auto", *convolution.METHODS])
def test_a_grey_picture_stays_two_dimensional(method):
    picture, kernel = random_pair((20, 30), (5, 5), 1)
    assert convolution.convolve(picture[:, :, 0], kernel[:, :, 0], method).shape == (20, 30)


@pytest.mark.parametrize("dtype", [np.float16, np.float64, np.uint8, bool])
def test_other_numbers_are_taken_too(dtype):
    picture = (np.random.default_rng(2).random((30, 20, 3)) * 200).astype(dtype)
    kernel = np.ones((3, 3))
    wanted = direct(picture.astype(np.float32), kernel[:, :, None])
    found = convolution.convolve(picture, kernel, "fft")
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, wanted, rtol=0, atol=SINGLE * wanted.max())


def test_pictures_need_not_lie_in_one_piece_and_are_not_written():
    picture, kernel = random_pair((50, 60), (11, 12), 4)
    colour = picture[::2, ::-1, :3]
    colour.flags.writeable = False
    before = colour.copy()
    found = convolution.convolve(colour, kernel[:, :, :3], "fft")
    np.testing.assert_array_equal(found, convolution.convolve(before, kernel[:, :, :3].copy(), "fft"))
    np.testing.assert_array_equal(colour, before)


def test_auto_takes_the_direct_sum_for_little_work():
    picture, kernel = random_pair((20, 30), (5, 5))
    wanted = convolution.convolve(picture, kernel, "reference")
    np.testing.assert_array_equal(convolution.convolve(picture, kernel), wanted)
    picture, kernel = random_pair((200, 300), (55, 55))
    wanted = convolution.convolve(picture, kernel, "fft")
    np.testing.assert_array_equal(convolution.convolve(picture, kernel), wanted)


@pytest.mark.parametrize(
    ("pixels", "kernel", "options", "message"),
    [
        (np.ones(5), np.ones((3, 3)), {}, "'pixels' must be an array of shape"),
        (np.ones((0, 5)), np.ones((3, 3)), {}, "'pixels' must be an array of shape"),
        (np.ones((5, 5)), np.ones((3, 0, 3)), {}, "'kernel' must be an array of shape"),
        (
            np.ones((5, 5, 3)),
            np.ones((3, 3, 2)),
            {},
            "'kernel' must have 1 channel or the picture's 3, got 2",
        ),
        (np.ones((5, 5)), np.ones((3, 3, 3)), {}, "'kernel' must have 1 channel or the picture's 1, got 3"),
        (np.ones((5, 5)), np.ones((3, 3)), {"method": "ftt"}, "Did you mean 'fft'"),
        (np.ones((5, 5)), np.ones((3, 3)), {"precision": "half"}, "'precision' must be one of"),
        (np.ones((5, 5)), np.ones((3, 3)), {"threads": 0}, "'threads' must be an integer >= 1"),
    ],
)
def test_refusals(pixels, kernel, options, message):
    with pytest.raises(refuse.Refusal, match=message):
        convolution.convolve(pixels, kernel, **options)


def test_a_prepared_kernel_refuses_other_sizes():
    prepared = convolution.Convolver(np.ones((3, 3, 3)), (8, 9))
    with pytest.raises(refuse.Refusal, match=r"'pixels' must be an array of shape \(8, 9, any\)"):
        prepared(np.ones((9, 8, 3)))
    with pytest.raises(refuse.Refusal, match="'kernel' must have 1 channel or the picture's 1"):
        prepared(np.ones((8, 9)))
    with pytest.raises(refuse.Refusal, match="'shape' must be an integer >= 1"):
        convolution.Convolver(np.ones((3, 3)), (0, 9))
