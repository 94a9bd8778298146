"""Jobs: a frozen record each, and run(job) that yields stages. Every face of Aureole calls these.

In: records of plain values, pictures. Out: `Stage`s, the last of which holds the job's result.

optics          descriptions of apertures and cameras as people give them, made into records
glare           the main job: a picture with the glare that a camera adds
glare_field     the same with kernels that change over the frame
starburst       a point spread function, or a kernel for another program
aperture        an aperture drawn, with its quadtree's counts
near_field      the light on a plane behind an opening or an obstacle
near_sweep      the same at many distances: planes, a strip of them, a section along the axis
near_texture    a ringing texture for the ghosts of a lens
flare           the ghosts of a lens and the starbursts, for given lights, on black or over a picture
flare_lights    its lights as people give them, measured or found in the picture
lights          the lights that pictures show, found in one or followed through a shot
glare_lights    which lights of a picture make glare: all that are bright, or those of a file
scene           lamps and occluders as a file describes them, where they are at a frame
lamp_glare      a frame of such a scene: each lamp seen in part, with the glare of that part
lamp_frames     many of its frames
lights_preview  a picture with its lights marked
flare_ringing   its ghosts one by one, each with the ringing of what the housing leaves of the iris
flare_starburst its starbursts, where each light stands
eye             what a point of light looks like to an eye, at a time or through time
eye_glare       a picture as an eye sees it at a time
eye_glare_frames the same through time, by waves of its own or from flipbooks
glare_sources   which light of a sequence's frames makes glare: mattes and lights
eye_sequence    each frame of a sequence as an eye sees it at its time
frames          frames of an animation: which there are, which are done; one frame of a sequence, alone
frame_files     numbered files: names with #### for the number, lists of frames, which lie there whole
sequence        frames of a sequence from files to files, whatever befalls one of them
glare_occlusion glare of lights behind something, in pictures that were made
glare_sequence  a camera's glare on each frame of a sequence, its kernel made once
flare_sequence  the flare of a lens on each frame of a sequence
sequence_video  a sequence as a video to look at
sequence_sheet  its frames made small, on one sheet
eye_preview     a point spread function of an eye drawn with degrees
viewer          an eye as people describe it, and the light that it is adapted to
measures        a pupil's transfer functions, Strehl ratio and encircled energy, on the sensor
lens            a lens as numbers, and what looks wrong in it
lens_ghosts     a lens's ghosts by their energy
lens_drawing    a lens drawn, with rays and ghosts
page            one page about a point spread function
drawing         an aperture's quads drawn
contact_sheet   small pictures of many on one sheet
surface         a diffractive surface's table, and what it is in numbers
surface_sources surfaces as people describe them: presets, slits, heights, tables in files
surface_preview a table drawn over h
surface_measure photographs of a sample, and the table that they make
surface_export  a surface for other software
surface_scene   what suits a surface that is drawn: object, distance, metals
surface_render  pictures of a diffractive surface on an object, still or turning
cluster         who makes frames: this process, several of this machine, or a cluster's machines
cluster_frames  a sequence's frames made by them
cluster_worker  what a worker of this machine does before its first frame
cluster_versions what a machine has that frames depend on
demo            the main job on the bundled scene
run             run(job): the one door to all of them
"""

from aureole.jobs.aperture import ApertureJob, ApertureResult
from aureole.jobs.cluster import Crew, Delivery, deliver
from aureole.jobs.cluster_frames import spread_over
from aureole.jobs.demo import DemoJob, DemoResult
from aureole.jobs.eye import QUICK_GRID, EyeAnimationJob, EyeJob, EyeResult
from aureole.jobs.eye_glare import EyeGlareJob, EyeGlareResult
from aureole.jobs.eye_glare_frames import EyeGlareAnimationJob
from aureole.jobs.eye_preview import eye_brightness, write_eye_preview
from aureole.jobs.eye_sequence import EyeGlareMaker
from aureole.jobs.flare import FlareJob, FlareResult
from aureole.jobs.flare_lights import Lamp
from aureole.jobs.flare_sequence import FlareMaker
from aureole.jobs.frames import (
    AnimationResult,
    Frame,
    FrameMaker,
    FrameOutcome,
    Frames,
    FrameTask,
    Pace,
    run_frame,
)
from aureole.jobs.glare import GlareJob, GlareResult, read_matte
from aureole.jobs.glare_field import LENS_RIMS, GlareField
from aureole.jobs.glare_lights import GlareLights, lights_of_frame, lit_by
from aureole.jobs.glare_occlusion import GlareOcclusion
from aureole.jobs.glare_sequence import GlareMaker
from aureole.jobs.glare_sources import GlareSources
from aureole.jobs.lamp_frames import LampMaker, lamp_tasks
from aureole.jobs.lamp_glare import LampGlareJob, LampGlareResult
from aureole.jobs.lens import lens_list, lens_report
from aureole.jobs.lens_drawing import check_drawing, write_drawing
from aureole.jobs.lens_ghosts import lens_ghosts
from aureole.jobs.lights import (
    LightsJob,
    LightsResult,
    LostFrame,
    placed_lamps,
    shot_threshold,
    shown_corner,
    shown_lamps,
    shown_shape,
)
from aureole.jobs.lights_preview import lights_drawing
from aureole.jobs.measures import PupilMeasures, pupil_measures
from aureole.jobs.near_field import NearFieldJob, NearFieldResult
from aureole.jobs.near_sweep import (
    NearFrame,
    NearSectionJob,
    NearSectionResult,
    NearSweepJob,
    NearSweepResult,
    Sweep,
)
from aureole.jobs.near_texture import NearTextureJob, NearTextureResult
from aureole.jobs.optics import Opening, Optics
from aureole.jobs.page import check_page, write_page
from aureole.jobs.run import finish, run
from aureole.jobs.scene import SceneFile, read_scene
from aureole.jobs.sequence import SequenceJob, SequenceResult, sequence_tasks
from aureole.jobs.sequence_sheet import sheet_stages
from aureole.jobs.sequence_video import video_stages
from aureole.jobs.starburst import StarburstJob, StarburstResult
from aureole.jobs.surface import SurfaceTableJob, SurfaceTableResult, order_rows
from aureole.jobs.surface_export import SurfaceExport, export, export_places, export_target
from aureole.jobs.surface_measure import Bracket, SurfaceMeasureJob
from aureole.jobs.surface_preview import write_table_preview
from aureole.jobs.surface_render import (
    SurfaceRenderJob,
    SurfaceRenderResult,
    SurfaceTurnJob,
    render_exposure,
)
from aureole.jobs.surface_scene import METALS, fitting_distance, usual_shape
from aureole.jobs.surface_sources import (
    TABLE_SUFFIXES,
    grating_titles,
    heights_from_file,
    is_table,
    named_table_stages,
    read_pixels,
    read_plane,
    surface_from_bokeh,
)
from aureole.jobs.viewer import Viewer

__all__ = [
    "LENS_RIMS",
    "METALS",
    "QUICK_GRID",
    "TABLE_SUFFIXES",
    "AnimationResult",
    "ApertureJob",
    "ApertureResult",
    "Bracket",
    "Crew",
    "Delivery",
    "DemoJob",
    "DemoResult",
    "EyeAnimationJob",
    "EyeGlareAnimationJob",
    "EyeGlareJob",
    "EyeGlareMaker",
    "EyeGlareResult",
    "EyeJob",
    "EyeResult",
    "FlareJob",
    "FlareMaker",
    "FlareResult",
    "Frame",
    "FrameMaker",
    "FrameOutcome",
    "FrameTask",
    "Frames",
    "GlareField",
    "GlareJob",
    "GlareLights",
    "GlareMaker",
    "GlareOcclusion",
    "GlareResult",
    "GlareSources",
    "Lamp",
    "LampGlareJob",
    "LampGlareResult",
    "LampMaker",
    "LightsJob",
    "LightsResult",
    "LostFrame",
    "NearFieldJob",
    "NearFieldResult",
    "NearFrame",
    "NearSectionJob",
    "NearSectionResult",
    "NearSweepJob",
    "NearSweepResult",
    "NearTextureJob",
    "NearTextureResult",
    "Opening",
    "Optics",
    "Pace",
    "PupilMeasures",
    "SceneFile",
    "SequenceJob",
    "SequenceResult",
    "StarburstJob",
    "StarburstResult",
    "SurfaceExport",
    "SurfaceMeasureJob",
    "SurfaceRenderJob",
    "SurfaceRenderResult",
    "SurfaceTableJob",
    "SurfaceTableResult",
    "SurfaceTurnJob",
    "Sweep",
    "Viewer",
    "check_drawing",
    "check_page",
    "deliver",
    "export",
    "export_places",
    "export_target",
    "eye_brightness",
    "finish",
    "fitting_distance",
    "grating_titles",
    "heights_from_file",
    "is_table",
    "lamp_tasks",
    "lens_ghosts",
    "lens_list",
    "lens_report",
    "lights_drawing",
    "lights_of_frame",
    "lit_by",
    "named_table_stages",
    "order_rows",
    "placed_lamps",
    "pupil_measures",
    "read_matte",
    "read_pixels",
    "read_plane",
    "read_scene",
    "render_exposure",
    "run",
    "run_frame",
    "sequence_tasks",
    "sheet_stages",
    "shot_threshold",
    "shown_corner",
    "shown_lamps",
    "shown_shape",
    "spread_over",
    "surface_from_bokeh",
    "usual_shape",
    "video_stages",
    "write_drawing",
    "write_eye_preview",
    "write_page",
    "write_table_preview",
]
