"""The table `reliance`: how often people took right advice and refused wrong advice, and their stated trust."""

from collections.abc import Sequence
from dataclasses import dataclass

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.attempts import Attempt, attempt_columns
from thbridge.experiment.export.families.decisions import GameDecision
from thbridge.experiment.export.families.described import ExperimentTable, TableOf, count, number, share
from thbridge.experiment.export.families.forms import GivenScore
from thbridge.experiment.export.families.trials import Trial
from thbridge.experiment.progress import Run

TRUST = "trust"
"""Name of the score for stated trust."""


@dataclass(frozen=True, slots=True)
class RelianceSubject:
    """Reliance in a trial.

    Attributes:
        run: run of the person.
        attempt: attempt at the trial.
        set_rate: share of wrong advice in the study's settings.
        advised: decisions of the person with advice.
        trust: trust that the person stated afterwards, 0 to 1, or None.
    """

    run: Run
    attempt: Attempt
    set_rate: float | None
    advised: tuple[GameDecision, ...]
    trust: float | None

    def shares(self, name: str, *, right: bool | None = None) -> float | None:
        """Return the share of decisions with a property. `right` restricts this to right or wrong advice."""
        of_them = [each for each in self.advised if right is None or each.is_right is right]
        known = [value for each in of_them if (value := getattr(each, name)) is not None]
        return sum(known) / len(known) if known else None

    @property
    def refused_wrong(self) -> float | None:
        """Share of wrong advice that the participant did not follow."""
        taken = self.shares("agreed", right=False)
        return None if taken is None else 1.0 - taken

    @property
    def error_rate(self) -> float | None:
        """Share of wrong advice. Advice that is not known to be right or wrong does not count."""
        right = self.shares("is_right")
        return None if right is None else 1.0 - right

    @property
    def calibration(self) -> float | None:
        """Stated trust minus the share of right advice."""
        return None if self.trust is None or self.error_rate is None else self.trust - (1.0 - self.error_rate)


def reliance_of(
    design: ExperimentDesign, trial: Trial, made: Sequence[GameDecision], scores: Sequence[GivenScore]
) -> RelianceSubject:
    """Return the reliance in a trial.

    Args:
        design: the experiment.
        trial: the trial.
        made: decisions of the trial.
        scores: all scores of the person.
    """
    step, rate = trial.attempt.step, None
    if step.condition is not None:
        rate = design.cells[trial.run.place.cell].studies[step.condition].dialogue.adviser_error_rate
    trust = [
        each.share
        for each in scores
        if each.subscale == TRUST and each.attempt.step.condition == step.condition and each.share is not None
    ]
    advised = tuple(each for each in made if each.agreed is not None)
    return RelianceSubject(trial.run, trial.attempt, rate, advised, trust[-1] if trust else None)


def reliance(design: ExperimentDesign, subjects: Sequence[RelianceSubject]) -> ExperimentTable:
    """Return the rows of the table `reliance` for trials."""
    table: TableOf[RelianceSubject] = TableOf(
        "reliance",
        "a trial: the person's reliance on the robots' advice",
        (
            *attempt_columns(design),
            count(
                "advised", "number of the person's decisions with advice, of all kinds", lambda row: len(row.advised)
            ),
            count(
                "advised_known",
                "number of the person's decisions with advice that is known to be right or wrong",
                lambda row: sum(each.is_right is not None for each in row.advised),
            ),
            share("agreed", "share of advice that the person took", lambda row: row.shares("agreed")),
            share(
                "taken_when_right",
                "share of right advice that the person took",
                lambda row: row.shares("agreed", right=True),
            ),
            share(
                "refused_when_wrong",
                "share of wrong advice that the person did not take",
                lambda row: row.refused_wrong,
            ),
            share(
                "appropriate",
                "appropriate reliance: share of advice (known to be right or wrong) that was right and taken, or wrong "
                "and not taken",
                lambda row: row.shares("is_appropriate"),
            ),
            share(
                "switched",
                "share of first choices that the person gave up after a robot disagreed",
                lambda row: row.shares("switched"),
            ),
            share("error_rate_set", "share of wrong advice in the study's settings", lambda row: row.set_rate),
            share(
                "error_rate",
                "share of wrong advice in this trial, among advice known to be right or wrong",
                lambda row: row.error_rate,
            ),
            share(
                "trust",
                "score `trust` of a form in the same condition, scaled to 0 (smallest possible) to 1 (greatest "
                "possible)",
                lambda row: row.trust,
            ),
            number(
                "calibration",
                "",
                "trust minus the share of right advice; above 0, the person trusted the advice too much; empty if "
                "trust "
                "or share is unknown",
                lambda row: row.calibration,
                -1,
                1,
            ),
        ),
    )
    return table.of(subjects)
