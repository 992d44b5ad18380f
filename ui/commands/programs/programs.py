"""Commands that run one program each: the text server, and its clients."""

import dataclasses
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen, CannotReach
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.robots_from import RobotsFrom
from ui.command_line.option_sets import with_option_sets
from ui.command_line.options import (
    PERSON,
    AsJson,
    BagFile,
    ClientOptions,
    ColourScheme,
    Keys,
    LookOption,
    MapName,
    OpenTo,
    ParticipantName,
    Port,
    Robots,
    Ros2Options,
    RosOptions,
    SeatName,
    Seed,
    StudyFile,
    Templates,
    WatchOptions,
    the_study,
)
from ui.command_line.outputs import make_ready
from ui.command_line.terminal import BAD_INPUT, DECLINED, FAILED, bad_input, fail, note, print_json, say, show
from ui.windows.display import why_no_window

if TYPE_CHECKING:
    from thbridge.ros2graph.sockets.joining import NodeTaken


def server(
    study_file: StudyFile = None,
    host: Annotated[str | None, typer.Option(help="Address to listen on; 0.0.0.0 also accepts other machines.")] = None,
    port: Port = None,
    keys: Keys = None,
    open_to: OpenTo = None,
    journal: Annotated[Path, typer.Option(help="Folder for the journals of games.")] = Path("journal"),
    new_game: Annotated[
        bool, typer.Option("--new-game", help="Start a new game even if a game is unfinished.")
    ] = False,
) -> None:
    """Run the text server of 2016 and the keeper, which manages the game, until the command is stopped."""
    import secrets

    from thbridge.app.server import serve
    from thbridge.recording.journal_folder import JournalStore
    from ui.command_line.event_loop import run
    from ui.command_line.keys import keys_of
    from ui.command_line.networks import check_doors, with_open_to
    from ui.command_line.settings import note_doubts, setting_of, study_of, with_server

    study = with_open_to(with_server(study_of(study_file, {}), host, port), open_to)
    ring = keys_of(study, study_file, keys)
    check_doors(study, ring)
    setting = setting_of(study, study_file)
    note_doubts(setting)

    with bad_input():
        ledger = JournalStore(journal)

    def ready(where: ListeningAddress | CannotListen) -> None:
        if isinstance(where, CannotListen):
            fail(BAD_INPUT, str(where))
        print(f"listening on {where.host}:{where.port}", flush=True)  # noqa: T201 - programs wait for this line
        if study.seats:
            note(f"Seats: {', '.join(each.name for each in study.seats)}. Start `thbridge tabui` with --seat for each.")

    run(serve(setting, ledger, new_game, ready, ring, secrets.token_hex(8)))


@with_option_sets
def simr(
    client: ClientOptions,
    robots: Robots = None,
    map_name: MapName = None,
    robots_from: Annotated[
        RobotsFrom | None,
        typer.Option(
            help="`sim`: simulate the robots. `ros`, `ros2`: command robots on a ROS 1 or ROS 2 graph; see "
            "`thbridge docs real-robots`."
        ),
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            help="Simulated seconds per real second; default: the study's rate, otherwise 1.", min=0.01, max=1000
        ),
    ] = None,
    seed: Seed = None,
    bag: BagFile = None,
    *,
    ros: RosOptions,
    ros2: Ros2Options,
    watching: WatchOptions,
    open_to: OpenTo = None,
) -> None:
    """Run the robots (SimR) as a client of a text server, until the command is stopped."""
    from thbridge.app import programs
    from thbridge.app.programs import SimrOptions
    from thbridge.app.real_robots import simr_with_real_robots
    from ui.command_line.event_loop import run
    from ui.command_line.keys import key_of, keys_of
    from ui.command_line.listening import check_foxglove, graph_of, hosts_of, ros2_of, watch_of
    from ui.command_line.networks import check_doors, with_open_to
    from ui.command_line.settings import note_doubts, setting_of, study_of
    from ui.commands.programs.client import address_of, new_token, note_settings_without_effect, tell_lost
    from ui.first_start.compiling import compile_ahead

    study_file = the_study(client.study_file, client.study_option)
    changes = {"robots": robots, "robots_from": robots_from, "map": map_name, "seed": seed}
    study = with_open_to(study_of(study_file, changes), open_to)
    host, port = address_of(client.server, study.server)
    if study.mavlink.on:
        # Another program, the game, decides where a robot may be sent.
        note("mavlink has no effect here: robots are MAVLink vehicles only in `thbridge play`.")
        study = dataclasses.replace(study, mavlink=dataclasses.replace(study.mavlink, on=False))
    setting = setting_of(study, study_file)
    note_doubts(setting)
    source = setting.study.robots_from
    real = source.is_real
    if study.external_nodes is not ExternalNodes.NONE and not (real or ros.join or ros2.join_ros2):
        fail(
            BAD_INPUT,
            "external_nodes: other nodes drive these robots on a ROS graph. Add --ros or --ros2, or set "
            "external_nodes: none.",
        )
    if real and (ros.join or ros2.join_ros2):
        option = "--ros" if ros.join else "--ros2"
        problem = f"real robots ({source.value}) are always on their own graph, which simr joins without this option"
        fail(BAD_INPUT, f"{option}: {problem}. Omit the option.")
    if real and watching.watch is not None:
        fail(BAD_INPUT, "--watch: this option needs simulated robots. Omit it, and watch real robots with rviz.")
    if real and watching.foxglove is not None:
        remedy = "Omit it, and watch real robots with foxglove_bridge"
        fail(BAD_INPUT, f"--foxglove: this option needs simulated robots. {remedy}.")
    if real and rate is not None:
        fail(BAD_INPUT, "--rate: real robots run in real time. Omit the option.")
    if real and (clash := setting.study.fleet.clash(setting.study.robots, source)) is not None:
        fail(BAD_INPUT, f"{clash.problem}. Write other names into the study's `fleet`, or use fewer robots.")
    graph = graph_of(dataclasses.replace(ros, join=ros.join or source is RobotsFrom.ROS), study.open_to)
    graph2 = ros2_of(study, dataclasses.replace(ros2, join_ros2=ros2.join_ros2 or source is RobotsFrom.ROS2))
    door = None
    if not real:
        door = watch_of(setting.study, study_file, watching, keys_of(setting.study, study_file, None))
    check_doors(study, None, door, graph, graph2, serves_text=False)
    shown = None if client.key is None else key_of(client.key)
    if bag is not None:
        make_ready(bag, setting.study.recording.compression)
    robots_graph = graph2 if source is RobotsFrom.ROS2 else graph
    if real and robots_graph is not None:
        note_settings_without_effect(setting.study)
        if graph2 is not None:
            note(f"ROS 2: {graph2}.")
        options = SimrOptions(host, port, new_token(), 1.0, bag, key=shown)
        unreachable = partial(_unreachable, "ROS" if graph2 is None else "ROS 2")
        unfit = run(simr_with_real_robots(setting, options, robots_graph, tell_lost, unreachable, _missing))
        if unfit is not None:
            fail(FAILED, unfit)
        return
    check_foxglove(watching.foxglove)
    compile_ahead(whole_hunt=True)
    options = SimrOptions(
        host, port, new_token(), rate or setting.study.rate or 1.0, bag, graph, door, watching.foxglove, shown, graph2
    )
    unfit = run(programs.simr(setting, options, tell_lost, hosts_of(graph, ros2=graph2)))
    if unfit is not None:
        fail(FAILED, unfit)


@with_option_sets
def hider(
    client: ClientOptions,
    treasures: Annotated[
        str | None, typer.Option(help="Name or folder of a template set that has `treasures`.")
    ] = None,
    seed: Seed = None,
) -> None:
    """Run the program that hides treasures (Hider) as a client of a text server, until the command is stopped."""
    from thbridge.app import programs
    from thbridge.app.compose.game import build_hider
    from ui.command_line.event_loop import run
    from ui.command_line.keys import key_of
    from ui.command_line.settings import study_of
    from ui.commands.programs.client import address_of, new_token, read_templates, tell_lost

    study_file = the_study(client.study_file, client.study_option)
    study = study_of(study_file, {"templates": treasures, "seed": seed})
    host, port = address_of(client.server, study.server)
    beside = Path() if study_file is None or treasures is not None else study_file.parent
    role = build_hider(read_templates(study.templates, beside), study.seed)
    run(programs.hider(role, host, port, new_token(), tell_lost, None if client.key is None else key_of(client.key)))


@with_option_sets
def tabui(
    client: ClientOptions,
    participant: ParticipantName = None,
    seat: SeatName = None,
    as_researcher: Annotated[
        bool,
        typer.Option(
            "--as-researcher",
            help="Play the seat in the place of its person while they are away, until they come back. The recording "
            "names a researcher as the player. On another machine, the key needs the right `intervene`.",
        ),
    ] = False,
    templates: Templates = None,
    seed: Seed = None,
    look: LookOption = ColourScheme.SYSTEM,
    as_json: AsJson = False,
    hosted: Annotated[bool, typer.Option("--hosted", hidden=True)] = False,
) -> None:
    """Run the participant's program (TabUI) as a client of a text server, in a window.

    Without a display, a simulated participant plays. In a game with several seats, --seat names the participant's seat.
    """
    if hosted:
        from ui.windows.participant_program import play_hosted

        raise typer.Exit(play_hosted(look.value))
    from thbridge.app import programs
    from thbridge.files.language_texts import shipped_texts
    from thbridge.hunt.seats import PlayedBy
    from thbridge.roles.participant.bot_strategy import BotStrategy
    from ui.command_line.event_loop import run
    from ui.command_line.keys import key_of
    from ui.command_line.seats import client_seat
    from ui.command_line.settings import study_of
    from ui.commands.programs.client import ANOTHER_GAME, address_of, new_token, player_of, show_nothing, tell_lost

    study_file = the_study(client.study_file, client.study_option)
    study = study_of(study_file, {"templates": templates, "seed": seed})
    host, port = address_of(client.server, study.server)
    shown = None if client.key is None else key_of(client.key)
    own_seat = client_seat(study, study_file, seat)
    if as_researcher and not own_seat:
        fail(BAD_INPUT, "--as-researcher: only seats of a game with several people can be taken. Add --seat NAME.")
    why = why_no_window()
    in_window = participant is None and templates is None and seed is None and not as_json
    if as_researcher and not (in_window and why is None):
        reason = why if in_window and why else "A researcher plays in a window."
        fail(BAD_INPUT, f"--as-researcher: {reason} Omit the options of simulated participants, and use a display.")
    if in_window:
        if why is None:
            from ui.windows.participant_program import play_at

            by = PlayedBy.RESEARCHER if as_researcher else PlayedBy.PERSON
            raise typer.Exit(play_at(host, port, new_token(), look.value, shown, own_seat, by))
        note(f"{why} A simulated participant plays.")
    participant = participant or BotStrategy.SUGGESTION.value
    player = player_of(participant, study, study_file, templates, seed, own_seat)
    program = programs.tabui(player.tabui, host, port, new_token(), tell_lost, show_nothing, shown)
    last = run(program, player.typed)
    if player.tabui.declined:
        say((player.tabui.texts or shipped_texts()).text("terminal.thanks"))
        raise typer.Exit(DECLINED)
    if last is None:
        fail(FAILED, "Stopped before the game was over.")
    if as_json:
        visited = sum(room.state == "visited" for room in last.rooms)
        print_json({"score": last.score, "rooms_visited": visited, "over": last.over})
    else:
        if participant != PERSON:  # A person who plays in the terminal has already read this.
            show(f"The game is over. Score {last.score}.")
        note(ANOTHER_GAME)


def _unreachable(graph: str, why: "CannotListen | CannotReach | NodeTaken") -> None:
    fail(BAD_INPUT, f"{graph}: {why}")


def _missing(sentences: Sequence[str]) -> None:
    for sentence in sentences or ["All robots have been found."]:
        note(sentence)
