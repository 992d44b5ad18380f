"""Sample states of the participant's window, and a model that shows one of them."""

import base64
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np

from sim.common.geometry import Pose2
from tests.support.project import ROOT
from tests.support.windows.sample_people import people
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from thbridge.files.map_files import read_map
from thbridge.hunt.properties import PropertyDrawing
from thbridge.roles.shared.notices import FloorPlan, RoomOutline
from ui.model.playing.keys import help_lines
from ui.model.playing.screen import (
    Act,
    Action,
    AnswerDialogueAct,
    Banner,
    Cancel,
    ChooseRobot,
    Confirm,
    Confirmation,
    DeclineConsentAct,
    DialoguePopup,
    EndGameAct,
    EnlargePicture,
    FitMap,
    FollowRobot,
    GameOverPage,
    GiveConsentAct,
    HistoryLine,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    Phase,
    PlayAgainAct,
    RequestHandbackAct,
    RequestSuggestionAct,
    RobotCard,
    RoomTile,
    Screen,
    SelectRoomAct,
    ShowHelp,
    ShowNext,
    ShowSettings,
    ShowWaiting,
    StopRobotAct,
    TakePictureAct,
    TakeUpTreasureAct,
    TreasureFact,
    TreasurePopup,
    WaitingItem,
)
from ui.model.shared.scene import RobotMark, RoomMark

FOOTPRINT = ((0.35, 0.0), (0.2, 0.25), (-0.3, 0.25), (-0.3, -0.25), (0.2, -0.25))
NAMES = ("Blue bottle", "Orange bottle", "Pink can", "Yellow can")
ENGLISH = shipped_texts()

_FOUND = {1: ("Orange bottle, +10", "Orange bottle", "+10"), 4: ("something pink", "pink")}
_STATES = ("driving", "rest", "waiting", "lost", "rest", "empty")


def later(texts: Texts) -> Action:
    return Action(ShowNext(), texts.text("popups.later"), "Esc", hint="The treasure waits for you.")


@cache
def floor_plan(name: str = "arena8") -> FloorPlan:
    """Return one of our maps as the message that a participant's program receives."""
    drawn = read_map(ROOT / "maps" / name)
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


def card(
    robot: int, *, selected: bool = False, state: str = "rest", cost: float | None = None, texts: Texts = ENGLISH
) -> RobotCard:
    words = {
        "driving": texts.text("cards.driving", room=4),
        "waiting": texts.text("cards.waiting_for", robot=1),
        "lost": texts.text("cards.lost_driving"),
        "empty": texts.text("cards.blocked"),
        "rest": texts.text("cards.resting"),
    }[state]
    energy = {"lost": 31.5, "empty": 0.0}.get(state, 72.0 - 7 * robot)
    moving = state in ("driving", "waiting", "lost")
    return RobotCard(
        robot=robot,
        name=texts.text("window.robot", robot=robot),
        selected=selected,
        energy=energy,
        energy_at_start=100.0,
        cost=cost,
        affordable=cost is None or cost <= energy,
        place=texts.room(1, "from") if moving else texts.room(3),
        state=words,
        trouble=state in ("lost", "empty"),
        progress={"driving": 0.62, "waiting": 0.3, "lost": 0.45}.get(state),
        waits=2 if robot == 1 else 0,
        select=Action(ChooseRobot(robot), texts.text("window.robot", robot=robot), "", hint="Commands this robot."),
        stop=Action(StopRobotAct(robot), texts.text("cards.stop"), "X" if selected else "", hint="Calls it back.")
        if moving
        else None,
    )


def commanded(
    robot: int, *, selected: bool = False, asked: bool = False, state: str = "driving", texts: Texts = ENGLISH
) -> RobotCard:
    """Return the card of a robot that a ground station commands."""
    key = "B" if selected else ""
    label = texts.text("cards.asked_back" if asked else "cards.ask_back")
    ask = Action(RequestHandbackAct(robot), label, key, not asked, hint="The ground station commands it.")
    shown = card(robot, selected=selected, state=state, texts=texts)
    station = texts.clause("words.numbered_station", number="255")
    return replace(shown, stop=None, commander=station, ask_back=ask)


def left(robot: int, *, selected: bool = False, texts: Texts = ENGLISH) -> RobotCard:
    """Return the card of a robot at a treasure that was left undecided."""
    key = "Ctrl+Z" if selected else ""
    again = Action(TakeUpTreasureAct(robot), texts.text("cards.take_up"), key, hint="You left the treasure in room 3.")
    return replace(card(robot, selected=selected, texts=texts), take_up=again)


def tile(number: int, rooms: int, *, considered: bool = False, texts: Texts = ENGLISH) -> RoomTile:
    state = "visited" if number in (1, 4) else "reserved" if number == 2 else "unvisited"
    key = str(number).zfill(len(str(rooms)))
    can = state == "unvisited" and number != 6
    hint = f"Costs 13; robot 1 then has {59 - number} left." if can else "Robot 1 has not enough energy."
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
        choose=Action(SelectRoomAct(number), f"Room {number}", key, can, hint),
        warning=texts.text("tiles.warn_name") if number == 7 else "",
    )


def playing(robots: int = 3, rooms: int = 8, considered: int | None = None, texts: Texts = ENGLISH) -> Screen:
    """Return the usual state: robots at work, and one room considered."""
    cards = tuple(
        card(
            robot,
            selected=robot == 0,
            state=_STATES[robot % len(_STATES)] if robots > 1 else "rest",
            cost=18.0 if robot == 0 and considered is not None else None,
            texts=texts,
        )
        for robot in range(robots)
    )
    return Screen(
        phase=Phase.PLAYING,
        waiting_for="",
        consent="",
        agree=Action(GiveConsentAct(), texts.text("game.agree"), "A"),
        decline=Action(DeclineConsentAct(), texts.text("game.decline"), "N"),
        banner=None,
        game=1,
        score=120,
        progress=texts.text("game.progress", time="12:05", left=5, count=8),
        cards=cards,
        tiles=tuple(
            tile(number, rooms, considered=number == considered, texts=texts) for number in range(1, rooms + 1)
        ),
        ask_advice=Action(RequestSuggestionAct(), texts.text("tiles.dont_know"), "D", hint="Ask robot 1 where to go."),
        end=Action(EndGameAct(), texts.text("tiles.end"), "E", hint="Robots could still do something."),
        tools=(
            Action(FollowRobot(), texts.text("game.follow"), "F", hint="Keeps robot 1 in the middle of the map."),
            Action(FitMap(), texts.text("game.whole_map"), "A", hint="Show the whole map."),
            Action(ShowSettings(), texts.text("settings.title"), "Ctrl+,", hint="Colors, size of text, sound."),
            Action(ShowHelp(), texts.text("game.help"), "F1", hint="All keys on one sheet."),
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


def dialogue(texts: Texts = ENGLISH) -> DialoguePopup:
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
            Action(AnswerDialogueAct(0), "Continue", "C"),
            Action(AnswerDialogueAct(1), "Stop", "S"),
        ),
        aside=later(texts),
    )


def treasure(
    *,
    picture: bool = False,
    picked: str | None = None,
    verdict: str | None = None,
    points: int | None = None,
    texts: Texts = ENGLISH,
) -> TreasurePopup:
    data = (ROOT / "templates/original-2016/pictures/rsz_t4.jpg").read_bytes() if picture else None
    return TreasurePopup(
        robot=1,
        room=4,
        title=texts.text("popups.found", robot=1, room=4),
        facts=(
            TreasureFact("Colour", "Pink", PropertyDrawing.COLOUR),
            TreasureFact("Footprint", "Square and Small", PropertyDrawing.SHAPE),
        ),
        take_picture=None
        if picture
        else Action(
            TakePictureAct(),
            texts.text("popups.take_picture"),
            "Ctrl+P",
            hint=texts.text("popups.costs", cost=5, energy=72),
        ),
        picture=data,
        names=NAMES,
        picked=picked,
        name_it=Action(
            IdentifyTreasureAct(),
            texts.text("popups.name_it_so", name=picked) if picked else texts.text("popups.name_it"),
            "Enter",
            picked is not None,
            texts.text("popups.naming_costs", cost=5) if picked is not None else "Pick a name first.",
        ),
        leave=Action(LeaveTreasureAct(), texts.text("popups.leave"), "Ctrl+L", hint=texts.text("popups.leave_for_now")),
        verdict=verdict,
        points=points,
        aside=later(texts) if verdict is None else Action(ShowNext(), texts.text("popups.close"), "Esc"),
        enlarge=Action(EnlargePicture(), texts.text("popups.enlarge"), "Ctrl+I") if picture else None,
    )


def arguing(texts: Texts = ENGLISH) -> DialoguePopup:
    """Return a dialogue with a robot that argues, with the greatest number of answers, all of them long."""
    room = "room 6 (North east)"
    return DialoguePopup(
        robot=0,
        title=texts.text("popups.about_room", robot=0, room=6),
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
            Action(
                AnswerDialogueAct(0),
                f"All right: if you go to {room} next, we reach 8 rooms for 124 energy in all.",
                "1",
            ),
            Action(AnswerDialogueAct(1), f"Why go to room 2 (West) first, then to {room}?", "2"),
            Action(AnswerDialogueAct(2), f"Go to {room} all the same.", "3", hint=texts.text("popups.your_decision")),
            Action(AnswerDialogueAct(3), "I have a question.", "4"),
            Action(AnswerDialogueAct(4), "Let us leave it at that.", "5"),
        ),
        aside=later(texts),
        room=6,
        note=texts.text("popups.decision_of_participant", robot=0),
        numbered=True,
    )


def questions(texts: Texts = ENGLISH) -> DialoguePopup:
    """Return the questions that the participant can ask the robot that argues."""
    asked = ("Why room 2 (West)?", "Why not room 6 (North east)?", "What would change your mind?", "Back.")
    keys = ("1", "2", "3", "Esc")
    choices = tuple(
        Action(AnswerDialogueAct(at), text, key) for at, (text, key) in enumerate(zip(asked, keys, strict=True))
    )
    return replace(arguing(texts), choices=choices, aside=replace(later(texts), key="W"))


def ended(texts: Texts = ENGLISH) -> DialoguePopup:
    """Return the end of a dialogue with a robot that argues."""
    talk = arguing(texts)
    close = Action(ShowNext(), texts.text("popups.close"), "Esc")
    outcome = texts.text("popups.agreed_room", robot=0, room=2)
    return replace(talk, sentences=talk.sentences[-2:], choices=(), aside=close, note="", outcome=outcome)


def naming(texts: Texts = ENGLISH) -> DialoguePopup:
    """Return the question of a robot if its find may be identified, with its picture next to the dialogue."""
    find = treasure(picture=True, texts=texts)
    talk = replace(dialogue(texts), robot=find.robot, room=find.room, warning="")
    return replace(talk, facts=find.facts or (), picture=find.picture, enlarge=find.enlarge)


def waiting(number: int, texts: Texts = ENGLISH) -> tuple[WaitingItem, ...]:
    return tuple(
        WaitingItem(
            robot,
            texts.text("game.waits_found", robot=robot, room=robot + 3),
            Action(ShowWaiting(robot), texts.text("game.show"), "W" if robot == 1 else "", hint="Its answer waits."),
        )
        for robot in range(1, number + 1)
    )


def question(texts: Texts) -> Confirmation:
    return Confirmation(
        texts.text("confirmations.reroute", robot=0, room=5),
        texts.text("confirmations.reroute_text", robot=0, place=4, room=5, energy=12.5),
        Action(Confirm(), texts.text("confirmations.reroute_yes", room=5), texts.text("keys.letter_of_yes")),
        Action(Cancel(), texts.text("confirmations.reroute_no"), texts.text("keys.letter_of_no")),
    )


def ending(texts: Texts) -> GameOverPage:
    return GameOverPage(
        texts.text("game_over.title", score=120),
        (
            texts.text("game_over.no_move_left"),
            texts.text("game_over.visited", number=7, count=8),
            texts.text("game_over.named", number=5, count=6),
        ),
        Action(PlayAgainAct(), texts.text("game_over.again"), "A", hint=texts.text("game_over.again_hint")),
    )


CONSENT = "\n\n".join(
    [
        "Thank you for your interest in this study.",
        "You will command a team of robots that look for treasures in a house. This takes about twenty minutes. "
        "What you do in the game is recorded under a number, not under your name.",
    ]
    + [f"{at}. You may stop at any time and need not say why." for at in range(1, 12)]
)


def states(texts: Texts = ENGLISH) -> Mapping[str, Screen]:
    """Return all states that tests look at, by name."""
    usual = playing(considered=5, texts=texts)
    right = texts.text("popups.right", name="Pink can", count=30)
    wrong = texts.text("popups.wrong", name="Blue bottle", count=5)
    lost = f"{texts.text('game.connection_lost_for', count=12)} {texts.text('game.reconnecting')}"
    return {
        "connecting": replace(usual, phase=Phase.CONNECTING, waiting_for=texts.text("game.robots_get_ready")),
        "consent": replace(usual, phase=Phase.CONSENT, consent=CONSENT),
        "playing": usual,
        "dialogue": replace(usual, popup=dialogue(texts), waiting=waiting(2, texts)),
        "naming": replace(usual, popup=naming(texts)),
        "thinking": replace(usual, popup=replace(dialogue(texts), choices=())),
        "arguing": replace(usual, popup=arguing(texts), waiting=waiting(1, texts)),
        "questions": replace(usual, popup=questions(texts)),
        "ended": replace(usual, popup=ended(texts), waiting=waiting(1, texts)),
        "refused-naming": replace(
            usual,
            popup=replace(
                treasure(texts=texts), talk="Robot 1 takes no picture. It said: I would not take a picture, no."
            ),
        ),
        "treasure": replace(usual, popup=treasure(texts=texts), waiting=waiting(1, texts)),
        "picture": replace(usual, popup=treasure(texts=texts, picture=True, picked="Pink can")),
        "verdict": replace(usual, popup=treasure(texts=texts, picture=True, verdict=right, points=30)),
        "wrong": replace(usual, popup=treasure(texts=texts, picture=True, verdict=wrong, points=-5)),
        "question": replace(usual, confirmation=question(texts)),
        "help": replace(usual, help=help_lines(texts, 8)),
        "lost": replace(usual, banner=Banner(lost, "bad")),
        "refused": replace(usual, banner=Banner("Robot 1 has not enough energy for room 6.", "note"), typed="1"),
        "commanded": replace(
            usual,
            cards=(
                commanded(0, selected=True, texts=texts),
                commanded(1, state="lost", texts=texts),
                commanded(2, asked=True, texts=texts),
                card(3, texts=texts),
            ),
        ),
        "left": replace(
            usual,
            cards=(
                card(0, texts=texts),
                left(1, selected=True, texts=texts),
                left(2, texts=texts),
                card(3, texts=texts),
            ),
        ),
        "over": replace(
            usual, phase=Phase.OVER, ending=ending(texts), cards=tuple(card(robot, texts=texts) for robot in range(3))
        ),
        "people": replace(usual, people=people(texts)),
        "six": replace(playing(6, 12, 5, texts), waiting=waiting(5, texts)),
    }


@dataclass
class SampleModel:
    """Model that shows a given screen, and records the acts."""

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
