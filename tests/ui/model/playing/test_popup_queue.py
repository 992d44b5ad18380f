from ui.model.playing.memory.popup_queue import DestinationItem, PopupQueue, TreasureItem

A, B, C = TreasureItem(0, 1), TreasureItem(1, 2), DestinationItem(2)


def shown(*items):
    popups = PopupQueue()
    popups.update(items)
    return popups


def test_the_first_is_shown_and_the_others_wait_in_order():
    popups = shown(A)
    popups.update((C, B, A))
    assert popups.shown == A
    assert popups.waiting == (C, B)


def test_what_is_over_makes_room_for_what_waits_longest():
    popups = shown(A, B, C)
    popups.update((C, B))
    assert popups.shown == B
    popups.update(())
    assert (popups.shown, popups.waiting) == (None, ())


def test_what_is_put_aside_comes_back_only_when_asked_for():
    popups = shown(A, B)
    popups.put_aside()
    assert (popups.shown, popups.waiting) == (B, (A,))
    popups.update((A,))
    assert popups.shown is None
    popups.put_aside()
    assert popups.shown == A


def test_what_the_participant_asked_for_comes_first_and_the_rest_comes_back_after_it():
    popups = shown(A, B)
    popups.show(C)
    assert (popups.shown, popups.waiting) == (C, (A, B))
    popups.update((A, B))
    assert popups.shown == A


def test_what_was_put_aside_and_asked_for_is_not_aside_any_more():
    popups = shown(A, B)
    popups.put_aside()
    popups.show(A)
    popups.show(B)
    popups.update((A,))
    assert popups.shown == A


def test_turning_to_a_robot_shows_what_waits_of_it_even_what_was_put_aside():
    popups = shown(A, B)
    popups.turn_to(1)
    assert popups.shown == B
    popups.turn_to(0)
    assert popups.shown == A
    popups.put_aside()
    popups.turn_to(2)
    assert popups.shown is None
    popups.turn_to(0)
    assert (popups.shown, popups.waiting) == (A, (B,))


def test_what_came_back_is_new():
    popups = shown(A)
    popups.put_aside()
    popups.update(())
    popups.update((A,))
    assert popups.shown == A
