"""The command line: flags in, files out. `aureole --help` is its manual.

main      the entry point: refusals on one line, exit codes
app       the Typer application with its commands
runs      running a job and writing its files
nearfield the command `aureole nearfield`
near_runs running near-field jobs and writing their files
glare     the command `aureole glare`, for cameras and eyes
eye       the command `aureole eye`
eye_runs  running the eye's jobs and writing their files
flare     the command `aureole flare`
lens      the commands `aureole lens`
lamp_glare the command `aureole lights glare`
surface   the commands `aureole surface`
surface_measure  the command `aureole surface measure`
surface_export  the command `aureole surface export`
surface_runs  running the jobs of diffractive surfaces and writing their files
bench     the commands `aureole bench`
options   flags that several commands share
cluster_options flags of who makes frames
occlusion_options  flags of what crops the iris that lights see
pupil_options  flags of vanes, dirt and wavefronts
glare_options  flags of files and of mixing
flare_options  flags of a lens's lights and ghosts
eye_options    flags of eyes, and of what they look at
near_options   flags of planes behind an opening, of many distances, and of ringing textures
surface_options  flags of surfaces and of their tables
surface_measure_options  flags of photographs, of the bench, and of their processing
surface_render_options  flags of objects, lamps, cameras and materials
moving    flags of animations, and the files of their frames
sequence_runs  running sequences of pictures: log, video, exit code
job_commands  job files for every command; the command `aureole run`
job_files  flags read from TOML and written to it
lights_options  which lights of a picture, for several commands
output    progress, reports, and files that appear whole
views     previews, and mattes read from files
"""

from aureole.cli.main import main

__all__ = ["main"]
