"""Part of a game's page with the people of the game and their texts."""

from dataclasses import dataclass

from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.keys import PEOPLE, shown_key
from ui.model.playing.screen import Act, PeoplePanel, PersonRow, PersonText


@dataclass(frozen=True, slots=True)
class PageAddressee:
    """Possible addressee of the next text; `choose` chooses it."""

    name: str
    chosen: bool
    choose: Act


@dataclass(frozen=True, slots=True)
class PagePeople:
    """Panel of the people; `PeoplePanel` describes the fields that are not listed here.

    Attributes:
        key: key that moves the focus to the field.
        show: label of the button that leads to the panel on a narrow page.
        people: the participant and the teammates.
        messages: name of the list of texts, for screen readers.
        sending: words for texts on their way.
        new: words for texts that the participant has not seen.
        label: label in front of the addressees.
        addressees: possible addressees; empty if there is only one.
        send: sends the text that the browser adds to this act.
        can_send: True if the text in the field can be sent.
        hint: reason why it cannot be sent; empty if it can.
    """

    title: str
    key: str
    show: str
    people: tuple[PersonRow, ...]
    texts: tuple[PersonText, ...]
    messages: str
    sending: str
    new: str
    nothing: str
    unread: int
    news: str
    read: Act | None
    writes: bool
    closed: str
    label: str
    addressees: tuple[PageAddressee, ...]
    prompt: str
    draft: str
    restored: int
    send_label: str
    send: Act
    can_send: bool
    hint: str


def page_of_people(texts: Texts, panel: PeoplePanel | None) -> PagePeople | None:
    """Return the panel of the people for a page; None if there is none."""
    if panel is None:
        return None
    return PagePeople(
        title=panel.title,
        key=shown_key(texts, PEOPLE.keys[0]),
        show=texts.text("people.show"),
        people=(panel.own, *panel.others),
        texts=panel.texts,
        messages=texts.text("people.messages"),
        sending=texts.text("people.sending"),
        new=texts.text("people.new"),
        nothing=panel.nothing,
        unread=panel.unread,
        news=panel.news,
        read=panel.read,
        writes=panel.writes,
        closed=panel.closed,
        label=texts.text("people.to"),
        addressees=tuple(
            PageAddressee(each.label, each.act == panel.addressee_act, each.act) for each in panel.addressees
        ),
        prompt=panel.prompt,
        draft=panel.draft,
        restored=panel.restored,
        send_label=panel.send.label,
        send=panel.send.act,
        can_send=panel.send.enabled,
        hint=panel.send.hint,
    )
