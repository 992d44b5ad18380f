"""A browser receives nothing of a treasure before the event that reveals it, and nothing that a game never reveals.

The search knows each form in which the product writes a text or a picture: as it is, in JSON, in HTML, in a URL, as
hexadecimal digits, and in base 64.
"""

import base64
import dataclasses
import hashlib
import html
import json
import random
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from urllib.parse import quote

import pytest

from tests.support.front_ends.at_browser import BrowserPerson
from tests.support.slow import slow
from tests.support.studies.secret_treasures import SecretTreasure, write_secret_set
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.hunt.events import (
    GameEnded,
    JournalEntry,
    TreasureIdentified,
    TreasurePictured,
    TreasureSensed,
    TreasuresHidden,
)
from thbridge.study.study_file import Study
from ui.model.playing.screen import (
    Act,
    Cancel,
    Confirm,
    EndGameAct,
    GoOnFromGame,
    IdentifyTreasureAct,
    PickName,
    ShowHelp,
    TakePictureAct,
)
from ui.web.page.game_page import BrowserPageMaker

SEED = 918_273_645
"""Random seed of the first study: a number that does not occur by itself."""
STEPS = 40
MAPS = ("arena8", "office", "practice", "warehouse12")
CONDITIONS = tuple(DialogueCondition)


@pytest.fixture(scope="module")
def treasures(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, tuple[SecretTreasure, ...]]:
    folder = tmp_path_factory.mktemp("xqfolder")
    return folder, write_secret_set(folder / "xqset", 40)


def played(folder: Path, number: int) -> BrowserPerson:
    """Return a person who has played a short game by chance; `number` chooses the study."""
    plain = Study()
    talk = dataclasses.replace(
        plain.dialogue, condition=CONDITIONS[number % len(CONDITIONS)], language=("en", "de")[number % 2]
    )
    study = dataclasses.replace(
        plain,
        map=MAPS[number // 2 % len(MAPS)],
        templates="./xqset",
        robots=1 + number % 3,
        seed=SEED + number,
        dialogue=talk,
    )
    person, rng = BrowserPerson(study, folder), random.Random(number)
    person.wait(20)
    for step in range(STEPS):
        act = _choose(person, rng)
        if step % 13 == 12:
            person.connect()  # A browser that connects again receives everything again.
        if act is not None:
            person.press(act)
        person.wait(40)
        if person.tree["ending"]:
            return person
    for _ in range(8):
        person.press(Confirm() if person.tree["question"] else EndGameAct())
        person.wait(40)
    return person


def _choose(person: BrowserPerson, rng: random.Random) -> Act | None:
    page = person.tree
    if page["question"]:
        return rng.choice((Confirm(), Cancel()))
    acts = [act for act in person.shown().possible() if not isinstance(act, EndGameAct | GoOnFromGame)]
    if page["help"]:
        return ShowHelp()
    if page["treasure"] and page["treasure"]["names"]:
        likely = [act for act in acts if isinstance(act, TakePictureAct | IdentifyTreasureAct)]
        names = [PickName(name["pick"]["name"]) for name in page["treasure"]["names"]]
        return rng.choice([*likely, rng.choice(names)])
    return rng.choice(acts) if acts else None


# The search ----------------------------------------------------------------------------------------------------------


def forms(secret: str | bytes) -> set[str]:
    """Return all forms of a text or of bytes in which a message may contain it, in lower case."""
    data = secret.encode() if isinstance(secret, str) else secret
    found = {data.hex(), quote(data).casefold()} if isinstance(secret, str) else set()
    if isinstance(secret, str):
        found |= {secret, html.escape(secret), json.dumps(secret)[1:-1], json.dumps(secret, ensure_ascii=False)[1:-1]}
        found |= {html.escape(json.dumps(secret)[1:-1])}
    # In base 64, the letters depend on the position; the first and the last ones also on the neighbors.
    for before in range(3):
        packed = base64.b64encode(bytes(before) + data).decode()
        found.add(packed[-(-before * 8 // 6) : (before + len(data)) * 8 // 6])
    return {form.casefold() for form in found}


Secret = tuple[str, set[str], int | None]
"""What it is, its forms, and the number of the event with which it is revealed; None if it is never revealed."""


def secrets_of(entries: Sequence[JournalEntry], treasures: Sequence[SecretTreasure]) -> Iterator[Secret]:
    """Yield all secrets of a game.

    The list of possible names is revealed with the first treasure that is sensed. From then on, a name alone reveals no
    treasure, and `named_too_early` checks where it is on the page.
    """
    hidden = next(entry for entry in entries if isinstance(entry, TreasuresHidden)).treasures

    def first(*kinds: type, name: str = "") -> int | None:
        """Return the number of the first event of these kinds, in a room with this treasure if a name is given."""
        events = enumerate(entries)
        return next(
            (
                number
                for number, entry in events
                if isinstance(entry, kinds) and (not name or hidden[entry.room.people - 1].name == name)
            ),
            None,
        )

    def listed(name: str) -> int | None:
        """Return the number of the first sentence with which a robot quotes the list of treasures as a reason.

        The list reveals properties of a possible name, but not where a treasure is.
        """
        said = (number for number, entry in enumerate(entries) if f"listed({name}," in getattr(entry, "move", ""))
        return next(said, None)

    for each in treasures:
        for word in each.words:
            yield f"name {word}", forms(word), first(TreasureSensed, GameEnded)
        sensed = (first(TreasureSensed, name=each.name), listed(each.name))
        for value in each.values:
            yield f"value {value}", forms(value), min((number for number in sensed if number is not None), default=None)
        digest = hashlib.blake2b(each.picture, digest_size=12).hexdigest()
        for what, data in (("picture", each.picture[-40:]), ("digest", digest)):
            yield f"{what} of {each.name}", forms(data), first(TreasurePictured, name=each.name)
        yield f"file of {each.name}", forms(each.file), None


def early(messages: Sequence[tuple[int, str]], secrets: Sequence[Secret]) -> list[str]:
    """Return what a message contains before its event: the secret, and the beginning of the message."""
    bounds = sorted({count for count, _ in messages})
    sent = {bound: "\n".join(text for count, text in messages if count == bound).casefold() for bound in bounds}
    found = []
    for what, shapes, revealed in secrets:
        for bound, text in sent.items():
            # An event is in the journal before anything of it is sent.
            if (revealed is None or bound <= revealed) and any(shape in text for shape in shapes):
                found.append(f"{what}, before event {revealed}, after {bound} events")
    return found


def hidden_from_all(person: BrowserPerson, folder: Path) -> Iterator[Secret]:
    """Yield what no participant ever learns: the random seed, the folder of the study, the id of the program."""
    yield "seed", forms(str(person.game.setting.study.seed)), None
    yield "folder", forms(str(folder)), None
    yield "set", forms("xqset"), None


def named_too_early(person: BrowserPerson, treasures: Sequence[SecretTreasure]) -> list[str]:
    """Return the names of treasures on the present page where only a treasure with a verdict may be named.

    Pop-ups and the history may contain possible names at any time after the first treasure was sensed.
    """
    page = person.tree
    verdicts = {entry.room.people for entry in person.game.log.events if isinstance(entry, TreasureIdentified)}
    parts = {f"room {tile['room']}": tile for tile in page["tiles"] if tile["room"] not in verdicts}
    parts |= {name: page[name] for name in ("cards", "robots", "tools", "queue", "rules", "advise", "progress")}
    written = {name: json.dumps(part, ensure_ascii=False).casefold() for name, part in parts.items()}
    words = [word.casefold() for each in treasures for word in each.words]
    return [f"{name}: {word}" for name, text in written.items() for word in words if word in text]


def faults_of(person: BrowserPerson, folder: Path, treasures: Sequence[SecretTreasure]) -> list[str]:
    """Return everything that the browser has received too early."""
    secrets = [*secrets_of(person.game.log.entries, treasures), *hidden_from_all(person, folder)]
    return early(person.received, secrets) + named_too_early(person, treasures)


@pytest.mark.parametrize("games", [range(3), *slow(*(range(first, first + 8) for first in range(3, 51, 8)))])
@pytest.mark.timeout(280)
def test_games_hold_nothing_early(treasures: tuple[Path, tuple[SecretTreasure, ...]], games: Sequence[int]) -> None:
    folder, kinds = treasures
    found: dict[int, list[str]] = {}
    revealed = 0
    for number in games:
        person = played(folder, number)
        assert any(isinstance(entry, GameEnded) for entry in person.game.log.events), number
        revealed += sum(isinstance(entry, TreasureSensed) for entry in person.game.log.events)
        found[number] = faults_of(person, folder, kinds)
    assert {number: faults for number, faults in found.items() if faults} == {}
    assert revealed >= len(games) // 2, "games that reveal nothing test nothing"


LEAKS: dict[str, Callable[[SecretTreasure], str]] = {
    "name": lambda each: each.words[0],
    "words": lambda each: each.words[2],
    "value": lambda each: each.values[1],
    "html": lambda each: html.escape(each.values[1]),
    "base 64": lambda each: base64.b64encode(f"?{each.name}".encode()).decode(),
    "digest": lambda each: hashlib.blake2b(each.picture, digest_size=12).hexdigest(),
    "picture": lambda each: base64.b64encode(each.picture).decode(),
    "file": lambda each: each.file,
}


@pytest.mark.parametrize("leak", LEAKS)
def test_the_search_finds_a_page_that_leaks(
    treasures: tuple[Path, tuple[SecretTreasure, ...]], leak: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, kinds = treasures
    plain = Study()
    study = dataclasses.replace(plain, map="practice", templates="./xqset", seed=SEED)
    person = BrowserPerson(study, folder)
    person.wait(20)
    assert faults_of(person, folder, kinds) == []
    make = BrowserPageMaker.page
    treasure = next(entry for entry in person.game.log.events if isinstance(entry, TreasuresHidden)).treasures[0]
    kind = next(each for each in kinds if each.name == treasure.name)

    def leaky(self: BrowserPageMaker, *values: object) -> object:
        return dataclasses.replace(make(self, *values), remark=LEAKS[leak](kind))  # type: ignore[arg-type]

    monkeypatch.setattr(BrowserPageMaker, "page", leaky)
    person.wait(20)
    assert faults_of(person, folder, kinds)
