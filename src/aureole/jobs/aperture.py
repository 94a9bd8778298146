"""The aperture job: an opening drawn, with the counts that its transforms depend on."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from aureole import aperture as apertures
from aureole import diffraction, picture, refuse
from aureole.diffraction import Quads
from aureole.jobs.drawing import change_drawing, quadtree_drawing, wavefront_drawing
from aureole.jobs.optics import Opening
from aureole.records import Aperture, Picture, Stage

# A change of transmittance below one step of an 8-bit picture is none.
LEAST_CHANGE = 0.01
# Quads a pixel from which on they do not pay.
TOO_MANY = 0.25


@dataclass(frozen=True)
class ApertureJob:
    """What opening to draw; lengths and f-numbers are those of the default camera.

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
    since : str, optional
        Picture of the opening a moment before, as this job draws it; only the quads of the change are
        drawn and counted.
    """

    opening: Opening = field(default_factory=Opening)
    iris: str | None = None
    size: int = 512
    finest: str = "full"
    quadtree: bool = False
    merge: bool = False
    since: str | None = None


@dataclass(frozen=True, eq=False)
class ApertureResult:
    """A drawn opening.

    Parameters
    ----------
    picture : Picture
        Transmittance as linear grey, with the quads' outlines on it where asked for; beside it the
        wavefront where there is one, blue below zero and red above.
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
    shape = job.opening.at_default_camera(job.iris)
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
    if job.since is not None:
        opened, covered = _changed(job, mask, shape.width)
        report |= {"quads_opened": len(opened), "quads_covered": len(covered)}
        pixels = change_drawing(opened, covered, diffraction.level_mask(mask, job.finest), shape.width)
    if shape.wavefront is not None and shape.mask is not None:
        report["wavefront_rms_m"] = apertures.wavefront_rms(shape)
        report["wavefront_peak_to_valley_m"] = float(np.ptp(shape.wavefront[shape.mask > 0]))
        pixels = picture.side_by_side([pixels, wavefront_drawing(shape, len(pixels))])
    yield Stage(1.0, "aperture", ApertureResult(Picture(pixels), shape, report))


def _changed(job: ApertureJob, mask: NDArray[np.float32], width: float) -> tuple[Quads, Quads]:
    """Return the quads that were opened and covered since the picture was drawn."""
    assert job.since is not None
    before = apertures.from_picture(picture.read(job.since), width).mask
    assert before is not None
    if before.shape != mask.shape:
        rows, columns = before.shape
        raise refuse.Refusal(f"'since' must be {job.size} x {job.size} pixels, got {columns} x {rows}.")
    difference = mask - before
    difference[np.abs(difference) < LEAST_CHANGE] = 0
    return diffraction.difference_quads(difference, width, job.finest, job.merge)
