"""Sentences for people."""

import pytest

from tests.support.mavlink.vehicle_with_stations import SECOND
from thbridge.mavlink.vehicle.parts import TextSeverity
from thbridge.mavlink.vehicle.telemetry.status_texts import StatusTexts


def said(texts, ticks, start=0):
    return [word.message for tick in range(start, start + ticks) for word in texts.step(tick)]


@pytest.mark.parametrize("length", [1, 49, 50, 51, 99, 100, 101, 150])
def test_a_sentence_comes_in_chunks_of_which_the_last_is_shorter(length):
    texts = StatusTexts()
    sentence = ("A" + "abcdefghi " * 20)[:length]
    texts.say(TextSeverity.INFO, sentence)
    chunks = said(texts, SECOND)
    assert b"".join(chunk._text_raw for chunk in chunks).decode() == sentence
    assert [chunk.chunk_seq for chunk in chunks] == list(range(len(chunks)))
    if len(chunks) > 1:
        assert len({chunk.id for chunk in chunks}) == 1
        assert chunks[0].id > 0
        assert len(chunks[-1]._text_raw) < 50
    else:
        assert chunks[0].id == 0


def test_two_long_sentences_are_told_apart():
    texts = StatusTexts()
    texts.say(TextSeverity.INFO, "A" * 60)
    texts.say(TextSeverity.INFO, "B" * 60)
    assert [chunk.id for chunk in said(texts, SECOND)] == [1, 1, 2, 2]


def test_no_more_than_a_few_a_second():
    texts = StatusTexts()
    for number in range(8):
        texts.say(TextSeverity.INFO, f"Sentence {number}")
    assert len(said(texts, SECOND)) <= 5
    assert len(said(texts, SECOND, SECOND)) >= 3


def test_the_same_sentence_is_not_said_again_for_a_while():
    texts = StatusTexts()
    heard = []
    for tick in range(10 * SECOND):
        texts.say(TextSeverity.WARNING, "No.")
        heard += texts.step(tick)
    assert 3 <= len(heard) <= 4


def test_a_warning_is_said_though_the_same_was_just_told():
    texts = StatusTexts()
    texts.say(TextSeverity.NOTICE, "Commanded by ground station 255.")
    texts.say(TextSeverity.WARNING, "Commanded by ground station 255.")
    assert [message.severity for message in said(texts, SECOND)] == [TextSeverity.NOTICE, TextSeverity.WARNING]


def test_of_too_many_the_newest_are_told():
    texts = StatusTexts()
    for number in range(1000):
        texts.say(TextSeverity.INFO, f"Sentence {number}")
    told = [message.text for message in said(texts, 100 * SECOND)]
    assert told == [f"Sentence {number}" for number in range(992, 1000)]


@pytest.mark.parametrize("severity", TextSeverity)
def test_what_is_critical_is_told_to_stations_that_are_not_heard_too(severity):
    texts = StatusTexts()
    texts.say(severity, "The station is lost." * 5)
    words = list(texts.step(0))
    assert {word.to_inactive for word in words} == {severity is TextSeverity.CRITICAL}


def test_a_sentence_begins_with_a_capital():
    texts = StatusTexts()
    texts.say(TextSeverity.INFO, "there is no mission")
    assert said(texts, 1)[0].text == "There is no mission"
