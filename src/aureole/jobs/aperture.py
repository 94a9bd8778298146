"""The aperture job: an opening drawn, with the counts that its transforms depend on."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from aureole import aperture as apertures
from aureole import diffraction, refuse
from aureole.jobs.drawing import quadtree_drawing
from aureole.jobs.optics import DEFAULT_CAMERA, Opening
from aureole.presets import load
from aureole.records import Aperture, Picture, Stage

# Quads a pixel from which on they do not pay.
TOO_MANY = 0.25


@dataclass(frozen=True)
class ApertureJob:
    """What opening to draw.

    Parameters
    ----------
    opening : Opening
        Its shape.
    iris : str, optional
        Iris preset for what the opening leaves out.
    size : int
        Pixels on each side.
    finest : str
        Finest level of the quadtree whose quads are counted.
    quadtree : bool
        Whether to draw the quads, too.
    merge : bool
        Whether to merge quads across the tree's levels.
    """

    opening: Opening = field(default_factory=Opening)
    iris: str | None = None
    size: int = 512
    finest: str = "full"
    quadtree: bool = False
    merge: bool = False


@dataclass(frozen=True, eq=False)
class ApertureResult:
    """A drawn opening.

    Parameters
    ----------
    picture : Picture
        Transmittance as linear grey, with the quads' outlines on it where asked for.
    aperture : Aperture
        The opening itself.
    report : dict
        Plain numbers.
    """

    picture: Picture
    aperture: Aperture
    report: dict[str, Any]


def run_aperture(job: ApertureJob) -> Iterator[Stage]:
    """Run an aperture job.

    Parameters
    ----------
    job : ApertureJob
        What to draw.

    Yields
    ------
    Stage
        The last one holds an `ApertureResult`.
    """
    refuse.at_least("size", job.size, 1)
    yield Stage(0.0, "aperture")
    shape = job.opening.build(job.iris or load("cameras", DEFAULT_CAMERA).iris)
    mask = apertures.rasterize(shape, job.size)
    yield Stage(0.5, "quadtree")
    quads = diffraction.quadtree(mask, shape.width, job.finest)
    counts = {"quads": len(quads)}
    if job.merge:
        quads = diffraction.quadtree(mask, shape.width, job.finest, merge=True)
        counts = {"quads_before_merging": counts["quads"], "quads": len(quads)}
    report = {
        "aperture": shape.name,
        "size": job.size,
        "open_area_fraction": float(mask.mean(dtype=np.float64)),
        "outlines": len(shape.outlines),
        "edges": sum(len(ring.vertices) for ring in shape.outlines),
        **counts,
        "positive_quads": int(np.count_nonzero(quads.weights > 0)),
        "negative_quads": int(np.count_nonzero(quads.weights < 0)),
    }
    if len(quads) > TOO_MANY * (job.size // diffraction.FINEST[job.finest]) ** 2:
        report["note"] = "nearly a quad for every pixel: quads do not pay here, 'auto' takes a fast transform"
    pixels = np.repeat(mask[..., None], 3, axis=2)
    if job.quadtree:
        pixels = quadtree_drawing(quads, diffraction.level_mask(mask, job.finest), shape.width)
    yield Stage(1.0, "aperture", ApertureResult(Picture(pixels), shape, report))
