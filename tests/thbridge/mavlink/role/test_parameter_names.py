"""The names of parameters in MAVLink: people write them into scripts, so they stay."""

import re

import pytest

from thbridge.mavlink.role.parameter_names import name_of
from thbridge.mavlink.role.parameters import PARAMETERS

PINNED = """
    AMCL_MIN_PART AMCL_MAX_PART AMCL_KLD_ERR AMCL_KLD_Z AMCL_UPD_MIN_D AMCL_UPD_MIN_A AMCL_RESAMP_INTV
    AMCL_RECOV_SLOW AMCL_RECOV_FAST AMCL_LASER_MODEL AMCL_MIN_RANGE AMCL_MAX_RANGE AMCL_MAX_BEAMS AMCL_Z_HIT
    AMCL_Z_SHORT AMCL_Z_MAX AMCL_Z_RAND AMCL_SIGMA_HIT AMCL_LAMB_SHORT AMCL_LIKELI_DIST AMCL_DO_BEAMSKIP
    AMCL_BSKIP_DIST AMCL_BSKIP_THR AMCL_ODOM_MODEL AMCL_ALPHA1 AMCL_ALPHA2 AMCL_ALPHA3 AMCL_ALPHA4 AMCL_ALPHA5
    AMCL_NOISE_LEARN EKF_UPD_MIN_D EKF_UPD_MIN_A EKF_MAX_BEAMS EKF_MAX_RANGE EKF_ALPHA1 EKF_ALPHA2 EKF_ALPHA3 EKF_ALPHA4
    EKF_GYRO_NOISE GC_ROBOT_RADIUS GC_FOOT_PAD GC_UPD_FREQ GC_PUB_FREQ GC_STATIC_ENABLE GC_OBS_ENABLE
    GC_OBS_FOOT_CLR GC_OBS_COMBINE GC_OBS_RANGE GC_OBS_RAYTRACE GC_INFL_ENABLE GC_INFL_RADIUS GC_INFL_COST_SCL
    GC_INFL_UNKNOWN LC_ROBOT_RADIUS LC_FOOT_PAD LC_UPD_FREQ LC_PUB_FREQ LC_STATIC_ENABLE LC_OBS_ENABLE
    LC_OBS_FOOT_CLR LC_OBS_COMBINE LC_OBS_RANGE LC_OBS_RAYTRACE LC_INFL_ENABLE LC_INFL_RADIUS LC_INFL_COST_SCL
    LC_INFL_UNKNOWN LC_WIDTH LC_HEIGHT GP_LETHAL_COST GP_NEUTRAL_COST GP_COST_FAC GP_ORIENT_MODE GP_ORIENT_WIN
    TP_ACC_LIM_X TP_ACC_LIM_TH TP_MAX_VEL_X TP_MIN_VEL_X TP_MAX_VEL_TH TP_MIN_VEL_TH TP_MIN_INPL_TH TP_ESC_VEL
    TP_ESC_RST_DIST TP_ESC_RST_TH TP_SIM_TIME TP_SIM_GRAN TP_ANG_SIM_GRAN TP_VX_SAMPLES TP_VTH_SAMPLES TP_DWA
    TP_PATH_BIAS TP_GOAL_BIAS TP_OCCDIST_SCL TP_HDG_LOOKAHEAD TP_HDG_SCORING TP_HDG_TIMESTEP TP_SIMPLE_ATTR
    TP_OSC_RST_DIST TP_XY_GOAL_TOL TP_YAW_GOAL_TOL DWA_ACC_LIM_X DWA_ACC_LIM_TH DWA_MAX_VEL_TRN DWA_MIN_VEL_TRN
    DWA_MAX_VEL_X DWA_MIN_VEL_X DWA_MAX_VEL_TH DWA_MIN_VEL_TH DWA_SIM_TIME DWA_SIM_GRAN DWA_ANG_SIM_GRAN
    DWA_VX_SAMPLES DWA_VTH_SAMPLES DWA_USE_DWA DWA_PATH_BIAS DWA_GOAL_BIAS DWA_OCCDIST_SCL DWA_TWIRLING_SCL
    DWA_FWD_PT_DIST DWA_SCL_SPEED DWA_MAX_SCL_FAC DWA_OSC_RST_DIST DWA_OSC_RST_ANG DWA_XY_GOAL_TOL
    DWA_YAW_GOAL_TOL DWA_TRN_STOP_VEL DWA_TH_STOP_VEL MB_GLOBAL_PLAN MB_LOCAL_PLAN MB_PLAN_FREQ MB_CTRL_FREQ
    MB_PLAN_PATIENCE MB_CTRL_PATIENCE MB_PLAN_RETRIES MB_OSC_TIMEOUT MB_OSC_DIST MB_RECOV_ENABLE MB_CLEAR_ROTATE
    MB_CONS_RST_DIST MB_PLAN_ADD_GOAL MB_SHUT_COSTMAPS SIM_GYRO_NOISE SIM_ODOM_ALPHA1 SIM_ODOM_ALPHA2
    SIM_ODOM_ALPHA3 SIM_ODOM_ALPHA4 SIM_ODOM_LIN_SCL SIM_ODOM_ANG_SCL SIM_LASER_NOISE SIM_LASER_BIAS
    SIM_LASER_DROP
"""
"""In the order in which they are told. New ones come; none of these ever changes or goes."""

OF_THE_VEHICLE = ("SYSID_", "FS_", "CRUISE_", "WP_", "ARMING_", "RC", "MAV_")
"""What ArduPilot's names for what a vehicle itself may be told begin with."""


def test_the_names_stay() -> None:
    assert [parameter.name for parameter in PARAMETERS] == PINNED.split()


def test_names_are_mavlinks_and_each_means_one_parameter() -> None:
    names = [parameter.name for parameter in PARAMETERS]
    assert len({*names}) == len(names)
    assert all(re.fullmatch(r"[A-Z][A-Z0-9_]{0,15}", name) for name in names)


def test_the_vehicles_own_names_are_left_to_it() -> None:
    assert not [parameter.name for parameter in PARAMETERS if parameter.name.startswith(OF_THE_VEHICLE)]


@pytest.mark.parametrize(
    ("path", "name"),
    [
        ("amcl.odom_alpha1", "AMCL_ALPHA1"),
        ("global_costmap.inflation_layer.inflation_radius", "GC_INFL_RADIUS"),
        ("DWAPlannerROS.max_vel_x", "DWA_MAX_VEL_X"),
        ("move_base.controller_frequency", "MB_CTRL_FREQ"),
        ("world.laser.range_noise", "SIM_LASER_NOISE"),
    ],
)
def test_a_name_comes_from_its_path(path: str, name: str) -> None:
    assert name_of(path) == name


def test_what_has_no_room_must_be_shortened_by_whoever_adds_it() -> None:
    with pytest.raises(ValueError, match=r"move_base.extraordinarily_long_word, has more than 16"):
        name_of("move_base.extraordinarily_long_word")
