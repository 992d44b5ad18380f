"""The options `--seat` and `--outside` of `thbridge play` and `thbridge tabui` in games with several seats."""

import json
from pathlib import Path

import pytest

from tests.support.programs.commands import refusal, thbridge

STUDY = """
robots: 1
game: {energy: 20}
seats:
  - {name: driver, robots: [1], names_treasures: false}
  - {name: namer, takes_over: false}
"""


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "study.yaml").write_text(STUDY)
    (tmp_path / "one.yaml").write_text("robots: 1\n")
    return tmp_path


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (
            "play study.yaml --participant person --seat pilot",
            "--seat: 'pilot' is not in the `seats` of study.yaml. Write",
        ),
        ("play one.yaml --participant person --seat driver", "--seat: one.yaml has no `seats`"),
        ("play study.yaml --headless --seat driver", "--seat: no person plays with these options. Omit the option"),
        ("play study.yaml --outside TabUI", "--outside: TabUI is not a role that other programs can play. Use TabUI-d"),
        ("play study.yaml --participant person --seat driver --outside TabUI-driver", "--seat: --outside gives driver"),
        ("play study.yaml --participant person --outside TabUI-driver,TabUI-namer", "so you have none. Omit one"),
        ("tabui study.yaml --participant nearest", "--seat: the game of study.yaml has several seats. Add --seat"),
        ("tabui study.yaml --participant nearest --seat pilot", "Write one of these: driver, namer."),
        ("tabui --participant nearest --seat TabUI", "--seat: 'TabUI' is no name of a seat."),
    ],
)
def test_wrong_seats_are_refused_before_anything_starts(study: Path, command: str, said: str) -> None:
    assert said in " ".join(refusal(*command.split()).split())


def test_a_team_of_variable_size_has_no_seats(study: Path) -> None:
    Path("study.yaml").write_text(STUDY + "participant: {robots: [1, 2]}\n")
    said = refusal("play", "study.yaml", "--headless")
    assert "participant.robots" in said and "Delete the key" in said


def test_simulated_participants_take_all_seats(study: Path) -> None:
    done = thbridge(study, "play", "study.yaml", "--headless", "--json", "--port", 0, "--bag", "hunt.bag")
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["over"] is not None
    events = [json.loads(line[: line.rindex("}") + 1]) for line in next(study.glob("hunt.journal/*")).open()]
    by = {(event["event"], event.get("seat")) for event in events}
    assert {("departed", "driver"), ("seat-taken", "namer")} <= by


def test_a_person_in_the_terminal_is_shown_their_seat(study: Path) -> None:
    command = ("play", "study.yaml", "--participant", "person", "--port", 0, "--bag", "hunt.bag", "--max-seconds", 2)
    done = thbridge(study, *command)
    assert "You take the seat driver. To take another one (namer), add --seat NAME." in " ".join(done.stderr.split())
