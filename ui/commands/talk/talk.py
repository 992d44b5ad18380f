"""`thbridge talk`: play, check and explain dialogue games in the terminal."""

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.groups import CommandGroup, paths_of
from ui.command_line.options import AsJson, Seed
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note, print_json, say


class _TalkGroup(CommandGroup):
    """Commands of `talk`. `talk` can also run without a command."""

    paths = paths_of({"ui.commands.talk.talk:talk_": "check words"})


talk_app = typer.Typer(
    cls=_TalkGroup,
    add_completion=False,
    help="Dialogue games: the rules of conversations between a robot and a person. Play and check them.",
    no_args_is_help=True,
)


class TalkExample(StrEnum):
    """Example of a conversation."""

    JHRI2015 = "jhri2015"
    RULES = "rules"


class TalkPlayer(StrEnum):
    """Player of one side of a dialogue."""

    PROGRAM = "program"
    PERSON = "person"


@talk_app.callback(invoke_without_command=True)
def talk(
    context: typer.Context,
    example: Annotated[
        TalkExample | None,
        typer.Option(help="Example to play: `jhri2015`, the worked example of Sklar and Azhar (2015), or `rules`."),
    ] = None,
    exchange: Annotated[int | None, typer.Option(help="Play only this exchange of the example.", min=1)] = None,
    robot: Annotated[TalkPlayer, typer.Option(help="Let a program or a person play the robot.")] = TalkPlayer.PROGRAM,
    human: Annotated[TalkPlayer, typer.Option(help="Let a program or a person play the human.")] = TalkPlayer.PERSON,
    games: Annotated[
        Path | None, typer.Option(help="Folder of your own games, in addition to the built-in games.")
    ] = None,
    game: Annotated[
        str | None, typer.Option(help="Play this game about the example's topics, instead of the example's games.")
    ] = None,
    language: Annotated[str, typer.Option(help="Language: en, de, or a language in --words.")] = "en",
    words: Annotated[
        Path | None, typer.Option(help="Folder of your own wordings, in addition to the built-in wordings.")
    ] = None,
    seed: Seed = 0,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print one JSON object per move on standard output, and nothing else.")
    ] = False,
) -> None:
    """Play an example in the terminal. A person chooses among legal moves; a program follows the example."""
    if context.invoked_subcommand is not None:
        return
    if example is None:
        fail(BAD_INPUT, f"--example: the example is missing. Write --example {TalkExample.JHRI2015}, or see --help.")
    from thbridge.dialogue.argumentation.cases import Side
    from thbridge.dialogue.examples import jhri2015
    from thbridge.dialogue.rule_examples import rules_as_topics
    from thbridge.dialogue.wording.wording import Wording
    from thbridge.files.game_files import SHIPPED_GAMES, read_rulebook
    from thbridge.files.word_files import SHIPPED_LANGUAGES, read_language
    from ui.commands.talk.examples import Quit, TerminalTalk, print_utterance

    with bad_input():
        rulebook = read_rulebook((SHIPPED_GAMES,) if games is None else (SHIPPED_GAMES, games))
        spoken = (
            read_language(name=language)
            if words is None
            else read_language((SHIPPED_LANGUAGES, words), language, locutions=rulebook.locutions)
        )
    if game is not None and game not in rulebook.games:
        fail(BAD_INPUT, f"--game: there is no game {game}. Choose one of {', '.join(sorted(rulebook.games))}.")
    exchanges = (jhri2015 if example is TalkExample.JHRI2015 else rules_as_topics)(rulebook)
    if exchange is not None and exchange > len(exchanges):
        remedy = f"The example has exchanges 1 to {len(exchanges)}"
        fail(BAD_INPUT, f"--exchange: there is no exchange {exchange}. {remedy}.")
    show = note if as_json else say
    people = frozenset(
        side for side, player in ((Side.ROBOT, robot), (Side.HUMAN, human)) if player is TalkPlayer.PERSON
    )
    for number, each in enumerate(exchanges, start=1):
        if exchange in {None, number}:
            show(f"Exchange {number}. {each.title}")
            heard = partial(print_utterance, number) if as_json else lambda _said: None
            try:
                TerminalTalk(each, people, game, seed or 0, Wording(spoken, 0), show, heard).play()
            except Quit:
                return
            show("")


def talk_check(
    folders: Annotated[
        list[Path] | None,
        typer.Argument(help="Folders with your games or languages; default: the built-in games."),
    ] = None,
    strategy: Annotated[
        str | None,
        typer.Option(help="Name of the installed strategy to check, in these games and the built-in games."),
    ] = None,
    author: Annotated[
        str | None,
        typer.Option(help="Name of the installed author of wordings to check, with the robots' moves in these games."),
    ] = None,
    conversations: Annotated[
        int,
        typer.Option(
            help="Number of test conversations of each kind, for the strategy and the author.", min=1, max=1000
        ),
    ] = 2,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Check games, wordings, strategies and authors. Also print the moves and the ends of each game."""
    from ui.commands.talk.check import check_folder, rulebook_with, shipped_folder

    checked = [check_folder(folder) for folder in folders or ([] if strategy or author else [shipped_folder()])]
    ok = readable = not any(each.faults for each in checked)
    values: dict[str, object] = {"folders": [each.as_json() for each in checked]}
    lines = [line for each in checked for line in each.lines()]
    if strategy is not None and readable:
        from ui.commands.talk.trials import check_strategy

        with bad_input():
            tried = check_strategy(strategy, rulebook_with(folders or []), conversations, seed or 0)
        ok = tried.ok
        values["strategy"] = tried.as_json()
        lines += tried.lines()
    if author is not None and readable:
        from ui.commands.talk.trials import check_author

        languages = [language for each in checked for language in each.languages]
        with bad_input():
            worded = check_author(author, languages, rulebook_with(folders or []), conversations, seed or 0)
        ok &= worded.ok
        values["author"] = worded.as_json()
        lines += worded.lines()
    if as_json:
        print_json({"ok": ok, **values})
    else:
        for line in lines:
            say(line)
    if not ok:
        raise typer.Exit(BAD_INPUT)


def talk_words() -> None:
    """List the keywords of game files and wording files, with their meanings."""
    from ui.commands.talk.check import words

    for line in words():
        say(line)
