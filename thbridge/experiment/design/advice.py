"""Advice on an experiment: valid choices that spoil a measure or that reviewers may criticize."""

import re
from collections import Counter
from collections.abc import Iterator
from itertools import chain

from thbridge.app.compose.setting import advice_on_language, missing_in
from thbridge.experiment.allocation.places import Place
from thbridge.experiment.design.experiment_file import ExperimentDesign, OrderKind, name_of
from thbridge.experiment.design.plan import plan_of
from thbridge.experiment.design.steps import Failed, StepKind
from thbridge.experiment.questionnaires.form import MEASURED, SHIPPED, Form, Scale
from thbridge.files.disk.text_files import read_text
from thbridge.files.language_texts import ENGLISH

_GAP = re.compile(r"\[(Replace|Write|Insert|TODO)\b[^\]]*\](?!\()")
"""Pattern of a gap that the author must still fill in, as in the consent text of the example."""


def advice_on(design: ExperimentDesign) -> tuple[str, ...]:
    """Return sentences about valid choices that may be unintended, in order of decreasing importance."""
    return (
        *_on_texts(design),
        *_on_languages(design),
        *map(str, design.doubts),
        *_on_orders(design),
        *_on_results_shown(design),
        *_on_steps(design),
        *_on_checks(design),
        *_on_forms(design),
        *_on_methods(design),
    )


def people_in_words(design: ExperimentDesign) -> str:
    """Return the number of participants and the number of conditions per participant, in words."""
    people, groups, within = design.allocation.size, len(design.cells), len(design.conditions)
    if groups == 1:
        return f"{people} people, " + ("one condition" if within == 1 else f"{within} conditions for each")
    met = "one" if within == 1 else f"{within}"
    return f"{people} people in {groups} groups; each person meets {met} of {groups * within} conditions"


def _on_texts(design: ExperimentDesign) -> Iterator[str]:
    for text in dict.fromkeys(entry.text for entry in design.file.steps if entry.text is not None):
        words = read_text(design.path.parent / text)
        if gap := _GAP.search(words):
            yield f"{text}: this text still has a gap ({gap.group()}). Fill in the gap."
        elif not words.strip():
            yield f"{text}: this text is empty. Participants would see an empty page."


def _on_languages(design: ExperimentDesign) -> Iterator[str]:
    """Yield sentences about games, forms, maps and template sets that are not in the study's language."""
    games = tuple(chain(*(cell.studies for cell in design.cells), *chain(*design.practices.values())))
    studies = {(study.dialogue.language, study.dialogue.words): study for study in (design.study, *games)}
    own, *others = dict.fromkeys(language for language, _ in studies)
    if others:
        yield (
            f"The pages of the study are in {own}, but games are in {_listed(others)}. Participants would read several "
            "languages. Write only one `dialogue.language`, under `base`."
        )
    for study in studies.values():
        if (advice := advice_on_language(study, design.beside)) is not None:
            yield f"{advice}."
    if own != ENGLISH:
        for path in {form.path: None for form in design.form_files.values() if form.path.parent == SHIPPED}:
            yield (
                f"{path.stem}: there is no translation of this form into {own}, so participants see the English form. "
                f"Translate a copy of {path}, and name the copy in the step: `form: {path.name}`."
            )
    of_files = {(study.dialogue.language, study.map, study.templates): study for study in games}
    missing = chain.from_iterable(missing_in(study, design.beside) for study in of_files.values())
    yield from dict.fromkeys(f"Participants would read another language: {fault}" for fault in missing)


def _on_orders(design: ExperimentDesign) -> Iterator[str]:
    orders, file = len(design.orders), design.file
    if file.quota % orders:
        yield (
            f"The quota, {file.quota}, is not a multiple of the number of orders, {orders}. So some orders occur more "
            "often than others."
        )
    if len(design.conditions) == 1:
        return
    if file.order is OrderKind.FIXED:
        yield (
            "All people play the conditions in the same order. So the data cannot separate effects of the condition "
            "from effects of practice or fatigue. Write `order: balanced`."
        )
    elif file.order is OrderKind.CYCLIC and len(design.conditions) > 2:
        yield (
            "With `order: cyclic`, a condition mostly comes after the same other condition. So after-effects are not "
            "balanced. Write `order: balanced`."
        )
    if len(set(file.seeds)) < len(file.seeds):
        yield "Two trials have the same seed under `seeds`, so both trials have the same hidden treasures."


def _on_results_shown(design: ExperimentDesign) -> Iterator[str]:
    """Yield advice if a game shows the best possible score before a form asks about the game."""
    if not any(study.participant.shows.answers for cell in design.cells for study in cell.studies):
        return
    plan = plan_of(design, Place(0, 0, 0))
    trial = next((step.number for step in plan if step.entry.step is StepKind.TRIAL), len(plan))
    form = next((step for step in plan[trial:] if step.entry.step is StepKind.FORM), None)
    if form is not None:
        yield (
            "At the end of a game, participants see the treasures of all rooms and the best possible score. This may "
            f"bias their answers to the later form {form.name}. Write `participant.shows.answers: false` under `base`. "
            "With `results: true`, the debrief shows the best possible score instead."
        )


def _on_steps(design: ExperimentDesign) -> Iterator[str]:
    steps = design.file.steps
    kinds = [entry.step for entry in steps]
    if StepKind.DEBRIEF not in kinds:
        yield "No step explains the purpose of the study afterwards. Add {step: debrief, text: FILE} as the last step."
    if StepKind.TRIAL in kinds and StepKind.PRACTICE not in kinds[: kinds.index(StepKind.TRIAL)]:
        yield (
            "There is no practice before the first trial. So this trial also measures how people learn to use the "
            "window. Add a practice step."
        )
    if StepKind.TRIAL in kinds and StepKind.CHECK not in kinds:
        yield "No check tests whether people understood the task. Add {step: check, form: FILE}."


def _on_checks(design: ExperimentDesign) -> Iterator[str]:
    for index, entry in enumerate(design.file.steps):
        if entry.step is not StepKind.CHECK:
            continue
        name = name_of(index, entry)
        if entry.attempts == 1 and entry.failed is Failed.EXCLUDE:
            yield f"{name}: a single wrong answer excludes a person. Write `attempts: 2`, or `failed: go on`."
        asked = [item for item in design.forms[index].items if item.is_checked and item.scale is Scale.CHOICE]
        fixed = [item for item in asked if not item.shuffle]
        if fixed and len(asked) > 1 and all(item.correct == item.options[0] for item in fixed):
            yield f"{name}: the right answer is always the first option. Write `shuffle: true` for the items."


def _on_forms(design: ExperimentDesign) -> Iterator[str]:
    forms = {form.path: form.value for form in design.form_files.values()}
    for path, form in forms.items():
        for words in _on_form(form):
            yield f"{path.stem}: {words}"


def _on_form(form: Form) -> Iterator[str]:
    bare = [
        item.id
        for item in form.items
        if item.scale in {Scale.LIKERT, Scale.ANALOGUE} and not (item.words[0] and item.words[-1])
    ]
    if bare:
        yield f"{_listed(bare)}: the ends of the scale have no words. Write `low` and `high`, or `labels`."
    texts = Counter(" ".join(item.text.casefold().split()) for item in form.items if item.text)
    for words, times in texts.items():
        if times > 1:
            ids = [item.id for item in form.items if " ".join(item.text.casefold().split()) == words]
            yield f"{_listed(ids)}: these items have the same text."
    for name, items in form.subscales.items():
        if len(items) == 1:
            yield f"the score {name} has only one item, so its reliability cannot be computed. Add further items."
        elif (
            len(items) > 2 and not any(item.reverse for item in items) and all(each.scale in MEASURED for each in items)
        ):
            yield (
                f"no item of the score {name} is reversed, so a person who agrees with everything gets a high score. "
                "Give some items the opposite meaning, and add `reverse: true`."
            )


def _on_methods(design: ExperimentDesign) -> Iterator[str]:
    """Yield advice about information that a paper must report and that the design does not contain."""
    file = design.file
    written = {
        "recruitment": file.recruitment,
        "ethics": file.ethics,
        "sample_size_reason": file.sample_size_reason,
        "exclusions": " ".join(file.exclusions),
    }
    missing = [key for key, sentence in written.items() if not sentence.strip() or _GAP.search(sentence)]
    if missing:
        yield f"The methods text will have gaps, because these keys have no text: {_listed(missing)}."


def _listed(names: list[str]) -> str:
    shown = ", ".join(names[:5])
    return f"{shown} and {len(names) - 5} more" if len(names) > 5 else shown
