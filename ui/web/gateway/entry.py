"""Entry into a study: people with a code or with the parameters of a recruiting service in their link may enter."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Protocol

from thbridge.experiment.conductor import Conductor
from thbridge.experiment.design.recruiting import CODE, LinkCodes, RecruitingSection, digest_of_code, is_value
from thbridge.experiment.store.browser_tickets import BrowserTickets


class LinkFault(StrEnum):
    """Reason why a link admits no one; the values are names of texts."""

    NONE = "no_link"
    """The study needs a code, and the address has none."""
    UNKNOWN = "unknown_link"
    """The code is not one of this study, or a parameter has characters that no service sends."""
    USED = "used_link"
    """The person with this link has already finished the study, or has withdrawn."""


class EntryRefused(Exception):  # noqa: N818 - nothing went wrong with the program
    """A link admits no one."""

    def __init__(self, fault: LinkFault) -> None:
        super().__init__(fault)
        self.fault = fault


@dataclass(frozen=True, slots=True)
class LinkEntry:
    """Contents of a link.

    Attributes:
        external_id: code of the person, or their id at a recruiting service; empty if the link has neither.
        parameters: parameters of the recruiting service.
    """

    external_id: str = ""
    parameters: Mapping[str, str] = field(default_factory=dict)


class EntryRule(Protocol):
    """Rule of who may enter."""

    def __call__(self, query: Mapping[str, str], secret: str, /) -> LinkEntry:
        """Return the contents of a link.

        Args:
            query: parameters in the address.
            secret: secret in the browser's cookie; empty if there is none.

        Raises:
            EntryRefused: the link admits no one.
        """


def open_to_all(_query: Mapping[str, str], _secret: str) -> LinkEntry:
    """Admit everyone; see `EntryRule`."""
    return LinkEntry()


class StudyEntry:
    """Rule of a study with people; see `EntryRule`.

    Args:
        recruiting: section of the study's file.
        codes: codes that admit people; if None, no code is needed.
        conductor: conductor of the study.
        tickets: record of browsers and their participants.
        withdrawn: digests of the codes of people who withdrew; their codes admit no one.
    """

    def __init__(
        self,
        recruiting: RecruitingSection,
        codes: LinkCodes | None,
        conductor: Conductor,
        tickets: BrowserTickets,
        withdrawn: frozenset[bytes] = frozenset(),
    ) -> None:
        self._withdrawn = withdrawn
        self._recruiting = recruiting
        self._codes = codes
        self._conductor = conductor
        self._tickets = tickets

    def __call__(self, query: Mapping[str, str], secret: str, /) -> LinkEntry:
        """See `EntryRule`."""
        names = self._recruiting.parameters
        parameters = {name: query[name] for name in names if query.get(name)}
        if not all(map(is_value, parameters.values())):
            raise EntryRefused(LinkFault.UNKNOWN)
        known = self._tickets.participant(secret)
        runs = self._conductor.progress.runs
        if self._codes is None:
            external_id = parameters.get(names[0], "") if names else ""
        elif code := query.get(CODE, ""):
            if code not in self._codes:
                raise EntryRefused(LinkFault.UNKNOWN)
            if digest_of_code(code) in self._withdrawn:
                raise EntryRefused(LinkFault.USED)
            external_id = code
        elif known in runs:
            # The page removes the code from its address, so a page that is loaded again comes without it.
            external_id = runs[known].external_id
        else:
            raise EntryRefused(LinkFault.NONE)
        run = self._conductor.progress.run_of(external_id)
        if run is not None and run.farewell_read and run.participant != known:
            raise EntryRefused(LinkFault.USED)
        return LinkEntry(external_id, parameters)
