"""Steps in the file of an experiment."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from sim.parameters import param

LONGEST_TRIAL = 4 * 3600.0
LARGEST_COUNT = 1000
"""Maximum number in a requirement of a practice game, except for seconds."""


class StepKind(StrEnum):
    """Kind of a step: activity of the person."""

    INSTRUCTIONS = "instructions"
    """The person reads a text."""
    CONSENT = "consent"
    """The person agrees to take part, or leaves."""
    PRACTICE = "practice"
    """The person plays a game that never counts as data."""
    CHECK = "check"
    """The person answers questions about comprehension or attention. These questions have right answers."""
    TRIAL = "trial"
    """The person plays a game in a condition."""
    FORM = "form"
    """The person fills in a questionnaire."""
    PAUSE = "pause"
    """The person rests, and continues by pressing a button."""
    DEBRIEF = "debrief"
    """The person reads the purpose of the study, and receives a completion code."""


class PracticeTerm(StrEnum):
    """Kind of requirement that a person must meet in a practice game before the next step."""

    SECONDS = "seconds"
    """Simulated time from the start of the game."""
    MOVES = "moves"
    """Number of moves of robots to rooms."""
    PICTURES = "pictures"
    """Number of different treasures with a picture."""
    IDENTIFIED = "identified"
    """Number of treasures that the person named, rightly or wrongly."""
    DIALOGUES = "dialogues"
    """Number of dialogues in which the person replied to a robot. If robots never talk, dialogues are not required."""


class Failed(StrEnum):
    """Consequence of a failed last attempt at a check."""

    EXCLUDE = "exclude"
    """The run ends and does not count. Its place becomes free."""
    GO_ON = "go on"
    """The run continues, and the data mark this run."""


class ResumeRule(StrEnum):
    """Rule for resuming a step after a crash."""

    EXACT = "exact"
    """Resume at the point of the crash: a form keeps its answers, and a game resumes from its journal."""
    BEGINNING = "beginning"
    """Restart the step. The earlier recorded data are kept and marked."""
    NEVER = "never"
    """Do not resume: the run ends and does not count."""


_TERMS = f"the terms are {', '.join(PracticeTerm)}"


@dataclass(frozen=True, slots=True)
class StepEntry:
    """Contents of a step in the file of an experiment."""

    step: StepKind = field(metadata={"help": "kind of the step"})
    name: str = param(
        "",
        "name of the step in tables and branches: small letters, digits and _; if empty, the name of the step's form, "
        "or "
        "the step's kind and number",
    )
    text: Path | None = param(
        None, "for instructions, consent and debrief: path of the text, relative to the folder of this file"
    )
    form: str = param("", "for check and form: name of a built-in form, or path relative to the folder of this file")
    each_condition: bool = param(
        default=False,
        help="repeat the step for each condition; adjacent steps with this key are repeated together",
    )
    right: int | None = param(
        None, "for a check: number of right answers needed to pass; if null, all answers must be right", "", 0
    )
    attempts: int = param(1, "for a check: allowed number of attempts", "", 1, 20)
    repeat: str = param(
        "", "for a check: name of the step to which a failed check returns; if empty, only the check is repeated"
    )
    failed: Failed = param(Failed.EXCLUDE, "for a check: consequence of a failed last attempt")
    max_seconds: float = param(
        3600.0, "for trial and practice: simulated time after which the game ends", "s", 1, LONGEST_TRIAL
    )
    base: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "for practice: keys of the study that override the keys of the person's first condition"},
    )
    at_least: Mapping[str, str] = field(
        default_factory=lambda: {PracticeTerm.MOVES: "1"},
        metadata={"help": f"for practice: requirements for continuing, {{TERM: NUMBER}}; {_TERMS}"},
    )
    when_leaving: bool = param(default=True, help="for a debrief: show it also to people who leave or are excluded")
    resume: ResumeRule = param(ResumeRule.EXACT, "rule for resuming the step after a crash")
    results: bool = param(
        default=False, help="for a debrief: list the person's score and the best possible score of each game"
    )
    only_at: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "levels of factors that the step needs; at other levels it is skipped: {FACTOR: LEVEL}"},
    )
    when: Mapping[str, str] = field(
        default_factory=dict,
        metadata={"help": "answers that the step needs; after other answers it is skipped: {STEP.ITEM: ANSWER}"},
    )
