"""Conclusions that follow from beliefs and rules, found by exhaustive search."""

from thbridge.dialogue.argumentation.propositions import Literal, Rule


def derives(support: frozenset[Literal | Rule], conclusion: Literal, granted: frozenset[Literal]) -> bool:
    """Return True if a conclusion follows; apply the rules until nothing new follows."""
    known = {each for each in support if isinstance(each, Literal)} | granted
    rules = [each for each in support if isinstance(each, Rule)]
    while True:
        new = {rule.conclusion for rule in rules if set(rule.premises) <= known} - known
        if not new:
            return conclusion in known
        known |= new
