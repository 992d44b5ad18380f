"""Forms: the items of a questionnaire, their scales, and the key for their scores."""

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
"""Folder of the forms of the program: English forms, and one folder per further language."""
T = TypeVar("T")


class Scale(StrEnum):
    """Type of the answer to an item."""

    LIKERT = "likert"
    """One of several points between two words, or with one word per point."""
    ANALOGUE = "analogue"
    """A mark anywhere on a line between two words."""
    DIFFERENTIAL = "differential"
    """One of several points between two opposite words."""
    NUMBER = "number"
    CHOICE = "choice"
    """One of several answers, or more than one."""
    TEXT = "text"


MEASURED = {Scale.LIKERT, Scale.ANALOGUE, Scale.DIFFERENTIAL}
"""Scales with a smallest and a greatest value, between which an item can be reversed."""


@dataclass(frozen=True, slots=True)
class Item:
    """An item of a form."""

    id: str = field(metadata={"help": "name of its column in the data: lower-case letters, digits and _"})
    text: str = param("", "question or statement; optional for a differential")
    scale: Scale = param(Scale.LIKERT, "type of the answer")
    points: int = param(7, "number of points of a likert or differential scale", "", 2, 11)
    low: str = param("", "word at the lower end of its scale")
    high: str = param("", "word at the upper end of its scale")
    labels: tuple[str, ...] = param(
        (),
        "texts of all points of a likert scale in their order, not only low and high; of a choice: texts shown to "
        "people instead of its answers, while the data have the answers",
    )
    minimum: float = param(0.0, "smallest value of an analogue scale or a number")
    maximum: float = param(100.0, "greatest value of an analogue scale or a number")
    step: float = param(1.0, "distance between the values of an analogue scale; 0: any value", "", 0)
    unit: str = param("", "unit of a number")
    options: tuple[str, ...] = param((), "answers of a choice")
    several: bool = param(default=False, help="whether people may choose more than one answer")
    shuffle: bool = param(default=False, help="whether the answers of a choice come in a random order per participant")
    pinned: tuple[str, ...] = param(
        (), "answers of a choice that keep their place when the others are shuffled, such as 'none of these'"
    )
    required: bool = param(default=True, help="whether it must be answered before the next page")
    not_applicable: bool = param(default=False, help="whether it may be answered as not applicable")
    seconds: float = param(
        0.0, "time limit, after which the item is closed with the answer so far; 0: no limit", "s", 0, 3600
    )
    attention: bool = param(
        default=False, help="whether it only checks attention; it has a right answer and is never scored"
    )
    subscale: str = param("", "name of the score that it belongs to; empty: it is not scored")
    reverse: bool = param(default=False, help="whether a high answer means a low score")
    correct: str | None = param(None, "of a check and of an attention check: the only right answer")
    correct_by_condition: Mapping[str, str] = field(
        default_factory=dict,
        hash=False,
        metadata={"help": "of a check: the right answer at each level of one factor: {FACTOR=LEVEL: ANSWER}"},
    )

    @property
    def least(self) -> float:
        """Smallest value of the scale."""
        return 1.0 if self.scale in {Scale.LIKERT, Scale.DIFFERENTIAL} else self.minimum

    @property
    def greatest(self) -> float:
        """Greatest value of the scale."""
        return float(self.points) if self.scale in {Scale.LIKERT, Scale.DIFFERENTIAL} else self.maximum

    @property
    def words(self) -> tuple[str, ...]:
        """The words of the points of a Likert or differential scale; those between the ends may be empty."""
        if self.labels:
            return self.labels
        return (self.low, *("" for _ in range(self.points - 2)), self.high)

    @property
    def score(self) -> str:
        """Name of the score that the item counts for; empty if it is not scored."""
        return "" if self.attention else self.subscale

    @property
    def is_checked(self) -> bool:
        """True for an item of a check with a right answer, at least in some conditions."""
        return self.correct is not None or bool(self.correct_by_condition)

    def correct_at(self, levels: Mapping[str, str]) -> str | None:
        """Return the right answer as written in the form; None if no answer is right or wrong.

        Args:
            levels: level of each factor in the participant's condition.
        """
        for key, answer in self.correct_by_condition.items():
            factor, _, level = key.partition("=")
            if levels.get(factor) == level:
                return answer
        return self.correct


class Scoring(StrEnum):
    """Method of computing a score from the items of a subscale."""

    MEAN = "mean"
    SUM = "sum"


@dataclass(frozen=True, slots=True)
class Form:
    """A questionnaire."""

    title: str = field(metadata={"help": "heading that people read"})
    instructions: str = param("", "text above the items")
    like: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "common values, for the items that do not have their own"}
    )
    items: tuple[Item, ...] = param((), "the items, in their order")
    shuffle: bool = param(default=False, help="whether items come in a different order for each person")
    page: int = param(0, "items per page; 0: all", "", 0)
    scoring: Scoring = param(Scoring.MEAN, "method of computing a score from its items")
    answered: float = param(1.0, "share of a subscale's items that must be answered for a score", "", 0, 1)
    source: str = param("", "origin of the form, for the methods text")
    licence: str = param("", "license of its wording")

    @property
    def subscales(self) -> Mapping[str, tuple[Item, ...]]:
        """The items of each score, in the order of their first occurrence."""
        names = dict.fromkeys(item.score for item in self.items if item.score)
        return {name: tuple(item for item in self.items if item.score == name) for name in names}

    def order(self, seed: int, participant: str) -> tuple[Item, ...]:
        """Return the items, and the answers of choices, in the order for this participant."""
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

        An item with a time limit has its own page, so that its time begins with the page.
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
    """Return the file of a form of the program in a language, or otherwise in English; the file need not exist."""
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
        BadFile: as in `read_form`.
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
    """Return the tree of a form in which each item has the common values from `like`."""
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
    """Yield key, problem and remedy of entries that are valid on their own, but not together."""
    first: dict[str, int] = {}
    if not form.items:
        yield "items", "a form without items", "Write some: - {id: ..., text: ...}"
    for index, item in enumerate(form.items):
        key = f"items[{index}]"
        if not item.id or not item.id.replace("_", "a").isalnum() or item.id != item.id.lower() or item.id[0].isdigit():
            yield f"{key}.id", f"{item.id!r} is no name of a column", "Write lower-case letters, digits and _"
        if item.id in first:
            yield f"{key}.id", f"{item.id} is also the id of item {first[item.id] + 1}", "Give each item its own id"
        first.setdefault(item.id, index)
        if not item.text and item.scale is not Scale.DIFFERENTIAL:
            yield f"{key}.text", "the text is missing", "Write the question or statement"
        if item.labels and item.scale is Scale.LIKERT and len(item.labels) != item.points:
            remedy = f"Write {item.points} words, or set points to {len(item.labels)}"
            yield f"{key}.labels", f"{len(item.labels)} words for {item.points} points", remedy
        if item.labels and item.scale is Scale.CHOICE and len(item.labels) != len(item.options):
            remedy = f"Write {len(item.options)} labels, one for each answer"
            yield f"{key}.labels", f"{len(item.labels)} labels for {len(item.options)} answers", remedy
        if item.scale is Scale.DIFFERENTIAL and not (item.low and item.high):
            yield key, "a differential needs its two words", "Write low and high"
        if item.scale is Scale.CHOICE and len(set(item.options)) < 2:
            yield f"{key}.options", "a choice needs different answers", "Write at least two"
        if item.shuffle and item.scale is not Scale.CHOICE:
            problem = f"the answers of a {item.scale} item have a fixed order"
            yield f"{key}.shuffle", problem, "Remove the line; the form's own key `shuffle` orders its items"
        if lost := next((answer for answer in item.pinned if answer not in item.options), None):
            yield f"{key}.pinned", f"{lost!r} is not one of the item's options", f"Write some of {', '.join(item.options)}"
        if item.attention and not item.is_checked:
            yield f"{key}.attention", "an attention check needs its right answer", "Write correct: ANSWER"
        if not item.minimum < item.maximum:
            yield f"{key}.minimum", "is not below the maximum", "Swap the two"
        if item.subscale and item.scale not in MEASURED | {Scale.NUMBER}:
            yield f"{key}.subscale", f"a {item.scale} item has no score", "Remove the line"
        if item.reverse and not (item.subscale and item.scale in MEASURED):
            yield f"{key}.reverse", "only a scored item can be reversed", "Remove the line, or name a subscale"
