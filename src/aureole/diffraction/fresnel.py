"""The Fresnel integrals, from tables: C(x) = ∫ cos(πt²/2) dt and S(x) = ∫ sin(πt²/2) dt from 0 to x.

They are what light does behind a straight edge (quad paper Eq. 23). With E = C + iS and w defined by
E(x) = (1 + i) / 2 − w(x) exp(iπx²/2) for x ≥ 0, w obeys w' = −1 − iπxw, so its Taylor polynomial about any
place follows from its value there. Beyond the table w is its asymptotic series (Abramowitz and Stegun,
7.3.27 and 7.3.28).
"""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import special

from aureole import refuse
from aureole.diffraction import _kernels_fresnel
from aureole.diffraction._kernels_fresnel import LAST, NODES
from aureole.diffraction._kernels_near import DEGREE, MIDDLE


def fresnel_integrals(x: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the Fresnel integrals C(x) and S(x), to 1e-9 absolute for every x.

    Parameters
    ----------
    x : array_like
        Real numbers, finite or infinite.

    Returns
    -------
    cosine, sine : ndarray of float64, shape of x
        C(x) and S(x); ±1/2 at ±infinity.

    Raises
    ------
    refuse.Refusal
        Where a value is NaN.
    """
    values = np.asarray(x, dtype=np.float64)
    if np.isnan(values).any():
        raise refuse.Refusal(f"'x' must hold numbers, got {np.count_nonzero(np.isnan(values))} that are NaN.")
    out = np.empty(values.size, dtype=np.complex128)
    _kernels_fresnel.integrals(np.ascontiguousarray(values).ravel(), taylor_table(), out)
    shaped = out.reshape(values.shape)
    return shaped.real.copy(), shaped.imag.copy()


@lru_cache(maxsize=1)
def taylor_table() -> NDArray[np.float64]:
    """Return the Taylor coefficients of w about each node, for the compiled loops.

    Returns
    -------
    ndarray of float64, shape (T, 12)
        Six real parts and six imaginary ones a node. Read only.
    """
    x = np.arange(int(LAST * NODES) + 1) / NODES
    sine, cosine = special.fresnel(x)
    w = (0.5 + 0.5j - cosine - 1j * sine) * np.exp(-0.5j * np.pi * x**2)
    # w' = −1 − iπxw, and (k + 1) a_{k+1} = −iπ (x a_k + a_{k−1}) for what follows.
    coefficients = [w, -1 - 1j * np.pi * x * w]
    for k in range(1, 5):
        coefficients.append(-1j * np.pi * (x * coefficients[k] + coefficients[k - 1]) / (k + 1))
    stacked = np.stack(coefficients, axis=1)
    table = np.ascontiguousarray(np.hstack([stacked.real, stacked.imag]))
    table.setflags(write=False)
    return table


@lru_cache(maxsize=1)
def decay_polynomial() -> NDArray[np.float64]:
    """Return (x + MIDDLE) w(x) for x ≥ 0 as one polynomial of (x − MIDDLE) / (x + MIDDLE), to 1e-10.

    Returns
    -------
    ndarray of float64, shape (2, DEGREE + 1)
        Coefficients of the real and of the imaginary part, powers ascending. Read only.
    """
    chebyshev = np.polynomial.chebyshev
    t = chebyshev.chebpts1(16 * DEGREE)
    x = MIDDLE * (1 + t) / (1 - t)
    # w is Faddeeva's function on a diagonal of the complex plane (Abramowitz and Stegun, 7.3.22).
    values = (x + MIDDLE) * (0.5 + 0.5j) * special.wofz(0.5 * np.sqrt(np.pi) * (1 + 1j) * x)
    fitted = (chebyshev.chebfit(t, part, DEGREE) for part in (values.real, values.imag))
    table = np.empty((2, DEGREE + 1))
    table[:] = [chebyshev.cheb2poly(each) for each in fitted]
    table.setflags(write=False)
    return table
