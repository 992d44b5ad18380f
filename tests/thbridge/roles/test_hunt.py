"""Whole hunts on the real router, with every role ours but the robots' bodies."""

from dataclasses import replace

import pytest

from tests.support.hunts.game_states import fold
from tests.support.hunts.hunt_without_simulator import RULES, HuntWithoutSimulator, scripted_engine
from tests.support.hunts.scripted_hunt import ScriptedPlayer, go
from thbridge.dialogue.moves import Continue, Speaker
from thbridge.hunt import rules
from thbridge.hunt.events import (
    Condition,
    ConditionChanged,
    EndReason,
    GameEnded,
    GameStarted,
    MoveFailed,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasuresHidden,
    TreasureTakenUp,
)
from thbridge.roles.keeper.keeper import Keeper
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.view import (
    AnswerDialogue,
    EndGame,
    IdentifyTreasure,
    LeaveTreasure,
    OpenDialogue,
    ParticipantRequest,
    PlayAgain,
    RequestSuggestion,
    SelectRoom,
    SendRobot,
    SenseTreasure,
    StopRobot,
    TakePicture,
    TakeUpTreasure,
    View,
)
from thbridge.text_protocol.wire import legacy


@pytest.fixture
def scripted():
    player = ScriptedPlayer()
    played = HuntWithoutSimulator(participant=TabUI(player))

    def say(*wishes: ParticipantRequest, ticks: int = 8) -> View:
        player.wish = wishes
        played.tabui.poll_player()
        played.run(ticks)
        return played.view()

    played.run(5)
    played.say = say
    return played


@pytest.mark.parametrize("strategy", BotStrategy)
@pytest.mark.parametrize("robots", [1, 2, 3, 6])
def test_a_hunt_goes_on_until_energy_or_rooms_run_out(strategy, robots):
    played = HuntWithoutSimulator(robots=robots, strategy=strategy)
    played.finish()
    game = played.session.game
    ended = game.ended
    if ended.reason is EndReason.ALL_VISITED:
        assert all(room.visited for room in game.rooms)
    else:
        assert not any(rules.affordable(game, robot) for robot in range(robots))
    assert ended.score == game.score == sum(e.points for e in played.log.events if isinstance(e, TreasureIdentified))
    assert all(robot.energy >= 0 for robot in game.robots)


def test_two_robots_visit_all_eight_rooms_on_the_robots_advice():
    played = HuntWithoutSimulator(robots=2)
    played.finish()
    assert sum(room.visited for room in played.session.game.rooms) == 8
    # Every color of the original set is unique, so a participant who knows the list is never wrong.
    assert played.session.game.score == sum(kind.points for kind in played.session.game.treasures)


def test_the_same_seed_gives_the_same_lines():
    first, second, other = HuntWithoutSimulator(seed=3), HuntWithoutSimulator(seed=3), HuntWithoutSimulator(seed=4)
    for played in (first, second, other):
        played.finish()
    assert first.lines == second.lines
    assert first.lines != other.lines


def test_a_random_participant_sometimes_stops_a_dialogue_and_no_robot_moves_on_it():
    stops = 0
    for seed in range(6):
        played = HuntWithoutSimulator(strategy=BotStrategy.RANDOM, seed=seed)
        played.finish()
        said = [utterance for tick_record in played.tick_records for utterance in tick_record.utterances]
        stopped = {u.dialogue for u in said if u.speaker is Speaker.PERSON and not isinstance(u.move, Continue)}
        stops += len(stopped)
        agreed = {u.dialogue for u in said if u.topic.scenario.value in ("specific-room", "dont-know")} - stopped
        assert sum(isinstance(event, RobotDeparted) for event in played.log.events) == len(agreed)
    assert stops > 0


def test_the_journal_alone_gives_the_state_back():
    played = HuntWithoutSimulator(strategy=BotStrategy.NEAREST)
    played.finish()
    started, *rest = played.log.events
    assert isinstance(started, GameStarted)
    assert fold(started, rest) == played.session.game


def test_nothing_moves_before_consensus(scripted):
    view = scripted.say(SendRobot(0, 3))
    assert view.refusal.reason == "no-consensus"
    assert not any(isinstance(event, RobotDeparted) for event in scripted.log.events)
    view = scripted.say(SelectRoom(0, 3))
    dialogue = view.dialogues[0]
    assert dialogue.said[-1] == "It will cost me 17 to go to room 3"
    view = scripted.say(SendRobot(0, 3))
    assert view.refusal.number == 2
    view = scripted.say(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
    dialogue = view.dialogues[0]
    assert dialogue.said[-1] == "Are you sure?"
    view = scripted.say(AnswerDialogue(dialogue.dialogue, dialogue.turn, 0))
    assert view.dialogues == ()
    assert [(consent.robot, consent.room) for consent in view.consents] == [(0, 3)]
    view = scripted.say(SendRobot(0, 3))
    assert view.robots[0].moving_to == 3
    assert view.robots[0].energy == 83.0
    assert view.consents == ()


def test_a_stop_ends_the_dialogue_without_consent(scripted):
    dialogue = scripted.say(RequestSuggestion(0)).dialogues[0]
    assert dialogue.said == ("Do you want me to go to room 2",)
    view = scripted.say(AnswerDialogue(dialogue.dialogue, dialogue.turn, 1))
    assert view.dialogues == ()
    assert view.consents == ()


def test_an_answer_to_a_turn_that_is_past_counts_once(scripted):
    dialogue = scripted.say(RequestSuggestion(0)).dialogues[0]
    answer = AnswerDialogue(dialogue.dialogue, dialogue.turn, 0)
    view = scripted.say(answer, ticks=1)
    scripted.tabui.connected()
    view = scripted.say(answer)
    assert len(view.dialogues[0].said) == 3


def test_a_room_is_visited_once_and_spoken_of_with_one_robot(scripted):
    scripted.say(SelectRoom(0, 3))
    view = scripted.say(SelectRoom(1, 3))
    assert view.refusal.reason == "under-discussion"
    view = go(scripted, 0, 5)
    assert view.room(5).state == "visited"
    view = scripted.say(SelectRoom(1, 5))
    assert view.refusal.reason == "already-visited"


def test_a_robot_without_the_energy_is_refused_before_it_moves():
    player = ScriptedPlayer()
    played = HuntWithoutSimulator(participant=TabUI(player), rules=replace(RULES, energy=15.0))
    played.run(5)
    player.wish = (SelectRoom(0, 3),)
    played.tabui.poll_player()
    played.run(8)
    view = played.view()
    assert view.refusal.reason == "not-enough-energy"
    assert "15" in view.refusal.sentence
    assert "17" in view.refusal.sentence
    assert view.robots[0].place == 0


def test_what_is_hidden_is_not_in_the_view_before_it_is_found(scripted):
    treasures = next(event.treasures for event in scripted.log.events if isinstance(event, TreasuresHidden))
    view = go(scripted, 0, 3)
    text = repr(view)
    assert not any(
        kind.name in text or kind.image in text or kind.properties["footprint"] in text for kind in treasures
    )
    view = scripted.say(SenseTreasure(3))
    assert view.room(3).sensed == treasures[2].properties
    assert treasures[2].image not in repr(view)


def test_the_treasures_three_scenarios(scripted):
    treasures = next(event.treasures for event in scripted.log.events if isinstance(event, TreasuresHidden))
    go(scripted, 0, 3)
    scripted.say(SenseTreasure(3))
    view = scripted.say(TakePicture(3))
    assert view.refusal.reason == "no-consensus"
    # The template of 2016 has no questions about pictures, so talking about one is agreeing on it.
    view = scripted.say(OpenDialogue(0, "take-picture", 3))
    assert view.consents[0].matter == "take-picture"
    view = scripted.say(TakePicture(3))
    assert view.room(3).picture == treasures[2].image
    assert view.robots[0].energy == 100 - 17 - 5
    scripted.say(OpenDialogue(0, "take-treasure", 3))
    view = scripted.say(IdentifyTreasure(3, treasures[2].name))
    assert view.room(3).verdict.points == treasures[2].points == view.score
    assert view.robots[0].energy == 100 - 17 - 5 - 1
    score = f"%%score Hider TabUI ,{treasures[2].points} "
    assert score in scripted.lines


def test_a_treasure_can_be_left(scripted):
    go(scripted, 0, 3)
    view = scripted.say(LeaveTreasure(3))
    assert view.room(3).left
    assert any(isinstance(event, TreasureLeft) for event in scripted.log.events)


def test_a_treasure_that_was_left_can_be_taken_up_again_and_named(scripted):
    go(scripted, 0, 3)
    scripted.say(LeaveTreasure(3))
    view = scripted.say(TakeUpTreasure(3))
    assert view.room(3).undecided and not view.room(3).left
    told = [event for event in scripted.log.events if isinstance(event, TreasureLeft | TreasureTakenUp)]
    assert [type(event) for event in told] == [TreasureLeft, TreasureTakenUp], "the record tells both"
    scripted.say(OpenDialogue(0, "take-treasure", 3))
    assert scripted.say(IdentifyTreasure(3, "can")).room(3).verdict is not None
    scripted.say(SelectRoom(0, 5))
    assert scripted.say(TakeUpTreasure(3)).refusal.reason == "already-decided"


def test_a_robot_called_back_gives_back_the_energy_of_the_way_not_driven(scripted):
    scripted.puppets.ticks = 1000
    go(scripted, 0, 3)
    view = scripted.say(StopRobot(0), ticks=10)
    assert view.robots[0].moving_to is None
    assert view.robots[0].energy == 100 - 17 / 2
    assert view.room(3).state == "unvisited"


def test_a_robot_under_way_is_called_back_and_sent_elsewhere(scripted):
    scripted.puppets.ticks = 1000
    assert go(scripted, 0, 3).robots[0].moving_to == 3
    view = scripted.say(SelectRoom(0, 5))
    assert (view.refusal.reason, view.dialogues) == ("under-way", ())
    refusals = view.refusal.number
    view = scripted.say(StopRobot(0))
    assert (view.robots[0].moving_to, view.robots[0].place, view.robots[0].energy) == (None, 0, 100 - 17 / 2)
    scripted.puppets.ticks = 10
    view = go(scripted, 0, 5)
    assert (view.room(3).state, view.room(5).state, view.robots[0].place) == ("unvisited", "visited", 5)
    assert view.robots[0].energy == 100 - 17 / 2 - view.costs[0][5]
    # That a robot stops that was told to is nothing to complain about.
    assert view.refusal.number == refusals
    # The room is free again, for any robot.
    assert go(scripted, 1, 3).room(3).state == "visited"


def test_a_robot_called_back_as_it_arrives_is_there(scripted):
    scripted.puppets.ticks = 30
    go(scripted, 0, 3)
    view = scripted.say(StopRobot(0), ticks=40)
    assert view.room(3).state == "visited" or view.robots[0].place == 0
    assert view.robots[0].moving_to is None
    assert scripted.say(SelectRoom(0, 5)).dialogues[0].room == 5


def test_a_robot_that_finds_no_way_says_so(scripted):
    scripted.puppets.stuck = {0}
    view = go(scripted, 0, 3)
    assert view.refusal.sentence == "There is no way."
    assert view.room(3).state == "unvisited"
    assert any(isinstance(event, MoveFailed) for event in scripted.log.events)


def report(scripted, robot: int, condition: Condition) -> View:
    scripted.puppets.conditions[robot] = condition
    scripted.run(60)
    return scripted.view()


def test_nobody_talks_in_the_name_of_a_robot_that_does_not_answer_until_it_does(scripted):
    scripted.say(SelectRoom(0, 3))
    view = report(scripted, 0, Condition.SILENT)
    assert view.robots[0].condition is Condition.SILENT
    assert view.dialogues == ()
    for wish in (SelectRoom(0, 5), RequestSuggestion(0)):
        view = scripted.say(wish)
        assert (view.refusal.reason, view.dialogues) == ("silent", ())
    assert scripted.say(SelectRoom(1, 3)).dialogues[0].robot == 1
    report(scripted, 0, Condition.WELL)
    assert scripted.say(RequestSuggestion(0)).dialogues[-1].robot == 0
    told = [event for event in scripted.log.events if isinstance(event, ConditionChanged)]
    assert told == [ConditionChanged(0, Condition.SILENT), ConditionChanged(0, Condition.WELL)]


def test_a_line_of_2016_moves_no_robot_that_does_not_answer(scripted):
    report(scripted, 0, Condition.SILENT)
    scripted.keeper._seats[""].participants._members.clear()
    scripted.run(1)
    before = len(scripted.lines)
    scripted.say(SendRobot(0, 3), ticks=20)
    assert scripted.session.game.robots[0].bound_for is None
    assert scripted.lines[before] == "%%goto TabUI SimR 0 2 2 45 "
    assert not any(line.startswith("%%error SimR TabUI") for line in scripted.lines[before:])


def test_how_robots_are_outlives_every_program(scripted):
    report(scripted, 0, Condition.SILENT)
    keeper = Keeper(
        RULES,
        lambda game: scripted_engine(scripted.templates),
        tuple(scripted.log.events),
    )
    assert [robot.condition for robot in keeper.state.robots] == [Condition.SILENT, Condition.WELL]
    # A SimR that comes back has robots that answer.
    scripted.puppets.connected()
    assert report(scripted, 0, Condition.WELL).robots[0].condition is Condition.WELL


def test_a_hunt_whose_last_robot_falls_silent_is_over():
    played = HuntWithoutSimulator(robots=2)
    played.run(200)
    played.puppets.conditions = [Condition.SILENT] * 2
    played.finish(1000)
    assert played.session.game.ended.reason is EndReason.NO_MOVE_LEFT


def test_a_hunt_with_a_room_that_nobody_reaches_is_given_up_after_all_others():
    played = HuntWithoutSimulator(robots=2, strategy=BotStrategy.NEAREST, rules=replace(RULES, energy=1000.0))
    played.puppets.stuck = {0, 1}
    played.finish()
    assert played.session.game.ended.reason is EndReason.GIVEN_UP
    assert sum(isinstance(event, MoveFailed) for event in played.log.events) == 2 * 3 * 8


def test_a_participant_may_end_the_game(scripted):
    assert scripted.say(EndGame(2)).over is None, "that is another game"
    assert scripted.say(EndGame(1)).over == "given-up"


def test_an_arrival_that_nobody_heard_is_learnt_from_the_status(scripted):
    scripted.puppets.mute = True
    view = go(scripted, 0, 3)
    assert view.room(3).state == "visited"
    assert sum(isinstance(event, RobotArrived) for event in scripted.log.events) == 1


def test_playing_again_hides_anew_and_counts_on():
    played = HuntWithoutSimulator(robots=2)
    played.finish()
    first = played.session.game
    player = ScriptedPlayer()
    player.wish = (PlayAgain(1),)
    played.tabui._player = player
    played.tabui.poll_player()
    played.run(12)
    again = played.session.game
    assert again.started.game == 2
    assert again.score == 0
    assert again.treasures is not None
    assert again.treasures != first.treasures
    assert played.puppets.orders[-1].game == 2


def test_robots_that_do_not_fit_the_game_are_turned_away():
    played = HuntWithoutSimulator(robots=2)
    played.run(10)
    played.puppets.robots = 3
    played.puppets.connected()
    played.run(3)
    assert "2 robots" in played.puppets.unfit
    assert "--new-game" in played.puppets.unfit


def test_programs_of_2016_need_no_consensus_and_never_say_that_they_give_up():
    """A TabUI of 2016 holds its dialogues itself: only its lines are seen."""
    player = ScriptedPlayer()
    played = HuntWithoutSimulator(participant=TabUI(player))
    played.run(5)
    # From here on an outside program speaks, on a connection that is not extended.
    played.router.local.detach(legacy.TABUI)
    played.keeper._seats[""].participants._members.clear()
    played.session._roles = tuple(role for role in played.session._roles if role is not played.tabui)
    connection = played.session.router.connect(0.0)

    def line(text: str) -> None:
        played.session.perform(played.session.router.receive_data(connection, text.encode(), 0.0))

    line("%%setid TabUI\n%%goto TabUI SimR 0 2 2 45\n")
    played.run(20)
    assert played.session.game.room(rules.Room(3)).visited
    line('%%error TabUI Hider  "2"\n')
    played.run(4)
    treasure = played.session.game.treasure(rules.Room(3))
    colour, footprint = treasure.properties.values()
    found = f'%%found Hider TabUI 2 2 "(Colour: {colour}) (Footprint: {footprint})" '
    assert found in played.lines
    line("%%snap TabUI Hider 2\n")
    played.run(4)
    assert f"%%image Hider TabUI 2 {treasure.image} " in played.lines
    line(f'%%found TabUI Hider "2,{treasure.name}\n')
    played.run(4)
    assert f"%%score Hider TabUI ,{treasure.points} " in played.lines
    assert played.session.game.score == treasure.points


def test_a_hider_of_2016_is_believed():
    """Its treasures are its own secret; the game learns from what it says."""
    played = HuntWithoutSimulator(outside={"Hider"})
    connection = played.session.router.connect(0.0)
    played.session.perform(played.session.router.receive_data(connection, b"%%setid Hider\n", 0.0))
    answered = 0

    def answer() -> None:
        nonlocal answered
        for text in played.lines[answered:]:
            parts = text.split()
            if parts[:3] == ["%%error", "TabUI", "Hider"] and parts[3] != "thbridge":
                room = parts[3].strip('"')
                reply = f'%%found Hider TabUI {room} {room} "(Colour: Orange) (Footprint: Round and Large)"\n'
            elif parts[:3] == ["%%found", "TabUI", "Hider"]:
                reply = "%%score Hider TabUI ,10\n"
            else:
                continue
            played.session.perform(played.session.router.receive_data(connection, reply.encode(), 0.0))
        answered = len(played.lines)

    for _ in range(6000):
        played.run(1)
        answer()
        if played.session.game is not None and played.session.game.ended is not None:
            break
    ended = played.session.game.ended
    assert isinstance(ended, GameEnded)
    assert ended.score == 80
    assert all(room.visited for room in played.session.game.rooms)
