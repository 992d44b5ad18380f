"""Games played by what the screen offers, against the real keeper, Hider and router."""

from base64 import b64encode
from dataclasses import replace

import pytest

from tests.support.hunts.hunt_without_simulator import RULES
from tests.support.hunts.screen_player import ScreenPlayer, agree, events, go, play
from thbridge.hunt.events import (
    Condition,
    MoveFailed,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureTakenUp,
)
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.shared.notices import PicturePiece, PoseTelemetry
from thbridge.roles.shared.robot_requests import WizardAdvice, WizardMode, WizardMove
from ui.model.playing.participant import Participant
from ui.model.playing.screen import (
    AnswerDialogueAct,
    Cancel,
    ChooseRobot,
    Confirm,
    DialoguePopup,
    EndGameAct,
    EnlargePicture,
    FinishNumber,
    FollowRobot,
    GiveConsentAct,
    IdentifyTreasureAct,
    LeaveTreasureAct,
    NextRobot,
    Phase,
    PickName,
    PlayAgainAct,
    RequestSuggestionAct,
    SelectRoomAct,
    ShowNext,
    ShowWaiting,
    StopRobotAct,
    TakePictureAct,
    TakeUpTreasureAct,
    TreasurePopup,
    TypeDigit,
    TypeLetter,
)

TALKATIVE = "sklar-azhar-2015"


def capital(words):
    return words[:1].upper() + words[1:]


def test_a_whole_hunt_by_what_is_offered():
    seat = ScreenPlayer(robots=2)
    play(seat)
    assert seat.screen.phase is Phase.OVER
    assert events(seat, TreasureIdentified)
    assert events(seat, TreasurePictured)
    assert seat.screen.score == seat.hunt.session.game.score > 0
    assert seat.screen.ending.lines[0] in (
        "Every room has been visited.",
        "No robot has the energy for another move.",
    )
    assert seat.do(PlayAgainAct(), 30).game == 2
    assert seat.screen.phase is Phase.PLAYING
    assert seat.screen.score == 0
    assert [line.text for line in seat.screen.history] == ["Game 2 begins, with 2 robots and 8 rooms."]


@pytest.mark.parametrize("consent", [None, "May we record what you do?"])
def test_a_participant_who_joins_after_a_game_begins_the_next_one_and_sees_nothing_of_the_last(consent):
    seat = ScreenPlayer(Participant(joins_next=True), briefing=Briefing(names=("ball",), consent=consent))
    for game in (1, 2):
        if consent:
            assert seat.screen.phase is Phase.CONSENT
            seat.do(GiveConsentAct())
        assert (seat.screen.phase, seat.screen.game) == (Phase.PLAYING, game)
        seat.do(EndGameAct())
        assert seat.do(Confirm()).phase is Phase.OVER
        assert seat.run(30).phase is Phase.OVER
        seat.model = Participant(joins_next=True)
        seat.model.connected(seat.now)
        seat.tabui.run = f"program {game}"
        seat.tabui.connected()
        phases = set()
        for _ in range(30):
            phases.add(seat.run(1).phase)
        assert Phase.OVER not in phases


def test_what_is_chosen_is_talked_about_at_once_and_then_done_by_itself():
    seat = ScreenPlayer()
    seat.model.do(SelectRoomAct(3), seat.now)
    pop = seat.screen.popup
    assert (pop.title, pop.sentences, pop.choices) == ("Asking robot 1 about room 3 …", (("you", "Go to room 3."),), ())
    assert seat.screen.tiles[2].choose.pending
    assert not seat.screen.tiles[2].choose.enabled
    pop = seat.run().popup
    assert pop.sentences == (("you", "Go to room 3."), ("robot", "It will cost me 17 to go to room 3"))
    assert [(choice.label, choice.key) for choice in pop.choices] == [("Continue", "C"), ("Stop", "S")]
    seat.model.do(AnswerDialogueAct(0), seat.now)
    pop = seat.screen.popup
    assert pop.sentences[-1] == ("you", "Continue")
    assert [choice.enabled for choice in pop.choices] == [False, False]
    assert pop.choices[0].pending
    seat.run()
    agree(seat)
    assert seat.screen.popup is None
    assert seat.view.robots[0].moving_to == 3
    assert seat.screen.cards[0].state == "traveling to room 3"
    sentences = [line.text for line in seat.screen.history if line.speaker != "game"]
    assert sentences == ["Go to room 3.", "It will cost me 17 to go to room 3", "Continue", "Are you sure?", "Continue"]


def test_stop_sends_nobody_and_the_same_can_be_asked_again():
    seat = ScreenPlayer()
    for _ in range(2):
        seat.do(SelectRoomAct(3))
        assert seat.do(AnswerDialogueAct(1)).popup is None
    assert not events(seat, RobotDeparted)
    assert [line.text for line in seat.screen.history if line.speaker == "you"] == ["Go to room 3.", "Stop"] * 2


def test_an_answer_counts_for_what_was_on_the_screen_only():
    seat = ScreenPlayer()
    seat.do(SelectRoomAct(3))
    seat.model.do(AnswerDialogueAct(0), seat.now)
    seat.model.do(AnswerDialogueAct(0), seat.now)
    seat.run()
    assert seat.screen.popup.sentences[-1] == ("robot", "Are you sure?")
    # The robot's next question comes while the finger is on its way down to the button.
    before = seat.screen
    seat.model.do(AnswerDialogueAct(0), seat.now)
    for _ in range(12):
        seat.now += 0.02
        seat.tabui.poll_player()
        seat.hunt.run(1)
    seat.model.do(AnswerDialogueAct(1), seat.now)
    assert before.popup.choices[1].label == "Stop"
    assert seat.view.robots[0].moving_to == 3


def test_naming_needs_a_name_picked_and_is_talked_over_in_the_same_place():
    seat = ScreenPlayer(set_name=TALKATIVE)
    pop = go(seat, 3).popup
    assert isinstance(pop, TreasurePopup)
    assert pop.names == seat.names
    assert pop.picked is None
    assert not pop.name_it.enabled
    assert pop.name_it.hint == "Pick a name first."
    treasure = seat.hunt.session.game.treasures[2]
    assert [fact.value for fact in pop.facts] == [*treasure.properties.values()]
    seat.press(PickName(treasure.name))
    pop = seat.do(IdentifyTreasureAct()).popup
    assert isinstance(pop, DialoguePopup)
    words = name_in_words(treasure.name)
    assert pop.title == f"Robot 1: name it {words}?"
    assert pop.sentences[0] == ("you", f"Name it {words}.")
    assert [fact.value for fact in pop.facts] == [*treasure.properties.values()]
    assert pop.picture is None
    assert pop.title in seat.screen.announcement
    pop = seat.do(AnswerDialogueAct(1)).popup
    assert (pop.picked, pop.verdict, pop.name_it.enabled) == (None, None, False), "a name not confirmed is gone"
    assert not events(seat, TreasureIdentified)
    pop = seat.press(PickName(treasure.name)).popup
    assert pop.name_it.label == f"Name it {words}"
    seat.do(IdentifyTreasureAct())
    pop = seat.do(AnswerDialogueAct(0)).popup
    assert pop.verdict == f"{capital(words)} is right, {treasure.points} points won."
    assert pop.points == seat.screen.score == treasure.points
    assert pop.aside.label == "Close"
    assert seat.do(ShowNext()).popup is None
    assert seat.screen.waiting == ()


def test_a_remark_on_a_find_goes_with_it():
    seat = ScreenPlayer(robots=2)
    go(seat, 3)
    assert seat.press(TypeLetter("%")).banner.text == "No name begins with “%”."
    assert seat.press(ChooseRobot(1)).banner is None


def test_a_picture_is_talked_over_and_taken_once_agreed():
    seat = ScreenPlayer(set_name=TALKATIVE)
    pop = go(seat, 3).popup
    energy = seat.screen.cards[0].energy
    assert pop.take_picture.hint.startswith("Costs 5 of")
    seat.do(TakePictureAct())
    pop = seat.do(AnswerDialogueAct(0)).popup
    assert isinstance(pop, TreasurePopup)
    assert pop.take_picture is None
    assert seat.screen.cards[0].energy == energy - 5
    assert pop.picture_note == "The picture is on its way."
    assert seat.run(300).popup.picture_note == "The picture cannot be shown here."


def test_a_wrong_name_costs_and_is_said_so():
    seat = ScreenPlayer()
    go(seat, 3)
    treasure = seat.hunt.session.game.treasures[2]
    wrong = next(name for name in seat.names if name != treasure.name)
    seat.press(PickName(wrong))
    pop = seat.do(IdentifyTreasureAct()).popup
    assert pop.verdict == f"{capital(name_in_words(wrong))} is wrong, {treasure.points} points lost."
    tile = seat.screen.tiles[2]
    assert (tile.found, *tile.found_shorter) == (f"{wrong}, −{treasure.points}", wrong, f"−{treasure.points}")
    assert seat.screen.tiles[2].state == "lost"


def test_time_and_rooms_left_are_shown():
    seat = ScreenPlayer()
    assert seat.screen.progress == "Time 0:00 · 8 of 8 rooms left"
    go(seat, 3)
    seat.model.receive(PoseTelemetry(tick=50 * 65, poses=()), seat.now)
    assert seat.screen.progress == "Time 1:05 · 7 of 8 rooms left"


def test_a_picture_is_enlarged_until_it_is_pressed_again_or_its_pop_up_goes():
    seat = ScreenPlayer()
    go(seat, 3)
    seat.do(TakePictureAct())
    agree(seat)
    seat.model.receive(PicturePiece(1, 3, 0, 1, b64encode(b"image").decode()), seat.now)
    assert seat.screen.popup.picture == b"image" and seat.screen.enlarged is None
    assert seat.do(EnlargePicture(), 0).enlarged == b"image"
    assert seat.do(EnlargePicture(), 0).enlarged is None
    seat.do(EnlargePicture(), 0)
    assert seat.do(LeaveTreasureAct()).enlarged is None


def test_who_may_be_sent_is_said_where_nothing_waits():
    seat = ScreenPlayer(robots=3)
    assert seat.screen.nothing_waits == "3 robots are ready to be sent"
    seat.do(ChooseRobot(0))
    assert seat.do(SelectRoomAct(1), 3).nothing_waits == "2 robots are ready to be sent"
    agree(seat)
    assert seat.screen.nothing_waits == "2 robots are ready to be sent"


def test_one_robot_is_selected_that_of_the_pop_up():
    seat = ScreenPlayer(robots=3)
    go(seat, 1)
    assert (selected(seat), seat.screen.popup.robot) == (0, 0)
    assert seat.screen.nothing_waits == "2 robots are ready to be sent", "and not that nothing waits"
    screen = seat.do(ChooseRobot(1))
    assert (selected(seat), screen.popup) == (1, None)
    assert [waiting.robot for waiting in screen.waiting] == [0]
    seat.do(SelectRoomAct(2))
    agree(seat)
    assert (selected(seat), seat.screen.popup.room) == (0, 1), "it comes back once the other robot is sent"


def test_no_other_robot_is_selected_by_itself_before_the_selected_one_is_sent():
    seat = ScreenPlayer(robots=2)
    seat.do(SelectRoomAct(1))
    agree(seat)
    seat.do(ChooseRobot(1))
    screen = seat.run(60)
    assert (selected(seat), screen.popup, [waiting.robot for waiting in screen.waiting]) == (1, None, [0])
    seat.do(SelectRoomAct(2))
    agree(seat)
    assert (selected(seat), seat.screen.popup.room) == (0, 1)


def test_a_map_that_follows_a_robot_follows_that_of_the_pop_up():
    seat = ScreenPlayer(robots=2)
    seat.do(SelectRoomAct(1))
    agree(seat)
    seat.do(ChooseRobot(1))
    seat.do(FollowRobot())
    assert seat.model.followed == 1
    seat.do(SelectRoomAct(2))
    agree(seat)
    seat.run(60)
    assert (seat.screen.popup.robot, seat.model.followed) == (0, 0)


def selected(seat):
    (robot,) = (card.robot for card in seat.screen.cards if card.selected)
    return robot


def test_a_robot_for_which_no_room_is_left_is_not_said_to_be_ready():
    seat = ScreenPlayer(robots=2, rules=replace(RULES, energy=1000.0))
    for room in range(1, 9):
        go(seat, room)
        if room < 8:
            seat.do(LeaveTreasureAct())
    assert {card.state for card in seat.screen.cards if card.robot == 1} == {"nothing left to do"}


def test_arrivals_wait_behind_what_is_read_and_never_take_its_place():
    seat = ScreenPlayer(robots=3)
    for robot, room in ((0, 1), (1, 2)):
        seat.do(ChooseRobot(robot))
        seat.do(SelectRoomAct(room))
        agree(seat)
    seat.do(ChooseRobot(2))
    seat.do(SelectRoomAct(5), 3)
    reading = seat.screen.popup
    screen = seat.run(60)
    assert screen.popup.title == reading.title or screen.popup.robot == 2
    assert [waiting.text for waiting in screen.waiting] == [
        "Robot 1 is in room 1 and found something",
        "Robot 2 is in room 2 and found something",
    ]
    assert [card.waits for card in screen.cards] == [1, 1, 0]
    agree(seat)
    assert seat.screen.popup.room == 1
    # Put aside it waits until it is asked for.
    assert seat.do(ShowNext()).popup.room == 2
    screen = seat.do(ShowNext())
    assert screen.popup is None or screen.popup.robot == 2
    seat.do(ShowWaiting(0))
    assert seat.screen.popup.room == 1
    seat.do(LeaveTreasureAct())
    assert [event.room.people for event in events(seat, TreasureLeft)] == [1]


def test_a_robot_under_way_is_called_back_before_it_goes_elsewhere():
    seat = ScreenPlayer()
    seat.hunt.puppets.ticks = 400
    seat.do(SelectRoomAct(3))
    agree(seat)
    screen = seat.do(SelectRoomAct(6))
    assert screen.confirmation.title == "Send robot 1 to room 6 instead?"
    assert "is on its way to room 3" in screen.confirmation.text
    assert screen.tiles[5].choose.hint == "Robot 1 is on its way to room 3 and would be stopped first."
    assert seat.do(Cancel()).confirmation is None
    assert seat.view.robots[0].moving_to == 3
    # A second press of the same key is no answer to a question.
    seat.press(SelectRoomAct(6))
    assert seat.press(SelectRoomAct(6)).confirmation is not None
    screen = seat.do(Confirm())
    assert [event.refund for event in events(seat, MoveFailed)] == [8.5]
    assert isinstance(screen.popup, DialoguePopup)
    assert screen.popup.title == "Robot 1: go to room 6?"
    agree(seat)
    assert seat.view.robots[0].moving_to == 6


def test_a_robot_that_arrives_before_it_is_called_back_is_not_sent_on():
    seat = ScreenPlayer()
    seat.do(SelectRoomAct(3))
    agree(seat)
    seat.press(SelectRoomAct(6), 0)
    screen = seat.run(60)
    assert screen.confirmation is None
    assert screen.banner.text == "Robot 1 is in room 3 now."
    assert not events(seat, MoveFailed)


def test_stop_calls_a_robot_back():
    seat = ScreenPlayer()
    seat.hunt.puppets.ticks = 400
    seat.do(SelectRoomAct(3))
    agree(seat)
    seat.model.do(StopRobotAct(), seat.now)
    card = seat.screen.cards[0]
    assert (card.state, card.stop.pending, card.stop.enabled) == ("stopping", True, False)
    card = seat.run().cards[0]
    assert (card.state, card.stop, card.energy) == ("ready", None, 91.5)


def test_going_on_asks_before_it_leaves_a_treasure_behind():
    seat = ScreenPlayer()
    go(seat, 3)
    screen = seat.do(SelectRoomAct(4))
    assert screen.confirmation.title == "Leave the treasure in room 3?"
    seat.do(Cancel())
    assert not events(seat, TreasureLeft)
    seat.do(SelectRoomAct(4))
    seat.do(Confirm())
    agree(seat)
    assert [event.room.people for event in events(seat, TreasureLeft)] == [3]
    assert seat.screen.popup is None


def test_a_refusal_is_told_and_takes_back_what_was_shown_for_it():
    seat = ScreenPlayer()
    seat.hunt.puppets.stuck = {0}
    seat.do(SelectRoomAct(3))
    agree(seat)
    screen = seat.run(30)
    assert (screen.banner.kind, screen.banner.text) == ("note", "The robot did not reach the room.")
    assert screen.announcement.endswith("The robot did not reach the room.")
    assert screen.tiles[2].choose.enabled
    assert seat.run(400).banner is None


def test_a_room_that_another_robot_asks_about_is_not_offered():
    seat = ScreenPlayer()
    seat.do(SelectRoomAct(3))
    seat.press(NextRobot(1))
    tile = seat.screen.tiles[2]
    assert (tile.choose.enabled, tile.choose.hint) == (False, "Robot 1 is asking you about this room.")
    screen = seat.press(SelectRoomAct(3))
    assert screen.banner.text == "Robot 1 is asking you about this room."


def test_ending_asks_once():
    seat = ScreenPlayer()
    screen = seat.do(EndGameAct())
    assert screen.confirmation.title == "End the game?"
    assert seat.press(EndGameAct()).phase is Phase.PLAYING
    screen = seat.do(Confirm())
    assert screen.phase is Phase.OVER
    assert screen.ending.lines[0] == "You have ended the game."


def test_energy_that_does_not_do_to_name_what_is_there_is_warned_of():
    def tile(energy):
        return ScreenPlayer(rules=replace(RULES, energy=energy)).screen.tiles[2]

    assert tile(17.5).choose.enabled
    assert tile(17.5).warning == "Enough energy to get there, but not to name what is there."
    assert tile(17.5).choose.hint.endswith(tile(17.5).warning)
    assert tile(18.0).warning == "Enough energy to name what is there, but not to take a picture."
    assert tile(23.0).warning == ""
    assert tile(16.0).warning == ""
    assert tile(16.0).choose.hint == "This move costs 17; robot 1 has 16 energy."


def driving_with(energy):
    seat = ScreenPlayer(rules=replace(RULES, energy=energy))
    assert seat.screen.cards[0].warning == ""
    seat.do(SelectRoomAct(3))
    while seat.view.robots[0].moving_to is None:
        seat.press(seat.screen.popup.choices[0].act)
    return seat


@pytest.mark.parametrize(
    ("energy", "warning"),
    [
        (17.0, "no energy for naming"),
        (17.5, "no energy for naming"),
        (18.0, "no energy for a picture"),
        (22.5, "either picture or name"),
        (23.0, ""),
    ],
)
def test_the_card_of_a_robot_that_drives_tells_what_its_energy_will_not_do_for(energy, warning):
    seat = driving_with(energy)
    card = seat.screen.cards[0]
    assert card.warning == warning
    assert card.select.hint == "You command robot 1." + (f" On arrival: {warning}." if warning else "")
    seat.run(200)
    assert seat.view.robots[0].place == 3
    assert seat.screen.cards[0].warning == ""


def test_a_robot_that_stops_is_not_warned_of_where_it_was_going():
    assert driving_with(18.0).press(StopRobotAct(0), 0).cards[0].warning == ""


def test_digits_choose_rooms():
    seat = ScreenPlayer()
    assert seat.press(TypeDigit(3)).popup.title == "Robot 1: go to room 3?"
    screen = seat.press(TypeDigit(9))
    assert screen.banner.text == "There is no room 9. The rooms are 1 to 8."
    assert seat.press(FinishNumber()).popup.title == "Robot 1: go to room 3?"


@pytest.mark.parametrize(
    ("condition", "state"),
    [(Condition.SILENT, "does not answer"), (Condition.LOST, "lost, does not know where it is")],
)
def test_trouble_is_said_in_words(condition, state):
    seat = ScreenPlayer()
    seat.hunt.puppets.conditions[0] = condition
    card = seat.run(60).cards[0]
    assert (card.state, card.trouble) == (state, True)


def test_a_robot_that_somebody_speaks_for_is_thinking_until_they_do():
    seat = ScreenPlayer()
    seat.hunt.session.ask("wizard", WizardMode(0, on=True))
    seat.do(RequestSuggestionAct())
    assert seat.screen.cards[0].state == "is being asked"
    seat.model = Participant()  # a window that was closed and opened again
    seat.model.connected(seat.now)
    seat.tabui.connected()
    assert seat.run().cards[0].state == "is thinking about where to go"
    seat.hunt.session.ask("wizard", WizardAdvice(0, 5))
    assert seat.run().cards[0].state == "is thinking"
    seat.hunt.session.ask("wizard", WizardMove(1, 0, 0, "Room 5?"))
    assert seat.run().cards[0].state == "asks you something"


def test_what_was_asked_and_lost_on_its_way_is_asked_again(monkeypatch):
    seat = ScreenPlayer()
    step = seat.tabui.step
    monkeypatch.setattr(seat.tabui, "step", lambda tick, messages: [step(tick, messages), []][1])
    seat.do(SelectRoomAct(3))
    monkeypatch.undo()
    assert seat.screen.popup.title == "Asking robot 1 about room 3 …"
    assert seat.run(160).popup.title == "Robot 1: go to room 3?"


def test_a_server_that_comes_back_goes_on_where_it_was():
    seat = ScreenPlayer()
    go(seat, 3)
    seat.press(PickName(seat.names[0]))
    seat.do(ShowNext())
    seat.model.lost("The server has gone.", seat.now)
    screen = seat.screen
    assert screen.banner.kind == "bad"
    assert screen.banner.text.startswith("The connection to the game is lost. The server has gone.")
    seat.now += 5.0
    assert "lost for 5 seconds." in seat.screen.banner.text
    seat.model.do(ShowWaiting(0), seat.now)
    assert seat.screen.popup.picked is None
    seat.model.do(LeaveTreasureAct(), seat.now)
    assert seat.screen.popup.leave.pending
    seat.model.connected(seat.now)
    seat.tabui.connected()
    screen = seat.run()
    assert screen.banner.kind == "note"
    assert events(seat, TreasureLeft)


def test_what_was_left_is_taken_up_again_until_the_robot_sets_out():
    seat = ScreenPlayer()
    assert go(seat, 3).popup.leave.hint == "Free; can be undone."
    assert seat.screen.cards[0].take_up is None
    screen = seat.do(LeaveTreasureAct())
    assert screen.popup is None and screen.waiting == ()
    assert screen.banner.text == (
        "The treasure in room 3 is left there. Until robot 1 sets out, you can take it up again."
    )
    assert (screen.cards[0].take_up.key, screen.cards[1].take_up) == ("Ctrl+Z", None)
    seat.model.do(TakeUpTreasureAct(), seat.now)
    assert seat.screen.cards[0].take_up.pending
    screen = seat.run()
    assert (screen.popup.room, screen.popup.picked, screen.cards[0].take_up) == (3, None, None)
    assert screen.banner is None
    assert [line.text for line in screen.history][-2:] == [
        "The treasure in room 3 is left there.",
        "The treasure in room 3 is taken up again.",
    ]
    seat.do(LeaveTreasureAct())
    assert go(seat, 5).cards[0].take_up is None
    assert (
        seat.press(TakeUpTreasureAct()).banner.text
        == "There is nothing to undo: robot 1 is not at a treasure that you left."
    )
    assert [type(event) for event in events(seat, TreasureLeft | TreasureTakenUp)] == [
        TreasureLeft,
        TreasureTakenUp,
        TreasureLeft,
    ]


def test_what_is_taken_up_again_comes_before_what_is_shown():
    seat = ScreenPlayer(robots=2)
    for robot, room in ((0, 3), (1, 4)):
        seat.do(ChooseRobot(robot))
        go(seat, room)
    assert seat.screen.popup.room == 3
    seat.do(LeaveTreasureAct())
    assert seat.screen.popup.room == 4
    screen = seat.do(TakeUpTreasureAct(0))
    assert screen.popup.room == 3
    assert [waiting.robot for waiting in screen.waiting] == [1]


def test_leaving_the_last_find_says_that_it_ends_the_game():
    seat = ScreenPlayer(robots=1, rules=replace(RULES, energy=20.0))
    pop = go(seat, 3).popup
    assert pop.leave.hint == "Ends the game."
    assert seat.press(PickName(seat.names[0])).popup.name_it.hint.endswith("Then the game ends.")
    screen = seat.do(LeaveTreasureAct())
    assert screen.confirmation.title == "Leave it, and end the game?"
    assert not events(seat, TreasureLeft)
    screen = seat.do(Cancel())
    assert screen.phase is Phase.PLAYING and screen.popup.room == 3
    seat.do(LeaveTreasureAct())
    assert seat.do(Confirm()).phase is Phase.OVER
    assert events(seat, TreasureLeft)


def test_the_picture_stays_in_sight_while_a_name_is_talked_over():
    names = tuple(sorted({kind.name for kind in ScreenPlayer(set_name=TALKATIVE).hunt.templates.kinds}))
    pictures = {kind.image: b"image" for kind in ScreenPlayer(set_name=TALKATIVE).hunt.templates.kinds}
    seat = ScreenPlayer(set_name=TALKATIVE, briefing=Briefing(names=names, pictures=pictures))
    go(seat, 3)
    seat.do(TakePictureAct())
    agree(seat)
    assert seat.run(60).popup.picture == b"image"
    seat.press(PickName(names[0]))
    pop = seat.do(IdentifyTreasureAct()).popup
    assert isinstance(pop, DialoguePopup)
    assert pop.picture == b"image"


def test_the_picture_comes_from_the_keeper_in_pieces():
    image = bytes(range(256)) * 300
    seat = ScreenPlayer(
        briefing=Briefing(names=("ball",), pictures={f"rsz_t{number}.jpg": image for number in range(1, 5)})
    )
    assert go(seat, 3).popup.picture is None
    assert seat.do(TakePictureAct(), 60).popup.picture == image
    seat.model = Participant()
    seat.model.connected(seat.now)
    seat.tabui.connected()
    assert seat.run(60).popup.picture == image


def test_nothing_is_played_before_the_participant_agrees():
    seat = ScreenPlayer(briefing=Briefing(names=("ball",), consent="May we record what you do?"))
    screen = seat.screen
    assert (screen.phase, screen.consent, screen.popup) == (Phase.CONSENT, "May we record what you do?", None)
    seat.press(SelectRoomAct(3))
    assert seat.do(GiveConsentAct()).phase is Phase.PLAYING
    assert seat.do(SelectRoomAct(3)).popup.title == "Robot 1: go to room 3?"


def test_a_server_that_is_killed_in_the_middle_goes_on_by_its_journal():
    seat = ScreenPlayer(robots=2)
    go(seat, 3)
    name = seat.names[0]
    seat.press(PickName(name))
    seat.do(ShowNext())
    seat.press(NextRobot(1))
    seat.hunt.puppets.ticks = 500
    seat.do(SelectRoomAct(4))
    agree(seat)
    lines = len(seat.screen.history)
    # Asked while nobody is there to receive it.
    seat.model.lost("The server has gone.", seat.now)
    seat.model.do(StopRobotAct(), seat.now)
    assert seat.screen.cards[1].state == "stopping"
    seat.restart_server()
    screen = seat.run(40)
    assert screen.banner.text == "Robot 2 has stopped before room 4. It gets 6.5 energy back."
    assert screen.cards[1].state == "ready"
    assert [event.at.people for event in events(seat, MoveFailed)] == [0]
    assert len(screen.history) > lines
    assert [waiting.text for waiting in screen.waiting] == ["Robot 1 is in room 3 and found something"]
    assert seat.do(ShowWaiting(0)).popup.picked is None
    seat.press(PickName(name))
    assert seat.do(IdentifyTreasureAct()).popup.verdict is not None


def test_another_window_comes_into_the_middle_of_a_game():
    seat = ScreenPlayer()
    go(seat, 3)
    seat.do(ChooseRobot(1))
    seat.do(SelectRoomAct(4))
    seat.model = Participant()
    seat.model.connected(seat.now)
    seat.tabui.connected()
    screen = seat.run()
    assert screen.history[0].text == "Game 1 is under way, with 2 robots and 8 rooms; the score is 0."
    assert len(screen.waiting) == 1
    treasure = seat.hunt.session.game.treasures[2]
    if not isinstance(screen.popup, TreasurePopup):
        seat.do(ShowNext())
    seat.press(PickName(treasure.name))
    assert seat.do(IdentifyTreasureAct()).score == treasure.points
