"""`thbridge keys`: keys with rights, for programs and windows on other machines."""

from pathlib import Path
from typing import Annotated

import typer

from thbridge.credentials import Right
from thbridge.hunt.seats import SEAT_NAME
from ui.command_line.terminal import BAD_INPUT, bad_input, command, fail, note, out, say

KeyFolder = Annotated[
    Path, typer.Option("--keys", help="Folder of the keys; give it to other commands with --keys or --watch-key.")
]
KeyName = Annotated[str, typer.Argument(help="Name of the key's owner; it is recorded with the owner's actions.")]
FOLDER = Path("keys")


def keys_new(
    name: KeyName,
    folder: KeyFolder = FOLDER,
    rights: Annotated[
        list[Right] | None,
        typer.Option("--right", help="Access right that the key grants; default: `watch`. Can be repeated."),
    ] = None,
    seats: Annotated[
        list[str] | None,
        typer.Option("--seat", help="Seat that a participant's program may take; default: all. Can be repeated."),
    ] = None,
    days: Annotated[
        int | None, typer.Option(help="Number of days after which the key expires; default: never.", min=1, max=3650)
    ] = None,
) -> None:
    """Create a key and write it to a file, for the person who needs the key."""
    import secrets
    from datetime import UTC, datetime, timedelta

    from thbridge.files.keys.key_ring import KeyRing
    from thbridge.timing.wall_clock import utc_now

    for seat in seats or ():
        if SEAT_NAME.fullmatch(seat) is None:
            fail(BAD_INPUT, f"--seat: {seat!r} is no name of a seat. Write a name such as driver.")
    if seats and (Right.PARTICIPANT not in (rights or ()) or Right.ADMIN in (rights or ())):
        fail(BAD_INPUT, "--seat: only a key of a participant has seats. Add `--right participant`.")
    expires = None if days is None else f"{datetime.now(UTC) + timedelta(days=days):%Y-%m-%dT%H:%M:%SZ}"
    with bad_input():
        path = KeyRing(folder, utc_now).add(
            name, rights or [Right.WATCH], secrets.token_urlsafe(32), expires, seats or ()
        )
    say(str(path))
    watches = Right.WATCH in (rights or [Right.WATCH]) or Right.INTERVENE in (rights or ())
    uses = command("watch", "HOST:PORT", "--key", path) if watches else f"--key {path}"
    note(f"Give this file to the owner of the key, then delete the file here. The owner uses it with `{uses}`.")


def keys_list(folder: KeyFolder = FOLDER) -> None:
    """List all keys, including expired, revoked and used keys."""
    from rich.table import Table

    from thbridge.files.keys.certificate import certificate_of
    from thbridge.files.keys.key_ring import KeyRing
    from thbridge.timing.wall_clock import utc_now

    with bad_input():
        entries = KeyRing(folder, utc_now).entries
    has_seats = any(entry.seats for entry in entries)
    table = Table("name", "rights", *["seats"] * has_seats, "created", "expires", "state")
    for entry in entries:
        state = "revoked" if entry.revoked else "expired" if entry.why_not(utc_now()) else "valid"
        if state == "valid" and entry.game is not None:
            state = "used for a game"
        seats = [", ".join(entry.seats)] * has_seats
        table.add_row(entry.name, ", ".join(entry.rights), *seats, entry.created, entry.expires or "never", state)
    out.print(table)
    if entries:
        with bad_input():
            say(f"sha256:{certificate_of(folder, utc_now()).fingerprint}")


def keys_revoke(name: KeyName, folder: KeyFolder = FOLDER) -> None:
    """Revoke a key. Clients that use this key are disconnected within a second."""
    from thbridge.files.keys.key_ring import KeyRing
    from thbridge.timing.wall_clock import utc_now

    if not folder.is_dir():
        fail(BAD_INPUT, f"--keys: there is no folder {folder}. Name the folder in which the key was created.")
    with bad_input():
        KeyRing(folder, utc_now).revoke(name)
    note(f"The key of {name} is revoked.")
