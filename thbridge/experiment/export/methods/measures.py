"""Text on measures: questionnaires with items, scales, scores and sources; reliability; measures of the games."""

from collections.abc import Iterator, Mapping, Sequence

from thbridge.experiment.design.steps import StepKind
from thbridge.experiment.export.families.attempts import NO_DATA
from thbridge.experiment.export.families.forms import attention_checks
from thbridge.experiment.export.methods.markdown import counted, listed, paragraph, table
from thbridge.experiment.export.tables import ExperimentRecords
from thbridge.experiment.questionnaires.form import Form, Item, Scale, Scoring
from thbridge.experiment.questionnaires.scoring import Answer, reliability_of
from thbridge.experiment.store.events import RunState

ITEMS_SHOWN = 40
"""Maximum number of items of a form in the text. The form's file has all items."""


def measures_section(records: ExperimentRecords) -> Iterator[str]:
    """Yield the lines of the section."""
    yield "### Measures"
    yield ""
    steps = records.design.file.steps
    forms = {index: form for index, form in records.design.forms.items() if steps[index].step is StepKind.FORM}
    for index, form in forms.items():
        yield from _form(form, each_condition=steps[index].each_condition and len(records.design.conditions) > 1)
    yield from paragraph(*_attention(records, [item for form in forms.values() for item in form.items]))
    if not forms:
        yield from paragraph("Participants filled in no questionnaire.")
    reliabilities = list(_reliabilities(records))
    yield from table(
        "Reliability in this sample",
        ("Score", "Step", "Condition", "Items", "n", "Cronbach's alpha", "McDonald's omega"),
        reliabilities,
    )
    if reliabilities:
        yield from paragraph(
            "n is the number of participants who answered all items. Omega is from a single factor, fitted to the "
            "correlations of items by least squares."
        )
    if any(entry.step is StepKind.TRIAL for entry in steps):
        yield from paragraph(
            "The export computes these measures from the recording of each game: points, rooms visited and treasures "
            "named; decision times; agreement with the robots' advice and appropriate reliance on it; switches after "
            "disagreement; idle times and concurrent activity of human and robots (Hoffman, 2019); moves in dialogues. "
            "`dictionary.csv` defines each measure and its unit.",
            "[State which of these measures were primary and secondary outcomes, and which covariates were used.]",
        )


def _attention(records: ExperimentRecords, items: Sequence[Item]) -> Iterator[str]:
    """Yield sentences about attention checks in questionnaires and about the number of participants who failed."""
    asked = [item for item in items if item.attention]
    if not asked:
        return
    complete = [subject for subject in records.subjects if subject.run.state is RunState.COMPLETE]
    passed = attention_checks(records.design, complete).values()
    failed = sum(not all(each) for each in passed)
    total = sum(each.count(False) for each in passed)
    yield f"The questionnaires had {counted(len(asked), 'attention check')}, which did not count for scores."
    yield (
        f"Of {counted(len(passed), 'analyzed participant')} who answered attention checks, {failed} failed at least "
        f"one check ({counted(total, 'failure')} in total)."
    )


def _purpose(item: Item) -> str:
    return "attention check" if item.attention else item.subscale


def _form(form: Form, *, each_condition: bool) -> Iterator[str]:
    when = "once for each condition" if each_condition else "once"
    order = " Items came in a random order for each participant." if form.shuffle else ""
    pages = f" A page had at most {counted(form.page, 'item')}." if form.page else ""
    yield from paragraph(
        f"**{form.title}** ({counted(len(form.items), 'item')}, {when}).",
        f'Instructions: "{form.instructions.strip()}"' if form.instructions.strip() else "",
        f"Source: {form.source.strip().rstrip('.')}." if form.source.strip() else "[Source of this form.]",
        f"License of the wording: {form.licence.strip().rstrip('.')}." if form.licence.strip() else "",
        *_scorings(form),
        f"{order}{pages}",
    )
    shown = form.items[:ITEMS_SHOWN]
    rows = [
        (
            item.id,
            item.text or "(only the two words)",
            scale_words(item),
            _purpose(item),
            "yes" if item.reverse else "",
        )
        for item in shown
    ]
    yield from table(f"Items of {form.title}", ("Item", "Text", "Response scale", "Score", "Reversed"), rows)
    if len(form.items) > len(shown):
        yield from paragraph(f"[The other {len(form.items) - len(shown)} items are in the form's file.]")


def _scorings(form: Form) -> Iterator[str]:
    """Yield a sentence about each score."""
    for name, items in form.subscales.items():
        reversed_ = sum(item.reverse for item in items)
        how = "sum" if form.scoring is Scoring.SUM else "mean"
        ranges = {(item.least, item.greatest) for item in items}
        share = 1 if form.scoring is Scoring.MEAN else len(items)
        low, high = (min(low for low, _ in ranges) * share, max(high for _, high in ranges) * share)
        spans = f", from {low:g} to {high:g}" if len(ranges) == 1 else ""
        key = "no item reversed" if not reversed_ else f"{counted(reversed_, 'item')} reversed"
        needed = "all answers" if form.answered >= 1.0 else f"at least {form.answered:.0%} of the answers"
        yield (
            f"The score *{name}* is the {how} of {counted(len(items), 'item')}{spans}, with {key}. The score needs "
            f"{needed}."
        )


def scale_words(item: Item) -> str:
    """Return the response scale of an item in words."""
    ends = f" ({item.low} to {item.high})" if item.low and item.high else ""
    if item.labels:
        ends = f" ({', '.join(item.labels)})"
    also = ", or not applicable" if item.not_applicable else ""
    if not item.required:
        also += ", optional"
    match item.scale:
        case Scale.LIKERT:
            return f"{item.points}-point Likert item{ends}{also}"
        case Scale.DIFFERENTIAL:
            return f"{item.points}-point semantic differential{ends}{also}"
        case Scale.ANALOGUE:
            step = f" in steps of {item.step:g}" if item.step > 0.0 else ""
            return f"line from {item.minimum:g} to {item.maximum:g}{step}{ends}{also}"
        case Scale.NUMBER:
            unit = f" {item.unit}" if item.unit else ""
            return f"number from {item.minimum:g} to {item.maximum:g}{unit}{also}"
        case Scale.CHOICE:
            several = "any of" if item.several else "one of"
            shuffled = ", in random order" if item.shuffle else ""
            if item.shuffle and item.pinned:
                shuffled += f" except for “{listed(item.pinned)}”"
            read = dict(zip(item.options, item.labels or item.options, strict=True))
            answers = [option if label == option else f"{label} ({option})" for option, label in read.items()]
            return f"{several}: {listed(answers)}{shuffled}{also}"
        case _:
            return f"free text{also}"


def _reliabilities(records: ExperimentRecords) -> Iterator[tuple[object, ...]]:
    """Yield a row for each score, step and condition of a completed form, so that no person counts twice."""
    items_of: dict[tuple[str, str], tuple[Item, ...]] = {}
    given: dict[tuple[str, str, str], list[Mapping[str, Answer]]] = {}
    for score in records.scores:
        step = score.attempt.step
        if score.run.state is not RunState.COMPLETE or step.entry.step in NO_DATA:
            continue
        condition = "" if step.condition is None else records.design.conditions[step.condition].name
        times = score.attempt.items
        answers = {
            item.id: float(answer)
            for item in score.items
            if item.id in times and isinstance(answer := times[item.id].answer, int | float)
        }
        items_of[score.subscale, step.name] = score.items
        given.setdefault((score.subscale, step.name, condition), []).append(answers)
    for (subscale, name, condition), people in sorted(given.items()):
        found = reliability_of(items_of[subscale, name], people)
        values = ("[too few]" if one != one else f"{one:.2f}" for one in (found.alpha, found.omega))  # noqa: PLR0124
        yield (subscale, name, condition or "all", found.items, found.people, *values)
