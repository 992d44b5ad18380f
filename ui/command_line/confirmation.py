"""Confirmation by a person at the terminal."""

import sys

import typer

from ui.command_line.terminal import BAD_INPUT, FAILED, fail


def confirm(question: str, otherwise: str, *, yes: bool) -> None:
    """Ask for a confirmation, and end the command without one.

    Args:
        question: what is confirmed.
        otherwise: clause on what was not done then.
        yes: True to skip the question.
    """
    if yes:
        return
    if sys.stdin is None or not sys.stdin.isatty():
        fail(BAD_INPUT, f"{otherwise}: this needs a confirmation. Run it in a terminal, or add --yes.")
    if not typer.confirm(question, err=True):
        fail(FAILED, f"{otherwise}.")
