"""Games on another machine of a cluster with TLS: over a network of its own, which is cut in the middle of a game."""

import asyncio
import os
import re
import shutil
import signal
import subprocess
from functools import partial
from pathlib import Path

import pytest

from tests.support.programs.bad_cable import HERE, THERE, BadCable, bad_cable
from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.dask_cluster import dask_cluster
from tests.support.programs.processes import Program, until
from tests.support.studies.served_program import STUDY
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent
from ui.web.pool.running_games import RunningGames, WorkerAddress

pytest.importorskip("distributed")
pytestmark = pytest.mark.slow

TLS = "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=dask -keyout k -out c"


def worker_of(running: RunningGames) -> WorkerAddress | None:
    """Return the worker of the only game; None while it has none."""
    found = [each for key in running if (each := running.address(key)) is not None and each.process]
    return found[0] if found else None


def child_of(server: Program) -> int:
    """Return the process that serves."""
    parent = server.process.pid
    return int(Path(f"/proc/{parent}/task/{parent}/children").read_text().split()[0])


async def in_game(browser: BrowserClient) -> None:
    """Wait until the page of the game is there."""
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"], 200)


async def begin_dialogue(browser: BrowserClient) -> None:
    """Begin a dialogue with the robot."""
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["tiles"][0]["choose"]["act"])
    await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])


async def leave_dialogue(browser: BrowserClient) -> None:
    """Put the dialogue with the robot aside."""
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["dialogue"]["aside"]["act"])
    await browser.until(lambda: browser.tree["dialogue"] is None)


def test_a_game_on_a_machine_that_vanishes_goes_on_on_another_one(tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (study / "welcome.txt").write_text("You play one game.\n")
    (study / "experiment.yaml").write_text(STUDY.format(quota=9, seconds=3000))
    subprocess.run(["openssl", *TLS.split()], cwd=tmp_path, check=True, capture_output=True)
    (tmp_path / "k").chmod(0o600)
    running = RunningGames.of(study)
    files = {"CA_FILE": "c", "CLIENT__CERT": "c", "CLIENT__KEY": "k"}
    environment = {f"DASK_DISTRIBUTED__COMM__TLS__{key}": str(tmp_path / name) for key, name in files.items()}
    security = ("--tls-ca-file", "c", "--tls-cert", "c", "--tls-key", "k")

    async def play(cable: BadCable, server: Program) -> None:
        found = re.search(rf"Open http://{HERE}:(\d+)/", server.text)
        assert found is not None, server.text
        port = int(found[1])
        browser = BrowserClient(port, host=HERE, dial=partial(cable.dial, port, far=False))
        await asyncio.to_thread(browser.load)
        await browser.open()
        await browser.press_button()
        await browser.press_button()
        await in_game(browser)
        worker = worker_of(running)
        assert worker is not None
        assert worker.host == THERE
        assert worker.socket.startswith("tls://")
        await begin_dialogue(browser)
        title = browser.tree["dialogue"]["title"]

        # Another server process finds the game on the other machine.
        os.kill(child_of(server), signal.SIGKILL)
        await browser.come_back(port)
        await in_game(browser)
        assert browser.tree["dialogue"]["title"] == title
        assert worker_of(running) == worker

        # A break of the network that is shorter than the patience of both ends.
        cable.set(cut=True)
        await asyncio.sleep(5.0)
        cable.set()
        await leave_dialogue(browser)
        assert worker_of(running) == worker

        # The other machine vanishes. The game waits until its process there has surely ended.
        cluster.join("--nthreads", "1", "--host", HERE, by=cable.here_by)
        before = browser.whole_pages
        cable.set(cut=True)
        await browser.until(lambda: browser.whole_pages > before, 200.0)
        await in_game(browser)
        other = worker_of(running)
        assert other is not None
        assert other.host == HERE
        # What was said is in the log of inputs; that the person had put the dialogue aside is not.
        assert browser.tree["dialogue"]["title"] == title
        await leave_dialogue(browser)
        await browser.end_game()
        await browser.until(lambda: browser.shown.get("button") == "Finish")
        await browser.close()

    with bad_cable() as cable, dask_cluster(tmp_path, *security) as cluster:
        cluster.schedule("--protocol", "tls", "--host", HERE, by=cable.here_by)
        address = cluster.address
        (tmp_path / "far").mkdir()
        far = (*cable.there_by, "env", f"TMPDIR={tmp_path / 'far'}")
        cluster.join("--nthreads", "1", "--host", THERE, by=far)
        options = ("--host", HERE, "--port", "0", "--open-to", "10.9.0.0/24", "--games", "0", "--scheduler", address)
        server = Program(tmp_path, "serve", "study", *options, environment=environment | os.environ, by=cable.here_by)
        try:
            until("the server", lambda: "Open http" in server.text or server.process.poll() is not None, [server])
            asyncio.run(asyncio.wait_for(play(cable, server), 280))
            server.stop()
        finally:
            server.close()
            shutil.rmtree(running.folder)
    events = [entry.event for entry in ExperimentFolder(study).entries() if isinstance(entry, LoggedEvent)]
    kinds = [event.kind for event in events]
    assert kinds.count(EventKind.GAME_PLAYED) == 1
    assert EventKind.GAME_BROKEN_OFF not in kinds
    (played,) = (event.data["bag"] for event in events if event.kind == EventKind.GAME_PLAYED)
    assert (study / str(played)).exists()
