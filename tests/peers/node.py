"""Node.js, in which programs of others run that tests play against; scripts/install_peers.sh installs it."""

from pathlib import Path

import pytest

from tests.support.programs.peer_programs import run_peer

FOLDER = Path(__file__).parents[2] / ".peers" / "scripts"
NEEDS_NODE = pytest.mark.skipif(
    not (FOLDER / "installed").exists(), reason="Node.js is not installed (see scripts/install_peers.sh)"
)


def run_script(text: str, *arguments: str, seconds: float = 120.0) -> str:
    """Run an ES module, which may import what is installed, and return what it prints."""
    # A module that comes by standard input finds packages as one of the working folder.
    command = (str(FOLDER / "node"), "--input-type=module", "-", *arguments)
    done = run_peer(command, cwd=FOLDER, input=text, timeout=seconds)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
