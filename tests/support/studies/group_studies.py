"""Studies with games of several people."""

from pathlib import Path

from tests.support.studies.experiment_files import write_experiment
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.rehearsal.people import SimulatedPeople
from thbridge.experiment.rehearsal.rehearsal import rehearse

SEATS = "[{name: driver, robots: [1, 2]}, {name: namer}]"
BASE = f"map: arena8, robots: 2, game.energy: 15, dialogue.condition: supervisor, seats: {SEATS}"


def group_study(
    lobby: str = "{}",
    steps: str = "[{step: trial, max_seconds: 60}]",
    further: str = "",
    base: str = BASE,
    quota: int = 2,
) -> str:
    """Return the file of a study in which two people play together."""
    return (
        f"title: Two together\nconsent_elsewhere: on paper\nbase: {{{base}}}\nquota: {quota}\nlobby: {lobby}\n"
        f"steps: {steps}\n{further}"
    )


PAIRS = group_study(
    steps="[{step: check, form: understood.yaml}, {step: trial, each_condition: true, max_seconds: 120}, "
    "{step: form, form: trust, each_condition: true}, {step: debrief, text: debrief.md}]",
    further="within: {noise.preset: [none, bad wheels]}\n",
    quota=8,
)


def rehearsed(root: Path, text: str, people: SimulatedPeople, seed: int = 3) -> ExperimentFolder:
    """Rehearse a study in a new folder."""
    root.mkdir(exist_ok=True)
    folder = ExperimentFolder(root)
    write_experiment(root, text)
    rehearse(folder, folder.read(), people, seed)
    return folder
