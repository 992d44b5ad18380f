"""The researcher's program beside a study, without its window: `python -m tests.system.study.watcher FOLDER LEDGER`.

It reads the log as the desk does. At each change it writes how many events it knows, a digest of them, and troubles.
"""

import hashlib
import json
import os
import sys
import time
from pathlib import Path

from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import LogFollower
from thbridge.timing.wall_clock import utc_now
from ui.sources.experiment import ExperimentSource


def main(folder: ExperimentFolder, ledger: Path) -> None:
    source, follower = ExperimentSource(folder, utc_now), LogFollower(folder.log)
    file, known, digest = os.open(ledger, os.O_WRONLY | os.O_APPEND | os.O_CREAT), 0, hashlib.sha256()
    while True:
        source.poll()
        if follower.poll():
            for entry in follower.entries[known:]:
                digest.update(repr(entry).encode())
            known = len(follower.entries)
            line = {"known": known, "digest": digest.hexdigest(), "troubles": source.state("").troubles}
            os.write(file, json.dumps(line).encode() + b"\n")
        time.sleep(0.05)


if __name__ == "__main__":
    main(ExperimentFolder(Path(sys.argv[1])), Path(sys.argv[2]))
