"""From wavelength to colour: spectra, the observer, the spectral sum, XYZ and RGB.

In come spectra (metres) and a diffraction `Pattern` at one wavelength; out goes a `Picture` in XYZ,
and from there one in a linear RGB space.

- `tables.py`: reads the published tables in `data/`, each with its source in its header.
- `spectra.py`: a `Spectrum` from numbers, a single line, a black body.
- `illuminants.py`: E, A, D65, F1, and "blackbody:3200K" or "line:550nm" as text.
- `observer.py`: the CIE 1931 2° observer; a spectrum's XYZ and white; the weights of a spectral sum.
- `spaces.py`: linear colour spaces, the matrices between them, adaptation from white to white.
- `spectral.py`: the spectral sum in METHODS; "reference" and the choice of "auto".
- `scaling.py`: what one spectral sum is asked to do, and where its scaled samples lie.
- `lookups.py`: "full", a look-up a wavelength, and "batch", the two passes of the quad paper.
- `rays.py`: "rays", all wavelengths along rays from the origin.
- `_kernels*.py`: the heavy loops.
"""

from aureole.light.illuminants import ILLUMINANTS, illuminant
from aureole.light.observer import chromaticity, lit_range, observer, quadrature, tristimulus, white
from aureole.light.spaces import (
    SPACES,
    Space,
    adaptation,
    convert,
    from_xyz,
    matrix,
    space_from_primaries,
    to_xyz,
)
from aureole.light.spectra import black_body, line, spectrum
from aureole.light.spectral import METHODS, in_white_of, spectral_sum, spectral_sum_at, stretched_sum

__all__ = [
    "ILLUMINANTS",
    "METHODS",
    "SPACES",
    "Space",
    "adaptation",
    "black_body",
    "chromaticity",
    "convert",
    "from_xyz",
    "illuminant",
    "in_white_of",
    "line",
    "lit_range",
    "matrix",
    "observer",
    "quadrature",
    "space_from_primaries",
    "spectral_sum",
    "spectral_sum_at",
    "spectrum",
    "stretched_sum",
    "to_xyz",
    "tristimulus",
    "white",
]
