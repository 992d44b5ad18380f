"""Sample states of the participant's window, and a model that shows one of them."""

import base64
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

import numpy as np

from sim.common.geometry import Pose2
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from thbridge.files.map_files import read_map
from thbridge.hunt.properties import PropertyDrawing
from thbridge.roles.notices import FloorPlan, RoomOutline
from ui.model.keys import help_lines
from ui.model.scene import RobotMark, RoomMark
from ui.model.screen import (
    Act,
    Action,
    AgreeToTakePart,
    AnotherGame,
    AskAdvice,
    AskForRobot,
    Banner,
    Cancel,
    ChooseRobot,
    ChooseRoom,
    Confirm,
    Confirmation,
    DeclineToTakePart,
    DialoguePopup,
    EndGame,
    EnlargePicture,
    FitMap,
    FollowRobot,
    GameOverPage,
    GiveAnswer,
    HistoryLine,
    LeaveTreasure,
    Phase,
    RobotCard,
    RoomTile,
    Screen,
    ShowHelp,
    ShowNext,
    ShowSettings,
    ShowWaiting,
    StopRobot,
    SubmitName,
    TakeThePicture,
    TakeUpAgain,
    TreasureFact,
    TreasurePopup,
    WaitingItem,
)

PROJECT = Path(__file__).resolve().parents[3]
FOOTPRINT = ((0.35, 0.0), (0.2, 0.25), (-0.3, 0.25), (-0.3, -0.25), (0.2, -0.25))
NAMES = ("Blue bottle", "Orange bottle", "Pink can", "Yellow can")
LATER = Action(ShowNext(), "Later", "Esc", hint="It waits for you.")

_FOUND = {1: ("Orange bottle, +10", "Orange bottle", "+10"), 4: ("something pink", "pink")}
_STATES = ("driving", "rest", "waiting", "lost", "rest", "empty")


@cache
def floor_plan(name: str = "arena8") -> FloorPlan:
    """One of our maps as the notice that a participant gets."""
    drawn = read_map(PROJECT / "maps" / name)
    rows, cols = drawn.grid.cells.shape
    cells = np.where(drawn.grid.cells == 100, 1, np.where(drawn.grid.cells < 0, 2, 0)).astype(np.uint8)
    rooms = tuple(
        RoomOutline(
            at + 1,
            room.name,
            tuple((float(x), float(y)) for x, y in room.region),
            (room.goal.x, room.goal.y, room.goal.theta),
        )
        for at, room in enumerate(drawn.rooms)
    )
    origin = drawn.grid.origin
    packed = base64.b64encode(zlib.compress(cells.tobytes())).decode()
    return FloorPlan(
        name,
        drawn.grid.resolution,
        (origin.x, origin.y, origin.theta),
        cols,
        rows,
        packed,
        rooms,
        FOOTPRINT,
    )


def card(robot: int, *, selected: bool = False, state: str = "rest", cost: float | None = None) -> RobotCard:
    words = {
        "driving": "traveling to room 4",
        "waiting": "waiting for robot 2",
        "lost": "lost, looking for its place",
        "empty": "no energy left",
        "rest": "at rest",
    }[state]
    energy = {"lost": 31.5, "empty": 0.0}.get(state, 72.0 - 7 * robot)
    moving = state in ("driving", "waiting", "lost")
    return RobotCard(
        robot=robot,
        name=f"Robot {robot + 1}",
        selected=selected,
        energy=energy,
        energy_at_start=100.0,
        cost=cost,
        affordable=cost is None or cost <= energy,
        place="from room 1" if moving else "room 3",
        state=words,
        trouble=state in ("lost", "empty"),
        progress={"driving": 0.62, "waiting": 0.3, "lost": 0.45}.get(state),
        waits=2 if robot == 1 else 0,
        select=Action(ChooseRobot(robot), f"Robot {robot + 1}", "", hint="Commands this robot."),
        stop=Action(StopRobot(robot), "Stop", "X" if selected else "", hint="Calls it back.") if moving else None,
    )


def commanded(robot: int, *, selected: bool = False, asked: bool = False, state: str = "driving") -> RobotCard:
    """One that a ground station commands."""
    key = "B" if selected else ""
    label = "Asked" if asked else "Ask for it back"
    ask = Action(AskForRobot(robot), label, key, not asked, hint="The ground station commands it.")
    shown = card(robot, selected=selected, state=state)
    return replace(shown, stop=None, commander="ground station 255", ask_back=ask)


def left(robot: int, *, selected: bool = False) -> RobotCard:
    """One that stands where something was left."""
    key = "Ctrl+Z" if selected else ""
    again = Action(TakeUpAgain(robot), "Take it up again", key, hint="You left what is in room 3.")
    return replace(card(robot, selected=selected), take_up=again)


def tile(number: int, rooms: int, *, considered: bool = False) -> RoomTile:
    state = "visited" if number in (1, 4) else "reserved" if number == 2 else "unvisited"
    key = str(number).zfill(len(str(rooms)))
    can = state == "unvisited" and number != 6
    hint = f"Costs 13; robot 1 keeps {59 - number}." if can else "Robot 1 has not enough energy."
    if state != "unvisited":
        hint = "This room was visited." if state == "visited" else "Robot 2 is under way to it."
    found, *shorter = _FOUND.get(number, ("",))
    return RoomTile(
        room=number,
        name=("North west", "West", "South west", "North middle", "South middle", "North east", "East", "South east")[
            (number - 1) % 8
        ],
        state=state,
        robot={1: 0, 4: 2, 2: 1}.get(number),
        cost=13.0 + number if state == "unvisited" and number != 8 else None,
        considered=considered,
        found=found,
        found_shorter=tuple(shorter),
        choose=Action(ChooseRoom(number), f"Room {number}", key, can, hint),
        warning="Enough energy to get there, not to name what is there." if number == 7 else "",
    )


def playing(robots: int = 3, rooms: int = 8, considered: int | None = None) -> Screen:
    """The usual state: robots at work, one room looked at."""
    cards = tuple(
        card(
            robot,
            selected=robot == 0,
            state=_STATES[robot % len(_STATES)] if robots > 1 else "rest",
            cost=18.0 if robot == 0 and considered is not None else None,
        )
        for robot in range(robots)
    )
    return Screen(
        phase=Phase.PLAYING,
        waiting_for="",
        consent="",
        agree=Action(AgreeToTakePart(), "I agree", "A"),
        decline=Action(DeclineToTakePart(), "I do not take part", "N"),
        banner=None,
        game=1,
        score=120,
        progress="Time 12:05 · 5 of 8 rooms left",
        cards=cards,
        tiles=tuple(tile(number, rooms, considered=number == considered) for number in range(1, rooms + 1)),
        ask_advice=Action(AskAdvice(), "Don't know", "D", hint="Ask robot 1 where to go."),
        end=Action(EndGame(), "End game", "E", hint="Robots could still do something."),
        tools=(
            Action(FollowRobot(), "Follow", "F", hint="Keeps robot 1 in the middle of the map."),
            Action(FitMap(), "Whole map", "A", hint="Shows all of the map."),
            Action(ShowSettings(), "Settings", "Ctrl+,", hint="Colors, size of text, sound."),
            Action(ShowHelp(), "Help", "F1", hint="All keys on one sheet."),
        ),
        popup=None,
        confirmation=None,
        waiting=(),
        history=(
            HistoryLine("game", None, "The game begins."),
            HistoryLine("you", 0, "Go to room 4."),
            HistoryLine("robot", 0, "It will cost me 13 to go to room 4. Are you sure?"),
            HistoryLine("you", 0, "Continue."),
            HistoryLine("game", None, "Robot 1 is under way to room 4."),
        ),
        ending=None,
        help=(),
        typed="",
        announcement="",
        announcement_number=0,
    )


def dialogue() -> DialoguePopup:
    return DialoguePopup(
        robot=0,
        title="Robot 1 talks about room 5",
        sentences=(
            ("you", "I don't know where to go."),
            ("robot", "Do you want me to go to room 5?"),
            ("you", "Continue"),
            ("robot", "It will cost me 12.5 to go to room 5, which leaves 59.5. Are you sure?"),
        ),
        choices=(
            Action(GiveAnswer(0), "Continue", "C"),
            Action(GiveAnswer(1), "Stop", "S"),
        ),
        aside=LATER,
    )


def treasure(
    *, picture: bool = False, picked: str | None = None, verdict: str | None = None, points: int | None = None
) -> TreasurePopup:
    data = (PROJECT / "templates/original-2016/pictures/rsz_t4.jpg").read_bytes() if picture else None
    return TreasurePopup(
        robot=1,
        room=4,
        title="Robot 2 found something in room 4",
        facts=(
            TreasureFact("Colour", "Pink", PropertyDrawing.COLOUR),
            TreasureFact("Footprint", "Square and Small", PropertyDrawing.SHAPE),
        ),
        take_picture=None
        if picture
        else Action(TakeThePicture(), "Take a picture", "Ctrl+P", hint="Costs 5 of 72 energy."),
        picture=data,
        names=NAMES,
        picked=picked,
        name_it=Action(
            SubmitName(),
            f"Name it {picked}" if picked else "Name it",
            "Enter",
            picked is not None,
            "Costs 5 energy." if picked is not None else "Pick a name first.",
        ),
        leave=Action(LeaveTreasure(), "Leave it", "Ctrl+L", hint="Free; can be undone."),
        verdict=verdict,
        points=points,
        aside=LATER if verdict is None else Action(ShowNext(), "Close", "Esc"),
        enlarge=Action(EnlargePicture(), "Enlarge", "Ctrl+I") if picture else None,
    )


def arguing() -> DialoguePopup:
    """A robot that argues, with as many answers as there can be, all of them long."""
    room = "room 6 (North east)"
    return DialoguePopup(
        robot=0,
        title="Robot 1: go to room 6?",
        sentences=(
            ("you", "Go to room 6."),
            ("robot", f"My advice: do not send me to {room} next."),
            ("you", f"Why not {room}?"),
            (
                "robot",
                f"I would not go to {room} next. My reasons: if I go to {room} next, we reach 8 rooms for 124 energy "
                "in all; if I go to room 2 (West) next, we reach 8 rooms for 123 energy in all, and 123 is less than "
                "124.",
            ),
        ),
        choices=(
            Action(GiveAnswer(0), f"All right: if you go to {room} next, we reach 8 rooms for 124 energy in all.", "1"),
            Action(GiveAnswer(1), f"Why go to room 2 (West) first, then to {room}?", "2"),
            Action(GiveAnswer(2), f"Go to {room} all the same.", "3", hint="This is your decision."),
            Action(GiveAnswer(3), "I have a question.", "4"),
            Action(GiveAnswer(4), "Let us leave it at that.", "5"),
        ),
        aside=LATER,
        room=6,
        note="Robot 1 advises you. The decision is yours.",
        numbered=True,
    )


def questions() -> DialoguePopup:
    """The questions that can be put to the robot that argues."""
    asked = ("Why room 2 (West)?", "Why not room 6 (North east)?", "What would change your mind?", "Back.")
    keys = ("1", "2", "3", "Esc")
    choices = tuple(Action(GiveAnswer(at), text, key) for at, (text, key) in enumerate(zip(asked, keys, strict=True)))
    return replace(arguing(), choices=choices, aside=replace(LATER, key="W"))


def ended() -> DialoguePopup:
    """The end of a dialogue with a robot that argues."""
    talk = arguing()
    close = Action(ShowNext(), "Close", "Esc")
    return replace(
        talk, sentences=talk.sentences[-2:], choices=(), aside=close, note="", outcome="Robot 1 goes to room 2."
    )


def naming() -> DialoguePopup:
    """The robot asks whether what it found shall be named, with its picture beside the talk."""
    find = treasure(picture=True)
    talk = replace(dialogue(), robot=find.robot, room=find.room, warning="")
    return replace(talk, facts=find.facts or (), picture=find.picture, enlarge=find.enlarge)


def waiting(number: int) -> tuple[WaitingItem, ...]:
    return tuple(
        WaitingItem(
            robot,
            f"Robot {robot + 1} is in room {robot + 3} and found something",
            Action(ShowWaiting(robot), "Show", "W" if robot == 1 else "", hint="Its answer waits."),
        )
        for robot in range(1, number + 1)
    )


QUESTION = Confirmation(
    "Stop robot 1?",
    "Robot 1 is on its way to room 4. It would be called back first; the energy of the way driven so far is gone.",
    Action(Confirm(), "Stop it, then room 5", "Y"),
    Action(Cancel(), "Let it go on", "N"),
)

ENDING = GameOverPage(
    "The game is over",
    (
        "No robot can do anything more.",
        "Your score is 120.",
        "7 of 8 rooms were visited; 5 treasures were named right and 1 wrong.",
    ),
    Action(AnotherGame(), "Play again", "A", hint="With treasures hidden anew."),
)

CONSENT = "\n\n".join(
    [
        "Thank you for your interest in this study.",
        "You will command a team of robots that look for treasures in a house. This takes about twenty minutes. "
        "What you do in the game is recorded under a number, not under your name.",
    ]
    + [f"{at}. You may stop at any time and need not say why." for at in range(1, 12)]
)


def states() -> Mapping[str, Screen]:
    """Every state worth a look, by name."""
    usual = playing(considered=5)
    return {
        "connecting": replace(usual, phase=Phase.CONNECTING, waiting_for="The robots are getting ready."),
        "consent": replace(usual, phase=Phase.CONSENT, consent=CONSENT),
        "playing": usual,
        "dialogue": replace(usual, popup=dialogue(), waiting=waiting(2)),
        "naming": replace(usual, popup=naming()),
        "thinking": replace(usual, popup=replace(dialogue(), choices=())),
        "arguing": replace(usual, popup=arguing(), waiting=waiting(1)),
        "questions": replace(usual, popup=questions()),
        "ended": replace(usual, popup=ended(), waiting=waiting(1)),
        "refused-naming": replace(
            usual, popup=replace(treasure(), talk="Robot 1 takes no picture. It said: I would not take a picture, no.")
        ),
        "treasure": replace(usual, popup=treasure(), waiting=waiting(1)),
        "picture": replace(usual, popup=treasure(picture=True, picked="Pink can")),
        "verdict": replace(
            usual, popup=treasure(picture=True, verdict="Right, it is Pink can: 30 points won.", points=30)
        ),
        "wrong": replace(
            usual, popup=treasure(picture=True, verdict="No, it is not Blue bottle: 5 points lost.", points=-5)
        ),
        "question": replace(usual, confirmation=QUESTION),
        "help": replace(usual, help=help_lines(shipped_texts(), 8)),
        "lost": replace(
            usual,
            banner=Banner("The connection to the game is lost for 12 s. It is tried again by itself.", "bad"),
        ),
        "refused": replace(usual, banner=Banner("Robot 1 has not enough energy for room 6.", "note"), typed="1"),
        "commanded": replace(
            usual, cards=(commanded(0, selected=True), commanded(1, state="lost"), commanded(2, asked=True), card(3))
        ),
        "left": replace(usual, cards=(card(0), left(1, selected=True), left(2), card(3))),
        "over": replace(usual, phase=Phase.OVER, ending=ENDING, cards=tuple(card(robot) for robot in range(3))),
        "six": replace(playing(6, 12, 5), waiting=waiting(5)),
    }


@dataclass
class SampleModel:
    """A model that shows a given screen, and keeps the acts done."""

    shown: Screen
    floor_plan: FloorPlan | None = None
    texts: Texts = field(default_factory=shipped_texts)
    followed: int | None = None
    done: list[Act] = field(default_factory=list)

    def screen(self, now: float) -> Screen:
        return self.shown

    def do(self, act: Act, now: float) -> None:
        self.done.append(act)

    def rooms(self, now: float) -> Sequence[RoomMark]:
        outlines = self.floor_plan.rooms if self.floor_plan is not None else ()
        tiles = {tile.room: tile for tile in self.shown.tiles}
        return tuple(
            RoomMark(
                room=room.room,
                name=room.name,
                region=np.array(room.region),
                state=shown.state,
                choosable=shown.choose.enabled,
                considered=shown.considered,
                found=shown.found,
                robot=shown.robot,
            )
            for room in outlines
            if (shown := tiles.get(room.room)) is not None
        )

    def robots(self, now: float) -> Sequence[RobotMark]:
        outlines = self.floor_plan.rooms if self.floor_plan is not None else ()
        marks = []
        for shown in self.shown.cards if outlines else ():
            room = outlines[(shown.robot * 3 + 1) % len(outlines)]
            goal = outlines[(shown.robot * 3 + 4) % len(outlines)]
            pose = Pose2(room.goal[0] + 0.4, room.goal[1] - 0.5, 0.6 * shown.robot)
            path = np.array([[pose.x, pose.y], [pose.x + 2.0, pose.y], [goal.goal[0], goal.goal[1]]])
            trail = np.array([[pose.x - 2.0, pose.y - 0.4], [pose.x - 1.0, pose.y - 0.5], [pose.x, pose.y]])
            marks.append(
                RobotMark(
                    robot=shown.robot,
                    label=str(shown.robot + 1),
                    pose=pose,
                    footprint=np.array(FOOTPRINT),
                    selected=shown.selected,
                    trouble=shown.trouble,
                    trail=trail if shown.progress is not None else np.zeros((0, 2)),
                    path=path if shown.progress is not None else np.zeros((0, 2)),
                )
            )
        return tuple(marks)
