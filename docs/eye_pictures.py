"""Draw the eye's point spread function, and a photograph as eyes of two ages see it.

    python docs/eye_pictures.py patterns PICTURE
    python docs/eye_pictures.py front PICTURE
    python docs/eye_pictures.py parts PICTURE
    python docs/eye_pictures.py veil PICTURE
    python docs/eye_pictures.py time PICTURE
    python docs/eye_pictures.py photograph FILE AGE PICTURE

patterns: ages of 30 and 70 (across), pupils of 3 and 7 mm (down).
front: the parts as they stand before the pupil, the lids open and closing.
parts: what pupil, particles, fibres and lashes do one by one, their sum as the thesis adds them, and the
whole as one wave.
veil: the mean over each circle about the core, beside CIE 135.
time: two seconds, six patterns each.
photograph: a linear picture as an eye of that age sees it; prints the picture's sum before and after.
"""

import sys
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from aureole import Picture, glare, picture
from aureole.bench import eye_patterns
from aureole.picture.transfer import decode_srgb

Pixels = NDArray[np.float32]
SIZE, FIELD = 360, np.radians(14.0)
# Density per steradian that is shown as one; a lamp of so many lux at the eye would light the page so.
BRIGHTNESS = 20.0
AGES, PUPILS = (30.0, 70.0), (3e-3, 7e-3)
# What 8 seconds at f/2.8 are right for, cd/m², and degrees across the photograph as it may have been.
DUSK, PHOTOGRAPH_FIELD, WIDE = 0.2, np.radians(40.0), 840


def patterns() -> Pixels:
    """Return patterns of two ages and two pupils."""
    rows = []
    for pupil in PUPILS:
        states = [replace(_state(age), pupil_diameter=pupil) for age in AGES]
        rows.append([_drawn(glare.eye_psf(state, (SIZE, SIZE), FIELD)) for state in states])
    return _sheet(rows)


def front() -> Pixels:
    """Return what stands before and in a pupil of 6.5 mm, for three openings of the lids."""
    state = replace(_state(30.0), pupil_diameter=6.5e-3)
    states = [replace(state, lid_opening=opening) for opening in (1.0, 0.6, 0.3)]
    drawings = [picture.to_display(glare.eye_picture(each, 300), 0.0, "clip") for each in states]
    close = picture.to_display(glare.eye_picture(state, 300, 1.5e-3), 0.0, "clip")
    return _sheet([[*drawings, close]])


def parts() -> Pixels:
    """Return the four components, their weighted sum, and the coherent whole."""
    state = replace(_state(30.0), pupil_diameter=7e-3)
    each = glare.component_psfs(state, (SIZE, SIZE), FIELD)
    weights = glare.component_weights(state)
    shown = [_drawn(Picture(each[name].pixels * np.float32(weights[name]))) for name in each]
    summed = _drawn(glare.eye_psf(state, (SIZE, SIZE), FIELD, combine="thesis"))
    whole = _drawn(glare.eye_psf(state, (SIZE, SIZE), FIELD))
    return _sheet([[shown[0], shown[1], shown[2]], [shown[3], summed, whole]])


def over_time() -> Pixels:
    """Return twelve patterns of two seconds, a blink among them."""
    eye = glare.Eye()
    size = 200
    frames = []
    for index in range(12):
        state = glare.EyeState.at(index / 6, 0.3, eye=eye)
        psf = glare.eye_psf(state, (size, size), FIELD)
        # A pattern sums to 1; what the lids let through of the light is seen.
        frames.append(_drawn(Picture(psf.pixels * np.float32(glare.open_share(state)), psf.colour_space)))
    return _sheet([frames[:6], frames[6:]])


def photograph(path: Path, age: float) -> Pixels:
    """Return a photograph as an eye sees it, and print what the frame holds before and after."""
    scene = picture.read(path)
    state = glare.EyeState.at(1.0, DUSK, age=age, field_of_view=PHOTOGRAPH_FIELD, blinking=False)
    rows, columns = scene.pixels.shape[:2]
    wide = glare.pattern_field((rows, columns), PHOTOGRAPH_FIELD)
    psf = glare.eye_psf(state, glare.pattern_shape((rows, columns)), wide, projection="perspective")
    found = glare.eye_composite(scene, psf, field_of_view=PHOTOGRAPH_FIELD)
    before, after = (float(each.pixels[..., :3].sum(dtype=np.float64)) for each in (scene, found))
    change = after / before - 1
    print(f"{path.name}, {age:.0f} years: sum {before:.6g} before, {after:.6g} after ({change:+.2e})")
    shown = picture.to_display(found, 1.2, "filmic")
    return np.concatenate([_fitted(shown, WIDE), np.ones((6, WIDE, 3), np.float32), _enlarged(shown)])


def _fitted(pixels: Pixels, columns: int) -> Pixels:
    """Return a picture with so many columns."""
    share = columns / pixels.shape[1]
    rows = round(pixels.shape[0] * share)
    return np.clip(ndimage.zoom(pixels, (rows / pixels.shape[0], share, 1), order=1), 0, 1)


def _enlarged(pixels: Pixels) -> Pixels:
    """Return the lamps on the right, twice as large as they are."""
    rows, columns = pixels.shape[:2]
    top, left = int(0.36 * rows), min(int(0.6 * columns), columns - WIDE // 2)
    return np.repeat(np.repeat(pixels[top : top + 150, left : left + WIDE // 2], 2, axis=0), 2, axis=1)


def _state(age: float) -> "glare.EyeState":
    return glare.EyeState.at(1.0, 0.1, age=age, blinking=False, hippus=False)


def _drawn(psf: Picture) -> Pixels:
    """Return a pattern for a screen, as bright for every size: by its energy in a steradian."""
    density = psf.pixels * np.float32(BRIGHTNESS / _pixel(psf) ** 2 / 1e3)
    return picture.to_display(Picture(density, psf.colour_space), 0.0, "filmic")


def _pixel(psf: Picture) -> float:
    return float(FIELD / psf.pixels.shape[1])


def _sheet(rows: list[list[Pixels]], gap: int = 4) -> Pixels:
    strips = [picture.side_by_side(row, gap) for row in rows]
    line = np.ones((gap, strips[0].shape[1], 3), np.float32)
    return np.concatenate([part for strip in strips for part in (strip, line)][:-1])


def veil(path: Path) -> None:
    """Draw the mean over circles beside CIE 135 and write the figure."""
    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7.2, 4.6), layout="constrained")
    angles = np.geomspace(0.1, 40, 40)
    for age, colour in zip((25.0, 70.0), ("#1d4ed8", "#c2410c"), strict=True):
        state = replace(_state(age), pupil_diameter=6e-3)
        standard = glare.veil.cie_135(np.radians(angles), age, state.eye.pigment)
        axes.loglog(angles, standard, color=colour, lw=6, alpha=0.25, label=f"CIE 135, {age:.0f} years")
        for tail, style in ((True, "-"), (False, ":")):
            means = eye_patterns.circle_means(state, angles, tail)
            words = "" if tail else ", wave optics alone"
            lit = means > 1e-4
            axes.loglog(angles[lit], means[lit], style, color=colour, lw=1.4, label=f"{age:.0f} years{words}")
    axes.set(xlabel="degrees from the source", ylabel="share of the light in a steradian", xlim=(0.1, 40))
    axes.legend(frameon=False, fontsize=8)
    axes.grid(alpha=0.25)
    with picture.whole_file(path) as part:
        figure.savefig(part, format=path.suffix.removeprefix("."), dpi=100)
    pyplot.close(figure)


def write(pixels: Pixels, path: Path) -> None:
    """Write a picture that is ready for a screen."""
    picture.write(path, Picture(decode_srgb(np.ascontiguousarray(pixels, dtype=np.float32)), "rec709"))


if __name__ == "__main__":
    kind, *rest = sys.argv[1:]
    if kind == "veil":
        veil(Path(rest[0]))
    elif kind == "photograph":
        write(photograph(Path(rest[0]), float(rest[1])), Path(rest[2]))
    else:
        write(
            {"patterns": patterns, "front": front, "parts": parts, "time": over_time}[kind](), Path(rest[0])
        )
