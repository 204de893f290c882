"""`python -m weingarten`: the command."""

from weingarten.cli.main import command

command()
