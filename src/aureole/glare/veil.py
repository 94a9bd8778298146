"""Published glare functions of the human eye: how much of a point source's light goes where.

Each is the veiling luminance over the illuminance of the source at the eye, in 1 / steradian, as a function
of the angle between the source and the place that is looked at: a point spread function in angle, whose
integral over the hemisphere is about 1.

The age is in years. The pigment is the CIE's p: 0 for black, 0.5 for brown, 1 for green and 1.2 for light
blue irises.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from aureole import refuse

Veil = Callable[[NDArray[np.float64]], NDArray[np.float64]]
RIGHT_ANGLE = math.pi / 2
OLDEST, LIGHTEST = 120.0, 1.2
CIE_146_EQUATIONS = ("general", "small-angle")
# Spencer's shares of the four terms; scotopic vision lacks the cones' directional selectivity.
SPENCER_STATES = {
    "photopic": (0.384, 0.478, 0.138, 0.0),
    "mesopic": (0.368, 0.478, 0.138, 0.016),
    "scotopic": (0.282, 0.478, 0.207, 0.033),
}
# Adapting luminances in cd/m² between which vision is mesopic.
DARKEST_MESOPIC, BRIGHTEST_MESOPIC = 0.01, 3.0
# Integrals begin where every function here is flat; their range of log angle has PARTS parts of NODES nodes.
FLATTEST, PARTS, NODES = 1e-8, 64, 12


def cie_135(angle: ArrayLike, age: float = 35.0, pigment: float = 0.5) -> NDArray[np.float64]:
    """Return the CIE's total glare function, core and wings (CIE 135/1-1999, Vos and van den Berg).

    Parameters
    ----------
    angle : array_like
        Radians from the source, 0 or above.
    age : float
        Years.
    pigment : float
        p, 0 to 1.2.

    Returns
    -------
    ndarray of float64
        1 / steradian, of the angles' shape. The integral over the hemisphere is 1.00 to 1.03.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    t, p = _degrees(angle), refuse.between("pigment", pigment, 0, LIGHTEST)
    a = (_age(age) / 70) ** 4
    core = 9.2e6 / (1 + (t / 0.0046) ** 2) ** 1.5 + 1.5e5 / (1 + (t / 0.045) ** 2) ** 1.5
    slope = 1 + (t / 0.1) ** 2
    through_iris = p * (1300 / slope**1.5 + 0.8 / np.sqrt(slope))
    total = (1 - 0.08 * a) * core + (1 + 1.6 * a) * (400 / slope + 3e-8 * t**2 + through_iris) + 2.5e-3 * p
    return np.asarray(total / (1 + p * (0.0417 + 0.055 * a)))


def cie_146(
    angle: ArrayLike, age: float = 35.0, pigment: float = 0.5, equation: str = "general"
) -> NDArray[np.float64]:
    """Return the CIE's equations for disability glare (CIE 146:2002; Vos 2003).

    Parameters
    ----------
    angle : array_like
        Radians from the source, above 0. "general" is meant for 0.1 to 100 degrees, "small-angle" for
        0.1 to 30 degrees.
    age : float
        Years.
    pigment : float
        p, 0 to 1.2; "small-angle" has none.
    equation : {"general", "small-angle"}
        Which.

    Returns
    -------
    ndarray of float64
        1 / steradian, of the angles' shape.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    refuse.one_of("equation", equation, CIE_146_EQUATIONS)
    t, p = _degrees(angle, above_zero=True), refuse.between("pigment", pigment, 0, LIGHTEST)
    factor = 1 + (_age(age) / 62.5) ** 4
    if equation == "small-angle":
        return np.asarray(10 / t**3 + 5 / t**2 * factor)
    return np.asarray(10 / t**3 + (5 / t**2 + 0.1 * p / t) * factor + 2.5e-3 * p)


def stiles_holladay(angle: ArrayLike, age: float = 35.0) -> NDArray[np.float64]:
    """Return the Stiles-Holladay equation with the CIE's age factor (CIE 146:2002).

    Parameters
    ----------
    angle : array_like
        Radians from the source, above 0; meant for 1 to 30 degrees.
    age : float
        Years.

    Returns
    -------
    ndarray of float64
        1 / steradian, of the angles' shape.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    t = _degrees(angle, above_zero=True)
    return np.asarray(10 * (1 + (_age(age) / 70) ** 4) / t**2)


def spencer(
    angle: ArrayLike, luminance: float = 100.0, age: float | None = None, wavelength: float = 568e-9
) -> NDArray[np.float64]:
    """Return the point spread function of Spencer, Shirley, Zimmerman and Greenberg 1995 (after Vos 1984).

    Parameters
    ----------
    angle : array_like
        Radians from the source, 0 or above.
    luminance : float
        Adapting luminance in cd/m²: below 0.01 vision is scotopic, above 3 photopic, mesopic between them.
        `SPENCER_STATES` lists the shares of each.
    age : float, optional
        Years. It moves 6.9e-9 age⁴ of the core's share to the wings, as is printed for photopic vision;
        without it the shares are the printed ones.
    wavelength : float
        Metres; the lens's halo stands at 3 degrees at 568 nm, and follows the wavelength.

    Returns
    -------
    ndarray of float64
        1 / steradian, of the angles' shape.

    Raises
    ------
    refuse.Refusal
        Where a number is outside its range.
    """
    t = _degrees(angle)
    moved = 0.0 if age is None else 6.9e-9 * _age(age) ** 4
    core, cubic, square, halo = SPENCER_STATES[vision(luminance)]
    nanometres = refuse.positive("wavelength", wavelength) * 1e9
    total = max(core - moved, 0.0) * 2.61e6 * np.exp(-((t / 0.02) ** 2))
    total += cubic * 20.91 / (t + 0.02) ** 3 + (square + min(moved, core)) * 72.37 / (t + 0.02) ** 2
    ring = 436.9 * 568 / nanometres * np.exp(-19.75 * (t - 3 * nanometres / 568) ** 2)
    return np.asarray(total + halo * ring)


def vision(luminance: float) -> str:
    """Name the state of vision at an adapting luminance, as Spencer and others 1995 divide it.

    Parameters
    ----------
    luminance : float
        cd/m².

    Returns
    -------
    str
        "scotopic" below 0.01 cd/m², "photopic" above 3 cd/m², "mesopic" between them.

    Raises
    ------
    refuse.Refusal
        Where the luminance is not above zero.
    """
    level = refuse.positive("luminance", luminance)
    if level < DARKEST_MESOPIC:
        return "scotopic"
    return "photopic" if level > BRIGHTEST_MESOPIC else "mesopic"


def hemisphere_energy(veil: Veil, low: float = 0.0, high: float = RIGHT_ANGLE) -> float:
    """Return how much energy a glare function holds between two angles, ∫ 2π sin θ f(θ) dθ.

    Parameters
    ----------
    veil : callable
        Takes angles in radians, shape (N,), and returns 1 / steradian.
    low, high : float
        Radians; the whole hemisphere unless given.

    Returns
    -------
    float
        To 1e-9 of itself for the functions of this file: Gauss-Legendre nodes of the angle's logarithm.

    Raises
    ------
    refuse.Refusal
        Where the angles are not 0 to π/2, or the first is not below the second.
    """
    refuse.between("high", high, FLATTEST, RIGHT_ANGLE)
    if not refuse.between("low", low, 0, RIGHT_ANGLE) < high:
        raise refuse.Refusal(f"'low' must be less than 'high', got {low:g} and {high:g}.")
    start = max(low, FLATTEST)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    edges = np.linspace(math.log(start), math.log(high), PARTS + 1)
    half = (edges[1] - edges[0]) / 2
    angles = np.exp((edges[:-1] + half)[:, None] + half * nodes)
    rings = 2 * math.pi * np.sin(angles) * angles * veil(angles.ravel()).reshape(angles.shape)
    inner = math.pi * (start**2 - low**2) * float(veil(np.array([start]))[0])
    return float((rings * weights).sum() * half + inner)


def _degrees(angle: ArrayLike, above_zero: bool = False) -> NDArray[np.float64]:
    """Check angles in radians and return them in degrees."""
    radians = np.asarray(refuse.all_finite("angle", angle), dtype=np.float64)
    lowest = float(radians.min(initial=RIGHT_ANGLE))
    if lowest < 0 or (above_zero and lowest == 0):
        raise refuse.Refusal(f"'angle' must be {'> 0' if above_zero else '>= 0'}, got {lowest:g}.")
    return np.asarray(np.degrees(radians))


def _age(age: float) -> float:
    return refuse.between("age", age, 0, OLDEST)
