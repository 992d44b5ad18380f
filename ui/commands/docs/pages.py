"""Pages of the documentation, from the installed package or from the folder docs of a checkout."""

import difflib
import os
import re
import shlex
import shutil
import subprocess
import sys
import webbrowser
from collections.abc import Collection, Mapping
from contextlib import suppress
from html import escape
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token
from rich.markdown import Markdown
from rich.pager import Pager

from sim.numerics.compiled_files import cache_folder
from thbridge.files.disk.whole import whole_file
from thbridge.files.errors import BadFile
from thbridge.files.resources import shipped
from ui.command_line.terminal import command, note, out, say

WIDEST = 120
"""Maximum number of characters in a line of a page on a terminal."""
_STYLE = "body{max-width:60em;margin:2em auto;padding:0 1em;font:16px/1.5 sans-serif}table{border-collapse:collapse}\
td,th{border:1px solid #ccc;padding:.2em .5em;vertical-align:top}pre{overflow-x:auto;background:#f4f4f4;padding:1em}\
img{max-width:100%}"


def pages() -> Mapping[str, Path]:
    """Return all pages by their names, such as `sweeps` and `0001-dependencies`."""
    found = sorted((shipped().root / "docs").rglob("*.md"))
    return {path.stem: path for path in found if path.stem != "index"}


def list_pages() -> None:
    """Print the names and titles of all pages."""
    titles = {name: _title(path) for name, path in pages().items()}
    width = max(map(len, titles))
    for name, title in titles.items():
        say(f"{name:{width}}  {title}")
    note(f"Show a page with `{command('docs', 'PAGE')}`, or in a browser with `{command('docs', 'PAGE', '--open')}`.")


def find_page(wanted: str) -> Path:
    """Return the file of a page, given its name or path: `sweeps`, `sweeps.md`, `docs/how-to/sweeps.md#plots`.

    Raises:
        BadFile: there is no such page.
    """
    known = pages()
    name = wanted.partition("#")[0].rpartition("/")[2].removesuffix(".md")
    if name in known:
        return known[name]
    near = difflib.get_close_matches(name, known, n=1)
    remedy = f"A similar name is {near[0]}" if near else f"`{command('docs')}` lists all pages"
    raise BadFile(Path(wanted), "there is no page of this name", remedy)


def show_page(page: Path) -> None:
    """Print a page: with layout on a terminal (in a pager if one is installed), otherwise as plain Markdown."""
    text = page.read_text(encoding="utf-8")
    if not out.is_terminal:
        print(text, end="")  # noqa: T201 - for other programs
        return
    laid_out = Markdown(text, hyperlinks=False)
    words = _pager()
    if words is None:
        out.print(laid_out, width=min(out.width, WIDEST))
        return
    with out.pager(_ProgramPager(words), styles=True):
        out.print(laid_out, width=min(out.width, WIDEST))


def open_in_browser(page: Path | None) -> None:
    """Open a page, or the list of all pages, in a browser; print the path of the opened file.

    Raises:
        BadFile: the files for the browser cannot be written.
    """
    root = shipped().root / "docs"
    folder = cache_folder().parent / "docs"
    written = {path: path.relative_to(root).with_suffix(".html") for path in pages().values()}
    links = "".join(f"* [{_title(path)}]({path.relative_to(root)})\n" for path in written)
    resolved = {path.resolve() for path in written}
    files = {Path("index.html"): _html(f"# thbridge\n{links}", root, resolved)}
    files |= {name: _html(path.read_text(encoding="utf-8"), path.parent, resolved) for path, name in written.items()}
    for name, text in files.items():
        with whole_file(folder / name, folders=True, synced=False) as file:
            file.write(text.encode())
    target = folder / (Path("index.html") if page is None else written[page])
    opened = False
    with suppress(webbrowser.Error):
        opened = webbrowser.open(target.as_uri())
    say(str(target))
    if not opened:
        note("No browser could be opened. Open this file in a browser, or omit --open.")


class _ProgramPager(Pager):
    """System program that shows a text page by page."""

    def __init__(self, words: list[str]) -> None:
        self._words = words

    def show(self, content: str) -> None:
        """Show a text until the program ends."""
        # Options for less: exit at once if the text fits, show colors, and leave the text on the screen.
        environment = {"LESS": "FRX", **os.environ}
        with subprocess.Popen(self._words, stdin=subprocess.PIPE, text=True, env=environment) as program:
            try:
                program.communicate(content)
            except KeyboardInterrupt:
                # Ctrl-C is for the pager, which keeps running.
                program.communicate()


def _pager() -> list[str] | None:
    """Return the command of the pager; None if no pager can be used."""
    if not sys.stdin.isatty() or os.environ.get("TERM", "dumb") == "dumb":
        return None
    words = shlex.split(os.environ.get("PAGER") or "less")
    return words if words and shutil.which(words[0]) else None


def _title(page: Path) -> str:
    return _title_in(page.read_text(encoding="utf-8"))


def _title_in(text: str) -> str:
    return text.partition("\n")[0].removeprefix("#").strip()


def _html(text: str, folder: Path, resolved: Collection[Path]) -> str:
    """Return a page as HTML; its links lead to the HTML files of other pages."""
    parser = MarkdownIt("commonmark").enable("table")
    tokens = parser.parse(text)
    for heading, words in pairwise(tokens):
        if heading.type == "heading_open":
            heading.attrSet("id", _anchor(words.content))
    for token in tokens:
        for inner in token.children or ():
            _redirect(inner, folder, resolved)
    title, body = escape(_title_in(text)), parser.renderer.render(tokens, parser.options, {})
    return f'<!doctype html><meta charset="utf-8"><title>{title}</title><style>{_STYLE}</style>\n{body}'


def _redirect(token: Token, folder: Path, resolved: Collection[Path]) -> None:
    """Change a link to a page into a link to its HTML file, and a link to another file into its path."""
    name = {"link_open": "href", "image": "src"}.get(token.type)
    target = str(token.attrGet(name)) if name else ""
    if name is None or target.startswith(("#", "http:", "https:")):
        return
    path, mark, anchor = target.partition("#")
    linked = (folder / path).resolve()
    if linked in resolved:
        token.attrSet(name, f"{path.removesuffix('.md')}.html{mark}{anchor}")
    elif linked.exists():
        token.attrSet(name, linked.as_uri())


def _anchor(heading: str) -> str:
    """Return the anchor of a heading, in the form that GitHub uses."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
