"""A study that is served to browsers in this process."""

import asyncio
import secrets
import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from pathlib import Path

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.recruiting import link_codes
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import ExperimentLog
from ui.hosting.kiosk.pages import WindowOfKiosk
from ui.web.gateway.serving import ServerOptions, serve_study
from ui.web.gateway.study_visits import VisitClock
from ui.web.pool.running_games import RunningGames


@asynccontextmanager
async def served(
    folder: Path,
    running: RunningGames | None = None,
    window: WindowOfKiosk | None = None,
    reported: list[str] | None = None,
    **changes: object,
) -> AsyncIterator[tuple[int, Conductor]]:
    """Serve the study in a folder; yield the port and the conductor. Games outlive the server if `running` is given.

    `window` is the window on this machine, if there is one. `reported` receives sentences about problems; if None,
    there must be none. `changes` are changes of the gateway's options.
    """
    place, clock = ExperimentFolder(folder), VisitClock()
    design = place.read()
    codes = link_codes(design.file.recruiting, folder)
    place.log.parent.mkdir(exist_ok=True)
    with ExperimentLog(place.log, synced=False) as log:
        conductor = Conductor(design, log, clock, secrets.randbelow)
        listening, ready = socket.create_server(("127.0.0.1", 0)), asyncio.Event()
        options = ServerOptions(listening, 2, None, ready.set, running=running)
        options = replace(options, **changes)  # type: ignore[arg-type]
        problems: list[str] = [] if reported is None else reported
        serving = asyncio.create_task(
            serve_study(place, design, conductor, clock, problems.append, options, codes, window)
        )
        await asyncio.wait([serving, asyncio.create_task(ready.wait())], return_when=asyncio.FIRST_COMPLETED)
        try:
            yield listening.getsockname()[1], conductor
        finally:
            serving.cancel()
            with suppress(asyncio.CancelledError):
                await serving
        assert reported is not None or not problems
