"""Confirmation by the person at the terminal."""

import sys

import typer

from ui.command_line.terminal import BAD_INPUT, FAILED, fail


def confirm(question: str, otherwise: str, *, yes: bool) -> None:
    """Ask for a confirmation; end the command if there is none.

    Args:
        question: the question to ask.
        otherwise: clause for the error message that says what was not done.
        yes: True to skip the question.
    """
    if yes:
        return
    if sys.stdin is None or not sys.stdin.isatty():
        fail(BAD_INPUT, f"{otherwise}: this needs a confirmation. Run it in a terminal, or add --yes.")
    if not typer.confirm(question, err=True):
        fail(FAILED, f"{otherwise}.")
