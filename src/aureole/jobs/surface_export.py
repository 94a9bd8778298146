"""A diffractive surface for other software: a page for browsers, Mitsuba, GLSL, glTF."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aureole import picture, refuse, surface
from aureole.jobs.surface_render import SurfaceRenderJob

# What each target's file is called.
TARGETS = {"web": ".html", "mitsuba": ".xml", "glsl": ".glsl", "gltf": ".gltf"}
# Those whose shaders read the table in RGB from a file beside theirs.
SHADERS = ("glsl", "gltf")


@dataclass(frozen=True, eq=False)
class SurfaceExport:
    """What to write for which software.

    Parameters
    ----------
    target : str
        One of `TARGETS`.
    path : Path
        The file to write.
    scene : SurfaceRenderJob
        Table, object, light and material; only the table of a target that has no scene.
    table_file : Path, optional
        Where the table lies.
    title : str
        Of a page.
    source : Path, optional
        A glTF file that gets the table; a new one with one object where it is left out.
    material : str, optional
        The name of the material in it that gets the table.
    size : int
        Longest side of a page's table.
    """

    target: str
    path: Path
    scene: SurfaceRenderJob
    table_file: Path | None = None
    title: str = "Diffractive surface"
    source: Path | None = None
    material: str | None = None
    size: int = 512


def export_target(path: Path, target: str | None) -> str:
    """Return for which software a file is, and refuse a suffix that does not fit.

    Parameters
    ----------
    path : Path
        File to write.
    target : str, optional
        One of `TARGETS`; by the suffix where it is left out.

    Returns
    -------
    str
        The target.

    Raises
    ------
    refuse.Refusal
        Where suffix and target do not go together.
    """
    suffix = path.suffix.lower()
    if target is None:
        refuse.one_of(f"suffix of {path.name}", suffix, TARGETS.values())
        return next(name for name, its in TARGETS.items() if its == suffix)
    refuse.one_of("to", target, TARGETS)
    refuse.one_of(f"suffix of {path.name}", suffix, (TARGETS[target],))
    return target


def export_places(asked: SurfaceExport) -> list[Path]:
    """Return the files that an export writes, and refuse those that cannot be written.

    Parameters
    ----------
    asked : SurfaceExport
        What to write.

    Returns
    -------
    list of Path
        The file first.

    Raises
    ------
    refuse.Refusal
        Where a folder is missing, or the table itself would be written over.
    """
    files = [asked.path]
    if asked.target in SHADERS or (asked.target == "mitsuba" and asked.table_file is None):
        beside = asked.path.with_suffix(".exr")
        if asked.table_file is not None and beside.resolve() == asked.table_file.resolve():
            raise refuse.Refusal(
                f"'{beside}' would be written over: shaders want the table in RGB beside theirs; "
                "give the output another name."
            )
        files += [beside, surface.sidecar_of(beside)]
    return [picture.writable(path) for path in files]


def export(asked: SurfaceExport) -> dict[str, Any]:
    """Write a surface for other software; each file appears whole or not at all.

    Parameters
    ----------
    asked : SurfaceExport
        What to write.

    Returns
    -------
    dict
        Plain numbers that the other software needs.

    Raises
    ------
    refuse.Refusal
        Where the target cannot hold what is asked, or a file cannot be written.
    """
    files = export_places(asked)
    table, shape = asked.scene.table, asked.scene.shape
    told: dict[str, Any] = {"target": asked.target}
    if asked.target == "web":
        view = surface.web_view(_scene(asked.scene), shape, table=table)
        surface.write_page(asked.path, table, view, asked.title, asked.size)
        return told | {"open": asked.path.resolve().as_uri()}
    if asked.target == "mitsuba":
        if isinstance(shape, surface.Mesh):
            raise refuse.Refusal("'shape' of a Mitsuba scene must be disc, plane or cylinder, not a mesh.")
        if asked.table_file is None:
            surface.write_table(files[1], table)
        texture = _beside(asked.table_file or files[1], asked.path)
        surface.write_mitsuba(asked.path, texture, _scene(asked.scene), shape)
    elif asked.target == "glsl":
        texture = files[1].name
        surface.write_glsl(asked.path, table)
    else:
        texture = files[1].name
        kind = "disc" if isinstance(shape, surface.Disc) else "plane"
        surface.write_table(files[1], table, "rec709")
        surface.write_gltf(asked.path, table, texture, asked.source, asked.material, shape=kind)
    return told | {"table": texture, "half_range": table.half_range, "warp": table.warp}


def _scene(job: SurfaceRenderJob) -> surface.Scene:
    pose = surface.pose_of(tilt=job.tilt, turn=job.turn, spin=job.spin)
    return surface.Scene(job.lamps, job.view, pose, job.material)


def _beside(table: Path, path: Path) -> str:
    """Return where a table lies as a file's own folder sees it."""
    return os.path.relpath(table, path.parent).replace(os.sep, "/")
