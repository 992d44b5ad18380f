"""The pages of docs hang together, and make a site that works from a disk."""

import re
from itertools import pairwise
from pathlib import Path

import pytest

from tests.support.project import ROOT
from ui.commands.docs.pages import _anchor

DOCS = ROOT / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
LISTS = {"glossary.md", "parameters.md", "windows-gallery.md"}
"""Pages as long as what they list."""
LONGEST = 250
"""Lines of a page."""
BUILT = {"contributing.md", "changelog.md", "api-classes.md", "api-learning.md", "commands"}
"""Pages that only the site has."""
_LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(([^)\s]+)\)")
_FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(DOCS).as_posix())
def test_a_page_says_whom_it_is_for_and_is_short_and_its_links_resolve(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    if page.parent.name != "decisions":
        assert re.match(r"# .+\n\n(For|This page is for) ", text), "the first sentence says whom the page is for"
        assert page.name in LISTS or text.count("\n") <= LONGEST
    assert broken_links(page, text) == []
    for picture, after in pairwise([*_FENCE.sub("", text).split("\n\n"), ""]):
        if re.fullmatch(r"!\[.*\]\(.*\)", picture.strip()):
            assert re.match(r"\*[^*]", after), f"a caption in italics follows {picture}"


def broken_links(page: Path, text: str) -> list[str]:
    broken = []
    for link in _LINK.findall(_FENCE.sub("", text)):
        path, _, anchor = link.partition("#")
        if link.startswith("http") or BUILT & {path.rpartition("/")[2], path.partition("/")[0]}:
            continue
        linked = page.parent / path if path else page
        if not linked.exists() or (anchor and linked.suffix == ".md" and anchor not in anchors(linked)):
            broken.append(link)
    return broken


def anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", _FENCE.sub("", page.read_text(encoding="utf-8")), re.MULTILINE)
    return {_anchor(re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)) for heading in headings}


@pytest.mark.slow
def test_the_site_is_built_without_warnings_and_loads_nothing_from_elsewhere(tmp_path: Path) -> None:
    from scripts.site.build import build  # noqa: PLC0415 - Sphinx takes a second

    (tmp_path / "0.0.9").mkdir()
    (tmp_path / "0.0.9" / "index.html").touch()
    assert build(tmp_path) == 0
    (site,) = tmp_path.glob("0.[1-9]*")
    assert f'["{site.name}", "0.0.9"]' in (tmp_path / "versions-list.js").read_text()
    for page in site.rglob("*.html"):
        loaded = re.findall(r'<(?:script|img|link|iframe)\b[^>]*(?:src|href)="([^"]+)"', page.read_text())
        assert not [each for each in loaded if re.match(r"(?:https?:)?//", each)], page
    for page in ("reference/commands/play", "reference/api-classes", "reference/study-file", "changelog"):
        assert (site / f"{page}.html").stat().st_size > 10_000
    assert "alpha3" in (site / "searchindex.js").read_text()
