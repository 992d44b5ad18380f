"""Simulated participants of labs, as plug-ins."""

import copy
from collections.abc import Callable, Sequence
from itertools import islice
from typing import Protocol, TypeAlias, get_args

import msgspec

from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.other_programs import RAISED, in_a_line, told_error
from thbridge.roles.participant.bots import TreasureKnowledge
from thbridge.roles.participant.tabui import Player
from thbridge.roles.shared.participant_lines import encode_request_line
from thbridge.roles.shared.view import ParticipantRequest, View

MOST_REQUESTS = 1000
"""Largest number of requests for one view."""


ParticipantCaller: TypeAlias = Callable[[Callable[[], Sequence[ParticipantRequest]]], Sequence[ParticipantRequest]]
"""Function that calls a lab's program and returns its result."""


class ParticipantFactory(Protocol):
    """Factory of a lab's simulated participant: a class or function."""

    def __call__(self, knowledge: TreasureKnowledge, attitude: Attitude, seed: int, /) -> Player:
        """Return the participant of one game.

        Args:
            knowledge: all treasures, and what a picture of each shows.
            attitude: attitude toward what robots say, as the study sets it.
            seed: random seed of the study. The same seed and views must give the same requests.
        """
        ...


class InstalledParticipant:
    """Simulated participant of a lab. If it fails, a built-in participant decides, and the failure is reported.

    Args:
        player: the lab's participant.
        stand_in: the built-in participant.
        call: calls the lab's program; in a trial, with a timeout.
        report: called with each fault.

    Attributes:
        fault: the error of the last view; empty if there was none.
    """

    def __init__(
        self,
        player: Player,
        stand_in: Player,
        call: ParticipantCaller,
        report: Callable[[str], None],
    ) -> None:
        self._player = player
        self._stand_in = stand_in
        self._call = call
        self._report = report
        self.fault = ""

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """Return the requests of the lab's participant, or of the built-in participant if it fails; see `Player`."""
        # A copy, so that the lab's program cannot change the view of the session.
        given = copy.deepcopy(view)
        try:
            requests = self._call(lambda: _checked(self._player.requests(given)))
        except RAISED as error:
            # The game must continue, even if the lab's program raises an error of any kind.
            self.fault = str(error) if isinstance(error, _NotARequest) else told_error(error)
        else:
            self.fault = ""
            return requests
        self._report(self.fault)
        return self._stand_in.requests(view)


class _NotARequest(Exception):  # noqa: N818 - the sentence describes the fault of a lab's program
    pass


def _checked(returned: object) -> Sequence[ParticipantRequest]:
    """Return the requests of a result. Raises _NotARequest if one of them cannot be sent."""
    if isinstance(returned, str | bytes) or not hasattr(returned, "__iter__"):
        raise _NotARequest(f"it returned a {type(returned).__name__}, not a list of requests")
    requests: list[ParticipantRequest] = []
    for request in islice(iter(returned), MOST_REQUESTS + 1):
        if not isinstance(request, get_args(ParticipantRequest)):
            raise _NotARequest(f"a {type(request).__name__} is no request")
        try:
            sent: ParticipantRequest = msgspec.convert(msgspec.to_builtins(request), type(request))
            encode_request_line(sent)
        except (TypeError, ValueError, OverflowError) as error:
            raise _NotARequest(f"{in_a_line(repr(request))} cannot be sent: {in_a_line(str(error))}") from error
        requests.append(sent)
    if len(requests) > MOST_REQUESTS:
        raise _NotARequest(f"it returned more than {MOST_REQUESTS} requests")
    return requests
