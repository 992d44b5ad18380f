"""A robot's parameters as a ground station reads and turns them."""

import math
import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.inputs import SetSoftwareParameters, SetWorldParameters, TeamInput
from sim.parameters import ParameterRejection, RobotParameters, WorldParameters
from thbridge.app.compose.robots import build_simr, build_team
from thbridge.app.compose.setting import read_setting
from thbridge.mavlink.role.parameters import PARAMETERS, VehicleParameters, values_of
from thbridge.mavlink.values.vehicle_interface import Denied, ParameterDescription, ParameterSetting
from thbridge.roles.shared.robot_requests import ParameterValue, SetParameters, Tuning
from thbridge.roles.simr.simr import SimR
from thbridge.study.study_file import Study

SINGLES = st.floats(width=32, allow_nan=False, allow_infinity=False)
OF_NAME = {parameter.name: parameter for parameter in PARAMETERS}


def single(value: float) -> float:
    return struct.unpack("<f", struct.pack("<f", value))[0]


class Bench:
    """One robot whose parameters change at once, and what was asked of it."""

    def __init__(self) -> None:
        self.now: Tuning | None = Tuning(RobotParameters(), WorldParameters())
        self.asked: list[tuple[tuple[str, ParameterValue], ...]] = []
        self.vehicle = VehicleParameters(0, self)

    def tuning(self, robot: int) -> Tuning | None:
        return self.now

    def ask(self, request: SetParameters) -> None:
        self.asked.append(request.values)
        assert self.now is not None
        changed = self.now.changed(request.values)
        assert not isinstance(changed, ParameterRejection)
        self.now = changed

    def value(self, name: str) -> object:
        assert self.now is not None
        return dict(zip(OF_NAME, values_of(self.now), strict=True))[name]


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_all_are_told_in_one_order_as_they_are_alone(bench: Bench) -> None:
    settings = bench.vehicle.settings()
    assert [setting.name for setting in settings] == [parameter.name for parameter in PARAMETERS]
    assert [*settings] == [bench.vehicle.setting(setting.name) for setting in settings]
    assert all(setting.value == single(setting.value) for setting in settings)


def test_all_are_described_in_the_same_order_and_begin_within_their_bounds(bench: Bench) -> None:
    described = bench.vehicle.descriptions()
    assert [each.name for each in described] == [setting.name for setting in bench.vehicle.settings()]
    for each, setting in zip(described, bench.vehicle.settings(), strict=True):
        assert each.default is not None
        assert single(each.default) == setting.value
        assert each.minimum is None or each.minimum <= each.default
        assert each.maximum is None or each.default <= each.maximum
        assert not each.words or each.default in range(len(each.words))
        assert each.meaning and not each.fixed


def test_what_a_parameter_means_is_what_the_study_says_of_it(bench: Bench) -> None:
    described = {each.name: each for each in bench.vehicle.descriptions()}
    assert described["AMCL_UPD_MIN_D"] == ParameterDescription(
        "AMCL_UPD_MIN_D", "distance driven before the next filter update", "robot.amcl.update_min_d of the study",
        "robot", "amcl", "m", 0.2, 0.0, 5.0,
    )  # fmt: skip
    assert described["AMCL_LASER_MODEL"].words == ("likelihood_field", "likelihood_field_prob", "beam")
    assert described["MB_RECOV_ENABLE"].words == ("off", "on")
    assert described["AMCL_MAX_PART"].whole and not described["AMCL_KLD_ERR"].whole
    assert described["LC_ROBOT_RADIUS"].details == "robot.local_costmap.robot_radius of the study; 0: null"
    assert (described["SIM_LASER_DROP"].section, described["TP_SIM_TIME"].group) == ("world", "base_local_planner")


def test_its_default_is_that_of_the_session_s_beginning(bench: Bench) -> None:
    before = bench.vehicle.descriptions()
    bench.vehicle.change("AMCL_KLD_ERR", 0.25)
    assert bench.vehicle.descriptions() == before


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("AMCL_KLD_ERR", single(0.05)),
        ("AMCL_MAX_PART", 1000.0),
        ("AMCL_DO_BEAMSKIP", 0.0),
        ("MB_RECOV_ENABLE", 1.0),
        ("AMCL_LASER_MODEL", 0.0),
        ("LC_ROBOT_RADIUS", 0.0),
        ("SIM_ODOM_LIN_SCL", 1.0),
        ("SIM_LASER_DROP", single(0.005)),
    ],
)
def test_numbers_switches_and_words_are_told_as_numbers(bench: Bench, name: str, told: float) -> None:
    assert bench.vehicle.setting(name) == ParameterSetting(name, told)


def test_to_send_back_what_was_read_changes_nothing(bench: Bench) -> None:
    before = bench.now
    for setting in bench.vehicle.settings():
        assert bench.vehicle.change(setting.name, setting.value) == setting
    assert (bench.now, bench.asked) == (before, [])


@pytest.mark.parametrize(
    ("name", "value", "meant"),
    [
        ("TP_MAX_VEL_X", single(0.7), 0.7),
        ("TP_MAX_VEL_X", 0.7, 0.7),
        ("SIM_LASER_NOISE", single(0.1), 0.1),
        ("AMCL_MAX_PART", 300.0, 300),
        ("AMCL_DO_BEAMSKIP", 1.0, True),
        ("AMCL_LASER_MODEL", 2.0, "beam"),
        ("MB_LOCAL_PLAN", 1.0, "dwa_local_planner/DWAPlannerROS"),
        ("GC_ROBOT_RADIUS", single(0.35), 0.35),
        ("TP_ESC_VEL", single(-0.3), -0.3),
    ],
)
def test_what_is_set_is_the_studys_own_value_and_is_told_at_once(
    bench: Bench, name: str, value: float, meant: object
) -> None:
    assert bench.vehicle.change(name, value) == ParameterSetting(name, single(value))
    assert bench.asked == [((OF_NAME[name].declaration.path, meant),)]
    assert (bench.value(name), type(bench.value(name))) == (meant, type(meant))
    assert bench.vehicle.setting(name) == ParameterSetting(name, single(value))


def test_what_has_no_value_is_zero_both_ways(bench: Bench) -> None:
    assert bench.vehicle.change("LC_ROBOT_RADIUS", 0.25) == ParameterSetting("LC_ROBOT_RADIUS", 0.25)
    assert bench.vehicle.change("LC_ROBOT_RADIUS", 0.0) == ParameterSetting("LC_ROBOT_RADIUS", 0.0)
    assert bench.value("LC_ROBOT_RADIUS") is None


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [
        ("AMCL_KLD_ERR", math.nan, "AMCL_KLD_ERR is a number, not nan"),
        ("AMCL_KLD_ERR", math.inf, "AMCL_KLD_ERR is a number, not inf"),
        ("AMCL_KLD_ERR", -1e300, "AMCL_KLD_ERR is a number, not -inf"),
        ("AMCL_KLD_ERR", 1.5, "amcl.kld_err is at most 1, not 1.5"),
        ("AMCL_MAX_PART", math.nan, "AMCL_MAX_PART is a number, not nan"),
        ("AMCL_MAX_PART", 300.5, "AMCL_MAX_PART is a whole number, not 300.5"),
        ("AMCL_MAX_PART", 3e38, "amcl.max_particles is at most 100000"),
        ("AMCL_MAX_PART", 10.0, "above amcl.max_particles"),
        ("AMCL_DO_BEAMSKIP", 2.0, "AMCL_DO_BEAMSKIP is 0 or 1, not 2"),
        ("AMCL_LASER_MODEL", 3.0, "from 0 to 2, not 3"),
        ("AMCL_LASER_MODEL", -1.0, "from 0 to 2, not -1"),
        ("AMCL_LASER_MODEL", 0.5, "whole number"),
        ("SIM_LASER_DROP", -0.1, "world.laser.dropout is at least 0"),
        ("NO_SUCH", 1.0, "There is no parameter NO_SUCH."),
    ],
)
def test_what_cannot_be_is_denied_with_the_reason_and_nothing_changes(
    bench: Bench, name: str, value: float, why: str
) -> None:
    before = bench.vehicle.settings()
    denied = bench.vehicle.change(name, value)
    assert isinstance(denied, Denied)
    assert why in denied.sentence
    assert denied.sentence.endswith(".")
    assert (bench.vehicle.settings(), bench.asked) == (before, [])


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda parameter: parameter.name)
def test_every_bound_that_a_number_has_can_be_set(parameter) -> None:
    for bound in (parameter.declaration.minimum, parameter.declaration.maximum):
        if bound is not None and parameter.name not in {"AMCL_MIN_PART", "AMCL_MAX_PART"}:
            bench = Bench()
            wide = {"TP_MAX_VEL_X": "TP_MIN_VEL_X", "TP_MAX_VEL_TH": "TP_MIN_INPL_TH"}
            for name, value in ((wide.get(parameter.name), 0.0), ("TP_MAX_VEL_X", 20.0), ("TP_MAX_VEL_TH", 20.0)):
                if name is not None:
                    bench.vehicle.change(name, value)
            assert bench.vehicle.change(parameter.name, single(bound)) == ParameterSetting(
                parameter.name, single(bound)
            )


@given(SINGLES.filter(lambda value: abs(value) <= 5.0))
def test_every_number_is_told_back_as_it_was_sent_and_means_the_shortest_decimal(value: float) -> None:
    parameter, bench = OF_NAME["SIM_LASER_NOISE"], Bench()
    result = bench.vehicle.change(parameter.name, value)
    if value < 0.0:
        assert isinstance(result, Denied)
        return
    assert result == ParameterSetting(parameter.name, value) == bench.vehicle.setting(parameter.name)
    meant = bench.value(parameter.name)
    assert isinstance(meant, float)
    if value != single(0.02):
        assert repr(meant) == repr(float(np.format_float_scientific(np.float32(value), unique=True)))


@given(st.floats(0.0, 5.0))
def test_a_value_of_the_study_outlives_any_ground_station(value: float) -> None:
    bench = Bench()
    assert bench.now is not None
    laser = replace(bench.now.world.laser, range_noise=value)
    bench.now = replace(bench.now, world=replace(bench.now.world, laser=laser))
    told = bench.vehicle.setting("SIM_LASER_NOISE")
    assert told == ParameterSetting("SIM_LASER_NOISE", single(value))
    bench.vehicle.change(told.name, told.value)
    assert bench.value("SIM_LASER_NOISE") == value


@given(st.sampled_from(sorted(OF_NAME)), st.floats(width=32))
def test_whatever_is_set_the_answer_is_what_is_told_from_then_on(name: str, value: float) -> None:
    bench = Bench()
    before = bench.vehicle.setting(name)
    result = bench.vehicle.change(name, value)
    after = bench.vehicle.setting(name)
    assert after == (before if isinstance(result, Denied) else result)


# In a team


class Noted:
    """A team of the real program, and what comes to it."""

    def __init__(self) -> None:
        setting = read_setting(replace(Study(), robots=2), Path())
        self.team = build_team(setting)
        self.simr = build_simr(setting, self)
        self.inputs: list[TeamInput] = []

    @property
    def size(self) -> int:
        return self.team.size

    @property
    def parameters(self) -> tuple[RobotParameters, ...]:
        return self.team.parameters

    @property
    def worlds(self) -> tuple[WorldParameters, ...]:
        return self.team.worlds

    def step(self, inputs=()):
        self.inputs += inputs
        return self.team.step(inputs)


@pytest.fixture(scope="module")
def noted() -> Noted:
    return Noted()


def vehicles(simr: SimR) -> tuple[VehicleParameters, VehicleParameters]:
    return VehicleParameters(0, simr), VehicleParameters(1, simr)


def test_several_in_one_tick_all_hold_and_are_told_before_it(noted: Noted) -> None:
    one, other = vehicles(noted.simr)
    for name, value in (("AMCL_MAX_PART", 400.0), ("AMCL_MIN_PART", 200.0), ("SIM_LASER_DROP", 0.5)):
        assert one.change(name, value) == ParameterSetting(name, value) == one.setting(name)
    one.change("SIM_GYRO_NOISE", 0.25)
    assert other.setting("AMCL_MAX_PART") == ParameterSetting("AMCL_MAX_PART", 1000.0)
    noted.simr.step(0, ())
    software, world = noted.parameters[0], noted.worlds[0]
    assert (software.amcl.min_particles, software.amcl.max_particles) == (200, 400)
    assert (world.laser.dropout, world.gyro_noise) == (0.5, 0.25)
    assert [type(item) for item in noted.inputs] == [
        SetSoftwareParameters,
        SetSoftwareParameters,
        SetWorldParameters,
        SetWorldParameters,
    ]
    assert (noted.parameters[1], noted.worlds[1]) == (RobotParameters(), WorldParameters())


def test_what_others_change_is_told_too(noted: Noted) -> None:
    _, other = vehicles(noted.simr)
    noted.simr.ask(SetParameters(1, (("amcl.kld_err", 0.125), ("world.odometry.alpha1", 0.5))))
    assert other.setting("AMCL_KLD_ERR") == ParameterSetting("AMCL_KLD_ERR", 0.125)
    noted.simr.step(1, ())
    assert other.setting("AMCL_KLD_ERR") == ParameterSetting("AMCL_KLD_ERR", 0.125)
    assert other.setting("SIM_ODOM_ALPHA1") == ParameterSetting("SIM_ODOM_ALPHA1", 0.5)


def test_robots_of_others_have_none(bench: Bench) -> None:
    bench.now = None
    assert bench.vehicle.settings() == ()
    assert bench.vehicle.setting("AMCL_KLD_ERR") is None
    assert isinstance(bench.vehicle.change("AMCL_KLD_ERR", 0.1), Denied)
