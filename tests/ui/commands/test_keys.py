from pathlib import Path

import pytest

from tests.support.programs.commands import invoke


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_key_is_made_listed_and_revoked() -> None:
    made = invoke("keys", "new", "maria", "--right", "watch", "--right", "intervene", "--days", "7")
    assert (made.exit_code, made.stdout) == (0, "keys/maria.key\n")
    assert len(Path("keys/maria.key").read_text().strip()) >= 40
    listed = invoke("keys", "list").stdout
    assert Path("keys/maria.key").read_text().splitlines()[1] in listed
    assert "maria" in listed
    assert "watch, intervene" in listed
    assert "valid" in listed
    assert invoke("keys", "revoke", "maria").exit_code == 0
    assert "revoked" in invoke("keys", "list").stdout


def test_faults_are_told() -> None:
    assert "there is no folder keys" in invoke("keys", "revoke", "maria").stderr
    invoke("keys", "new", "maria")
    again = invoke("keys", "new", "maria")
    assert again.exit_code == 2
    assert "a key maria already exists" in again.stderr


def test_a_door_wants_keys_that_are_there_and_cannot_be_guessed() -> None:
    Path("keys").mkdir()
    none = invoke("play", "--headless", "--watch", "0", "--watch-key", "keys")
    assert none.exit_code == 2
    assert "there are no keys in keys. Create a key: " in none.stderr
    Path("a.key").write_text("a\n")
    Path("a.key").chmod(0o600)
    short = invoke("play", "--headless", "--watch", "0", "--watch-key", "a.key")
    assert short.exit_code == 2
    assert "this key is easy to guess, because it has only 1 characters" in short.stderr


def test_a_key_of_a_participant_may_be_for_certain_seats(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    invoke("keys", "new", "ann", "--right", "participant", "--seat", "driver", "--seat", "scout")
    assert "driver, scout" in invoke("keys", "list").stdout
    for words, problem in (
        (("--seat", "driver"), "only a key of a participant"),
        (("--right", "participant", "--seat", "The driver"), "is no name of a seat"),
    ):
        refused = invoke("keys", "new", "bob", *words)
        assert refused.exit_code == 2 and problem in refused.stderr
    assert "bob" not in invoke("keys", "list").stdout
