"""Files of the page, read and compressed once. Their addresses contain a digest, so browsers may keep them for ever."""

import base64
import gzip
import hashlib
from pathlib import Path

from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from ui.web.page.theme_css import THEME_CSS

STATIC = Path(__file__).parents[1] / "static"
_KINDS = {".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}
_STYLES = ("page.css", "map.css", "votes.css")
"""Style sheets that are one on the page."""
_DIGEST = 16
_HEADERS = {"Cache-Control": "public, max-age=31536000, immutable", "Vary": "Accept-Encoding"}


class PageFiles:
    """Scripts, style sheets and icon of all pages.

    Attributes:
        root: address of their folder. It changes with any of the files, because the files belong together.
        style: element with the style sheet of the first page.
        policy: content security policy of all pages.
    """

    def __init__(self) -> None:
        self._files = {path.name: path.read_bytes() for path in sorted(STATIC.iterdir()) if path.suffix in _KINDS}
        self._files["page.css"] = THEME_CSS.encode() + b"".join(self._files[name] for name in _STYLES)
        self._compressed = {name: gzip.compress(file, mtime=0) for name, file in self._files.items()}
        digest = hashlib.sha256(b"".join(self._compressed.values())).hexdigest()[:_DIGEST]
        self.root = f"/static/{digest}"
        style = self._files["page.css"]
        # Inside the page, because on a slow line, a file of its own would delay the first text by a round trip.
        self.style = f"<style>{style.decode()}</style>"
        style_digest = base64.b64encode(hashlib.sha256(style).digest()).decode()
        self.policy = (
            "default-src 'none'; script-src 'self'; img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; "
            f"form-action 'none'; frame-ancestors 'none'; style-src 'self' 'sha256-{style_digest}'"
        )

    @property
    def route(self) -> Route:
        """Route of the files."""
        return Route(f"{self.root}/{{name}}", self._answer)

    async def _answer(self, request: Request) -> Response:
        name = request.path_params["name"]
        if name not in self._files:
            raise HTTPException(404)
        kind, headers = _KINDS[Path(name).suffix], _HEADERS
        if "gzip" in request.headers.get("Accept-Encoding", ""):
            return Response(self._compressed[name], headers=headers | {"Content-Encoding": "gzip"}, media_type=kind)
        return Response(self._files[name], headers=headers, media_type=kind)
