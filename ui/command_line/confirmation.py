"""Confirmation by the person at the terminal."""

import sys

import typer

from ui.command_line.terminal import BAD_INPUT, FAILED, fail


def confirm(question: str, otherwise: str, *, yes: bool) -> None:
    """Ask the user for a confirmation; end the command if the user does not confirm.

    Args:
        question: the question to ask.
        otherwise: beginning of the error message, such as "Nothing was deleted".
        yes: True to skip the question.
    """
    if yes:
        return
    if sys.stdin is None or not sys.stdin.isatty():
        fail(BAD_INPUT, f"{otherwise}: the command needs a confirmation. Run it in a terminal, or add --yes.")
    if not typer.confirm(question, err=True):
        fail(FAILED, f"{otherwise}.")
