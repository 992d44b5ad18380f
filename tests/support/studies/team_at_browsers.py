"""A game with three seats, and people in browsers who play it."""

import asyncio
from pathlib import Path

from tests.support.programs.browser_client import BrowserClient
from thbridge.study.study_file import Study, read_study_text

TEAM_TEXT = """\
map: practice
templates: practice
robots: 2
rate: 10
server: {port: 0}
seats:
  - {name: north, label: the north, robots: [1], names_treasures: false, sees_dialogues: own}
  - {name: south, label: the south, robots: [2], sees_dialogues: own}
  - {name: judge, label: the judge, sees_dialogues: own, sees_energy: false, sees_map: false, sees_score: false}
team: {agreement: {end: one}}
"""
END = {"act": "EndGameAct"}
SEATS = ("north", "south", "judge")
TEAM: Study = read_study_text(Path("team.yaml"), TEAM_TEXT)


async def waiting(port: int) -> BrowserClient:
    """Return a browser whose person has read the rules, and waits for others."""
    browser = await BrowserClient.arrived(port)
    await browser.press_button()
    await browser.until(lambda: browser.shown["t"] in {"turn", "wait", "game"})
    return browser


async def playing(browser: BrowserClient) -> None:
    """Wait until the page of the game is complete."""
    await browser.until(lambda: browser.tree.get("phase") == "playing" and browser.tree["tiles"], 120)


def own_robots(browser: BrowserClient) -> list[int]:
    """Return the numbers of the robots that the person commands."""
    return [card["number"] for card in browser.tree["cards"] if card["commander"] == "You"]


def seat_of(browser: BrowserClient) -> str:
    """Return the seat of a person, which their page shows by the robots that they command."""
    return {(1,): "north", (2,): "south", (): "judge"}[tuple(own_robots(browser))]


async def seated(port: int) -> dict[str, BrowserClient]:
    """Return the browsers of three people who play, by their seats."""
    people = await asyncio.gather(*(waiting(port) for _ in SEATS))
    await asyncio.gather(*map(playing, people))
    team = {seat_of(browser): browser for browser in people}
    assert {*team} == {*SEATS}
    return team


async def talk(browser: BrowserClient) -> str:
    """Ask the person's robot to go to a room; return its answer."""
    (number,) = own_robots(browser)
    await asyncio.sleep(0.4)  # Answers right after a change of the page are not accepted.
    await browser.act({"act": "ChooseRobot", "robot": number - 1})
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["tiles"][number - 1]["choose"]["act"])
    await browser.until(lambda: browser.tree["dialogue"] and browser.tree["dialogue"]["choices"])
    return str(browser.tree["dialogue"]["sentences"][-1]["text"])


async def end(browser: BrowserClient) -> None:
    """End the game for all."""
    await asyncio.sleep(0.4)
    if browser.tree["dialogue"]:
        await browser.act(browser.tree["dialogue"]["aside"]["act"])
        await browser.until(lambda: browser.tree["dialogue"] is None)
        await asyncio.sleep(0.4)
    # Robots of other seats must have arrived.
    await browser.until(lambda: any(each["act"] == END and each["enabled"] for each in browser.tree["tools"]))
    await browser.act(END)
    await browser.until(lambda: browser.tree["question"])
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["question"]["buttons"][0]["act"])


async def go_on(browser: BrowserClient) -> None:
    """Continue after the game, and wait for the last page."""
    await browser.until(lambda: browser.tree.get("ending"))
    await asyncio.sleep(0.4)
    await browser.act(browser.tree["ending"]["buttons"][0]["act"])
    await browser.until(lambda: browser.shown["heading"] == "Thank you")
