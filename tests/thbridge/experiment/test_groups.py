"""Games of several people: groups in the log, their places, and what follows if people are missing."""

import itertools
import random
from collections.abc import Iterator
from contextlib import ExitStack
from datetime import datetime
from pathlib import Path

import pytest

from tests.support.studies.experiment_files import write_experiment
from tests.support.studies.group_studies import PAIRS, group_study, rehearsed
from tests.support.studies.rehearsed_studies import clocks
from thbridge.experiment.allocation.places import Allocation, NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.recruiting import Ending
from thbridge.experiment.design.soundness import faults_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.lobby import SeatHolder
from thbridge.experiment.progress import Progress
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState
from thbridge.experiment.waiting_room import WaitingRoom
from thbridge.experiment.withdrawal import plan_withdrawal, withdraw
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.yaml.load import load


class Study:
    """A study whose conductor can be restarted."""

    def __init__(self, root: Path, text: str, opened: ExitStack) -> None:
        write_experiment(root, text)
        self.folder = ExperimentFolder(root)
        self.design = self.folder.read()
        self.folder.log.parent.mkdir()
        self._opened = opened
        self._ticks, self._draw = itertools.count(), random.Random(1).randrange
        self.start()

    def start(self) -> None:
        self._opened.close()
        log = self._opened.enter_context(ExperimentLog(self.folder.log))
        self.conductor = Conductor(self.design, log, lambda: clocks(next(self._ticks)), self._draw)
        self.room = WaitingRoom(self.design, self.conductor)

    def arrive(self, now: float) -> str:
        """Let a person come and wait for a game; return their id."""
        person = self.conductor.admit().participant
        self.wait(person, now)
        return person

    def wait(self, person: str, now: float) -> None:
        step = self.conductor.begin(person)
        assert step is not None
        self.room.enter(person, step, now)

    def run(self, person: str):
        return self.conductor.progress.runs[person]


@pytest.fixture
def opened() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


TWO_TRIALS = "[{step: trial, name: first}, {step: trial, name: second}]"


def test_a_restarted_program_finds_groups_seats_and_the_present_game_in_the_log(
    tmp_path: Path, opened: ExitStack
) -> None:
    study = Study(tmp_path, group_study("{leaving: program}"), opened)
    people = [study.arrive(0.0), study.arrive(4.0)]
    (game,) = study.room.update(5.0).games
    game = study.conductor.change_seat(EventKind.SEAT_LEFT, game, "namer", 7.5)
    before = study.conductor.change_seat(EventKind.SEAT_FILLED, game, "namer", 7.5)
    study.start()
    (after,) = study.conductor.progress.groups.values()
    assert after == before
    assert after.people == dict(zip(("driver", "namer"), people, strict=True))
    assert after.seats == {"driver": SeatHolder.PERSON, "namer": SeatHolder.PROGRAM}
    assert study.conductor.change_seat(EventKind.SEAT_RESUMED, after, "namer").present == tuple(people)


def test_a_game_ends_for_each_person_who_holds_a_seat(tmp_path: Path, opened: ExitStack) -> None:
    study = Study(tmp_path, group_study(), opened)
    one, two = study.arrive(0.0), study.arrive(0.0)
    (game,) = study.room.update(0.0).games
    study.conductor.end_group_game(game, {"bag": "recordings/G-1/step-1.bag", "score": 7})
    assert [study.run(person).game["seat"] for person in (one, two)] == ["driver", "namer"]
    assert study.run(one).game["bag"] == study.run(two).game["bag"]


def test_a_wait_in_vain_ends_with_a_code_and_frees_the_place(tmp_path: Path, opened: ExitStack) -> None:
    study = Study(tmp_path, group_study("{wait: 60}"), opened)
    person = study.arrive(10.0)
    assert study.room.update(69.0).ended == ()
    assert study.room.update(70.0).ended == (person,)
    run = study.run(person)
    assert (run.state, run.ending, len(run.code)) == (RunState.EXCLUDED, Ending.NO_GROUP, 8)
    assert study.conductor.begin(person) is None
    assert study.conductor.progress.next_place() == run.place


def test_people_whose_group_lost_a_person_skip_its_further_games_and_are_paid(
    tmp_path: Path, opened: ExitStack
) -> None:
    study = Study(tmp_path, group_study(steps=TWO_TRIALS), opened)
    one, two = study.arrive(0.0), study.arrive(0.0)
    (game,) = study.room.update(0.0).games
    study.conductor.end_group_game(game, {"bag": "recordings/G-1/step-1.bag"})
    study.conductor.end(one, study.run(one).plan[0])
    study.wait(one, 1.0)
    study.conductor.leave(two, "went home")
    assert study.room.update(2.0).ended == (one,)
    assert study.conductor.begin(one) is None
    run = study.run(one)
    assert run.state is RunState.EXCLUDED and run.code
    assert run.reason == "second could not be played, because a person of the group had left"


@pytest.mark.parametrize("counts", [False, True])
def test_a_run_with_an_incomplete_game_counts_only_if_the_study_says_so(
    tmp_path: Path, opened: ExitStack, counts: bool
) -> None:
    study = Study(
        tmp_path, group_study(f"{{then: program, wait: 5, incomplete_counts: {str(counts).lower()}}}"), opened
    )
    person = study.arrive(0.0)
    (game,) = study.room.update(5.0).games
    assert game.seats == {"driver": SeatHolder.PERSON, "namer": SeatHolder.PROGRAM}
    study.conductor.end_group_game(game, {"bag": "recordings/G-1/step-1.bag"})
    study.conductor.end(person, study.run(person).plan[0])
    study.conductor.begin(person)
    assert study.run(person).code
    assert study.run(person).state is (RunState.COMPLETE if counts else RunState.EXCLUDED)


def test_a_person_whose_page_is_gone_does_not_get_a_seat(tmp_path: Path, opened: ExitStack) -> None:
    study = Study(tmp_path, group_study(quota=4), opened)
    gone = study.arrive(0.0)
    study.room.leave(gone)
    others = [study.arrive(1.0), study.arrive(2.0)]
    (game,) = study.room.update(3.0).games
    assert [*game.people.values()] == others or gone not in game.people.values()


def test_answers_pair_people(tmp_path: Path, opened: ExitStack) -> None:
    form = "{step: form, form: understood.yaml, name: before}"
    lobby = "{by: before.played, seat_of: {driver: 'yes', namer: 'no'}}"
    study = Study(tmp_path, group_study(lobby, f"[{form}, {{step: trial}}]", quota=6), opened)

    def arrive(answer: str, now: float) -> str:
        person = study.conductor.admit().participant
        step = study.conductor.begin(person)
        study.conductor.tell(EventKind.ITEM_GIVEN, person, step, {"item": "played", "answer": answer}, "participant")
        study.conductor.end(person, step)
        study.wait(person, now)
        return person

    first, second, third = arrive("no", 0.0), arrive("no", 1.0), arrive("yes", 2.0)
    (game,) = study.room.update(2.0).games
    assert game.people == {"driver": third, "namer": first}
    assert second in {each.participant for each in study.room._lobby.waiting}


def test_people_of_a_group_get_successive_places_with_the_same_order() -> None:
    allocation = Allocation(4, 2, 6, 5, groups=((0, 1), (2, 2, 3)))
    places = [allocation.place(number) for number in range(allocation.size)]
    assert [place.number for place in places] == [*range(allocation.size)]
    counts = [[place.cell for place in places].count(cell) for cell in range(4)]
    assert all(count >= 6 for count in (counts[0], counts[1], counts[3]))
    assert counts[2] == 2 * counts[3]


def test_a_further_group_replaces_a_person_who_left_after_the_game() -> None:
    allocation = Allocation(1, 1, 4, 5, groups=((0, 0),))
    everyone = {0, 1, 2, 3}
    assert allocation.next({0, 1, 2}, {3}, everyone) is NoPlace.TAKEN
    further = allocation.next({0, 1, 2}, set(), {0, 1, 2})
    assert further == allocation.place(4)
    assert allocation.next({0, 1, 2}, {4}, {0, 1, 2}) is NoPlace.TAKEN or allocation.place(5)
    assert allocation.next({0, 1, 2, 4}, set(), {0, 1, 2, 4}) is NoPlace.FULL
    assert allocation.next({0, 1, 3}, set(), {0, 1}) == allocation.place(2)


def test_a_rehearsal_with_drop_outs_and_crashes_fills_the_quota_with_whole_groups(tmp_path: Path) -> None:
    people = SimulatedPeople(plays=False, drop_out=0.05, crashes=0.01)
    folder = rehearsed(tmp_path, PAIRS, people)
    progress = Progress(folder.read()).after(read_log(folder.log))
    assert progress.next_place() is NoPlace.FULL
    whole = [run for run in progress.runs.values() if run.state is RunState.COMPLETE]
    assert len(whole) >= 8
    for run in whole:
        games = [progress.groups[seat.group, step] for step, seat in run.seats.items()]
        assert len(games) == 2 and len({game.group for game in games}) == 1
        assert not any(game.incomplete for game in games)


def test_people_arrive_in_the_rehearsed_intervals(tmp_path: Path) -> None:
    file = tmp_path / "rehearsal.yaml"
    file.write_text("plays: false\ndrop_out: 0\narrivals: 7\n", encoding="utf-8")
    folder = rehearsed(tmp_path, PAIRS, load(file, SimulatedPeople).value)
    begun = [
        datetime.fromisoformat(each.event.clocks.wall)
        for each in read_log(folder.log)
        if isinstance(each, LoggedEvent) and each.event.kind == EventKind.RUN_BEGUN
    ]
    assert [(later - former).total_seconds() for former, later in itertools.pairwise(begun)] == [7.0] * (len(begun) - 1)


def test_equal_rehearsals_of_groups_have_equal_logs(tmp_path: Path) -> None:
    people = SimulatedPeople(plays=False, drop_out=0.1)
    one, two = (read_log(rehearsed(tmp_path / name, PAIRS, people).log) for name in ("a", "b"))
    assert one == two


def test_a_withdrawal_deletes_the_recordings_of_the_group_and_keeps_the_others_events(
    tmp_path: Path, opened: ExitStack
) -> None:
    study = Study(tmp_path, group_study(), opened)
    one, two = study.arrive(0.0), study.arrive(0.0)
    (game,) = study.room.update(0.0).games
    bag = study.folder.bag(game.group, 1)
    bag.parent.mkdir(parents=True)
    bag.write_bytes(b"a game")
    study.conductor.end_group_game(game, {"bag": f"recordings/{game.group}/step-1.bag"})
    opened.close()
    plan = plan_withdrawal(study.folder, study.design, one)
    assert [*plan.recordings] == [bag.parent]
    result = withdraw(study.folder, study.design, plan.withdrawal, {}, None, lambda: clocks(99))
    assert not result.failed and not bag.parent.exists()
    entries = read_log(study.folder.log)
    assert all(one not in repr(entry) for entry in entries)
    (left,) = Progress(study.design).after(entries).groups.values()
    assert left.people == {"namer": two}
    kinds = [entry.event.kind for entry in entries if isinstance(entry, LoggedEvent) and entry.event.participant == two]
    assert EventKind.GAME_PLAYED in kinds and EventKind.GROUP_FORMED in kinds


BETWEEN = "between: {skill: {expert: {}, novice: {}}}\n"
FORM = "{step: form, form: understood.yaml, name: before}"


@pytest.mark.parametrize(
    ("lobby", "steps", "further", "key", "problem"),
    [
        ("{by: skill}", "[{step: trial}]", BETWEEN, "lobby.by", "how many people of each kind"),
        ("{quota: {expert: 2}}", "[{step: trial}]", BETWEEN, "lobby.quota", "no effect without `by`"),
        ("{by: skill, quota: {expert: many}}", "[{step: trial}]", BETWEEN, "lobby.quota.expert", "not a number"),
        ("{by: skill, quota: {expert: 2, novice: 1}}", "[{step: trial}]", BETWEEN, "lobby.quota", "has 2 seats"),
        ("{by: skill, quota: {expert: 2}}", "[{step: trial}]", BETWEEN, "lobby.by", "could never play"),
        (
            "{by: skill, quota: {expert: 1, nobody: 1}}",
            "[{step: trial}]",
            BETWEEN,
            "lobby.quota.nobody",
            "neither a level",
        ),
        ("{by: skil, quota: {expert: 2}}", "[{step: trial}]", BETWEEN, "lobby.by", "neither a factor"),
        (
            "{by: skill, seat_of: {driver: expert, guide: novice}}",
            "[{step: trial}]",
            BETWEEN,
            "lobby.seat_of",
            "but those of the game are driver, namer",
        ),
        (
            "{by: before.played, quota: {'yes': 1, 'no': 1}}",
            f"[{{step: trial}}, {FORM}]",
            "",
            "lobby.by",
            "before the first game",
        ),
        ("{then: fewer, least: 3}", "[{step: trial}]", "", "lobby.least", "cannot start with 3 people"),
        ("{wait: 1}", "[{step: trial}]", "", "lobby.wait", ""),
        (
            "{by: robots, quota: {1: 1, 2: 1}}",
            "[{step: trial}]",
            "between: {things: {some: {game.wrong_share: 0.5}, none: {}}}\n",
            "lobby.by",
            "neither a factor",
        ),
        (
            "{by: share, quota: {some: 1, none: 1}}",
            "[{step: trial}]",
            "between: {share: {some: {game.wrong_share: 0.5}, none: {}}}\n",
            "between.share",
            "share changes the study",
        ),
        (
            "{}",
            f"[{FORM}, {{step: trial, when: {{before.played: 'yes'}}}}]",
            "",
            "steps[1].when",
            "may have different answers",
        ),
        (
            "{}",
            "[{step: practice, name: practice}, {step: check, form: understood.yaml, attempts: 2, repeat: practice}, "
            "{step: trial}]",
            "",
            "steps[1].repeat",
            "repeat the game",
        ),
    ],
)
def test_a_lobby_that_cannot_work_is_a_fault_with_its_key(
    tmp_path: Path, lobby: str, steps: str, further: str, key: str, problem: str
) -> None:
    write_experiment(tmp_path, group_study(lobby, steps, further))
    with pytest.raises((BadFile, BadFiles)) as raised:
        faults = [*faults_of(ExperimentFolder(tmp_path).read())]
        assert faults, "no fault"
        raise BadFiles(tuple(faults))
    faults = getattr(raised.value, "faults", [raised.value])
    assert any(fault.key == key and problem in fault.problem for fault in faults), list(map(str, faults))


def test_a_lobby_without_games_of_several_people_is_a_fault(tmp_path: Path) -> None:
    write_experiment(tmp_path, "title: x\nconsent_elsewhere: x\nlobby: {wait: 60}\nsteps: [{step: trial}]\n")
    (fault,) = faults_of(ExperimentFolder(tmp_path).read())
    assert "no game of this study has several people" in str(fault)
