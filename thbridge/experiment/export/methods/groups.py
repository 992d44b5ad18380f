"""Text on games of several people: seats, how groups were formed, and the groups that played."""

import statistics
from collections.abc import Iterator

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.lobby import LeavingRule, SeatOrder, WaitRule
from thbridge.experiment.export.methods.markdown import counted, joined, paragraph, table
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.lobby import SeatHolder
from thbridge.study.seats import SeatEntry


def groups_section(records: ExperimentRecords, people: str) -> Iterator[str]:
    """Yield the lines of the section; nothing if each game has one participant. `people` as for `design_section`."""
    design = records.design
    if not design.has_groups:
        return
    yield "### Groups and seats"
    yield ""
    seats = {seat.name: seat for cell in design.cells for study in cell.studies for seat in study.seats}
    yield from paragraph(f"Several {people} played one game together. Each of them had a seat:")
    yield from table("Seats", ("Seat", "Robots at the start", "Rights and sight"), map(_seat, seats.values()))
    yield from paragraph(_forming(design), _waiting(design), _leaving(design))
    trials = [group for group in records.groups if group.attempt.step.trial is not None]
    if not trials:
        return
    whole = [group for group in trials if not group.game.incomplete]
    programs = sum(SeatHolder.PROGRAM in {*group.game.began.values(), *group.game.seats.values()} for group in trials)
    waits = [wait for group in trials for wait in group.waited.values()]
    yield from paragraph(
        f"The data contain {counted(len(trials), 'game')} of {len({group.game.group for group in trials})} groups. "
        f"{len(whole)} of these games had a person in each seat from the start to the end; in {programs} games, a "
        "program held a seat (the tables declare each of these seats).",
        f"People waited for their group for a median of {statistics.median(waits):.0f} s, and at most {max(waits):.0f} "
        "s."
        if waits
        else "",
    )


def _seat(seat: SeatEntry) -> tuple[str, str, str]:
    may = [
        words
        for has, words in (
            (seat.names_treasures, "names treasures"),
            (seat.talks, "talks with robots"),
            (seat.takes_over and seat.talks, "takes over robots"),
            (seat.ends_game, "may end the game"),
        )
        if has
    ]
    hidden = [
        words
        for sees, words in (
            (seat.sees_energy, "energy"),
            (seat.sees_map, "the map"),
            (seat.sees_score, "the score"),
        )
        if not sees
    ]
    robots = joined([str(robot) for robot in seat.robots]) if seat.robots else "none"
    sight = f"does not see {joined(hidden)}" if hidden else ""
    return seat.label or f"the {seat.name}", robots, "; ".join([*may, *([sight] if sight else [])])


def _forming(design: ExperimentDesign) -> str:
    lobby = design.file.lobby
    if lobby.seat_of:
        each = joined([f"{value} got the seat {seat}" for seat, value in lobby.seat_of.items()])
        formed = f"A group had one person for each seat, by {lobby.by}: a person with {each}."
    elif lobby.quota:
        each = joined([f"{number} with {value}" for value, number in lobby.quota.items()])
        formed = f"A group had {each} (by {lobby.by}), in the order of their arrival."
    else:
        formed = "People formed groups in the order of their arrival."
    drawn = f" Seats were assigned at random (seed {design.file.seed})." if lobby.seats is SeatOrder.RANDOM else ""
    seats = "" if lobby.seat_of else drawn or " The person who had waited longest got the first seat, and so on."
    again = "A group stayed together for all games." if lobby.same_group else "New groups were formed for each game."
    return f"{formed}{seats} {again}"


def _waiting(design: ExperimentDesign) -> str:
    lobby = design.file.lobby
    then = {
        WaitRule.PAY: "the study ended for this person with a completion code, and the run did not count",
        WaitRule.FEWER: f"the game started with at least {lobby.least} people, and the other seats were empty",
        WaitRule.PROGRAM: "the game started, and programs (simulated participants) took the other seats",
    }
    return f"If a group was not complete after {lobby.wait:g} s, {then[lobby.then]}."


def _leaving(design: ExperimentDesign) -> str:
    lobby = design.file.lobby
    then = {
        LeavingRule.END: "the game ended, and the other people went on to the next step",
        LeavingRule.EMPTY: "the seat was empty until the person came back",
        LeavingRule.PROGRAM: "a program took the seat until the person came back",
    }
    counts = "counted" if lobby.incomplete_counts else "were paid and did not count"
    return (
        f"If a person left a game, or was absent from it for more than {design.file.presence.grace:g} s, "
        f"{then[lobby.leaving]}. Runs with such a game {counts}."
    )
