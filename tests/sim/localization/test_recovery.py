import pytest

from sim.localization.recovery import Recovery


def averaged(values, slow=0.001, fast=0.1):
    recovery = Recovery()
    for value in values:
        recovery = recovery.after(value, slow, fast)
    return recovery


def test_a_steady_filter_is_never_lost():
    assert averaged([0.9] * 300).lost == 0.0
    assert Recovery().lost == 0.0


def test_a_moment_behind_other_robots_is_no_loss():
    assert averaged([0.95] * 100 + [0.5] * 5).lost == 0.0


def test_a_robot_carried_elsewhere_is_noticed_within_three_scans_but_not_by_one():
    assert averaged([0.95] * 100 + [0.3] * 3).unexplained
    assert not averaged([0.95] * 100 + [0.4]).unexplained


def test_walls_that_stay_away_are():
    assert averaged([0.95] * 100 + [0.3] * 20).lost > 0.2


def test_a_vague_first_scan_is_soon_forgotten():
    assert averaged([0.1] + [0.9] * 8, slow=0.0).slow == pytest.approx(0.9 - 0.8 / 9)
    assert averaged([0.1] + [0.9] * 50).slow > 0.8


def test_both_decays_zero_turn_recovery_off():
    assert averaged([0.9] * 50 + [0.1] * 50, slow=0.0, fast=0.0).lost == 0.0


def test_what_a_lost_filter_sees_does_not_become_usual():
    assert averaged([0.95] * 20 + [0.5] * 100).lost > 0.1
