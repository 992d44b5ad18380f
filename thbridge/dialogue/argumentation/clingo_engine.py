"""Extensions by clingo, a solver of logic programs: a definition is a program, and each answer is an extension.

Arguments are passed as numbers, their indices in the framework, so that any text can be a name.
"""

from collections.abc import Mapping, Sequence

import clingo

from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import Extension, Semantics, extensions, in_order

_COMMON = """
#show in/1.
#defined arg/1.
#defined att/2.
out(X) :- in(Y), att(Y,X).
"""

_COMPLETE = """
% Any arguments may be in that are in no conflict, defend themselves and leave out nothing that they defend.
{in(X)} :- arg(X).
undefended(X) :- att(Y,X), not out(Y).
:- in(X), out(X).
:- in(X), undefended(X).
:- arg(X), not in(X), not undefended(X).
"""

_STABLE = """
% Each argument is in, or something that is in attacks it.
in(X) :- arg(X), not out(X).
"""

_LARGEST = """
% As many are in as may be: with the options below, no answer is part of another one.
#heuristic in(X) : arg(X). [1,true]
"""

_PROGRAMS: Mapping[Semantics, tuple[str, Sequence[str]]] = {
    Semantics.COMPLETE: (_COMPLETE, ()),
    Semantics.PREFERRED: (_COMPLETE + _LARGEST, ("--heuristic=Domain", "--enum-mode=domRec")),
    Semantics.STABLE: (_STABLE, ()),
}

_LOOK_UP = 0.1
"""Seconds between checks for an interrupt by the user."""


def extensions_by_clingo(framework: ArgumentationFramework, semantics: Semantics) -> tuple[Extension, ...]:
    """Return all extensions in the order of `extensions`; the grounded extension needs neither a search nor clingo."""
    if semantics is Semantics.GROUNDED:
        return extensions(framework, semantics)
    program, options = _PROGRAMS[semantics]
    # Without this, clingo would print to standard error that there is nothing to decide. This is no fault.
    control = clingo.Control(["--models=0", *options], logger=lambda _code, _message: None)
    control.add(_COMMON + program + _facts(framework))
    control.ground()
    found: list[Extension] = []

    def keep(model: clingo.Model) -> None:
        places = (symbol.arguments[0].number for symbol in model.symbols(shown=True))
        found.append(frozenset(framework.arguments[place] for place in places))

    # clingo solves in a separate thread, so that this thread can be interrupted.
    with control.solve(on_model=keep, async_=True) as solving:
        while not solving.wait(_LOOK_UP):
            pass
        solving.get()
    return in_order(framework, found)


def _facts(framework: ArgumentationFramework) -> str:
    facts = [f"arg({place})." for place in range(len(framework.arguments))]
    facts += [f"att({place},{target})." for place, each in enumerate(framework.attacked) for target in each]
    return "\n".join(facts)
