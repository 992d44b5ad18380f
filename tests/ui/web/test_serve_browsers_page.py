"""docs/how-to/serve-browsers.md works: its commands lead a browser to the first hunt."""

import asyncio
import importlib
import re
from contextlib import suppress
from importlib.metadata import distribution, requires
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.processes import Program, run_thbridge, until
from tests.support.project import ROOT

PAGE = (ROOT / "docs" / "how-to" / "serve-browsers.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^(pip install .*|thbridge .*?) *(?:#.*)?$", PAGE, re.MULTILINE)[:6]
"""Commands of the first two sections; the others need another machine, or a server that runs."""
MODULES = {"markdown-it-py": "markdown_it"}
"""Packages whose module has another name."""


def test_the_page_has_these_commands() -> None:
    assert COMMANDS == [
        "pip install 'thbridge[web]'",
        "thbridge serve",
        "thbridge study init my-study.yaml",
        "thbridge serve my-study.yaml",
        "thbridge study new my-study-folder",
        "thbridge serve my-study-folder",
    ]


def test_the_extra_of_the_page_exists_and_its_packages_are_installed() -> None:
    (extra,) = re.findall(r"thbridge\[(\w+)\]", COMMANDS[0])
    assert extra in distribution("thbridge").metadata.get_all("Provides-Extra", ())
    needed = [Requirement(text) for text in requires("thbridge") or ()]
    of_extra = [each for each in needed if each.marker is not None and each.marker.evaluate({"extra": extra})]
    of_extra = [each for each in of_extra if not each.marker or not each.marker.evaluate({"extra": ""})]
    assert {"starlette", "uvicorn", "websockets"} <= {each.name for each in of_extra}
    for each in of_extra:
        assert each.specifier.contains(distribution(each.name).version), each
        importlib.import_module(MODULES.get(each.name, each.name.replace("-", "_")))


@pytest.mark.parametrize(
    "served",
    [
        "",
        pytest.param("my-study.yaml", marks=pytest.mark.slow),
        pytest.param("my-study-folder", marks=pytest.mark.slow),
    ],
)
def test_the_commands_lead_a_browser_to_the_first_hunt(served: str, tmp_path: Path) -> None:
    command = f"thbridge serve {served}".strip()
    for before in COMMANDS[1 : COMMANDS.index(command)]:
        if not before.startswith("thbridge serve"):
            done = run_thbridge(tmp_path, *before.split()[1:])
            assert done.returncode == 0, done.stderr
    # Port 8080 of the page may be taken on the machine of the test.
    server = Program(tmp_path, *command.split()[1:], "--port", "0")
    try:
        until("the address", lambda: "Open http" in server.text or server.process.poll() is not None, [server])
        port = int(re.findall(r"Open http://127\.0\.0\.1:(\d+)/ in a browser", server.text)[0])
        asyncio.run(asyncio.wait_for(reach_first_hunt(port), 240))
    finally:
        server.stop()
        server.close()


async def reach_first_hunt(port: int) -> None:
    """Press the main button of each page, and agree, until a robot asks whether it should go to a room."""
    browser = BrowserClient(port)
    await asyncio.to_thread(browser.load)
    await browser.open()
    for number in range(100):
        await browser.until(lambda wanted=number: len(browser.study) > wanted, 120)
        message = browser.study[number]
        if message["t"] == "game":
            break
        if message["t"] == "consent":
            await browser.send({"type": "ConsentReply", "page": message["page"], "agrees": True, "window_ns": 1})
        elif message["t"] == "text":
            await browser.send({"type": "WentOn", "page": message["page"]})
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"], 120)
    for _ in range(60):
        # A game ignores presses in the moment after something new has appeared.
        await browser.act(browser.tree["tiles"][0]["choose"]["act"])
        with suppress(TimeoutError):
            await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"], 2)
            break
    assert browser.tree["dialogue"]["choices"]
    await browser.close()
