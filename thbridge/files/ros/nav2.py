"""Translation of parameter files of ROS 2's Nav2 to parameters of ROS 1.

Nav2's nodes are the successors of amcl and move_base, with other names, units and defaults. Parameters that a file
leaves out have Nav2's defaults if the file describes their node. Parameters without a counterpart are listed and have
no effect.

Source: see `thbridge.ros2.nav2_names`, which has the names.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path

from thbridge.files.errors import BadFile
from thbridge.files.yaml.tree import Listing, Node, Scalar, Section
from thbridge.ros2 import nav2_names

Entry = tuple[Scalar, Node]

PARAMETERS = "ros__parameters"

_AMCL_DEFAULTS: Mapping[str, str] = {
    "laser_max_range": "100.0",
    "max_beams": "60",
    "max_particles": "2000",
    "min_particles": "500",
    "pf_err": "0.05",
    "resample_interval": "1",
    "update_min_a": "0.2",
    "update_min_d": "0.25",
    "z_hit": "0.5",
    "z_max": "0.05",
    "z_rand": "0.5",
    "z_short": "0.05",
}
"""Nav2's defaults that differ from the defaults of ROS 1."""
_MODELS: Mapping[str, str] = {
    "nav2_amcl::DifferentialMotionModel": "diff-corrected",
    "nav2_amcl::OmniMotionModel": "omni-corrected",
    "differential": "diff-corrected",
    "omnidirectional": "omni-corrected",
}

_SCALE = "1.0"
"""DWB's weight of a listed critic without a weight."""
_OBSTACLES = ("BaseObstacle", "ObstacleFootprint")
_DWB_STANDS: tuple[str, ...] = ("max_speed_xy", "max_vel_x", "max_vel_theta", "acc_lim_x", "acc_lim_theta")
"""Limits with the default 0. If a file leaves these limits out, a robot with Nav2 does not move."""
_GOAL_CHECKER_DEFAULTS: Mapping[str, str] = {
    "xy_goal_tolerance": "0.25",
    "yaw_goal_tolerance": "0.25",
    "stateful": "true",
}
_PROGRESS_CHECKER_DEFAULTS: Mapping[str, str] = {"required_movement_radius": "0.5", "movement_time_allowance": "10.0"}
_DWB_DEFAULTS: Mapping[str, str] = {
    "min_speed_xy": "0.0",
    "min_speed_theta": "0.0",
    "sim_time": "1.7",
    "linear_granularity": "0.5",
    "angular_granularity": "0.025",
    "vx_samples": "20",
    "vtheta_samples": "20",
    "trans_stopped_velocity": "0.25",
}
_DWB_ONLY = ("critics", "debug_trajectory_details", "plugin", "trajectory_generator_name")

_NAVFN_DEFAULTS: Mapping[str, str] = {"tolerance": "0.5"}

_SOURCE_ONLY = ("obstacle_min_range", "raytrace_min_range", "transport_type")
_COSTMAP_DEFAULTS: Mapping[str, str] = {
    "robot_radius": "0.1",
    "width": "5",
    "height": "5",
    "publish_frequency": "1.0",
    "track_unknown_space": "false",
}
_COSTMAP_PLUGINS: Mapping[str, str] = {
    "static_layer": "nav2_costmap_2d::StaticLayer",
    "obstacle_layer": "nav2_costmap_2d::ObstacleLayer",
    "inflation_layer": "nav2_costmap_2d::InflationLayer",
}
"""Layers of a costmap without `plugins`."""
_COSTMAP_ONLY = (
    *(
        "filters",
        "map_vis_z",
        "initial_transform_timeout",
        "inscribed_obstacle_cost_value",
        "subscribe_to_stamped_footprint",
    ),
    *("service_introspection_mode", "introspection_mode"),
)
_OF_EVERY_NODE = ("use_sim_time", "start_type_description_service")
"""Parameters of each node, which need no notice."""
_LAYER_ONLY = (
    *("map_subscribe_transient_local", "restore_cleared_footprint", "tf_filter_tolerance", "custom_inscribed_radius"),
    *("inflate_around_unknown", "num_threads", "plugin"),
)


_NODES = ("amcl", "controller_server", "planner_server", "local_costmap", "global_costmap")
"""Nodes that have a counterpart."""


def is_of_ros2(tree: Node) -> bool:
    """Return True if any node in a tree has `ros__parameters`."""
    match tree:
        case Section(_, entries):
            return any(key.text == PARAMETERS or is_of_ros2(child) for key, child in entries)
        case Listing(_, items):
            return any(map(is_of_ros2, items))
    return False


def as_ros1(path: Path, tree: Section, notices: list[str]) -> Section:
    """Return the entries that a file of ROS 1 would have.

    Args:
        path: path of the file, for notices and faults.
        tree: entries of the file.
        notices: receives sentences about entries without a counterpart, and about defaults of Nav2.

    Raises:
        BadFile: none of its nodes has a counterpart.
    """
    return _Translation(path, notices).file(tree)


def _nodes(tree: Section) -> Iterator[tuple[Scalar, Section]]:
    """Yield the name and the parameters of each node, including nodes in namespaces."""
    for key, child in tree.entries:
        if not isinstance(child, Section):
            continue
        own = next((inner for name, inner in child.entries if name.text == PARAMETERS), None)
        if own is not None:
            # A node without parameters has nothing after the colon.
            yield key, own if isinstance(own, Section) else Section(key.line, [])
        else:
            yield from _nodes(child)


def _nested(section: Section) -> Section:
    """Return the entries of a section, with dotted names such as `static_layer.enabled` moved to inner sections."""
    entries: list[Entry] = []
    inner: dict[str, list[Entry]] = {}
    for key, child in section.entries:
        name, dot, rest = key.text.partition(".")
        within = [(_scalar(rest, key.line), child)] if dot else child.entries if isinstance(child, Section) else None
        if within is None:
            entries.append((key, child))
            continue
        if name not in inner:
            inner[name] = []
            entries.append((_scalar(name, key.line), Section(key.line, inner[name])))
        inner[name] += within
    return Section(section.line, [(key, _nested(one) if isinstance(one, Section) else one) for key, one in entries])


def _dotted(section: Section, prefix: str = "") -> Iterator[Entry]:
    """Yield the entries of a section; entries of inner sections have their full names, such as `PathDist.scale`."""
    for key, child in section.entries:
        name = Scalar(f"{prefix}{key.text}", plain=True, line=key.line)
        if isinstance(child, Section):
            yield from _dotted(child, f"{name.text}.")
        else:
            yield name, child


def _with_entries(entries: list[Entry], name: str, more: list[Entry]) -> list[Entry]:
    """Return entries with more entries in the section of this name."""
    section = next((child for key, child in entries if key.text == name and isinstance(child, Section)), None)
    own = section.entries if section else []
    rest = [entry for entry in entries if entry[0].text != name]
    return [*rest, (_scalar(name, more[0][0].line), Section(more[0][0].line, [*own, *more]))]


def _scalar(text: str, line: int) -> Scalar:
    return Scalar(text, plain=True, line=line)


class _Translation:
    """The translation of one file."""

    def __init__(self, path: Path, notices: list[str]) -> None:
        self._path = path
        self._notices = notices
        self._strange: list[str] = []

    def file(self, tree: Section) -> Section:
        entries: list[Entry] = []
        others: list[str] = []
        known: set[str] = set()
        for key, parameters in _nodes(tree):
            if key.text in known:
                problem = f"{key.text} appears again for a second robot"
                raise BadFile(self._path, problem, "write the nodes of one robot to a separate file", key.line)
            if key.text in _NODES:
                known.add(key.text)
            match key.text:
                case "amcl":
                    entries.append((key, self._amcl(key, parameters)))
                case "local_costmap" | "global_costmap":
                    entries.append((key, self._costmap(key, _nested(parameters))))
                case "planner_server":
                    entries += self._planner(parameters)
                case "controller_server":
                    entries += self._controller(parameters)
                case other:
                    others.append(other)
        if not known:
            remedy = f"name a file that has {', '.join(_NODES[:-1])} or {_NODES[-1]}"
            raise BadFile(self._path, "no node of this file of ROS 2 has a counterpart here", remedy)
        if others:
            self._add_notice(f"these nodes of ROS 2 have no counterpart here: {', '.join(sorted(set(others)))}")
        if self._strange:
            strange = ", ".join(self._strange)
            self._add_notice(f"these parameters have no effect, because they have no counterpart here: {strange}")
        return Section(tree.line, entries)

    def _add_notice(self, sentence: str) -> None:
        self._notices.append(f"{self._path}: {sentence}")

    def _renamed(
        self, node: str, parameters: Section, names: Mapping[str, str], defaults: Mapping[str, str]
    ) -> list[Entry]:
        """Return a node's parameters under the names of ROS 1, with Nav2's defaults for omitted parameters."""
        entries: list[Entry] = []
        written = set()
        for key, child in _dotted(parameters):
            written.add(key.text)
            if key.text in names:
                entries.append((_scalar(names[key.text], key.line), child))
            elif key.text not in _OF_EVERY_NODE:
                self._strange.append(f"{node}.{key.text}")
        return entries + self._defaults(node, parameters.line, written, names, defaults)

    def _defaults(
        self, node: str, line: int, written: set[str], names: Mapping[str, str], defaults: Mapping[str, str]
    ) -> list[Entry]:
        left_out = {name: value for name, value in defaults.items() if name not in written}
        if left_out:
            values = ", ".join(f"{name}: {value}" for name, value in left_out.items())
            self._add_notice(f"{node} leaves out these parameters, so they have Nav2's defaults: {values}")
        return [(_scalar(names.get(name, name), line), _scalar(value, line)) for name, value in left_out.items()]

    def _amcl(self, node: Scalar, parameters: Section) -> Section:
        models = [(key, child) for key, child in parameters.entries if key.text == "robot_model_type"]
        silent = ("set_initial_pose", "initial_pose.z", "robot_model_type", "scan_topic", "map_topic")
        rest = Section(parameters.line, [(key, child) for key, child in parameters.entries if key.text not in silent])
        entries = self._renamed("amcl", rest, nav2_names.AMCL, _AMCL_DEFAULTS)
        model = models[-1][1] if models else _scalar("nav2_amcl::DifferentialMotionModel", node.line)
        if isinstance(model, Scalar):
            known = _MODELS.get(model.text)
            if known is None:
                remedy = f"write one of {', '.join(_MODELS)}"
                raise BadFile(
                    self._path, f"{model.text!r} is not a motion model", remedy, model.line, "robot_model_type"
                )
            entries.append((_scalar("odom_model_type", model.line), _scalar(known, model.line)))
        return Section(parameters.line, entries)

    def _costmap(self, node: Scalar, parameters: Section) -> Section:
        """Return a costmap with its layers listed as in ROS 1."""
        inner = {key.text: child for key, child in parameters.entries}
        given = list(parameters.entries)
        if "plugins" not in inner:
            names_of_all = [_scalar(name, parameters.line) for name in _COSTMAP_PLUGINS]
            inner["plugins"] = Listing(parameters.line, [*names_of_all])
            given.insert(0, (_scalar("plugins", parameters.line), inner["plugins"]))
            listed = ", ".join(_COSTMAP_PLUGINS)
            self._add_notice(f"{node.text} leaves out plugins, so Nav2's default is used: {listed}")
        listing = inner["plugins"]
        if not isinstance(listing, Listing):
            usual = ", ".join(_COSTMAP_PLUGINS)
            remedy = f"write for example [{usual}], or delete the line to use these layers, Nav2's default"
            raise BadFile(self._path, "not a list of layers", remedy, listing.line, f"{node.text}.plugins")
        plugins = [item for item in listing.items if isinstance(item, Scalar)]
        names = {each.text for each in plugins}
        of_the_map = [entry for entry in given if entry[0].text in nav2_names.OF_THE_MAP]
        entries: list[Entry] = []
        if of_the_map and nav2_names.STATIC_LAYER in names:
            given = _with_entries(given, nav2_names.STATIC_LAYER, of_the_map)
        for key, child in given:
            if key.text == "plugins":
                entries.append(
                    (key, Listing(child.line, [self._plugin(each, inner.get(each.text)) for each in plugins]))
                )
            elif key.text in names and isinstance(child, Section):
                entries.append((key, self._layer(f"{node.text}.{key.text}", child)))
            elif key.text in nav2_names.OF_THE_MAP and nav2_names.STATIC_LAYER in names:
                pass  # These have moved to the static layer.
            elif key.text in _COSTMAP_ONLY or isinstance(child, Section):
                self._strange.append(f"{node.text}.{key.text}")
            elif key.text in _OF_EVERY_NODE:
                pass
            else:
                entries.append((key, child))
        defaults = dict(_COSTMAP_DEFAULTS)
        if node.text == "global_costmap":
            del defaults["width"], defaults["height"]
        if "footprint" in inner:
            del defaults["robot_radius"]
        return Section(parameters.line, entries + self._defaults(node.text, parameters.line, {*inner}, {}, defaults))

    def _plugin(self, name: Scalar, layer: Node | None) -> Node:
        """Return a layer's entry in the list `plugins` of ROS 1: {name, type}."""
        own = layer.entries if isinstance(layer, Section) else []
        usual = _scalar(_COSTMAP_PLUGINS.get(name.text, name.text), name.line)
        kind = next((child for key, child in own if key.text == "plugin" and isinstance(child, Scalar)), usual)
        # Layers are recognized by their types: nav2_costmap_2d::ObstacleLayer in the same way as
        # costmap_2d::ObstacleLayer.
        return Section(name.line, [(_scalar("name", name.line), name), (_scalar("type", name.line), kind)])

    def _layer(self, place: str, layer: Section) -> Section:
        entries: list[Entry] = []
        for key, child in layer.entries:
            if key.text in _LAYER_ONLY:
                if key.text != "plugin":
                    self._strange.append(f"{place}.{key.text}")
            elif isinstance(child, Section):
                entries.append((key, self._source(f"{place}.{key.text}", child)))
            else:
                entries.append((key, child))
        return Section(layer.line, entries)

    def _source(self, place: str, source: Section) -> Section:
        if all(key.text != "max_obstacle_height" for key, _ in source.entries):
            height = "0 m in Nav2, so that nothing higher is marked; here heights are ignored"
            self._add_notice(f"{place} leaves out max_obstacle_height, which is {height}")
        entries: list[Entry] = []
        for key, child in source.entries:
            if key.text in _SOURCE_ONLY:
                self._strange.append(f"{place}.{key.text}")
            else:
                entries.append((_scalar(nav2_names.SOURCE.get(key.text, key.text), key.line), child))
        return Section(source.line, entries)

    def _first_plugin(self, parameters: Section, listed: str, kind: str, default: str) -> tuple[Scalar, Section] | None:
        """Return the first plugin of a kind in a list, with its parameters; the others are reported.

        If there is no list, the default plugin does not need a type.
        """
        inner = {key.text: (key, child) for key, child in parameters.entries}
        names = inner[listed][1] if listed in inner else None
        wanted = (
            [item.text for item in names.items if isinstance(item, Scalar)] if isinstance(names, Listing) else [default]
        )
        found = None
        for name in wanted:
            key, child = inner.get(name, (None, None))
            own = child.entries if isinstance(child, Section) else []
            plugin = next(
                (value.text for word, value in own if word.text == "plugin" and isinstance(value, Scalar)),
                "" if listed in inner else kind,
            )
            if found is None and key is not None and isinstance(child, Section) and kind in plugin.lower():
                found = key, child
            else:
                self._strange.append(f"{name} ({plugin or 'no plugin'})")
        return found

    def _planner(self, parameters: Section) -> Iterator[Entry]:
        found = self._first_plugin(parameters, "planner_plugins", "navfn", "GridBased")
        if found is None and not {"planner_plugins", "GridBased"} & {key.text for key, _ in parameters.entries}:
            found = _scalar("GridBased", parameters.line), Section(parameters.line, [])
        if found is None:
            self._add_notice("the global planner is navfn, because no planner in planner_plugins exists here")
            return
        key, own = found
        rest = Section(own.line, [entry for entry in own.entries if entry[0].text != "plugin"])
        yield (
            _scalar("NavfnROS", key.line),
            Section(own.line, self._renamed(key.text, rest, nav2_names.NAVFN, _NAVFN_DEFAULTS)),
        )

    def _controller(self, parameters: Section) -> Iterator[Entry]:
        """Yield the local planner, and move_base's parameters that belong to the controller in Nav2."""
        inner = {key.text: (key, child) for key, child in parameters.entries}
        base: list[Entry] = [
            (
                _scalar("base_local_planner", parameters.line),
                _scalar("dwa_local_planner/DWAPlannerROS", parameters.line),
            )
        ]
        if "controller_frequency" in inner:
            base.append(inner["controller_frequency"])
        name, checker = self._checker(parameters, "progress_checker")
        rest = Section(checker.line, [entry for entry in checker.entries if entry[0].text != "plugin"])
        base += self._renamed(name, rest, nav2_names.PROGRESS_CHECKER, _PROGRESS_CHECKER_DEFAULTS)
        yield _scalar("move_base", parameters.line), Section(parameters.line, base)
        found = self._first_plugin(parameters, "controller_plugins", "dwb", "FollowPath")
        name, checker = self._checker(parameters, "goal_checker")
        rest = Section(checker.line, [entry for entry in checker.entries if entry[0].text in nav2_names.GOAL_CHECKER])
        tolerances = self._renamed(name, rest, nav2_names.GOAL_CHECKER, _GOAL_CHECKER_DEFAULTS)
        if found is None:
            self._add_notice(
                "the local planner is DWAPlannerROS as in ROS 1: no controller in controller_plugins exists here"
            )
            yield _scalar("DWAPlannerROS", parameters.line), Section(parameters.line, list(tolerances))
            return
        key, own = found
        written = self._with_critics(key.text, own)
        weights = [
            (name, child) for name, child in written if name.text in nav2_names.HALVED and isinstance(child, Scalar)
        ]
        silent = {*nav2_names.HALVED, *_DWB_ONLY}
        rest = Section(own.line, [entry for entry in written if entry[0].text not in silent])
        entries = [*self._renamed(key.text, rest, nav2_names.DWB, _DWB_DEFAULTS)]
        if stands := [name for name in _DWB_STANDS if all(entry[0].text != name for entry in written)]:
            self._add_notice(
                f"{key.text} leaves out {', '.join(stands)}, which are 0 in Nav2; here they have the values of ROS 1"
            )
        # In Nav2 the goal checker decides when the robot has arrived.
        entries = [
            entry for entry in entries if entry[0].text not in {name.text for name, _ in tolerances}
        ] + tolerances
        entries += [(_scalar(nav2_names.HALVED[name.text], name.line), self._half(weight)) for name, weight in weights]
        yield _scalar("DWAPlannerROS", key.line), Section(own.line, entries)

    def _checker(self, parameters: Section, kind: str) -> tuple[str, Section]:
        """Return the first checker of a kind, or Nav2's default checker without parameters. The others are reported."""
        inner = {key.text: child for key, child in parameters.entries}
        listing = inner.get(f"{kind}_plugins")
        names = (
            [item.text for item in listing.items if isinstance(item, Scalar)] if isinstance(listing, Listing) else []
        )
        names = names or [name for name in inner if kind in name and isinstance(inner[name], Section)]
        self._strange += names[1:]
        first = inner.get(names[0]) if names else None
        return (names or [kind])[0], first if isinstance(first, Section) else Section(parameters.line, [])

    def _with_critics(self, planner: str, own: Section) -> list[Entry]:
        """Return DWB's parameters with their effective weights: 0 for critics that are not listed, and 1 by default."""
        entries = [*_dotted(own)]
        listing = next((child for key, child in entries if key.text == "critics"), None)
        if not isinstance(listing, Listing):
            self._add_notice(f"{planner} leaves out critics, without which DWB does not start; weights are as in ROS 1")
            return entries
        listed = {item.text for item in listing.items if isinstance(item, Scalar)}
        obstacles = next((name for name in _OBSTACLES if name in listed), _OBSTACLES[0])
        scales = {f"{name}.scale": name for name in ("PathDist", "GoalDist", obstacles)}
        names = {f"{obstacles}.{word}": f"{_OBSTACLES[0]}.{word}" for word in ("scale", "sum_scores")}
        weighed: list[Entry] = []
        for key, child in entries:
            if key.text in scales and scales[key.text] not in listed:
                self._strange.append(f"{planner}.{key.text} (not in critics)")
            else:
                weighed.append((_scalar(names.get(key.text, key.text), key.line), child))
        present = {key.text for key, _ in weighed}
        for scale, name in scales.items():
            weight = names.get(scale, scale)
            if weight not in present:
                value = _SCALE if name in listed else "0.0"
                why = f"critics {'list' if name in listed else 'leave out'} {name}"
                self._add_notice(f"{planner}.{scale} is {value} in Nav2, because {why}")
                weighed.append((_scalar(weight, own.line), _scalar(value, own.line)))
        return weighed

    def _half(self, weight: Scalar) -> Scalar:
        try:
            return _scalar(repr(float(weight.text) / 2.0), weight.line)
        except ValueError:
            return weight  # The loader reports the fault.
