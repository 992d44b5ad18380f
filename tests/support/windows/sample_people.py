"""Sample of the panel of the people in a game, in any language."""

from collections.abc import Callable

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.seats import Seat, StopRight
from thbridge.roles.shared.team_notices import LONGEST_TEXT
from ui.model.playing.people import commands_words, may_words
from ui.model.playing.screen import (
    Action,
    ChooseAddressee,
    MarkReadAct,
    PeoplePanel,
    PersonRow,
    PersonText,
    SayToPeopleAct,
)


def people(texts: Texts, label: Callable[[str], str] = lambda seat: f"the {seat}") -> PeoplePanel:
    """Return a panel with three people, some texts, a text on its way, and a draft."""
    driver, namer, scout = label("driver"), label("namer"), label("scout")
    rights = Seat("namer", namer, stops=StopRight.ALL)

    def row(seat: str, name: str, robots: tuple[int, ...], presence: str, *, present: bool) -> PersonRow:
        return PersonRow(seat, name, present, presence, commands_words(texts, robots), robots, may_words(texts, rights))

    to_scout = texts.text("people.to_one", who=texts.text("window.you"), other=scout)
    to_you = texts.text("people.to_you", who=scout)
    you = texts.text("window.you")
    everyone = texts.text("people.everyone")
    names = (("", everyone), ("driver", driver), ("scout", scout))
    return PeoplePanel(
        title=texts.text("people.title"),
        own=row("namer", texts.text("people.you", who=namer), (), "", present=True),
        others=(
            row("driver", driver, (0, 1), texts.text("people.here"), present=True),
            row("scout", scout, (2,), texts.text("people.away"), present=False),
        ),
        texts=(
            PersonText(1, driver.capitalize(), "12 + 13 = 25", "0:04", own=False),
            PersonText(2, to_scout, "2, 4", "0:09", own=True),
            PersonText(3, to_you, "4? " * 30, "0:31", own=False, new=True),
            PersonText(0, you, "8", "", own=True, pending=True),
        ),
        nothing="",
        unread=1,
        news=texts.text("people.news", count=1),
        read=MarkReadAct(3),
        writes=True,
        closed="",
        addressees=tuple(
            Action(ChooseAddressee(seat), name, "", hint=texts.text("people.write_to", who=name))
            for seat, name in names
        ),
        to="",
        prompt=texts.text("people.write_to", who=everyone),
        draft="1 2 3",
        restored=0,
        send=Action(SayToPeopleAct(""), texts.text("people.send"), "Enter"),
        longest=LONGEST_TEXT,
    )
