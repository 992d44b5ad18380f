"""Hunts of several simulated people in all seat plans: drawn by their seeds alone, and played to their ends."""

from dataclasses import replace

import pytest

from scripts.try_seats import PEOPLE, PLANS, Hunt, Outcome, play, row, study_of
from tests.support.project import ROOT
from thbridge.dialogue.games.strategies import Attitude
from thbridge.study.study_file import read_study_text
from thbridge.study.text import resolved


@pytest.mark.parametrize("plan", PLANS)
def test_each_plan_is_a_valid_study_for_each_number_of_people(plan: str):
    for people in PEOPLE:
        study = study_of(Hunt(plan, people, 7, simulated=False))
        assert len(study.seats) == people
        assert read_study_text(ROOT / "seats.yaml", resolved(study)) == study


def test_people_are_drawn_by_the_seed():
    studies = [study_of(Hunt("roles", 4, seed, simulated=False)) for seed in range(20)]
    assert {seat.attitude for study in studies for seat in study.seats} == set(Attitude)
    assert study_of(Hunt("roles", 4, 3, simulated=False)) == studies[3]


@pytest.mark.parametrize("plan", PLANS)
def test_a_hunt_of_each_plan_ends(plan: str):
    outcome = play(Hunt(plan, 3, 5, simulated=False))
    assert (outcome.ended, outcome.fault) == (True, "")
    assert outcome.rooms > 0
    assert (outcome.votes > 0) == (plan == "majority")
    assert play(outcome.hunt) == outcome


def test_a_row_counts_hunts_that_are_stuck_or_failed():
    hunt = Hunt("roles", 2, 1, simulated=False)
    good = Outcome(hunt, ended=True, score=100, votes=2, agreement=0.5, seconds_to_decide=3.0)
    cells = row("roles", 2, [good, replace(good, ended=False, score=50), Outcome(hunt, fault="KeyError()")]).split(
        " | "
    )
    assert cells[:5] == ["| roles", "2", "3", "2", "1"]
    assert cells[9:11] == ["0.50 ± 0.00", "3.00 ± 0.00"]
