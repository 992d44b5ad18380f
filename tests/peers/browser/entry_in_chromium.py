"""Program of another environment: a person in Chromium who comes by a link, opens a second tab, and leaves by a link.

Arguments: port of the gateway; a code that the study knows. It prints a JSON object: `seen`, what the person saw;
`faults`, what axe-core finds.
"""

import json
import sys

from axe_core_python.selenium import Axe
from selenium import webdriver
from selenium.common.exceptions import StaleElementReferenceException
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

PATIENCE = 60.0
"""Seconds for each step."""


def main(port, code):
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
        options.add_argument(flag)
    browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    seen, faults = {}, []

    def until(happened):
        return WebDriverWait(browser, PATIENCE, 0.1, [StaleElementReferenceException]).until(
            lambda _browser: happened()
        )

    def heading():
        return browser.execute_script("return document.querySelector('h1')?.textContent ?? ''")

    def come_to(wanted):
        until(lambda: heading() == wanted)
        for fault in Axe().run(browser)["violations"]:
            targets = [node["target"] for node in fault["nodes"]][:3]
            faults.append(f"{wanted}: {fault['id']} ({fault['impact']}): {targets}")

    def press(selector="main .main"):
        # A new page ignores presses for a moment, because they were meant for the page before it.
        before = heading()
        until(lambda: heading() != before or browser.find_element(By.CSS_SELECTOR, selector).click())

    try:
        browser.get(f"http://127.0.0.1:{port}/?code=not-a-code-of-this-study")
        come_to("This link does not belong to this study")
        browser.get(f"http://127.0.0.1:{port}/?code={code}&PROLIFIC_PID=pid7")
        come_to("Welcome")
        headings = (
            "window.headings = []; new MutationObserver(() => headings.push(document.querySelector('h1')?.textContent))"
        )
        for _ in range(3):
            browser.refresh()
            browser.execute_script(f"{headings}.observe(document.getElementById('main'), {{childList: true}})")
            come_to("Welcome")
        seen["after reload"] = sorted(set(browser.execute_script("return headings")) - {"Welcome"})
        first = browser.current_window_handle
        browser.switch_to.new_window("tab")
        browser.get(f"http://127.0.0.1:{port}/?code={code}&PROLIFIC_PID=pid7")
        come_to("The study is open in another tab")
        press()
        come_to("Welcome")
        browser.close()
        browser.switch_to.window(first)
        come_to("Welcome")
        press()
        come_to("Please read")
        seen["address"] = browser.execute_script("return location.search")
        browser.refresh()
        come_to("Please read")
        press()
        come_to("Thank you")
        seen["ending"] = browser.find_element(By.CSS_SELECTOR, "a.main").get_attribute("href")
        press("a.main")
        until(lambda: "127.0.0.1" not in browser.current_url)
    finally:
        browser.quit()
    print(json.dumps({"seen": seen, "faults": faults}))


main(*sys.argv[1:])
