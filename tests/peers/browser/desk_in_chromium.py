"""Program of another environment: two people and a researcher in Chromium.

Arguments: port of the gateway; key of the researcher; folder for pictures. It prints a JSON object: `seen`, what people
and researcher saw; `faults`, what axe-core finds; `errors`, errors of the browsers' consoles.
"""

import json
import sys

from driven_chromium import DrivenChromium

REASON = "asked <svg onload='pwned = 1'> a friend"
MESSAGE = '<img src=x onerror="window.pwned = 1">Please continue.'

LINES_OF_CODES = r"""
  return [...document.querySelectorAll("td")].filter((cell) => /^P-\S+$/.test(cell.textContent)).map((cell) => {
    cell.style.cssText = "display: block; width: 2rem; min-width: 0";
    const words = document.createRange();
    words.selectNodeContents(cell);
    return words.getClientRects().length;
  });
"""


class Visitor(DrivenChromium):
    """Browser of one person, who comes to the gateway at a port."""

    def __init__(self, port):
        super().__init__()
        self.at = f"http://127.0.0.1:{port}/"

    def begin(self):
        self.browser.get(self.at)
        self.until(lambda: self.text("main h1") == "Welcome")
        # A new page ignores presses for a moment.
        self.until(lambda: "Read this." in self.text("main") or self.press_first("main .main"))


def main(port, key, folder):
    seen = {}
    with Visitor(port) as person, Visitor(port) as other:
        person.begin()
        other.begin()
        theirs = other.browser.current_window_handle
        desk = other
        desk.browser.switch_to.new_window("tab")
        desk.browser.get(f"{desk.at}desk#{key}")
        people = "#tables section:first-child tbody tr"
        desk.until(lambda: len(desk.shown(people)) == 2)
        seen["address"] = desk.run("return location.href").removeprefix(desk.at)
        seen["cookie"] = desk.run("return document.cookie")
        for width, height in ((1280, 800), (390, 844)):
            for look in ("light", "dark"):
                desk.resize(width, height, look)
                desk.judge(f"desk {width} {look}")
                desk.browser.save_screenshot(f"{folder}/desk-{width}-{look}.png")
        desk.resize(1280, 800, "light")
        seen["cells"] = len(desk.shown(f"{people}:first-child > *"))
        # The run that began last is the first row.
        rows = [each.get_attribute("data-key") for each in desk.shown(people)]
        seen["people"] = rows
        desk.press_first(f"tr[data-key='{rows[1]}'] button[aria-label^='Message']")
        desk.judge("dialog")
        desk.browser.save_screenshot(f"{folder}/desk-dialog.png")
        desk.shown("dialog textarea")[0].send_keys(MESSAGE)
        desk.press_first("dialog .main")
        person.until(lambda: person.text("#message p"))
        seen["message"] = person.text("#message p")
        seen["still reads"] = "Read this." in person.text("main")
        person.judge("message")
        person.press_first("#message button")
        seen["closed"] = not person.text("#message")
        desk.until(lambda: "Read" in desk.text("#tables section:last-child tbody"))
        seen["lines of codes"] = desk.run(LINES_OF_CODES)
        desk.press_first(f"tr[data-key='{rows[0]}'] button[aria-label^='Exclude']")
        desk.shown("dialog textarea")[0].send_keys(REASON)
        desk.press_first("dialog .main")
        desk.until(lambda: REASON in desk.text(f"tr[data-key='{rows[0]}']"))
        foreign = "return document.querySelectorAll('img[src=x], [onload], main script').length"
        seen["foreign"] = [each.run(foreign) for each in (person, desk)]
        seen["pwned"] = [each.run("return window.pwned ?? null") for each in (person, desk)]
        other.browser.switch_to.window(theirs)
        other.until(lambda: other.text("main h1") == "The study ends here")
        other.judge("excluded")
        seen["other reads"] = "Read this." in person.text("main")
        errors = person.errors + other.errors
    print(json.dumps({"seen": seen, "faults": person.faults + other.faults, "errors": errors}))


main(*sys.argv[1:])
