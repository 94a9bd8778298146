"""The command line: flags in, files out. `aureole --help` is its manual.

main      the entry point: refusals on one line, exit codes
app       the Typer application with its commands
options   flags that several commands share
output    progress, reports, and files that appear whole
"""

from aureole.cli.main import main

__all__ = ["main"]
