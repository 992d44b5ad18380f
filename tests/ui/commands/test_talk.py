"""`thbridge talk`."""

import json
import shutil
from pathlib import Path

from typer.testing import CliRunner

from thbridge.dialogue.games.locutions import CONDITIONS, EFFECTS
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, Slot
from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook
from ui.cli import app


def talk(*arguments: object, code: int = 0, typed: str | None = None) -> str:
    done = CliRunner().invoke(app, ["talk", *map(str, arguments)], input=typed)
    assert done.exit_code == code, done.output
    return done.stdout


def test_the_shipped_games_are_told_with_their_ends() -> None:
    told = talk("check")
    assert "persuasion, about a literal; it ends after 60 moves at the latest" in told
    assert "ends: agreement, disagreement, unknown; stalemate," in told
    assert f"{len(read_rulebook().games)} games, no faults" in told


def test_of_a_folder_only_its_own_games_are_told(tmp_path: Path) -> None:
    text = (SHIPPED_GAMES / "persuasion.yaml").read_text()
    (tmp_path / "dispute.yaml").write_text(text.replace("name: persuasion", "name: dispute"))
    (told,) = json.loads(talk("check", tmp_path, "--json"))["folders"]
    assert [game["name"] for game in told["games"]] == ["dispute"]
    assert told["games"][0]["stages"][0] == {
        "name": "opening",
        "turn": "initiator",
        "replies": [{"say": "assert", "of": "topic", "next": "claimed", "last": None}],
    }


def test_faults_of_all_folders_are_told_with_their_lines(tmp_path: Path) -> None:
    for name, word in (("a", "iniator"), ("b", "respondent")):
        folder = Path(shutil.copytree(SHIPPED_GAMES, tmp_path / name))
        file = folder / "inquiry.yaml"
        file.write_text(file.read_text().replace("turn: initiator", f"turn: {word}"))
    told = talk("check", tmp_path / "a", tmp_path / "b", code=2)
    assert f"{tmp_path}/a/inquiry.yaml, line 7, stages[0].turn: 'iniator' is no choice here." in told
    assert f"{tmp_path}/b/inquiry.yaml, line 7, stages[0].turn: the initiator opens a game." in told
    (fault,) = json.loads(talk("check", tmp_path / "b", "--json", code=2))["folders"][0]["faults"]
    assert (fault["line"], fault["remedy"]) == (7, "Write initiator")


def test_every_word_of_the_files_is_explained() -> None:
    told = {line.strip().split("  ")[0] for line in talk("words").splitlines()}
    assert told >= {*CONDITIONS, *EFFECTS, *Slot, *GameRole, *DialogueEnd}
