"""People who enter a study by a link: with a code, with parameters of a recruiting service, and with endings."""

import asyncio
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.support.programs.browser_client import BrowserClient
from tests.support.programs.commands import output_of
from tests.support.studies.served_study import served
from tests.support.studies.study_events import data_of
from thbridge.experiment.export.tables import tables_of
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.events import EventKind, LoggedEvent, RunState

STUDY = """\
title: By a link
base: {map: practice, templates: practice, robots: 1, rate: 10, server.port: 0}
quota: 4
recruiting: {RECRUITING}
steps:
  - {step: instructions, text: welcome.txt}
  - {step: consent, text: consent.txt}
  - {step: check, form: check.yaml, name: check}
  - {step: form, form: form.yaml, name: form}
"""
FORM = """\
title: A question
items:
  - {id: why, text: Why?, scale: text}
"""
CHECK = """\
title: A check
items:
  - {id: sum, text: 1 + 1?, scale: choice, options: ['2', '3'], correct: '2'}
"""
CODES = ("first-code-23456789", "other-code-23456789")
PROLIFIC = "?PROLIFIC_PID=5f1a9b7c3d&STUDY_ID=study77aa&SESSION_ID=session88bb"


@pytest.fixture
def study(tmp_path: Path) -> Callable[[str], Path]:
    """Return a function that writes the study with a section `recruiting`, and returns its folder."""

    def write(recruiting: str) -> Path:
        for name in ("welcome", "consent"):
            (tmp_path / f"{name}.txt").write_text(f"This is the text of {name}.\n")
        (tmp_path / "form.yaml").write_text(FORM)
        (tmp_path / "check.yaml").write_text(CHECK)
        (tmp_path / "codes.txt").write_text("\n".join(CODES))
        (tmp_path / "experiment.yaml").write_text(STUDY.replace("{RECRUITING}", recruiting))
        return tmp_path

    return write


async def answered(browser: BrowserClient, item: str, answer: str) -> None:
    """Answer the only item of a form, and continue."""
    await browser.until(lambda: any(each["id"] == item for each in browser.shown.get("items", [])))
    news = {"type": "ItemNews", "page": browser.shown["page"], "item": item, "window_ns": 2, "answer": answer}
    await browser.send({**news, "what": "given"})
    await browser.press_button()


async def consented(browser: BrowserClient, *, agrees: bool) -> None:
    """Begin, read the instructions, and answer the question about consent."""
    await browser.press_button()
    await browser.press_button()
    await browser.until(lambda: browser.shown["t"] == "consent")
    await browser.send({"type": "ConsentReply", "page": browser.shown["page"], "agrees": agrees, "window_ns": 1})


async def finished(browser: BrowserClient, check: str = "2") -> None:
    """Go through the whole study up to its last page."""
    await consented(browser, agrees=True)
    await answered(browser, "sum", check)
    if check == "2":
        await answered(browser, "why", "because")
    await browser.press_button()
    await browser.until(lambda: not browser.shown.get("button"))


def test_a_code_admits_one_person_who_continues_in_another_browser(study: Callable[[str], Path]) -> None:
    folder = study("{codes: codes.txt}")

    async def run() -> None:
        async with served(folder) as (port, conductor):
            first = await BrowserClient.arrived(port, f"?code={CODES[0]}")
            await consented(first, agrees=True)
            await answered(first, "sum", "2")
            await first.until(lambda: first.shown["t"] == "form" and first.shown["heading"] == "A question")
            page = first.shown
            await first.close()
            changed = await BrowserClient.arrived(port, f"?code={CODES[0]}")
            await changed.until(lambda: changed.shown == page)
            await changed.close()
            assert len(conductor.progress.runs) == 1
        async with served(folder) as (port, conductor):
            # The page has removed the code from its address. The browser is known by its cookie.
            back = await BrowserClient.arrived(port, "", changed.cookie)
            await answered(back, "why", "because")
            await back.press_button()
            await back.until(lambda: not back.shown.get("button"))
            (finisher,) = conductor.progress.runs.values()
            assert finisher.state is RunState.COMPLETE
            # The person who loads the page again finds the completion code; no other browser does.
            await back.close()
            again = await BrowserClient.arrived(port, "", back.cookie)
            await again.until(lambda: again.shown.get("code"))
            assert "already been used" in await asyncio.to_thread(BrowserClient(port).load, f"?code={CODES[0]}")
            await again.close()

    asyncio.run(asyncio.wait_for(run(), 120))


def test_the_code_of_a_person_who_withdrew_admits_no_one(study: Callable[[str], Path]) -> None:
    folder = study("{codes: codes.txt}")

    async def run(query: str) -> BrowserClient:
        async with served(folder) as (port, _):
            browser = await BrowserClient.arrived(port, query)
            await consented(browser, agrees=True)
            await browser.close()
        return browser

    async def refused(browser: BrowserClient) -> None:
        async with served(folder) as (port, conductor):
            # In the person's own browser, too.
            for cookie in ("", browser.cookie):
                text = await asyncio.to_thread(BrowserClient(port, cookie).load, f"?code={CODES[0]}")
                assert "already been used" in text
            assert "Please open the study by its link" in await asyncio.to_thread(
                BrowserClient(port, browser.cookie).load
            )
            assert "already been used" not in await asyncio.to_thread(BrowserClient(port).load, f"?code={CODES[1]}")
            assert not conductor.progress.runs

    browser = asyncio.run(asyncio.wait_for(run(f"?code={CODES[0]}"), 120))
    (participant,) = {
        entry.event.participant for entry in ExperimentFolder(folder).entries() if isinstance(entry, LoggedEvent)
    } - {""}
    output_of("study", "withdraw", folder, participant, "--yes")
    asyncio.run(asyncio.wait_for(refused(browser), 120))
    assert all(CODES[0].encode() not in path.read_bytes() for path in (folder / "store").rglob("*") if path.is_file())


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("", "Please open the study by its link"),
        ("?code=third-code-23456789", "does not belong to this study"),
        ("?code=", "Please open the study by its link"),
        (f"?code={CODES[0]}&PROLIFIC_PID=%7B%7B%25PROLIFIC_PID%25%7D%7D", "does not belong to this study"),
    ],
)
def test_a_link_that_admits_no_one_shows_what_to_do_and_writes_nothing(
    study: Callable[[str], Path], query: str, said: str
) -> None:
    folder = study("{codes: codes.txt}")

    async def run() -> None:
        async with served(folder) as (port, conductor):
            browser = BrowserClient(port)
            text = await asyncio.to_thread(browser.load, query)
            assert said in text and "the person who invited you" in text and "<script" not in text
            assert not browser.cookie, "no visit begins"
            assert not conductor.progress.runs

    asyncio.run(asyncio.wait_for(run(), 120))
    assert not ExperimentFolder(folder).entries()
    assert not (folder / "store" / "browsers.json").exists()


def test_an_address_that_tries_many_codes_gets_no_page_for_some_time(study: Callable[[str], Path]) -> None:
    folder = study("{codes: codes.txt}")

    async def run() -> None:
        async with served(folder) as (port, _):
            load = BrowserClient(port).load
            pages = [await asyncio.to_thread(load, f"?code=guessed-code-{number:04}") for number in range(40)]
            assert "does not belong" in pages[0] and "<html" not in pages[-1]
            assert pages[-1] == await asyncio.to_thread(load, f"?code={CODES[0]}"), "a right guess is not recognized"

    asyncio.run(asyncio.wait_for(run(), 120))


def test_parameters_are_in_the_log_and_never_in_an_export(study: Callable[[str], Path]) -> None:
    folder = study("{}")

    async def run() -> None:
        async with served(folder) as (port, conductor):
            first = await BrowserClient.arrived(port, PROLIFIC)
            await consented(first, agrees=True)
            await first.until(lambda: first.shown["t"] == "form")
            page = first.shown
            await first.close()
            second = await BrowserClient.arrived(port, PROLIFIC.replace("session88bb", "session99cc"))
            await second.until(lambda: second.shown == page)
            await second.close()
            assert len(conductor.progress.runs) == 1, "the person's id is the first parameter"

    asyncio.run(asyncio.wait_for(run(), 120))
    (begun,) = data_of(folder, EventKind.RUN_BEGUN)
    assert begun["external_id"] == "5f1a9b7c3d"
    assert begun["parameters"] == {"PROLIFIC_PID": "5f1a9b7c3d", "STUDY_ID": "study77aa", "SESSION_ID": "session88bb"}
    assert begun["front_end"] == "browser"
    tables = tables_of(ExperimentFolder(folder).read(), ExperimentFolder(folder).entries())
    exported = repr([(table.name, table.rows) for table in tables])
    assert "browser" in exported
    assert not [value for value in ("5f1a9b7c3d", "study77aa", "session88bb", "session99cc") if value in exported]


ENDINGS = """\
{endings: {complete: 'https://service.example/done?cc=C1&pid={PROLIFIC_PID}', failed_check: CHECK-CODE,
  declined: 'https://service.example/declined', ended_early: EARLY-CODE, full: 'https://service.example/full?{STUDY_ID}'}}"""


def test_each_ending_has_its_own_address_or_code(study: Callable[[str], Path]) -> None:
    folder = study(ENDINGS.replace("\n", " "))
    text = (folder / "experiment.yaml").read_text()
    (folder / "experiment.yaml").write_text(text.replace("quota: 4", "quota: 1"))

    async def run() -> None:
        async with served(folder) as (port, _):

            async def ending(browser: BrowserClient) -> tuple[str, str]:
                await browser.until(lambda: browser.shown.get("ending"))
                shown = browser.shown["ending"]
                await browser.close()
                return shown["address"], shown.get("code", "")

            declining = await BrowserClient.arrived(port)
            await consented(declining, agrees=False)
            assert await ending(declining) == ("https://service.example/declined", "")
            assert "contact the researchers of this study" in declining.shown["html"], "none is in the room"
            failing = await BrowserClient.arrived(port)
            await finished(failing, check="3")
            assert await ending(failing) == ("", "CHECK-CODE")
            leaving = await BrowserClient.arrived(port)
            await consented(leaving, agrees=True)
            await leaving.send({"type": "StoppedTakingPart"})
            assert await ending(leaving) == ("", "EARLY-CODE")
            completing = await BrowserClient.arrived(port, PROLIFIC)
            await finished(completing)
            assert await ending(completing) == ("https://service.example/done?cc=C1&pid=5f1a9b7c3d", "")
            late = await BrowserClient.arrived(port, PROLIFIC.replace("5f1a9b7c3d", "6f"))
            assert await ending(late) == ("https://service.example/full?study77aa", "")

    asyncio.run(asyncio.wait_for(run(), 120))
