"""Sentences of the player about recorded events, in the language of the page."""

from thbridge.dialogue.wording.texts import NamedRoom, Texts
from thbridge.hunt import events
from thbridge.hunt.codec import from_json
from thbridge.hunt.event_words import event_in_words, kind_in_words
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.hunt.seats import capitalized
from thbridge.hunt.treasures import name_in_words
from thbridge.json_text import json_of
from thbridge.ros.messages.session_records import GameEvent, UtteranceRecord
from ui.model.playing.objections import reason_words
from ui.web.player.content import EntryMark, PlayedEntry

_INCIDENTS = {
    "collision": (EntryMark.FAILED, "player.collision"),
    "carried": (EntryMark.FAILED, "player.moved"),
    "died": (EntryMark.FAILED, "player.died"),
    "revived": (EntryMark.OTHER, "player.revived"),
}
"""Recorded kinds of events of a robot that are not events of the game, with their marks and texts."""
_OMITTED = (
    events.TreasuresHidden
    | events.ConsentGiven
    | events.RoomAdvised
    | events.CostsEstimated
    | events.DialogueOpened
    | events.DialogueSaid
    | events.KeyUsed
)
"""Events that the transcript omits: values for analyses, and repetitions of utterances."""


class EventWords:
    """Sentences about events.

    Args:
        texts: texts of the page's language.
        rooms: names of the map's rooms.
    """

    def __init__(self, texts: Texts, rooms: RoomNames) -> None:
        self.texts, self._rooms = texts, rooms

    def entry(self, at: float, recorded: GameEvent, robot: int | None) -> PlayedEntry | None:
        """Return the entry of an event; None for an event that the transcript omits.

        Args:
            at: seconds.
            recorded: the event.
            robot: index of the event's robot in the page, or None.
        """
        event = event_of(recorded)
        if isinstance(event, _OMITTED) or recorded.kind == "authored":
            return None
        if recorded.kind in _INCIDENTS and recorded.robot is not None:
            mark, key = _INCIDENTS[recorded.kind]
            return PlayedEntry(at, mark, "", robot, "", self.texts.text(key, robot=recorded.robot))
        if event is None:
            return PlayedEntry(at, EntryMark.OTHER, "", robot, "", _plain(recorded))
        mark, text = self._words(event)
        points = event.points if isinstance(event, events.TreasureIdentified) else None
        return PlayedEntry(at, mark, "", robot, "", text, points)

    def utterance(self, at: float, said: UtteranceRecord, robot: int | None) -> PlayedEntry:
        """Return the entry of an utterance; `robot` is the index of its robot in the page, or None."""
        speaker = "robot" if said.speaker == "robot" else "participant"
        who = self.texts.text(f"player.speaker_{speaker}", robot=said.robot)
        if said.author == "wizard":
            who = self.texts.text("player.speaker_researcher", speaker=who)
        return PlayedEntry(at, EntryMark.SAID, speaker, robot, who, said.text or said.move)

    def objection(self, at: float, raised: events.ObjectionRaised, label: str, robot: int | None) -> PlayedEntry:
        """Return the entry of an objection.

        Args:
            at: seconds.
            raised: the objection.
            label: words for the seat that objects.
            robot: index of the dialogue's robot in the page, or None.
        """
        key = "objections.by_teammate_because" if raised.text else "objections.by_teammate"
        reason = reason_words(self.texts, raised.reason)
        text = self.texts.text(key, seat=capitalized(label), reason=reason, words=raised.text)
        return PlayedEntry(at, EntryMark.OTHER, "", robot, "", text)

    def room(self, room: Room | int) -> NamedRoom:
        """Return a room with its name."""
        number = room.people if isinstance(room, Room) else room
        return NamedRoom(number, self._rooms.name(number))

    def points(self, points: int) -> str:
        """Return points with their sign, in words."""
        return self.texts.text("player.points", count=abs(points), signed=f"{points:+d}")

    def _words(self, event: events.JournalEntry) -> tuple[EntryMark, str]:
        """Return the mark and the sentence of an event."""
        text, room = self.texts.text, self.room
        match event:
            case events.GameStarted(game=game):
                return EntryMark.OTHER, text("player.started", number=game)
            case events.GameEnded(reason=reason, score=score):
                return EntryMark.OTHER, text(f"player.ended_{reason.replace('-', '_')}", score=score)
            case events.RobotDeparted():
                return EntryMark.DRIVEN, text("player.departed", robot=event.robot, room=room(event.room))
            case events.RobotArrived():
                return EntryMark.DRIVEN, text("player.arrived", robot=event.robot, room=room(event.room))
            case events.MoveFailed(robot=robot, reason=reason):
                return EntryMark.FAILED, text("player.move_failed", robot=robot, room=room(event.room), reason=reason)
            case events.ConditionChanged(robot=robot, condition=condition):
                mark = EntryMark.OTHER if condition is events.Condition.WELL else EntryMark.FAILED
                return mark, text(f"player.condition_{condition}", robot=robot)
            case events.CommanderChanged(robot=robot, by=events.Commander.PARTICIPANT):
                return EntryMark.DECIDED, text("player.commanded_participant", robot=robot)
            case events.CommanderChanged(robot=robot, by=by, name=name):
                commander = name or text(f"words.{by.replace(' ', '_')}")
                return EntryMark.DECIDED, text("player.commanded", robot=robot, commander=commander)
            case events.HandbackRequested(robot=robot):
                return EntryMark.DECIDED, text("player.asked_back", robot=robot)
            case events.TreasureSensed(properties=properties) if properties:
                values = self.texts.listed(properties.values())
                return EntryMark.FOUND, text("player.sensed", room=room(event.room), values=values)
            case events.TreasureSensed():
                return EntryMark.FOUND, text("player.something_found", room=room(event.room))
            case events.PropertyMeasured(property=name, value=value):
                return EntryMark.FOUND, text("player.measured", room=room(event.room), property=name, value=value)
            case events.PropertyTold(property=name, value=value):
                return EntryMark.FOUND, text("player.reported", room=room(event.room), property=name, value=value)
            case events.TreasurePictured(robot=robot):
                return EntryMark.FOUND, text("player.pictured", robot=robot, room=room(event.room))
            case events.TreasureIdentified(room=Room() as place, name=str(name), points=points):
                named, won = name_in_words(name), self.points(points)
                return EntryMark.DECIDED, text("player.identified", room=room(place), name=named, points=won)
            case events.TreasureIdentified(points=points):
                return EntryMark.DECIDED, text("player.identified_points", points=self.points(points))
            case events.TreasureLeft():
                return EntryMark.DECIDED, text("player.left", room=room(event.room))
            case events.TreasureTakenUp():
                return EntryMark.DECIDED, text("player.taken_up", room=room(event.room))
        raise TypeError(f"the player has no sentence for {type(event).__name__}")


def event_of(recorded: GameEvent) -> events.JournalEntry | None:
    """Return the event of the game in a record; None for other events, and for events of an unknown form."""
    try:
        return from_json(recorded.json)
    except ValueError:
        return None


def _plain(recorded: GameEvent) -> str:
    """Return the words of an event that the player does not know, in English."""
    try:
        fields = json_of(recorded.json)
    except ValueError:
        fields = None
    known = isinstance(fields, dict)
    text = event_in_words(recorded.kind, fields) if known else recorded.json
    return f"{kind_in_words(recorded.kind)}: {text}" if text else kind_in_words(recorded.kind)
