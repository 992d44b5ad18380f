"""Steps of an experiment, as its file lists them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from sim.parameters import param

LONGEST_TRIAL = 4 * 3600.0
LARGEST_COUNT = 1000
"""Largest number that a practice game may require of one kind, except for seconds."""


class StepKind(StrEnum):
    """Kind of a step: what a person does in it."""

    INSTRUCTIONS = "instructions"
    """Reads a text."""
    CONSENT = "consent"
    """Agrees to take part, or leaves."""
    PRACTICE = "practice"
    """Plays a game that never counts as data."""
    CHECK = "check"
    """Answers questions with right answers, about comprehension or attention."""
    TRIAL = "trial"
    """Plays a game in a condition."""
    FORM = "form"
    """Fills in a questionnaire."""
    PAUSE = "pause"
    """Rests until they continue."""
    DEBRIEF = "debrief"
    """Reads what the study was about, and gets a completion code."""


class PracticeTerm(StrEnum):
    """Kind of requirement in a practice game that a person must meet before the next step."""

    SECONDS = "seconds"
    """Simulated time from the start of the game."""
    MOVES = "moves"
    """Robots sent to rooms."""
    PICTURES = "pictures"
    """Pictures taken of treasures, each treasure once."""
    IDENTIFIED = "identified"
    """Treasures named, rightly or wrongly."""
    DIALOGUES = "dialogues"
    """Dialogues in which the person has replied to a robot. If robots never talk, none are required."""


class Failed(StrEnum):
    """Consequence for a person who fails a check for the last time."""

    EXCLUDE = "exclude"
    """The run ends and does not count; its place is free again."""
    GO_ON = "go on"
    """The run continues and is marked."""


class ResumeRule(StrEnum):
    """Rule by which a step resumes after a crash."""

    EXACT = "exact"
    """Where it stopped: a form keeps its answers, and a game resumes from its journal."""
    BEGINNING = "beginning"
    """From its beginning; what was recorded before is kept and marked."""
    NEVER = "never"
    """Not at all: the run ends there and does not count."""


_TERMS = f"the terms are {', '.join(PracticeTerm)}"


@dataclass(frozen=True, slots=True)
class StepEntry:
    """Contents of a step in the file of an experiment."""

    step: StepKind = field(metadata={"help": "what is done in it"})
    name: str = param(
        "", "name in tables and branches: small letters, digits and _; if empty, the name of its form, or its kind"
    )
    text: Path | None = param(
        None, "file to read, for instructions, consent and debrief, relative to this file's folder"
    )
    form: str = param("", "form to fill in: a built-in form, or a path relative to this file's folder")
    each_condition: bool = param(
        default=False,
        help="repeat the step for each condition; adjacent steps marked so are repeated together",
    )
    right: int | None = param(None, "number of right answers that pass a check; if null, all", "", 0)
    attempts: int = param(1, "number of times that a check may be tried", "", 1, 20)
    repeat: str = param("", "name of the step from which a failed check is repeated; if empty, only the check")
    failed: Failed = param(Failed.EXCLUDE, "what happens when the last attempt at a check fails")
    max_seconds: float = param(3600.0, "simulated time after which a game ends", "s", 1, LONGEST_TRIAL)
    base: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "for practice: keys of the study, which override those of the person's first condition"},
    )
    at_least: Mapping[str, str] = field(
        default_factory=lambda: {PracticeTerm.MOVES: "1"},
        metadata={"help": f"for practice: what to do before people can continue, {{TERM: NUMBER}}; {_TERMS}"},
    )
    when_leaving: bool = param(default=True, help="for a debrief: people who leave or are excluded also read it")
    resume: ResumeRule = param(ResumeRule.EXACT, "how the step resumes after a crash")
    results: bool = param(
        default=False, help="for a debrief: list the person's score of each game, and the best possible one"
    )
    only_at: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "levels of factors at which the step comes; at others it is skipped: {FACTOR: LEVEL}"},
    )
    when: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "answers that the step needs; without them it is skipped: {STEP.ITEM: ANSWER}"},
    )
