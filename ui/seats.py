"""Players for TabUI, simulated or at the keyboard."""

import asyncio
import sys
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import TypeVar

from thbridge.app.compose import build_bot
from thbridge.files.template_files import TemplateSet
from thbridge.roles.bot_strategy import BotStrategy
from thbridge.roles.tabui import TabUI
from ui.options import ParticipantKind
from ui.terminal import BAD_INPUT, FAILED, bad_input, fail, out
from ui.terminal_player import TerminalPlayer

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Seat:
    """A player and its program.

    Attributes:
        tabui: the role.
        typed: takes in a line of the keyboard; None for a simulated participant.
    """

    tabui: TabUI
    typed: Callable[[str], None] | None


def seat_of_bot(who: ParticipantKind, templates: TemplateSet, seed: int) -> Seat:
    """Seat a simulated participant, who knows the treasures; its chance is keyed by the seed."""
    return Seat(TabUI(build_bot(templates, BotStrategy(who), seed)), None)


def seat_of_person() -> Seat:
    """Seat a person, who knows what the game tells."""
    person = TerminalPlayer(lambda line: out.print(line, highlight=False, markup=False))
    tabui = TabUI(person)

    def typed(line: str) -> None:
        person.type(line)
        tabui.poll_player()

    return Seat(tabui, typed)


def run(program: Coroutine[object, object, T], typed: Callable[[str], None] | None = None) -> T:
    """Run a program to its end, with the keyboard if somebody types. A file at fault ends the command as failed."""
    with bad_input(FAILED):
        return asyncio.run(_with_keyboard(program, typed))


async def _with_keyboard(program: Coroutine[object, object, T], typed: Callable[[str], None] | None) -> T:
    """Run a program; lines are taken in as they are typed, between two ticks."""
    if typed is None:
        return await program
    loop = asyncio.get_running_loop()

    def readable() -> None:
        line = sys.stdin.readline()
        if line:
            typed(line)
        else:
            loop.remove_reader(sys.stdin)

    try:
        loop.add_reader(sys.stdin, readable)
    except (OSError, ValueError):
        program.close()
        fail(BAD_INPUT, "--participant person: standard input is a file or closed. Type in a terminal, or feed a pipe.")
    return await program
