"""Page after the end of a game."""

from thbridge.hunt.events import EndReason
from thbridge.roles.view import PlayAgain
from ui.model.keys import keyed
from ui.model.playing.state import HuntMemory
from ui.model.playing.words import as_sentence, counted, listed, scored, verdict_words
from ui.model.screen import AnotherGame, GameOverPage

_ENDS = {
    EndReason.ALL_VISITED.value: "Every room has been visited.",
    EndReason.NO_MOVE_LEFT.value: "No robot has the energy to go any further.",
    EndReason.GIVEN_UP.value: "You have ended the game.",
}


def game_over_page(hunt: HuntMemory) -> GameOverPage:
    """The reason why the game is over, and its results."""
    view = hunt.view
    visited = sum(room.state == "visited" for room in view.rooms)
    verdicts = [(room.room, room.verdict) for room in view.rooms if room.verdict is not None]
    right = sum(verdict.points > 0 for _, verdict in verdicts)
    rightly = f", {right or 'none'} rightly" if verdicts else ""
    lines = [
        _ENDS.get(view.over or "", "The game is over."),
        f"{visited} of {counted(len(view.rooms), 'room')} visited.",
        as_sentence(f"{counted(len(verdicts), 'treasure')} named{rightly}."),
    ]
    left = [f"room {room.room}" for room in view.rooms if room.left or room.undecided]
    if left:
        lines.append(f"Left where it was: in {listed(left)}.")
    lines += [f"Room {room}: {verdict_words(verdict.name, verdict.points)}" for room, verdict in verdicts]
    busy = PlayAgain(view.game) in hunt.pending
    again = keyed(AnotherGame(), "Play again", not busy, "With treasures hidden anew.", busy)
    return GameOverPage(f"The game is over. Score: {scored(view.score)}", tuple(lines), again)
