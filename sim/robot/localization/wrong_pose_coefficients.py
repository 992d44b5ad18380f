"""Coefficients of the models in `wrong_pose`, written by `scripts/fit_wrong_pose.py`."""

from sim.robot.localization.wrong_pose import GaussianEvidence, ParticleEvidence

PARTICLES = ParticleEvidence(
    always=-3.6742,
    lost=1.4113,
    anywhere=-1.0175,
    unproven=1.5026,
    unproven_updates=0.4004,
    updates=-0.6441,
    unexplained=7.7630,
    lately_unexplained=-3.2228,
    below_usual=0.7527,
    misfit=-0.7410,
    lead=1.5243,
    rival=0.9294,
    unsettled=2.2274,
    outside=-1.5387,
    deviation=-0.1740,
    turn_deviation=0.5483,
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
