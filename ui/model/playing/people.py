"""People of a game with several seats: their panel on the screen, their texts, and sentences about them."""

from collections.abc import Iterator, Sequence

from thbridge.dialogue.wording.texts import Texts
from thbridge.files.errors import visible
from thbridge.hunt.events import Commander
from thbridge.hunt.seats import Seat, StopRight
from thbridge.roles.shared.team_notices import LONGEST_TEXT, TalkLine, TeamTalk
from thbridge.roles.shared.view import TeamView, View
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.screen import (
    Action,
    ChooseAddressee,
    MarkReadAct,
    PeopleAct,
    PeoplePanel,
    PersonRow,
    PersonText,
    SayToPeopleAct,
    WriteText,
)
from ui.model.playing.seat_words import seat_sentences
from ui.model.playing.words import clock_words


def do_with_people(memory: ParticipantMemory, hunt: HuntMemory, act: PeopleAct, now: float) -> None:
    """Carry out an act on the panel of the people."""
    team, talk = hunt.view.team, memory.talk
    if team is None:
        return
    match act:
        case ChooseAddressee(seat) if _is_addressee(team, seat):
            talk.to = seat
        case WriteText(text):
            talk.write(text, now)
        case SayToPeopleAct(to, text) if _is_addressee(team, to) and text.strip():
            talk.write(text, now)
            reason = why_not_send(hunt.texts, team, text)
            if reason:
                talk.restored += 1
                memory.history.announce(reason)
            else:
                talk.send(to, team.own.name, now)
        case MarkReadAct(line) if line in talk.lines:
            talk.shown = max(talk.shown, line)
        case _:
            pass


def receive_talk(memory: ParticipantMemory, talk: TeamTalk) -> None:
    """Process texts from the keeper, and announce those of other people to screen readers."""
    hunt = memory.hunt
    team = None if hunt is None else hunt.view.team
    known = memory.talk.game == talk.game
    new = memory.talk.receive(talk, "" if team is None else team.own.name)
    # Texts that came before this program joined are on the panel, and marked as new there.
    if team is None or not known:
        return
    for line in new:
        if line.seat != team.own.name:
            memory.history.announce(spoken_text(memory.texts, team, line))


def why_not_send(texts: Texts, team: TeamView, text: str) -> str:
    """Return the reason why a text cannot be sent now; empty if it can."""
    if not team.talk_is_open:
        return texts.text("people.closed")
    length = len(text.strip())
    if length > LONGEST_TEXT:
        return texts.text("people.too_long", longest=LONGEST_TEXT, length=length)
    return ""


def people_panel(memory: ParticipantMemory, hunt: HuntMemory) -> PeoplePanel | None:
    """Return the panel of the people; None if the game has only one participant."""
    view, talk, texts = hunt.view, memory.talk, hunt.texts
    team = view.team
    if team is None:
        return None
    unread = unread_texts(team, tuple(talk.lines.values()), talk.shown)
    to = talk.to if _is_addressee(team, talk.to) else ""
    to_whom = texts.text("people.everyone") if not to else name_of(team, to)
    writes = team.talk_is_open or bool(talk.lines)
    reason = why_not_send(texts, team, talk.draft)
    names = [("", texts.text("people.everyone")), *((mate.seat.name, mate.seat.label) for mate in team.teammates)]
    pending = tuple(
        PersonText(
            0, author_words(texts, team, team.own.name, each.to), shown_text(each.text), "", own=True, pending=True
        )
        for each in talk.pending
    )
    return PeoplePanel(
        title=texts.text("people.title"),
        own=_row(texts, view, team.own, present=True, own=True),
        others=tuple(_row(texts, view, mate.seat, present=mate.present) for mate in team.teammates),
        texts=(*(_text(texts, hunt, team, line, new=line in unread) for line in talk.lines.values()), *pending),
        nothing=texts.text("people.nothing") if writes and not talk.lines and not pending else "",
        unread=len(unread),
        news=texts.text("people.news", count=len(unread)) if unread else "",
        read=MarkReadAct(unread[-1].line) if unread else None,
        writes=writes,
        closed="" if team.talk_is_open else texts.text("people.closed"),
        addressees=tuple(
            Action(ChooseAddressee(seat), label, "", hint=texts.text("people.write_to", who=label))
            for seat, label in names
        )
        if len(team.teammates) > 1
        else (),
        to=to,
        prompt=texts.text("people.write_to", who=to_whom),
        draft=talk.draft,
        restored=talk.restored,
        send=Action(SayToPeopleAct(to), texts.text("people.send"), "Enter", enabled=not reason, hint=reason),
        longest=LONGEST_TEXT,
    )


def unread_texts(team: TeamView, lines: Sequence[TalkLine], shown: int = 0) -> list[TalkLine]:
    """Return the texts of other people that the person has not seen.

    Args:
        team: the people.
        lines: all texts.
        shown: number of the last text that this program has shown.
    """
    read = max(team.read, shown)
    return [line for line in lines if line.line > read and line.seat != team.own.name]


def shown_text(text: str) -> str:
    """Return an untrusted text on one line, with control characters as escapes."""
    return visible(" ".join(text.split()))


def name_of(team: TeamView, seat: str) -> str:
    """Return the words for a seat."""
    seats = (team.own, *(mate.seat for mate in team.teammates))
    return next((each.label for each in seats if each.name == seat), seat)


def author_words(texts: Texts, team: TeamView, author: str, to: str) -> str:
    """Return the author and, if a text is not for all, its addressee."""
    own = author == team.own.name
    if to == team.own.name:
        return texts.text("people.to_you", who=name_of(team, author))
    who = texts.text("window.you") if own else name_of(team, author)
    return texts.text("people.to_one", who=who, other=name_of(team, to)) if to else texts.text("people.to_all", who=who)


def spoken_text(texts: Texts, team: TeamView, line: TalkLine) -> str:
    """Return a text with its author and addressee as one sentence."""
    return texts.text("window.said", who=author_words(texts, team, line.seat, line.to), words=shown_text(line.text))


def robots_of(view: View, seat: Seat, *, own: bool) -> tuple[int, ...]:
    """Return the indices of the robots that a seat commands."""
    if own:
        return tuple(robot.robot for robot in view.robots if not robot.has_other_commander)
    return tuple(
        robot.robot
        for robot in view.robots
        if robot.commander is Commander.TEAMMATE and robot.commander_name == seat.label
    )


def commands_words(texts: Texts, robots: Sequence[int]) -> str:
    """Return the robots that a person commands, in words."""
    if not robots:
        return texts.text("people.commands_none")
    return texts.text("people.commands", which=_listed(texts, robots))


def people_at_start(texts: Texts, view: View) -> Iterator[str]:
    """Yield sentences about the people at the start of a game, and the robots that they command."""
    team = view.team
    if team is None:
        return
    for seat in (team.own, *(mate.seat for mate in team.teammates)):
        robots = robots_of(view, seat, own=seat is team.own)
        if seat is not team.own:
            yield texts.text("people.they_are", who=seat.label, commands=commands_words(texts, robots))
        else:
            yield f"{texts.text('people.you_are', who=seat.label)} {seat_sentences(texts, seat, robots)}"


def people_changes(texts: Texts, before: TeamView | None, team: TeamView | None) -> Iterator[str]:
    """Yield sentences about people who joined or left, and about the times in which they can send texts."""
    if before is None or team is None:
        return
    was_present = {mate.seat.name: mate.present for mate in before.teammates}
    for mate in team.teammates:
        if mate.present != was_present.get(mate.seat.name, mate.present):
            yield texts.text("people.joined" if mate.present else "people.left", who=mate.seat.label)
    if team.talk_is_open != before.talk_is_open:
        yield texts.text("people.opened" if team.talk_is_open else "people.closed_now")


def may_words(texts: Texts, seat: Seat) -> str:
    """Return what the person of a seat may do in addition to commanding robots, as one sentence."""
    rights = {
        "name": seat.names_treasures,
        "stop": seat.stops is StopRight.ALL,
        "take_over": seat.can_take_over,
        "end": seat.ends_game,
        "object": seat.may_object,
    }
    listed = [texts.text(f"people.may_{right}") for right, has in rights.items() if has]
    return texts.text("people.may", what=texts.listed(listed)) if listed else ""


def _is_addressee(team: TeamView, seat: str) -> bool:
    return not seat or any(mate.seat.name == seat for mate in team.teammates)


def _listed(texts: Texts, robots: Sequence[int]) -> str:
    return texts.listed(texts.robot(robot) for robot in robots)


def _row(texts: Texts, view: View, seat: Seat, *, present: bool, own: bool = False) -> PersonRow:
    robots = robots_of(view, seat, own=own)
    return PersonRow(
        seat=seat.name,
        name=texts.text("people.you", who=seat.label) if own else seat.label,
        present=present,
        presence="" if own else texts.text("people.here" if present else "people.away"),
        commands=commands_words(texts, robots),
        robots=robots,
        may=may_words(texts, seat),
    )


def _text(texts: Texts, hunt: HuntMemory, team: TeamView, line: TalkLine, *, new: bool) -> PersonText:
    return PersonText(
        line=line.line,
        who=author_words(texts, team, line.seat, line.to),
        text=shown_text(line.text),
        time=clock_words(hunt.seconds_of(line.at)),
        own=line.seat == team.own.name,
        new=new,
    )
