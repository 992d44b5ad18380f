"""The nine cases."""

from collections import Counter
from itertools import chain, combinations, product

from thbridge.dialogue.argumentation.cases import DialogueKind, Side, Stance, case_of, case_of_choices

ROOMS = [f"Room{number}" for number in range(1, 7)]


def test_every_case_has_its_number_and_who_lacks_knowledge_asks() -> None:
    assert sorted(case_of(robot, human).number for robot, human in product(Stance, Stance)) == list(range(1, 10))
    assert case_of(Stance.UNKNOWN, Stance.BELIEVES).openers == {Side.ROBOT}
    assert case_of(Stance.DISBELIEVES, Stance.UNKNOWN).openers == {Side.HUMAN}
    assert case_of(Stance.BELIEVES, Stance.DISBELIEVES).openers == {Side.ROBOT, Side.HUMAN}
    assert case_of(Stance.BELIEVES, Stance.BELIEVES).openers == set()


def test_all_pairs_of_choices_among_six_rooms_are_counted_as_the_paper_does() -> None:
    choices = list(chain.from_iterable(combinations(ROOMS, size) for size in range(7)))
    counts = Counter(case_of_choices(robot, human, ROOMS) for robot, human in product(choices, choices))
    assert counts == {
        DialogueKind.AGREEMENT: 63,
        DialogueKind.PERSUASION: 3906,
        DialogueKind.INFORMATION_SEEKING: 126,
        DialogueKind.INQUIRY: 1,
    }
