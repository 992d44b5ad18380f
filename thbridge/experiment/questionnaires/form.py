"""Forms: the items of a questionnaire, the scales of the items, and the rules for scores."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from typing import TypeVar

import numpy as np

from sim.numerics import noise
from sim.parameters import param
from thbridge.files.disk.inside import fault_of_name
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import FaultCollection
from thbridge.files.yaml.load import Loaded, load_tree
from thbridge.files.yaml.merge import over
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse

SHIPPED = Path(__file__).parent / "forms"
"""Folder of the built-in forms: English forms, and one subfolder per further language."""
T = TypeVar("T")


class Scale(StrEnum):
    """Type of the answer to an item."""

    LIKERT = "likert"
    """Choice of a point between two words, or of a point with its own word."""
    ANALOGUE = "analogue"
    """Mark at any position on a line between two words."""
    DIFFERENTIAL = "differential"
    """Choice of a point between two opposite words."""
    NUMBER = "number"
    CHOICE = "choice"
    """Choice of one or more of several answers."""
    TEXT = "text"


MEASURED = {Scale.LIKERT, Scale.ANALOGUE, Scale.DIFFERENTIAL}
"""Scales with a smallest and a greatest value. Only items with one of these scales can be reversed."""


@dataclass(frozen=True, slots=True)
class Item:
    """An item of a form."""

    id: str = field(metadata={"help": "name of the item's column in the data: lower-case letters, digits and _"})
    text: str = param("", "question or statement; optional if the scale is `differential`")
    scale: Scale = param(Scale.LIKERT, "type of the answer")
    points: int = param(7, "number of points of a likert or differential scale", "", 2, 11)
    low: str = param("", "word at the lower end of the scale")
    high: str = param("", "word at the upper end of the scale")
    labels: tuple[str, ...] = param(
        (),
        "for the scale likert: words of all points, in order, instead of low and high; for the scale choice: texts "
        "that people see instead of the answers (the data contain the answers)",
    )
    minimum: float = param(0.0, "for the scales analogue and number: smallest value")
    maximum: float = param(100.0, "for the scales analogue and number: greatest value")
    step: float = param(1.0, "for the scale analogue: distance between possible values; 0: any value", "", 0)
    unit: str = param("", "for the scale number: unit")
    options: tuple[str, ...] = param((), "for the scale choice: possible answers")
    several: bool = param(default=False, help="for the scale choice: allow more than one answer")
    shuffle: bool = param(
        default=False, help="for the scale choice: show the answers in a random order, which differs between people"
    )
    pinned: tuple[str, ...] = param(
        (), "for the scale choice: answers that `shuffle` does not move, such as 'none of these'"
    )
    required: bool = param(default=True, help="require an answer before the next page")
    not_applicable: bool = param(default=False, help="allow the answer 'not applicable'")
    seconds: float = param(
        0.0, "time limit; after this time, the present answer counts and the item closes; 0: no limit", "s", 0, 3600
    )
    attention: bool = param(
        default=False, help="use the item only as an attention check, with a right answer and without a score"
    )
    subscale: str = param("", "name of the score that the item belongs to; if empty, the item has no score")
    reverse: bool = param(default=False, help="reverse the item: a high answer gives a low score")
    correct: str | None = param(None, "for checks and attention checks: the right answer")
    correct_by_condition: Mapping[str, str] = field(
        default_factory=dict,
        hash=False,
        metadata={"help": "for checks: the right answer at each level of one factor: {FACTOR=LEVEL: ANSWER}"},
    )

    @property
    def least(self) -> float:
        """Smallest value of the scale."""
        return 1.0 if self.scale in {Scale.LIKERT, Scale.DIFFERENTIAL} else self.minimum

    @property
    def greatest(self) -> float:
        """Maximum value of the scale."""
        return float(self.points) if self.scale in {Scale.LIKERT, Scale.DIFFERENTIAL} else self.maximum

    @property
    def words(self) -> tuple[str, ...]:
        """Words of the points of a Likert or differential scale. Words between the two ends may be empty."""
        if self.labels:
            return self.labels
        return (self.low, *("" for _ in range(self.points - 2)), self.high)

    @property
    def score(self) -> str:
        """Name of the item's score; empty if the item has no score."""
        return "" if self.attention else self.subscale

    @property
    def is_checked(self) -> bool:
        """True if the item has a right answer in at least one condition."""
        return self.correct is not None or bool(self.correct_by_condition)

    def correct_at(self, levels: Mapping[str, str]) -> str | None:
        """Return the right answer as written in the form, or None if there is no right answer.

        Args:
            levels: level of each factor in the participant's condition.
        """
        for key, answer in self.correct_by_condition.items():
            factor, _, level = key.partition("=")
            if levels.get(factor) == level:
                return answer
        return self.correct


class Scoring(StrEnum):
    """Method for computing a score from the items of a subscale."""

    MEAN = "mean"
    SUM = "sum"


@dataclass(frozen=True, slots=True)
class Form:
    """A questionnaire."""

    title: str = field(metadata={"help": "heading of the form for participants"})
    instructions: str = param("", "text for participants above the items")
    like: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "default values of the items' keys in this form"}
    )
    items: tuple[Item, ...] = param((), "items of the form, in order")
    shuffle: bool = param(default=False, help="show the items in a random order, which differs between people")
    page: int = param(0, "number of items per page; 0: all items on one page", "", 0)
    scoring: Scoring = param(Scoring.MEAN, "method for computing a score from its items")
    answered: float = param(1.0, "smallest share of answered items for which a score is computed", "", 0, 1)
    source: str = param("", "origin of the form, for the methods text")
    licence: str = param("", "license of the form's wording")

    @property
    def subscales(self) -> Mapping[str, tuple[Item, ...]]:
        """The items of each score, in the order of their first occurrence."""
        names = dict.fromkeys(item.score for item in self.items if item.score)
        return {name: tuple(item for item in self.items if item.score == name) for name in names}

    def order(self, seed: int, participant: str) -> tuple[Item, ...]:
        """Return the items in the order for this participant. The answers of shuffled items are in order, too."""
        items = tuple(self._with_options_in_order(item, seed, participant) for item in self.items)
        if not self.shuffle:
            return items
        return _drawn(items, noise.key(seed, "experiment", "items", self.title, participant))

    def _with_options_in_order(self, item: Item, seed: int, participant: str) -> Item:
        if not item.shuffle:
            return item
        stream = noise.key(seed, "experiment", "options", self.title, item.id, participant)
        drawn = iter(_drawn(tuple(option for option in item.options if option not in item.pinned), stream))
        options = tuple(each if each in item.pinned else next(drawn) for each in item.options)
        labels = dict(zip(item.options, item.labels, strict=False))
        return replace(item, options=options, labels=tuple(labels[option] for option in options if labels))

    def pages(self, seed: int, participant: str) -> Iterator[tuple[Item, ...]]:
        """Yield the items of each page.

        An item with a time limit has its own page, so that its time limit starts with the page.
        """
        items = self.order(seed, participant)
        size = self.page or len(items)
        page: tuple[Item, ...] = ()
        for item in items:
            if page and (item.seconds or page[0].seconds or len(page) == size):
                yield page
                page = ()
            page = (*page, item)
        if page:
            yield page


def _drawn(values: tuple[T, ...], stream: np.uint64) -> tuple[T, ...]:
    """Return values in a random order."""
    drawn = [(noise.uniform(stream, 0, index), index) for index in range(len(values))]
    return tuple(values[index] for _, index in sorted(drawn))


def shipped_form(name: str, language: str) -> Path:
    """Return the path of a built-in form in a language, or in English if there is no translation.

    The file may not exist.
    """
    translated = SHIPPED / language / f"{name}.yaml"
    return translated if not fault_of_name(language) and translated.is_file() else SHIPPED / f"{name}.yaml"


def read_form(path: Path) -> Loaded[Form]:
    """Read a form.

    Raises:
        BadFile: the file cannot be read, or has faults. BadFiles reports all faults at once.
    """
    return form_of_tree(path, parse(path, read_text(path)))


def form_of_tree(path: Path, tree: Node) -> Loaded[Form]:
    """Read a form from its tree.

    Raises:
        BadFile: the form has faults. BadFiles reports all faults at once.
    """
    loaded = load_tree(path, _alike(tree), Form)
    faults = FaultCollection()
    for problem in _problems(loaded.value):
        with faults.kept():
            raise loaded.fault(*problem)
    if faults.found:
        raise faults.together()
    return loaded


def _alike(tree: Node) -> Node:
    """Return the tree of a form after adding the default values in `like` to each item."""
    if not isinstance(tree, Section):
        return tree
    like = next((node for key, node in tree.entries if key.text == "like"), None)
    if not isinstance(like, Section):
        return tree
    entries: list[tuple[Scalar, Node]] = []
    for key, node in tree.entries:
        if key.text == "items" and isinstance(node, Listing):
            entries.append((key, replace(node, items=[over(like, item) for item in node.items])))
        elif key.text != "like":
            entries.append((key, node))
    return Section(tree.line, entries)


def _problems(form: Form) -> Iterator[tuple[str, str, str]]:
    """Yield the key, problem and remedy of entries that are valid alone, but contradict each other."""
    first: dict[str, int] = {}
    if not form.items:
        yield "items", "the form has no items", "Write at least one line: - {id: ..., text: ...}"
    for index, item in enumerate(form.items):
        key = f"items[{index}]"
        if not item.id or not item.id.replace("_", "a").isalnum() or item.id != item.id.lower() or item.id[0].isdigit():
            yield f"{key}.id", f"{item.id!r} is not a valid column name", "Write lower-case letters, digits and _"
        if item.id in first:
            yield f"{key}.id", f"{item.id} is also the id of item {first[item.id] + 1}", "Give each item its own id"
        first.setdefault(item.id, index)
        if not item.text and item.scale is not Scale.DIFFERENTIAL:
            yield f"{key}.text", "the text is missing", "Write the question or statement"
        if item.labels and item.scale is Scale.LIKERT and len(item.labels) != item.points:
            remedy = f"Write {item.points} labels, or points: {len(item.labels)}"
            yield f"{key}.labels", f"{item.points} points need {item.points} labels, not {len(item.labels)}", remedy
        if item.labels and item.scale is Scale.CHOICE and len(item.labels) != len(item.options):
            problem = f"{len(item.options)} answers need {len(item.options)} labels, not {len(item.labels)}"
            yield f"{key}.labels", problem, "Write one label for each answer"
        if item.scale is Scale.DIFFERENTIAL and not (item.low and item.high):
            yield key, "the scale differential needs two words", "Write low and high"
        if item.scale is Scale.CHOICE and len(set(item.options)) < 2:
            yield f"{key}.options", "the scale choice needs different answers", "Write at least two answers"
        if item.shuffle and item.scale is not Scale.CHOICE:
            problem = f"the answers of a {item.scale} item have a fixed order"
            yield f"{key}.shuffle", problem, "Delete the line; to shuffle the items, write `shuffle` for the form"
        if lost := next((answer for answer in item.pinned if answer not in item.options), None):
            remedy = f"Write some of {', '.join(item.options)}"
            yield f"{key}.pinned", f"{lost!r} is not one of the item's options", remedy
        if item.attention and not item.is_checked:
            yield f"{key}.attention", "the attention check has no right answer", "Write correct: ANSWER"
        if not item.minimum < item.maximum:
            yield f"{key}.minimum", "the minimum is not below the maximum", "Swap the two"
        if item.subscale and item.scale not in MEASURED | {Scale.NUMBER}:
            yield f"{key}.subscale", f"an item with the scale {item.scale} cannot have a score", "Delete the line"
        if item.reverse and not (item.subscale and item.scale in MEASURED):
            yield f"{key}.reverse", "only an item with a score can be reversed", "Delete the line, or write a subscale"
