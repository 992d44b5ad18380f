"""Settings of a session: the study, the options that change the study, and all files that the study names."""

import dataclasses
import os
from collections.abc import Mapping
from pathlib import Path

from thbridge.app.compose.setting import StudySetting, read_map_of, read_setting
from thbridge.files.map_files import Map
from thbridge.files.resources import shipped
from thbridge.files.word_files import SHIPPED_LANGUAGES, languages_in
from thbridge.files.yaml.load import Loaded
from thbridge.sockets.addresses import Address, parse_address, parse_target
from thbridge.study.built_in import study_at
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.overrides import StudyChange
from thbridge.study.study_file import Study
from ui.command_line.options import MavlinkOptions
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note


def study_of(file: Path | None, changes: Mapping[str, object]) -> Study:
    """Return the study of a file, or a built-in study, as changed by options. An option that is None changes nothing.

    Without a file, each key has its default. The defaults are the values of the 2016 game, because other programs
    expect them.
    """
    with bad_input():
        study, loaded = study_at(file)
    for notice in () if loaded is None else loaded.notices:
        note(notice)
    return with_options(study, changes)


def with_options(study: Study, changes: Mapping[str, object]) -> Study:
    """Return a study as changed by options. An option that is None changes nothing."""
    given = {key: value for key, value in changes.items() if value is not None}
    changed = dataclasses.replace(study, **given)  # type: ignore[arg-type]  # the options have their types from typer
    if any(number > changed.robots for number in changed.each):
        problem = f"--robots {changed.robots}: the study configures robot {max(changed.each)} under `each`"
        fail(BAD_INPUT, f"{problem}. Use more robots, or delete this entry from the study.")
    return changed


def with_language(study: Study, language: str | None, file: Path | None) -> Study:
    """Return the study in another language: a built-in language, or a language of the study's folder of words.

    If `language` is None, return the study unchanged.
    """
    if language is None:
        return study
    folders = [SHIPPED_LANGUAGES]
    if study.dialogue.words is not None:
        folders.append((Path() if file is None else file.parent) / study.dialogue.words)
    known = sorted({name for folder in folders for name in languages_in(folder)})
    if language not in known:
        fail(BAD_INPUT, f"--language: there is no language {language!r}. Choose one of {', '.join(known)}.")
    return dataclasses.replace(study, dialogue=dataclasses.replace(study.dialogue, language=language))


def with_strategy(study: Study, strategy: str | None) -> Study:
    """Return the study with this strategy of the simulated participant; if None, return it unchanged."""
    if strategy is None:
        return study
    return dataclasses.replace(study, participant=dataclasses.replace(study.participant, strategy=strategy))


def changes_of(given: list[str]) -> tuple[list[Path], list[StudyChange]]:
    """Return the study files and the single changes that the values of --with name."""
    files, changes = [], []
    for text in given:
        key, equals, value = text.partition("=")
        if equals and key and not Path(text).exists():
            changes.append(StudyChange(key.strip(), value))
        elif text.endswith((".yaml", ".yml")):
            files.append(Path(text))
        else:
            problem = f"--with: {text!r} is neither KEY=VALUE nor a study file"
            fail(BAD_INPUT, f"{problem}. Write, for example, --with robot.amcl.max_particles=500.")
    return files, changes


def with_server(study: Study, host: str | None, port: int | None) -> Study:
    """Return the study with another host or port to listen on. An argument that is None changes nothing."""
    given = study.server
    changed = dataclasses.replace(
        given, host=given.host if host is None else host, port=given.port if port is None else port
    )
    return dataclasses.replace(study, server=changed)


def setting_of(study: Study, file: Path | None) -> StudySetting:
    """Read everything that the study names; relative paths start from the folder of the study's file."""
    # From now on, new files can be read by the accounts that the study allows (`recording: readers:`).
    os.umask(study.recording.readers.umask)
    with bad_input():
        return read_setting(study, Path() if file is None else file.parent, written=_written(file))


def note_doubts(setting: StudySetting) -> None:
    """Print warnings about a setting's map, templates and costs."""
    for warning in setting.doubts:
        note(str(warning))


def map_of(study: Study, file: Path | None) -> Map:
    """Return the study's map without travel costs, for commands that play no game.

    Relative paths start at the folder of the study's file.
    """
    with bad_input():
        beside = Path() if file is None else file.parent
        return read_map_of(study, beside, with_costs=False, written=_written(file))


def _written(file: Path | None) -> Loaded[Study] | None:
    """Return the study as it is in the file, so that error messages can name lines; None without a file."""
    return study_at(file)[1]


def map_folder(name: str) -> Path:
    """Return the folder of a map, given the map's name or the folder's path, with or without a slash."""
    wanted = f"./{name}" if "/" not in name and Path(name).is_dir() else name
    with bad_input():
        return shipped().find("maps", wanted, Path())


def check_simulated(study: Study, command: str) -> None:
    """End the program if other programs drive the robots of the study, because the command drives robots itself."""
    if study.robots_from.is_real:
        fail(
            BAD_INPUT,
            f"robots_from: this study is for real robots, but `{command}` simulates them. Start `thbridge server`, "
            "`simr`, `hider` and `tabui`, or set robots_from: sim in the study.",
        )
    if study.external_nodes is not ExternalNodes.NONE:
        fail(
            BAD_INPUT,
            f"external_nodes: other ROS nodes drive these robots, but `{command}` drives robots itself. Start `simr "
            "--ros` (or --ros2) with this study, and play with `simr --robots-from ros` (or ros2).",
        )


def with_mavlink(study: Study, options: MavlinkOptions) -> Study:
    """Return the study as changed by the MAVLink options. An option that is None changes nothing."""
    for option, text in (("--udp-listen", options.udp_listen), ("--tcp", options.tcp)):
        if text is not None and parse_address(text) is None:
            fail(BAD_INPUT, f"{option}: {text!r} is not an address. Write HOST:PORT, such as 127.0.0.1:14550.")
    targets = None if options.udp is None else tuple(dict.fromkeys(options.udp))
    taken: set[Address] = set()
    for text in targets or ():
        target = parse_target(text)
        if target is None:
            fail(
                BAD_INPUT,
                f"--udp: {text!r} is not an address. Write HOST:PORT, such as 127.0.0.1:14550, or HOST:PORT/ROBOT.",
            )
        if target.number is not None and target.number > study.robots:
            fail(BAD_INPUT, f"--udp: {text!r}: there is no robot {target.number}. The last robot is {study.robots}.")
        if target.address in taken:
            fail(BAD_INPUT, f"--udp: {target.address} is already used for other robots. Use another port for {text!r}.")
        taken.add(target.address)
    given = {"on": options.on, "udp": targets}
    given |= {key: getattr(options, key) for key in ("identity", "udp_listen", "tcp", "tlog")}
    changes = {key: value for key, value in given.items() if value is not None}
    section = dataclasses.replace(study.mavlink, **changes)  # type: ignore[arg-type]  # the options have their types
    unused = next((key for key in changes if key != "on"), None)
    if unused is not None and not section.on:
        option = unused.replace("_", "-")
        fail(BAD_INPUT, f"--{option}: MAVLink is off in this session. Add --mavlink, or omit this option.")
    return dataclasses.replace(study, mavlink=section)
