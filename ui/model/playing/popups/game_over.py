"""Page after the end of a game."""

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import EndReason
from thbridge.roles.shared.view import Debrief, PlayAgain, RoomDebrief, RoomView, View
from ui.model.playing.keys import keyed
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.screen import GameOverPage, GoOnFromGame, PlayAgainAct
from ui.model.playing.seat_view import sees_score
from ui.model.playing.words import verdict_words
from ui.model.shared.points import scored


def game_over_page(hunt: HuntMemory, once: bool) -> GameOverPage:
    """Return the page with the results and the reason for the end; `once` is True if no other game follows."""
    texts, view = hunt.texts, hunt.view
    busy = PlayAgain(view.game) in hunt.pending
    again = keyed(PlayAgainAct(), texts.text("game_over.again"), not busy, texts.text("game_over.again_hint"), busy)
    if once:
        again = keyed(GoOnFromGame(), texts.text("game_over.go_on"))
    title = texts.text("game_over.title", score=scored(view.score)) if sees_score(view) else texts.text("seats.over")
    return GameOverPage(title, ending_lines(texts, view), again)


def ending_lines(texts: Texts, view: View) -> tuple[str, ...]:
    """Return the reason for the end of a game and its results, as sentences."""
    visited = sum(room.state == "visited" for room in view.rooms)
    debrief = view.debrief or Debrief()
    lines = [
        _end(texts, view),
        f"{texts.text('game_over.visited', number=visited, count=len(view.rooms))} {_named(texts, view)}",
    ]
    if debrief.best is not None:
        lines.append(texts.text("game_over.possible", count=debrief.best))
    was = {room.room: room for room in debrief.rooms}
    lines += [line for room in view.rooms if (line := _of_room(texts, view, room, was.get(room.room)))]
    lines.append(debrief.farewell or texts.text("game_over.thanks"))
    return tuple(lines)


def _end(texts: Texts, view: View) -> str:
    """Return the reason why the game is over. A general sentence replaces reasons that only later releases know."""
    reason = view.over or ""
    if view.team is not None and reason == EndReason.GIVEN_UP:
        return texts.text("seats.given_up")
    key = f"game_over.{reason.replace('-', '_')}"
    return texts.text(key if texts.has(key) else "game_over.unknown")


def _named(texts: Texts, view: View) -> str:
    verdicts = [room.verdict for room in view.rooms if room.verdict is not None]
    right = sum(verdict.points > 0 for verdict in verdicts)
    if not verdicts:
        return texts.text("game_over.none_named")
    if not sees_score(view):
        return texts.text("seats.treasures_named", count=len(verdicts))
    if not right:
        return texts.text("game_over.named_none_rightly", count=len(verdicts))
    return texts.text("game_over.named", count=len(verdicts), number=right)


def _of_room(texts: Texts, view: View, room: RoomView, was: RoomDebrief | None) -> str:
    """Return a sentence about the result of a room, with the treasure if the game reveals it.

    The sentence is empty if there is nothing to say.
    """
    name, points = ("", 0) if was is None else (view.word_for(was.name), was.points)
    it_was = f" {texts.text('game_over.it_was', name=name, count=points)}" if name else ""
    if room.verdict is not None:
        word = view.word_for(room.verdict.name)
        verdict = verdict_words(texts, word, room.verdict.points, shows_points=sees_score(view))
        told = texts.text("history.named", room=room.room, verdict=verdict)
        return told if room.verdict.points > 0 else f"{told}{it_was}"
    if room.left or room.undecided:
        return texts.text("game_over.left", room=room.room) + it_was
    return texts.text("game_over.not_visited", room=room.room, name=name, count=points) if name else ""
