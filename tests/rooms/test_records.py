"""Records: where a grid's samples lie, the pixel of a camera, records that stay as they are."""

import dataclasses

import numpy as np
import pytest

from aureole import Camera, Grid, aperture, records

RECORDS = [
    value for value in vars(records).values() if dataclasses.is_dataclass(value) and isinstance(value, type)
]


@pytest.mark.parametrize("rows", [1, 2, 3, 4, 7, 8])
@pytest.mark.parametrize("columns", [1, 2, 5, 6])
def test_the_centre_is_a_sample(rows, columns):
    y, x = Grid((rows, columns), (0.5, 0.25), (3.0, -2.0)).axes()
    assert (len(y), len(x)) == (rows, columns)
    assert y[rows // 2] == 3.0
    assert x[columns // 2] == -2.0


@pytest.mark.parametrize(
    ("count", "wanted"),
    [(1, [0]), (2, [-1, 0]), (3, [-1, 0, 1]), (4, [-2, -1, 0, 1]), (5, [-2, -1, 0, 1, 2])],
)
def test_samples_of_odd_and_even_sizes(count, wanted):
    y, x = Grid((count, count), (2.0, 0.5)).axes()
    np.testing.assert_array_equal(y, 2.0 * np.array(wanted))
    np.testing.assert_array_equal(x, 0.5 * np.array(wanted))
    assert y.dtype == x.dtype == np.float64


def test_axes_are_those_of_the_fft():
    """With spacing 1 / n the samples are numpy's own shifted frequencies."""
    for count in (8, 9):
        y, _ = Grid((count, 1), (1 / count, 1.0)).axes()
        np.testing.assert_allclose(y, np.fft.fftshift(np.fft.fftfreq(count)), rtol=0, atol=1e-16)


def test_grids_compare_by_value():
    assert Grid((2, 3), (1.0, 1.0)) == Grid((2, 3), (1.0, 1.0), (0.0, 0.0))
    assert Grid((2, 3), (1.0, 1.0)) != Grid((3, 2), (1.0, 1.0))


def test_pixel_pitch_is_rows_first():
    camera = Camera(50e-3, 16.0, 36e-3, 24e-3, (1000, 3000), aperture.circle(1e-3))
    assert camera.pixel_pitch == pytest.approx((24e-6, 12e-6), rel=1e-15)


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.__name__)
def test_records_are_frozen(record):
    made = object.__new__(record)
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(made, dataclasses.fields(record)[0].name, None)


def test_every_record_is_tried():
    assert len(RECORDS) >= 10
