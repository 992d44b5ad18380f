"""MAVProxy as a process, without a screen and in a folder of its own."""

import os
import re
import signal
import subprocess
import time
from pathlib import Path
from typing import Self

from tests.peers.rover_session import PEERS
from tests.support.programs.peer_programs import skip_if_crashed, skipping_if_crashed

MODULES = "link,param,wp,mode,cmdlong,arm,log,signing,misc"
PATIENCE = 120.0


class MavProxy:
    """One MAVProxy, typed to line by line."""

    def __init__(self, folder: Path, port: int) -> None:
        folder.mkdir()
        self.folder = folder
        self.output = folder / "mavproxy.txt"
        self._file = self.output.open("wb")
        self._read = 0
        self.process = subprocess.Popen(
            [
                PEERS / "mavproxy" / "bin" / "mavproxy.py", f"--master=udp:127.0.0.1:{port}",
                f"--default-modules={MODULES}", "--target-system=1", f"--state-basedir={folder}", "--nowait",
            ],
            cwd=folder, stdin=subprocess.PIPE, stdout=self._file, stderr=subprocess.STDOUT, text=True, bufsize=1,
            env={**os.environ, "PYTHONUNBUFFERED": "1", "HOME": str(folder)}, start_new_session=True,
        )  # fmt: skip

    def types(self, line: str) -> None:
        assert self.process.stdin is not None
        with skipping_if_crashed("MAVProxy", self.process):
            self.process.stdin.write(f"{line}\n")

    def says(self, pattern: str, again: str = "") -> re.Match[str]:
        """Waits for words that it has not said before, and takes all up to them as read.

        What is typed `again` each second may lead to them.
        """
        end, typed = time.monotonic() + PATIENCE, time.monotonic()
        while True:
            text = self.output.read_text(errors="replace")
            found = re.search(pattern, text[self._read :])
            if found is not None:
                self._read += found.end()
                return found
            skip_if_crashed("MAVProxy", self.process.poll(), text)
            if time.monotonic() > end:
                raise TimeoutError(f"waited {PATIENCE} s for {pattern!r} in\n{text}")
            if again and time.monotonic() > typed + 1.0:
                typed = time.monotonic()
                self.types(again)
            time.sleep(0.05)

    def does(self, line: str, pattern: str) -> re.Match[str]:
        self.types(line)
        return self.says(pattern)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait(10)
        if self.process.stdin is not None:
            self.process.stdin.close()
        self._file.close()
