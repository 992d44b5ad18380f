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
    """The participant's program is from 2016 and cannot ask for consent."""

    @property
    def recordable(self) -> bool:
        """True if the participant may be recorded."""
        return self not in {ConsentStatus.AWAITED, ConsentStatus.DECLINED}


CONSENT_SENTENCES = {
    ConsentStatus.AWAITED: "nothing is recorded until the participant has agreed to take part",
    ConsentStatus.GIVEN: "the participant has agreed to take part, and the game is recorded",
    ConsentStatus.DECLINED: "the participant does not take part: nothing is recorded, and the next participant "
    "can join",
    ConsentStatus.NOT_ASKED: "this TabUI is a program of 2016 and cannot ask for consent: ask the participant "
    "yourself; the game is recorded",
}
"""Sentences for the researcher about the state of the participant's consent."""


class ConsentAnswer:
    """The consent of the present participant.

    If consent is given before a game, it is stored for this game. A refusal is final for the program that sends it;
    only another program is asked again. Consent is also valid for later games, until another program joins after the
    end of a game. This program may belong to another person, who is asked before they see any game data.

    Args:
        asked: True if the study has a consent text.
        seat: name of the participant's seat.
    """

    def __init__(self, asked: bool, seat: str = "") -> None:
        self._asked = asked
        self._seat = seat
        self._early: GiveConsent | None = None
        self._declined = False
        self._legacy = False
        self._run = ""
        self._another = False

    def join(self, state: GameState | None, run: str) -> None:
        """Process the joining of a program that can ask for consent. For `run`, see `ParticipantReady`."""
        self._declined = self._legacy = False
        if state is not None and state.ended is not None and run != self._run:
            self._early, self._another = None, True
        self._run = run

    def note_legacy(self) -> None:
        """Record that the participant's program is from 2016."""
        self._legacy = True

    def agree(self, state: GameState | None, consent: GiveConsent) -> tuple[ConsentGiven, ...]:
        """Return the event of consent in this game. Empty if consent is for the next game or has no effect."""
        if self._declined and self.awaited(state):
            return ()
        if state is not None and not self._another:
            return () if self._seat in state.agreements else (ConsentGiven(consent.at),)
        if self._asked and self._early is None:
            self._early = consent
        return ()

    def decline(self, state: GameState | None) -> None:
        """Record that the participant declined, unless they have already agreed."""
        self._declined = self.awaited(state)

    def first_events(self, former: GameState | None) -> tuple[ConsentGiven, ...]:
        """Return the event of consent directly after the start of a game. Empty if there is no consent yet.

        Args:
            former: state of the previous game, whose consent stays valid. None before the first game.
        """
        early, self._early = self._early, None
        another, self._another = self._another, False
        if early is not None:
            return (ConsentGiven(early.at),)
        if former is None or another or self._seat not in former.agreements:
            return ()
        return (ConsentGiven(former.agreements[self._seat]),)

    def awaited(self, state: GameState | None) -> bool:
        """Return True if the game waits for the participant's consent."""
        agreed = self._early is not None if state is None or self._another else self._seat in state.agreements
        return self._asked and not agreed

    def status(self, state: GameState | None) -> ConsentStatus:
        """Return the state of consent in this game. `state` is None before the first game."""
        if not self._asked:
            return ConsentStatus.NOT_NEEDED
        if not self.awaited(state):
            return ConsentStatus.GIVEN
        if self._legacy:
            return ConsentStatus.NOT_ASKED
        return ConsentStatus.DECLINED if self._declined else ConsentStatus.AWAITED
