import pytest

from tests.support.ros.nested_types import PART, nested
from thbridge.ros.messages.foreign_types import MOST_FIELDS, register, store_of, types_in
from thbridge.ros.messages.types import md5_of, plain_definition


@pytest.mark.parametrize("name", ["", "/", "///", "9a/1b", "a", "a/b/c", "a/b\nint8 x", "a/" + "b" * 200, "a/б"])
def test_what_is_no_name_of_a_type_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="is not the name of a type"):
        types_in(name, "int8 a\n")


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        (nested(24), f"more than {MOST_FIELDS} fields"),
        (nested(40, "T{0} a\n"), "nests types"),
        ("".join(f"int8 f{index}\n" for index in range(60_000)), "lines"),
        ("int8 a #" + "x" * (1 << 20), "characters"),
        ("uint8[4000000000] a\n", "larger than"),
        (f"B[4000000000] a\n{PART}a/B\nstring b\n", "larger than"),
        ("T a\n", "contains itself"),
        ("float64 A=1e999\nint8 a\n", "not finite"),
        ("int64 A=" + "9" * 5000 + "\nint8 a\n", "cannot be parsed"),
        ("?", "cannot be parsed"),
        (f"int8 a\n{PART}9/1\nint8 b\n", "is not the name"),
    ],
)
def test_a_definition_out_of_bounds_is_refused(text: str, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        types_in("a/T" if text.startswith("T a") else "a/T0", text)
    assert md5_of("a/T" if text.startswith("T a") else "a/T0", text) is None


def test_definitions_within_the_bounds_are_read() -> None:
    assert len(types_in("a/T0", nested(12))) == 13
    for msgtype in ("nav_msgs/Odometry", "visualization_msgs/MarkerArray", "nav_msgs/OccupancyGrid"):
        plain = plain_definition(msgtype)
        assert md5_of(msgtype, plain.text) == plain.md5


def test_names_that_collide_are_refused() -> None:
    with pytest.raises(ValueError, match="collide"):
        store_of(types_in("a/T", "int8 a\nint16 a\n"))
    store = store_of(types_in("a/T", "int8 a\n"))
    with pytest.raises(ValueError, match="collide"):
        register(store, types_in("a/T", "int16 a\n"))
