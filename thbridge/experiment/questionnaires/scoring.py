"""Scores of a form's answers, and the reliability of these scores."""

import math
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim.numerics.float_array import FloatArray
from thbridge.experiment.questionnaires.form import MEASURED, Form, Item, Scale, Scoring

NOT_APPLICABLE = "not applicable"
"""Answer to an item that does not apply. A missing answer is different from this answer."""

Answer = float | str | tuple[str, ...]
"""Answer to one item: a number, a text, one option, or several options."""


def right_answer(item: Item, levels: Mapping[str, str]) -> Answer | None:
    """Return the right answer to an item, with the type of a stored answer, or None if there is no right answer.

    Args:
        item: item of a form.
        levels: level of each factor in the participant's condition.
    """
    correct = item.correct_at(levels)
    if correct is None or item.scale not in {*MEASURED, Scale.NUMBER}:
        return correct
    try:
        return float(correct)
    except ValueError:
        return None


def is_right(item: Item, answer: object, levels: Mapping[str, str]) -> bool | None:
    """Return True for a right answer, False for a wrong answer, and None if the item has no right answer.

    In texts, case does not matter.
    """
    right = right_answer(item, levels)
    if right is None:
        return None
    if item.scale is Scale.TEXT and isinstance(answer, str) and isinstance(right, str):
        given, right = (unicodedata.normalize("NFC", text).strip().casefold() for text in (answer, right))
        return given == right
    return answer == right


def keyed(item: Item, answer: Answer | None) -> float:
    """Return the value of an answer for the score, reversed for a reversed item. Return NaN if there is no number."""
    if not isinstance(answer, int | float) or isinstance(answer, bool):
        return math.nan
    return item.least + item.greatest - answer if item.reverse else float(answer)


def scores_of(form: Form, answers: Mapping[str, Answer]) -> dict[str, float]:
    """Return the score of each subscale. A score is NaN if too few items were answered.

    Args:
        form: the form.
        answers: answers by the item's id, without unanswered items.
    """
    scores = {}
    for name, items in form.subscales.items():
        values = [value for item in items if not math.isnan(value := keyed(item, answers.get(item.id)))]
        if not values or len(values) < form.answered * len(items):
            scores[name] = math.nan
        else:
            mean = math.fsum(values) / len(values)
            # Missing answers count as the mean of the given answers.
            scores[name] = mean * len(items) if form.scoring is Scoring.SUM else mean
    return scores


@dataclass(frozen=True, slots=True)
class Reliability:
    """Internal consistency of a subscale.

    Attributes:
        people: number of people who answered all items of the subscale. Other people do not count.
        items: number of items of the subscale.
        alpha: Cronbach's alpha; NaN for fewer than two people or items, or without any variance.
        omega: McDonald's omega total, from one factor fitted by least squares of residual correlations; NaN in the same
            cases, for fewer than three items, and for an item without variance.
    """

    people: int
    items: int
    alpha: float
    omega: float


def reliability_of(items: Sequence[Item], people: Sequence[Mapping[str, Answer]]) -> Reliability:
    """Return the reliability of a subscale.

    Args:
        items: items of the subscale.
        people: answers of each person, by the item's id.

    Sources: Cronbach, Coefficient alpha and the internal structure of tests (1951); McDonald, Test theory (1999),
        chapter 6; Harman and Jones, Factor analysis by minimizing residuals (1966).
    """
    rows = np.array([[keyed(item, answers.get(item.id)) for item in items] for answers in people])
    rows = rows.reshape(-1, len(items))
    rows = rows[~np.isnan(rows).any(axis=1)]
    count, k = rows.shape
    if count < 2 or k < 2:
        return Reliability(count, k, math.nan, math.nan)
    off = rows - rows.mean(axis=0)
    covariance = np.array([[(off[:, i] * off[:, j]).sum() for j in range(k)] for i in range(k)]) / (count - 1)
    own, whole = np.diag(covariance), covariance.sum()
    if whole <= 0.0:
        return Reliability(count, k, math.nan, math.nan)
    alpha = k / (k - 1) * (1.0 - own.sum() / whole)
    return Reliability(count, k, float(alpha), _omega(covariance))


def _omega(covariance: FloatArray) -> float:
    deviations = np.sqrt(np.diag(covariance))
    if (deviations == 0.0).any() or len(deviations) < 3:
        # One correlation does not determine the loadings of two items.
        return math.nan
    loadings = _one_factor(covariance / (deviations[:, np.newaxis] * deviations)) * deviations
    common = loadings.sum() ** 2
    unique = np.maximum(np.diag(covariance) - loadings * loadings, 0.0).sum()
    return float(common / (common + unique))


def _one_factor(correlation: FloatArray) -> FloatArray:
    """Return the (k,) loadings of one factor with the least sum of squared residual correlations.

    Each step sets one loading to the value that is best while the other loadings are fixed. The steps end when no
    loading changes.
    """
    k = len(correlation)
    between = correlation - np.diag(np.diag(correlation))
    # The mean correlation of an item with the other items has the sign and about the size of the item's loading.
    loadings: FloatArray = between.sum(axis=1) / math.sqrt(max(between.sum(), 1e-12))
    for _ in range(1000):
        before = loadings.copy()
        for i in range(k):
            others = np.delete(loadings, i)
            squares = (others * others).sum()
            if squares > 0.0:
                best = (np.delete(between[i], i) * others).sum() / squares
                loadings[i] = min(1.0, max(-1.0, best))
        if np.abs(loadings - before).max() < 1e-10:
            break
    return loadings if loadings.sum() >= 0.0 else -loadings
