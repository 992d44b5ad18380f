"""Table of keys: buttons get their labels from it, and the help sheet its lines.

Keys are named as on the keyboard: "Tab", "Shift+Tab", "Enter", "Esc", "Up", "Down", "F1", a digit, a capital letter,
"?". Letters are free while a list has the focus; see `typed_name`.
"""

import string
from collections.abc import Sequence
from dataclasses import dataclass

from ui.model.screen import (
    Act,
    Action,
    AgreeToTakePart,
    AnotherGame,
    AskAdvice,
    AskForRobot,
    Cancel,
    Confirm,
    DialoguePopup,
    EndGame,
    FinishNumber,
    FitMap,
    FollowRobot,
    LeaveTreasure,
    NextRobot,
    Phase,
    PickName,
    Screen,
    ShowHelp,
    ShowNext,
    StopRobot,
    SubmitName,
    TakeThePicture,
    TreasurePopup,
    TypeDigit,
)


@dataclass(frozen=True, slots=True)
class KeyBinding:
    """Keys that do one act.

    Attributes:
        keys: the first is the one printed on the button.
        act: the act.
        does: the act in words, for the help sheet.
    """

    keys: tuple[str, ...]
    act: Act
    does: str


PLAYING = (
    KeyBinding(("Tab",), NextRobot(1), "Command the next robot"),
    KeyBinding(("Shift+Tab",), NextRobot(-1), "Command the robot before"),
    KeyBinding(("D", "?"), AskAdvice(), "Don't know: ask the robot where to go"),
    KeyBinding(("X",), StopRobot(), "Stop the robot"),
    KeyBinding(("B",), AskForRobot(), "Ask for the robot back, if somebody else commands it"),
    KeyBinding(("P",), TakeThePicture(), "Take a picture of what was found"),
    KeyBinding(("N", "Enter"), SubmitName(), "Name what was found, as picked from the list"),
    KeyBinding(("L",), LeaveTreasure(), "Leave what was found, for good"),
    KeyBinding(("Esc", "W"), ShowNext(), "Put the pop-up aside, or show what waits"),
    KeyBinding(("F",), FollowRobot(), "Keep the robot in the middle of the map, or stop doing so"),
    KeyBinding(("M",), FitMap(), "Show the whole map"),
    KeyBinding(("E",), EndGame(), "End the game"),
)
"""Keys while the game goes on."""

CONSENT = (KeyBinding(("A",), AgreeToTakePart(), "Agree to take part"),)
OVER = (KeyBinding(("A",), AnotherGame(), "Play another game"),)
QUESTION = (
    KeyBinding(("Y",), Confirm(), "Yes, to a question of the program"),
    KeyBinding(("N", "Esc"), Cancel(), "No, to a question of the program"),
)
"""Keys while the program asks for confirmation; all others are ignored then."""

HELP = KeyBinding(("F1", "H"), ShowHelp(), "Open or close this sheet")

_TABLES = (PLAYING, CONSENT, OVER, QUESTION, (HELP,))
_TAKEN = frozenset(key for binding in (*PLAYING, HELP) for key in binding.keys)


def key_of(act: Act) -> str:
    """The key to print on the button of an act; empty when it has none of its own."""
    return next((binding.keys[0] for table in _TABLES for binding in table if binding.act == act), "")


def keyed(act: Act, label: str, enabled: bool = True, hint: str = "", pending: bool = False) -> Action:
    """The action of an act, with its own key."""
    return Action(act, label, key_of(act), enabled, hint, pending)


def choice_keys(choices: Sequence[str]) -> tuple[str, ...]:
    """A key for each answer that may be given: a letter of its first word if one is free, C for Continue."""
    taken = set(_TAKEN)
    keys = []
    for text in choices:
        candidates = [*(letter for letter in text.upper() if letter in string.ascii_uppercase), *string.ascii_uppercase]
        key = next((letter for letter in candidates if letter not in taken), "")
        taken.add(key)
        keys.append(key)
    return tuple(keys)


def act_for(key: str, screen: Screen) -> Act | None:
    """The act of a key while a screen is shown; None if it has none.

    Args:
        key: as the module names keys.
        screen: the screen that the participant sees.
    """
    if key in HELP.keys or (screen.help and key == "Esc"):
        return HELP.act
    if screen.help:
        # The sheet covers what the other keys are for.
        return None
    if screen.confirmation is not None:
        return _bound(key, QUESTION)
    match screen.phase:
        case Phase.CONSENT:
            return _bound(key, CONSENT)
        case Phase.OVER:
            return _bound(key, OVER)
        case Phase.PLAYING:
            return _playing(key, screen)
        case Phase.CONNECTING:
            return None


def typed_name(letter: str, names: Sequence[str], picked: str | None) -> str | None:
    """The next name, after the one picked, that begins with this letter; None if none does.

    For a list that has the focus: only a letter with which no name begins is looked up in the table of keys.
    """
    fitting = [name for name in names if name.casefold().startswith(letter.casefold())] if letter else []
    if not fitting:
        return None
    return fitting[(fitting.index(picked) + 1) % len(fitting)] if picked in fitting else fitting[0]


def help_lines(rooms: int) -> tuple[tuple[str, str], ...]:
    """The help sheet: (keys, what they do)."""
    number = "Send the robot to this room" + (": both digits, or Enter after the first" if rooms > 9 else "")
    lines = [(f"1 to {rooms}", number)]
    lines += [(" or ".join(binding.keys), binding.does) for binding in PLAYING]
    lines.append(("Enter", "The first of the answers to a robot; each answer's own letter is on its button"))
    lines.append(("Up, Down", "Pick a name from the list; in the list, also the first letter of the name"))
    lines += [(" or ".join(binding.keys), binding.does) for binding in (*QUESTION, HELP)]
    return tuple(lines)


def _bound(key: str, table: Sequence[KeyBinding]) -> Act | None:
    return next((binding.act for binding in table if key in binding.keys), None)


def _playing(key: str, screen: Screen) -> Act | None:
    if len(key) == 1 and key in string.digits:
        return TypeDigit(int(key))
    if screen.typed and key in ("Enter", "Esc"):
        return FinishNumber() if key == "Enter" else Cancel()
    match screen.popup:
        case DialoguePopup(choices=choices):
            if key == "Enter":
                return choices[0].act if choices else None
            answer = next((choice.act for choice in choices if choice.key == key), None)
            if answer is not None:
                return answer
        case TreasurePopup(verdict=verdict) as pop:
            if key in ("Up", "Down"):
                return _neighbour(pop, 1 if key == "Down" else -1)
            if key == "Enter" and verdict is not None:
                return ShowNext()
        case None:
            pass
    return _bound(key, PLAYING)


def _neighbour(pop: TreasurePopup, step: int) -> Act | None:
    if not pop.names or pop.verdict is not None:
        return None
    if pop.picked not in pop.names:
        return PickName(pop.names[0 if step > 0 else -1])
    return PickName(pop.names[(pop.names.index(pop.picked) + step) % len(pop.names)])
