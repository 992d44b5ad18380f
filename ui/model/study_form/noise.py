"""Effects of the noise in a form, as values to draw."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from thbridge.offline.noise import PathSpread, RoomScan, belief_spread, covered, odometry_spread, room_scan
from thbridge.study.noise import (
    TARGET_PATHS,
    NoisePreset,
    NoiseSection,
    noise_section_of,
    preset,
    with_noise,
    with_value,
)
from thbridge.study.study_file import Study
from ui.model.study_form.form import FieldKind, FormField, editable_text

_ALMOST_NONE = 1e-3
"""An ellipse is drawn as a point if it is smaller than this, meters."""


@dataclass(frozen=True, slots=True, eq=False)
class CourseComparison:
    """Simulated drives of one course, the particle filter's predictions of them, and a sentence that compares both."""

    wheels: PathSpread
    believed: PathSpread
    verdict: str


@dataclass(frozen=True, slots=True, eq=False)
class NoisePreview:
    """Drawings of all noise."""

    straight: CourseComparison
    square: CourseComparison
    scan: RoomScan
    scan_words: str


def noise_from_form(fields: Iterable[FormField], typed: Mapping[str, str]) -> NoiseSection:
    """Return the noise of a form's fields.

    Typed values take precedence over values of the file; invalid typed values are ignored.

    Args:
        fields: fields of the section `noise`.
        typed: last typed values, by the keys of their fields.
    """
    noise = noise_section_of(Study())
    chosen = typed.get("noise.preset")
    if chosen in set(NoisePreset):
        noise = preset(NoisePreset(chosen), noise)
    for field in fields:
        if chosen is not None and field.written is None and field.key not in typed:
            continue  # The field's default is the value of the previous preset.
        path = field.key.removeprefix("noise.")
        value = _value(field, typed.get(field.key, editable_text(field)))
        if path in TARGET_PATHS and value is not None:
            noise = with_value(noise, path, value)
    return noise


def _value(field: FormField, typed: str) -> float | str | None:
    if field.kind is FieldKind.CHOICE:
        return typed if typed in field.choices else None
    try:
        value = float(typed)
    except ValueError:
        return None
    return value if field.minimum <= value <= field.maximum else None


def preview_of(study: Study, noise: NoiseSection) -> NoisePreview:
    """Return drives and a scan with this noise; all other values come from the study.

    This takes about 50 ms.
    """
    study = with_noise(noise, study)
    world, amcl = study.world, study.robot.amcl
    drives = []
    for course in ("straight", "square"):
        wheels = odometry_spread(world.odometry, course, world.max_vel_x, world.max_vel_theta)
        believed = belief_spread(amcl, course, world.max_vel_x, world.max_vel_theta)
        drives.append(CourseComparison(wheels, believed, _verdict(wheels, believed)))
    scan = room_scan(world)
    return NoisePreview(drives[0], drives[1], scan, _words_of(scan))


def _verdict(wheels: PathSpread, believed: PathSpread) -> str:
    """Return a sentence that compares the true noise with the noise that the filter assumes."""
    share = covered(wheels, believed)
    share_words = f"{100 * share:.0f} % of the drives end where the filter expects 95 % of them"
    if wheels.along < _ALMOST_NONE and believed.along < _ALMOST_NONE:
        return "The odometry has no error, and the filter expects none."
    if share < 0.8:
        return f"The filter assumes too little noise: {share_words}."
    if believed.along * believed.across > 9 * wheels.along * wheels.across:
        return f"The filter assumes too much noise: {share_words}, in a region far larger than necessary."
    return f"The filter's model of the noise fits the true noise: {share_words}."


def _words_of(scan: RoomScan) -> str:
    lost = f"{scan.lost or 'no'} {'range is' if scan.lost == 1 else 'ranges are'} lost"
    return f"{len(scan.seen)} of {scan.beams} beams measure a range; {lost}."


def extent_of(fan: PathSpread) -> str:
    """Return a text on the spread of the end points of simulated drives."""
    return f"95 % of the drives end within ± {fan.along:.2f} m by ± {fan.across:.2f} m"
