"""The participant's answer to the study's consent text, before and during a game."""

from enum import Enum

from thbridge.hunt.events import ConsentGiven
from thbridge.hunt.game import GameState
from thbridge.roles.shared.view import GiveConsent


class ConsentStatus(Enum):
    """State of the participant's consent to take part."""

    NOT_NEEDED = "not needed"
    AWAITED = "awaited"
    GIVEN = "given"
    DECLINED = "declined"
    NOT_ASKED = "not asked"
    """The participant's program is of 2016 and cannot ask."""

    @property
    def recordable(self) -> bool:
        """True when what the participant does may be recorded."""
        return self not in {ConsentStatus.AWAITED, ConsentStatus.DECLINED}


CONSENT_SENTENCES = {
    ConsentStatus.AWAITED: "nothing is recorded until the participant has agreed to take part",
    ConsentStatus.GIVEN: "the participant has agreed to take part, and the game is recorded",
    ConsentStatus.DECLINED: "the participant does not take part: nothing is recorded, and the next one can join",
    ConsentStatus.NOT_ASKED: "this TabUI is a program of 2016, which cannot ask for consent: ask the participant "
    "yourself; the game is recorded",
}
"""Sentences for the researcher about the participant's consent."""


class ConsentAnswer:
    """The consent of the present participant.

    A yes before a game is kept for that game. A no is final for the program that sends it: only another program that
    joins is asked again. A yes applies to later games too, until another program joins after the end of a game. That
    program may belong to the next person, who is asked before they see anything of the game.

    Args:
        asked: True if the study has a consent text.
    """

    def __init__(self, asked: bool) -> None:
        self._asked = asked
        self._early: GiveConsent | None = None
        self._declined = False
        self._legacy = False
        self._run = ""
        self._another = False

    def join(self, state: GameState | None, run: str) -> None:
        """Note that a participant's program that can ask has joined; `run` as in `ParticipantReady`."""
        self._declined = self._legacy = False
        if state is not None and state.ended is not None and run != self._run:
            self._early, self._another = None, True
        self._run = run

    def note_legacy(self) -> None:
        """Note that the participant's program is of 2016."""
        self._legacy = True

    def agree(self, state: GameState | None, consent: GiveConsent) -> tuple[ConsentGiven, ...]:
        """Return the event of a yes in this game; empty if the yes is kept for the next game, or has no effect."""
        if self._declined and self.awaited(state):
            return ()
        if state is not None and not self._another:
            return () if state.agreed else (ConsentGiven(consent.at),)
        if self._asked and self._early is None:
            self._early = consent
        return ()

    def decline(self, state: GameState | None) -> None:
        """Note a no, unless the participant has agreed already."""
        self._declined = self.awaited(state)

    def first_events(self, former: GameState | None) -> tuple[ConsentGiven, ...]:
        """Return the consent as the first event after the start of a game; empty if there is none yet.

        Args:
            former: the previous game, after which consent stays valid; None before the first game.
        """
        early, self._early = self._early, None
        another, self._another = self._another, False
        if early is not None:
            return (ConsentGiven(early.at),)
        return (ConsentGiven(former.agreed_at),) if former is not None and former.agreed and not another else ()

    def awaited(self, state: GameState | None) -> bool:
        """Return True while the participant still has to agree to take part."""
        agreed = self._early is not None if state is None or self._another else state.agreed
        return self._asked and not agreed

    def status(self, state: GameState | None) -> ConsentStatus:
        """Return the state of consent in this game; `state` is None before the first game."""
        if not self._asked:
            return ConsentStatus.NOT_NEEDED
        if not self.awaited(state):
            return ConsentStatus.GIVEN
        if self._legacy:
            return ConsentStatus.NOT_ASKED
        return ConsentStatus.DECLINED if self._declined else ConsentStatus.AWAITED
