"""`thbridge serve`: games and studies in browsers, for many people at once."""

import os
import secrets
import socket
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ui.command_line.options import ColourScheme, LookOption, OpenTo, Scheduler, SeatName
from ui.command_line.signals import INTERRUPTED
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, note

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractAsyncContextManager

    from thbridge.sockets.addresses import Address
    from thbridge.sockets.reconnecting import ConnectionLost
    from thbridge.study.study_file import Study
    from ui.hosting.window_process import WindowProcess
    from ui.model.kiosk import FromKiosk, ToKiosk
    from ui.web.gateway.serving import ServerOptions
    from ui.web.pool.joined_game import JoinedGame
    from ui.web.pool.pool import RemoteHosts

GAMES_PER_CORE = 6
"""Games of three robots with which 95 % of all acts have their effect on the page within 0.1 s; see
`scripts/measure_browser_games.py`."""

Served = Annotated[
    Path | None, typer.Argument(help="Study file, or folder of a study with people.", metavar="STUDY|FOLDER")
]


def serve(
    served: Served = None,
    host: Annotated[
        str, typer.Option(help="Address to listen on; 0.0.0.0 also accepts the other machines of --open-to.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="TCP port; 0 is any free port.", min=0, max=65535)] = 8080,
    open_to: OpenTo = None,
    keys: Annotated[
        Path | None,
        typer.Option(
            help="Folder of keys (see `thbridge keys new`) for the researcher's page of a study with people. Without "
            "it, the command prints a link with a random key."
        ),
    ] = None,
    games: Annotated[
        int | None,
        typer.Option(
            help="Greatest number of games at the same time on this machine; default: 6 per core. 0 is possible only "
            "with --scheduler.",
            min=0,
        ),
    ] = None,
    scheduler: Scheduler = None,
    server: Annotated[
        str | None,
        typer.Option(
            help="Let one visitor after another join a game whose text server runs elsewhere, instead of starting "
            "games; see `thbridge tabui`. The session of the game writes the recording.",
            metavar="HOST:PORT",
        ),
    ] = None,
    key: Annotated[
        Path | None,
        typer.Option(help="With --server: file with the key that the server requires.", metavar="FILE"),
    ] = None,
    seat: SeatName = None,
    bags: Annotated[Path, typer.Option(help="Folder for recordings of games without a study folder.")] = Path("served"),
    tls_cert: Annotated[Path | None, typer.Option(help="Certificate of the server, a PEM file, for HTTPS.")] = None,
    tls_key: Annotated[Path | None, typer.Option(help="Private key of the certificate, a PEM file.")] = None,
    proxy: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NETWORK",
            help="Address or network of a proxy in front of this server, whose headers X-Forwarded-For and "
            "X-Forwarded-Proto are used. Can be repeated.",
        ),
    ] = None,
    kiosk: Annotated[
        bool,
        typer.Option(
            "--kiosk",
            help="Also open the window of `thbridge study run` on this machine, where one person after another takes "
            "part in the same study.",
        ),
    ] = False,
    windowed: Annotated[
        bool, typer.Option("--windowed", help="With --kiosk: use a window instead of the full screen.")
    ] = False,
    look: LookOption = ColourScheme.SYSTEM,
    drain: Annotated[
        bool,
        typer.Option("--drain", help="Ask the server of this folder to start no games, and to end after its games."),
    ] = False,
) -> None:
    """Serve games to browsers: a game of a study file for each visitor, or for several together, or a whole study."""
    try:
        from ui.web.gateway.serving import ServerOptions, serve_games
    except ModuleNotFoundError as missing:
        fail(BAD_INPUT, f"The package {missing.name} is not installed. Install it: pip install 'thbridge[web]'")
    from thbridge.files.disk.synced import make_folder
    from thbridge.roles.shared.seat_programs import program_of
    from thbridge.sockets.addresses import Address
    from thbridge.sockets.admission import Admission
    from thbridge.sockets.keys import SingleKey
    from thbridge.sockets.tls import browser_context
    from thbridge.study.study_file import Study
    from ui.command_line.event_loop import run
    from ui.command_line.kept_running import keep_running
    from ui.command_line.keys import keys_of
    from ui.command_line.networks import check_browsers, check_networks
    from ui.command_line.schedulers import warn_if_open
    from ui.command_line.settings import check_simulated, note_doubts, setting_of, study_of
    from ui.first_start.compiling import compile_ahead, usable_cores
    from ui.web.gateway.draining import drain as drain_server
    from ui.web.pool.running_games import RunningGames
    from ui.web.pool.worker import GATEWAY_TIMEOUT
    from ui.windows.display import why_no_window

    is_study = served is not None and served.is_dir()
    recorded = bags if served is None or not is_study else served
    if server is not None:
        recorded = bags / f"{program_of(seat or '')} at {server}"  # No folder: it names the visitors of this server.
    with bad_input():
        running = RunningGames.of(recorded)
    if drain:
        if not drain_server(running, note):
            fail(
                BAD_INPUT,
                f"No server serves {recorded}. Name its study folder, or its folder of recordings with --bags. If the "
                f"server has another temporary folder than {running.folder.parent.parent}, as services with PrivateTmp "
                "have, run both commands with the same TMPDIR.",
            )
        return
    if server is None and (key is not None or seat is not None):
        fail(BAD_INPUT, "--key and --seat belong to --server, the address of a game elsewhere. Add it, or omit them.")
    if server is not None and is_study:
        fail(BAD_INPUT, "--server: games of a study with people run on this server. Name the study file of the game.")
    if server is not None and (games is not None or scheduler is not None):
        fail(BAD_INPUT, "--server: one person at a time joins the game. Omit --games and --scheduler.")
    if games is None:
        games = GAMES_PER_CORE * usable_cores() if server is None else 1
    if games == 0 and scheduler is None:
        fail(BAD_INPUT, "--games 0: games need a machine. Write at least 1, or add --scheduler.")
    if scheduler is not None:
        if find_spec("distributed") is None:
            fail(BAD_INPUT, "--scheduler: distributed is not installed. Run: pip install 'thbridge[cluster]'")
        warn_if_open(scheduler)
        # Other machines have another working folder.
        served, recorded = None if served is None else served.absolute(), recorded.absolute()
        bags = bags.absolute()
    check_networks("--open-to", open_to or ())
    check_networks("--proxy", proxy or ())
    if kiosk and not is_study:
        fail(BAD_INPUT, "--kiosk needs a study with people. Name its folder, or use `thbridge play` for a study file.")
    if kiosk and games == 0:
        fail(BAD_INPUT, "--games 0: games of the person at the kiosk need this machine. Write at least 1.")
    if windowed and not kiosk:
        fail(BAD_INPUT, "--windowed belongs to --kiosk. Give both, or neither.")
    if kiosk and (why := why_no_window()) is not None:
        fail(BAD_INPUT, why)
    if (tls_cert is None) != (tls_key is None):
        fail(BAD_INPUT, "--tls-cert and --tls-key belong together. Give both, or neither.")
    with bad_input():
        tls = None if tls_cert is None or tls_key is None else browser_context(tls_cert, tls_key)

    def options(study: Study, file: Path | None) -> ServerOptions:
        """Return the options of the gateway; its port is taken from now on."""
        ring, secret = keys_of(study, file, keys), secrets.token_urlsafe(24)
        networks = tuple(open_to or study.open_to)
        check_browsers(host, networks, encrypted=tls is not None)
        listening = _listen(host, port)
        shown = f"http{'' if tls is None else 's'}://{Address(host, listening.getsockname()[1])}/"
        addresses = f"Open {shown} in a browser."
        if is_study:
            how = f"#{secret}" if ring is None else " (with a key that may watch)"
            addresses += f"\nThe researcher's page: {shown}desk{how}"
        ready, admission = partial(note, addresses), Admission.to(networks)
        desk_keys = SingleKey(secret) if ring is None else ring
        return ServerOptions(
            listening,
            games,
            tls,
            ready,
            admission,
            tuple(proxy or ()),
            running=running,
            stopping=report_running,
            remote=None if scheduler is None else _remote_hosts(scheduler, recorded),
            keys=desk_keys,
        )

    def report_running() -> None:
        """Report the games that outlive the server."""
        if count := len([*running]):
            games_go_on = "1 game goes" if count == 1 else f"{count} games go"
            note(
                f"The server ends. {games_go_on} on for {GATEWAY_TIMEOUT:.0f} s: start the same command again within "
                "this time, and people are back where they were. Otherwise the games end, with complete recordings. "
                "To end a server only after its games, use --drain."
            )

    def begin() -> None:
        """Continue in a process that is started again if it dies; end the first one if the cluster cannot be used."""
        if server is None:
            compile_ahead(whole_hunt=True)
        if keep_running() and scheduler is not None:
            _check_cluster(scheduler, recorded)

    with bad_input():
        lock = running.lock_server(recorded)
    with lock:
        if served is not None and is_study:
            window = None
            if kiosk:
                from ui.commands.study.run import kiosk_process

                window = kiosk_process(served, look.value, windowed=windowed)
            _serve_folder(served, options, begin, window)
            return
        study = study_of(served, {})
        check_simulated(study, "serve")
        note_doubts(setting_of(study, served))
        joined = None if server is None else _joined(study, served, server, key, seat)
        chosen = options(study, served)
        if scheduler is not None:
            with bad_input():
                make_folder(bags)
        begin()

        def new_bag() -> Path:
            make_folder(bags)
            return bags / f"{secrets.token_hex(6)}{study.recording.ending}"

        run(serve_games(study, served, new_bag, note, chosen, joined), handles_signals=True)


def _serve_folder(
    folder: Path,
    options: "Callable[[Study, Path | None], ServerOptions]",
    begin: "Callable[[], None]",
    window: "WindowProcess[ToKiosk, FromKiosk] | None",
) -> None:
    from thbridge.experiment.check import read_for_people
    from thbridge.experiment.conductor import Conductor
    from thbridge.experiment.design.recruiting import link_codes
    from thbridge.experiment.folder import ExperimentFolder
    from thbridge.experiment.sockets.markers import MarkerStream
    from thbridge.experiment.store.event_log import ExperimentLog
    from thbridge.files.disk.synced import make_folder
    from ui.command_line.event_loop import run
    from ui.commands.study.run import STAYS_OPEN
    from ui.commands.study.unfinished import finish_begun_withdrawals
    from ui.web.gateway.serving import serve_study
    from ui.web.gateway.study_visits import VisitClock

    finish_begun_withdrawals(folder)
    with bad_input():
        place, clock = ExperimentFolder(folder), VisitClock()
        design = read_for_people(place)
        codes = link_codes(design.file.recruiting, place.root)
    chosen = options(design.study, design.path)
    begin()
    with bad_input():
        make_folder(place.log.parent)
        log = ExperimentLog(place.log)
    with log, MarkerStream(design.file.title, wanted=design.file.markers) as markers, bad_input(FAILED):
        conductor = Conductor(design, log, markers.stamping(clock), secrets.randbelow)
        conductor.listeners.append(markers.push)
        for trouble in markers.troubles:
            note(trouble)
        code = 0
        try:
            run(serve_study(place, design, conductor, clock, note, chosen, codes, window), handles_signals=True)
        except (KeyboardInterrupt, typer.Exit) as ended:
            if window is None or not window.left_open:
                raise
            code = ended.exit_code if isinstance(ended, typer.Exit) else INTERRUPTED
        if window is not None and window.left_open:
            note(STAYS_OPEN)
            os._exit(code)  # The usual end of the interpreter would also end the window.


def _joined(study: "Study", file: Path | None, server: str, key: Path | None, seat: str | None) -> "JoinedGame":
    """Return the game of a text server; end the program if the server cannot be reached, or refuses the key."""
    import asyncio

    from thbridge.sockets.addresses import Address, ListeningAddress
    from ui.command_line.keys import key_of
    from ui.command_line.seats import client_seat
    from ui.commands.programs.client import address_of
    from ui.web.pool.joined_game import JoinedGame

    host, port = address_of(server, study.server)
    own_seat = client_seat(study, file, seat)
    shown = None if key is None else key_of(key)
    game = JoinedGame.at(study, file, ListeningAddress(host, port), shown, own_seat)
    if (lost := asyncio.run(game.why_refused())) is not None:
        fail(BAD_INPUT, _why_not_joined(lost, Address(host, port), key))
    return game


def _why_not_joined(lost: "ConnectionLost", server: "Address", key: Path | None) -> str:
    """Return the reason why a game elsewhere cannot be joined, with a remedy."""
    from thbridge.sockets.reconnecting import LossReason

    option = "--server" if key is None else f"--key {key}"
    match lost.reason:
        case LossReason.UNREACHABLE:
            remedy = "Start `thbridge server` or `thbridge play --outside TabUI` there first, or correct the address"
            return f"--server: no game at {lost.detail}. {remedy}."
        case LossReason.UNTRUSTED:
            remedy = "Give the key of this server. If the server accepts no keys, omit --key"
            return f"{option}: {lost.detail}. {remedy}."
        case _ if key is None:
            remedy = "Add its key with --key FILE, or give the study file of the game"
            return f"{option}: the game at {server} refuses this program: {lost.detail}. {remedy}."
        case _:
            remedy = "Ask the admin of the server for another key (`thbridge keys new NAME`)"
            return f"{option}: the game at {server} refuses this key: {lost.detail}. {remedy}."


def _remote_hosts(
    scheduler: str, recorded: Path
) -> "Callable[[Callable[[str], None]], AbstractAsyncContextManager[RemoteHosts]]":
    from ui.web.pool.cluster import ClusterHosts

    return lambda report: ClusterHosts(scheduler, recorded, report).watched()


def _check_cluster(scheduler: str, recorded: Path) -> None:
    import asyncio

    from ui.web.pool.cluster import ClusterUnfit, check_cluster

    try:
        asyncio.run(check_cluster(scheduler, recorded))
    except ClusterUnfit as reason:
        fail(BAD_INPUT, str(reason))


def _listen(host: str, port: int) -> socket.socket:
    """Return a bound socket; end the program if the port is taken."""
    listening = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
    except OSError as error:
        fail(BAD_INPUT, f"Cannot listen on {host}:{port}: {error.strerror}. Choose another port with --port.")
    return listening
