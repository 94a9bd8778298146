"""Power is conserved: pictures of primitives against closed forms and against counted random rays."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from aureole.flare import raster
from aureole.flare.barycentric import METHODS
from aureole.flare.primitives import Frame, Primitives

Numbers = NDArray[np.float64]
Map = Callable[[Numbers, Numbers], tuple[Numbers, Numbers]]
FRAME = Frame((96, 120), 1e-5)
WHITE = np.ones((1, 3))


def cells(place: Map, count: int = 24, weight: float = 1.0, stop: Map | None = None) -> Primitives:
    """Return the cells of a grid over [-1, 1]² that a map lays on the picture; the pupil's area is 4 m²."""
    side = np.linspace(-1.0, 1.0, count + 1)
    u, v = np.meshgrid(side, side)
    x, y = place(u, v)
    stop_x, stop_y = (np.zeros_like(u), np.zeros_like(u)) if stop is None else stop(u, v)
    numbers = [x, y, np.full_like(u, weight), np.zeros_like(u), stop_x, stop_y]
    around = [np.stack([a[:-1, :-1], a[:-1, 1:], a[1:, 1:], a[1:, :-1]], -1).reshape(-1, 4) for a in numbers]
    corners = np.stack(around[:2], -1).astype(np.float32)
    attributes = np.stack(around[2:], -1).astype(np.float32)
    area, zero = np.full(count**2, 4.0 / count**2, np.float32), np.zeros(count**2, np.int32)
    return Primitives(corners, attributes, area, zero, zero, zero + 1, np.zeros(1))


def together(*parts: Primitives) -> Primitives:
    """Return all primitives as one record, each part a ghost and a colour of its own."""
    fields = [np.concatenate([getattr(p, name) for p in parts]) for name in ("corners", "attributes", "area")]
    number = np.concatenate([np.full(len(p.area), k, np.int32) for k, p in enumerate(parts)])
    return Primitives(*fields, number, number, np.ones_like(number), np.zeros(1))


def drawn(primitives: Primitives, **options: object) -> Numbers:
    """Return one channel of the picture."""
    return raster.rasterize(primitives, WHITE, FRAME, **options)[..., 0].astype(np.float64)


def wavy(seed: int, size: float = 18.0, fold: float = 0.0) -> Map:
    """Return a smooth map with a random bend, folded along a curve where `fold` is above about 0.5."""
    a, b, c, d, turn = np.random.default_rng(seed).uniform(-0.25, 0.25, 5)

    def place(u: Numbers, v: Numbers) -> tuple[Numbers, Numbers]:
        s, t = u + a * v * v + b * u * v, v + c * u * u + d * u * v * v
        s = s - fold * u * u
        x, y = (
            math.cos(8 * turn) * s - math.sin(8 * turn) * t,
            math.sin(8 * turn) * s + math.cos(8 * turn) * t,
        )
        return 59.3 + size * x, 47.1 + size * y

    return place


def counted(primitives: Primitives, each: int = 4000, seed: int = 5) -> Numbers:
    """Return the picture of random rays in the cells' bilinear maps."""
    generator = np.random.default_rng(seed)
    picture = np.zeros(FRAME.shape)
    for quad, rays, area in zip(primitives.corners, primitives.attributes, primitives.area, strict=True):
        u, v = generator.random((2, each))
        b = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], 1)
        x, y = (b @ quad.astype(np.float64)).T
        values = b @ rays.astype(np.float64)
        passes = (values[:, 1] <= 1) & (np.hypot(values[:, 2], values[:, 3]) <= 1)
        edges = [np.arange(n + 1) for n in FRAME.shape]
        picture += np.histogram2d(y, x, bins=edges, weights=values[:, 0] * passes)[0] * (area / each)
    return picture


@pytest.mark.parametrize("method", ["reference", "tiles"])
@pytest.mark.parametrize("flip", [1, -1])
def test_a_rectangle_is_covered_exactly(method: str, flip: int) -> None:
    left, right, top, bottom = 20.3, 81.75, 11.6, 70.2
    box = cells(lambda u, v: (flip * u * 30.725 + 51.025, v * 29.3 + 40.9), 7)
    columns, rows = np.arange(FRAME.shape[1]), np.arange(FRAME.shape[0])
    across = np.clip(np.minimum(columns + 1, right) - np.maximum(columns, left), 0, 1)
    down = np.clip(np.minimum(rows + 1, bottom) - np.maximum(rows, top), 0, 1)
    expected = 4.0 * np.outer(down, across) / ((right - left) * (bottom - top))
    assert drawn(box, method=method) == pytest.approx(expected, abs=2e-5 * expected.max())


@pytest.mark.parametrize("count", [1, 3, 10, 40, 150])
def test_a_sheared_sheet_is_even_inside_and_keeps_its_power(count: int) -> None:
    # Cells from 60 pixels wide down to less than half a pixel.
    sheet = cells(lambda u, v: (60 + 22 * u + 9 * v, 48 - 7 * u + 25 * v), count, weight=0.7)
    picture, density = drawn(sheet), 0.7 / (22 * 25 + 9 * 7)
    assert picture.sum() == pytest.approx(0.7 * 4, rel=1e-3)
    assert picture[38:58, 50:70] == pytest.approx(density, rel=2e-2 if count > 100 else 1e-4)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("fold", [0.0, 1.0])
def test_power_lands_where_random_rays_land(seed: int, fold: float) -> None:
    sheet = cells(wavy(seed, 14.0, fold), 16)
    picture, truth = drawn(sheet), counted(sheet)
    assert picture.sum() == pytest.approx(4.0, rel=3e-3)
    # Over 4×4 pixels, where rays are many enough for 1 %.
    blocks = [a.reshape(24, 4, 30, 4).sum((1, 3)) for a in (picture, truth)]
    assert np.abs(blocks[0] - blocks[1]).sum() < 0.02 * 4
    assert picture.max() < 1.15 * truth.max()
    assert picture.min() >= 0


@pytest.mark.parametrize("count", [12, 40])
def test_a_disc_has_its_area(count: int) -> None:
    radius = 40 / 1.2
    place: Map = lambda u, v: (60.2 + 40 * u, 48.4 + 40 * v)  # noqa: E731
    round_stop = cells(place, count, stop=lambda u, v: (1.2 * u, 1.2 * v))
    assert drawn(round_stop).sum() * 80**2 / 4 == pytest.approx(math.pi * radius**2, rel=1e-3)
    # As a level: (1 + r²) / 2, whose bilinear values lie too high by 2 h²/3 in the mean.
    level = cells(place, count, stop=lambda u, v: (1.2 * u, 1.2 * v))
    level.attributes[..., 1] = 0.5 + 0.5 * (level.attributes[..., 2:] ** 2).sum(-1)
    level.attributes[..., 2:] = 0
    part = 1.0 - 2.0 * (1.2 * 2 / count) ** 2 / 6.0
    assert drawn(level).sum() * 80**2 / 4 == pytest.approx(part * math.pi * radius**2, rel=2e-3)


@pytest.mark.parametrize("coordinates", METHODS)
def test_a_middle_on_a_shared_edge_belongs_to_one_quad(coordinates: str) -> None:
    # Corners and edges of the cells run through pixels' middles.
    for sheet in (
        cells(lambda u, v: (60.5 + 32 * u, 48.5 + 32 * v), 16),
        cells(lambda u, v: (60.5 - 32 * u, 48.5 + 32 * v), 16),
    ):
        picture = drawn(sheet, coordinates=coordinates)
        assert np.count_nonzero(picture) == 64**2
        assert picture[picture > 0] == pytest.approx(4.0 / 64**2, rel=1e-5)
    diamonds = cells(lambda u, v: (60.5 + 20 * (u + v), 48.5 + 20 * (u - v)), 10)
    picture = drawn(diamonds, coordinates=coordinates)
    assert np.count_nonzero(picture) == pytest.approx(80 * 40, abs=81)
    assert picture[picture > 0] == pytest.approx(4.0 / 3200, rel=1e-5)


@pytest.mark.parametrize("coordinates", METHODS)
def test_coordinates_keep_most_power(coordinates: str) -> None:
    sheet = cells(wavy(1, 35.0), 10, stop=lambda u, v: (1.2 * u, 1.2 * v))
    picture, truth = drawn(sheet, coordinates=coordinates), drawn(sheet)
    # Loop and DeRose's are not linear in quads that are no parallelograms.
    assert picture.sum() == pytest.approx(truth.sum(), rel=3e-2 if coordinates == "loop-derose" else 3e-3)
    assert np.abs(picture - truth)[30:60, 40:80].max() < 0.05 * truth.max()


@pytest.mark.parametrize("coordinates", ["coverage", *METHODS])
@pytest.mark.parametrize("fold", [0.0, 1.0])
def test_tiles_show_what_the_reference_shows(fold: float, coordinates: str) -> None:
    # Three ghosts over one another, a large one beyond the frame among them, edged by stop and level.
    stop: Map = lambda u, v: (1.3 * u + 0.1, 1.3 * v)  # noqa: E731
    sheets = [cells(wavy(k, 15.0 * 3**k, fold), 20, stop=stop) for k in range(3)]
    whole = together(*sheets)
    colours = np.random.default_rng(1).random((3, 3))
    truth = raster.rasterize(whole, colours, FRAME, "reference", coordinates)
    assert truth.max() > 0
    for tiles in ((128, 64), (32, 8), (None, 16)):
        found = raster.rasterize(whole, colours, FRAME, "tiles", coordinates, tiles=tiles)
        assert np.abs(found - truth).max() <= 1e-5 * truth.max()
    alone = [
        raster.rasterize(s, colours[k : k + 1], FRAME, "auto", coordinates) for k, s in enumerate(sheets)
    ]
    assert np.abs(sum(alone) - truth).max() <= 1e-5 * truth.max()


def test_a_mirrored_sheet_makes_a_mirrored_picture() -> None:
    sheet = cells(wavy(3, fold=1.0), 20, stop=lambda u, v: (1.3 * u, 1.3 * v))
    picture = drawn(sheet)
    sheet.corners[..., 0] = FRAME.shape[1] - sheet.corners[..., 0]
    mirrored = drawn(sheet)
    assert np.abs(mirrored[:, ::-1] - picture).max() <= 2e-4 * picture.max()


def test_an_iris_shows_its_shape() -> None:
    # A square hole of half the stop's width in a mask whose samples are finer than pixels.
    mask = np.zeros((256, 256))
    mask[64:192, 64:192] = 1.0
    sheet = cells(lambda u, v: (60.0 + 40 * u, 48.0 + 40 * v), 20, stop=lambda u, v: (u, v))
    picture = drawn(sheet, iris=mask)
    density = 4.0 / 80**2
    assert picture[29:67, 41:79] == pytest.approx(density, rel=1e-4)
    assert picture.sum() == pytest.approx(density * 40 * 40, rel=1e-2)
    assert picture[:27].max() == picture[:, :39].max() == 0.0


def test_nothing_else_passes_where_the_level_is_above_one() -> None:
    sheet = cells(lambda u, v: (60.0 + 40 * u, 48.0 + 40 * v), 20)
    sheet.attributes[..., 1] = 1.6
    assert drawn(sheet).max() == 0.0


@pytest.mark.parametrize("coordinates", ["coverage", "mean-value"])
def test_quads_of_any_size_do_no_harm(coordinates: str) -> None:
    # A quad far larger than all pictures, one far away, and one without area.
    large = np.array([[-3e7, -2e7], [5e7, -2e7], [5e7, 4e7], [-3e7, 4e7]])
    quads = np.stack([large, large * 1e4, large * 1e-12 + 5.0, large + 2e8, np.tile([[9.0, 7.0]], (4, 1))])
    base = cells(lambda u, v: (u, v), 1)
    rays = np.repeat(base.attributes, 5, 0)
    rays[1, :, 2:] = [[-1e9, 1e9], [1e9, 1e9], [1e9, -1e9], [-1e9, -1e9]]
    zero = np.zeros(5, np.int32)
    whole = Primitives(
        quads.astype(np.float32), rays, np.ones(5, np.float32), zero, zero, zero + 1, np.zeros(1)
    )
    picture = drawn(whole, coordinates=coordinates)
    assert np.isfinite(picture).all()
    assert picture.sum() == pytest.approx(2.0, rel=1e-4)
    assert drawn(whole, coordinates=coordinates, iris=np.ones((8, 8))).sum() == pytest.approx(2.0, rel=1e-4)
