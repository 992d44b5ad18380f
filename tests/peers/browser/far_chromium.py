"""Program of another environment: a person in Chromium on another machine, who does what the lines of the input say.

Argument: address of the page. Lines: "begin", "rules" (open or close the rules), "state", "quit". After each line it
prints a JSON object: `rules`, True if the rules are open; `lost`, True if the page reports a lost connection; `cookie`,
the cookie of the server.
"""

import json
import sys
import time
from contextlib import suppress

from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

STATE = """
return { rules: !!document.querySelector("dialog.help")?.open, lost: !document.getElementById("connection").hidden };
"""


def pressed(browser, selector):
    """Press the first visible and possible button of a selector; return False if there is none."""
    with suppress(WebDriverException):
        for each in browser.find_elements(By.CSS_SELECTOR, selector):
            if each.is_displayed() and each.get_attribute("aria-disabled") != "true":
                each.click()
                return True
    return False


def begin(browser):
    """Go on from all pages until the game is shown."""
    while not browser.find_elements(By.CSS_SELECTOR, ".tile"):
        pressed(browser, ".reading button.main")
        time.sleep(0.1)


def main():
    options = Options()
    options.binary_location = "/usr/bin/chromium"
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1280,800"):
        options.add_argument(flag)
    browser = webdriver.Chrome(options=options, service=Service("/usr/bin/chromedriver"))
    try:
        browser.get(sys.argv[1])
        for line in sys.stdin:
            match line.strip():
                case "begin":
                    begin(browser)
                case "rules":
                    browser.switch_to.active_element.send_keys(Keys.F1)
                case "quit":
                    break
            cookies = [f"{each['name']}={each['value']}" for each in browser.get_cookies()]
            print(json.dumps({**browser.execute_script(STATE), "cookie": "; ".join(cookies)}), flush=True)
    finally:
        browser.quit()


main()
