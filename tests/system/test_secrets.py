"""Keys are in no recording, log, page, export, output or list of processes, though those who have them came in.

Nor are they in what a program prints that fails on purpose, is aborted, or tells all that asyncio can tell.
"""

import hashlib
import json
import os
import pickle
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until
from tests.support.slow import slow
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.to_mcap import to_mcap
from thbridge.analysis.to_ros2 import to_ros2
from thbridge.batch.design import read_design
from thbridge.batch.folder import open_folder
from thbridge.batch.sweep import tasks_of
from thbridge.files.keys.key_ring import Right
from thbridge.files.tables.table_files import TableFormat
from thbridge.recording.bag.options import Compression

WATCH_KEY = "watch-key-a4c1d7e09b23"
PASSPHRASE = "signing passphrase 7f3e91"
TELLING = {**os.environ, "PYTHONASYNCIODEBUG": "1", "PYTHONFAULTHANDLER": "1", "QT_QPA_PLATFORM": "offscreen"}
"""Set by somebody who wants to know all: what asyncio calls, and the stacks of whoever is aborted."""


@pytest.fixture
def keys(tmp_path: Path) -> Path:
    """Files with one key for watchers, and one that signs frames."""
    folder = tmp_path / "keys"
    folder.mkdir(mode=0o700)
    for name, text in (("watch.txt", WATCH_KEY), ("signing.txt", PASSPHRASE)):
        (folder / name).write_text(f"{text}\n")
        (folder / name).chmod(0o600)
    return folder


def ring(tmp_path: Path) -> tuple[Path, str]:
    """A ring with a key of Maria's, who may intervene; its folder and her secret."""
    folder = tmp_path / "ring"
    made = Program(
        tmp_path, "keys", "new", "maria", "--keys", "ring", "--right", Right.WATCH, "--right", Right.INTERVENE
    )
    assert made.process.wait(60) == 0, made.text
    made.close()
    secret = (folder / "maria.key").read_text().split()[0]
    assert len(secret) > 20
    return folder, secret


def forms_of(*secrets: str) -> set[bytes]:
    """The bytes by which secrets can be known: as they are, and what is made of a passphrase."""
    return {each.encode() for each in secrets} | {hashlib.sha256(each.encode()).digest() for each in (PASSPHRASE,)}


def processes() -> Iterator[tuple[Path, bytes]]:
    """Command line and environment of every process of this machine."""
    for process in Path("/proc").glob("[0-9]*"):
        for name in ("cmdline", "environ"):
            with suppress(OSError):
                yield process / name, (process / name).read_bytes()


def holding(secrets: set[bytes], *contents: tuple[Path, bytes]) -> list[Path]:
    return [path for path, content in contents if any(secret in content for secret in secrets)]


def written(folder: Path, *besides: Path) -> list[tuple[Path, bytes]]:
    """All files in a folder but those of keys."""
    paths = [
        path for path in folder.rglob("*") if path.is_file() and not any(path.is_relative_to(it) for it in besides)
    ]
    return [(path, path.read_bytes()) for path in paths]


def said_by(port: int, *lines: str) -> None:
    """A watcher says these lines, and waits until it is told that one was refused, or that is turned away."""
    told = b""
    with socket.create_connection(("127.0.0.1", port), 20) as watcher:
        for line in lines:
            watcher.sendall(line.encode() + b"\n")
        watcher.settimeout(5)
        with suppress(TimeoutError, ConnectionError):
            while b"/watch/status" not in told or b"refused" not in told:
                piece = watcher.recv(2**16)
                if not piece:
                    break
                told += piece


@pytest.mark.slow
def test_keys_are_nowhere_but_in_their_files(tmp_path: Path, keys: Path) -> None:
    folder, secret = ring(tmp_path)
    secrets = forms_of(secret, PASSPHRASE)
    secrets |= set((folder / "certificate.pem").read_bytes().splitlines()[1:3])  # of the private key
    port = free_port()
    options = ("--headless", "--rate", "5", "--max-seconds", "60", "--bag", "a.bag", "--port", "0", "--report")
    # Packed, a key would not be found.
    options += ("--with", "recording.compression=none")
    doors = ("--watch", str(port), "--watch-key", "ring", "--mavlink", "--tlog", "--signing-key", "keys/signing.txt")
    hunt = Program(tmp_path, "play", *options, *doors, environment=TELLING)
    window = None
    try:
        until("the door", lambda: "Researchers can connect" in hunt.text, [hunt])
        window = Program(tmp_path, "watch", f"127.0.0.1:{port}", "--key", "ring/maria.key", environment=TELLING)
        key = json.dumps({"key": secret})
        halt = {"request": "Halt", "fields": {"robot": 0}}
        said_by(port, '{"key": "a wrong one"}', json.dumps(halt))
        # Maria is careless: she says her key again and again, where it is not wanted.
        said_by(port, key, json.dumps({**halt, "key": secret}), json.dumps({"request": secret}), secret)
        seen = list(processes())
        assert any(b"--signing-key" in content for _, content in seen)
        hunt.process.wait(120)
    finally:
        for program in (hunt, window):
            if program is not None:
                program.close()
    bag = tmp_path / "a.bag"
    to_mcap(bag, tmp_path / "a.mcap", "none")
    to_ros2(bag, tmp_path / "ros2", Compression.NONE)
    export_bag(bag, tmp_path / "tables", (TableFormat.CSV,))
    files = written(tmp_path, keys, folder / "maria.key", folder / "certificate.pem")
    assert {path.suffix for path, _ in files} >= {".bag", ".tlog", ".html", ".jsonl", ".txt", ".mcap", ".csv", ".json"}
    assert b"maria" in bag.read_bytes(), "whoever intervened is named in the record"
    assert holding(secrets, *files, *seen) == []


FAILING = """
import thbridge.watching.wire as watching
def feed(self, data):
    raise RuntimeError("on purpose")
watching.WatcherSession.feed = feed
from ui.cli import main
main()
"""


@pytest.mark.parametrize("ending", ["failure", *slow("abort")])
def test_what_fails_on_purpose_does_not_tell_a_key(tmp_path: Path, keys: Path, ending: str) -> None:
    secrets = forms_of(WATCH_KEY, PASSPHRASE)
    port = free_port()
    words = ["play", "--headless", "--rate", "1", "--max-seconds", "60", "--bag", "a.bag", "--port", "0", "--mavlink"]
    words += ["--watch", str(port), "--watch-key", "keys/watch.txt", "--signing-key", "keys/signing.txt"]
    output = tmp_path / "output.txt"
    with output.open("wb") as file:
        hunt = subprocess.Popen(
            [sys.executable, "-c", FAILING if ending == "failure" else "from ui.cli import main; main()", *words],
            cwd=tmp_path,
            stdout=file,
            stderr=subprocess.STDOUT,
            env={**TELLING, "PYTHONUNBUFFERED": "1"},
        )
    try:
        until("the door", lambda: b"Researchers can connect" in output.read_bytes(), [])
        said_by(port, json.dumps({"key": WATCH_KEY}))
        hunt.send_signal(signal.SIGABRT if ending == "abort" else signal.SIGTERM)
        hunt.wait(90)
    finally:
        if hunt.poll() is None:
            hunt.kill()
            hunt.wait(10)
    assert ("on purpose" if ending == "failure" else "Fatal Python error") in output.read_text()
    assert holding(secrets, *written(tmp_path, keys)) == []


def test_a_worker_of_a_sweep_gets_the_name_of_a_key_and_no_key(tmp_path: Path, keys: Path) -> None:
    (tmp_path / "study.yaml").write_text("robots: 1\nmavlink: {tcp: 127.0.0.1:5760, signing_key: keys/signing.txt}\n")
    (tmp_path / "sweep.yaml").write_text("study: study.yaml\nreplicates: 2\n")
    design = read_design(tmp_path / "sweep.yaml")
    sent = pickle.dumps(tasks_of(design, open_folder(design, tmp_path / "results"), lambda _: True))
    assert b"signing.txt" in sent
    assert holding(forms_of(PASSPHRASE), (tmp_path, sent), *written(tmp_path, keys)) == []
