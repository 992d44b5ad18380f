"""Merging of trees of YAML files: values at paths of keys are added, replaced and removed."""

from collections.abc import Sequence

from thbridge.files.yaml.tree import Node, Scalar, Section


def nested(key: str, node: Node, line: int, written_at: str = "") -> Node:
    """Return the tree with a node at a path of keys, such as `robot.amcl.kld_err`.

    Args:
        key: the path.
        node: value at the path.
        line: line of the keys.
        written_at: path at which people wrote the value, if this path is different; the keys store it for messages.
    """
    for name in reversed(key.split(".")):
        node = Section(line, [(Scalar(name, True, line, place=written_at), node)])
        written_at = written_at.rpartition(".")[0]
    return node


def over(base: Node, top: Node) -> Node:
    """Return a tree merged with another tree on top: sections are merged, and other values are replaced."""
    if not (isinstance(base, Section) and isinstance(top, Section)):
        return top
    above = {entry[0].text: entry for entry in reversed(top.entries)}
    below = {key.text for key, _ in base.entries}
    entries = [
        (above[key.text][0], over(child, above[key.text][1])) if key.text in above else (key, child)
        for key, child in base.entries
    ]
    # A key that is written twice in `top` stays there twice, so that this fault is found.
    added = [entry for entry in top.entries if entry[0].text not in below or entry is not above[entry[0].text]]
    return Section(top.line, entries + added)


def without(tree: Node, path: Sequence[str]) -> Node:
    """Return a tree without the nodes at a path of keys."""
    if not isinstance(tree, Section):
        return tree
    name, *inside = path
    if not inside:
        return Section(tree.line, [entry for entry in tree.entries if entry[0].text != name])
    entries = [(key, without(child, inside) if key.text == name else child) for key, child in tree.entries]
    return Section(tree.line, entries)


def set_by_both(one: Node, other: Node) -> str | None:
    """Return the path of a key that two trees set, or None. Of sections in both trees, only the keys inside count."""
    if not (isinstance(one, Section) and isinstance(other, Section)):
        return ""
    known = {key.text: child for key, child in one.entries}
    for key, child in other.entries:
        if key.text in known and (inner := set_by_both(known[key.text], child)) is not None:
            return f"{key.text}.{inner}".rstrip(".")
    return None
