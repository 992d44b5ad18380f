"""Program of another environment: Chromium, killed again and again in a game, and started again with its profile.

Arguments: port of the gateway; number of kills; folder of the profile. It prints a JSON object: `seconds`, the times
from the start of Chromium until the game is shown; `lost`, lines of the history that were not shown again; `lines`, the
number of lines in the end.
"""

import json
import os
import signal
import sys
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By

PATIENCE = 60.0
STATE = """
const lines = [...document.querySelectorAll(".history li")].map((line) => line.textContent);
return document.querySelector(".tile") ? lines : null;
"""


def opened(profile):
    """Start Chromium; return its driver and its process."""
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", f"--user-data-dir={profile}"):
        options.add_argument(flag)
    browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    driver = browser.service.process.pid
    # Any thread of the driver may have started it.
    started = [each.read_text().split() for each in Path(f"/proc/{driver}/task").glob("*/children")]
    return browser, int(next(process for processes in started for process in processes))


def until(what, happened):
    """Wait for something; return it."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        with suppress(WebDriverException):
            if (found := happened()) is not None:
                return found
        time.sleep(0.05)
    raise TimeoutError(what)


def press(browser, selector):
    """Press the first visible button of a selector, if there is one."""
    with suppress(WebDriverException):
        shown = [each for each in browser.find_elements(By.CSS_SELECTOR, selector) if each.is_displayed()]
        if shown:
            shown[0].click()


def lines_of(browser, begins):
    """Return the lines of the history; None before the game is shown. If `begins` is True, leave earlier pages."""
    if begins:
        press(browser, ".reading button.main")
    return browser.execute_script(STATE)


def keeps(cookies):
    """Return True once Chromium has written the cookie to its profile, which takes some time; None before."""
    return True if cookies.exists() and b"thbridge" in cookies.read_bytes() else None


def main():
    port, kills, profile = int(sys.argv[1]), int(sys.argv[2]), Path(sys.argv[3])
    seconds, lost, before = [], [], []
    for number in range(kills + 1):
        began = time.monotonic()
        browser, process = opened(profile)
        browser.get(f"http://127.0.0.1:{port}/")
        after = until("the game", partial(lines_of, browser, number == 0))
        seconds.append(round(time.monotonic() - began, 2))
        lost += [line for line in before if line not in after]
        until("the cookie", partial(keeps, profile / "Default" / "Cookies"))
        press(browser, ".tile")
        time.sleep(1.0)
        press(browser, ".pops .answers button")
        time.sleep(1.0)
        before = lines_of(browser, False)
        os.kill(process, signal.SIGKILL)
        with suppress(Exception):
            browser.service.stop()
    print(json.dumps({"seconds": seconds[1:], "lost": lost, "lines": len(before)}))


main()
