"""Question on the terminal whether a person takes part. Nothing is recorded before the answer."""

import typer

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.view import GiveConsent
from thbridge.timing.wall_clock import utc_now
from ui.command_line.event_loop import read_line
from ui.command_line.terminal import DECLINED, NOT_TAKING_PART, fail, say
from ui.model.consent_words import answer_in


def ask_for_consent(texts: Texts, text: str) -> GiveConsent:
    """Show the study's text, and wait for the answer. The answer no, or the end of the input, ends the command."""
    for line in text.splitlines():
        say(line)
    question = texts.text("terminal.question")
    say(question)
    while True:
        line = read_line()
        if not line:
            fail(DECLINED, NOT_TAKING_PART)
        match answer_in(texts, line):
            case True:
                return GiveConsent(utc_now())
            case False:
                say(texts.text("terminal.thanks_not_recorded"))
                raise typer.Exit(DECLINED)
            case None:
                say(question)
