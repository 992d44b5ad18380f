"""Simulated people of rehearsals, and the file with their properties."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path

import numpy as np

from sim.numerics import noise
from sim.parameters import param
from thbridge.dialogue.games.strategies import Attitude
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.questionnaires.form import MEASURED, Item, Scale
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE, right_answer
from thbridge.experiment.store.events import JsonValue
from thbridge.files.errors import FaultCollection
from thbridge.files.yaml.load import Loaded, load


@dataclass(frozen=True, slots=True)
class PutInEffect:
    """A simulated effect on a score of people's answers."""

    score: str = field(metadata={"help": "name of the score"})
    shift: float = param(0.1, "increase of the answers, as a share of the scale", "", -1, 1)
    where: Mapping[str, str] = field(
        default_factory=dict, metadata={"help": "levels with this effect: {FACTOR: LEVEL}; if empty, all levels"}
    )

    def holds(self, levels: Mapping[str, str]) -> bool:
        """Return True if the effect applies to people at these levels."""
        return all(levels.get(factor) == level for factor, level in self.where.items())


@dataclass(frozen=True, slots=True)
class SimulatedPeople:
    """Properties of simulated people, from the file `rehearsal.yaml`."""

    drop_out: float = param(0.02, "probability that a person leaves during a step", "", 0, 0.9)
    wrong: float = param(0.15, "probability of a wrong answer in a check", "", 0, 1)
    not_applicable: float = param(0.02, "probability of the answer 'not applicable', if an item allows it", "", 0, 1)
    spread: float = param(0.15, "standard deviation of answers between people, as a share of the scale", "", 0, 1)
    within: float = param(
        0.15, "standard deviation of a person's answers between items and conditions, as a share of the scale", "", 0, 1
    )
    effects: tuple[PutInEffect, ...] = param((), "effects on scores")
    attitudes: tuple[Attitude, ...] = param(
        (), "attitudes to robots' claims; each person has one of these attitudes; if empty, the attitude of the study"
    )
    words_per_minute: float = param(220.0, "reading speed of people", "1/min", 10, 2000)
    answering: float = param(4.0, "median time for answering an item", "s", 0.1, 600)
    hesitation: float = param(0.6, "spread of the answering time: standard deviation of its logarithm", "", 0, 3)
    crashes: float = param(0.0, "probability that the program crashes after an event and is restarted", "", 0, 0.5)
    arrivals: float = param(
        20.0, "in a study with games of several people: time between the arrivals of two people", "s", 0.1, 86400
    )
    plays: bool = param(default=True, help="play and record games; if false, trials end at once")

    def without_games(self) -> "SimulatedPeople":
        """Return the same people with trials that end at once. Simulated answers do not depend on games."""
        return replace(self, plays=False)

    def answer(
        self,
        item: Item,
        levels: Mapping[str, str],
        manner: float,
        draw: Callable[[], float],
        normal: Callable[[], float],
    ) -> JsonValue:
        """Return the answer of one person to an item.

        Args:
            item: item of a form.
            levels: level of each factor for the person.
            manner: the person's tendency to give higher answers in this form than other people; mean 0, variance 1.
            draw: source of random numbers from 0 to less than 1.
            normal: source of random numbers with mean 0 and variance 1.
        """
        right = right_answer(item, levels)
        if right is not None and draw() >= self.wrong:
            return list(right) if isinstance(right, tuple) else right
        if item.not_applicable and draw() < self.not_applicable:
            return NOT_APPLICABLE
        match item.scale:
            case Scale.CHOICE:
                return item.options[int(draw() * len(item.options))]
            case Scale.TEXT:
                return "an answer of a rehearsal"
        width = item.greatest - item.least
        shift = math.fsum(each.shift for each in self.effects if each.score == item.score and each.holds(levels))
        share = 0.5 + shift + self.spread * manner + self.within * normal()
        value = item.least + width * min(1.0, max(0.0, share))
        if item.reverse:
            value = item.least + item.greatest - value
        step = item.step if item.scale in {Scale.ANALOGUE, Scale.NUMBER} else 1.0
        steps = round((value - item.least) / step) if step > 0.0 else 0
        return item.least + steps * step if item.scale in MEASURED and step > 0.0 else value


def normal(stream: np.uint64, tick: int = 0) -> float:
    """Return a random number with mean 0 and variance 1: the sum of 12 uniform numbers, minus 6 (Irwin and Hall)."""
    return sum(chain.from_iterable(noise.uniform_pair(stream, tick, block) for block in range(6))) - 6.0


def read_people(path: Path, design: ExperimentDesign) -> SimulatedPeople:
    """Read the properties of simulated people. If the file does not exist, return the default properties.

    Raises:
        BadFile: the file cannot be read, or names a score, factor or level that the experiment does not have.
    """
    if not path.exists():
        return SimulatedPeople()
    loaded = load(path, SimulatedPeople)
    check_effects(loaded, design)
    return loaded.value


def check_effects(loaded: Loaded[SimulatedPeople], design: ExperimentDesign) -> None:
    """Check that the experiment has the scores, factors and levels of all effects.

    Raises:
        BadFile: the experiment does not have a score, factor or level.
    """
    scores = {name for form in design.forms.values() for name in form.subscales}
    levels: dict[str, set[str]] = {}
    for combination in (*(each.levels for each in design.conditions), *(each.levels for each in design.cells)):
        for factor, level in combination.items():
            levels.setdefault(factor, set()).add(level)
    faults = FaultCollection()
    for index, effect in enumerate(loaded.value.effects):
        key = f"effects[{index}]"
        if effect.score not in scores:
            remedy = f"Write one of {_listed(scores)}"
            faults.found.append(loaded.fault(f"{key}.score", f"no form has a score {effect.score}", remedy))
        for factor, level in effect.where.items():
            if factor not in levels:
                remedy = f"Write one of {_listed({*levels})}"
                faults.found.append(loaded.fault(f"{key}.where", f"{factor} is not a factor", remedy))
            elif level not in levels[factor]:
                remedy = f"Write one of {_listed(levels[factor])}"
                faults.found.append(loaded.fault(f"{key}.where", f"{factor} has no level {level}", remedy))
    if faults.found:
        raise faults.together()


def _listed(names: set[str]) -> str:
    return ", ".join(sorted(names)) or "none, because the study has none"
