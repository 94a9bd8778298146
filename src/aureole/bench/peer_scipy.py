"""SciPy: padded real transforms, pruned to what is wanted, its own zoom transform, and convolutions."""

import importlib

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from aureole.bench import convolved
from aureole.bench.optics import Intensity, Irradiance, Optics, Plane
from aureole.bench.timing import workers

NAME, MODULE, PACKAGE = "SciPy", "scipy", "scipy"
LOOP = "SciPy ZoomFFT"
# Nothing in the loop is kept from one run to the next.
LOOP_KEEPS = False


def ways(optics: Optics) -> dict[str, Intensity]:
    """Return SciPy's ways to the intensity on the sensor.

    Parameters
    ----------
    optics : Optics
        Mask, lens and sensor.

    Returns
    -------
    dict
        Name to a function of the wavelength.
    """
    return {LOOP: lambda wavelength: _zoomed(optics, wavelength)}


def near_ways(plane: Plane) -> dict[str, Irradiance]:
    """Return SciPy's ways to the irradiance behind a mask, in single precision, in a frame twice as wide.

    Parameters
    ----------
    plane : Plane
        Mask and wavelength.

    Returns
    -------
    dict
        Name to a function of the distance.
    """
    return {
        "SciPy, impulse response": lambda z: _convolved(convolved.impulse_response, plane, z),
        "SciPy, the same by axes": lambda z: _convolved(convolved.impulse_response_by_axes, plane, z),
        "SciPy, transfer function": lambda z: _convolved(convolved.transfer_function, plane, z),
    }


def _convolved(way: convolved.Convolution, plane: Plane, distance: float) -> NDArray[np.floating]:
    field = way(plane.mask, plane.width, distance, plane.wavelength, 2)
    power: NDArray[np.floating] = field.real**2 + field.imag**2
    return power


def _zoomed(optics: Optics, wavelength: float) -> NDArray[np.floating]:
    size = optics.size
    step = optics.pitch / (wavelength * optics.focal_length) * optics.pixel
    band = [-(size // 2) * step, (size - size // 2) * step]
    # Imported late: it would slow every start of the command line down.
    zoom = importlib.import_module("scipy.signal").ZoomFFT(size, band, m=size, fs=1.0)
    with scipy.fft.set_workers(workers()):
        field = zoom(zoom(optics.mask, axis=1), axis=0)
    power: NDArray[np.floating] = (field.real**2 + field.imag**2) / wavelength**2
    return power


def padded_power(mask: NDArray[np.float32], finer: int) -> NDArray[np.float32]:
    """Return the power of a mask's DFT on a finer grid by padded real transforms.

    The best that padding can do: rows of zeros are not transformed, nor columns that are not wanted,
    and half of the plane follows from the other.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Even n.
    finer : int
        How much finer than the transform's own spacing the frequencies lie.

    Returns
    -------
    ndarray of float32, shape (n, n)
        Zero frequency at (n // 2, n // 2).
    """
    size = len(mask)
    half = size // 2 + 1
    across = scipy.fft.rfft(mask, n=finer * size, axis=1, workers=workers())[:, :half]
    whole = scipy.fft.fft(across, n=finer * size, axis=0, workers=workers())
    middle = size // 2
    # From here on, row r belongs to the frequency r − middle.
    kept = np.concatenate([whole[-middle:], whole[: middle + 1]])
    power = kept.real**2 + kept.imag**2
    out = np.empty((size, size), dtype=np.float32)
    out[:, middle:] = power[:size, :middle]
    out[:, :middle] = power[size:0:-1, middle:0:-1]
    return out


def real_power(mask: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the power of a mask's DFT by one real transform, mirrored to the full plane.

    Parameters
    ----------
    mask : ndarray of float32, shape (n, n)
        Any.

    Returns
    -------
    ndarray of float32, shape (n, n)
        Zero frequency first.
    """
    size = len(mask)
    half = scipy.fft.rfft2(mask, workers=workers())
    power = half.real**2 + half.imag**2
    whole = np.empty((size, size), np.float32)
    columns = power.shape[1]
    whole[:, :columns] = power
    whole[0, columns:] = power[0, size - columns : 0 : -1]
    whole[1:, columns:] = power[:0:-1, size - columns : 0 : -1]
    return whole
