"""What a name means depends on who says it."""

import pytest

from thbridge.rosgraph.values.names import canonical, join, namespace, resolve


@pytest.mark.parametrize(
    ("name", "node", "meant"),
    [
        ("odom", "/robot1/amcl", "/robot1/odom"),
        ("odom", "/amcl", "/odom"),
        ("/odom", "/robot1/amcl", "/odom"),
        ("~rate", "/robot1/amcl", "/robot1/amcl/rate"),
        ("~/rate", "/robot1/amcl", "/robot1/amcl/rate"),
        ("", "/robot1/amcl", "/robot1/"),
        ("", "/amcl", "/"),
        ("//a//b/", "/x", "/a/b"),
        ("a//b/", "/x/y", "/x/a/b"),
        ("/", "/x", "/"),
    ],
)
def test_names_resolve_as_in_ros(name, node, meant):
    assert resolve(name, node) == meant


@pytest.mark.parametrize(("name", "space"), [("/a/b", "/a/"), ("/a/b/", "/a/"), ("/a", "/"), ("/", "/"), ("", "/")])
def test_a_namespace_ends_with_a_slash(name, space):
    assert namespace(name) == space


def test_joining():
    assert join("/a", "b") == join("/a/", "b") == "/a/b"
    assert join("/", "b") == "/b"
    assert join("", "b") == "b"
    assert join("/a", "/b") == "/b"
    assert join("/a", "~b") == "~b"


def test_canonical_names():
    assert canonical("//a//b//") == "/a/b"
    assert canonical("a/") == "a"
    assert canonical("/") == "/"
    assert canonical("") == ""
