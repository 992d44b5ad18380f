"""Options that several commands share."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.sockets.addresses import LOCALHOST, ROS_MASTER_URI, TEXT_SERVER_PORT, WATCH_PORT
from ui.command_line.terminal import BAD_INPUT, fail

StudyFile = Annotated[
    Path | None,
    typer.Argument(
        help="Study file (YAML), see `thbridge study init`; or `standard` or `original-2016`, the built-in studies. "
        "Options below win over it."
    ),
]
StudyOption = Annotated[Path | None, typer.Option("--study", help="The same as `study_file` by position.", hidden=True)]
# The bounds are those of the study file, so that the study in a bag can be read again.
Robots = Annotated[int | None, typer.Option(help="Size of the team.", min=1, max=64)]
MapName = Annotated[str | None, typer.Option("--map", help="Name of a map, or path of its folder (with a slash).")]
Seed = Annotated[
    int | None, typer.Option(help="Same seed, same study, same inputs: the same run.", min=0, max=2**31 - 1)
]
LanguageOption = Annotated[
    str | None,
    typer.Option("--language", metavar="NAME", help="Language of the participant: en, de, or one that you installed."),
]
Port = Annotated[int | None, typer.Option(help="TCP port for other programs; 0 takes a free one.", min=0, max=65535)]
BagFile = Annotated[Path | None, typer.Option(help="Where to record. An older file is kept under a new name.")]


class ProgressKind(StrEnum):
    """Forms of the progress of a long command."""

    AUTO = "auto"
    JSON = "json"


ProgressOption = Annotated[
    ProgressKind,
    typer.Option(
        "--progress",
        help="Progress on standard error. `auto`: a bar on a terminal, or else a line a minute. `json`: an object a "
        "line.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output, nothing else.")]
Templates = Annotated[str | None, typer.Option(help="Name of a set of templates, or path of its folder.")]
ADDRESS = f"{LOCALHOST}:{TEXT_SERVER_PORT}"
OpenTo = Annotated[
    list[str] | None,
    typer.Option(
        "--open-to",
        metavar="NETWORK",
        help="Network, such as 10.0.0.0/24, whose machines may connect where an address is not this machine's alone; "
        "see `thbridge docs security`. May be given several times.",
    ),
]

Keys = Annotated[
    Path | None,
    typer.Option(
        "--keys",
        help="Folder of keys (`thbridge keys new`), by which programs and windows take part from other machines, "
        "encrypted; see `thbridge docs security`.",
    ),
]
KeyFile = Annotated[
    Path | None,
    typer.Option("--signing-key", metavar="FILE", help="MAVLink frames are signed and verified with this file's key."),
]


class ColourScheme(StrEnum):
    """Colors of windows."""

    SYSTEM = "system"
    LIGHT = "light"
    DARK = "dark"


LookOption = Annotated[
    ColourScheme,
    typer.Option(
        "--look", help="Light or dark windows. `system`: as in the window's settings, or else as the desktop."
    ),
]


PERSON = "person"
"""Participant who types."""
_SIMULATED = tuple(each.value for each in BotStrategy)


def one_of(built_in: tuple[str, ...], group: str) -> Callable[[str | None], str | None]:
    """Return the callback of an option that takes a built-in name, or one that is installed in a group."""

    def check(name: str | None) -> str | None:
        if name is None or name in built_in:
            return name
        from thbridge.files.plugins import names_in  # noqa: PLC0415 - help and completion load nothing of it

        if name not in (installed := names_in(group)):
            raise typer.BadParameter(f"{name!r} is not one of {', '.join(map(repr, (*built_in, *installed)))}.")
        return name

    return check


ParticipantName = Annotated[
    str | None,
    typer.Option(
        "--participant",
        metavar="|".join((PERSON, *_SIMULATED, "NAME")),
        callback=one_of((PERSON, *_SIMULATED), "thbridge.participants"),
        autocompletion=lambda: [PERSON, *_SIMULATED],
        help="You in the terminal (`person`), or how a simulated participant chooses rooms, or the NAME of one that is "
        "installed; without a window.",
    ),
]
SimulatedParticipant = Annotated[
    str | None,
    typer.Option(
        "--participant",
        metavar="|".join((*_SIMULATED, "NAME")),
        callback=one_of(_SIMULATED, "thbridge.participants"),
        autocompletion=lambda: [*_SIMULATED],
        help="Let a simulated participant play anew, instead of saying again what was said.",
    ),
]


@dataclass(frozen=True, slots=True)
class ClientOptions:
    """A study, and the text server at which a program takes part."""

    study_file: StudyFile = None
    study_option: StudyOption = None
    server: Annotated[
        str | None,
        typer.Option(
            help=f"Where the text server is, by default where the study has it, or else {ADDRESS}.", metavar="HOST:PORT"
        ),
    ] = None
    key: Annotated[
        Path | None,
        typer.Option(help="File with the key that the server wants; what is said is encrypted.", metavar="FILE"),
    ] = None


def the_study(by_position: Path | None, by_option: Path | None) -> Path | None:
    """The study file, which may be named by position or, as earlier, by --study."""
    if by_position is not None and by_option is not None:
        fail(BAD_INPUT, f"--study: {by_position} is named already. Leave one of the two out.")
    return by_position or by_option


class EngineKind(StrEnum):
    """Kinds of engines, which carry out the games."""

    PROCESSES = "processes"
    DASK = "dask"
    SLURM = "slurm"


@dataclass(frozen=True, slots=True)
class RosOptions:
    """The graph of ROS 1 nodes to take part in."""

    join: Annotated[bool, typer.Option("--ros", help="Take part in a ROS 1 graph; see `thbridge docs live-graph`.")] = (
        False
    )
    ros_master: Annotated[
        str | None,
        typer.Option(
            envvar="ROS_MASTER_URI",
            metavar="URI",
            help=f"The ROS master, by default {ROS_MASTER_URI}. Where none answers on this machine, this program is "
            "it.",
        ),
    ] = None
    ros_host: Annotated[
        str | None,
        typer.Option(
            envvar=["ROS_HOSTNAME", "ROS_IP"],
            help="Address for ROS nodes to reach this program, by default 127.0.0.1: who reaches it can drive robots.",
        ),
    ] = None


@dataclass(frozen=True, slots=True)
class WatchOptions:
    """Ports for windows that show a session."""

    watch: Annotated[
        str | None,
        typer.Option(
            metavar="[HOST:]PORT",
            help=f"Let researchers' windows connect, for example at {WATCH_PORT}; see `thbridge docs watching`.",
        ),
    ] = None
    watch_key: Annotated[
        Path | None,
        typer.Option(
            help="Folder of keys (`thbridge keys new`), or file with one: whoever watches has one. They see the truth.",
        ),
    ] = None
    foxglove: Annotated[
        int | None,
        typer.Option(
            help="Show the session in Foxglove, at this port of this machine; see `thbridge docs watching`.",
            min=0,
            max=65535,
        ),
    ] = None


@dataclass(frozen=True, slots=True)
class MavlinkOptions:
    """Robots as MAVLink vehicles."""

    on: Annotated[
        bool | None,
        typer.Option("--mavlink/--no-mavlink", help="Make every robot a MAVLink rover; see `thbridge docs mavlink`."),
    ] = None
    identity: Annotated[
        AutopilotIdentity | None,
        typer.Option(help="Whose autopilot robots say they have; QGroundControl commands only ardupilot's."),
    ] = None
    udp: Annotated[
        list[str] | None,
        typer.Option(
            metavar="HOST:PORT",
            help="Where a ground station listens, HOST:PORT/ROBOT for one robot alone; may be given several times.",
        ),
    ] = None
    udp_listen: Annotated[
        str | None,
        typer.Option(metavar="HOST:PORT", help="Where ground stations that speak first find robots by UDP."),
    ] = None
    tcp: Annotated[str | None, typer.Option(metavar="HOST:PORT", help="Where ground stations may connect by TCP.")] = (
        None
    )
    signing_key: KeyFile = None
    tlog: Annotated[
        bool | None, typer.Option("--tlog/--no-tlog", help="Also write all MAVLink frames into a .tlog beside the bag.")
    ] = None


@dataclass(frozen=True, slots=True)
class EngineOptions:
    """Engine that carries out a batch."""

    engine: Annotated[
        EngineKind,
        typer.Option(help="Who plays: processes of this machine, a Dask cluster, or jobs of Slurm."),
    ] = EngineKind.PROCESSES
    processes: Annotated[
        int | None, typer.Option(help="Processes of this machine; by default one on every core.", min=1, max=1024)
    ] = None
    scheduler: Annotated[
        str | None,
        typer.Option(help="Scheduler of a Dask cluster, such as tls://10.0.0.1:8786.", metavar="ADDRESS"),
    ] = None
    jobs: Annotated[int, typer.Option(help="Jobs of Slurm to submit at a time.", min=1, max=10_000)] = 10
    job_options: Annotated[
        list[str] | None,
        typer.Option(
            "--slurm",
            metavar="KEY=VALUE",
            help="Option of Slurm's jobs, as `sbatch` has it: `--slurm partition=short`. May be given several times.",
        ),
    ] = None
