"""Build the site: `python -m scripts.site.build [FOLDER]`; `make docs` calls it.

The pages come from `docs`, the changelog and CONTRIBUTING.md. Pages about commands, keys of a study file and the
Python API are generated from the code. The site is written to FOLDER/VERSION. It also works from a local disk, because
it loads nothing from other hosts. Each version in FOLDER has links to the other versions.
"""

import argparse
import json
import os
import re
import shutil
import sys
import tempfile
from importlib import import_module, metadata
from pathlib import Path

from sphinx.cmd.build import build_main

from scripts.site.command_pages import command_pages
from thbridge import api
from thbridge.api import learning

ROOT = Path(__file__).parents[2]
HERE = Path(__file__).parent
OF_THE_PROJECT = {"CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md", "README.md": "index.md"}
"""Files of the project's root folder, each with the page of the site that contains or replaces it."""
INDEXES = {"index.md", "development.md"}
"""Names of pages that determine the order of other pages."""
_LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#:]+)(#[^)]*)?\)")


def build(folder: Path) -> int:
    """Build the site of the installed version in a folder; return Sphinx's exit code, which is 0 without warnings."""
    target = folder / metadata.version("thbridge")
    with tempfile.TemporaryDirectory() as made:
        source = Path(made) / "docs"
        _lay_source(source)
        shutil.rmtree(target, ignore_errors=True)
        code = build_main(
            ["-q", "-W", "--keep-going", "-c", str(HERE), "-d", f"{made}/trees", str(source), str(target)]
        )
    shutil.rmtree(target / ".doctrees", ignore_errors=True)
    versions = sorted((path.name for path in folder.iterdir() if (path / "index.html").exists()), reverse=True)
    (folder / "versions-list.js").write_text(f"window.siteVersions = {json.dumps(versions)};\n")
    return code


def _lay_source(source: Path) -> None:
    shutil.copytree(ROOT / "docs", source, ignore=shutil.ignore_patterns("pictures"))
    (source / "pictures").symlink_to(ROOT / "docs" / "pictures")
    for name, page in OF_THE_PROJECT.items():
        if page != "index.md":
            text = _with_links_of((ROOT / name).read_text(encoding="utf-8"), ROOT, ROOT / "docs")
            (source / page).write_text(text, encoding="utf-8")
    for page in (ROOT / "docs").rglob("*.md"):
        copy = source / page.relative_to(ROOT / "docs")
        text = _with_links_of(page.read_text(encoding="utf-8"), page.parent, page.parent)
        copy.write_text(text + _toctree(page, text, copy), encoding="utf-8")
    commands = source / "reference" / "commands"
    commands.mkdir()
    for name, text in command_pages().items():
        (commands / f"{name}.md").write_text(text, encoding="utf-8")
    for name, text in api_pages().items():
        (source / "reference" / f"{name}.md").write_text(text, encoding="utf-8")


def _with_links_of(text: str, folder: Path, to: Path) -> str:
    """Return a page whose links are correct from its path in the site.

    A link to a file outside the site becomes the file's name.
    """

    def link(match: re.Match[str]) -> str:
        words, path, anchor = match[1], match[2], match[3] or ""
        linked = Path(os.path.normpath(folder / path))
        if linked.is_relative_to(ROOT / "docs") and linked.is_file():
            return f"[{words}]({os.path.relpath(linked, to)}{anchor})"
        if linked.parent == ROOT and linked.name in OF_THE_PROJECT:
            return f"[{words}]({os.path.relpath(ROOT / 'docs' / OF_THE_PROJECT[linked.name], to)}{anchor})"
        if not linked.exists():
            return match[0]
        name = linked.relative_to(ROOT).as_posix()
        return words if name in words else f"{words} (`{name}`)"

    return _LINK.sub(link, text)


def _toctree(page: Path, text: str, copy: Path) -> str:
    """Return the toctree of an index page: the linked pages in its folder, and the indexes of subfolders.

    If the index page has sections, each section becomes a page with the same links, so that the sidebar shows groups.
    """
    if page.name not in INDEXES:
        return ""
    head, *sections = re.split(r"^## ", text, flags=re.MULTILINE)
    entries = _entries(head)
    for section in sections:
        title, _, links = section.partition("\n")
        name = f"group-{title.lower().replace(' ', '-').replace(',', '')}"
        group = f"# {title}\n\n{links.strip()}\n{_listed(_entries(links))}"
        (copy.parent / f"{name}.md").write_text(group, encoding="utf-8")
        entries.append(name)
    return _listed(entries)


def _entries(text: str) -> list[str]:
    linked = dict.fromkeys(match[2] for match in _LINK.finditer(text) if match[2].endswith(".md"))
    inner = [path for path in linked if "/" not in path or (path.count("/") == 1 and path.endswith("/index.md"))]
    return [path.removesuffix(".md") for path in inner if not path.startswith("../")]


def _listed(entries: list[str]) -> str:
    return "\n```{toctree}\n:hidden:\n\n" + "\n".join(entries) + "\n```\n"


def api_pages() -> dict[str, str]:
    """Return the pages of the Python API, by their names."""
    return {
        "api-classes": _api_page(api, "thbridge.api", "For programmers: all classes of `thbridge.api`."),
        "api-learning": _api_page(
            learning,
            "thbridge.api.learning",
            "For people who train agents: the environments of `thbridge.api.learning`.",
        ),
    }


def _api_page(module: object, name: str, reader: str) -> str:
    lines = [f"# {name}", "", reader, "", f"```{{py:module}} {name}\n```", ""]
    for each in sorted(vars(import_module(name))):
        value = getattr(module, each)
        if each.startswith("_") or not getattr(value, "__module__", "").startswith("thbridge.api"):
            continue
        kind = "autoclass" if isinstance(value, type) else "autofunction"
        lines += [f"## {each}", "", f"```{{eval-rst}}\n.. {kind}:: {name}.{each}\n```", ""]
    return "\n".join(lines)


def main() -> int:
    """Read the command line, and build the site."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=ROOT / "site", metavar="FOLDER", help="default: site")
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    code = build(folder)
    print(folder / metadata.version("thbridge") / "index.html")
    return code


if __name__ == "__main__":
    sys.exit(main())
