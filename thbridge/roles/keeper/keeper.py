"""The keeper of the game. Only the keeper changes treasures, visited rooms, energy and score.

The keeper runs next to the router, reads every forwarded line (a *tap*), and receives requests as notices. Its
decisions are events. The caller must write the events to the journal before it sends the messages of the same step. So
a crash cannot lose an event that another program already knows.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias, get_args

from sim.common.frozen import frozen
from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.engine import DialogueEngine
from thbridge.dialogue.moves import DialogueUtterance
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import (
    Event,
    GameStarted,
    JournalEntry,
    JournalOnly,
    TeamEntry,
)
from thbridge.hunt.game import GameState
from thbridge.hunt.properties import TreasureProperty
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rules import MOST_ROBOTS
from thbridge.hunt.seats import ONE_SEAT, PlayedBy, Seat
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.roles.keeper.advice.robot_knowledge import RobotKnowledge
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.keeper.disclosed.consent import ConsentStatus
from thbridge.roles.keeper.disclosed.debriefing import debrief_of
from thbridge.roles.keeper.disclosed.disclosure import view_of
from thbridge.roles.keeper.disclosed.seats import ParticipantSeat, view_of_seat
from thbridge.roles.keeper.initiative import decide_alone, report_failures
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.keeper.programs import ConnectedHider, ConnectedTeam
from thbridge.roles.keeper.requests.legacy_lines import LegacyLines, LineReason, undone
from thbridge.roles.keeper.requests.participant_requests import handle_participant_request
from thbridge.roles.keeper.requests.station_requests import (
    handle_station_request,
    kept_commands,
    return_robots,
    sense_for_stations,
)
from thbridge.roles.keeper.requests.team_requests import handle_team_request, propose, settle
from thbridge.roles.keeper.requests.wizard import WizardState, handle_wizard_request, wizard_state
from thbridge.roles.keeper.team.game_team import TeamRules
from thbridge.roles.shared.notices import (
    KEEPER,
    ConsentQuery,
    HiderReady,
    HideTreasures,
    LegacyReply,
    MoveCosts,
    ParticipantFault,
    ParticipantReady,
    RobotsReady,
    TeamRejection,
    TeamStatus,
)
from thbridge.roles.shared.participant_lines import decode_request_line
from thbridge.roles.shared.participant_rules import KeeperReason
from thbridge.roles.shared.robot_requests import CommandRequest, GameRequest
from thbridge.roles.shared.seat_programs import is_researchers, researchers_program, seat_of, why_no_seat
from thbridge.roles.shared.team_notices import MarkRead, RaiseObjection, ReportPresence, SayToPeople, Vote
from thbridge.roles.shared.view import (
    Debrief,
    DeclineConsent,
    EndGame,
    GiveConsent,
    IdentifyTreasure,
    ParticipantRequest,
    PlayAgain,
    SendRobot,
    SenseTreasure,
    TakePicture,
)
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextCommand, TextMessage
from thbridge.text_protocol.wire.notice_format import (
    Notice,
    NoticeDecoder,
    NoticeValue,
    encode_notice,
    is_notice,
    kind_of,
    parse_notice,
)
from thbridge.text_protocol.wire.router import Forwarded, NameRefusal

KeeperNotice: TypeAlias = (
    RobotsReady
    | TeamStatus
    | MoveCosts
    | HiderReady
    | HideTreasures
    | ParticipantReady
    | ParticipantFault
    | ReportPresence
    | ConsentQuery
    | DeclineConsent
    | ParticipantRequest
)
"""A notice to the keeper."""

KEEPER_NOTICES = NoticeDecoder[KeeperNotice](KeeperNotice)

_BY_IMPORTANCE = (
    ConsentStatus.DECLINED,
    ConsentStatus.AWAITED,
    ConsentStatus.NOT_ASKED,
    ConsentStatus.GIVEN,
    ConsentStatus.NOT_NEEDED,
)
_HAS_SEATS = RequestRefused(KeeperReason.HAS_SEATS, "This game has several seats, which programs of 2016 cannot take.")
_BEFORE_AGREEING = RequestRefused(KeeperReason.NOT_AGREED, "You have not agreed to take part yet.")
_WISHES = {kind_of(kind) for kind in get_args(ParticipantRequest)}
_AFTER_AGREEING = _WISHES - {kind_of(GiveConsent)}
_COUNTED_WISHES = _AFTER_AGREEING - {kind_of(PlayAgain)}
"""Requests whose repetitions are ignored. `PlayAgain` is not included: it names the finished game, so repetitions have
no effect. Programs repeat it until robots join."""
_REPORTS = {kind_of(TeamStatus), kind_of(MoveCosts)}
"""Regular reports of SimR. Most of them change nothing."""
_PERSONAL = {kind_of(kind) for kind in (GiveConsent, DeclineConsent, PlayAgain, ReportPresence)}
"""Notices that a researcher in the place of a participant cannot send."""
_QUOTED = 200
"""Maximum number of characters in the quotation of a refused line."""


@dataclass(frozen=True, slots=True)
class GameRules:
    """Rules of the game from the study.

    Attributes:
        seed: random seed of the game.
        energy: energy of each robot at the start.
        picture_cost: energy of taking a picture.
        identify_cost: energy of naming a treasure.
        wrong_share: points that a wrong name costs, as a share of the treasure's points.
        seats: the seats; empty for a game with one participant.
        team: rules for the participants of several seats.
    """

    seed: int
    energy: float
    picture_cost: float
    identify_cost: float
    wrong_share: float
    seats: tuple[Seat, ...] = ()
    team: TeamRules = field(default_factory=TeamRules)

    def start(self, game: int, robots: int, costs: CostMatrix, properties: tuple[TreasureProperty, ...]) -> GameStarted:
        """Return the event that starts a game; see `GameStarted`."""
        return GameStarted(
            seed=self.seed,
            game=game,
            robots=robots,
            energy=self.energy,
            picture_cost=self.picture_cost,
            identify_cost=self.identify_cost,
            wrong_share=self.wrong_share,
            costs=costs,
            properties=properties,
            seats=self.seats,
        )


@dataclass(frozen=True, slots=True)
class ProgramRefusal:
    """Refusal of a program's request.

    Attributes:
        program: name of the program.
        asked: the refused line, or the kind of the refused notice.
        refused: the reason.
    """

    program: str
    asked: str
    refused: RequestRefused

    def __str__(self) -> str:
        """Return a sentence for logs, such as `refused "%%goto TabUI SimR 0 39 39 45" of TabUI: Room 40 is ...`."""
        if self.refused.reason == LineReason.NOBODY:
            return f'could not deliver "{self.asked}" of {self.program}: {self.refused.sentence}'
        return f'refused "{self.asked}" of {self.program}: {self.refused.sentence}'


@frozen()
class KeeperDecisions:
    """Decisions of one step of the keeper.

    Attributes:
        entries: entries for the journal: the events of the game and the utterances, in order.
        utterances: utterances in dialogues, in order.
        wizard: turns that wait for a wizard.
        refusals: refused requests of programs, in order.
    """

    entries: tuple[JournalEntry, ...]
    utterances: tuple[DialogueUtterance, ...]
    wizard: WizardState
    refusals: tuple[ProgramRefusal, ...] = ()

    @property
    def events(self) -> tuple[Event, ...]:
        """The events of the game, in order."""
        return tuple(entry for entry in self.entries if not isinstance(entry, JournalOnly))

    @property
    def team(self) -> tuple[TeamEntry, ...]:
        """The texts, votes and objections of participants, in order."""
        return tuple(entry for entry in self.entries if isinstance(entry, TeamEntry))


class Keeper:
    """Keeper of the game; see the module's description.

    Args:
        rules: rules of the game.
        engine: function that returns the dialogue engine for the game with a number.
        history: entries of the unfinished game from its journal, oldest first; empty for a new game.
        last_game: number of the last game. The next game gets the following number.
        briefing: data for participants in addition to the state of the game.
        adviser: adviser that computes the robots' suggestions.
        attention_timeout: number of ticks without the participant's attention after which a robot decides alone. If
            None, robots wait without limit.
        tells_refusals: True to send refusals to programs of 2016, by `%%error`.

    Attributes:
        decisions: decisions of the last step. The caller must first write their entries to the journal.
        dismissed: programs of researchers that must be disconnected after the last step, because participants play
            their seats again; each with the reason, as a clause.
    """

    name = KEEPER

    def __init__(
        self,
        rules: GameRules,
        engine: Callable[[int], DialogueEngine],
        history: Sequence[JournalEntry] = (),
        last_game: int = 0,
        briefing: Briefing | None = None,
        adviser: Adviser | None = None,
        attention_timeout: int | None = None,
        *,
        tells_refusals: bool = False,
    ) -> None:
        self._tells_refusals = tells_refusals
        self._refusals: list[ProgramRefusal] = []
        self._rules = rules
        self._briefing = briefing or Briefing()
        knowledge = RobotKnowledge(adviser or Adviser(), self._briefing.kinds)
        self._game = OpenGame(engine, last_game, self._briefing.room_names, knowledge, rules.team)
        self._attention_timeout = attention_timeout
        self._game.restore(history)
        return_robots(self._game)
        self._legacy_lines = LegacyLines(self._game)
        # The connected programs, with the last notices to them.
        self._team = ConnectedTeam(self._game)
        self._hider = ConnectedHider(self._game)
        self._seats = {seat.name: ParticipantSeat(seat, self._briefing) for seat in rules.seats or (ONE_SEAT,)}
        self._debrief: Debrief | None = None
        # Input and output of the current step, and the decisions of the last step.
        self._has_input = False
        self._empty: frozenset[str] = frozenset()
        self._requests: list[GameRequest] = []
        self._outgoing: list[TextMessage] = []
        self.decisions = KeeperDecisions((), (), WizardState())
        self.dismissed: tuple[tuple[str, str], ...] = ()

    @property
    def state(self) -> GameState | None:
        """State of the current or last game; None before the first game."""
        return self._game.state

    @property
    def last_game(self) -> int:
        """Number of the current or last game. Before the first game, the first game's number minus 1."""
        return self._game.last_game

    @property
    def dialogues_not_restored(self) -> tuple[int, ...]:
        """Numbers of dialogues that could not be resumed after an interruption of the game."""
        return self._game.dialogues.not_restored

    @property
    def consent(self) -> ConsentStatus:
        """State of the participants' consent to take part; of several seats, the state that matters most."""
        given = {place.consent.status(self.state) for place in self._seats.values()}
        return next(status for status in _BY_IMPORTANCE if status in given)

    def refused_name(self, program: str, extended: bool) -> NameRefusal | None:
        """Return the reason why a program cannot have its name in this game, or None; see `NameRule`."""
        reason = why_no_seat(program, self._rules.seats, extended) or self._why_not_researcher(program)
        if reason is None:
            return None
        answer = TextMessage.of(TextCommand.ERROR, self.name, program, f"refused: {reason}")
        return NameRefusal(reason, answer if self._tells_refusals else None)

    def _why_not_researcher(self, program: str) -> str | None:
        """Return the reason, as a clause, why a researcher cannot play a seat now; None if they can."""
        place = self._place_of(program) if is_researchers(program) else None
        if place is None or place.played_by in {None, PlayedBy.RESEARCHER}:
            return None
        who = "a program" if place.is_simulated else "a person"
        return f"{who} plays the seat {place.seat.name} now; take a seat that is empty, or whose person is away"

    def _dismiss_researchers(self) -> Iterator[tuple[str, str]]:
        """Yield the programs of researchers whose seats participants play again, with the reason as a clause."""
        for place in self._seats.values():
            program = researchers_program(place.seat.name)
            if program in place.participants.reachable and (reason := self._why_not_researcher(program)) is not None:
                place.participants.note_unreachable(program)
                yield program, reason

    def connected(self) -> None:
        """Do nothing. The other programs send notices to the keeper when they are connected."""

    def tap(self, forwarded: Sequence[Forwarded]) -> None:
        """Process the lines that were forwarded since the last step. Call this directly before `step`."""
        for item in forwarded:
            if item.message.sender == self.name and not item.delivered:
                for place in self._seats.values():
                    place.participants.note_unreachable(item.message.receiver)
            if is_notice(item.message) or item.message.sender == self.name:
                continue
            self._has_input = True
            only = self._seats.get(ONE_SEAT.name)
            if item.message.sender == legacy.TABUI and not item.sender_extended and only is not None:
                only.consent.note_legacy()
            refused = self._refused_line(item) if self._rules.seats else self._effect(item)
            if refused is not None:
                self._note_refusal(item.message.sender, item.message.line().strip(), refused)
                if self._tells_refusals and not item.sender_extended:
                    text = f"refused: {refused.sentence}"
                    self._outgoing.append(TextMessage.of(TextCommand.ERROR, self.name, item.message.sender, text))

    def _refused_line(self, item: Forwarded) -> RequestRefused | None:
        """Process a line in a game with several seats. Return the reason if it has no effect.

        Lines of 2016 do not name their sender reliably. So requests in lines have no effect, and lines of programs of
        2016 have none at all.
        """
        if not item.sender_extended or decode_request_line(item) is not None:
            return _HAS_SEATS
        refused = self._effect(item)
        # SimR reports to a participant of 2016, who does not take part. The views contain these reports.
        return None if item.message.receiver == legacy.TABUI else refused

    def _effect(self, item: Forwarded) -> RequestRefused | None:
        """Process a line. Return the reason if it has no effect."""
        last = self._game.last_refusal
        self._handle_line(item)
        now = self._game.last_refusal
        if now is not None and now is not last:
            return RequestRefused(now.reason, now.sentence)
        return undone(item, self.state)

    def note_left(self, programs: Sequence[str]) -> None:
        """Record that these programs were disconnected since the last step. Call this before `step`."""
        if programs and self._rules.seats:  # In a game with one participant, no program needs to know.
            self._has_input = True
            for name in programs:
                for place in self._seats.values():
                    place.participants.note_unreachable(name)

    def _handle_line(self, item: Forwarded) -> None:
        if self.state is None:
            return
        # This is only for our own programs. The dialogues of programs of 2016 are internal, so the keeper does not know
        # their agreements.
        request = decode_request_line(item)
        only = self._seats.get(ONE_SEAT.name)
        ours = item.sender_extended and only is not None and item.message.sender in only.participants
        if ours and only is not None and request is not None and only.consent.awaited(self.state):
            self._game.refuse(kind_of(type(request)), _BEFORE_AGREEING)
            return
        reply = self._legacy_lines.handle(self.state, item, needs_consent=ours)
        if reply is not None:
            self._send(legacy.HIDER, LegacyReply(reply.command, reply.text))

    def ask(self, request: GameRequest) -> None:
        """Queue a request for the next step. It will be processed before the messages of that step."""
        self._requests.append(request)

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Run one tick; see `Role`."""
        if self._game.advance(tick):
            self._has_input = True
        if self._rules.seats:
            empty = self._game.team.empty(self._rules.seats, self._present, self._game.seconds)
            self._has_input = self._has_input or empty != self._empty
            self._empty = empty
        timeout = self._attention_timeout
        if timeout is not None and self._is_attended and decide_alone(self._game, timeout):
            self._has_input = True
        requests, self._requests = self._requests, []
        for request in requests:
            self._has_input = True
            if not isinstance(request, CommandRequest):
                handle_wizard_request(self._game, self.state, request)
            elif self.state is not None:
                handle_station_request(
                    self._game, self.state, request, awaits_treasures=self._hider.awaits_treasures(self.state)
                )
        for message in messages:
            value = parse_notice(message)
            if isinstance(value, Notice):
                state, last = self._game.state, self._game.last_refusal
                self._handle_notice(value)
                now = self._game.last_refusal
                is_news = value.kind not in _REPORTS or self._game.state is not state or now is not last
                # In a game with several seats, each report is also a time at which absences are recorded.
                self._has_input = self._has_input or is_news or bool(self._rules.seats)
                if value.kind in _WISHES and now is not None and now is not last:
                    self._note_refusal(value.sender, value.kind, RequestRefused(now.reason, now.sentence))
        if self._game.team.decisions.open and settle(self._game, self._present, self._legacy_lines):
            self._has_input = True
        # This comes after the messages, because a message of the same tick has the new prices of a stopped robot.
        report_failures(self._game)
        wizard, self.dismissed = self.decisions.wizard, ()
        # Without input, the state cannot have changed. Most ticks have no input.
        if self._has_input:
            self._has_input = False
            if self._rules.seats:
                self.dismissed = tuple(self._dismiss_researchers())
            if self.state is not None and self._rules.seats:
                self._game.record(self._game.team.changes(self._present, self._game.tick / TICKS_PER_SECOND))
            if self.state is not None:
                sense_for_stations(self._game, self.state)
            if self.state is not None:
                # Wait only for the decisions of our own programs: programs of 2016 never leave a treasure.
                self._game.record(rules.ending(self.state, wait_for_decisions=self._is_joined, empty=self._empty))
            self._send_notices()
            wizard = wizard_state(self._game, self.state)
        for place in self._seats.values():
            self._outgoing += place.participants.pieces(tick)
        self.decisions = KeeperDecisions(
            self._game.take_entries(), self._game.take_utterances(), wizard, tuple(self._refusals)
        )
        self._refusals.clear()
        outgoing, self._outgoing = self._outgoing, []
        return outgoing

    @property
    def _present(self) -> dict[str, PlayedBy]:
        """Seats that are played now, and by whom: by participants who are connected and not away, or by researchers."""
        return {name: by for name, place in self._seats.items() if (by := place.played_by) is not None}

    @property
    def _is_attended(self) -> bool:
        """True if any of our own programs takes part, and no consent of a participant is missing."""
        return self._is_joined and all(
            place.participants.is_empty or place.consent.status(self.state).recordable for place in self._seats.values()
        )

    @property
    def _is_joined(self) -> bool:
        """True if any of our own programs takes part as a participant."""
        return any(not place.participants.is_empty for place in self._seats.values())

    def _place_of(self, program: str) -> "ParticipantSeat | None":
        """Return the seat of a program, or None."""
        seat = seat_of(program, self._rules.seats)
        return None if seat is None else self._seats[seat.name]

    def _note_refusal(self, program: str, asked: str, refused: RequestRefused) -> None:
        self._refusals.append(ProgramRefusal(program, asked[:_QUOTED], refused))

    # Notices to the keeper

    def _handle_notice(self, notice: Notice) -> None:
        if not _is_from_its_program(notice):
            return
        if notice.kind in _SAID_BY:
            self._handle_program(notice)
            return
        place = self._place_of(notice.sender)
        if place is None:
            return  # This program has no seat.
        by_researcher = is_researchers(notice.sender)
        if by_researcher and (place.played_by not in {None, PlayedBy.RESEARCHER} or notice.kind in _PERSONAL):
            return  # The participant has come back; or only the participant may decide this.
        with self._game.acting(place.seat.name, is_researcher=by_researcher):
            if not self._is_turned_away(place, notice):
                self._handle_participant(place, notice)

    def _handle_program(self, notice: Notice) -> None:
        """Process a notice of SimR or Hider."""
        value = KEEPER_NOTICES.decode(notice)
        match value:
            case RobotsReady():
                self._robots(notice.sender, value)
            case TeamStatus():
                self._team.take_status(value)
            case MoveCosts():
                self._team.price(value)
            case HiderReady():
                self._hider.ready = True
                self._send(legacy.HIDER, self._hider.request())
            case HideTreasures():
                self._hider.hide(value)
            case ConsentQuery():
                self._send(notice.sender, self._team.permission(recordable=self.consent.recordable))
            case _:
                pass

    def _handle_participant(self, place: ParticipantSeat, notice: Notice) -> None:
        """Process a notice of a participant's program."""
        value, state = KEEPER_NOTICES.decode(notice), self.state
        match value:
            case ParticipantReady(run, simulated):
                if place.participants.is_another_program(notice.sender, run):
                    # The journal shows the change also if one program follows another in the same tick.
                    self._game.record(self._game.team.leave(place.seat.name, self._game.seconds))
                if not is_researchers(notice.sender):
                    place.consent.join(state, run)
                    place.is_away, place.is_simulated = False, simulated
                for robot in range(0 if state is None else len(state.robots)):
                    self._game.attend(robot)
                self._outgoing += place.participants.join(notice.sender, self._team.map, run)
            case DeclineConsent():
                place.consent.decline(state)
            case GiveConsent():
                self._game.record(place.consent.agree(state, value))
            case PlayAgain(game):
                self._play_again(game)
            case ReportPresence(present):
                place.is_away = not present
            case ParticipantFault() | None:
                pass  # Faults are only recorded.
            case RobotsReady() | TeamStatus() | MoveCosts() | HiderReady() | HideTreasures() | ConsentQuery():
                pass  # Only SimR and Hider may send these.
            case _ if state is None:
                pass
            case SayToPeople() | MarkRead() | Vote() | RaiseObjection():
                if self._rules.seats:
                    handle_team_request(self._game, state, value, place.seat)
            case SendRobot() | IdentifyTreasure() | EndGame() if self._rules.seats and propose(
                self._game, state, value, place.seat, len(self._present), self._legacy_lines
            ):
                pass  # The others vote.
            case SendRobot() | SenseTreasure() | TakePicture() | IdentifyTreasure():
                if self._rules.seats:  # Without seats, these requests come as lines of 2016.
                    self._legacy_lines.carry_out(state, value, place.seat)
            case _:
                seat = place.seat if self._rules.seats else None
                awaits = self._hider.awaits_treasures(state)
                handle_participant_request(self._game, state, value, seat, awaits_treasures=awaits)

    def _is_turned_away(self, place: ParticipantSeat, notice: Notice) -> bool:
        """Return True for a repeated request, or for a request before the participant's consent."""
        if self.state is None:
            return False
        if notice.kind in _COUNTED_WISHES and place.participants.is_repetition(notice):
            # The first request was already granted or refused, and the view shows the result.
            return True
        if notice.kind in _AFTER_AGREEING and place.consent.awaited(self.state):
            self._game.refuse(notice.kind, _BEFORE_AGREEING)
            return True
        return False

    def _robots(self, sender: str, robots: RobotsReady) -> None:
        state = self.state
        costs = costs_of(robots.costs)
        if isinstance(costs, RequestRefused):
            self._send(sender, TeamRejection(costs.sentence))
        elif not 0 < robots.robots <= MOST_ROBOTS:
            self._send(sender, TeamRejection(f"A team has 1 to {MOST_ROBOTS} robots, not {robots.robots}."))
        elif state is None:
            self._team.ready = robots
            self._start(robots.robots, costs)
        elif state.ended is not None:
            self._team.ready = robots
        elif len(state.robots) != robots.robots or state.started.costs != costs:
            self._send(sender, TeamRejection(_mismatch(state, robots)))
        else:
            self._team.ready = robots
            self._send(legacy.SIMR, self._team.orders(state, with_poses=True))

    def _start(self, robots: int, costs: CostMatrix) -> None:
        started = self._rules.start(self._game.last_game + 1, robots, costs, self._briefing.properties)
        # Consent and the commands of ground stations stay valid in the next game.
        former = self.state
        kept = () if former is None else kept_commands(former, robots)
        agreed = [event for place in self._seats.values() for event in place.first_events(former)]
        self._game.record((started, *agreed, *kept))
        self._team.begin(started.game)
        self._send(legacy.HIDER, self._hider.request())

    def _play_again(self, finished: int) -> None:
        state, team = self.state, self._team.ready
        if state is None or state.ended is None or state.started.game != finished or team is None:
            return
        costs = costs_of(team.costs)
        if isinstance(costs, CostMatrix):
            self._start(team.robots, costs)

    # Notices of the keeper

    def _send(self, receiver: str, value: NoticeValue | None) -> None:
        if value is not None:
            self._outgoing.append(encode_notice(self.name, receiver, value))

    def _send_notices(self) -> None:
        state, robots_ready = self.state, self._team.ready is not None
        if state is not None:
            if robots_ready:
                self._send(legacy.SIMR, self._team.orders(state, with_poses=False))
            for place in self._seats.values():
                view = view_of(
                    state,
                    self._game.dialogues,
                    self._game.refusals.get(place.seat.name),
                    self._briefing,
                    robots_ready=robots_ready,
                    asks=place.consent.awaited(state),
                    asked_back=self._game.handbacks.robots,
                    debrief=self._debriefed(state),
                    names_energy=place.seat.sees_energy,
                )
                if self._rules.seats:
                    talk = self._game.team.talk
                    view = view_of_seat(
                        view,
                        state,
                        place.seat,
                        self._present,
                        self._game.team,
                        talk_is_open=talk.is_open(self._game.seconds),
                        room_names=self._briefing.names_of_rooms(self._team.map),
                    )
                    self._outgoing += place.participants.show_talk(state.started.game, talk.lines_for(place.seat.name))
                self._outgoing += place.participants.show(view)
        self._send(legacy.SIMR, self._team.changed_permission(recordable=self.consent.recordable))

    def _debriefed(self, state: GameState) -> Debrief | None:
        """Return the debrief of an ended game. It is computed only once."""
        if state.ended is None:
            self._debrief = None
        elif self._debrief is None:
            starts = [[math.inf if cost is None else cost for cost in row] for row in self._team.from_starts]
            by_matrix = [state.started.costs.rows[0]] * len(state.robots)
            self._debrief = debrief_of(state, starts or by_matrix, self._briefing)
        return self._debrief


def costs_of(rows: Sequence[Sequence[float | None]]) -> CostMatrix | RequestRefused:
    """Return the cost matrix for rows from `plain_costs`, or a refusal for invalid rows."""
    try:
        return CostMatrix.of_plain(rows)
    except ValueError as error:
        return RequestRefused("bad-costs", str(error))


def _mismatch(state: GameState, robots: RobotsReady) -> str:
    return (
        f"A game with {len(state.robots)} robots and {len(state.rooms)} rooms is under way; these are {robots.robots} "
        f"robots on the map {robots.map} with {len(robots.costs) - 1} rooms. Start SimR as before, or end that game "
        "by starting the server with --new-game."
    )


_PROGRAMS = {legacy.SIMR, legacy.HIDER}
_SAID_BY = {
    **{kind_of(each): legacy.SIMR for each in (RobotsReady, TeamStatus, MoveCosts, ConsentQuery)},
    **{kind_of(each): legacy.HIDER for each in (HiderReady, HideTreasures)},
}
"""The only program that may send a notice, by the notice's kind. Only participants may send all other kinds."""


def _is_from_its_program(notice: Notice) -> bool:
    """Return True if the sender may send notices of this kind. The rights of keys depend on the program."""
    program = _SAID_BY.get(notice.kind)
    return notice.sender not in _PROGRAMS if program is None else notice.sender == program
