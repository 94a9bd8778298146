"""Draw what happens to the near field by FFT as the plane comes closer (quad paper, Figure 12).

    python docs/aliasing.py [docs/pictures/aliasing.jpg]

A heptagon of 4 mm in a window of 8 mm, 256² pixels, green light. From left to right the plane comes closer.
The upper rows convolve samples by FFT: with the sampled impulse response, in the window alone and in a frame
of zeros twice as wide; with the sampled transfer function, in the same frame; and with the impulse response
on samples eight times as fine in that frame, 256 times as many. The last row is Aureole, which takes no
samples of the opening. The number in each picture is its difference from direct sums in float64: root mean
square of the irradiance, of its mean.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray

from aureole import Aperture, Grid, diffraction, picture
from aureole.bench import convolved, shapes

SIZE, WINDOW, WAVELENGTH = 256, 8e-3, 550e-9
FRESNEL_NUMBERS = (1, 6, 24, 40)
FINER = 8
OURS = "Aureole"
NAMES = (
    "impulse response",
    "impulse response,\n2× padded",
    "transfer function,\n2× padded",
    f"impulse response,\n{FINER}× finer, 2× padded",
    OURS,
)
# Twice the irradiance where nothing is in the way is white.
BRIGHTEST, GAMMA = 2.0, 1 / 2.2

Irradiance = NDArray[np.floating]


def planes(fresnel_number: float) -> Iterator[tuple[str, Irradiance, float]]:
    """Return each way's irradiance on a plane, and how far it is from the truth."""
    distance = distance_of(fresnel_number)
    mask = shapes.mask("heptagon", SIZE)
    opening, step = Aperture(WINDOW, mask=mask), WINDOW / SIZE
    middle = 0.5 * step
    rest = (WINDOW, distance, WAVELENGTH)
    fine = convolved.impulse_response_by_axes(np.kron(mask, np.ones((FINER, FINER), np.float32)), *rest)
    fields = (
        (convolved.impulse_response(mask, *rest, padding=1), middle),
        (convolved.impulse_response(mask, *rest), middle),
        (convolved.transfer_function(mask, *rest), middle),
        # A sample of an even number of finer ones lies half of their step beyond the pixel's middle.
        (fine[FINER // 2 :: FINER, FINER // 2 :: FINER], middle + 0.5 * step / FINER),
        (diffraction.near_field(opening, _grid(step, middle), *rest[1:]).amplitude, middle),
    )
    for name, (field, place) in zip(NAMES, fields, strict=True):
        exact = diffraction.near_power(opening, _grid(step, place), *rest[1:], "reference")
        found = np.abs(field) ** 2
        yield name, found, float(np.sqrt(np.mean((found - exact) ** 2)) / exact.mean())


def distance_of(fresnel_number: float) -> float:
    """Return the distance at which half of the window's width has a Fresnel number, metres."""
    return (WINDOW / 4) ** 2 / (WAVELENGTH * fresnel_number)


def _grid(step: float, middle: float) -> Grid:
    return Grid((SIZE, SIZE), (step, step), (middle, middle))


def draw(path: Path) -> None:
    """Draw all planes by all ways and write the picture."""
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(
        len(NAMES), len(FRESNEL_NUMBERS), figsize=(9.6, 12.0), layout="constrained", squeeze=False
    )
    for column, number in enumerate(FRESNEL_NUMBERS):
        axes[0, column].set_title(f"z = {distance_of(number):.2g} m, Fresnel number {number}", fontsize=9)
        for place, (name, found, error) in zip(axes[:, column], planes(number), strict=True):
            place.imshow(np.clip(found / BRIGHTEST, 0, 1) ** GAMMA, cmap="gray", vmin=0, vmax=1)
            place.set(xticks=[], yticks=[])
            box = {"facecolor": "black", "edgecolor": "none", "pad": 1.5}
            place.text(
                0.03, 0.04, f"{error:.1g}", color="white", fontsize=8, transform=place.transAxes, bbox=box
            )
            if column == 0:
                place.set_ylabel(name, fontsize=9)
    with picture.whole_file(path) as part:
        figure.savefig(part, format=path.suffix.lower().removeprefix("."), dpi=120)
    pyplot.close(figure)


if __name__ == "__main__":
    draw(Path(sys.argv[1] if len(sys.argv) > 1 else "docs/pictures/aliasing.jpg"))
