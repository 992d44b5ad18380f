"""Coefficients of the models in `wrong_pose`, written by `scripts/fit_wrong_pose.py`."""

from sim.robot.localization.wrong_pose import GaussianEvidence, ParticleEvidence

PARTICLES = ParticleEvidence(
    always=-3.9823,
    lost=1.6353,
    anywhere=-1.3299,
    unproven=1.6412,
    unproven_updates=0.3834,
    updates=-0.5970,
    unexplained=7.5077,
    lately_unexplained=-3.1489,
    below_usual=0.5931,
    misfit=-0.7976,
    lead=1.3570,
    rival=0.8186,
    unsettled=2.5552,
    outside=-1.6444,
    deviation=-0.1935,
    turn_deviation=0.5538,
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
