"""Computation and output of `thbridge study power`."""

import hashlib
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.table import Table

from thbridge.app.compose.machine import versions
from thbridge.batch.engines.engine import Engine
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import fingerprint_of
from thbridge.experiment.rehearsal.people import read_people
from thbridge.experiment.rehearsal.power import LEVEL, PowerEstimate, PowerQuestion, PowerTask, estimate_power
from thbridge.files.errors import BadFile
from thbridge.files.progress import Tell
from ui.command_line.terminal import out, print_json, say

ENOUGH = 0.8
"""Usual target value of a study's power."""


def power_tasks(
    root: Path, score: str, factor: str, people: Sequence[int], rehearsals: int, seed: int, results: Path
) -> list[PowerTask]:
    """Return the rehearsals that are needed for a power estimate.

    Args:
        root: folder of the experiment.
        score: name of a subscale.
        factor: factor whose levels are compared.
        people: numbers of people. If empty, six numbers are used, up to the experiment's number of people.
        rehearsals: number of rehearsals with the effects, and of rehearsals without them.
        seed: random seed of the first rehearsal.
        results: folder of results of this and other estimates.

    Raises:
        BadFile: the experiment is faulty, or has no such score or factor.
    """
    folder = ExperimentFolder(root)
    design = folder.read()
    simulated = read_people(folder.people, design)
    scores = sorted({name for form in design.forms.values() for name in form.subscales})
    if score not in scores:
        remedy = f"Write --score with one of {', '.join(scores) or 'the scores of a form (there is none yet)'}"
        raise BadFile(folder.file, f"no form has a score {score}", remedy)
    factors = sorted({*design.conditions[0].levels, *design.cells[0].levels})
    if factor not in factors:
        remedy = f"Write --factor with one of {', '.join(factors) or 'its factors (there is none yet)'}"
        raise BadFile(folder.file, f"{factor} is not a factor", remedy)
    most = design.allocation.size
    sizes = tuple(sorted({*people})) or tuple(sorted({max(2, math.ceil(most * part / 6)) for part in range(1, 7)}))
    question = PowerQuestion(score, factor, sizes)
    # Results are stored under this key, so that they are reused only for the same question, experiment and set of
    # people.
    asked = f"{fingerprint_of(folder, versions()).digest} {question} {simulated}"
    place = results / hashlib.sha256(asked.encode()).hexdigest()[:16]
    return [
        PowerTask(root.resolve(), place.resolve(), question, simulated.without_games(), number, effects)
        for number in range(seed, seed + rehearsals)
        for effects in (True, False)
    ]


def estimate_shown(
    tasks: Sequence[PowerTask], engine: Engine[PowerTask], tell: Tell
) -> Mapping[bool, Sequence[PowerEstimate]]:
    """Run the rehearsals; `tell` receives the progress. See `estimate_power`."""
    with engine:
        return estimate_power(tasks, engine, lambda done: tell("rehearsals", done, len(tasks)))


def show_estimates(estimates: Mapping[bool, Sequence[PowerEstimate]], *, as_json: bool) -> None:
    """Print the power and the share of false positives for each number of people."""
    pairs = list(zip(estimates[True], estimates[False], strict=True))
    enough = next((power.people for power, _ in pairs if power.share >= ENOUGH), None)
    if as_json:
        rows = [
            {
                "people": power.people,
                "rehearsals": power.rehearsals,
                "power": power.share,
                "false_positives": none.share,
            }
            for power, none in pairs
        ]
        print_json({"level": LEVEL, "estimates": rows, "enough": enough})
        return
    table = Table("people", "power", "95 % interval", "false positives")
    for power, none in pairs:
        low, high = power.interval
        table.add_row(f"{power.people}", f"{power.share:.2f}", f"{low:.2f} to {high:.2f}", f"{none.share:.3f}")
    out.print(table)
    if enough is None:
        say(f"None of these numbers of people gives a power of {ENOUGH}. Try more people with --people.")
    else:
        say(f"{enough} people give a power of at least {ENOUGH}.")
