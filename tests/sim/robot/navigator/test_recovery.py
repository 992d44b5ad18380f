from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.parameters import MoveBaseParameters, RecoveryBehavior
from sim.robot.navigator.recovery import OscillationDetector, RecoveryBehaviours


def tried(recovery: RecoveryBehaviours) -> list[str]:
    names = []
    while (name := recovery.next()) is not None:
        names.append(name)
    return names


def test_the_order_is_that_of_ros() -> None:
    recovery = RecoveryBehaviours(MoveBaseParameters(), 0.4)
    order = ["conservative_reset", "rotate_recovery", "aggressive_reset", "rotate_recovery"]
    assert tried(recovery) == order
    assert tried(recovery) == []
    recovery.restart()
    assert tried(recovery) == order


def test_the_list_may_be_another_or_without_turns_or_off() -> None:
    one = (RecoveryBehavior("aggressive_reset"),)
    assert tried(RecoveryBehaviours(MoveBaseParameters(recovery_behaviors=one), 0.4)) == ["aggressive_reset"]
    still = MoveBaseParameters(clearing_rotation_allowed=False)
    assert tried(RecoveryBehaviours(still, 0.4)) == ["conservative_reset", "aggressive_reset"]
    assert tried(RecoveryBehaviours(MoveBaseParameters(recovery_behavior_enabled=False), 0.4)) == []


def test_resets_spare_a_square_around_the_robot() -> None:
    recovery = RecoveryBehaviours(MoveBaseParameters(conservative_reset_dist=5.0), 0.4)
    assert recovery.reset_side("conservative_reset") == 5.0
    assert recovery.reset_side("aggressive_reset") == 1.6


def test_a_robot_oscillates_when_it_has_not_got_far_for_long() -> None:
    oscillation = OscillationDetector(2.0, 0.5)
    oscillation.restart(0)
    oscillation.watch(0, Pose2(0, 0, 0))
    late = 2 * TICKS_PER_SECOND + 1
    oscillation.watch(late, Pose2(0.4, 0, 0))
    assert oscillation.due(late)
    oscillation.pause(10)
    assert not oscillation.due(late)
    oscillation.watch(late, Pose2(0.5, 0, 0))
    assert not oscillation.due(late + 2 * TICKS_PER_SECOND)


def test_without_a_timeout_nothing_oscillates() -> None:
    oscillation = OscillationDetector(0.0, 0.5)
    oscillation.restart(0)
    assert not oscillation.due(10**9)
