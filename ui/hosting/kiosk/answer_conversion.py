"""Conversion of items and answers between a form and its window."""

from thbridge.experiment.questionnaires.form import Item, Scale
from thbridge.experiment.questionnaires.scoring import NOT_APPLICABLE
from thbridge.experiment.store.events import JsonValue
from ui.model.kiosk import Answer, FormItem

LONGEST = 20_000
"""Maximum number of characters of a text answer."""


def form_item(item: Item) -> FormItem:
    """Return the parts of an item that participants see, without its scoring and its right answer."""
    return FormItem(
        id=item.id,
        text=item.text,
        scale=item.scale.value,
        words=item.words,
        low=item.low,
        high=item.high,
        minimum=item.minimum,
        maximum=item.maximum,
        step=item.step,
        unit=item.unit,
        options=item.options,
        labels=item.labels if item.scale is Scale.CHOICE else (),
        several=item.several,
        required=item.required,
        not_applicable=item.not_applicable,
        seconds=item.seconds,
    )


def is_answer(item: Item, answer: Answer) -> bool:
    """Return True for a valid answer to an item. None is valid, and removes an earlier answer."""
    if answer is None:
        return True
    if answer == NOT_APPLICABLE and item.not_applicable:
        return True
    match item.scale:
        case Scale.TEXT:
            return isinstance(answer, str) and len(answer) <= LONGEST
        case Scale.CHOICE if item.several:
            return isinstance(answer, tuple) and set(answer) <= set(item.options)
        case Scale.CHOICE:
            return answer in item.options
        case Scale.NUMBER:
            return isinstance(answer, float) and item.minimum <= answer <= item.maximum
    is_whole = item.scale is Scale.ANALOGUE or (isinstance(answer, float) and answer.is_integer())
    return isinstance(answer, float) and is_whole and item.least <= answer <= item.greatest


def to_answer(given: JsonValue) -> Answer:
    """Convert an answer from the log's form to the window's form."""
    if isinstance(given, list):
        return tuple(map(str, given))
    if isinstance(given, bool | dict):
        return None
    return float(given) if isinstance(given, int) else given


def to_json(answer: Answer) -> JsonValue:
    """Convert an answer from the window's form to the log's form."""
    return list(answer) if isinstance(answer, tuple) else answer
