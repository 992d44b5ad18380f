"""Open dialogues as JSON values, to be saved and restored."""

from collections.abc import Callable
from typing import assert_never

from thbridge.dialogue.engine import Dialogues
from thbridge.dialogue.moves import Ask, Author, Continue, Dialogue, DialogueTopic, Move, Scenario, Speaker, Stop, Turn
from thbridge.hunt.json_fields import Fields, Json
from thbridge.hunt.rooms import Room

VERSION = 2


def snapshot(dialogues: Dialogues) -> dict[str, Json]:
    """Return a JSON value from which `restore` makes equal dialogues."""
    return {
        "v": VERSION,
        "opened": dialogues.opened,
        "open": [
            {
                "number": dialogue.number,
                **_topic_fields(dialogue.topic),
                "turns": [_turn_fields(turn) for turn in dialogue.turns],
            }
            for dialogue in dialogues.open
        ],
    }


def restore(value: object) -> Dialogues:
    """Return the dialogues of a snapshot.

    Raises:
        ValueError: it is not such a snapshot; the message names the faulty field.
    """
    fields = Fields(value)
    version = fields.integer("v")
    if version != VERSION:
        raise ValueError(f"the snapshot is version {version}, this program reads version {VERSION}")
    dialogues = Dialogues(fields.integer("opened"), tuple(_dialogue(dialogue) for dialogue in fields.objects("open")))
    fields.end()
    return dialogues


def move_fields(move: Move) -> dict[str, Json]:
    """Return a move as the fields of a JSON object: `move` is its kind."""
    match move:
        case Ask(question):
            return {"move": "ask", "question": question}
        case Continue():
            return {"move": "continue"}
        case Stop():
            return {"move": "stop"}
        case _:
            assert_never(move)


def take_move(fields: Fields) -> Move:
    """Take the move out of these fields; others are left. Raises ValueError for an unknown one."""
    kind = fields.text("move")
    if kind not in _MOVES:
        raise ValueError(f"unknown move {kind!r}")
    return _MOVES[kind](fields)


_MOVES: dict[str, Callable[[Fields], Move]] = {
    "ask": lambda fields: Ask(fields.integer("question")),
    "continue": lambda _: Continue(),
    "stop": lambda _: Stop(),
}


def _topic_fields(topic: DialogueTopic) -> dict[str, Json]:
    return {
        "scenario": topic.scenario.value,
        "robot": topic.robot,
        "room": topic.room.people,
        "cost": topic.cost,
        "energy": topic.energy,
        "colour": topic.colour,
        "footprint": topic.footprint,
    }


def _turn_fields(turn: Turn) -> dict[str, Json]:
    return {
        "speaker": turn.speaker.value,
        **move_fields(turn.move),
        "author": turn.author.value,
        "text": turn.text,
    }


def _dialogue(fields: Fields) -> Dialogue:
    dialogue = Dialogue(
        fields.integer("number"),
        DialogueTopic(
            Scenario(fields.text("scenario")),
            fields.integer("robot"),
            Room.of_people(fields.integer("room")),
            fields.number("cost"),
            fields.number("energy"),
            fields.text("colour"),
            fields.text("footprint"),
        ),
        tuple(_turn(turn) for turn in fields.objects("turns")),
    )
    fields.end()
    return dialogue


def _turn(fields: Fields) -> Turn:
    turn = Turn(Speaker(fields.text("speaker")), take_move(fields), Author(fields.text("author")), fields.text("text"))
    fields.end()
    return turn
