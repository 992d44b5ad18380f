"""Program of another environment: two people and a researcher in Chromium.

Arguments: port of the gateway; key of the researcher; folder for pictures. It prints a JSON object: `seen`, what people
and researcher saw; `faults`, what axe-core finds; `errors`, errors of the browsers' consoles.
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
REASON = "asked <svg onload='pwned = 1'> a friend"
MESSAGE = '<img src=x onerror="window.pwned = 1">Please continue.'


class Chromium:
    """Browser of one person."""

    def __init__(self, port):
        options = Options()
        options.binary_location = "/usr/bin/chromium"
        for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
        self.at = f"http://127.0.0.1:{port}/"
        self.faults = []

    def until(self, happened):
        return WebDriverWait(self.browser, PATIENCE, 0.1, [StaleElementReferenceException]).until(
            lambda _browser: happened()
        )

    def text(self, selector):
        return "".join(each.text for each in self.browser.find_elements(By.CSS_SELECTOR, selector))

    def judge(self, name):
        for fault in Axe().run(self.browser)["violations"]:
            targets = [node["target"] for node in fault["nodes"]][:3]
            self.faults.append(f"{name}: {fault['id']} ({fault['impact']}): {targets}")

    def press(self, selector):
        self.browser.find_element(By.CSS_SELECTOR, selector).click()

    def begin(self):
        self.browser.get(self.at)
        self.until(lambda: self.text("main h1") == "Welcome")
        # A new page ignores presses for a moment.
        self.until(lambda: "Read this." in self.text("main") or self.press("main .main"))

    def size(self, width, height, look):
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        feature = {"features": [{"name": "prefers-color-scheme", "value": look}]}
        self.browser.execute_cdp_cmd("Emulation.setEmulatedMedia", feature)

    @property
    def errors(self):
        return [entry["message"] for entry in self.browser.get_log("browser") if entry["level"] == "SEVERE"]


def main(port, key, folder):
    seen, person, other = {}, Chromium(port), Chromium(port)
    try:
        person.begin()
        other.begin()
        theirs = other.browser.current_window_handle
        desk = other
        desk.browser.switch_to.new_window("tab")
        desk.browser.get(f"{desk.at}desk#{key}")
        people = "#tables section:first-child tbody tr"
        desk.until(lambda: len(desk.browser.find_elements(By.CSS_SELECTOR, people)) == 2)
        seen["address"] = desk.browser.execute_script("return location.href").removeprefix(desk.at)
        seen["cookie"] = desk.browser.execute_script("return document.cookie")
        for width, height in ((1280, 800), (390, 844)):
            for look in ("light", "dark"):
                desk.size(width, height, look)
                desk.judge(f"desk {width} {look}")
                desk.browser.save_screenshot(f"{folder}/desk-{width}-{look}.png")
                wide = "return document.documentElement.scrollWidth > innerWidth"
                if desk.browser.execute_script(wide):
                    desk.faults.append(f"desk {width} {look}: wider than the window")
        desk.size(1280, 800, "light")
        cells = desk.browser.find_elements(By.CSS_SELECTOR, f"{people}:first-child > *")
        seen["cells"] = sum(cell.is_displayed() for cell in cells)
        # The run that began last is the first row.
        rows = [each.get_attribute("data-key") for each in desk.browser.find_elements(By.CSS_SELECTOR, people)]
        seen["people"] = rows
        desk.press(f"tr[data-key='{rows[1]}'] button[aria-label^='Message']")
        desk.judge("dialog")
        desk.browser.save_screenshot(f"{folder}/desk-dialog.png")
        desk.browser.find_element(By.CSS_SELECTOR, "dialog textarea").send_keys(MESSAGE)
        desk.press("dialog .main")
        person.until(lambda: person.text("#message p"))
        seen["message"] = person.text("#message p")
        seen["still reads"] = "Read this." in person.text("main")
        person.judge("message")
        person.press("#message button")
        seen["closed"] = not person.text("#message")
        desk.until(lambda: "Read" in desk.text("#tables section:last-child tbody"))
        desk.press(f"tr[data-key='{rows[0]}'] button[aria-label^='Exclude']")
        desk.browser.find_element(By.CSS_SELECTOR, "dialog textarea").send_keys(REASON)
        desk.press("dialog .main")
        desk.until(lambda: REASON in desk.text(f"tr[data-key='{rows[0]}']"))
        foreign = "return document.querySelectorAll('img[src=x], [onload], main script').length"
        seen["foreign"] = [each.browser.execute_script(foreign) for each in (person, desk)]
        seen["pwned"] = [each.browser.execute_script("return window.pwned ?? null") for each in (person, desk)]
        other.browser.switch_to.window(theirs)
        other.until(lambda: other.text("main h1") == "The study ends here")
        other.judge("excluded")
        seen["other reads"] = "Read this." in person.text("main")
        errors = person.errors + other.errors
    finally:
        person.browser.quit()
        other.browser.quit()
    print(json.dumps({"seen": seen, "faults": person.faults + other.faults, "errors": errors}))


main(*sys.argv[1:])
