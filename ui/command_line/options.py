"""Options that several commands share."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from thbridge.mavlink.values.options import AutopilotIdentity
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.ros2graph.values.address import MOST_DOMAINS, CarrierKind
from thbridge.sockets.addresses import LOCALHOST, ROS_MASTER_URI, TEXT_SERVER_PORT, WATCH_PORT
from ui.command_line.terminal import BAD_INPUT, fail

StudyFile = Annotated[
    Path | None,
    typer.Argument(
        help="Study file (YAML; see `thbridge study init`), or a built-in study: `standard` or `original-2016`. "
        "Options of this command override keys of the study."
    ),
]
StudyOption = Annotated[Path | None, typer.Option("--study", help="Same as the argument `study_file`.", hidden=True)]
# The bounds are the same as in study files, so that the study stored in a bag can be read again.
Robots = Annotated[int | None, typer.Option(help="Number of robots.", min=1, max=64)]
MapName = Annotated[
    str | None, typer.Option("--map", help="Name of a map, or path of its folder; a path needs a slash.")
]
Seed = Annotated[
    int | None,
    typer.Option(help="Random seed. The same seed, study and inputs give the same run.", min=0, max=2**31 - 1),
]
LanguageOption = Annotated[
    str | None,
    typer.Option("--language", metavar="NAME", help="Language of the participant: en, de, or a language you added."),
]
Port = Annotated[int | None, typer.Option(help="TCP port for other programs; 0 means any free port.", min=0, max=65535)]
BagFile = Annotated[
    Path | None,
    typer.Option(
        help="Recording: NAME.bag (ROS 1), NAME.mcap (ROS 2), or a name without ending (rosbag2 folder). An existing "
        "recording of this name is renamed."
    ),
]


class ProgressKind(StrEnum):
    """Formats of the progress of a long command."""

    AUTO = "auto"
    JSON = "json"


ProgressOption = Annotated[
    ProgressKind,
    typer.Option(
        "--progress",
        help="Form of the progress messages on standard error. `auto`: a bar on a terminal, otherwise a line per "
        "minute. `json`: one JSON object per line.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output, and nothing else.")]
Templates = Annotated[str | None, typer.Option(help="Name of a template set, or path of its folder.")]
ADDRESS = f"{LOCALHOST}:{TEXT_SERVER_PORT}"
OpenTo = Annotated[
    list[str] | None,
    typer.Option(
        "--open-to",
        metavar="NETWORK",
        help="Network whose machines may connect to servers that listen on more than 127.0.0.1, such as 10.0.0.0/24; "
        "see `thbridge docs security`. Can be repeated.",
    ),
]

Keys = Annotated[
    Path | None,
    typer.Option(
        "--keys",
        help="Folder of keys (see `thbridge keys new`) for programs and windows on other machines. Their connections "
        "are encrypted; see `thbridge docs security`.",
    ),
]
KeyFile = Annotated[
    Path | None,
    typer.Option("--signing-key", metavar="FILE", help="Sign and verify MAVLink frames with the key in this file."),
]


class ColourScheme(StrEnum):
    """Colors of windows."""

    SYSTEM = "system"
    LIGHT = "light"
    DARK = "dark"


LookOption = Annotated[
    ColourScheme,
    typer.Option(
        "--look",
        help="Colors of windows. `system` means the colors that you chose in a window; "
        "if you chose none, windows have the colors of the desktop.",
    ),
]


PERSON = "person"
"""Name of the participant who types in the terminal."""
_SIMULATED = tuple(each.value for each in BotStrategy)


def one_of(built_in: tuple[str, ...], group: str) -> Callable[[str | None], str | None]:
    """Return the callback of an option that accepts a built-in name, or a name installed in a group of entry points."""

    def check(name: str | None) -> str | None:
        if name is None or name in built_in:
            return name
        from thbridge.files.plugins import names_in  # noqa: PLC0415 - not needed by help and completion

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
        help="Play without a window. The player is `person` (you, in the terminal), a built-in simulated "
        "participant, or an installed simulated participant with this NAME.",
    ),
]
SeatName = Annotated[
    str | None,
    typer.Option(
        "--seat",
        metavar="NAME",
        help="Seat that you take in a game with several participants; see `seats` in the study.",
    ),
]
SimulatedParticipant = Annotated[
    str | None,
    typer.Option(
        "--participant",
        metavar="|".join((*_SIMULATED, "NAME")),
        callback=one_of(_SIMULATED, "thbridge.participants"),
        autocompletion=lambda: [*_SIMULATED],
        help="Replace the recorded participant with a simulated participant.",
    ),
]


@dataclass(frozen=True, slots=True)
class ClientOptions:
    """Study, and the text server that a program connects to."""

    study_file: StudyFile = None
    study_option: StudyOption = None
    server: Annotated[
        str | None,
        typer.Option(
            help=f"Address of the text server; default: the address in the study, otherwise {ADDRESS}.",
            metavar="HOST:PORT",
        ),
    ] = None
    key: Annotated[
        Path | None,
        typer.Option(help="File with the key that the server requires. The connection is encrypted.", metavar="FILE"),
    ] = None


def the_study(by_position: Path | None, by_option: Path | None) -> Path | None:
    """Return the study file, which is an argument or, as in older versions, the option --study."""
    if by_position is not None and by_option is not None:
        fail(BAD_INPUT, f"--study: {by_position} is already given as an argument. Omit one of the two.")
    return by_position or by_option


Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        help="Address of the scheduler of a Dask cluster, such as tls://10.0.0.1:8786.",
        metavar="ADDRESS",
    ),
]


class EngineKind(StrEnum):
    """Kinds of engines, which play the games of a batch."""

    PROCESSES = "processes"
    DASK = "dask"
    SLURM = "slurm"


@dataclass(frozen=True, slots=True)
class RosOptions:
    """ROS 1 graph to join."""

    join: Annotated[bool, typer.Option("--ros", help="Join a ROS 1 graph; see `thbridge docs live-graph`.")] = False
    ros_master: Annotated[
        str | None,
        typer.Option(
            envvar="ROS_MASTER_URI",
            metavar="URI",
            help=f"Address of the ROS master (default {ROS_MASTER_URI}). If the address is on this machine and no "
            "master runs there, this program starts a master.",
        ),
    ] = None
    ros_host: Annotated[
        str | None,
        typer.Option(
            envvar=["ROS_HOSTNAME", "ROS_IP"],
            help="Address at which ROS nodes connect to this program (default 127.0.0.1). Any node that can connect "
            "can drive robots.",
        ),
    ] = None


@dataclass(frozen=True, slots=True)
class Ros2Options:
    """ROS 2 graph to join. Its other settings are in the study's section `ros2`."""

    join_ros2: Annotated[bool, typer.Option("--ros2", help="Join a ROS 2 graph; see `thbridge docs live-graph`.")] = (
        False
    )
    ros2_domain: Annotated[
        int | None,
        typer.Option(
            envvar="ROS_DOMAIN_ID",
            min=0,
            max=MOST_DOMAINS,
            help="Domain id of the ROS 2 graph. If not given, that of the study (default 0).",
        ),
    ] = None
    carrier: Annotated[
        CarrierKind | None,
        typer.Option(
            help="Protocol of the ROS 2 graph: `dds`, or `zenoh` (with a router). If not given, that of the study "
            "(default dds)."
        ),
    ] = None


@dataclass(frozen=True, slots=True)
class WatchOptions:
    """Ports for windows that show a session."""

    watch: Annotated[
        str | None,
        typer.Option(
            metavar="[HOST:]PORT",
            help=f"Accept researchers' windows at this port, such as {WATCH_PORT}; see `thbridge docs watching`.",
        ),
    ] = None
    watch_key: Annotated[
        Path | None,
        typer.Option(
            help="Folder of keys (see `thbridge keys new`), or file with one key. Researchers' windows then need a key."
        ),
    ] = None
    foxglove: Annotated[
        int | None,
        typer.Option(
            help="Port on this machine at which Foxglove can show the session; see `thbridge docs watching`.",
            min=0,
            max=65535,
        ),
    ] = None


@dataclass(frozen=True, slots=True)
class MavlinkOptions:
    """Options of robots as MAVLink vehicles."""

    on: Annotated[
        bool | None,
        typer.Option("--mavlink/--no-mavlink", help="Run each robot as a MAVLink rover; see `thbridge docs mavlink`."),
    ] = None
    identity: Annotated[
        AutopilotIdentity | None,
        typer.Option(
            help="Autopilot type that robots report. QGroundControl can command robots only if the type is `ardupilot`."
        ),
    ] = None
    udp: Annotated[
        list[str] | None,
        typer.Option(
            metavar="HOST:PORT",
            help="Address of a ground station. With HOST:PORT/ROBOT, it receives only the frames of this robot. "
            "Can be repeated.",
        ),
    ] = None
    udp_listen: Annotated[
        str | None,
        typer.Option(
            metavar="HOST:PORT", help="UDP address at which robots wait for the first message of ground stations."
        ),
    ] = None
    tcp: Annotated[
        str | None, typer.Option(metavar="HOST:PORT", help="TCP address at which ground stations connect.")
    ] = None
    signing_key: KeyFile = None
    tlog: Annotated[
        bool | None,
        typer.Option("--tlog/--no-tlog", help="Also write all MAVLink frames to a .tlog file next to the bag."),
    ] = None


@dataclass(frozen=True, slots=True)
class EngineOptions:
    """Engine that plays the games of a batch."""

    engine: Annotated[
        EngineKind,
        typer.Option(help="Run games in processes on this machine, on a Dask cluster, or in Slurm jobs."),
    ] = EngineKind.PROCESSES
    processes: Annotated[
        int | None, typer.Option(help="Number of processes on this machine; default: one per core.", min=1, max=1024)
    ] = None
    scheduler: Scheduler = None
    jobs: Annotated[int, typer.Option(help="Number of Slurm jobs to submit at a time.", min=1, max=10_000)] = 10
    job_options: Annotated[
        list[str] | None,
        typer.Option(
            "--slurm",
            metavar="KEY=VALUE",
            help="Option of `sbatch` for Slurm jobs, for example `--slurm partition=short`. Can be repeated.",
        ),
    ] = None
