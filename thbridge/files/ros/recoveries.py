"""Recovery behaviors in ROS files. Each has a freely chosen name, the type of a plugin, and a section of settings."""

from thbridge.files.plugins import RECOVERIES
from thbridge.files.ros.normalize import Entry
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section

CONSERVATIVE, AGGRESSIVE, ROTATE = "conservative_reset", "aggressive_reset", "rotate_recovery"
USUAL = {CONSERVATIVE, AGGRESSIVE, ROTATE, "move_slow_and_clear"}
"""Names of sections with settings of behaviors, in files without a list of behaviors."""


def behaviour_names(entries: list[Entry]) -> set[str]:
    """Return the names of sections in which a file may have settings of recovery behaviors."""
    lists = [child for key, child in entries if key.text == "recovery_behaviors"]
    return USUAL | {name for child in lists for name, _ in _behaviours(child)}


def with_our_behaviours(entries: list[Entry], where: str, notices: list[str]) -> list[Entry]:
    """Return move_base's parameters with our names of the recovery behaviors.

    Args:
        entries: the entries of the section.
        where: the file, for notices.
        notices: receives a sentence for each setting without effect.
    """
    names = behaviour_names(entries)
    ours = {CONSERVATIVE: CONSERVATIVE}
    for key, child in entries:
        if key.text == "recovery_behaviors":
            ours |= _named_here(child)
    written = {key.text for key, _ in entries}
    shaped: list[Entry] = []
    for key, child in entries:
        if key.text == "recovery_behaviors" and isinstance(child, Listing):
            shaped.append((key, _listed(child, ours, where, notices)))
        elif key.text in names and isinstance(child, Section):
            for name, value in child.entries:
                if ours.get(key.text) == CONSERVATIVE and name.text == "reset_distance":
                    # ROS ignores conservative_reset_dist when recovery_behaviors is given.
                    if "conservative_reset_dist" not in written:
                        shaped.append((Scalar("conservative_reset_dist", plain=True, line=name.line), value))
                    continue
                notice = f"move_base.{key.text}.{name.text} has no effect here: behaviors keep their defaults"
                notices.append(f"{where}, line {name.line}: {notice}")
        else:
            shaped.append((key, child))
    return shaped


def _behaviours(node: Node) -> list[tuple[str, str]]:
    """Return the name and type of each entry of recovery_behaviors."""
    found = []
    for item in node.items if isinstance(node, Listing) else []:
        entries = item.entries if isinstance(item, Section) else []
        words = {key.text: child.text for key, child in entries if isinstance(child, Scalar)}
        if "name" in words:
            found.append((words["name"], words.get("type", "")))
    return found


def _named_here(node: Node) -> dict[str, str]:
    """Return our name for each behavior of a list; empty for a type that we do not have."""
    names: dict[str, str] = {}
    for name, kind in _behaviours(node):
        if name in {CONSERVATIVE, AGGRESSIVE, ROTATE}:
            names[name] = name
        elif kind.endswith("RotateRecovery"):
            names[name] = ROTATE
        elif kind.endswith("ClearCostmapRecovery"):
            # The first behavior that clears costmaps keeps obstacles nearby, the next behaviors clear more.
            names[name] = AGGRESSIVE if CONSERVATIVE in names.values() else CONSERVATIVE
        elif kind or name not in USUAL:
            installed = RECOVERIES.names()
            found = next((word for word in (kind, name) if word in installed), None)
            if found is not None:
                names[name] = found
            elif kind:
                names[name] = ""
    return names


def _listed(node: Listing, ours: dict[str, str], where: str, notices: list[str]) -> Listing:
    items: list[Node] = []
    for item in node.items:
        entries = item.entries if isinstance(item, Section) else []
        name = next((child for key, child in entries if key.text == "name" and isinstance(child, Scalar)), None)
        here = None if name is None else ours.get(name.text)
        if name is None or here is None:
            items.append(item)
        elif here:
            key = Scalar("name", plain=True, line=name.line)
            items.append(Section(item.line, [(key, Scalar(here, plain=True, line=name.line))]))
            if here != name.text:
                notices.append(f"{where}, line {name.line}: recovery behavior {name.text} is used as {here}")
        else:
            notice = f"recovery behavior {name.text} has no effect here: its type does not exist"
            notices.append(f"{where}, line {name.line}: {notice}")
    return Listing(node.line, items)
