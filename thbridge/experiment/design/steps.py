"""Steps of an experiment, as its file lists them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from sim.parameters import param

LONGEST_TRIAL = 4 * 3600.0
LARGEST_COUNT = 1000
"""Largest number that a practice game may ask for of one kind, except for seconds."""


class StepKind(StrEnum):
    """Kind of a step: what a person does in it."""

    INSTRUCTIONS = "instructions"
    """Reads a text."""
    CONSENT = "consent"
    """Agrees to take part, or leaves."""
    PRACTICE = "practice"
    """Plays a game that never counts as data."""
    CHECK = "check"
    """Answers questions that have right answers: of comprehension, or of attention."""
    TRIAL = "trial"
    """Plays a game in a condition."""
    FORM = "form"
    """Fills in a questionnaire."""
    PAUSE = "pause"
    """Rests until they go on."""
    DEBRIEF = "debrief"
    """Reads what it was all about, and gets a completion code."""


class PracticeTerm(StrEnum):
    """Term of what must be done in a practice game before a person may go on."""

    SECONDS = "seconds"
    """Simulated time from the start of the game."""
    MOVES = "moves"
    """Robots sent to rooms."""
    PICTURES = "pictures"
    """Pictures taken of treasures, each treasure once."""
    IDENTIFIED = "identified"
    """Treasures named, rightly or wrongly."""
    DIALOGUES = "dialogues"
    """Dialogues in which the person has replied to a robot. Where robots never talk, none are asked for."""


class Failed(StrEnum):
    """Consequence for a person who fails a check for the last time."""

    EXCLUDE = "exclude"
    """The run ends and does not count; its place opens again."""
    GO_ON = "go on"
    """The run goes on, marked."""


class ResumeRule(StrEnum):
    """Rule by which a step goes on after a crash."""

    EXACT = "exact"
    """Where it was: a form has the answers given, a game goes on from its journal."""
    BEGINNING = "beginning"
    """It begins anew; what was there is kept and marked."""
    NEVER = "never"
    """The run ends there and does not count."""


_TERMS = f"the terms are {', '.join(PracticeTerm)}"


@dataclass(frozen=True, slots=True)
class StepEntry:
    """A step as the file of an experiment has it."""

    step: StepKind = field(metadata={"help": "what is done in it"})
    name: str = param(
        "", "name in tables and branches: small letters, digits and _; none: that of its form, or its kind"
    )
    text: Path | None = param(
        None, "file of what is read, for instructions, consent and debrief, from this file's folder"
    )
    form: str = param("", "form that is filled in: one that comes with the program, or a path from this file's folder")
    each_condition: bool = param(
        default=False,
        help="whether it comes once for each condition; steps so marked that follow each other come together",
    )
    right: int | None = param(None, "right answers that a check asks for; null: all", "", 0)
    attempts: int = param(1, "how often a check may be tried", "", 1, 20)
    repeat: str = param("", "name of the step from which a failed check is repeated; none: the check alone")
    failed: Failed = param(Failed.EXCLUDE, "what follows when a check is failed for the last time")
    max_seconds: float = param(3600.0, "simulated time after which a game ends", "s", 1, LONGEST_TRIAL)
    base: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "of practice: keys of the study, over those of the person's first condition"},
    )
    at_least: Mapping[str, str] = field(
        default_factory=lambda: {PracticeTerm.MOVES: "1"},
        metadata={"help": f"of practice: what must be done before people may go on, {{TERM: NUMBER}}; {_TERMS}"},
    )
    when_leaving: bool = param(
        default=True, help="of a debriefing: whether people who leave or are excluded read it as well"
    )
    resume: ResumeRule = param(ResumeRule.EXACT, "how it goes on after a crash")
    results: bool = param(
        default=False, help="whether a debrief lists the score of each game of the person, and the best possible one"
    )
    only_at: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "levels of factors at which the step comes; else it is passed over: {FACTOR: LEVEL}"},
    )
    when: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "answers without which the step is passed over: {STEP.ITEM: ANSWER}"},
    )
