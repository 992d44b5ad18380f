"""`thbridge bag`: look into recordings and mend them."""

from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.table import Table

from thbridge.adapters.bag_reader import info as bag_info
from thbridge.adapters.bag_repair import reindex as reindex_bag
from ui.options import AsJson
from ui.terminal import bad_input, out, print_json

bag_app = typer.Typer(help="Look into recordings and mend them.", no_args_is_help=True)


@bag_app.command("info")
def bag_info_command(bag: Annotated[Path, typer.Argument(help="A ROS 1 bag.")], as_json: AsJson = False) -> None:
    """Say what is in a bag."""
    with bad_input():
        found = bag_info(bag)
    if as_json:
        print_json(msgspec.to_builtins(found, enc_hook=str))
        return
    table = Table("topic", "type", "messages", title=f"{bag}: {found.duration:.1f} s, {found.messages} messages")
    for topic in found.topics:
        table.add_row(topic.name, topic.msgtype, str(topic.messages))
    out.print(table)


@bag_app.command("reindex")
def bag_reindex_command(
    bag: Annotated[Path, typer.Argument(help="A bag whose writer was killed.")], as_json: AsJson = False
) -> None:
    """Recover a bag that was cut off; the original is kept beside it."""
    with bad_input():
        done = reindex_bag(bag)
    if as_json:
        print_json(msgspec.to_builtins(done, enc_hook=str))
        return
    out.print(f"Recovered {done.messages} messages into {done.path}; the original is {done.backup}.", highlight=False)
    if done.lost_bytes:
        out.print(f"{done.lost_bytes} bytes at its end were half written and are lost.", highlight=False)
