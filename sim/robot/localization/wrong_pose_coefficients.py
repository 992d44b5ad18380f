"""Coefficients of the models in `wrong_pose`, written by `scripts/fit_wrong_pose.py`."""

from sim.robot.localization.wrong_pose import GaussianEvidence, ParticleEvidence

PARTICLES = ParticleEvidence(
    always=-3.9026,
    lost=0.5537,
    anywhere=-2.5264,
    unproven=5.5924,
    unproven_updates=-0.6118,
    updates=-0.5449,
    unexplained=8.0640,
    lately_unexplained=-3.6831,
    below_usual=0.5478,
    misfit=-1.6122,
    lead=4.4370,
    rival=0.9010,
    unsettled=2.3817,
    outside=-2.4182,
    deviation=-0.0135,
    turn_deviation=0.6115,
)

GAUSSIANS = GaussianEvidence(
    always=-1.8411,
    forgotten=0.3460,
    lost=-0.0740,
    refused=-0.4112,
    poor=2.1499,
    unmatched=7.2937,
    matches=-0.6055,
    deviation=0.3449,
    turn_deviation=-0.1038,
    drive_noise=-0.7564,
    turn_noise=0.2152,
)
