"""One voice for refusals: what was asked, what is allowed, what was got.

Every check returns the value it was given, so that a caller can write
``diameter = refuse.positive("diameter", diameter)``. The message of a `Refusal` is one line for
the person at the keyboard; the command line prints it and exits with 2.
"""

import difflib
import math
from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import numpy as np

Choice = TypeVar("Choice", bound=str)


class Refusal(ValueError):
    """An input that cannot be served, said in one line for the person who gave it."""


def positive(name: str, value: float) -> float:
    """Refuse what is not a finite number above zero.

    Parameters
    ----------
    name : str
        The parameter's public name.
    value : float
        Its value.

    Returns
    -------
    float
        The value.

    Raises
    ------
    Refusal
        Where it is not a finite number above zero.
    """
    if not _is_finite(value) or value <= 0:
        raise Refusal(f"'{name}' must be a finite number > 0, got {_shown(value)}.")
    return float(value)


def finite(name: str, value: float) -> float:
    """Refuse what is not a finite number.

    Parameters
    ----------
    name : str
        The parameter's public name.
    value : float
        Its value.

    Returns
    -------
    float
        The value.

    Raises
    ------
    Refusal
        Where it is not a finite number.
    """
    if not _is_finite(value):
        raise Refusal(f"'{name}' must be a finite number, got {_shown(value)}.")
    return float(value)


def between(name: str, value: float, low: float, high: float) -> float:
    """Refuse a number outside a closed interval.

    Parameters
    ----------
    name : str
        The parameter's public name.
    value : float
        Its value.
    low, high : float
        The interval's ends, both allowed.

    Returns
    -------
    float
        The value.

    Raises
    ------
    Refusal
        Where it is not a number in the interval.
    """
    if not _is_finite(value) or not low <= value <= high:
        raise Refusal(f"'{name}' must be a number from {low:g} to {high:g}, got {_shown(value)}.")
    return float(value)


def at_least(name: str, value: int, smallest: int) -> int:
    """Refuse what is not a whole number of at least a smallest one.

    Parameters
    ----------
    name : str
        The parameter's public name.
    value : int
        Its value.
    smallest : int
        The smallest allowed.

    Returns
    -------
    int
        The value.

    Raises
    ------
    Refusal
        Where it is not an integer, or is smaller.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < smallest:
        raise Refusal(f"'{name}' must be an integer >= {smallest}, got {_shown(value)}.")
    return int(value)


def one_of(name: str, value: Choice, allowed: Iterable[Choice]) -> Choice:
    """Refuse a word that is not among the allowed ones, with the nearest of them.

    Parameters
    ----------
    name : str
        The parameter's public name.
    value : str
        Its value.
    allowed : iterable of str
        The words that are allowed.

    Returns
    -------
    str
        The value.

    Raises
    ------
    Refusal
        Where it is not among them.
    """
    words = list(allowed)
    if value not in words:
        listed = ", ".join(f"'{word}'" for word in words)
        raise Refusal(f"'{name}' must be one of {listed}, got {_shown(value)}.{_nearest(str(value), words)}")
    return value


def unknown_key(where: str, key: str, known: Iterable[str]) -> Refusal:
    """Make the refusal of a key that a file or table does not have.

    Parameters
    ----------
    where : str
        What was read: a file's name or "presets".
    key : str
        The unknown key.
    known : iterable of str
        The keys it could have been.

    Returns
    -------
    Refusal
        To be raised by the caller.
    """
    words = sorted(known)
    nearest = _nearest(key, words) or f" Known: {', '.join(words)}."
    return Refusal(f"{where} has no '{key}'.{nearest}")


def shape_of(name: str, array: Any, shape: tuple[int | None, ...]) -> np.ndarray:
    """Refuse an array whose shape does not fit.

    Parameters
    ----------
    name : str
        The parameter's public name.
    array : array_like
        Its value.
    shape : tuple of int or None
        The wanted shape; None stands for any length of at least one.

    Returns
    -------
    ndarray
        The value as an array.

    Raises
    ------
    Refusal
        Where the number of dimensions or a length differs.
    """
    found = _array(name, array)
    fits = found.ndim == len(shape) and all(
        have == want or (want is None and have > 0) for have, want in zip(found.shape, shape, strict=True)
    )
    if not fits:
        wanted = ", ".join("any" if length is None else str(length) for length in shape)
        raise Refusal(f"'{name}' must be an array of shape ({wanted}), got {found.shape}.")
    return found


def all_finite(name: str, array: Any) -> np.ndarray:
    """Refuse an array with NaN or infinity, saying how many there are.

    Parameters
    ----------
    name : str
        The parameter's public name.
    array : array_like
        Its value.

    Returns
    -------
    ndarray
        The value as an array.

    Raises
    ------
    Refusal
        Where any value is NaN or infinite, or the values are not numbers.
    """
    found = _array(name, array)
    if found.dtype.kind not in "buif":
        raise Refusal(f"'{name}' must hold real numbers, got values of type {found.dtype}.")
    # A finite sum has only finite terms, and takes a fraction of the time.
    with np.errstate(over="ignore", invalid="ignore"):
        if np.isfinite(found.sum()):
            return found
    bad = found.size - int(np.count_nonzero(np.isfinite(found)))
    if bad:
        raise Refusal(f"'{name}' must hold finite numbers, got {bad} that are NaN or infinite.")
    return found


def _is_finite(value: object) -> bool:
    """Return whether a value is a number that a float can hold."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def _array(name: str, array: Any) -> np.ndarray:
    try:
        return np.asarray(array)
    except ValueError:
        raise Refusal(f"'{name}' must be an array; its rows have different lengths.") from None


def _shown(value: object) -> str:
    if isinstance(value, str):
        return f"'{value}'"
    return f"{value:g}" if isinstance(value, float | np.floating) else str(value)


def _nearest(word: str, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f" Did you mean '{close[0]}'?" if close else ""
