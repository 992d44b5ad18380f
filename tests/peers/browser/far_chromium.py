"""Program of another environment: a person in Chromium on another machine, who does what the lines of the input say.

Argument: address of the page. Lines: "begin", "rules" (open or close the rules), "state", "quit". After each line it
prints a JSON object: `rules`, True if the rules are open; `lost`, True if the page reports a lost connection; `cookie`,
the cookie of the server.
"""

import json
import sys
import time
from contextlib import suppress

from driven_chromium import CHANGES, DrivenChromium

STATE = """
return { rules: !!document.querySelector("dialog.help")?.open, lost: !document.getElementById("connection").hidden };
"""


def begin(person):
    """Go on from all pages until the game is shown."""
    while not person.shown(".tile"):
        with suppress(*CHANGES):
            person.press_first(".reading button.main")
        time.sleep(0.1)


def main():
    with DrivenChromium() as person:
        person.browser.get(sys.argv[1])
        for line in sys.stdin:
            match line.strip():
                case "begin":
                    begin(person)
                case "rules":
                    person.press_key("F1")
                case "quit":
                    break
            cookies = [f"{each['name']}={each['value']}" for each in person.browser.get_cookies()]
            print(json.dumps({**person.run(STATE), "cookie": "; ".join(cookies)}), flush=True)


main()
