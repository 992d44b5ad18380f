"""`thbridge argue`: arguments that can be accepted together, and the reasons."""

from enum import StrEnum
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from thbridge.dialogue.argumentation.semantics import Semantics
from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, print_json, say


class ArgumentationEngine(StrEnum):
    """Program that computes extensions."""

    PYTHON = "python"
    CLINGO = "clingo"


def argue(
    file: Annotated[Path, typer.Argument(help="Argumentation framework: a .apx, .tgf or .af file.")],
    semantics: Annotated[
        Semantics,
        typer.Option(
            help="Kind of extensions. GR: grounded, CO: complete, PR: preferred, ST: stable.", case_sensitive=False
        ),
    ] = Semantics.GROUNDED,
    engine: Annotated[
        ArgumentationEngine,
        typer.Option(help="Program that computes extensions. clingo, an extra package, is faster on large frameworks."),
    ] = ArgumentationEngine.PYTHON,
    query: Annotated[
        str | None, typer.Option(help="Argument to look up: print whether it is in every, some or no extension.")
    ] = None,
    explain: Annotated[
        bool,
        typer.Option(
            "--explain", help="Also print a discussion that explains why the argument of --query is accepted or not."
        ),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Compute the extensions of an argumentation framework: sets of arguments that can be accepted together."""
    from thbridge.dialogue.argumentation.discussion import discuss, is_won
    from thbridge.files.argument_files import read_framework
    from ui.commands.argue.words import discussion_in_words, grounded_label, membership_in_words, name_order

    if explain and query is None:
        fail(BAD_INPUT, "--explain requires an argument to explain. Add --query ARGUMENT.")
    if engine is ArgumentationEngine.CLINGO:
        if find_spec("clingo") is None:
            remedy = "Run: pip install 'thbridge[argumentation]', or omit --engine"
            fail(BAD_INPUT, f"--engine: the package clingo is not installed. {remedy}.")
        from thbridge.dialogue.argumentation.clingo_engine import extensions_by_clingo as extensions
    else:
        from thbridge.dialogue.argumentation.semantics import extensions
    with bad_input():
        framework = read_framework(file)
    if query is not None and query not in framework.index:
        near = [name for name in framework.arguments if name.lower() == query.lower()]
        of = ", ".join(near or framework.arguments[:12]) or "none"
        fail(BAD_INPUT, f"--query: there is no argument {query} in {file}. Its arguments are, for example: {of}.")
    found = extensions(framework, semantics)
    names = sorted((sorted(each, key=name_order) for each in found), key=lambda each: [*map(name_order, each)])
    result: dict[str, object] = {"semantics": semantics.value, "extensions": names}
    lines = [f"{{{', '.join(each)}}}" for each in names] or ["No extension exists."]
    if query is not None:
        credulous, sceptical = any(query in each for each in found), all(query in each for each in found)
        result |= {"query": query, "credulous": credulous, "sceptical": sceptical}
        how = "every" if sceptical and found else "some" if credulous else "no"
        lines.append(f"{query} is in {how} extension.")
    if explain and query is not None:
        discussion = discuss(framework, query)
        result["discussion"] = [{"locution": move.locution.value, "argument": move.argument} for move in discussion]
        result["grounded"] = is_won(discussion)
        result["label"] = grounded_label(framework, query)
        lines += membership_in_words(framework, semantics, found, query)
        lines += ["", f"Discussion of the question: is {query} in the grounded extension?"]
        lines += discussion_in_words(framework, discussion)
    if as_json:
        print_json(result)
    else:
        for line in lines:
            say(line)
