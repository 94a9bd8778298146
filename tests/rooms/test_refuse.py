"""Refusals: what passes comes back, what does not is told in one line with the value."""

import math
import re

import numpy as np
import pytest

from aureole import refuse


def refused(message):
    """Expect a refusal of exactly this text."""
    return pytest.raises(refuse.Refusal, match=f"^{re.escape(message)}$")


@pytest.mark.parametrize("value", [1, 2.5, 1e-300, np.float32(0.5), np.int64(3)])
def test_positive_returns_a_float(value):
    found = refuse.positive("diameter", value)
    assert found == value
    assert type(found) is float


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0, "0"),
        (-1.25, "-1.25"),
        (-0.0, "-0"),
        (math.nan, "nan"),
        (math.inf, "inf"),
        (np.float32(-2), "-2"),
        (True, "True"),
        (None, "None"),
        ("3", "'3'"),
        (1j, "1j"),
    ],
)
def test_positive_refuses(value, shown):
    with refused(f"'diameter' must be a finite number > 0, got {shown}."):
        refuse.positive("diameter", value)


@pytest.mark.parametrize("value", [0, -3, 2.5, np.float64(-1e300)])
def test_finite_returns_a_float(value):
    found = refuse.finite("x", value)
    assert found == value
    assert type(found) is float


@pytest.mark.parametrize(
    ("value", "shown"), [(math.nan, "nan"), (-math.inf, "-inf"), (False, "False"), ("1", "'1'"), ([], "[]")]
)
def test_finite_refuses(value, shown):
    with refused(f"'x' must be a finite number, got {shown}."):
        refuse.finite("x", value)


@pytest.mark.parametrize("value", [0, 1, 0.5, np.float32(1)])
def test_between_allows_its_ends(value):
    found = refuse.between("curvature", value, 0, 1)
    assert found == value
    assert type(found) is float


@pytest.mark.parametrize(
    ("value", "shown"), [(-1e-9, "-1e-09"), (1.5, "1.5"), (math.nan, "nan"), (True, "True"), ("0", "'0'")]
)
def test_between_refuses(value, shown):
    with refused(f"'curvature' must be a number from 0 to 1, got {shown}."):
        refuse.between("curvature", value, 0, 1)


@pytest.mark.parametrize("value", [3, 4, np.int32(7), np.uint8(200)])
def test_at_least_returns_an_int(value):
    found = refuse.at_least("blades", value, 3)
    assert found == value
    assert type(found) is int


@pytest.mark.parametrize(
    ("value", "shown"), [(2, "2"), (-5, "-5"), (3.0, "3"), (True, "True"), ("3", "'3'"), (None, "None")]
)
def test_at_least_refuses(value, shown):
    with refused(f"'blades' must be an integer >= 3, got {shown}."):
        refuse.at_least("blades", value, 3)


def test_one_of_returns_the_word():
    assert refuse.one_of("mode", "add", ("replace", "add")) == "add"
    assert refuse.one_of("mode", "add", {"add": 1}) == "add"
    assert refuse.one_of("mode", "add", iter(["add"])) == "add"


@pytest.mark.parametrize(
    ("value", "end"),
    [
        ("replce", "got 'replce'. Did you mean 'replace'?"),
        ("zzz", "got 'zzz'."),
        ("ADD", "got 'ADD'."),
        (3, "got 3."),
        (["add"], "got ['add']. Did you mean 'add'?"),
    ],
)
def test_one_of_refuses_with_the_nearest(value, end):
    with refused(f"'mode' must be one of 'replace', 'add', {end}"):
        refuse.one_of("mode", value, ("replace", "add"))


def test_unknown_key_names_the_nearest_or_all():
    near = refuse.unknown_key("'my.toml'", "blade", ["rotation", "blades"])
    assert isinstance(near, refuse.Refusal)
    assert str(near) == "'my.toml' has no 'blade'. Did you mean 'blades'?"
    far = refuse.unknown_key("'my.toml'", "xyz", ["rotation", "blades"])
    assert str(far) == "'my.toml' has no 'xyz'. Known: blades, rotation."


def test_shape_of_returns_an_array():
    found = refuse.shape_of("points", [[1, 2], [3, 4], [5, 6]], (None, 2))
    np.testing.assert_array_equal(found, [[1, 2], [3, 4], [5, 6]])
    array = np.zeros((2, 3))
    assert refuse.shape_of("points", array, (2, 3)) is array


@pytest.mark.parametrize("shape", [(0, 2), (3, 3), (3,), (3, 2, 1), ()])
def test_shape_of_refuses(shape):
    with refused(f"'points' must be an array of shape (any, 2), got {shape}."):
        refuse.shape_of("points", np.zeros(shape), (None, 2))


@pytest.mark.parametrize("values", [[1.5, -2], [True], np.zeros((2, 0))])
def test_all_finite_returns_an_array(values):
    np.testing.assert_array_equal(refuse.all_finite("mask", values), np.asarray(values))


def test_all_finite_counts_what_is_not():
    with refused("'mask' must hold finite numbers, got 3 that are NaN or infinite."):
        refuse.all_finite("mask", [[1, math.nan, 3], [math.inf, -math.inf, 0]])


@pytest.mark.parametrize(("values", "kind"), [(["a"], "<U1"), ([None], "object")])
def test_all_finite_refuses_what_are_no_numbers(values, kind):
    with refused(f"'mask' must hold real numbers, got values of type {kind}."):
        refuse.all_finite("mask", values)


def test_a_refusal_is_a_value_error():
    assert issubclass(refuse.Refusal, ValueError)


def test_numbers_that_no_float_holds_are_refused():
    with pytest.raises(refuse.Refusal, match="'diameter' must be a finite number > 0"):
        refuse.positive("diameter", 10**400)


def test_ragged_and_complex_arrays_are_refused():
    with refused("'mask' must be an array; its rows have different lengths."):
        refuse.shape_of("mask", [[1, 2], [3]], (None, None))
    with refused("'mask' must hold real numbers, got values of type complex128."):
        refuse.all_finite("mask", np.ones((2, 2), dtype=complex))
