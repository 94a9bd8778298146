"""`python -m aureole.cli` does what `aureole` does."""

from aureole.cli.main import main

main()
