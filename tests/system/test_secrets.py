"""Keys are in no recording, log, page, output or list of processes, though those who have them came in."""

import hashlib
import socket
from pathlib import Path

from tests.system.ports import free_port
from tests.system.programs import Program, until

WATCH_KEY = "watch-key-a4c1d7e09b23"
PASSPHRASE = "signing passphrase 7f3e91"


def test_keys_are_nowhere_but_in_their_files(tmp_path: Path) -> None:
    keys = tmp_path / "keys"
    keys.mkdir()
    for name, text in (("watch.txt", WATCH_KEY), ("signing.txt", PASSPHRASE)):
        (keys / name).write_text(f"{text}\n")
        (keys / name).chmod(0o600)
    port = free_port()
    options = ("--headless", "--rate", "5", "--max-seconds", "25", "--bag", "a.bag", "--port", "0", "--report")
    # Packed, a key would not be found.
    options += ("--with", "recording.compression=none")
    doors = ("--watch", str(port), "--watch-key", "keys/watch.txt", "--mavlink", "--tlog")
    hunt = Program(tmp_path, "play", *options, *doors, "--signing-key", "keys/signing.txt")
    try:
        until("the door", lambda: "Researchers can watch" in hunt.text, [hunt])
        told = b""
        for key in ("a wrong one", WATCH_KEY):
            with socket.create_connection(("127.0.0.1", port), 20) as watcher:
                watcher.sendall(f'{{"key": "{key}"}}\n{{"request": "Nonsense", "fields": {{}}}}\n'.encode())
                told += watcher.recv(2**16)
        process = Path(f"/proc/{hunt.process.pid}")
        seen = (process / "cmdline").read_bytes() + (process / "environ").read_bytes()
        hunt.process.wait(120)
    finally:
        hunt.close()
    files = [path for path in tmp_path.rglob("*") if path.is_file() and path.parent != keys]
    assert {path.suffix for path in files} >= {".bag", ".tlog", ".html", ".jsonl", ".txt"}
    contents = {path: path.read_bytes() for path in files} | {Path("processes"): seen, Path("told"): told}
    secrets = (WATCH_KEY.encode(), PASSPHRASE.encode(), hashlib.sha256(PASSPHRASE.encode()).digest())
    found = {path for path, content in contents.items() for secret in secrets if secret in content}
    assert not found
