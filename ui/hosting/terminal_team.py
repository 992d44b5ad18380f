"""Commands and lines of a person at a terminal in a game with several participants."""

from collections.abc import Iterator, Sequence

from sim.common.robot_numbers import number_of
from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import Commander
from thbridge.hunt.seats import Seat
from thbridge.roles.shared.participant_rules import revealed
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.team_notices import LONGEST_REASON, REASONS, DecisionView, RaiseObjection, Vote
from thbridge.roles.shared.view import DialogueView, IdentifyTreasure, ParticipantRequest, RobotView, SendRobot, View
from ui.model.playing.objections import can_object, new_objections, objection_words, reason_words
from ui.model.playing.seat_view import decision_about, decisions, label_of, takers
from ui.model.playing.votes import awaits_own, needed, news_of, proposal, vote_words


def allowed(view: View, requests: Sequence[ParticipantRequest]) -> Iterator[ParticipantRequest]:
    """Yield the requests that the seat may send, without those on which the team votes."""
    state, seat = revealed(view).state, revealed(view).seat
    for request in requests:
        match request:
            case SendRobot(robot):
                voted = decision_about(view, robot=robot)
            case IdentifyTreasure(room):
                voted = decision_about(view, room=room)
            case _:
                voted = None
        if voted is None and (seat is None or why_not_allowed(state, seat, request) is None):
            yield request


def taker_named(view: View, typed: str) -> Seat | None:
    """Return the teammate whose name or label was typed; if nothing was typed, the only one who can take over robots.

    Return None if there is no such teammate.
    """
    words = typed.casefold()
    fitting = [seat for seat in takers(view) if words in ("", seat.name, seat.label.casefold())]
    return fitting[0] if len(fitting) == 1 else None


def listed_takers(view: View) -> str:
    """Return the names of the teammates who can take over robots."""
    return ", ".join(seat.name for seat in takers(view))


def vote_typed(view: View, words: Sequence[str], *, agrees: bool) -> Vote | None:
    """Return the vote that was typed: the number of a decision, which may be omitted, and a reason.

    Return None if there is no such vote.
    """
    own = "" if view.team is None else view.team.own.name
    open_ = [each for each in decisions(view) if each.seat != own]
    numbered = {str(each.decision): each for each in open_}
    if words and words[0] in numbered:
        return Vote(numbered[words[0]].decision, agrees, " ".join(words[1:]))
    first = next((each for each in open_ if awaits_own(view, each)), next(iter(open_), None))
    return None if first is None else Vote(first.decision, agrees, " ".join(words))


def vote_lines(texts: Texts, view: View, decision: DecisionView) -> Iterator[str]:
    """Yield lines about an open vote."""
    yield proposal(texts, view, decision)
    for vote in decision.votes:
        yield f"  {vote_words(texts, view, vote)}"
    own = "" if view.team is None else view.team.own.name
    key = "terminal.vote_own" if decision.seat == own else "terminal.vote"
    yield f"  {needed(texts, view, decision)} {texts.text(key, number=decision.decision)}"


def vote_news(texts: Texts, before: View, view: View) -> Iterator[str]:
    """Yield lines about what is new in votes since an earlier view, and how to take part in a new vote."""
    yield from news_of(texts, before, view)
    known = {each.decision for each in decisions(before)}
    for each in decisions(view):
        if each.decision not in known:
            yield list(vote_lines(texts, view, each))[-1]


def objection_typed(view: View, robot: int, words: Sequence[str]) -> RaiseObjection | DialogueView | None:
    """Return the objection that was typed: the number of a reason, and own words.

    Return the dialogue with the robot if no reason was typed, and None if the seat cannot object in such a dialogue.
    """
    talks = (each for each in view.dialogues if each.robot == robot and can_object(view, each))
    dialogue = next(talks, None)
    if dialogue is None:
        return None
    numbered = {str(number): reason for number, reason in enumerate(REASONS[dialogue.matter], start=1)}
    if not words or words[0] not in numbered:
        return dialogue
    return RaiseObjection(dialogue.dialogue, numbered[words[0]], " ".join(words[1:])[:LONGEST_REASON])


def reason_lines(texts: Texts, dialogue: DialogueView) -> Iterator[str]:
    """Yield lines about the possible reasons for an objection, and how to object."""
    for number, reason in enumerate(REASONS[dialogue.matter], start=1):
        yield f"  {number}  {reason_words(texts, reason)}"
    yield texts.text("terminal.object", number=number_of(dialogue.robot))


def objection_news(texts: Texts, before: View, view: View) -> Iterator[str]:
    """Yield lines about the objections since an earlier view, and how to object in a new dialogue of a teammate."""
    for objection in new_objections(before, view):
        yield objection_words(texts, view, objection)
    known = {each.dialogue for each in before.dialogues}
    for each in view.dialogues:
        if each.dialogue not in known and can_object(view, each):
            yield texts.text("terminal.object", number=number_of(each.robot))


def asked_for_news(texts: Texts, before: View, view: View) -> Iterator[str]:
    """Yield lines about robots of the participant that teammates ask for since an earlier view."""
    known = () if before.team is None else before.team.asked_for
    for robot, seat in () if view.team is None else view.team.asked_for:
        if (robot, seat) not in known:
            yield texts.text("seats.wants", seat=label_of(view, seat), robot=robot)


def why_not_ask_for(texts: Texts, view: View, robot: RobotView) -> str:
    """Return the reason why the seat cannot take over a robot of a teammate; empty if it can."""
    takes = view.team is None or view.team.own.can_take_over
    return "" if takes or robot.commander is not Commander.TEAMMATE else texts.text("seats.not_yours")
