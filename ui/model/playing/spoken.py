"""Words that all front ends show, or read aloud, about parts of the screen."""

from thbridge.dialogue.wording.texts import Texts, counted
from ui.model.playing.keys import shown_key
from ui.model.playing.screen import Action, DialoguePopup, HistoryLine, RobotCard, RoomTile, Screen


def energy_words(texts: Texts, card: RobotCard) -> tuple[str, ...]:
    """Return the energy left and the cost of a considered move in words, in a long and a short version.

    Return no words if the participant does not see the energy.
    """
    if card.energy is None:
        return ("",)
    energy, left = texts.number(card.energy), card.energy
    if card.cost is None:
        shown = energy
    elif card.affordable:
        left = max(0.0, card.energy - card.cost)
        shown = f"{energy} − {texts.number(card.cost)} = {texts.number(left)}"
    else:
        keys = ("window.lacking_units", "window.lacking", "window.lacking_short")
        return tuple(texts.text(key, energy=energy, cost=card.cost) for key in keys)
    units = texts.text("window.energy_units", energy=shown, count=counted(left))
    return units, texts.text("window.energy", energy=shown), shown


def spoken_card(texts: Texts, card: RobotCard) -> str:
    """Return a card as screen readers read it."""
    parts = [
        card.name,
        texts.text("window.selected") if card.selected else "",
        card.commanded,
        "" if card.energy is None else texts.text("window.energy_of", energy=card.energy, full=card.energy_at_start),
        _spoken_cost(texts, card),
        card.state,
        card.place,
        card.warning,
        texts.text("window.waits", count=card.waits) if card.waits else "",
    ]
    return ", ".join(part for part in parts if part)


def _spoken_cost(texts: Texts, card: RobotCard) -> str:
    if card.cost is None:
        return ""
    return texts.text("window.move_costs" if card.affordable else "window.move_too_dear", cost=card.cost)


def spoken_request(texts: Texts, name: str, action: Action) -> str:
    """Return the name of a button on a card. The button stays while the game has not granted the request yet.

    Args:
        texts: texts of the game's language.
        name: sentence about the act.
        action: the button.
    """
    return name if action.enabled else texts.text("window.asked_for", name=name)


def tile_words(texts: Texts, tile: RoomTile) -> tuple[str, ...]:
    """Return the line below a room's number, and shorter versions of it: the find there, or the cost to go there."""
    if tile.found:
        return tile.found, *tile.found_shorter
    if tile.state == "reserved":
        return texts.text("window.on_the_way"), texts.text("window.taken")
    if tile.state != "unvisited":
        return ("",)
    if tile.cost is None:
        return ("" if tile.reachable else texts.text("window.no_way"),)
    keys = ("window.costs_energy", "window.costs_units", "window.units")
    return *(texts.text(key, cost=tile.cost, count=counted(tile.cost)) for key in keys), texts.number(tile.cost)


def spoken_tile(texts: Texts, tile: RoomTile) -> str:
    """Return a room as a sentence for screen readers."""
    if tile.robot is None or tile.state == "unvisited":
        state = texts.text(f"window.{tile.state}")
    else:
        state = texts.clause(f"window.{tile.state}_by", robot=tile.robot)
    parts = [
        texts.text("window.room", room=tile.room),
        tile.name,
        state,
        tile.found,
        "" if tile.cost is None or tile.state != "unvisited" else texts.text("window.costs", cost=tile.cost),
        tile.warning,
    ]
    return ", ".join(part for part in parts if part)


def speaker_of(texts: Texts, line: HistoryLine) -> str:
    """Return the name of the speaker of a line of the history; empty for the game."""
    if line.speaker == "game":
        return ""
    if line.speaker == "teammate" and line.robot is not None:
        return texts.text("seats.teammate_to", seat=line.teammate, robot=line.robot)
    if line.robot is None:
        return texts.text("window.you")
    return texts.text("window.you_to" if line.speaker == "you" else "window.robot", robot=line.robot)


def name_of_speaker(texts: Texts, pop: DialoguePopup, speaker: str) -> str:
    """Return the name of the speaker of a sentence in a pop-up: the robot, the participant, or a teammate."""
    match speaker:
        case "robot":
            return texts.text("window.robot", robot=pop.robot)
        case "teammate":
            return pop.partner
        case "objection":
            return ""  # The sentence says who objects.
        case _:
            return texts.text("window.you")


def state_of(texts: Texts, pop: DialoguePopup) -> str:
    """Return a remark about a dialogue: who decides, who talks with the robot, or that the robot is thinking."""
    if pop.ended:
        return ""
    return pop.note if pop.choices or pop.partner else texts.text("window.thinking", robot=pop.robot)


def spoken_act(texts: Texts, card: RobotCard, name: str) -> str:
    """Return the name of an act of a card's button; see `RobotCard.buttons`."""
    others = {"hand_over": "seats.hand_over_robot"}
    if card.holder:
        others["ask_back"] = "seats.ask_for_robot"
    return texts.text(others.get(name, f"window.{name}"), robot=card.robot)


def remark_of(texts: Texts, screen: Screen) -> str:
    """Return a remark about the considered room, or about the digits typed so far."""
    if screen.typed:
        return texts.text("window.digits", digits=screen.typed, enter=shown_key(texts, "Enter"))
    tile: RoomTile | None = next((tile for tile in screen.tiles if tile.considered), None)
    if tile is None:
        return ""
    words = tile.warning or tile.choose.hint
    return texts.text("window.remark", name=tile.name, remark=words) if words else tile.name


def signed(number: int) -> str:
    """Return a number of points with the sign that is used for numbers, not a hyphen."""
    return f"{number}".replace("-", "−")
