"""`thbridge play`: all roles of a hunt in one program."""

import dataclasses
import math
from contextlib import nullcontext
from typing import TYPE_CHECKING, Annotated

import typer

from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from ui.command_line.option_sets import with_option_sets
from ui.command_line.options import (
    PERSON,
    AsJson,
    BagFile,
    ColourScheme,
    Keys,
    LanguageOption,
    LookOption,
    MapName,
    MavlinkOptions,
    OpenTo,
    ParticipantName,
    Port,
    ProgressKind,
    ProgressOption,
    Robots,
    Ros2Options,
    RosOptions,
    SeatName,
    Seed,
    StudyFile,
    WatchOptions,
)
from ui.command_line.outputs import make_ready
from ui.command_line.terminal import BAD_INPUT, DECLINED, FAILED, NOT_TAKING_PART, bad_input, fail, note, print_json
from ui.windows.display import why_no_window

if TYPE_CHECKING:
    from thbridge.study.study_file import Study

AN_HOUR = 3600.0


@with_option_sets
def play(
    study_file: StudyFile = None,
    robots: Robots = None,
    map_name: MapName = None,
    headless: Annotated[bool, typer.Option(help="Run without a window even if a display is available.")] = False,
    participant: ParticipantName = None,
    seat: SeatName = None,
    seed: Seed = None,
    language: LanguageOption = None,
    rate: Annotated[
        float | None,
        typer.Option(
            help="Simulated seconds per real second; 0 means full speed, which is the default if neither people nor "
            "other programs play.",
            min=0,
            max=1000,
        ),
    ] = None,
    bag: BagFile = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--with",
            metavar="KEY=VALUE|FILE.yaml",
            help="Change a key of the study, for example `--with robot.amcl.max_particles=500`, or all keys that a "
            "FILE.yaml contains. Can be repeated.",
        ),
    ] = None,
    outside: Annotated[
        str,
        typer.Option(
            help="Roles that other programs play, for example `TabUI,Hider`; in a game with several seats, for example "
            "`TabUI-driver`.",
            metavar="ROLES",
        ),
    ] = "",
    port: Port = None,
    max_seconds: Annotated[
        float | None,
        typer.Option(
            help="Stop after this many simulated seconds. Default: 3600, but no limit with human players or MAVLink.",
            min=1,
        ),
    ] = None,
    report_page: Annotated[
        bool | None,
        typer.Option("--report/--no-report", help="Write an HTML report of the bag. Default: yes, except with --json."),
    ] = None,
    *,
    ros: RosOptions,
    ros2: Ros2Options,
    watching: WatchOptions,
    keys: Keys = None,
    open_to: OpenTo = None,
    mavlink: MavlinkOptions,
    look: LookOption = ColourScheme.SYSTEM,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Play a whole hunt in a window, and record it in a bag. Without a display, a simulated participant plays.

    The default study is `standard`; with --outside it is `original-2016`, the game of 2016.

    Other programs may connect to the TCP port, and replace the built-in programs for the roles that --outside names.
    With --outside, a window opens only if --seat names your seat.

    In a game with several seats, you take one seat, and simulated participants take the others.
    """
    from ui.first_start.bar import START_BAR, announce_start

    may_open = participant is None and not (headless or as_json) and (not outside or seat is not None)
    windowed = may_open and why_no_window() is None
    announce_start(look.value if windowed else None)

    from sim.common.observations import TICK
    from thbridge.app import play as hunt
    from thbridge.app.compose.game import build_participants
    from thbridge.app.consent import ParticipantDeclined
    from thbridge.app.play import HuntUnfinished, PlayOptions
    from thbridge.app.session.session import TickRecord
    from thbridge.files.language_texts import shipped_languages
    from thbridge.files.progress import untold
    from thbridge.study.built_in import STANDARD
    from thbridge.study.overrides import with_changes
    from thbridge.text_protocol.wire import legacy
    from ui.command_line.event_loop import run
    from ui.command_line.keys import keys_of
    from ui.command_line.listening import check_foxglove, graph_of, hosts_of, ports_of, ros2_of, watch_of
    from ui.command_line.networks import check_doors, with_open_to
    from ui.command_line.outcome import show_outcome, usual_bag
    from ui.command_line.progress import shown_progress
    from ui.command_line.report import write_report
    from ui.command_line.seats import person_seat
    from ui.command_line.settings import (
        changes_of,
        check_simulated,
        note_doubts,
        setting_of,
        study_of,
        with_language,
        with_mavlink,
        with_options,
        with_server,
        with_strategy,
    )
    from ui.command_line.story import print_story
    from ui.commands.programs.client import new_token
    from ui.first_start.compiling import compile_ahead

    files, assignments = changes_of(changes or [])
    # Other programs expect the game of 2016. Our own programs, if they run separately, expect it, too.
    study = STANDARD if study_file is None and not outside else study_of(study_file, {})
    with bad_input():
        study = with_changes(study, files, assignments)
    study = with_server(with_options(study, {"robots": robots, "map": map_name, "seed": seed}), None, port)
    study = with_mavlink(study, mavlink)
    study = with_language(with_open_to(study, open_to), language, study_file)
    if participant != PERSON:
        study = with_strategy(study, participant)
    check_simulated(study, "play")
    setting = setting_of(study, study_file)
    note_doubts(setting)
    others = _roles(outside, study)
    graph, graph2 = graph_of(ros, study.open_to), ros2_of(study, ros2)
    who = participant or study.participant.strategy
    if seat is not None and not (windowed or who == PERSON):
        why = why_no_window() if may_open else None
        problem = "no person plays with these options" if why is None else why.rstrip(".")
        fail(BAD_INPUT, f"--seat: {problem}. Omit the option, or play in the terminal: --participant person.")
    own_seat = person_seat(study, study_file, seat, others) if windowed or who == PERSON else ""
    ports = ports_of(study, study_file, mavlink.signing_key)
    people = windowed or bool(others) or who == PERSON or ports is not None
    limit = max_seconds or (math.inf if people else AN_HOUR)
    pace = next(given for given in (rate, study.rate, float(people or ros.join or ros2.join_ros2)) if given is not None)
    callbacks = hosts_of(graph, as_json, graph2)
    ring = keys_of(study, study_file, keys)
    door = watch_of(study, study_file, watching, ring)
    check_doors(study, ring, door, graph, graph2)
    check_foxglove(watching.foxglove)
    if windowed:
        from ui.hosting.games import WindowGames, offer_of, play_in_window

        free = study_file is None and language is None and study.dialogue.language == STANDARD.dialogue.language
        languages = shipped_languages() if free else None
        offered = offer_of(setting, given=robots is not None, languages=languages, seat=own_seat)
        options = PlayOptions(
            pace,
            bag,
            others,
            study.participant.strategy if own_seat else "",
            limit,
            graph,
            watch=door,
            foxglove=watching.foxglove,
            mavlink=ports,
            keys=ring,
            ros2=graph2,
        )
        compile_ahead(whole_hunt=True, look=look.value)
        games = WindowGames(study, study_file, options, report_page is not False, callbacks, own_seat)
        play_in_window(games, offered, ("--look", look.value))
        return
    if who == PERSON:
        from ui.hosting.consent import ask_for_consent
        from ui.hosting.players import player_of_person, teammates_of

        START_BAR.close()  # The person types in the line that the bar occupies.
        text = None if legacy.TABUI in others else setting.consent
        agreed = None if text is None else ask_for_consent(setting.texts, text)
        player = player_of_person(setting.texts, agreed, own_seat)
        participants, typed = (player.tabui, *teammates_of(setting, own_seat)), player.typed
    else:
        with bad_input():
            participants, typed = build_participants(setting, participant), None
    path = bag or usual_bag(setting)
    make_ready(path, setting.study.recording.compression)

    def ready(where: ListeningAddress | CannotListen) -> None:
        if isinstance(where, CannotListen):
            if others:
                fail(BAD_INPUT, str(where))
            note(f"Other programs cannot join: {where}")
        elif not as_json:
            note(f"Other programs can join at {where.host}:{where.port}.")

    rooms = setting.map.room_names

    def follow(moment: TickRecord) -> None:
        tell("simulated seconds", int(moment.tick * TICK), 0)
        if not as_json and who != PERSON:
            print_story(moment, rooms)

    compile_ahead(whole_hunt=pace > 0.0)
    unfinished: HuntUnfinished | None = None
    try:
        options = PlayOptions(
            pace,
            path,
            others,
            who,
            limit,
            graph,
            watch=door,
            foxglove=watching.foxglove,
            mavlink=ports,
            keys=ring,
            run=new_token(),
            ros2=graph2,
        )
        program = hunt.play(setting, participants, options, ready, follow, callbacks)
        shown = nullcontext(untold) if who == PERSON else shown_progress(progress, "play", beside_text=not as_json)
        with shown as tell:
            outcome = run(program, typed)
    except ParticipantDeclined as declined:
        fail(DECLINED if declined.answered else FAILED, NOT_TAKING_PART)
    except HuntUnfinished as early:
        outcome, unfinished = early.outcome, early
    if as_json:
        print_json(dataclasses.asdict(outcome) | {"bag": str(outcome.bag)})
    else:
        show_outcome(outcome)
    stopped = unfinished is not None and unfinished.stopped
    if not stopped and (report_page or (report_page is None and not as_json)):
        with bad_input():
            write_report(path, path.with_suffix(".html"))
    if stopped:
        fail(FAILED, "The hunt was stopped. The recording is complete up to this point.")
    if unfinished is not None:
        fail(FAILED, f"The game did not end within {limit:g} simulated seconds. Allow more time with --max-seconds.")


def _roles(names: str, study: "Study") -> frozenset[str]:
    from thbridge.roles.shared.seat_programs import programs_of
    from thbridge.text_protocol.wire import legacy

    chosen = frozenset(name.strip() for name in names.split(",") if name.strip())
    known = [*programs_of(each.name for each in study.seats), legacy.HIDER]
    wrong = sorted(chosen.difference(known))
    if wrong:
        remedy = f"Use {', '.join(known[:-1])} or {known[-1]}"
        fail(BAD_INPUT, f"--outside: {wrong[0]} is not a role that other programs can play. {remedy}.")
    return chosen
