"""Forms of a study at the kiosk, filled in page by page."""

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.design.plan import PlannedStep
from thbridge.experiment.progress import options_shown
from thbridge.experiment.questionnaires.form import Form, Item
from thbridge.experiment.store.events import EventKind, JsonValue
from ui.hosting.kiosk.answer_conversion import form_item, is_answer, to_answer, to_json
from ui.hosting.kiosk.pages import KioskPages
from ui.model.kiosk import (
    FormToFill,
    ItemNews,
    WentBack,
    WentOn,
)


class FormSteps:
    """Steps in which the person at the kiosk fills in forms.

    Args:
        design: design of the study.
        pages: pages of the kiosk.
    """

    def __init__(self, design: ExperimentDesign, pages: KioskPages) -> None:
        self._design = design
        self._pages = pages

    async def fill_in(self, step: PlannedStep) -> None:
        """Show a form, from its first incomplete page on, until it is filled in. The person may also go back.

        A person cannot return to a page with a time limit.
        """
        form = self._design.forms[step.index]
        pages = list(form.pages(self._design.file.seed, self._pages.person))
        part = next((part for part, items in enumerate(pages, start=1) if self._is_open(items)), len(pages) + 1)
        while part <= len(pages):
            items = pages[part - 1]
            before = next((page for page in range(part - 1, 0, -1) if not _is_limited(pages[page - 1])), 0)
            is_closed = _is_limited(items) and not self._is_open(items)
            if is_closed or await self._fill_in_page(form, items, part, len(pages), back=before > 0):
                part += 1
            else:
                part = before
                self._pages.tell(EventKind.WENT_BACK, {"page": part})

    def _is_open(self, items: tuple[Item, ...]) -> bool:
        """Return True if a page has an item without an answer, or with a changed answer that was not submitted."""
        given, drafts = self._pages.run.given, self._pages.run.drafts
        return any(item.id not in given or item.id in drafts or self._is_missing(item) for item in items)

    def _is_missing(self, item: Item) -> bool:
        """Return True if a required item has no answer and its time is not over."""
        run = self._pages.run
        return item.required and run.given.get(item.id) is None and item.id not in run.timed_out

    async def _fill_in_page(self, form: Form, items: tuple[Item, ...], part: int, parts: int, *, back: bool) -> bool:
        """Show a page of a form until it is filled in. Return False if the person goes back to the previous page.

        An optional item without an answer is recorded with an empty answer.
        """
        shown, missing = tuple(map(form_item, items)), tuple[str, ...]()
        leaves = (WentOn, WentBack) if back else (WentOn,)
        while True:
            kept = {**self._pages.run.given, **self._pages.run.drafts}
            answers = {item.id: to_answer(kept[item.id]) for item in items if item.id in kept}
            closed = tuple(item.id for item in items if item.id in self._pages.run.timed_out)
            page = FormToFill(0, form.title, form.instructions, shown, answers, closed, missing, part, parts, back=back)
            await self._pages.show(page)
            while not isinstance(message := await self._pages.next_of_run(), leaves):
                if isinstance(message, ItemNews):
                    await self._take(items, message)
            for item in items:
                if item.id in self._pages.run.drafts:
                    self._pages.tell(EventKind.ITEM_GIVEN, {"item": item.id, "answer": self._pages.run.drafts[item.id]})
            if isinstance(message, WentBack):
                return False
            missing = tuple(item.id for item in items if self._is_missing(item))
            if not missing:
                for item in items:
                    if item.id not in self._pages.run.given:
                        self._pages.tell(EventKind.ITEM_GIVEN, {"item": item.id, "answer": None})
                return True

    async def _take(self, items: tuple[Item, ...], news: ItemNews) -> None:
        """Record an event of an item."""
        item = next((item for item in items if item.id == news.item), None)
        if item is None or item.id in self._pages.run.timed_out:
            return
        if news.what in {"changed", "given", "timed out"} and not is_answer(item, news.answer):
            return
        data: dict[str, JsonValue] = {"item": item.id, "window_ns": news.window_ns}
        run, answer = self._pages.run, to_json(news.answer)
        match news.what:
            case "shown":
                self._pages.tell(EventKind.ITEM_SHOWN, {**data, **options_shown(item)})
            case "touched":
                self._pages.tell(EventKind.ITEM_TOUCHED, data)
            case "pasted":
                self._pages.tell(EventKind.TEXT_PASTED, {**data, "characters": news.characters})
            case "changed":
                if answer != {**run.given, **run.drafts}.get(item.id):
                    self._pages.tell(EventKind.ITEM_CHANGED, {**data, "answer": answer})
                await self._pages.kept(item.id, news.answer)
            case "given":
                if item.id in run.drafts or answer != run.given.get(item.id):
                    self._pages.tell(EventKind.ITEM_GIVEN, {**data, "answer": answer})
                await self._pages.kept(item.id, news.answer)
            case "timed out" if item.seconds > 0.0:
                self._pages.tell(EventKind.ITEM_TIMED_OUT, {**data, "answer": answer})
                await self._pages.kept(item.id, news.answer, timed_out=True)


def _is_limited(items: tuple[Item, ...]) -> bool:
    """Return True if a page has an item with a time limit."""
    return any(item.seconds > 0.0 for item in items)
