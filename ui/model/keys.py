"""Table of keys: buttons get their labels from it, and the help sheet its lines.

Keys are named as on the keyboard: "Tab", "Shift+Tab", "Enter", "Esc", "Space", "Up", "Down", "Home", "End", "F1", a
digit, a capital letter, "Ctrl+" and a capital letter, "?".

While a pop-up asks for the name of a treasure, letters belong to its list, wherever the focus is; see `is_for_list`.
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
    AskWhatItIs,
    Cancel,
    Confirm,
    DeclineToTakePart,
    DialoguePopup,
    EndGame,
    EnlargePicture,
    FinishNumber,
    FitMap,
    FollowRobot,
    GoOnFromGame,
    LeaveTreasure,
    NextRobot,
    Phase,
    PickName,
    Screen,
    ShowHelp,
    ShowNext,
    StopRobot,
    SubmitName,
    SwitchSound,
    TakeThePicture,
    TakeUpAgain,
    TreasurePopup,
    TypeDigit,
    TypeLetter,
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
    KeyBinding(("Ctrl+P",), TakeThePicture(), "Take a picture of what was found"),
    KeyBinding(("Ctrl+I",), EnlargePicture(), "Show the picture large, or small again"),
    KeyBinding(("Enter", "Ctrl+N"), SubmitName(), "Name what was found, as picked from the list"),
    KeyBinding(("Ctrl+K",), AskWhatItIs(), "Ask the robot what it is, where robots argue"),
    KeyBinding(("Ctrl+L",), LeaveTreasure(), "Leave what was found"),
    KeyBinding(("Ctrl+Z",), TakeUpAgain(), "Take up again what was left, until the robot sets out"),
    KeyBinding(("Esc", "W"), ShowNext(), "Put the pop-up aside, or show what waits"),
    KeyBinding(("F",), FollowRobot(), "Keep the robot in the middle of the map, or stop doing so"),
    KeyBinding(("A",), FitMap(), "Show the whole map"),
    KeyBinding(("M",), SwitchSound(), "Switch sound off, or on again"),
    KeyBinding(("E",), EndGame(), "End the game"),
)
"""Keys while the game goes on. While letters belong to a list, Ctrl and the letter does what the letter does."""

CONSENT = (
    KeyBinding(("A",), AgreeToTakePart(), "Agree to take part"),
    KeyBinding(("N",), DeclineToTakePart(), "Do not take part"),
)
OVER = (
    KeyBinding(("A",), AnotherGame(), "Play another game"),
    KeyBinding(("Enter",), GoOnFromGame(), "Go on with what comes after the game"),
)
"""Keys once the game is over, one for each of the ways on; the page offers one of them."""
QUESTION = (
    KeyBinding(("Y",), Confirm(), "Yes, to a question of the program"),
    KeyBinding(("N", "Esc"), Cancel(), "No, to a question of the program"),
)
"""Keys while the program asks for confirmation; all others are ignored then."""

HELP = KeyBinding(("F1", "H"), ShowHelp(), "Open or close this sheet")

WAITING_KEY = "W"
"""The second key of `ShowNext`: for a button that shows what waits, "Esc" would be a riddle."""

_TABLES = (PLAYING, CONSENT, OVER, QUESTION, (HELP,))
_CTRL = "Ctrl+"
_TAKEN = frozenset((*(key for binding in (*PLAYING, HELP) for key in binding.keys), "L", "N", "P"))
"""Keys that no answer gets: with Ctrl, L, N and P are keys of the pop-up that dialogues take the place of."""
BACK = "close-questions"
"""Word for the answer that leads from the questions back to the other answers."""
_STEPS = ("Up", "Down", "Home", "End")


def key_of(act: Act) -> str:
    """The key to print on the button of an act; empty when it has none of its own."""
    return next((binding.keys[0] for table in _TABLES for binding in table if binding.act == act), "")


def keyed(act: Act, label: str, enabled: bool = True, hint: str = "", pending: bool = False) -> Action:
    """The action of an act, with its own key."""
    return Action(act, label, key_of(act), enabled, hint, pending)


def choice_keys(choices: Sequence[str], acts: Sequence[str] = ()) -> tuple[str, ...]:
    """A key for each answer that may be given.

    Args:
        choices: sentences. Each gets a letter of its first word if one is free: C for Continue.
        acts: words for what the choices do, of robots that argue: their answers are numbered, and Esc leads back.
    """
    if acts:
        return tuple("Esc" if act == BACK else str(number) for number, act in enumerate(acts, start=1))
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
    if is_for_list(key, screen):
        return TypeLetter(" " if key == "Space" else key.casefold())
    if key in HELP.keys or (screen.help and key == "Esc"):
        return HELP.act
    if screen.help:
        # The sheet covers what the other keys are for.
        return None
    if screen.confirmation is not None:
        return _bound(key, QUESTION)
    if screen.enlarged is not None:
        return EnlargePicture() if key in ("Esc", "Enter", "Space", key_of(EnlargePicture())) else None
    match screen.phase:
        case Phase.CONSENT:
            return _bound(key, CONSENT)
        case Phase.OVER:
            act = _bound(key, OVER)
            return act if screen.ending is not None and screen.ending.again.act == act else None
        case Phase.PLAYING:
            return _playing(key, screen)
        case Phase.CONNECTING:
            return None


def is_for_list(key: str, screen: Screen) -> bool:
    """Return True when a key is a letter of a name in the list shown, or a blank within one."""
    pop = screen.popup
    if not isinstance(pop, TreasurePopup) or not pop.asks_for_name or _is_covered(screen):
        return False
    return is_letter(key) or (key == "Space" and bool(pop.typed))


def _is_covered(screen: Screen) -> bool:
    """Return True while something lies above the pop-up."""
    return screen.confirmation is not None or bool(screen.help) or screen.enlarged is not None


def is_letter(key: str) -> bool:
    """Return True for the key of a letter alone."""
    return len(key) == 1 and key.isalpha()


def help_lines(
    rooms: int, silent: str = "", *, properties: bool = False, numbered: bool = False
) -> tuple[tuple[str, str], ...]:
    """The help sheet: (keys, what they do).

    Args:
        rooms: number of rooms; 0 before there is a game.
        properties: True when robots can be asked to sense more, or the participant to tell it.
        numbered: True when answers to robots are numbered.
        silent: why there can be no sound, which stands in place of what its key does; empty when there can be.
    """
    number = "Send the robot to this room" + (": both digits, or Enter after the first" if rooms > 9 else "")
    lines = [(f"1 to {rooms}", number)] if rooms else []
    for binding in PLAYING:
        does = silent if silent and isinstance(binding.act, SwitchSound) else binding.does
        lines.append((" or ".join(binding.keys), does))
    if numbered:
        lines.append(("1 to 5", "While a robot waits for an answer: the answer with this number"))
        lines.append(("Up, Down", "While a robot waits for an answer: from answer to answer; Enter gives it"))
        lines.append(("PageUp, PageDown", "What was said before, and what was said last"))
        lines.append(("Esc", "Among the questions to a robot: back to the other answers"))
    else:
        lines.append(("Enter", "The first of the answers to a robot; each answer's own letter is on its button"))
    lines.append(("Letters", "While a name is asked for: pick the name that begins so"))
    lines.append((", ".join(_STEPS), "While a name is asked for: pick the name before or after, the first or last"))
    if properties:
        lines.append(("Ctrl and a number", "While a name is asked for: sense or say more of what was found"))
    lines.append(("Ctrl and a letter", "While a name is asked for: what the letter does otherwise"))
    lines += [(" or ".join(binding.keys), binding.does) for binding in (*QUESTION, HELP)]
    return tuple(lines)


def _bound(key: str, table: Sequence[KeyBinding]) -> Act | None:
    return next((binding.act for binding in table if key in binding.keys), None)


def _playing(key: str, screen: Screen) -> Act | None:
    if len(key) == 1 and key in string.digits:
        return _digit(int(key), screen)
    if screen.typed and key in ("Enter", "Esc"):
        return FinishNumber() if key == "Enter" else Cancel()
    match screen.popup:
        case DialoguePopup(choices=choices):
            if key == "Enter":
                return choices[0].act if choices else None
            answer = next((choice.act for choice in choices if choice.key == key), None)
            if answer is not None:
                return answer
        case TreasurePopup() as pop if pop.asks_for_name:
            if key in _STEPS:
                return _step(key, pop)
            if (of_a_fact := next((act.act for act in pop.acts if act.key == key), None)) is not None:
                return of_a_fact
            return _bound(key, PLAYING) or _bound(key.removeprefix(_CTRL), (*PLAYING, HELP))
        case TreasurePopup() if key == "Enter":
            return ShowNext()
        case _:
            pass
    return _bound(key, PLAYING)


def _digit(digit: int, screen: Screen) -> Act | None:
    """A digit of a room's number; while answers are numbered, an answer, unless a number has been begun before."""
    pop = screen.popup
    if not isinstance(pop, DialoguePopup) or not pop.numbered or screen.typed:
        return TypeDigit(digit)
    return pop.choices[digit - 1].act if 0 < digit <= len(pop.choices) else None


def _step(key: str, pop: TreasurePopup) -> Act | None:
    if not pop.names:
        return None
    if key in ("Home", "End") or pop.picked not in pop.names:
        return PickName(pop.names[0 if key in ("Home", "Down") else -1])
    step = 1 if key == "Down" else -1
    return PickName(pop.names[(pop.names.index(pop.picked) + step) % len(pop.names)])
