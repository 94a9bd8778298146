"""One page about a point spread function: pupil, patterns, transfer function, energy, numbers."""

from pathlib import Path
from typing import Any

import numpy as np

from aureole import diffraction, glare, picture, refuse, units
from aureole.jobs.measures import AIRY, PupilMeasures
from aureole.records import Aperture, Camera, Grid, Picture

SUFFIXES = (".png", ".jpg", ".pdf", ".svg")
SIZE_INCHES, DOTS_PER_INCH = (11.69, 8.27), 150
CORE_PIXELS, CORE_DECADES = 301, 6
# Half the side of the core's picture in Airy radii, more where the energy is spread wider.
LEAST_AIRY, MOST_AIRY = 5.0, 60.0
INK, ACCENT, QUIET = "#1f2430", "#c2410c", "#6b7280"
BLUE = "#1d4ed8"


def check_page(path: Path, what: str = "report") -> Path:
    """Refuse, before any work, a place or a format for which no page can be written.

    Parameters
    ----------
    path : Path
        File to write.
    what : str
        What is written, for the refusal.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    refuse.Refusal
        Where the suffix is unknown or the place cannot be written.
    """
    refuse.one_of(f"suffix of the {what}", path.suffix.lower(), SUFFIXES)
    return picture.writable(path)


def write_page(path: Path, psf: Picture, camera: Camera, measures: PupilMeasures, illuminant: str) -> None:
    """Draw the page and write it, whole or not at all.

    Parameters
    ----------
    path : Path
        File to write; its suffix says the format: PNG, JPEG, PDF or SVG.
    psf : Picture
        The camera's point spread function.
    camera : Camera
        The camera.
    measures : PupilMeasures
        Of its pupil.
    illuminant : str
        The light's name.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be written.
    """
    from matplotlib.figure import Figure

    check_page(path)
    figure = Figure(figsize=SIZE_INCHES, facecolor="white")
    figure.suptitle(_title(camera), x=0.045, y=0.965, ha="left", fontsize=14, color=INK, weight="bold")
    places = figure.add_gridspec(
        2, 3, left=0.065, right=0.965, top=0.87, bottom=0.085, wspace=0.42, hspace=0.34
    )
    pupil = glare.pupil(camera)
    _draw_pupil(figure.add_subplot(places[0, 0]), pupil)
    _draw_core(figure.add_subplot(places[0, 1]), pupil, camera, measures)
    _draw_kernel(figure.add_subplot(places[0, 2]), psf, camera)
    _draw_transfer(figure.add_subplot(places[1, 0]), measures, illuminant)
    _draw_energy(figure.add_subplot(places[1, 1]), measures, illuminant)
    _draw_numbers(figure.add_subplot(places[1, 2]), camera, measures, illuminant)
    save(path, figure)


def save(path: Path, figure: Any) -> None:
    """Write a figure, whole or not at all; the same figure makes the same file.

    Parameters
    ----------
    path : Path
        File to write; its suffix says the format: PNG, JPEG, PDF or SVG.
    figure : matplotlib.figure.Figure
        What is drawn.

    Raises
    ------
    refuse.Refusal
        Where the file cannot be written.
    """
    # Without a date the same job writes the same file.
    undated: dict[str, Any] = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}
    kind = path.suffix.lower()
    with picture.whole_file(path) as part:
        figure.savefig(part, format=kind[1:], dpi=DOTS_PER_INCH, metadata=undated.get(kind))


def _title(camera: Camera) -> str:
    length = units.metres_as_text(camera.focal_length)
    words = camera.iris.name.replace(" with wavefront", "").split(" behind ")
    dirt = f" behind {' and '.join(words[1:])}" if len(words) > 1 else ""
    return f"{words[0][0].upper()}{words[0][1:]}{dirt}, {length} f/{camera.f_number:.3g}"


def _draw_pupil(axes: Any, pupil: Aperture) -> None:
    """Show the mask in grey, or the wavefront where light passes."""
    from aureole import aperture as apertures

    half = 1e3 * pupil.width / 2
    where = {"extent": (-half, half, -half, half), "interpolation": "none"}
    if pupil.wavefront is None or pupil.mask is None:
        axes.imshow(apertures.rasterize(pupil, 512), cmap="gray", vmin=0, vmax=1, **where)
        _label(axes, "Pupil: transmittance", "mm", "")
        return
    error = 1e9 * np.where(pupil.mask > 0.5, pupil.wavefront, np.nan)
    depth = max(float(np.nanmax(np.abs(error))), 1e-6)
    axes.set_facecolor("#22252b")
    shown = axes.imshow(error, cmap="RdBu_r", vmin=-depth, vmax=depth, **where)
    _scale(axes, shown, "nm")
    _label(axes, "Pupil: wavefront error", "mm", "")


def _draw_core(axes: Any, pupil: Aperture, camera: Camera, measures: PupilMeasures) -> None:
    """Show the intensity about the axis over the peak of a flat wavefront."""
    from aureole import aperture as apertures

    airy = AIRY * measures.wavelength * camera.f_number
    wide = measures.report["radius_of_90_percent_energy_m"] or MOST_AIRY * airy
    half = min(max(LEAST_AIRY * airy, 1.25 * wide), MOST_AIRY * airy)
    spacing = 2 * half / (CORE_PIXELS * camera.focal_length * measures.wavelength)
    grid = Grid((CORE_PIXELS, CORE_PIXELS), (spacing, spacing))
    power = diffraction.far_power(pupil, grid, wavelength=measures.wavelength) / apertures.area(pupil) ** 2
    side = 1e6 * half
    shown = axes.imshow(
        np.log10(np.maximum(power, 10.0 ** (-CORE_DECADES - 1))),
        cmap="inferno",
        vmin=-CORE_DECADES,
        vmax=0,
        extent=(-side, side, -side, side),
        interpolation="none",
    )
    _scale(axes, shown, "log10")
    circle = np.linspace(0, 2 * np.pi, 181)
    axes.plot(1e6 * airy * np.cos(circle), 1e6 * airy * np.sin(circle), color="white", lw=0.7, ls=(0, (3, 3)))
    _label(axes, f"PSF at {_nm(measures)}, over its ideal peak", "µm", "")


def _draw_kernel(axes: Any, psf: Picture, camera: Camera) -> None:
    """Show the point spread function as it is written, over ten decades."""
    (rows, columns), (pitch_y, pitch_x) = psf.pixels.shape[:2], camera.pixel_pitch
    half_x, half_y = 1e3 * columns * pitch_x / 2, 1e3 * rows * pitch_y / 2
    shown = picture.to_display(psf, exposure=0.0, tone="log")
    axes.imshow(np.clip(shown, 0, 1), extent=(-half_x, half_x, -half_y, half_y), interpolation="none")
    axes.locator_params(nbins=5)
    _label(axes, f"Kernel: {columns} × {rows} pixels, 10 decades", "mm", "")


def _draw_transfer(axes: Any, measures: PupilMeasures, illuminant: str) -> None:
    places = 1e-3 * measures.frequencies
    axes.plot(
        places, measures.transfer_limit, color=QUIET, lw=1, ls=":", label=f"ideal circle, {_nm(measures)}"
    )
    for curve, style, name in zip(measures.transfer, ("-", "--"), ("tangential", "sagittal"), strict=True):
        axes.plot(places, curve, color=BLUE, ls=style, lw=1.5, label=f"{name}, {_nm(measures)}")
    if measures.transfer_in_light is not measures.transfer:
        pairs = zip(measures.transfer_in_light, ("-", "--"), ("tangential", "sagittal"), strict=True)
        for curve, style, name in pairs:
            axes.plot(places, curve, color=ACCENT, ls=style, lw=1.5, label=f"{name}, {illuminant}")
    axes.set_xlim(0, places[-1])
    axes.set_ylim(0, 1)
    _label(axes, "Modulation transfer", "cycles per mm", "contrast")
    _legend(axes, "upper right")


def _draw_energy(axes: Any, measures: PupilMeasures, illuminant: str) -> None:
    places = 1e6 * measures.radii
    axes.plot(
        places, measures.encircled_limit, color=QUIET, lw=1, ls=":", label=f"ideal circle, {_nm(measures)}"
    )
    axes.plot(places, measures.encircled, color=BLUE, lw=1.5, label=_nm(measures))
    last = measures.encircled
    if measures.encircled_in_light is not measures.encircled:
        last = measures.encircled_in_light
        axes.plot(places, last, color=ACCENT, lw=1.5, label=illuminant)
    for share in (50, 80, 90):
        radius = measures.report[f"radius_of_{share}_percent_energy_m"]
        if radius is not None:
            axes.plot([0, 1e6 * radius, 1e6 * radius], [share / 100, share / 100, 0], color=QUIET, lw=0.6)
            axes.text(1e6 * radius, 0.02, f"{share} %", fontsize=7, color=QUIET, rotation=90, ha="left")
    axes.set_xlim(0, places[-1])
    axes.set_ylim(0, 1)
    _label(axes, "Encircled energy", "radius in µm", "part of the energy")
    _legend(axes, "lower right", 0.12)


def _draw_numbers(axes: Any, camera: Camera, measures: PupilMeasures, illuminant: str) -> None:
    """Write the numbers as a table of two columns."""
    axes.axis("off")
    report = measures.report
    strehl_in_light = [(f"Strehl ratio, {illuminant}", f"{report['strehl_in_light']:.3f}")]
    if measures.transfer_in_light is measures.transfer:
        strehl_in_light = []
    rows = [
        ("focal length", units.metres_as_text(camera.focal_length)),
        ("f-number", f"{camera.f_number:.4g}"),
        (f"Airy radius, {_nm(measures)}", units.metres_as_text(report["airy_radius_m"])),
        (f"cut-off 1/(λN), {_nm(measures)}", _per_mm(report["cutoff_cycles_per_mm"])),
        ("  tangential, sagittal", _two(report, "cutoff")),
        ("contrast 50 %, tan., sag.", _two(report, "mtf50")),
        (f"Strehl ratio, {_nm(measures)}", f"{report['strehl']:.3f}"),
        *strehl_in_light,
        ("wavefront error, RMS", _wavefront(report, measures.wavelength)),
    ]
    for share in (50, 80, 90):
        radius = report[f"radius_of_{share}_percent_energy_m"]
        text = "beyond the curve" if radius is None else units.metres_as_text(radius)
        rows.append((f"{share} % of the energy within", text))
    for line, (name, value) in enumerate(rows):
        height = 1.0 - line / (len(rows) - 1)
        axes.text(-0.06, height, name, fontsize=9, color=QUIET, va="center", transform=axes.transAxes)
        axes.text(
            1.04, height, value, fontsize=9, color=INK, va="center", ha="right", transform=axes.transAxes
        )


def _wavefront(report: dict[str, Any], wavelength: float) -> str:
    rms = report["wavefront_rms_m"]
    if rms == 0:
        return "none"
    return f"{units.metres_as_text(rms)} = {rms / wavelength:.3g} λ"


def _two(report: dict[str, Any], name: str) -> str:
    along = [report[f"{name}_{way}_cycles_per_mm"] for way in ("tangential", "sagittal")]
    return f"{along[0]:.4g}, {_per_mm(along[1])}"


def _per_mm(value: float) -> str:
    return f"{value:.4g} / mm"


def _nm(measures: PupilMeasures) -> str:
    return f"{1e9 * measures.wavelength:.4g} nm"


def _label(axes: Any, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=10, color=INK, loc="left")
    axes.set_xlabel(x, fontsize=8, color=QUIET)
    axes.set_ylabel(y, fontsize=8, color=QUIET)
    axes.tick_params(labelsize=7, colors=QUIET)
    for spine in axes.spines.values():
        spine.set_color("#d1d5db")


def _legend(axes: Any, where: str, up: float = 0.0) -> None:
    place = (0, up, 1, 1 - up)
    axes.legend(loc=where, bbox_to_anchor=place, fontsize=7, edgecolor="none", labelcolor=INK)
    axes.grid(color="#e5e7eb", lw=0.6)


def _scale(axes: Any, shown: Any, label: str) -> None:
    bar = axes.figure.colorbar(shown, cax=axes.inset_axes((1.03, 0.0, 0.04, 1.0)))
    bar.ax.set_title(label, fontsize=7, color=QUIET, loc="left")
    bar.ax.tick_params(labelsize=7, colors=QUIET)
    bar.outline.set_visible(False)
