"""Faults of studies with games of several people."""

from collections.abc import Iterator, Sequence
from itertools import chain

from thbridge.experiment.design.experiment_file import ExperimentDesign, name_of
from thbridge.experiment.design.lobby import WaitRule
from thbridge.experiment.design.steps import StepEntry, StepKind
from thbridge.experiment.questionnaires.form import Scale
from thbridge.files.errors import BadFile
from thbridge.study.study_file import Study


def faults_of_lobby(design: ExperimentDesign) -> Iterator[BadFile]:
    """Yield faults that would keep people from playing together."""
    lobby = design.file.lobby
    if not design.has_groups:
        if written := next((key for key in design.lines if key.startswith("lobby")), None):
            problem = "no game of this study has several people"
            yield design.fault(written, problem, "Write `seats` in the study, or delete the section")
        return
    seats = {index: _seats(studies) for index, studies in _games(design).items()}
    values = list(_values(design))
    if lobby.by and not values:
        yield design.fault("lobby.by", *_unknown(design, lobby.by, min(seats, default=0)))
        return
    yield from _of_values(design, values)
    for names in dict.fromkeys(chain.from_iterable(seats.values())):
        yield from _of_seats(design, names)
    yield from _of_families(design)
    if lobby.same_group:
        yield from _of_same_group(design, seats)
    factor = design.pairing_factor
    for index in seats:
        if factor and factor in design.file.steps[index].only_at:
            problem = f"people with different levels of {factor} play together"
            yield design.fault(f"steps[{index}].only_at", problem, "Delete the line, or write another lobby.by")


def _games(design: ExperimentDesign) -> dict[int, Sequence[Study]]:
    """Return all studies of each game of several people, by the index of the step."""
    found = {}
    for index, entry in enumerate(design.file.steps):
        studies: Sequence[Study] = ()
        if entry.step is StepKind.TRIAL:
            studies = tuple(chain.from_iterable(cell.studies for cell in design.cells))
        elif entry.step is StepKind.PRACTICE:
            studies = tuple(chain.from_iterable(design.practices[index]))
        if any(study.seats for study in studies):
            found[index] = studies
    return found


def _seats(studies: Sequence[Study]) -> list[tuple[str, ...]]:
    return [*dict.fromkeys(tuple(seat.name for seat in study.seats) for study in studies if study.seats)]


def _values(design: ExperimentDesign) -> Iterator[str]:
    """Yield all levels or answers by which groups are formed; yield nothing if `by` names none."""
    by = design.file.lobby.by
    if design.pairing_factor:
        yield from dict.fromkeys(cell.levels[by] for cell in design.cells)
        return
    step, _, name = by.rpartition(".")
    first = min(_games(design), default=0)
    for index, form in design.forms.items():
        if name_of(index, design.file.steps[index]) == step and index < first:
            items = (item for item in form.items if item.id == name)
            chosen = (item for item in items if item.scale is Scale.CHOICE and not item.several)
            yield from chain.from_iterable(item.options for item in chosen)


def _unknown(design: ExperimentDesign, by: str, first: int) -> tuple[str, str]:
    """Return the problem and the remedy of a key `by` that names no factor between people and no earlier answer."""
    factors = [*design.cells[0].levels]
    items = [
        f"{name_of(index, design.file.steps[index])}.{item.id}"
        for index, form in design.forms.items()
        if index < first
        for item in form.items
        if item.scale is Scale.CHOICE and not item.several
    ]
    known = [*factors, *items]
    problem = f"{by} is neither a factor between people nor a chosen answer of a form before the first game"
    return problem, f"Write one of {', '.join(known)}" if known else "Add such a form, or delete the key"


def _of_values(design: ExperimentDesign, values: Sequence[str]) -> Iterator[BadFile]:
    """Yield faults of levels and answers in `quota` and `seat_of`."""
    lobby = design.file.lobby
    named = {f"lobby.quota.{value}": value for value in lobby.quota}
    named |= {f"lobby.seat_of.{seat}": value for seat, value in lobby.seat_of.items()}
    for key, value in named.items():
        if lobby.by and value not in values:
            problem = f"{value} is neither a level nor an answer of {lobby.by}"
            yield design.fault(key, problem, f"Write one of {', '.join(values)}")
    missing = [value for value in values if value not in named.values()]
    if missing and design.pairing_factor:
        problem = f"people at the level {missing[0]} of {lobby.by} could never play"
        yield design.fault("lobby.by", problem, "Write a number or a seat for each level")


def _of_seats(design: ExperimentDesign, seats: Sequence[str]) -> Iterator[BadFile]:
    """Yield faults of keys that do not fit the seats of a game."""
    lobby = design.file.lobby
    if lobby.quota and (people := sum(map(int, lobby.quota.values()))) != len(seats):
        problem = f"a group would have {people} people, but the game has {len(seats)} seats ({', '.join(seats)})"
        yield design.fault("lobby.quota", problem, f"Write numbers with the sum {len(seats)}")
    if lobby.seat_of and {*lobby.seat_of} != {*seats}:
        problem = f"the seats are {', '.join(lobby.seat_of)}, but those of the game are {', '.join(seats)}"
        yield design.fault("lobby.seat_of", problem, "Write each seat of the game once")
    if lobby.then is WaitRule.FEWER and lobby.least > len(seats):
        problem = f"a game with {len(seats)} seats cannot start with {lobby.least} people"
        yield design.fault("lobby.least", problem, f"Write at most {len(seats)}")


def _of_families(design: ExperimentDesign) -> Iterator[BadFile]:
    """Yield a fault if people who play together would play different games."""
    first: dict[str, tuple[Sequence[Study], ...]] = {}
    for cell, each in enumerate(design.cells):
        games = (each.studies, *(studies[cell] for studies in design.practices.values()))
        if first.setdefault(design.family(cell), games) != games:
            factor = design.pairing_factor
            problem = f"people at all levels of {factor} play together, but {factor} changes the study"
            remedy = "Write levels without keys of the study, such as {expert: {}, novice: {}}"
            yield design.fault(f"between.{factor}", problem, remedy)
            return


def _of_same_group(design: ExperimentDesign, seats: dict[int, list[tuple[str, ...]]]) -> Iterator[BadFile]:
    """Yield faults of studies in which a group cannot stay together."""
    steps, remedy = design.file.steps, "Write same_group: false under `lobby`, or change the study"
    if len({*chain.from_iterable(seats.values())}) > 1:
        by_cell = {design.family(cell): {*_seats(_of_cell(design, cell))} for cell in range(len(design.cells))}
        if any(len(each) > 1 for each in by_cell.values()):
            yield design.fault(
                "lobby", "games of a person have different seats, so a group cannot stay together", remedy
            )
    for index in seats:
        entry = steps[index]
        if entry.when:
            problem = "people of one group may have different answers, so some of them would skip this game"
            yield design.fault(f"steps[{index}].when", problem, remedy)
    for index, entry in enumerate(steps):
        if any(_repeats(design, index, entry, game) for game in seats):
            problem = "only some people of a group may fail the check and repeat the game"
            yield design.fault(f"steps[{index}].repeat", problem, "Name a later step, or delete `repeat`")


def _of_cell(design: ExperimentDesign, cell: int) -> list[Study]:
    return [*design.cells[cell].studies, *chain.from_iterable(each[cell] for each in design.practices.values())]


def _repeats(design: ExperimentDesign, index: int, check: StepEntry, game: int) -> bool:
    """Return True if a failed check may repeat a game."""
    if check.step is not StepKind.CHECK or check.attempts == 1 or not check.repeat:
        return False
    named = [number for number in range(index) if name_of(number, design.file.steps[number]) == check.repeat]
    return bool(named) and named[-1] <= game < index
