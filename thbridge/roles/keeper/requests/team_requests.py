"""Requests of participants to each other: texts, votes on decisions, and objections in dialogues."""

from collections.abc import Collection
from typing import TypeAlias

from sim.common.observations import TICKS_PER_SECOND
from thbridge.hunt import rules
from thbridge.hunt.events import DecisionOutcome, DecisionSettled, ObjectionRaised
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.seats import Seat
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.keeper.requests.legacy_lines import LegacyLines
from thbridge.roles.keeper.team.decisions import VotedRequest, request_of
from thbridge.roles.shared.participant_rules import KeeperReason
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.team_notices import MarkRead, RaiseObjection, SayToPeople, Vote
from thbridge.roles.shared.view import EndGame
from thbridge.text_protocol.wire.notice_format import kind_of

TeamRequest: TypeAlias = SayToPeople | MarkRead | Vote | RaiseObjection
"""A request of a participant to the other participants."""

_NOT_AGREED = RequestRefused(KeeperReason.NOT_AGREED_ON, "The team has not agreed to this.")
_HAS_ENDED = RequestRefused(KeeperReason.DIALOGUE_ENDED, "This dialogue has ended.")


def handle_team_request(game: OpenGame, state: GameState, request: TeamRequest, seat: Seat) -> None:
    """Carry out a request of the participant of a seat, or store its refusal."""
    now = game.tick / TICKS_PER_SECOND
    match request:
        case SayToPeople():
            said = game.team.talk.say(seat, request, state.started.seats, now)
            if isinstance(said, RequestRefused):
                game.refuse(kind_of(SayToPeople), said)
            else:
                game.record(said)
        case MarkRead(line):
            game.record(game.team.talk.read(seat.name, line, now))
        case Vote(decision, agrees, reason):
            game.record(game.team.decisions.vote(seat.name, decision, reason, now, agrees=agrees))
        case RaiseObjection():
            objected = _object(game, state, request, seat, now)
            if isinstance(objected, RequestRefused):
                game.refuse(kind_of(RaiseObjection), objected)
            else:
                game.record(objected)


def _object(
    game: OpenGame, state: GameState, request: RaiseObjection, seat: Seat, now: float
) -> tuple[ObjectionRaised, ...] | RequestRefused:
    """Return the event of an objection, or a refusal."""
    talks = game.dialogues
    refused = why_not_allowed(state, seat, request, talks.under_way.matter_of(request.dialogue))
    if refused is not None:
        return refused
    dialogue = talks.under_way.numbered(request.dialogue)
    if dialogue is None:
        return _HAS_ENDED
    after, is_open = talks.sentence_count(dialogue), game.team.talk.is_open(now)
    return game.team.objections.object_to(dialogue, seat, request, after, now, talk_is_open=is_open)


def propose(
    game: OpenGame, state: GameState, request: VotedRequest, seat: Seat, people: int, lines: LegacyLines
) -> bool:
    """Open a vote on a request if it needs the agreement of several participants. Return False if it does not.

    Args:
        game: the game in progress.
        state: state of the game.
        request: the request.
        seat: seat of the participant.
        people: number of participants who are present.
        lines: handler of requests that are lines of 2016.
    """
    if not game.team.decisions.needs_vote(request, people):
        return False
    refused = _why_not(state, request, seat, lines)
    if refused is not None:
        game.refuse(kind_of(type(request)), refused)
    else:
        game.record(game.team.decisions.propose(seat.name, request, people, game.tick / TICKS_PER_SECOND))
    return True


def settle(game: OpenGame, present: Collection[str], lines: LegacyLines) -> bool:
    """End the votes that are due, and carry out what was agreed. Return True if a vote has ended."""
    now = game.tick / TICKS_PER_SECOND
    ended = [*_void(game, lines, now), *game.team.decisions.due(present, now)]
    done: set[int] = set()
    for entry in ended:
        proposed = game.team.decisions.proposed(entry.decision)
        if entry.decision in done or proposed is None or game.state is None:
            continue
        done.add(entry.decision)
        game.record((entry,))
        seat = game.state.seat(proposed.seat)
        if seat is None:
            continue
        request = request_of(proposed, game.state.started.game)
        with game.acting(seat.name):
            if entry.outcome is not DecisionOutcome.CARRIED:
                game.refuse(kind_of(type(request)), _NOT_AGREED)
            elif isinstance(request, EndGame):
                game.apply_ruling(kind_of(EndGame), rules.end_game(game.state))
            else:
                lines.carry_out(game.state, request, seat)
    return bool(done)


def _void(game: OpenGame, lines: LegacyLines, now: float) -> tuple[DecisionSettled, ...]:
    state = game.state
    if state is None:
        return ()
    impossible = []
    for proposed in game.team.decisions.open:
        seat = state.seat(proposed.seat)
        request = request_of(proposed, state.started.game)
        if seat is None or _why_not(state, request, seat, lines) is not None:
            impossible.append(proposed.decision)
    return game.team.decisions.void(impossible, now)


def _why_not(state: GameState, request: VotedRequest, seat: Seat, lines: LegacyLines) -> RequestRefused | None:
    """Return the reason why a request is impossible now, also if all participants agreed, or None."""
    refused = why_not_allowed(state, seat, request)
    if refused is not None:
        return refused
    ruling = rules.end_game(state) if isinstance(request, EndGame) else lines.ruling(state, request)
    return ruling if isinstance(ruling, RequestRefused) else None
