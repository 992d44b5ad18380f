"""A participant's program has in it nothing of a treasure before the game reveals it: not in memory, not in files."""

import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest

from tests.support.programs import processes
from tests.support.programs.process_memory import found_in_memory

Program, until, journal, kinds = processes.Program, processes.until, processes.journal, processes.kinds

ORIGINAL = Path(__file__).parents[2] / "templates" / "original-2016"
COLOURS = [f"xqcolour{number}" for number in range(4)]
NAMES = [f"xqname{number}" for number in range(4)]
IMAGES = [f"xqfile{number}.jpg" for number in range(4)]


class Person(Program):
    """`thbridge tabui` with a person, whose keyboard is a pipe."""

    def __init__(self, folder: Path, server: str) -> None:
        self.arguments = ("tabui", "--participant", "person", "--server", server)
        self.folder = folder
        self.output = folder / "person.txt"
        self._file = self.output.open("wb")
        self.process = subprocess.Popen(
            [*processes.THBRIDGE, *self.arguments],
            cwd=folder,
            stdin=subprocess.PIPE,
            stdout=self._file,
            stderr=subprocess.STDOUT,
            env={**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"},
        )

    def type(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n".encode())
        self.process.stdin.flush()

    def open_files(self) -> set[str]:
        links = Path(f"/proc/{self.process.pid}/fd").iterdir()
        return {str(link.readlink()) for link in links}


@pytest.fixture
def secret(tmp_path: Path) -> Path:
    """A study whose treasures have words that stand nowhere else."""
    templates = tmp_path / "secret"
    shutil.copytree(ORIGINAL, templates)
    (templates / "treasures.participant").unlink()
    lines = [f"{c},Round and Large,10,{n},{i}" for c, n, i in zip(COLOURS, NAMES, IMAGES, strict=True)]
    (templates / "treasures").write_text("8\n" + "\n".join(lines) + "\n")
    for number, name in enumerate(IMAGES, start=1):
        (templates / "pictures" / f"rsz_t{number}.jpg").rename(templates / "pictures" / name)
    (tmp_path / "study.yaml").write_text("templates: ./secret\nrobots: 1\n")
    return tmp_path


@pytest.mark.slow
@pytest.mark.timeout(240)
def test_the_participant_s_program_learns_of_treasures_by_the_game_alone(secret: Path) -> None:
    running: list[Program] = [Program(secret, "server", "study.yaml", "--port", "0")]
    try:
        at = f"127.0.0.1:{processes.port_of(running[0], running)}"
        running.append(Program(secret, "simr", "--study", "study.yaml", "--server", at))
        running.append(Program(secret, "hider", "--treasures", "./secret", "--server", at))
        elsewhere = secret / "elsewhere"
        elsewhere.mkdir()
        person = Person(elsewhere, at)
        running.append(person)
        until("the treasures to be hidden", lambda: "hidden" in kinds(secret), running)
        until("the game to begin", lambda: "Game 1" in person.text, running)
        for line in ("1 8", "c", "c"):
            before = person.text
            person.type(line)
            until("an answer", lambda before=before: person.text != before, running)
        until("the robot to be under way", lambda: "departed" in kinds(secret), running)
        # However long looking takes, the robot's arrival is not heard meanwhile.
        person.process.send_signal(signal.SIGSTOP)
        assert "sensed" not in kinds(secret)
        words = {*COLOURS, *NAMES, *IMAGES}
        try:
            assert found_in_memory(person.process.pid, {*words, "sets out for room 8"}) == {"sets out for room 8"}
        except PermissionError:
            pytest.skip("nobody may look into other processes here")
        person.process.send_signal(signal.SIGCONT)
        until("a treasure to be found", lambda: "something xqcolour" in person.text, running)
        sensed = next(event for event in journal(secret) if event["event"] == "sensed")["colour"]
        assert found_in_memory(person.process.pid, words) == {sensed, *NAMES}
        assert not [name for name in person.open_files() if "secret/" in name.removeprefix(str(secret))]
    finally:
        for program in running:
            program.close()
