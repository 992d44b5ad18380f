"""Our programs as processes, started as an admin starts them, and waits for what they do."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from tests.support.programs import processes

THBRIDGE = [sys.executable, "-c", "from ui.cli import main; main()"]


class Program:
    """Process that runs a `thbridge` command. Its output goes to a file, so that a failing test can show it.

    Args:
        folder: working folder.
        arguments: arguments after `thbridge`.
        environment: environment variables of the process.
        by: command that runs it, for example on another machine.
    """

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        environment: Mapping[str, str] = os.environ,
        by: Sequence[str] = (),
    ) -> None:
        self.arguments = arguments
        self.by = by
        self.environment = environment
        self.folder = folder
        self.output = folder / f"{arguments[0]}-{time.monotonic_ns()}.txt"
        self._file = self.output.open("wb")
        self.process = subprocess.Popen(
            [*by, *THBRIDGE, *arguments],
            cwd=folder,
            stdout=self._file,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            env={**environment, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"},
            start_new_session=True,
        )

    @property
    def text(self) -> str:
        return self.output.read_text(errors="replace")

    def kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait(10)

    def stop(self) -> int:
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(90)

    def again(self) -> "Program":
        return Program(self.folder, *self.arguments, environment=self.environment, by=self.by)

    def close(self) -> None:
        if self.process.poll() is None:
            self.kill()
        self._file.close()


def until(what: str, condition: Callable[[], bool], programs: list[Program], seconds: float = 120.0) -> None:
    """Wait for a condition by testing it repeatedly.

    After the time limit, raise TimeoutError with all programs' output.
    """
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            told = "\n".join(f"--- {program.arguments[0]}\n{program.text}" for program in programs)
            raise TimeoutError(f"waited {seconds} s for {what}\n{told}")
        time.sleep(0.05)


def port_of(server: Program, programs: list[Program]) -> int:
    until("the server to listen", lambda: "listening on" in server.text or server.process.poll() is not None, programs)
    assert "listening on" in server.text, server.text
    return int(server.text.split("listening on ")[1].split()[0].rpartition(":")[2])


def journal(folder: Path, game: int = 1) -> list[dict]:
    path = folder / "journal" / f"game-{game:04d}.jsonl"
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text().splitlines() if line.endswith("}")]


def kinds(folder: Path) -> list[str]:
    return [event["event"] for event in journal(folder)]


def run_thbridge(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*processes.THBRIDGE, *arguments], cwd=folder, capture_output=True, text=True, timeout=280, check=False
    )


def play_headless(folder: Path, *arguments: str) -> dict:
    done = run_thbridge(folder, "play", "--headless", "--json", "--port", "0", *arguments)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
