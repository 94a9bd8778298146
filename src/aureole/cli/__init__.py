"""The command line: flags in, files out. `aureole --help` is its manual.

main      the entry point: refusals on one line, exit codes
app       the Typer application with its commands
runs      running a job and writing its files
bench     the commands `aureole bench`
options   flags that several commands share
pupil_options  flags of vanes, dirt and wavefronts
output    progress, reports, and files that appear whole
views     previews, and mattes read from files
"""

from aureole.cli.main import main

__all__ = ["main"]
