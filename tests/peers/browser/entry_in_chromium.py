"""Program of another environment: a person in Chromium who comes by a link, opens a second tab, and leaves by a link.

Arguments: port of the gateway; a code that the study knows. It prints a JSON object: `seen`, what the person saw;
`faults`, what axe-core finds.
"""

import json
import sys

from driven_chromium import DrivenChromium


def main(port, code):
    seen, person = {}, DrivenChromium()
    browser, until = person.browser, person.until

    def heading():
        return person.run("return document.querySelector('h1')?.textContent ?? ''")

    def come_to(wanted):
        until(lambda: heading() == wanted)
        person.judge(wanted)

    def press(selector="main .main"):
        # A new page ignores presses for a moment, because they were meant for the page before it.
        before = heading()
        until(lambda: heading() != before or person.press_first(selector))

    with person:
        browser.get(f"http://127.0.0.1:{port}/?code=not-a-code-of-this-study")
        come_to("This link does not belong to this study")
        browser.get(f"http://127.0.0.1:{port}/?code={code}&PROLIFIC_PID=pid7")
        come_to("Welcome")
        headings = (
            "window.headings = []; new MutationObserver(() => headings.push(document.querySelector('h1')?.textContent))"
        )
        for _ in range(3):
            browser.refresh()
            person.run(f"{headings}.observe(document.getElementById('main'), {{childList: true}})")
            come_to("Welcome")
        seen["after reload"] = sorted(set(person.run("return headings")) - {"Welcome"})
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
        seen["address"] = person.run("return location.search")
        browser.refresh()
        come_to("Please read")
        press()
        come_to("Thank you")
        seen["ending"] = person.shown("a.main")[0].get_attribute("href")
        press("a.main")
        until(lambda: "127.0.0.1" not in browser.current_url)
    print(json.dumps({"seen": seen, "faults": person.faults}))


main(*sys.argv[1:])
