"""Help texts, messages, comments, docstrings and pages keep to the words of the style sheet in CONTRIBUTING.md."""

import io
import re
import subprocess
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.project import ROOT

INSTEAD = {
    r"tell|tells|told|telling": "print, report, show, send, return, say",
    r"anew": "again, restart",
    r"whoever|whomever|nobody|somebody": "the client that, no client, a person",
    r"so many|so much|so long": "N, an amount, a duration",
    r"of which|of whom": "two sentences",
    r"such as (?:is|are|was|were)": "that",
    r"(?:come|comes|came) of (?:it|them|this|that)|(?:becomes?|became) of": "result, outcome",
    r"None:(?= )": "If None, ...",
    r"by wish": "optional, if requested",
    r"err|errs|erred": "has an error of, is wrong",
    r"befalls?|befell|mishaps?": "scheduled failure",
    r"chance|chances": "random, random seed, probability",
    r"patience": "timeout",
    r"amid|amidst": "during",
    r"beside": "next to, in addition to",
    r"carried(?! out)": "kidnapped, propagated, extrapolated; moved, held",
    r"words of others": "untrusted text",
    r"to the bit": "bit for bit",
    r"at (?:the|its|their|a|each|every|all its) doors?": "at the port, at the connection",
    r"colour\w*|behaviour\w*|neighbour\w*|favour\w*|honour\w*|licence\w*|grey\w*": "American spelling",
    r"backwards|towards": "backward, toward",
    r"centre|centres|centred|metre|metres|\w+metres?|catalogue\w*|programmes?|analys(?:e|ed|ing)": "American spelling",
    r"(?:local|normal|initial|organ|recogn|optim|minim|maxim|serial|synchron|visual|general)is(?:e|ed|es|ing|ation)":
        "American spelling",
}  # fmt: skip
"""Words and phrases that the product does not use, and what to write instead."""
BANNED = re.compile("|".join(rf"\b(?P<g{at}>{words})(?!\w)" for at, words in enumerate(INSTEAD)), re.IGNORECASE)
_LANGUAGE = "thbridge/dialogue/wording/languages/en"
ALLOWED: dict[str, frozenset[str]] = {
    f"{_LANGUAGE}/language.yaml": frozenset({"nobody", "metres"}),
    f"{_LANGUAGE}/lines.yaml": frozenset({"nobody", "told", "tell"}),
    f"{_LANGUAGE}/phrases.yaml": frozenset({"nobody", "somebody", "colour"}),
    f"{_LANGUAGE}/texts/kiosk.yaml": frozenset({"tell"}),
    f"{_LANGUAGE}/texts/properties.yaml": frozenset({"colour"}),
    f"{_LANGUAGE}/texts/rules.yaml": frozenset({"told"}),
    f"{_LANGUAGE}/texts/scripted.yaml": frozenset({"nobody", "told"}),
    "templates/everyday-things/de/words.yaml": frozenset({"colour"}),
    "templates/four-properties/de/words.yaml": frozenset({"colour"}),
    "templates/practice/de/words.yaml": frozenset({"colour"}),
    "templates/sklar-azhar-2015/de/words.yaml": frozenset({"colour"}),
    "thbridge/api/recording.py": frozenset({"beside"}),
    "thbridge/ros/messages/definition_texts.py": frozenset({"initialising"}),
    # Key of study files.
    "docs/explanation/robots.md": frozenset({"mishaps"}),
    # Names of arguments and of public fields.
    "thbridge/app/compose/move_costs.py": frozenset({"beside"}),
    "thbridge/app/compose/setting.py": frozenset({"beside"}),
    "thbridge/roles/keeper/advice/adviser.py": frozenset({"erred"}),
    "thbridge/roles/shared/view.py": frozenset({"told"}),
    # Definitions of messages, which are in every bag: ROS's tools compare them with the installed ones.
    "thbridge/ros/messages/types.py": frozenset({"chance", "nobody", "somebody"}),
    # Texts of older recordings, and of MAVLink frames, which replays compare.
    "thbridge/mavlink/vehicle/mission/items.py": frozenset({"metres"}),
    "thbridge/app/replay/rewordings.py": frozenset({"somebody"}),
}
"""Words that some files may use: terms of the field, keys of 2016, recorded sentences, people who tell others."""
SKIPPED = ("CONTRIBUTING.md", "templates/original-2016/", "tests/")
"""The style sheet, which quotes these words; texts of 2016, and tests."""
WRITTEN = ("*.md", "*.py", "*.sh", "*.toml", "Makefile", "*/en/*.yaml", "templates/*.yaml", "maps/*.yaml")
_ARGUMENT = re.compile(r"^ +\w+:(?= )")
_CODE = re.compile(r"`[^`\n]*`|\]\([^)\s]*\)|\{[^{}\n]*\}|https?://\S+")


def texts(path: Path) -> Iterator[tuple[int, str]]:
    """Yield the lines of a file that people read, with their numbers: of Python, strings and comments."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        yield from enumerate(text.splitlines(), 1)
        return
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        is_prose = token.type == tokenize.COMMENT or (token.type == tokenize.STRING and " " in token.string)
        if is_prose:
            yield from enumerate(token.string.splitlines(), token.start[0])


def faults(path: Path) -> Iterator[tuple[int, str, str]]:
    """Yield the banned words of a file: line, word, and what to write instead."""
    for number, line in texts(path):
        for match in BANNED.finditer(_CODE.sub("`", _ARGUMENT.sub("", line))):
            yield number, match[0], list(INSTEAD.values())[int((match.lastgroup or "")[1:])]


def written() -> list[Path]:
    """Return the files of the project that the check reads."""
    listed = subprocess.run(["git", "ls-files", *WRITTEN], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [ROOT / name for name in listed.splitlines() if not name.startswith(SKIPPED)]


def test_no_text_uses_a_banned_word() -> None:
    found = [
        f"{name}:{number}: {word!r}; better: {instead}"
        for path in written()
        for number, word, instead in faults(path)
        if word.lower() not in ALLOWED.get(name := path.relative_to(ROOT).as_posix(), ())
    ]
    assert not found, f"{len(found)} banned words:\n" + "\n".join(found[:60])


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('"""Return what robots are told."""', ["told"]),
        ("# None: no limit", ["None:"]),
        ("limit = 3  # metres", ["metres"]),
        ('say("Nobody answers.")', ["Nobody"]),
        ('say("`told`", "told"); told = {}', []),
        ('say("The command was carried out.")', []),
    ],
)
def test_the_check_finds_words_in_strings_and_comments_alone(tmp_path: Path, line: str, words: list[str]) -> None:
    path = tmp_path / "module.py"
    path.write_text(line + "\n")
    assert [word for _, word, _ in faults(path)] == words
