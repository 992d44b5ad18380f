"""A ground station of MAVSDK's that reads a robot's files and metadata, and prints what it got as JSON.

Its standard input is one JSON object: `url` to listen at, the number of the `robot`, a `folder` for files, and whether
to download them by `bursts`, once for each. The last line of its output is another: the files that were `listed`, each
of them as it was `downloaded`, whether checksums are `identical`, what may be `written`, and the `metadata` of
parameters.
"""

import asyncio
import json
import os
import sys
import traceback
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from mavsdk import ComponentType, Configuration
from mavsdk.asyncio import Mavsdk
from mavsdk.asyncio.plugins.component_metadata import ComponentMetadataAsync
from mavsdk.asyncio.plugins.ftp import FtpAsync
from mavsdk.plugins.component_metadata import MetadataType
from mavsdk.plugins.ftp import FtpError

PATIENCE = 30.0


async def parameters(updates: AsyncIterator[Any]) -> str:
    """What comes about parameters."""
    async for update in updates:
        if update.type == MetadataType.PARAMETER:
            return str(update.json_metadata)
    raise EOFError


async def plays(orders: dict[str, Any]) -> dict[str, Any]:
    folder = Path(orders["folder"])
    async with Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION)) as mavsdk:
        await mavsdk.add_any_connection(orders["url"])
        while True:
            systems = {await system.get_system_id(): system for system in await mavsdk.get_systems()}
            if orders["robot"] in systems:
                break
            await asyncio.sleep(0.05)
        system = systems[orders["robot"]]
        files = FtpAsync(system)
        told: dict[str, Any] = {"downloaded": [], "identical": []}
        listing = await files.list_directory("/")
        told["listed"] = {entry.name: entry.size_bytes for entry in listing.entries}
        for name in told["listed"]:
            for by_bursts in orders["bursts"]:
                async for _ in files.download(name, str(folder), by_bursts):
                    pass
                told["downloaded"].append((name, (folder / name).read_text()))
                told["identical"].append(await files.are_files_identical(str(folder / name), name))
        try:
            await files.remove_file("general.json")
            told["written"] = "removed"
        except FtpError as error:
            told["written"] = str(error)
        metadata = ComponentMetadataAsync(system)
        updates = metadata.subscribe_metadata_available()
        waiting = asyncio.create_task(parameters(updates))
        await asyncio.sleep(0)
        await metadata.request_autopilot_component()
        told["metadata"] = json.loads(await asyncio.wait_for(waiting, PATIENCE))
        return told


if __name__ == "__main__":
    try:
        print(json.dumps(asyncio.run(plays(json.load(sys.stdin)))), flush=True)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)  # threads of MAVSDK's may wait for ever
