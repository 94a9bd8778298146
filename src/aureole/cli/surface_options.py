"""Flags of the command `surface table`: which surface, what table, and what they mean."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from aureole import jobs, refuse, surface, units
from aureole.cli import options
from aureole.cli.options import FILES

SURFACE, HEIGHTS, BOKEH, TABLE = "Surface: one of these", "Surface: heights", "Surface: bokeh", "Table"
Source = tuple[surface.Grating | surface.HeightField, dict[str, Any], tuple[str, ...]]
SOME_PRESETS = "cd, dvd, bluray, lcd-342ppi, blazed-600"
HEIGHT_UNIT = "1um"

Name = Annotated[
    str,
    typer.Argument(
        metavar="TABLE",
        help=f"A table that `aureole surface table` or `measure` wrote, or a grating's preset "
        f"({SOME_PRESETS}; "
        "all: `aureole surface list`), or a preset's TOML file.",
    ),
]
Illuminant = Annotated[
    str,
    typer.Option(
        "--illuminant",
        help="The light, kept in the table: E, A, D65, F1, LED-B1..5, blackbody:3200K or line:532nm.",
        rich_help_panel=TABLE,
    ),
]
Preview = Annotated[
    Path | None,
    typer.Option(
        "--preview",
        help="Also draw the table over h, over many decades, with a scale: PNG, JPEG, PDF or SVG.",
        rich_help_panel=FILES,
    ),
]
PreviewRange = Annotated[
    float | None,
    typer.Option(
        "--preview-range",
        help="h at the preview's borders, at most 2; as far as nearly all light goes unless given.",
        rich_help_panel=FILES,
    ),
]
TableOut = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        help="Table to write: .exr, .pfm or .npz, with NAME.json beside it.",
        rich_help_panel=FILES,
    ),
]
ColourSpace = Annotated[
    str,
    typer.Option(
        "--colour-space",
        help="Of the file's numbers: xyz, or rec709, acescg or rec2020, whose white is the light's then.",
        rich_help_panel=TABLE,
    ),
]


@dataclass(frozen=True)
class SourceFlags:
    """The flags that name a surface, as text; each field's option teaches its use.

    Parameters
    ----------
    grating, slits, across, radial, blaze, display : optional
        Lines.
    height, pixel, height_unit, method, order : optional
        Heights.
    bokeh, period, depth, rotate, lens_blur, lens, as_slits : optional
        A photograph of lines.
    """

    grating: Annotated[
        str | None,
        typer.Option(
            "--grating",
            help=f"A preset: {SOME_PRESETS}, or a TOML file like those; all: `aureole surface list`.",
            rich_help_panel=SURFACE,
        ),
    ] = None
    slits: Annotated[
        str | None,
        typer.Option(
            "--slits",
            help="Slits: width, from one to the next, how many are lit in phase: 0.5um,1.6um,21.",
            rich_help_panel=SURFACE,
        ),
    ] = None
    across: Annotated[
        str | None,
        typer.Option(
            "--across",
            help="With --slits: crossed by others, in the same words: 10um,74um,5.",
            rich_help_panel=SURFACE,
        ),
    ] = None
    radial: Annotated[
        bool,
        typer.Option(
            "--radial",
            help="With --slits: of all directions mixed, orders are rings.",
            rich_help_panel=SURFACE,
        ),
    ] = False
    blaze: Annotated[
        str | None,
        typer.Option(
            "--blazed",
            help="Tilted facets: lines in a millimetre, and the wavelength that they send back: 600,500nm.",
            rich_help_panel=SURFACE,
        ),
    ] = None
    display: Annotated[
        float | None,
        typer.Option(
            "--display",
            help="A screen's pixels, by how many there are in an inch: 342.",
            rich_help_panel=SURFACE,
        ),
    ] = None
    height: Annotated[
        Path | None,
        typer.Option(
            "--height",
            help="A picture of heights, one period of a surface that repeats: EXR, PFM, NPY, TIFF, PNG.",
            rich_help_panel=HEIGHTS,
        ),
    ] = None
    pixel: Annotated[
        str | None,
        typer.Option("--pixel", help="From one height to the next: 20nm.", rich_help_panel=HEIGHTS),
    ] = None
    height_unit: Annotated[
        str | None,
        typer.Option(
            "--height-unit",
            help=f"What a value of 1 in that picture is: {HEIGHT_UNIT} unless given.",
            rich_help_panel=HEIGHTS,
        ),
    ] = None
    method: Annotated[
        str | None,
        typer.Option(
            "--method",
            help="exact (unless given), born (first order), taylor with --order, or amplitude, whose values "
            "are reflectances 0 to 1.",
            rich_help_panel=HEIGHTS,
        ),
    ] = None
    order: Annotated[
        int | None,
        typer.Option(
            "--order",
            help="Last power of the Taylor series; a note says where it is too low.",
            rich_help_panel=HEIGHTS,
        ),
    ] = None

    bokeh: Annotated[
        Path | None,
        typer.Option(
            "--bokeh",
            help="A photograph of a small lamp's out-of-focus spot on the surface, whose lines it shows: a "
            "likeness, for structures that the lens can see. It needs --period or --pixel, and --depth.",
            rich_help_panel=BOKEH,
        ),
    ] = None
    period: Annotated[
        str | None,
        typer.Option("--period", help="Known distance of the lines in it: 24.8um.", rich_help_panel=BOKEH),
    ] = None
    depth: Annotated[
        str | None,
        typer.Option("--depth", help="Height from its dark to its bright: 100nm.", rich_help_panel=BOKEH),
    ] = None
    rotate: Annotated[
        str | None,
        typer.Option(
            "--rotate",
            help="Turn it counter-clockwise: 90deg; found from the lines unless given.",
            rich_help_panel=BOKEH,
        ),
    ] = None
    lens_blur: Annotated[
        float | None,
        typer.Option(
            "--lens-blur",
            help="Blur to undo, standard deviation in pixels: 1.5 unless given, 0 for none.",
            rich_help_panel=BOKEH,
        ),
    ] = None
    lens: Annotated[
        str | None,
        typer.Option(
            "--lens",
            help="Distance, focal length and f-number: 85cm,250mm,5.6. A note says where it cannot see "
            "such lines.",
            rich_help_panel=BOKEH,
        ),
    ] = None
    as_slits: Annotated[
        bool,
        typer.Option(
            "--as-slits",
            help="Take the lines as slits: as wide, as far apart and as many as are lit.",
            rich_help_panel=BOKEH,
        ),
    ] = False

    def source(self) -> Source:
        """Return the surface, plain numbers and notes; refuse none, several, and strays."""
        named = {
            "grating": self.grating,
            "slits": self.slits,
            "blazed": self.blaze,
            "display": self.display,
            "height": self.height,
            "bokeh": self.bokeh,
        }
        given = [name for name, value in named.items() if value is not None]
        if len(given) != 1:
            said = ", ".join(f"'{name}'" for name in named)
            raise refuse.Refusal(f"give one of {said}; got {' and '.join(given) or 'none'}.")
        self._refuse_strays(given[0])
        if self.bokeh is not None:
            return self._bokeh(self.bokeh)
        return (self._heights(self.height) if self.height is not None else self._lines()), {}, ()

    def _lines(self) -> surface.Grating:
        """Return a grating."""
        if self.grating is not None:
            return surface.grating(self.grating)
        if self.blaze is not None:
            return _blazed(self.blaze)
        if self.display is not None:
            return surface.display_grating(refuse.positive("display", self.display), name="display")
        assert self.slits is not None
        along = _lines(self.slits, "slits")
        if self.across is not None:
            return surface.crossed_grating(along, _lines(self.across, "across"), "crossed slits")
        if self.radial:
            return surface.radial_grating(along, name="radial slits")
        return surface.multislit_grating(along.period, along.width, along.count, name="slits")

    def how(self) -> dict[str, Any]:
        """Return how heights are turned into light, by the names of a `SurfaceTableJob`."""
        if self.method == "taylor" and self.order is None:
            raise refuse.Refusal("'method' taylor needs 'order', such as --order 5.")
        if self.order is not None and self.method != "taylor":
            raise refuse.Refusal("'order' is the Taylor series'; it needs --method taylor.")
        return {"method": self.method or "exact", "order": 1 if self.order is None else self.order}

    def _heights(self, path: Path) -> surface.HeightField:
        if self.pixel is None:
            raise refuse.Refusal(
                "'height' needs 'pixel', the distance from one height to the next: --pixel 20nm."
            )
        if self.method is not None:
            refuse.one_of("method", self.method, surface.height.METHODS)
        pixel = refuse.positive("pixel", units.length(self.pixel, "pixel", "20nm"))
        unit = (
            1.0
            if self.method == "amplitude"
            else units.length(self.height_unit or HEIGHT_UNIT, "height-unit", "1um")
        )
        return jobs.heights_from_file(path, pixel, unit)

    def _bokeh(self, path: Path) -> Source:
        """Read a bokeh with what is known about it."""
        if (self.period is None) == (self.pixel is None):
            raise refuse.Refusal("'bokeh' needs one of 'period', such as 24.8um, and 'pixel', such as 0.5um.")
        if self.depth is None and not self.as_slits:
            raise refuse.Refusal("'bokeh' needs 'depth', such as 100nm, or 'as-slits'.")
        known: dict[str, Any] = {"depth": _length(self.depth or "100nm", "depth", "100nm")}
        for name, text in (("period", self.period), ("pixel", self.pixel)):
            if text is not None:
                known[name] = _length(text, name, "24.8um")
        if self.rotate is not None:
            known["angle"] = units.angle(self.rotate, "rotate")
        if self.lens_blur is not None:
            known["deviation"] = refuse.between("lens-blur", self.lens_blur, 0.0, 100.0)
        if self.lens is not None:
            known["lens"] = _lens(self.lens)
        return jobs.surface_from_bokeh(path, self.as_slits, **known)

    def _refuse_strays(self, kind: str) -> None:
        """Refuse flags that belong to another kind of surface."""
        owners: dict[str, dict[str, Any]] = {
            "slits": {"across": self.across, "radial": self.radial or None},
            "height": {"height-unit": self.height_unit},
            "height' or 'bokeh": {"pixel": self.pixel, "method": self.method, "order": self.order},
            "bokeh": {
                "period": self.period,
                "depth": self.depth,
                "rotate": self.rotate,
                "lens-blur": self.lens_blur,
                "lens": self.lens,
                "as-slits": self.as_slits or None,
            },
        }
        for owner, flags in owners.items():
            for name, value in flags.items():
                if value is not None and kind not in owner.split("' or '"):
                    raise refuse.Refusal(f"'{name}' goes with '{owner}', not with '{kind}'.")
        if self.across is not None and self.radial:
            raise refuse.Refusal("'across' and 'radial' do not go together; give one of them.")


@dataclass(frozen=True)
class TableFlags:
    """The flags of a table's form, as text; each field's option teaches its use.

    Parameters
    ----------
    size, half_range, warp, zero_order, normalise : optional
        Of the table.
    """

    size: Annotated[
        str | None,
        typer.Option(
            "--size",
            help="Samples of the table: 2048, or 2048x256. 2048 unless given, 1024 of heights.",
            rich_help_panel=TABLE,
        ),
    ] = None
    half_range: Annotated[
        float,
        typer.Option(
            "--range",
            help="h at the table's borders: 2 holds every pair of directions, less is finer.",
            rich_help_panel=TABLE,
        ),
    ] = 2.0
    warp: Annotated[
        int,
        typer.Option(
            "--warp",
            help="Odd power that crowds the samples where h is small: h = range * u^warp.",
            rich_help_panel=TABLE,
        ),
    ] = 5
    zero_order: Annotated[
        str,
        typer.Option(
            "--zero-order",
            help="The mirror's own highlight: keep it in the table, remove it, or specular: draw it as an "
            "ordinary lobe, which stays white.",
            rich_help_panel=TABLE,
        ),
    ] = "keep"
    normalise: Annotated[
        bool,
        typer.Option(
            "--normalise",
            help="Darken the table, where needed, so that no more light comes back than was sent.",
            rich_help_panel=TABLE,
        ),
    ] = False

    def form(self) -> dict[str, Any]:
        """Return the table's form, by the names of a `SurfaceTableJob`."""
        return {
            "size": None if self.size is None else options.size(self.size),
            "half_range": refuse.between("range", refuse.positive("range", self.half_range), 0.0, 2.0),
            "warp": surface.table.checked_warp(self.warp),
            "zero_order": refuse.one_of("zero-order", self.zero_order, surface.table.ZERO_ORDERS),
            "normalise": self.normalise,
        }


def _length(text: str, name: str, example: str) -> float:
    return refuse.positive(name, units.length(text, name, example))


def _lens(text: str) -> tuple[float, float, float]:
    """Read "85cm,250mm,5.6"."""
    words = [word.strip() for word in text.split(",")]
    try:
        if len(words) != 3:
            raise ValueError
        number = float(words[2])
    except ValueError:
        raise refuse.Refusal(f"'lens' must be such as 85cm,250mm,5.6, got '{text}'.") from None
    away, focal = (_length(word, "lens", "85cm") for word in words[:2])
    return away, focal, refuse.positive("lens", number)


def _lines(text: str, name: str) -> surface.Lines:
    """Read "0.5um,1.6um,21"."""
    words = [word.strip() for word in text.split(",")]
    if len(words) != 3 or not words[2].isdecimal():
        raise refuse.Refusal(
            f"'{name}' must be width, distance and number of slits, such as 0.5um,1.6um,21, got '{text}'."
        )
    width, period = (refuse.positive(name, units.length(word, name, "0.5um")) for word in words[:2])
    if width > period:
        raise refuse.Refusal(f"'{name}' must be no wider than from one to the next, got '{text}'.")
    return surface.Lines(period, width, refuse.at_least(name, int(words[2]), 1))


def _blazed(text: str) -> surface.Grating:
    """Read "600,500nm"."""
    words = [word.strip() for word in text.split(",")]
    if len(words) != 2:
        raise refuse.Refusal(
            f"'blazed' must be lines in a millimetre and a wavelength: 600,500nm, got '{text}'."
        )
    try:
        density = float(words[0])
    except ValueError:
        raise refuse.Refusal(f"'blazed' must be such as 600,500nm, got '{text}'.") from None
    wavelength = units.length(words[1], "blazed", "500nm")
    return surface.blazed_grating(density, wavelength, name=f"blazed {words[0]}")
