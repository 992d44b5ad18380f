"""Shared parts of the commands that run one program each."""

import secrets
from pathlib import Path

from thbridge.app import programs
from thbridge.files.language_texts import shipped_texts
from thbridge.files.resources import shipped
from thbridge.files.template_files import TemplateSet, read_template_set
from thbridge.roles.shared.view import View
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.study.robots_from import RobotsFrom
from thbridge.study.study_file import ServerSection, Study
from ui.command_line.options import ADDRESS, PERSON
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note
from ui.hosting.lobby import WILDCARD_ADDRESSES
from ui.hosting.players import LocalPlayer, player_of_bot, player_of_person

ANOTHER_GAME = (
    "To play another game, press Play again in the window of `thbridge tabui`, "
    "or stop and restart `thbridge server` (or `thbridge play`)."
)
"""Sentence on the terminal at the end of a game."""


def player_of(
    who: str, study: Study, study_file: Path | None, templates: str | None, seed: int | None, seat: str = ""
) -> LocalPlayer:
    """Return the player. The study already includes `templates` and `seed`, which have no effect for a person."""
    if who == PERSON:
        for option, value in (("--templates", templates), ("--seed", seed)):
            if value is not None:
                note(f"{option} has no effect here: it applies only to simulated participants.")
        return player_of_person(shipped_texts(), seat=seat)
    beside = Path() if study_file is None or templates is not None else study_file.parent
    templates_read = read_templates(study.templates, beside)
    with bad_input():
        return player_of_bot(who, templates_read, study, seat)


def read_templates(wanted: str, beside: Path) -> TemplateSet:
    """Return a template set, given its name or folder; a relative path starts at `beside`."""
    with bad_input():
        return read_template_set(shipped().find("templates", wanted, beside))


def address_of(server: str | None, study: ServerSection) -> tuple[str, int]:
    """Return the host and port of the text server, from the option `--server` or else from the study."""
    if server is None:
        if study.port == 0:
            fail(
                BAD_INPUT, "server: port: 0 in the study means any free port. Add the actual port: --server HOST:PORT."
            )
        return WILDCARD_ADDRESSES.get(study.host, study.host), study.port
    host, colon, port = server.rpartition(":")
    if not colon or not host or not port.isdecimal() or not 0 < int(port) < 65536:
        fail(BAD_INPUT, f"--server: {server!r} is not an address. Write HOST:PORT, such as {ADDRESS}.")
    return host, int(port)


def new_token() -> str:
    """Return an id of this run, by which the server recognizes a client that reconnects after a network fault."""
    return secrets.token_hex(8)


def tell_lost(lost: ConnectionLost) -> None:
    """Print why the connection was lost."""
    note(programs.reason_of(lost))


def note_settings_without_effect(study: Study) -> None:
    """Print the keys of a study that have no effect on its real robots."""
    standard = Study()
    for key in ("rate", "watch", "robot", "each", "things", "mishaps"):
        if getattr(study, key) != getattr(standard, key):
            note(f"{key} has no effect here: it applies only to simulated robots.")
    if study.robots_from is RobotsFrom.ROS2:
        for key, other in study.fleet.replaced():
            note(f"{key} has no effect here: Nav2 robots have {other} instead.")


def show_nothing(view: View) -> None:
    """Ignore a view until the game is over."""
