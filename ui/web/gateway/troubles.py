"""Reports of browsers that their page cannot go on."""

from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response

from ui.web.gateway.limits import RefusalLog

LONGEST = 4096
"""Greatest size of a report in bytes; a longer one is refused."""
_SHOWN = 600
"""Characters of a report that are printed."""

_MOST = 1000
"""Number of reports after which no further report is printed."""


class PageTroubles:
    """Reports of browsers. The first report of each browser is printed.

    Args:
        log: log of problems with clients.
    """

    def __init__(self, log: RefusalLog) -> None:
        self._log = log
        self._heard: set[str] = set()

    async def receive(self, request: Request, secret: str) -> Response:
        """Print the report of the browser with this secret; its further reports are ignored."""
        if secret not in self._heard and len(self._heard) < _MOST:
            text = b""
            try:
                async for part in request.stream():
                    text += part
                    if len(text) > LONGEST:
                        return Response(status_code=413)
            except ClientDisconnect:
                return Response(status_code=400)
            self._heard.add(secret)
            # Untrusted text: in one line, and with escape sequences shown as such.
            self._log.warn(f"The page of a browser cannot go on: {text.decode(errors='replace')[:_SHOWN]!r}")
        return Response(status_code=204)
