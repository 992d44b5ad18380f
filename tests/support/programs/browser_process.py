"""Browser as a process of its own, which can be killed: `python -m tests.support.programs.browser_process`.

Arguments: port and cookie. It opens and closes the rules of the game again and again, once its input has a line. It
prints a line of JSON for each state of the page: `rules`, True if they are open; `history`, the lines of the history.
"""

import asyncio
import json
import sys

from tests.support.programs.browser_client import BrowserClient


async def main(port: int, cookie: str) -> None:
    """Open and close the rules until the process is killed."""
    browser = await BrowserClient.arrived(port, cookie=cookie)
    await browser.until(lambda: browser.tree.get("tiles"))
    begun = False
    while True:
        rules = bool(browser.tree["rules"])
        print(json.dumps({"rules": rules, "history": [line["text"] for line in browser.tree["history"]]}), flush=True)
        if not begun:
            begun = bool(await asyncio.to_thread(sys.stdin.readline))
        await browser.press("F1")
        await browser.until(lambda before=rules: bool(browser.tree["rules"]) != before)


if __name__ == "__main__":
    asyncio.run(main(int(sys.argv[1]), sys.argv[2]))
