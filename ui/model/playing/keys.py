"""Table of keys, used for the labels of buttons and the lines of the help sheet.

Keys are named as on the keyboard: "Tab", "Shift+Tab", "Enter", "Esc", "Space", "Up", "Down", "Home", "End", "F1", a
digit, a capital letter, "Ctrl+" and a capital letter, "?".

While a pop-up asks for the name of a treasure, letters select a name in the pop-up's list, regardless of the keyboard
focus; see `is_for_list`.
"""

import string
from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import (
    Act,
    Action,
    AskWhatItIs,
    Cancel,
    Confirm,
    DeclineConsentAct,
    DialoguePopup,
    EndGameAct,
    EnlargePicture,
    FinishNumber,
    FitMap,
    FollowRobot,
    GiveConsentAct,
    GoOnFromGame,
    GoToPeople,
    HandOverAct,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    NextRobot,
    Phase,
    PickName,
    PlayAgainAct,
    RaiseObjectionAct,
    RequestHandbackAct,
    RequestSuggestionAct,
    Screen,
    ShowHelp,
    ShowNext,
    ShowSettings,
    StopRobotAct,
    SwitchSound,
    TakePictureAct,
    TakeUpTreasureAct,
    TreasurePopup,
    TypeDigit,
    TypeLetter,
)

SETTINGS_KEYS = "Ctrl+,"
"""Keys that open the settings in all windows."""


@dataclass(frozen=True, slots=True)
class KeyBinding:
    """Keys that carry out one act.

    Attributes:
        keys: names of the keys; the first key is printed on the button.
        act: the act.
        does: key of the help sheet's text about the act.
    """

    keys: tuple[str, ...]
    act: Act
    does: str


PLAYING = (
    KeyBinding(("Tab",), NextRobot(1), "keys.next_robot"),
    KeyBinding(("Shift+Tab",), NextRobot(-1), "keys.robot_before"),
    KeyBinding(("D", "?"), RequestSuggestionAct(), "keys.advice"),
    KeyBinding(("X",), StopRobotAct(), "keys.stop"),
    KeyBinding(("B",), RequestHandbackAct(), "keys.ask_back"),
    KeyBinding(("Ctrl+P",), TakePictureAct(), "keys.picture"),
    KeyBinding(("Ctrl+I",), EnlargePicture(), "keys.enlarge"),
    KeyBinding(("Enter", "Ctrl+N"), IdentifyTreasureAct(), "keys.name"),
    KeyBinding(("Ctrl+K",), AskWhatItIs(), "keys.unsure"),
    KeyBinding(("Ctrl+L",), LeaveTreasureAct(), "keys.leave"),
    KeyBinding(("Ctrl+Z",), TakeUpTreasureAct(), "keys.take_up"),
    KeyBinding(("Esc", "W"), ShowNext(), "keys.aside"),
    KeyBinding(("F",), FollowRobot(), "keys.follow"),
    KeyBinding(("A",), FitMap(), "keys.whole_map"),
    KeyBinding(("M",), SwitchSound(), "keys.sound"),
    KeyBinding((SETTINGS_KEYS,), ShowSettings(), "keys.settings"),
    KeyBinding(("E",), EndGameAct(), "keys.end"),
)
"""Keys during a game. While letters select a name in a list, Ctrl and a letter have the letter's usual effect."""

CONSENT = (
    KeyBinding(("A",), GiveConsentAct(), "keys.agree"),
    KeyBinding(("N",), DeclineConsentAct(), "keys.decline"),
)
OVER = (
    KeyBinding(("A",), PlayAgainAct(), "keys.play_again"),
    KeyBinding(("Enter",), GoOnFromGame(), "keys.go_on"),
)
"""Keys after the game. The page offers only one of these acts."""
PEOPLE = KeyBinding(("T",), GoToPeople(), "people.key")
"""Key during and after a game of several participants."""
HAND_OVER = KeyBinding(("R",), HandOverAct(), "keys.hand_over")
"""Key in games with several participants, while a robot can be handed over."""
OBJECT = KeyBinding(("O",), RaiseObjectionAct(), "keys.object")
"""Key of seats that may object, while the dialogue of a teammate is shown."""
HELP = KeyBinding(("F1", "H"), ShowHelp(), "keys.help")

WAITING_KEY = "W"
"""Second key of `ShowNext`.

The key is printed on the button that shows the waiting pop-ups, because "Esc" would be unclear there.
"""

_TABLES = (PLAYING, (HAND_OVER,), CONSENT, OVER, (HELP,))
_CTRL = "Ctrl+"
_TAKEN = frozenset((*(key for binding in (*PLAYING, HELP) for key in binding.keys), "L", "N", "P"))
"""Letters that are never keys of answers, because they are keys of the game.

L, N and P are included because Ctrl+L, Ctrl+N and Ctrl+P are keys of treasures' pop-ups, which dialogues replace.
"""
BACK = "close-questions"
"""Name of the answer that leads from the questions back to the other answers."""
_STEPS = ("Up", "Down", "Home", "End")


def question_keys(texts: Texts) -> tuple[KeyBinding, KeyBinding]:
    """Return the keys for questions that ask for confirmation; the letters depend on the language.

    All other keys are ignored during a question.
    """
    return (
        KeyBinding((texts.text("keys.letter_of_yes"),), Confirm(), "keys.yes"),
        KeyBinding((texts.text("keys.letter_of_no"), "Esc"), Cancel(), "keys.no"),
    )


def key_of(act: Act) -> str:
    """Return the key to print on the button of an act; empty if the act has no key."""
    return next((binding.keys[0] for table in _TABLES for binding in table if binding.act == act), "")


def keyed(act: Act, label: str, enabled: bool = True, hint: str = "", pending: bool = False) -> Action:
    """Return the button of an act, with the act's key."""
    return Action(act, label, key_of(act), enabled, hint, pending)


def choice_keys(choices: Sequence[str], acts: Sequence[str] = ()) -> tuple[str, ...]:
    """Return a key for each possible answer.

    Args:
        choices: answers as sentences. The key of an answer is the first free letter of the sentence, such as C for
            Continue.
        acts: names of the effects of the answers if robots argue. Then the answers are numbered, and Esc is the key of
            the answer that leads back. Empty if robots do not argue.
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
    """Return the act of a key on a screen; None if the key has no effect.

    Args:
        key: name of the key, as in the docstring of this module.
        screen: the screen that the participant sees.
    """
    if is_for_list(key, screen):
        return TypeLetter(" " if key == "Space" else key.casefold())
    if key in HELP.keys or (screen.help and key == "Esc"):
        return HELP.act
    if screen.help:
        # The help sheet covers all objects of the other keys.
        return None
    if screen.confirmation is not None:
        answers = screen.confirmation.answers
        return Cancel() if key == "Esc" else next((answer.act for answer in answers if answer.key == key), None)
    if screen.enlarged is not None:
        return EnlargePicture() if key in ("Esc", "Enter", "Space", key_of(EnlargePicture())) else None
    match screen.phase:
        case Phase.CONSENT:
            return _bound(key, CONSENT)
        case Phase.OVER:
            if key in PEOPLE.keys and _writes(screen):
                return PEOPLE.act
            act = _bound(key, OVER)
            return act if screen.ending is not None and screen.ending.again.act == act else None
        case Phase.PLAYING:
            act = _playing(key, screen)
            return None if screen.no_map and isinstance(act, FollowRobot | FitMap) else act
        case Phase.CONNECTING:
            return None


def is_for_list(key: str, screen: Screen) -> bool:
    """Return True if a key is a letter for the visible list of names, or a space within a name."""
    pop = screen.popup
    if not isinstance(pop, TreasurePopup) or not pop.asks_for_name or _is_covered(screen):
        return False
    return is_letter(key) or (key == "Space" and bool(pop.typed))


def _is_covered(screen: Screen) -> bool:
    """Return True while a question, the help sheet or a picture covers the pop-up."""
    return screen.confirmation is not None or bool(screen.help) or screen.enlarged is not None


def is_letter(key: str) -> bool:
    """Return True for the key of a single letter."""
    return len(key) == 1 and key.isalpha()


def shown_key(texts: Texts, key: str) -> str:
    """Return the name of a key in the participant's language, such as "Strg+P" for "Ctrl+P"."""
    *held, last = [key] if len(key) == 1 else key.split("+")
    return "+".join(_key_name(texts, each) for each in (*held, last))


def help_line(texts: Texts, binding: KeyBinding) -> tuple[str, str]:
    """Return a line of the help sheet as (keys, effect)."""
    keys = [shown_key(texts, key) for key in binding.keys]
    both = keys[0] if len(keys) == 1 else texts.text("keys.one_or_other", key=keys[0], other_key=keys[1])
    return both, texts.text(binding.does)


def help_lines(
    texts: Texts,
    rooms: int,
    silent: str = "",
    *,
    properties: bool = False,
    numbered: bool = False,
    team: bool = False,
    has_map: bool = True,
    objects: bool = False,
) -> tuple[tuple[str, str], ...]:
    """Return all lines of the help sheet as (keys, effect).

    Args:
        texts: texts of the window's language.
        rooms: number of rooms; 0 before there is a game.
        properties: True if the participant can ask robots to sense further properties, or can report properties.
        numbered: True if answers to robots are numbered.
        team: True in a game with several participants.
        has_map: False if the participant does not see the map.
        objects: True if the participant may object in dialogues of teammates.
        silent: reason why there is no sound, shown in place of the effect of the sound key; empty if there is sound.
    """
    enter, ctrl = shown_key(texts, "Enter"), shown_key(texts, "Ctrl")

    def listed(*keys: str) -> str:
        return ", ".join(shown_key(texts, key) for key in keys)

    lines = []
    if rooms:
        number = texts.text("keys.room_of_two_digits", key=enter) if rooms > 9 else texts.text("keys.room")
        lines.append((texts.text("keys.one_to_other", key="1", other_key=str(rooms)), number))
    for binding in PLAYING:
        if isinstance(binding.act, FollowRobot | FitMap) and not has_map:
            continue
        keys, does = help_line(texts, binding)
        lines.append((keys, silent if silent and isinstance(binding.act, SwitchSound) else does))
    if team:
        yes, no = (binding.keys[0] for binding in question_keys(texts))
        lines += [help_line(texts, HAND_OVER), (yes, texts.text("keys.vote_yes")), (no, texts.text("keys.vote_no"))]
    if objects:
        lines.append(help_line(texts, OBJECT))
    if numbered:
        lines.append((texts.text("keys.one_to_other", key="1", other_key="5"), texts.text("keys.numbered_answer")))
        lines.append((listed("Up", "Down"), texts.text("keys.through_answers", key=enter)))
        lines.append((listed("PageUp", "PageDown"), texts.text("keys.through_talk")))
        lines.append((listed("Esc"), texts.text("keys.back_from_questions")))
    else:
        lines.append((enter, texts.text("keys.first_answer")))
    lines.append((texts.text("keys.letters"), texts.text("keys.name_letters")))
    lines.append((listed(*_STEPS), texts.text("keys.name_steps")))
    if properties:
        lines.append((texts.text("keys.with_number", key=ctrl), texts.text("keys.property_number")))
    lines.append((texts.text("keys.with_letter", key=ctrl), texts.text("keys.letter_meanwhile")))
    others = (PEOPLE,) if team else ()
    lines += [help_line(texts, binding) for binding in (*others, *question_keys(texts), HELP)]
    return tuple(lines)


def button_keys(texts: Texts) -> tuple[tuple[str, str], ...]:
    """Return the keys that move from button to button and change the size of text, as lines of the help sheet."""
    ctrl, space, enter = (shown_key(texts, key) for key in ("Ctrl", "Space", "Enter"))
    return (
        (texts.text("pages.keys_arrows"), texts.text("pages.key_arrows", space=space, enter=enter)),
        (texts.text("pages.keys_text", ctrl=ctrl), texts.text("pages.key_text", ctrl=ctrl)),
    )


def _key_name(texts: Texts, key: str) -> str:
    name = f"keys.key_{key.lower()}"
    return texts.text(name) if texts.has(name) else key


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
            if key in OBJECT.keys and screen.popup.objects is not None:
                return OBJECT.act
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
    votes = (button for vote in screen.votes for button in vote.buttons)
    if (vote := next((button.act for button in votes if button.key == key), None)) is not None:
        return vote
    if key in HAND_OVER.keys:
        return HAND_OVER.act if any(card.selected and card.hand_over for card in screen.cards) else None
    return _bound(key, (*PLAYING, PEOPLE) if _writes(screen) else PLAYING)


def _writes(screen: Screen) -> bool:
    """Return True if the screen has a field for texts to other people."""
    return screen.people is not None and screen.people.writes


def popup_keys(screen: Screen) -> frozenset[str]:
    """Return the letters that belong to the pop-up shown: those of the answers, or all if a list of names is shown."""
    match screen.popup:
        case DialoguePopup(choices=choices):
            return frozenset(choice.key for choice in choices)
        case TreasurePopup(asks_for_name=True):
            return frozenset(string.ascii_uppercase)
        case _:
            return frozenset()


def _digit(digit: int, screen: Screen) -> Act | None:
    """Return the act of a digit.

    If answers are numbered and no room number was begun, the digit is an answer. Otherwise it belongs to a room number.
    """
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
