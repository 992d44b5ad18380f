"""Players in the role TabUI: simulated participants, or a person at the keyboard."""

from collections.abc import Callable
from dataclasses import dataclass

from thbridge.app.compose.game import build_bot, build_participants, seat_seed
from thbridge.app.compose.setting import StudySetting
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.template_files import TemplateSet
from thbridge.hunt.seats import PlayedBy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.seat_programs import program_of
from thbridge.roles.shared.view import GiveConsent
from thbridge.study.study_file import Study
from ui.command_line.terminal import bad_input, show


@dataclass(frozen=True, slots=True)
class LocalPlayer:
    """Player and its program.

    Attributes:
        tabui: role of the participant.
        typed: function that receives a typed line; None for a simulated participant.
    """

    tabui: TabUI
    typed: Callable[[str], None] | None


def player_of_bot(who: str, templates: TemplateSet, study: Study, seat: str = "") -> LocalPlayer:
    """Return a simulated participant with the study's seed and attitude, and with the kinds of treasures."""
    bot = build_bot(templates, who, seat_seed(study.seed, seat), study.participant.attitude)
    return LocalPlayer(TabUI(bot, seat=seat, by=PlayedBy.PROGRAM), None)


def teammates_of(setting: StudySetting, seat: str) -> tuple[TabUI, ...]:
    """Return simulated participants for all seats except the one with this name."""
    if not seat:
        return ()
    with bad_input():
        return tuple(each for each in build_participants(setting) if each.name != program_of(seat))


def player_of_person(texts: Texts, consent: GiveConsent | None = None, seat: str = "") -> LocalPlayer:
    """Return a player for a person at the keyboard.

    Args:
        texts: texts that are used until the game sends the texts of its language.
        consent: consent of a person who has already agreed to take part.
        seat: name of the person's seat; empty in a game with one participant.
    """
    # Other players need no view model, and the import would take a tenth of the time until a game begins.
    from ui.hosting.terminal_player import TerminalPlayer  # noqa: PLC0415

    person = TerminalPlayer(show, lambda: tabui.room_names, lambda: tabui.texts or texts)
    tabui = TabUI(person, consent=consent, seat=seat, talk=person.talk.hear)

    def typed(line: str) -> None:
        person.type(line)
        if person.declined:
            tabui.decline()
        tabui.poll_player()

    return LocalPlayer(tabui, typed)
