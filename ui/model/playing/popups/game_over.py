"""Page after the end of a game."""

from thbridge.hunt.events import EndReason
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.view import Debrief, PlayAgain, RoomDebrief, RoomView
from ui.model.keys import keyed
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.words import as_sentence, counted, scored, verdict_words
from ui.model.screen import AnotherGame, GameOverPage, GoOnFromGame

_ENDS = {
    EndReason.ALL_VISITED.value: "Every room has been visited.",
    EndReason.NO_MOVE_LEFT.value: "No robot has the energy to go any further.",
    EndReason.GIVEN_UP.value: "You have ended the game.",
}


def game_over_page(hunt: HuntMemory, once: bool) -> GameOverPage:
    """The reason why the game is over, and its results; `once` where no other game follows."""
    view = hunt.view
    visited = sum(room.state == "visited" for room in view.rooms)
    verdicts = [room.verdict for room in view.rooms if room.verdict is not None]
    right = sum(verdict.points > 0 for verdict in verdicts)
    rightly = f", {right or 'none'} rightly" if verdicts else ""
    debrief = view.debrief or Debrief()
    lines = [
        _ENDS.get(view.over or "", "The game is over."),
        f"{visited} of {counted(len(view.rooms), 'room')} visited. "
        + as_sentence(f"{counted(len(verdicts), 'treasure')} named{rightly}."),
    ]
    if debrief.best is not None:
        lines.append(f"With the same energy, {counted(debrief.best, 'point')} were possible.")
    was = {room.room: room for room in debrief.rooms}
    lines += [line for room in view.rooms if (line := _of_room(room, was.get(room.room)))]
    lines.append(debrief.farewell or "Thank you for playing.")
    busy = PlayAgain(view.game) in hunt.pending
    again = keyed(AnotherGame(), "Play again", not busy, "With treasures hidden anew.", busy)
    if once:
        again = keyed(GoOnFromGame(), "Continue")
    return GameOverPage(f"The game is over. Score: {scored(view.score)}", tuple(lines), again)


def _of_room(room: RoomView, was: RoomDebrief | None) -> str:
    """The end of a room in a sentence, with what was in it as far as that is told; empty where nothing is."""
    it = "" if was is None else f"{name_in_words(was.name)}, {counted(was.points, 'point')}"
    if room.verdict is not None:
        told = verdict_words(room.verdict.name, room.verdict.points)
        return f"Room {room.room}: {told}" + (f" It was {it}." if it and room.verdict.points <= 0 else "")
    if room.left or room.undecided:
        return f"Room {room.room}: left where it was" + (f"; it was {it}." if it else ".")
    return f"Room {room.room}: not visited; there was {it}." if it else ""
