"""One request of each kind that a watching researcher can send."""

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.inputs import (
    CancelGoal,
    ClearCostmaps,
    GlobalLocalization,
    KidnapRobot,
    KillRobot,
    NomotionUpdate,
    PlaceRobot,
    PutThing,
    RemoveThing,
    ReviveRobot,
    SendGoal,
    SetPoseEstimate,
)
from sim.robot.navigator.goals import Goal
from sim.world.thing import Thing
from thbridge.app.session.watch_requests import WatchRequest
from thbridge.roles.shared.robot_requests import SetParameters, WizardAdvice, WizardMode, WizardMove
from thbridge.ros.messages.records import CancelRequest, InitialPose, SimpleGoal, VelocityCommand

HERE = Pose2(1.0, 0.5, 0.1)
SURE = np.diag([0.1, 0.1, 0.01])
CRATE = Thing("crate", ((0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)), HERE)
GRANTED: list[WatchRequest] = [
    SendGoal(0, Goal(3, HERE)),
    CancelGoal(1),
    SimpleGoal(0, HERE, 3),
    CancelRequest(0, "", 0),
    VelocityCommand(1, Twist(0.2, 0.0)),
    InitialPose(0, HERE, SURE),
    SetPoseEstimate(1, HERE, SURE),
    GlobalLocalization(0),
    NomotionUpdate(0),
    ClearCostmaps(1),
    SetParameters(0, (("amcl.kld_err", 0.02), ("amcl.recovery_alpha_fast", 0.1), ("world.laser.range_noise", 0.3))),
    PutThing(CRATE),
    RemoveThing("crate"),
    KidnapRobot(1, HERE),
    PlaceRobot(0, HERE),
    KillRobot(1),
    ReviveRobot(1),
    WizardMode(1, on=True),
    WizardMove(3, 0, 0, "Off I go!"),
    WizardAdvice(0, 4),
]
