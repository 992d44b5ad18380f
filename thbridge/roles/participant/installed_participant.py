"""Plug-ins for simulated participants that a lab installs."""

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
"""Maximum number of requests for one view."""


ParticipantCaller: TypeAlias = Callable[[Callable[[], Sequence[ParticipantRequest]]], Sequence[ParticipantRequest]]
"""Function that calls a lab's program and returns its result."""


class ParticipantFactory(Protocol):
    """Class or function of a lab that creates a simulated participant."""

    def __call__(self, knowledge: TreasureKnowledge, attitude: Attitude, seed: int, /) -> Player:
        """Return the participant of one game.

        Args:
            knowledge: all treasures, and their pictures.
            attitude: attitude to robots' claims, from the study.
            seed: random seed of the study. The same seed and views must give the same requests.
        """
        ...


class InstalledParticipant:
    """Simulated participant of a lab. If its code fails, a built-in participant decides, and the failure is reported.

    Args:
        player: the lab's participant.
        stand_in: the built-in participant for the case of a failure.
        call: function that calls the lab's code; in a trial, with a timeout.
        report: function that receives each fault.

    Attributes:
        fault: the error for the last view; empty if there was none.
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
        # Make a copy, so that the lab's code cannot change the view of the session.
        given = copy.deepcopy(view)
        try:
            requests = self._call(lambda: _checked(self._player.requests(given)))
        except RAISED as error:
            # The game must continue, even if the lab's code raises any error.
            self.fault = str(error) if isinstance(error, _NotARequest) else told_error(error)
        else:
            self.fault = ""
            return requests
        self._report(self.fault)
        return self._stand_in.requests(view)


class _NotARequest(Exception):  # noqa: N818 - the sentence describes the fault of a lab's program
    pass


def _checked(returned: object) -> Sequence[ParticipantRequest]:
    """Return the requests in a result. Raises _NotARequest if a request cannot be sent."""
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
