"""The section `noise` of a study: true sensor noise, and the noise models of the estimators.

A study stores each of these numbers under one key, in `world` or in `robot`. The section `noise` lets people write all
of these numbers in one section. `TARGET_PATHS` gives the key of each number in the study.
"""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar, cast

from sim.parameters import AmclParameters, EkfParameters, LaserParameters, OdometryNoise, WorldParameters, param
from thbridge.files.yaml.load import load_tree
from thbridge.files.yaml.merge import nested, over, without
from thbridge.files.yaml.places import node_at
from thbridge.files.yaml.tree import Node, Scalar, Section, parse

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")
S = TypeVar("S", bound="DataclassInstance")


def _as_in(section: type["DataclassInstance"], name: str, kind: type[T]) -> T:
    """Return a field with the declaration of the field `name` in `section`."""
    (found,) = (field for field in dataclasses.fields(section) if field.name == name)
    return cast(T, dataclasses.field(default=found.default, metadata=found.metadata))


class NoisePreset(StrEnum):
    """Name of a set of noise values; see `PRESETS`."""

    NONE = "none"
    PERFECT = "perfect"
    TURTLEBOT2 = "turtlebot2"
    BAD_WHEELS = "bad wheels"


@dataclass(frozen=True, slots=True)
class LaserNoise:
    """True noise of the laser."""

    range_noise: float = _as_in(LaserParameters, "range_noise", float)
    range_bias: float = _as_in(LaserParameters, "range_bias", float)
    dropout: float = _as_in(LaserParameters, "dropout", float)


@dataclass(frozen=True, slots=True)
class AmclNoiseBelief:
    """Noise model of the particle filter."""

    odom_model_type: str = _as_in(AmclParameters, "odom_model_type", str)
    odom_alpha1: float = _as_in(AmclParameters, "odom_alpha1", float)
    odom_alpha2: float = _as_in(AmclParameters, "odom_alpha2", float)
    odom_alpha3: float = _as_in(AmclParameters, "odom_alpha3", float)
    odom_alpha4: float = _as_in(AmclParameters, "odom_alpha4", float)
    laser_sigma_hit: float = _as_in(AmclParameters, "laser_sigma_hit", float)
    laser_z_hit: float = _as_in(AmclParameters, "laser_z_hit", float)
    laser_z_rand: float = _as_in(AmclParameters, "laser_z_rand", float)


@dataclass(frozen=True, slots=True)
class EkfNoiseBelief:
    """Noise model of the Kalman filter. The filter itself estimates the laser's noise from every scan."""

    odom_alpha1: float = _as_in(EkfParameters, "odom_alpha1", float)
    odom_alpha2: float = _as_in(EkfParameters, "odom_alpha2", float)
    odom_alpha3: float = _as_in(EkfParameters, "odom_alpha3", float)
    odom_alpha4: float = _as_in(EkfParameters, "odom_alpha4", float)
    gyro_noise: float = _as_in(EkfParameters, "gyro_noise", float)


@dataclass(frozen=True, slots=True)
class NoiseBeliefs:
    """Noise models of the estimators."""

    amcl: AmclNoiseBelief = param(AmclNoiseBelief(), "the particle filter")
    ekf: EkfNoiseBelief = param(EkfNoiseBelief(), "the Kalman filter; it estimates the laser's noise from the scans")


@dataclass(frozen=True, slots=True)
class NoiseSection:
    """True sensor noise, and the estimators' noise models."""

    preset: NoisePreset = param(
        NoisePreset.NONE,
        "set of noise values (`none`: the defaults, `perfect`: no noise); the keys below override single values",
    )
    odometry: OdometryNoise = param(OdometryNoise(), "actual odometry noise")
    laser: LaserNoise = param(LaserNoise(), "actual laser noise")
    gyro_noise: float = _as_in(WorldParameters, "gyro_noise", float)
    believed: NoiseBeliefs = param(NoiseBeliefs(), "noise model in the software of every robot")


_SECTIONS = {
    "odometry": "world.odometry",
    "laser": "world.laser",
    "believed.amcl": "robot.amcl",
    "believed.ekf": "robot.ekf",
}


def _homes() -> Iterator[tuple[str, str]]:
    for section, home in _SECTIONS.items():
        for field in dataclasses.fields(cast("DataclassInstance", value_at(NoiseSection(), section))):
            yield f"{section}.{field.name}", f"{home}.{field.name}"
    yield "gyro_noise", "world.gyro_noise"


def value_at(section: object, path: str) -> object:
    """Return the value at a path of names, such as `robot.amcl.kld_err`."""
    for name in path.split("."):
        section = cast(object, getattr(section, name))
    return section


def with_value(section: T, path: str, value: object) -> T:
    """Return a copy of the section with `value` at a path of names."""
    return with_values(section, {path: value})


def with_values(section: T, values: Mapping[str, object]) -> T:
    """Return a copy of the section with new values at paths of names. Each inner section is copied only once."""
    own: dict[str, object] = {}
    inner: dict[str, dict[str, object]] = {}
    for path, value in values.items():
        name, _, rest = path.partition(".")
        if rest:
            inner.setdefault(name, {})[rest] = value
        else:
            own[name] = value
    for name, changed in inner.items():
        own[name] = with_values(cast(object, getattr(section, name)), changed)
    return cast(T, dataclasses.replace(cast("DataclassInstance", section), **own))


TARGET_PATHS: Mapping[str, str] = dict(_homes())
"""Path of each number in the study, by its path in the section `noise`."""


def noise_section_of(study: object) -> NoiseSection:
    """Return the section `noise` that describes this study."""
    return with_values(NoiseSection(), {path: value_at(study, home) for path, home in TARGET_PATHS.items()})


def with_noise(section: NoiseSection, study: T) -> T:
    """Return a copy of the study with the numbers of the section `noise`."""
    return with_values(study, {home: value_at(section, path) for path, home in TARGET_PATHS.items()})


def resolve_noise(tree: Node) -> Node:
    """Return the tree of a study after moving the numbers of its section `noise` to their own keys.

    The moved numbers keep their line numbers, because messages show these. A number stays in the section if the study
    also sets the number's own key. All other entries stay in the section, too. So the reader reports each fault at the
    right line.
    """
    moved: Node = Section(1, [])
    rest = tree
    for path, home in TARGET_PATHS.items():
        written = f"noise.{path}".split(".")
        number = node_at(tree, written)
        if isinstance(number, Scalar) and _stands_once(tree, written) and node_at(tree, home.split(".")) is None:
            moved = over(moved, nested(home, number, number.line, f"noise.{path}"))
            rest = without(rest, written)
    return over(moved, rest)


def _stands_once(tree: Node, path: Sequence[str]) -> bool:
    above = node_at(tree, path[:-1])
    return isinstance(above, Section) and [key.text for key, _ in above.entries].count(path[-1]) == 1


def preset_in(tree: Node) -> NoisePreset:
    """Return the noise preset that the tree of a study names, or `NoisePreset.NONE`."""
    for name in ("noise", "preset"):
        if not isinstance(tree, Section):
            return NoisePreset.NONE
        tree = next((node for key, node in tree.entries if key.text == name), Scalar("", True, 1))
    named = tree.text if isinstance(tree, Scalar) else ""
    return NoisePreset(named) if named in set(NoisePreset) else NoisePreset.NONE


def tree_of_preset(name: NoisePreset) -> Node:
    """Return the tree of a study with the numbers of a preset and no other keys."""
    section = parse(Path(f"preset {name}"), PRESETS[name])
    return without(resolve_noise(nested("noise", section, section.line)), ("noise",))


def preset(name: NoisePreset, standard: NoiseSection) -> NoiseSection:
    """Return the numbers of a preset; numbers that the preset omits come from `standard`."""
    path = Path(f"preset {name}")
    return load_tree(path, parse(path, PRESETS[name]), NoiseSection, standard).value


PRESETS: Mapping[NoisePreset, str] = {
    NoisePreset.NONE: "",
    NoisePreset.PERFECT: """
odometry: {alpha1: 0, alpha2: 0, alpha3: 0, alpha4: 0}
laser: {range_noise: 0, dropout: 0}
gyro_noise: 0
believed:
  amcl: {odom_alpha1: 0.01, odom_alpha2: 0.01, odom_alpha3: 0.01, odom_alpha4: 0.01, laser_sigma_hit: 0.05}
  ekf: {odom_alpha1: 0, odom_alpha2: 0, odom_alpha3: 0, odom_alpha4: 0, gyro_noise: 0}
""",
    NoisePreset.TURTLEBOT2: """
odometry: {alpha1: 0.02, alpha2: 0.02, alpha3: 0.02, alpha4: 0.02, linear_scale: 1.005, angular_scale: 1.01}
laser: {range_noise: 0.02, dropout: 0.01}
gyro_noise: 0.004
believed:
  amcl:
    odom_alpha1: 0.2
    odom_alpha2: 0.2
    odom_alpha3: 0.2
    odom_alpha4: 0.2
    laser_sigma_hit: 0.2
    laser_z_hit: 0.5
    laser_z_rand: 0.5
  ekf: {odom_alpha1: 0.02, odom_alpha2: 0.02, odom_alpha3: 0.02, odom_alpha4: 0.02, gyro_noise: 0.004}
""",
    NoisePreset.BAD_WHEELS: """
odometry: {alpha1: 0.1, alpha2: 0.1, alpha3: 0.1, alpha4: 0.1, linear_scale: 1.05, angular_scale: 1.1}
believed:
  amcl:
    odom_model_type: diff-corrected
    odom_alpha1: 0.05
    odom_alpha2: 0.02
    odom_alpha3: 0.02
    odom_alpha4: 0.02
  ekf: {odom_alpha1: 0.1, odom_alpha2: 0.1, odom_alpha3: 0.1, odom_alpha4: 0.1}
""",
}
"""YAML text of the section `noise` for each preset.

turtlebot2: a Kobuki base and an RPLidar A1. The wheels' scales are the errors of an uncalibrated base (Borenstein and
Feng 1996 report up to a few percent). The gyroscope's noise is 0.03 deg/s per root hertz (data sheet of the L3G4200D)
at a bandwidth of 50 Hz. The range noise is 1 % at a range of 2 m (data sheet of the A1M8). The particle filter's noise
model is from turtlebot_navigation's amcl.launch.xml.
"""
