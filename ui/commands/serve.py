"""`thbridge serve`: games in browsers, for many people at once."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import StudyFile
from ui.command_line.terminal import BAD_INPUT, fail, note


def serve(
    study_file: StudyFile = None,
    host: Annotated[str, typer.Option(help="Address to listen on; 0.0.0.0 also accepts other machines.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="TCP port; 0 is any free port.", min=0, max=65535)] = 8080,
    games: Annotated[int, typer.Option(help="Greatest number of games at the same time.", min=1)] = 8,
    folder: Annotated[Path, typer.Option(help="Folder for the recordings.")] = Path("served"),
    tls_cert: Annotated[Path | None, typer.Option(help="Certificate of the server, a PEM file; for HTTPS.")] = None,
    tls_key: Annotated[Path | None, typer.Option(help="Private key of the certificate, a PEM file.")] = None,
) -> None:
    """Serve the game to browsers: each visitor of the page plays one game of the study, which is recorded."""
    import math
    import secrets
    import socket

    from thbridge.files.disk.synced import make_folder
    from ui.command_line.event_loop import run
    from ui.command_line.settings import note_doubts, setting_of, study_of
    from ui.first_start.compiling import compile_ahead

    try:
        from ui.web.gateway.serving import serve_games
    except ModuleNotFoundError as missing:
        fail(BAD_INPUT, f"The package {missing.name} is not installed. Install it: pip install 'thbridge[web]'")
    if (tls_cert is None) != (tls_key is None):
        fail(BAD_INPUT, "--tls-cert and --tls-key belong together. Give both, or neither.")
    study = study_of(study_file, {})
    note_doubts(setting_of(study, study_file))
    compile_ahead(whole_hunt=True)
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    listening = socket.socket(family, socket.SOCK_STREAM)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((host, port))
    except OSError as error:
        fail(BAD_INPUT, f"Cannot listen on {host}:{port}: {error.strerror}. Choose another port with --port.")
    shown = f"http{'' if tls_cert is None else 's'}://{host}:{listening.getsockname()[1]}/"

    def new_bag() -> Path:
        make_folder(folder)
        return folder / f"{secrets.token_hex(6)}.bag"

    run(
        serve_games(
            study,
            study_file,
            listening,
            new_bag,
            lambda: note(f"Open {shown} in a browser."),
            games=games,
            max_seconds=math.inf,
            tls=None if tls_cert is None or tls_key is None else (tls_cert, tls_key),
        )
    )
