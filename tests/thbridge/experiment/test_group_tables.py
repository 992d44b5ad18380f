"""Tables of games of several people: who had which seat, what each seat said and did, and who decided."""

from dataclasses import replace

import pandas as pd
import pytest

from tests.support.studies.group_studies import group_study, rehearsed
from tests.thbridge.experiment.psych_ds_rules import problems
from thbridge.experiment.design.soundness import GROUP_COLUMNS, TAKEN_COLUMNS
from thbridge.experiment.export.families.dyads import dyads
from thbridge.experiment.export.families.game_recording import (
    GameRecording,
    Happening,
    TimedEvent,
    TimedTeamEntry,
    TimedUtterance,
    read_game,
)
from thbridge.experiment.export.families.group_games import RecordedGroup, acts_of
from thbridge.experiment.export.families.group_tables import joint_decisions, objections, seats, texts, votes
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.export.tables import ExperimentRecords, group_tables, records_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    DecisionKind,
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    ObjectionRaised,
    ObjectionReason,
    PersonRead,
    PersonSaid,
    RobotDeparted,
    TeamEntry,
    VoteCast,
)
from thbridge.hunt.rooms import Room
from thbridge.ros.messages.session_records import UtteranceRecord

SEATS = "[{name: driver, robots: [1, 2], names_treasures: false}, {name: namer, takes_over: false}]"
BASE = (
    f"map: arena8, robots: 2, game.energy: 15, participant.strategy: nearest, dialogue.condition: supervisor, "
    f"seats: {SEATS}, team: {{agreement: {{send: two}}}}"
)


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> ExperimentFolder:
    """A rehearsal with games of two people, of whom some leave; programs take their seats."""
    text = group_study("{leaving: program, incomplete_counts: true}", base=BASE, quota=2)
    people = SimulatedPeople(drop_out=0.3)
    return rehearsed(tmp_path_factory.mktemp("played"), text, people, 5)


@pytest.fixture(scope="module")
def records(played: ExperimentFolder) -> ExperimentRecords:
    return records_of(played.read(), played.entries())


def frames(records: ExperimentRecords) -> dict[str, pd.DataFrame]:
    found: dict[str, list[pd.DataFrame]] = {}
    for table in group_tables(records):
        found.setdefault(table.name, []).append(pd.DataFrame(table.rows, columns=[each.name for each in table.columns]))
    return {name: pd.concat(parts, ignore_index=True) for name, parts in found.items()}


def test_an_export_with_groups_is_a_dataset_and_its_methods_describe_them(played: ExperimentFolder) -> None:
    export = played.root / "exports" / "one"
    export_experiment(played, played.read(), played.entries(), export, {"thbridge": "1.0"}, None)
    assert problems(export) == []
    names = {path.stem for path in (export / "tables").glob("*.parquet")}
    assert {"groups", "seats", "joint_decisions", "votes"} <= names
    methods = (export / "methods.md").read_text()
    assert "### Groups and seats" in methods and "a program took the seat until the person came back" in methods
    trials, games = (pd.read_parquet(export / "tables" / f"{name}.parquet") for name in ("trials", "groups"))
    own = trials[trials.bag.notna()]
    assert set(own.group) == set(games[games.bag.notna()].group)
    assert {*own.groupby("group").bag.nunique()} == {1}, "all people of a group refer to one recording"


def test_programs_in_seats_are_declared(records: ExperimentRecords) -> None:
    found = frames(records)
    left = found["seats"][found["seats"].left_s.notna()]
    assert not left.empty
    assert set(left.holder) == {"person"} and set(left.holder_at_end) == {"program"}
    assert (left.filled_s == left.left_s).all()
    assert set(found["groups"][found["groups"].group.isin(left.group)].incomplete) == {True}
    later = found["votes"].merge(left, left_on=["group", "voter"], right_on=["group", "seat"])
    later = later[later.time_s > later.left_s]
    assert set(later.voter_holder) <= {"program"}


def test_each_seat_has_its_own_acts(records: ExperimentRecords) -> None:
    found = frames(records)
    for _, game in found["groups"][found["groups"].bag.notna()].iterrows():
        own = found["seats"][found["seats"].group == game.group].set_index("seat")
        assert own.loc["driver"].identified == 0 and own.loc["namer"].moves == 0
        assert own.identified.sum() == game.identified
        assert own.turns.sum() == game.turns
        assert own.turn_share.sum() == pytest.approx(1.0)
        made = found["joint_decisions"][found["joint_decisions"].group == game.group]
        assert len(made) == own.proposed.sum() == game.proposed
        assert {*made[made.outcome == "carried"].agreed_by} <= {"driver; namer"}


def test_no_table_of_groups_has_a_column_that_a_factor_may_be_called(records: ExperimentRecords) -> None:
    columns = {column.name for table in group_tables(records) for column in table.columns}
    assert columns - TAKEN_COLUMNS - GROUP_COLUMNS == set(), "add these to GROUP_COLUMNS"


def told(*entries: TeamEntry) -> GameRecording:
    return GameRecording(team=[TimedTeamEntry(entry.at, entry) for entry in entries])


@pytest.fixture
def group(records: ExperimentRecords) -> RecordedGroup:
    return replace(records.groups[0], changes={})


def with_entries(group: RecordedGroup, *entries: TeamEntry) -> RecordedGroup:
    return group.recorded(told(*entries))


def test_texts_have_author_addressee_and_times(records: ExperimentRecords, group: RecordedGroup) -> None:
    game = with_entries(
        group,
        PersonSaid(1, "driver", "", "Hello", 3.0, 1.5),
        PersonSaid(2, "driver", "namer", "Room 2?", 5.0, 2.0),
        PersonRead(1, "namer", 4.0),
        PersonSaid(3, "namer", "driver", "Yes", 8.0, 0.5),
    )
    rows = pd.DataFrame(texts(records.design, game).rows).set_index("line")
    assert [*rows.author] == ["driver", "driver", "namer"] and [*rows.reader] == ["namer", "namer", "driver"]
    assert [*rows.to_all] == [True, False, False]
    assert rows.loc[1].read_after_s == 1.0 and pd.isna(rows.loc[2].read_s)
    assert rows.loc[2].author_participant == group.game.people["driver"]
    assert [*rows.typing_s] == [1.5, 2.0, 0.5]


def test_votes_have_proposer_voters_reasons_and_seconds(records: ExperimentRecords, group: RecordedGroup) -> None:
    game = with_entries(
        group,
        DecisionProposed(1, "driver", DecisionKind.SEND, 0, Room(2), "", 2, 10.0),
        VoteCast(1, "namer", False, "too far", 14.0),
        DecisionSettled(1, DecisionOutcome.REJECTED, 14.0),
    )
    (row,) = joint_decisions(records.design, game).rows
    assert (row["proposed_by"], row["agreed_by"], row["rejected_by"]) == ("driver", "driver", "namer")
    assert (row["decision_s"], row["outcome"], row["robot"]) == (4.0, "rejected", 1)
    first, second = votes(records.design, game).rows
    assert (first["voter"], first["agrees"]) == ("driver", True)
    assert (second["voter"], second["agrees"], second["reason"], second["after_proposal_s"]) == (
        "namer",
        False,
        "too far",
        4.0,
    )


def test_an_objection_has_its_reason_and_whether_it_was_followed(
    records: ExperimentRecords, played: ExperimentFolder
) -> None:
    """A recorded game of these seats, with an objection in the dialogue before the first move and in a later one."""
    group = next(each for each in records.groups if each.trial is not None)
    recording = read_game(played.bag_named(group.trial.bag))
    first = next(each for each in recording.events if isinstance(each.event, RobotDeparted))
    robot, room, seat = first.event.robot, first.event.room, first.event.seat

    def objection(number: int, about: Room, at: float) -> list[Happening | TimedTeamEntry]:
        said = UtteranceRecord(
            dialogue=number, speaker="human", robot=robot, room=about.people, scenario="select-room", text="Yes",
            author=f"person {seat}", move="accept",
        )  # fmt: skip
        raised = ObjectionRaised(number, "namer", robot, about, ObjectionReason.TOO_FAR, "far", 1, at)
        return [TimedUtterance(at - 0.02, said), TimedTeamEntry(at, raised)]

    added = [*objection(101, Room(room.people % 8 + 1), first.time - 0.2), *objection(102, room, first.time - 0.1)]
    recording.happenings += [each for each in added if isinstance(each, TimedUtterance)]
    recording.team += [each for each in added if isinstance(each, TimedTeamEntry)]
    game = replace(group, changes={}).recorded(recording)
    followed, ignored = objections(records.design, game).rows
    assert [each["followed"] for each in (followed, ignored)] == [True, False]
    assert (ignored["talk"], ignored["objector"], ignored["decided_by"]) == (102, "namer", seat)
    assert (ignored["reason"], ignored["text"], ignored["matter"]) == ("too-far", "far", "select-room")
    (row,) = [each for each in seats(records.design, game).rows if each["seat"] == "namer"]
    assert (row["objections"], row["objections_followed"]) == (2, 1)


def test_turns_are_series_of_acts_of_one_seat(records: ExperimentRecords, group: RecordedGroup) -> None:
    said = [(1.0, "driver"), (2.0, "driver"), (3.0, "namer"), (4.0, "driver")]
    recording = told(*(PersonSaid(n, seat, "", "x", at, 0.0) for n, (at, seat) in enumerate(said, start=1)))
    acts = acts_of(recording)
    assert (acts.turns, acts.of("driver").turns, acts.of("namer").turns) == (3, 2, 1)
    rows = {row["seat"]: row for row in seats(records.design, group.recorded(recording)).rows}
    assert rows["driver"]["turn_share"] == pytest.approx(2 / 3)


def test_dyads_have_what_one_seat_did_toward_the_other(records: ExperimentRecords, group: RecordedGroup) -> None:
    recording = told(
        PersonSaid(1, "driver", "", "Hello", 1.0, 0.5),
        PersonRead(1, "namer", 3.0),
        DecisionProposed(1, "driver", DecisionKind.SEND, 0, Room(2), "", 2, 4.0),
        VoteCast(1, "namer", True, "", 6.0),
        DecisionSettled(1, DecisionOutcome.CARRIED, 6.0),
        ObjectionRaised(7, "namer", 0, Room(2), ObjectionReason.TOO_FAR, "", 1, 8.0),
    )
    said = UtteranceRecord(
        dialogue=7, speaker="human", robot=0, room=2, scenario="select-room", text="Go", author="person driver",
        move="assert",
    )  # fmt: skip
    given = CommanderChanged(1, Commander.PARTICIPANT, "namer", seat="driver")
    back = CommanderChanged(1, Commander.PARTICIPANT, "driver")
    events = [TimedEvent(at, event, None, None) for at, event in ((9.0, given), (10.0, back))]
    recording.happenings = [TimedUtterance(7.0, said), *events]
    first, second = dyads(records.design, group.recorded(recording)).rows
    assert (first["seat"], first["toward"]) == (second["toward"], second["seat"]) == ("driver", "namer")
    assert first["participant"] == second["toward_participant"] == group.game.people["driver"]
    assert (first["texts"], first["read_after_s"], second["texts"], second["read_after_s"]) == (1, 2.0, 0, None)
    assert (second["votes"], second["agreed"], second["vote_after_s"], first["votes"]) == (1, 1, 2.0, 0)
    assert (second["objections"], first["objections"]) == (1, 0)
    assert (first["handed_over"], second["handed_over"]) == (1, 0)
    assert (first["turns"], second["turns"]) == (2, 2)
