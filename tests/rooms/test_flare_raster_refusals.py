"""What a raster refuses, and what it does with nothing."""

import numpy as np
import pytest

from aureole.flare import raster
from aureole.flare.primitives import Frame, Primitives
from aureole.refuse import Refusal

FRAME = Frame((20, 30), 1e-5)


def square(count: int = 1) -> Primitives:
    corners = np.array([[[2, 2], [12, 2], [12, 12], [2, 12]]] * count, np.float32).reshape(-1, 4, 2)
    rays = np.zeros((count, 4, 4), np.float32)
    rays[..., 0] = 1
    zero = np.zeros(count, np.int32)
    return Primitives(corners, rays, np.ones(count, np.float32), zero, zero, zero + 1, np.zeros(1))


@pytest.mark.parametrize("method", ["reference", "tiles"])
def test_nothing_makes_a_black_picture(method: str) -> None:
    picture = raster.rasterize(square(0), np.ones((1, 3)), FRAME, method)
    assert picture.shape == (20, 30, 3)
    assert picture.dtype == np.float32
    assert not picture.any()


def test_an_effort_counts_what_tiles_hold() -> None:
    # A square of 12×12 pixels with its ramps lies in 2×2 dense tiles of 8 and in one coarse one.
    _, effort = raster.rasterize_timed(square(), np.ones((1, 3)), FRAME, "tiles", tiles=(16, 8))
    assert (effort.coarse_indices, effort.dense_indices) == (1, 4)
    assert raster.tile_indices(square(), FRAME, (16, 8)) == (1, 4)
    assert effort.memory > 0
    assert min(effort.prepare, effort.coarse, effort.dense, effort.traversal) >= 0


def test_wrong_input_is_refused() -> None:
    broken = square()
    broken.corners[0, 0, 0] = np.nan
    cases = [
        ("method", {"method": "fast"}),
        ("coordinates", {"coordinates": "barycentric"}),
        ("tiles", {"tiles": (20, 8)}),
        ("tiles", {"tiles": (128, 4)}),
        ("iris", {"iris": np.ones(4)}),
        ("iris", {"iris": np.full((4, 4), np.inf)}),
        ("colours", {"colours": np.ones((0, 3))}),
        ("colours", {"colours": np.ones((1, 4))}),
        ("primitives", {"primitives": broken}),
    ]
    for name, change in cases:
        given = {"primitives": square(), "colours": np.ones((1, 3)), "frame": FRAME, **change}
        with pytest.raises(Refusal, match=f"'{name}'"):
            raster.rasterize(**given)
