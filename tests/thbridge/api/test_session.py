"""Sessions of `thbridge.api`: equal to those of the command line, replayed bit for bit, and what they take."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.support.programs.commands import thbridge
from thbridge import api
from thbridge.recording.bag.reading.reader import messages
from thbridge.ros.names import SESSION

STUDY = api.HuntStudy(robots=2, seed=3, game={"energy": 30})


def contents(bag: Path) -> list[tuple[str, int, bytes]]:
    return [(message.topic, message.stamp_ns, message.data) for message in messages(bag)]


def test_a_game_is_that_of_the_command_line_byte_for_byte(tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.bag", tmp_path / "theirs.bag"
    (tmp_path / "study.yaml").write_text("robots: 2\nseed: 3\ngame:\n  energy: 30\n")
    with api.HuntSession(STUDY, participant="nearest", record=ours) as session:
        assert session.play()
    command = ["play", "study.yaml", "--participant", "nearest", "--bag", str(theirs), "--json", "--port", "0"]
    assert thbridge(tmp_path, *command).exit_code == 0
    mine, other = contents(ours), contents(theirs)
    # The session record holds the study, whose port differs, so that no other program is in the way.
    assert [each for each in mine if each[0] != SESSION] == [each for each in other if each[0] != SESSION]
    journals = [next((tmp_path / f"{name}.journal").glob("*.jsonl")).read_bytes() for name in ("ours", "theirs")]
    assert journals[0] == journals[1]


def test_whatever_is_asked_is_recorded_and_replays_bit_for_bit(tmp_path: Path) -> None:
    with api.HuntSession(STUDY, record=tmp_path / "hunt.bag") as session:
        session.run(0.2)
        session.participant.select(1, 3)
        session.step(4)
        while session.view is not None and session.view.dialogues:
            if session.view.dialogues[0].choices:
                session.participant.answer(1)
            session.step(3)
        session.participant.send(1, 3)
        session.send(2, 5)
        session.run(2.0)
        session.stop(2)
        session.set_parameters(1, {"amcl.kld_err": 0.02, "world.laser.range_noise": 0.05})
        session.set_pose(2, *session.snapshot.true_poses[1])
        session.put_thing("crate", "crate", 0.0, 0.0, 0.3)
        session.run(1.0)
        session.set_goal(2, 0.5, 1.0, 1.0)
        session.run(1.0)
        session.cancel_goal(2)
        session.drive(2, 0.2, 0.1)
        session.run(0.4)
        session.remove_thing("crate")
        session.carry(2, 2.0, 0.0, 0.0)
        session.forget_pose(2)
        session.run(1.0)
        session.kill(2)
        session.run(0.5)
        session.revive(2)
        session.hand_back(2)
        session.run_until("arrived", at_most=60)
        session.participant.sense(3)
        session.run(0.3)
        known = session.view.known[2] if session.view else {}
    recording = api.HuntRecording(tmp_path / "hunt.bag")
    assert known
    assert recording.participant == "program"
    assert recording.study.yaml() == STUDY.yaml()
    done = recording.replay()
    assert done.equal and done.difference is None and done.ticks == round(recording.seconds * 50)
    asked = {str(message["line"]).split()[0] for _, _, message in recording.messages("/inputs")}
    assert {"TakeCommand", "SetParameters", "SimpleGoal", "VelocityCommand", "PutThing", "Die", "%%goto"} <= asked


def test_a_session_can_be_told_apart_from_its_recording_by_nothing(tmp_path: Path) -> None:
    with api.HuntSession(STUDY, participant="random", record=tmp_path / "a.bag") as one:
        one.run(3)
        with api.HuntSession(STUDY, participant="random") as other:
            other.run(3)
            assert np.array_equal(one.snapshot.true_poses, other.snapshot.true_poses)
            assert one.events == other.events


def test_a_snapshot_has_a_row_for_each_robot() -> None:
    with api.HuntSession(STUDY) as session:
        session.run(0.2)
        session.send(2, 4)
        now = session.run(1.0)
        assert now.poses.shape == now.true_poses.shape == now.odometry.shape == now.goals.shape == (2, 3)
        assert now.covariances.shape == (2, 3, 3)
        assert ((now.p_wrong > 0.0) & (now.p_wrong < 0.1)).all()
        assert now.scans.shape == (2, 181) and np.isfinite(now.scans).any()
        assert now.costs.shape == (2, 8)
        assert np.abs(now.poses - now.true_poses).max() < 0.3
        assert np.isnan(now.goals[0]).all() and np.isfinite(now.goals[1]).all()
        assert now.states == ("idle", "controlling")
        assert now.bound_for.tolist() == [0, 4]
        assert now.energy[0] == 30.0 and now.energy[1] < 30.0
        assert now.seconds == session.seconds == pytest.approx(1.2)
        assert len(now.true_treasures) == 8


def test_a_snapshot_stays_what_it_was() -> None:
    with api.HuntSession(STUDY) as session:
        session.drive(1, 0.5, 0.0)
        before = session.run(0.3)
        poses, scans = before.true_poses.copy(), before.scans.copy()
        session.run(0.5)
        assert np.array_equal(before.true_poses, poses) and np.array_equal(before.scans, scans, equal_nan=True)
        assert not np.array_equal(session.snapshot.true_poses, poses)


def test_the_view_holds_what_is_found_only_when_it_is_found() -> None:
    with api.HuntSession(STUDY) as session:
        session.run(0.2)
        assert session.view is not None and session.view.names == ()
        assert not any(session.view.known)
        hidden = set(session.snapshot.true_treasures)
        told = " ".join(str(getattr(session.view, name)) for name in dir(session.view) if not name.startswith("_"))
        assert not [name for name in hidden if name in told]


def test_running_until_something_happens() -> None:
    with api.HuntSession(STUDY) as session:
        assert session.run_until("ready", at_most=5)
        assert session.ready == (1, 2)
        session.send(1, 3)
        assert session.run_until("departed", at_most=5)
        assert session.ready == (2,)
        assert session.run_until(lambda now: now.snapshot.true_twists[0, 0] > 0.1, at_most=10)
        assert not session.run_until("pictured", at_most=0.5)


def test_a_goal_tells_its_end() -> None:
    with api.HuntSession(STUDY) as session:
        session.set_goal(1, 0.0, 0.0)
        assert session.run_until("goal", at_most=60)
        assert session.events[-1].text == "reached" and session.events[-1].robot == 1
        session.set_goal(1, 1000.0, 0.0)
        assert session.run_until("goal", at_most=60)
        assert session.events[-1].text not in {"reached", "cancelled"}


def test_a_refusal_is_an_event_and_in_the_view() -> None:
    with api.HuntSession(STUDY) as session:
        session.run(0.2)
        session.participant.send(1, 3)
        session.run(0.2)
        assert session.view is not None
        refused = [event.text for event in session.events if event.kind == "refused"]
        assert refused == [session.view.refusal]


@pytest.mark.parametrize(
    ("act", "told"),
    [
        (lambda session: session.send(3, 1), "there is no robot 3. Give a number from 1 to 2."),
        (lambda session: session.set_goal(1, math.nan, 0.0), "all numbers must be finite"),
        (lambda session: session.set_goal(1, 1e9, 0.0), "the coordinates of the place are too large for any map"),
        (lambda session: session.set_pose(1, 0, 0, 0, [[-1, 0, 0], [0, 1, 0], [0, 0, 1]]), "covariance"),
        (lambda session: session.set_parameters(1, {"amcl.kld_errr": 1}), "kld_err"),
        (lambda session: session.put_thing("x", "house", 0, 0), "Write crate, door, fire or person"),
        (lambda session: session.participant.answer(1), "does not wait for an answer"),
        (lambda session: session.step(0), "below 1"),
    ],
)
def test_what_cannot_be_asked_is_told_and_changes_nothing(act: Callable[[api.HuntSession], object], told: str) -> None:
    with api.HuntSession(STUDY) as session:
        session.step()
        with pytest.raises(api.HuntError, match=told.replace(".", r"\.")):
            act(session)
        session.step()
        with api.HuntSession(STUDY) as other:
            other.step(2)
            assert np.array_equal(session.snapshot.true_poses, other.snapshot.true_poses)


def test_a_simulated_participant_is_not_spoken_for() -> None:
    with api.HuntSession(STUDY, participant="nearest") as session, pytest.raises(api.HuntError, match="without"):
        session.participant.select(1, 3)


def test_recordings_that_cannot_be_made_are_told(tmp_path: Path) -> None:
    with pytest.raises(api.HuntError, match=r"ends in \.bag"):
        api.HuntSession(STUDY, record=tmp_path / "hunt.txt")
    (tmp_path / "file").touch()
    with pytest.raises(api.HuntError, match="Choose another path"):
        api.HuntSession(STUDY, record=tmp_path / "file" / "hunt.bag")


def test_an_older_recording_is_kept(tmp_path: Path) -> None:
    for _ in range(2):
        with api.HuntSession(STUDY, record=tmp_path / "hunt.bag") as session:
            session.step(5)
    assert sorted(path.name for path in tmp_path.glob("*.bag")) == ["hunt-1.bag", "hunt.bag"]


def test_a_closed_session_does_not_go_on() -> None:
    with api.HuntSession(STUDY) as session:
        session.step()
    with pytest.raises(api.HuntError, match="closed"):
        session.step()


def test_a_participant_agrees_where_the_study_asks(tmp_path: Path) -> None:
    (tmp_path / "consent.txt").write_text("You may leave at any time.")
    (tmp_path / "study.yaml").write_text("participant:\n  consent: consent.txt\n")
    with api.HuntSession(api.HuntStudy(tmp_path / "study.yaml")) as session:
        session.run(0.2)
        assert session.view is not None and session.view.consent == "You may leave at any time."
        session.participant.agree()
        session.run(0.2)
        assert session.view.consent is None
