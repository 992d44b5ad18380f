"""Parameters from the YAML files of a ROS navigation stack.

A file may be for a node's own namespace (`min_particles: 500`), for the root (`amcl: {min_particles: 500}`), or for
move_base with all nodes and plugins inside it. Costmap parameters without a section are for both costmaps, unless the
file is named with its namespace, `local_costmap:costmap.yaml`. Layers may have any name. Values are read as in ROS's
loader: `yes` is true, `!degrees 90` and `deg(90)` are angles.

If the files have entries for a node, the node's other parameters have ROS's defaults; see `RosFiles.start`.
"""

import dataclasses
import difflib
import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Never, TypeVar, cast, get_type_hints

from sim.parameters import CostmapParameters, MoveBaseParameters, RobotParameters, with_ros_defaults
from thbridge.files.disk.text_files import read_text
from thbridge.files.errors import BadFile, BadFiles
from thbridge.files.ros.nav2 import as_ros1, is_of_ros2
from thbridge.files.ros.normalize import Entry, RosYamlNormalizer
from thbridge.files.ros.recoveries import behaviour_names, with_our_behaviours
from thbridge.files.yaml.declarations import choices_of
from thbridge.files.yaml.load import load_tree, words_in
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section, parse

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T")

COSTMAPS = ("global_costmap", "local_costmap")
SECTIONS: Mapping[str, type] = {
    name: hint
    for name, hint in cast(Mapping[str, type], get_type_hints(RobotParameters)).items()
    if dataclasses.is_dataclass(hint)
}
"""Sections of a robot's parameters. Each section is a namespace in ROS."""

NODES = (
    ("amcl",),
    ("fake_localization",),
    (*COSTMAPS, "NavfnROS", "GlobalPlanner", "TrajectoryPlannerROS", "DWAPlannerROS", "move_base"),
)
"""Sections by the ROS node that reads them."""
PLANNERS: Mapping[str, tuple[str, ...]] = {
    field.name: choices_of(str, field.metadata)
    for field in dataclasses.fields(MoveBaseParameters)
    if field.name.startswith("base_")
}
"""Available planners, by the parameter of move_base that chooses one."""

_NAMESPACE = re.compile(rf"(?P<folder>.*/)?(?P<namespace>{'|'.join(SECTIONS)}):(?P<file>.+)")

LAYERS = {
    "static_layer": ("static",),
    "obstacle_layer": ("obstacle", "voxel", "laser", "scan"),
    "inflation_layer": ("inflat",),
}
"""Layers of a costmap, with the words by which they are recognized in a plugin's type or name."""

_PERIOD = "the time between commands always follows from move_base's controller_frequency"
_UNREAD = "ROS does not read it there; you probably mean "
_SIDEWAYS = "ROS does not read it there; the sideways speeds are TrajectoryPlannerROS's y_vels"
WITHOUT_EFFECT: Mapping[str, Mapping[str, str]] = {
    "move_base": {"recovery_behaviour_enabled": f"{_UNREAD}recovery_behavior_enabled"},
    "TrajectoryPlannerROS": {
        "acc_lim_th": f"{_UNREAD}acc_lim_theta",
        "controller_frequency": _PERIOD,
        "max_vel_y": _SIDEWAYS,
        "min_vel_y": _SIDEWAYS,
        "publish_cost_grid": f"{_UNREAD}publish_cost_grid_pc",
    },
    "DWAPlannerROS": {
        "acc_lim_th": f"{_UNREAD}acc_lim_theta",
        "max_vel_rot": f"{_UNREAD}max_vel_theta",
        "min_vel_rot": f"{_UNREAD}min_vel_theta",
        "vtheta_samples": f"{_UNREAD}vth_samples",
        "sim_period": _PERIOD,
        "controller_frequency": _PERIOD,
    },
    "GlobalPlanner": {"planner_costmap_publish_frequency": "ROS no longer reads this parameter"},
    "global_costmap": {"meter_scoring": f"{_UNREAD}TrajectoryPlannerROS's"},
    "local_costmap": {"meter_scoring": f"{_UNREAD}TrajectoryPlannerROS's"},
}
"""Parameters in files of well-known robots that no ROS package reads, with a remark for each."""
LAYERS_WITHOUT_EFFECT: Mapping[str, str] = {
    "robot_radius": f"{_UNREAD}the costmap's",
    "footprint": f"{_UNREAD}the costmap's",
    "publish_observations": "this parameter belongs to a layer that does not exist here",
}
"""Parameters of costmap layers that no ROS package reads, with a remark for each."""
OF_THE_GRAPH = frozenset(
    {"robot_description", "rosdistro", "roslaunch", "rosversion", "run_id", "tf_prefix", "use_sim_time"}
)
"""Parameters that belong to no node, but are in a dump of the parameter server."""
_PLANNER = re.compile(r"\w*(Planner|Follower|Controller)\w*")
"""Name of a section of a planner, including planners of packages outside of ROS's navigation."""


@dataclass(frozen=True, slots=True)
class RosParameters:
    """The parameters in some ROS files.

    Attributes:
        value: the robot's parameters, after applying the files.
        notices: sentences about parameters without effect, and about interpretations.
        written: paths of all parameters in the files, such as `amcl.kld_err`.
    """

    value: RobotParameters
    notices: tuple[str, ...]
    written: frozenset[str]


@dataclass(frozen=True, slots=True)
class RosFiles:
    """ROS files, sorted into the sections of `RobotParameters`.

    Attributes:
        trees: entries of each file, in the order in which a launch file loads them.
        listed: our layers in each costmap that has `plugins`.
        notices: sentences about parameters without effect, and about interpretations.
    """

    trees: tuple[tuple[Path, Section], ...]
    listed: Mapping[str, frozenset[str]]
    notices: tuple[str, ...]

    @property
    def sections(self) -> frozenset[str]:
        """Sections of `RobotParameters` that the files have entries for."""
        return frozenset(key.text for _, tree in self.trees for key, _ in tree.entries if key.text in SECTIONS)

    def start(self, standard: RobotParameters) -> RobotParameters:
        """Return the parameters before these files are applied.

        A node with any entries in the files begins with all of ROS's defaults. Without `plugins`, a costmap has the map
        only if `static_map: true` is given (costmap_2d_ros.cpp, loadOldParameters). A costmap without entries would
        have neither the map nor a sensor in ROS, so it keeps the standard layers and the robot's body.

        Args:
            standard: parameters of other nodes, and parameters that ROS does not have.
        """
        changes: dict[str, object] = {}
        for node in NODES:
            for section in node if self.sections.intersection(node) else ():
                own = cast("DataclassInstance", getattr(standard, section))
                ros = with_ros_defaults(own)
                if isinstance(own, CostmapParameters) and isinstance(ros, CostmapParameters):
                    ros = self._costmap(section, own, ros)
                changes[section] = ros
        return cast(RobotParameters, _replaced(standard, changes))

    def _costmap(self, section: str, standard: CostmapParameters, ros: CostmapParameters) -> CostmapParameters:
        if section in self.listed:
            return ros
        if section in self.sections:
            return dataclasses.replace(ros, static_layer=dataclasses.replace(ros.static_layer, enabled=False))
        sources = standard.obstacle_layer.observation_sources
        return dataclasses.replace(
            ros,
            footprint=standard.footprint,
            robot_radius=standard.robot_radius,
            static_layer=dataclasses.replace(ros.static_layer, enabled=standard.static_layer.enabled),
            obstacle_layer=dataclasses.replace(ros.obstacle_layer, observation_sources=sources),
        )

    def over(self, start: RobotParameters) -> RosParameters:
        """Apply the files one after the other. The last value is used, as on the parameter server.

        Args:
            start: values for parameters that the files leave out.

        Raises:
            BadFiles: all faults of all files.
        """
        notices = list(self.notices)
        faults: list[BadFile] = []
        written: set[str] = set()
        value = start
        for path, tree in self.trees:
            try:
                loaded = load_tree(path, tree, RobotParameters, value)
            except BadFiles as found:
                faults.extend(found.faults)
                continue
            value = loaded.value
            notices.extend(loaded.notices)
            written.update(loaded.lines)
        if faults:
            raise BadFiles(tuple(_once(faults)))
        notices.extend(self._about_planners(value, written))
        return RosParameters(_with_layers(value, self.listed), tuple(_once(notices)), frozenset(written))

    def _about_planners(self, value: RobotParameters, written: Collection[str]) -> Iterator[str]:
        """Yield a sentence for each planner that files describe but do not choose; a launch file might choose it."""
        for key, kinds in PLANNERS.items():
            chosen = cast(str, getattr(value.move_base, key))
            for kind in kinds:
                section = kind.rpartition("/")[2]
                if kind != chosen and section in self.sections and f"move_base.{key}" not in written:
                    remedy = f"if a launch file chooses it, add a file with `{key}: {kind}`"
                    yield f"{section} has no effect: no file has {key}, so {chosen} is used; {remedy}"


def parse_ros_files(paths: Sequence[Path]) -> RosFiles:
    """Read ROS files. Each is given by a path, or by a namespace for its contents and a path: `NAMESPACE:PATH`.

    Raises:
        BadFile: a file cannot be read at all.
    """
    notices: list[str] = []
    trees = [_parsed(path, notices) for path in paths]
    layers = {name: layer for _, tree in trees for name, layer in _layers_listed(tree).items()}
    shaped: list[tuple[Path, Section]] = []
    listed: dict[str, frozenset[str]] = {}
    for path, tree in trees:
        sorter = _Sorter(path, layers, notices)
        shaped.append((path, sorter.shaped(tree)))
        listed |= sorter.listed
    trees = [(path, _without_static_map(path, tree, listed, notices)) for path, tree in shaped]
    return RosFiles(tuple(trees), listed, tuple(notices))


def read_ros_parameters(paths: Sequence[Path], standard: RobotParameters) -> RosParameters:
    """Read ROS files. Parameters that the files leave out have ROS's defaults; other nodes are as in `standard`.

    Raises:
        BadFiles: all faults of all files; or one BadFile if a file cannot be read at all.
    """
    files = parse_ros_files(paths)
    return files.over(files.start(standard))


def namespace_in(path: Path) -> tuple[str, Path]:
    """Return the namespace before a file's name, as in `local_costmap:costmap.yaml`, or "", and the file's path."""
    found = None if path.exists() else _NAMESPACE.fullmatch(str(path))
    return ("", path) if found is None else (found["namespace"], Path(found["folder"] or "") / found["file"])


def _parsed(path: Path, notices: list[str]) -> tuple[Path, Section]:
    """Return the file of a path, and its entries. If the path begins with a namespace, this namespace contains them."""
    namespace, file = namespace_in(path)
    tree = _normal(file, notices)
    if namespace:
        tree = Section(tree.line, [(Scalar(namespace, plain=True, line=tree.line), tree)])
    return file, tree


def _normal(path: Path, notices: list[str]) -> Section:
    tree = RosYamlNormalizer(path, notices).section(parse(path, read_text(path), ros=True))
    return as_ros1(path, tree, notices) if is_of_ros2(tree) else _of_one_robot(path, tree)


def _of_one_robot(path: Path, tree: Section) -> Section:
    """Return the entries of a file.

    Entries in a robot's namespace, as in a dump of all parameters, are moved out of it.
    """
    robots = [(key, child) for key, child in tree.entries if isinstance(child, Section) and _has_nodes(child)]
    if not robots or any(key.text in SECTIONS for key, _ in tree.entries):
        return tree
    if len(robots) > 1:
        problem = f"the file has the parameters of several robots: {', '.join(key.text for key, _ in robots)}"
        remedy = "write the parameters of one robot to a separate file: `rosparam dump FILE NAMESPACE`"
        raise BadFile(path, problem, remedy)
    others = [entry for entry in tree.entries if entry[0].text != robots[0][0].text]
    return _of_one_robot(path, Section(tree.line, [*others, *robots[0][1].entries]))


def _has_nodes(tree: Section) -> bool:
    """Return True for a namespace that contains one of our nodes, directly or in an inner namespace."""
    inner = [(key, child) for key, child in tree.entries if isinstance(child, Section)]
    return any(key.text in {"amcl", "move_base"} or _has_nodes(child) for key, child in inner)


def _without_static_map(path: Path, tree: Section, listed: Collection[str], notices: list[str]) -> Section:
    """Return the entries without `static_map` in costmaps that list their layers, because ROS ignores it there."""
    sections: list[Entry] = []
    for key, child in tree.entries:
        kept = child
        if key.text in listed and isinstance(child, Section):
            kept = Section(child.line, [entry for entry in child.entries if entry[0].text != "static_map"])
            for name, _ in child.entries:
                if name.text == "static_map":
                    notice = f"{key.text}.static_map has no effect, as in ROS: `plugins` lists the layers"
                    notices.append(f"{path}, line {name.line}: {notice}")
        sections.append((key, kept))
    return Section(tree.line, sections)


def _once(notice: Sequence[T]) -> list[T]:
    """Return the items without items that are repeated for the second costmap."""
    return list({str(thing).replace(COSTMAPS[1], COSTMAPS[0]): thing for thing in reversed(notice)}.values())[::-1]


@dataclass(slots=True)
class _Sorter:
    """Sorter that moves the entries of one file to the sections of `RobotParameters`.

    Attributes:
        layers: our layer for each layer that any file names in `plugins`.
        listed: our layers in each costmap of this file that has `plugins`.
    """

    path: Path
    layers: Mapping[str, str]
    notices: list[str]
    listed: dict[str, frozenset[str]] = dataclasses.field(default_factory=dict)

    def shaped(self, tree: Section) -> Section:
        parts: dict[str, list[Entry]] = {}
        whole: list[Entry] = []
        flat: list[Entry] = []
        for key, child in _hoisted(tree):
            if key.text not in SECTIONS:
                flat.append((key, child))
            elif isinstance(child, Section):
                parts.setdefault(key.text, []).extend(child.entries)
            else:
                whole.append((key, child))
        homes = self.homes(flat, by_node=bool(parts))
        # An unknown section is kept, so that the loader reports it.
        whole += homes.pop("", [])
        for section, entries in homes.items():
            parts.setdefault(section, []).extend(entries)
        for section, entries in parts.items():
            kept = list(self.with_effect(section, entries))
            shaped = self.costmap(section, kept) if section in COSTMAPS else kept
            if section == "move_base":
                shaped = with_our_behaviours(kept, str(self.path), self.notices)
            line = shaped[0][0].line if shaped else tree.line
            whole.append((Scalar(section, plain=True, line=line), Section(line, shaped)))
        return Section(tree.line, whole)

    def homes(self, flat: list[Entry], by_node: bool) -> dict[str, list[Entry]]:
        """Assign sections to parameters that have no section.

        Sections that have more of these parameters come first. Each parameter gets the first section that has it.

        Unknown sections get an empty name in the result.

        Args:
            flat: the parameters.
            by_node: True if other parameters of the file have sections. Unknown parameters then belong to no node.
        """
        homes: dict[str, list[Entry]] = {}
        for key, _ in flat:
            if key.text in OF_THE_GRAPH:
                self.tell(key, f"{key.text} has no effect here: it belongs to the whole ROS graph")
        flat = [entry for entry in flat if entry[0].text not in OF_THE_GRAPH]
        ours = {*SECTIONS, *LAYERS, *self.layers, *OF_THE_GRAPH}
        known = {section: self.names_of(section, flat) for section in SECTIONS}
        scores = {section: math.fsum(_likeness(key.text, names) for key, _ in flat) for section, names in known.items()}
        ranked = sorted(SECTIONS, key=lambda section: -scores[section])
        for key, child in flat:
            home = next((section for section in ranked if key.text in known[section]), None)
            layer = ranked[0] in COSTMAPS and scores[ranked[0]] > 0.0 and self.unlisted(key.text)
            strange = by_node and not any(difflib.get_close_matches(key.text, names) for names in known.values())
            if home is None and (isinstance(child, Section) or strange) and not layer:
                if _PLANNER.fullmatch(key.text) and not difflib.get_close_matches(key.text, SECTIONS, cutoff=0.85):
                    self.tell(key, f"{key.text} has no effect here: there is no such planner")
                elif not difflib.get_close_matches(key.text, ours, cutoff=0.7):
                    self.tell(key, f"{key.text} has no effect here: no node here reads it")
                else:
                    homes.setdefault("", []).append((key, child))
                continue
            home = home or ranked[0]
            for section in COSTMAPS if home in COSTMAPS else (home,):
                homes.setdefault(section, []).append((key, child))
        return homes

    def names_of(self, section: str, flat: list[Entry]) -> set[str]:
        into = SECTIONS[section]
        names = {field.name for field in dataclasses.fields(into)} | set(WITHOUT_EFFECT.get(section, {}))
        for table in ("ros_only", "renamed", "passed_on"):
            names |= set(cast(Mapping[str, str], getattr(into, table, {})))
        if section == "move_base":
            names |= behaviour_names(flat)
        if section in COSTMAPS:
            names |= {"plugins"}
            for key, child in flat:
                if key.text == "observation_sources":
                    names |= set(words_in(child))
                if isinstance(child, Section) and self.layer_of(key.text) is not None:
                    names.add(key.text)
        return names

    def with_effect(self, section: str, entries: list[Entry]) -> Iterator[Entry]:
        """Yield the entries except those in `WITHOUT_EFFECT`; each of these gets a notice."""
        for key, child in entries:
            meaning = WITHOUT_EFFECT.get(section, {}).get(key.text)
            if key.text == "use_sim_time":
                self.tell(key, f"{section}.{key.text} has no effect here: it belongs to the whole ROS graph")
            elif meaning is None:
                yield key, child
            else:
                self.tell(key, f"{section}.{key.text} has no effect here: {meaning}")

    def tell(self, key: Scalar, sentence: str) -> None:
        self.notices.append(f"{self.path}, line {key.line}: {sentence}")

    def of_layer(self, place: str, layer: Section) -> list[Entry]:
        """Return the entries of a layer except those in `LAYERS_WITHOUT_EFFECT`; each of these gets a notice."""
        for key, _ in layer.entries:
            if key.text in LAYERS_WITHOUT_EFFECT:
                self.tell(key, f"{place}.{key.text} has no effect here: {LAYERS_WITHOUT_EFFECT[key.text]}")
        return [entry for entry in layer.entries if entry[0].text not in LAYERS_WITHOUT_EFFECT]

    def unlisted(self, name: str) -> bool:
        """Return True for a layer that ROS does not load, because the lists of plugins do not name it."""
        names = [field.name for field in dataclasses.fields(CostmapParameters)]
        return bool(self.layers) and not difflib.get_close_matches(name, [*names, *self.layers], cutoff=0.8)

    def layer_of(self, name: str) -> str | None:
        return self.layers[name] if name in self.layers else _layer_like(name)

    def costmap(self, section: str, entries: list[Entry]) -> list[Entry]:
        """Return a costmap with its layers under our names, and without `plugins`."""
        sources = {word for key, child in entries if key.text == "observation_sources" for word in words_in(child)}
        shaped: list[Entry] = []
        layers: dict[str, list[Entry]] = {}
        for key, child in entries:
            layer = self.layer_of(key.text) if isinstance(child, Section) and key.text not in sources else None
            if key.text == "plugins":
                if not isinstance(child, Listing) or not all(_plugins(Listing(0, [item])) for item in child.items):
                    remedy = "write for example [{name: walls, type: 'costmap_2d::StaticLayer'}], or delete the line"
                    raise BadFile(
                        self.path, "not a list of layers with name and type", remedy, key.line, f"{section}.plugins"
                    )
                self.listed[section] = frozenset(_plugins(child).values())
            elif layer == "":
                self.tell(key, f"{section}.{key.text} has no effect here: this kind of layer does not exist")
            elif layer is None and isinstance(child, Section) and key.text not in sources and self.unlisted(key.text):
                self.tell(key, f"{section}.{key.text} has no effect, as in ROS: no `plugins` lists it")
            elif layer is None or not isinstance(child, Section):
                shaped.append((key, child))
            elif layer in layers:
                layers[layer] = _joined(layers[layer], self.of_layer(f"{section}.{key.text}", child))
                self.tell(key, f"{section}.{key.text} is merged into the only {layer} here")
            else:
                layers[layer] = self.of_layer(f"{section}.{key.text}", child)
        if "static_layer" in layers and any(key.text == "track_unknown_space" for key, _ in shaped):
            # In ROS the costmap's value overrides the layer's own (costmap_2d_ros.cpp, copyParentParameters).
            own = layers["static_layer"]
            layers["static_layer"] = [entry for entry in own if entry[0].text != "track_unknown_space"]
        for layer, inner in layers.items():
            line = inner[0][0].line if inner else shaped[0][0].line if shaped else 1
            shaped.append((Scalar(layer, plain=True, line=line), Section(line, inner)))
        return shaped


def _hoisted(tree: Section) -> Iterator[Entry]:
    """Yield the entries of a file; our sections in move_base's namespace are moved out of it."""
    for key, child in tree.entries:
        if key.text == "move_base" and isinstance(child, Section):
            own = [entry for entry in child.entries if entry[0].text not in SECTIONS]
            yield from (entry for entry in child.entries if entry[0].text in SECTIONS)
            yield key, Section(child.line, own)
        else:
            yield key, child


def _likeness(name: str, names: set[str]) -> float:
    if name in names:
        return 1.0
    return 0.5 if difflib.get_close_matches(name, names, n=1, cutoff=0.8) else 0.0


def _layer_like(text: str) -> str | None:
    return next((layer for layer, words in LAYERS.items() if any(word in text.lower() for word in words)), None)


def _layers_listed(node: Node) -> Mapping[str, str]:
    """Return our layer for each name in all `plugins` of a tree; empty for a type that we do not have."""
    found: dict[str, str] = {}
    if isinstance(node, Section):
        for key, child in node.entries:
            found |= _plugins(child) if key.text == "plugins" else _layers_listed(child)
    return found


def _plugins(node: Node) -> Mapping[str, str]:
    """Return our layer for each name in a list of {name, type}; empty for a type that we do not have."""
    found = {}
    for item in node.items if isinstance(node, Listing) else []:
        entries = item.entries if isinstance(item, Section) else []
        words = {key.text: child.text for key, child in entries if isinstance(child, Scalar)}
        if "name" in words and "type" in words:
            found[words["name"]] = _layer_like(words["type"].rpartition("::")[2]) or ""
    return found


def _joined(first: list[Entry], second: list[Entry]) -> list[Entry]:
    """Merge two layers of one kind: observation sources come from both, all other values from the first layer."""
    names = {key.text for key, _ in first}
    joined = list(first)
    for key, child in second:
        if key.text not in names:
            joined.append((key, child))
        elif key.text == "observation_sources" and isinstance(child, Scalar):
            joined = [
                (own, dataclasses.replace(text, text=f"{text.text} {child.text}"))
                if own.text == key.text and isinstance(text, Scalar)
                else (own, text)
                for own, text in joined
            ]
    return joined


def _with_layers(value: RobotParameters, listed: Mapping[str, frozenset[str]]) -> RobotParameters:
    """Return the parameters; in each costmap, the layers that its `plugins` leaves out are disabled."""
    for section, layers in listed.items():
        costmap = cast("DataclassInstance", getattr(value, section))
        off = {layer: _replaced(getattr(costmap, layer), {"enabled": False}) for layer in LAYERS if layer not in layers}
        value = cast(RobotParameters, _replaced(value, {section: _replaced(costmap, off)}))
    return value


def _replaced(section: "DataclassInstance", changes: Mapping[str, object]) -> "DataclassInstance":
    return dataclasses.replace(section, **cast(Mapping[str, Never], changes))
