"""Text on materials and apparatus: the task, robots, programs, and settings that are not the defaults."""

from collections.abc import Iterator, Mapping

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.methods.markdown import paragraph, table
from thbridge.experiment.export.methods.settings import same_in_all, settings_that_differ
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.store.events import FrontEnd


def materials_section(records: ExperimentRecords, versions: Mapping[str, str], people: str) -> Iterator[str]:
    """Yield the lines of the section.

    Args:
        records: records of the experiment.
        versions: versions of the programs.
        people: "participants" or "simulated participants".
    """
    design = records.design
    yield "### Materials and apparatus"
    yield ""
    if any(entry.step is StepKind.TRIAL for entry in design.file.steps):
        yield from paragraph(*_task(design))
        yield from paragraph("[A picture of the participant's window.]")
    software = f"thbridge {versions.get('thbridge', '[version]')} with Python {versions.get('python', '[version]')}"
    language = f"The language of the program's own texts was {same_in_all(design, 'dialogue.language')}."
    shown = "No window was shown." if records.is_rehearsal else _front_ends(records)
    yield from paragraph(
        f"The study ran on {software}. The robots and their surroundings were simulated. {shown} {language}",
        "[Computer, operating system, screen size and resolution, mouse or other input, sound, room, number of "
        "stations, people present, and the language of texts and forms.]",
    )
    differ = list(settings_that_differ(design))
    yield from table("Settings of the games that differ from the defaults", ("Key", "Default", "Here"), differ)
    if not differ:
        yield from paragraph("All settings of the games were the defaults of this release.")


def _front_ends(records: ExperimentRecords) -> str:
    """Return a sentence about the programs in which people took part."""
    browsers = sum(run.front_end == FrontEnd.BROWSER for run in records.runs)
    if not browsers:
        return "All pages and games were shown in one window."
    if browsers == len(records.runs):
        return "Participants took part in a browser on their own devices; a server ran the study and the games."
    return (
        f"{browsers} of {len(records.runs)} participants took part in a browser; the others saw all pages and games in "
        "one window."
    )


def _task(design: ExperimentDesign) -> Iterator[str]:
    def value(key: str) -> str:
        return same_in_all(design, key)

    yield (
        f"The task was a treasure hunt. One participant and {_team(value('robots'))} searched the rooms of a building "
        f"(map {value('map')}; treasures {value('templates')})."
    )
    yield (
        "The participant sent robots to rooms, could order pictures there, and named the treasure in a room. Each "
        "robot "
        f"started with {value('game.energy')} units of energy. A move cost energy. A picture cost "
        f"{value('game.picture_cost')} units, and naming a treasure cost {value('game.identify_cost')}."
    )
    share = value("game.wrong_share")
    loss = "lost the same number of points" if share == "1" else f"lost {share} of that number"
    yield f"A right name won the points of the treasure. A wrong name {loss}."
    limits = sorted({entry.max_seconds for entry in design.file.steps if entry.step is StepKind.TRIAL})
    yield (
        "A game ended when all rooms were visited, when no robot could pay for a move, when the participant ended it, "
        f"or after {' or '.join(f'{limit:g}' for limit in limits)} s."
    )
    conditions = sorted({str(study.dialogue.condition) for cell in design.cells for study in cell.studies})
    yield from (_CONDITIONS[condition] for condition in conditions)
    rates = sorted({study.rate or 1.0 for cell in design.cells for study in cell.studies})
    speed = "the speed" if rates == [1.0] else f"{' or '.join(f'{rate:g}' for rate in rates)} times the speed"
    yield f"Simulated time ran at {speed} of real time."


def _team(robots: str) -> str:
    return "one simulated mobile robot" if robots == "1" else f"a team of {robots} simulated mobile robots"


_CONDITIONS = {
    "supervisor": "In the condition *supervisor*, robots did what the participant said.",
    "script": "In the condition *script*, robots asked fixed questions before they acted, and the participant decided.",
    "collaborator": (
        "In the condition *collaborator*, robots argued with the participant, and both sides had to agree before a "
        "robot acted."
    ),
    "adviser": "In the condition *adviser*, robots argued with the participant, who had the last word.",
    "autonomous": "In the condition *autonomous*, robots argued with the participant and had the last word.",
}
"""Sentence about each dialogue condition."""
