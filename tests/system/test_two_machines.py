"""A hunt over the network between two machines: keys open the doors, and nobody on the way hears a word."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.programs.processes import Program, journal, kinds, until
from tests.system.two_machines import two_machines

_OLD_PROGRAM = """
import socket
old = socket.create_connection(("10.9.0.1", 6009), timeout=20)
old.sendall(b"%%setid OldProgram\\n")
try:
    print(old.recv(100))
except ConnectionError:
    print("cut off")
"""
_WATCHER = """
import asyncio, sys
from pathlib import Path
from thbridge.files.keys.key_file import read_key
from thbridge.watching.wire import SessionMessage
from thbridge.watching.sockets.client import WatchClient

async def watch():
    client = WatchClient("10.9.0.2", 6010, read_key(Path(sys.argv[1])))
    running = asyncio.ensure_future(client.run())
    seen = 0
    while seen < 500:
        seen += sum(isinstance(each, SessionMessage) for each in client.take())
        await asyncio.sleep(0.05)
    client.send(b'{"sender":"x","request":"ClearCostmaps","fields":{"robot":0}}\\n')
    await asyncio.sleep(0.5)

asyncio.run(asyncio.wait_for(watch(), 60))
print("watched")
"""


@pytest.mark.slow
def test_a_hunt_over_the_network_is_encrypted_and_who_shows_no_key_stays_outside(tmp_path: Path) -> None:
    (tmp_path / "study.yaml").write_text("robots: 1\n")
    for name, right in (("ann", "robots"), ("bob", "hider"), ("cleo", "participant"), ("dora", "intervene")):
        made = Program(tmp_path, "keys", "new", name, "--right", right)
        assert made.process.wait(60) == 0, made.text
    with two_machines(tmp_path) as lab:
        at = ("--server", "10.9.0.1:6009")
        running = [
            Program(
                tmp_path, "server", "study.yaml", "--host", "0.0.0.0", "--port", "6009", "--keys", "keys", by=lab.here
            )
        ]
        try:
            until("the server to listen", lambda: "listening on" in running[0].text, running)
            simr = ("simr", "study.yaml", *at, "--key", "keys/ann.key", "--rate", "10", "--bag", "simr.bag")
            door = ("--watch", "10.9.0.2:6010", "--watch-key", "keys")
            running.append(Program(tmp_path, *simr, *door, by=lab.there))
            running.append(Program(tmp_path, "hider", *at, "--key", "keys/bob.key", by=lab.there))
            until("the door for windows", lambda: "can connect to" in running[1].text, running)
            watch = [*lab.here, sys.executable, "-c", _WATCHER, "keys/dora.key"]
            watcher = subprocess.run(watch, cwd=tmp_path, capture_output=True, text=True, timeout=90, check=False)
            assert watcher.stdout == "watched\n", watcher.stderr
            person = Program(
                tmp_path, "tabui", "study.yaml", *at, "--key", "keys/cleo.key", "--participant", "nearest", by=lab.there
            )
            running.append(person)
            until("a treasure to be found", lambda: "sensed" in kinds(tmp_path), running)
            command = [*lab.there, sys.executable, "-c", _OLD_PROGRAM]
            old = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
            assert old.stdout == "cut off\n", old
            revoked = Program(tmp_path, "keys", "revoke", "cleo")
            running.append(revoked)
            assert revoked.process.wait(60) == 0, revoked.text
            until("the participant to be cut off", lambda: "the key cleo was revoked" in person.text, running)
        finally:
            for each in reversed(running):
                each.close()
        traffic = lab.traffic.read_bytes()
    # What is plain would have been seen.
    assert b"%%setid OldProgram" in traffic
    assert len(traffic) > 100_000
    # Of five letters at least: shorter ones are in a megabyte of noise by chance.
    words = [
        "TabUI",
        "Hider",
        "robot",
        "thbridge",
        "/clock",
        "%%goto",
        "%%error",
        "%%found",
        "Colour",
        "score",
        "Room ",
    ]
    secrets = [path.read_text().split()[0] for path in (tmp_path / "keys").glob("*.key")]
    assert len(secrets) == 4
    assert [word for word in (*words, *secrets) if word.encode() in traffic] == []
    used = {(event["key"], event["did"]) for event in journal(tmp_path) if event["event"] == "key"}
    assert used == {("ann", "joined as SimR"), ("bob", "joined as Hider"), ("cleo", "joined as TabUI")}
