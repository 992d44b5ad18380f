"""Parameters in namespaces, and who hears of a change."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.rosgraph.wire import parameter_tree
from thbridge.rosgraph.wire.parameter_tree import ParameterTree, ParameterUpdate, updates

names = st.sampled_from("abc")
values = st.recursive(st.integers(), lambda inner: st.dictionaries(names, inner, max_size=3), max_leaves=6)
keys = st.lists(names, min_size=1, max_size=3).map(lambda path: "/" + "/".join(path))


@given(st.lists(st.tuples(keys, values)), keys, values)
def test_what_is_set_is_there_until_deleted(before, key, value):
    tree = ParameterTree()
    for earlier, other in before:
        tree.set(earlier, other)
    handed_out = tree.get("/")
    copied = repr(handed_out)
    tree.set(key, value)
    assert tree.get(key) == value
    tree.delete(key)
    assert key not in tree
    with pytest.raises(KeyError):
        tree.delete(key)
    assert repr(handed_out) == copied  # what was handed out does not change under way


@given(st.lists(st.tuples(keys, st.none() | values)), keys, values)
def test_values_are_counted_whatever_replaced_what(before, key, value):
    tree = ParameterTree()
    for earlier, other in before:
        if other is not None:
            tree.set(earlier, other)
        elif earlier in tree:
            tree.delete(earlier)
    unbounded = ParameterTree()
    unbounded.set("/", tree.get("/"))
    unbounded.set(key, value)

    def nested(each):
        return 1 + sum(map(nested, each.values())) if isinstance(each, dict) else 1

    def letters(each):
        return sum(len(name) + letters(inner) for name, inner in each.items()) if isinstance(each, dict) else 0

    after = unbounded.get("/")
    for limit, count in (("MAX_VALUES", nested(after)), ("MAX_CHARACTERS", letters(after))):
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(parameter_tree, limit, count - 1)
            with pytest.raises(ValueError, match=f"more than {count - 1} par|longer than {count - 1} char"):
                tree.set(key, value)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parameter_tree, "MAX_VALUES", nested(after))
        patch.setattr(parameter_tree, "MAX_CHARACTERS", letters(after))
        tree.set(key, value)
    assert tree.get("/") == after


def test_names_are_those_of_leaves():
    tree = ParameterTree()
    tree.set("/", {"a": 1, "b": {"c": [2], "d": {}}})
    tree.set("/e/f", 3)
    assert tree.names() == ["/a", "/b/c", "/e/f"]


def test_a_value_in_the_way_becomes_a_namespace():
    tree = ParameterTree()
    tree.set("/a", 1)
    tree.set("/a/b", 2)
    assert tree.get("/") == {"a": {"b": 2}}


def test_the_root_is_a_namespace_and_stays():
    tree = ParameterTree()
    with pytest.raises(ValueError, match="root"):
        tree.set("/", 1)
    with pytest.raises(KeyError):
        tree.delete("/")
    assert tree.get("/") == {}


def test_what_is_too_deep_to_be_sent_is_refused():
    tree = ParameterTree()
    with pytest.raises(ValueError, match="deep"):
        tree.set("/a" * 1000, 1)
    assert tree.get("/") == {}


def test_a_search_goes_up_by_the_first_word():
    tree = ParameterTree()
    tree.set("/robot1/map/frame", "map")
    tree.set("/map/size", 3)
    assert tree.search("/robot1/amcl", "map/frame") == "/robot1/map/frame"
    assert tree.search("/robot1/amcl", "map/size") == "/robot1/map/size"  # though it is not there
    assert tree.search("/robot2/amcl", "map/size") == "/map/size"
    assert tree.search("/robot2", "nothing") is None
    assert tree.search("/robot2", "/map") == "/map"
    assert tree.search("/robot2", "/nothing") is None
    for space, key in (("robot2", "map"), ("/", "~map"), ("/", "")):
        with pytest.raises(ValueError, match=r"must be|invalid"):
            tree.search(space, key)


def test_who_hears_of_a_change():
    subscribed = ["/", "/a/", "/a/b/", "/a/x/", "/other/"]
    assert updates(subscribed, "/a", {"b": 1}) == [
        ParameterUpdate("/", "/a/", {"b": 1}, own=True),
        ParameterUpdate("/a/", "/a/", {"b": 1}, own=True),
        ParameterUpdate("/a/x/", "/a/x/", {}, own=False),  # gone with the new value of /a
        ParameterUpdate("/a/b/", "/a/b/", 1, own=False),
    ]
    assert updates(subscribed, "/a/b", 2) == [
        ParameterUpdate("/", "/a/b/", 2, own=True),
        ParameterUpdate("/a/", "/a/b/", 2, own=True),
        ParameterUpdate("/a/b/", "/a/b/", 2, own=True),
    ]
