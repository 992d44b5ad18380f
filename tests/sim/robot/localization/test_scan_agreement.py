import pytest

from sim.robot.localization.scan_agreement import ScanAgreement


def averaged(values, slow=0.001, fast=0.1):
    recovery = ScanAgreement()
    for value in values:
        recovery = recovery.after(value, slow, fast)
    return recovery


def test_a_steady_filter_is_never_lost():
    assert not averaged([0.9] * 300).lost
    assert not ScanAgreement().lost


def test_a_robot_carried_elsewhere_is_noticed_within_four_scans_but_by_no_fewer():
    assert averaged([0.98] * 100 + [0.3] * 4).lost
    assert not averaged([0.98] * 100 + [0.0] * 3).lost


def test_a_second_look_is_taken_after_one_bad_scan():
    assert not averaged([0.98] * 100).suspicious
    assert averaged([0.98] * 100 + [0.3]).suspicious


def test_a_moment_behind_other_robots_is_no_loss():
    assert not averaged([0.98] * 100 + [0.8] * 5).lost


def test_walls_that_stay_a_little_wrong_are_a_reason_to_look_but_no_loss():
    doubted = averaged([0.98] * 100 + [0.82])
    assert not doubted.suspicious
    doubted = averaged([0.98] * 100 + [0.82] * 25)
    assert doubted.suspicious
    assert not doubted.lost


def test_a_map_that_never_explains_all_is_no_loss():
    assert not averaged([0.82] * 300).lost


def test_a_vague_first_scan_is_soon_forgotten():
    assert averaged([0.1] + [0.9] * 8, slow=0.0).slow == pytest.approx(0.9 * 8 / 9)
    assert not averaged([0.1] + [0.9] * 8).lost


def test_both_decays_zero_leave_the_last_scans():
    assert not averaged([0.98] * 50 + [0.82] * 50, slow=0.0, fast=0.0).lost
    assert averaged([0.98] * 50 + [0.3] * 4, slow=0.0, fast=0.0).lost


def test_what_is_seen_from_elsewhere_does_not_become_usual():
    assert averaged([0.95] * 20 + [0.5] * 100).slow > 0.9
    recovery = averaged([0.95] * 20)
    for _ in range(100):
        recovery = recovery.searching(0.8)
    assert recovery.slow > 0.9
    assert not recovery.explained


def test_a_place_that_explains_as_much_as_usual_can_be_found_in():
    recovery = averaged([0.95] * 20 + [0.2] * 5)
    assert not recovery.explained
    for _ in range(5):
        recovery = recovery.searching(0.95)
    assert recovery.explained
