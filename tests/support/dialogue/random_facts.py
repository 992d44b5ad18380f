"""Random facts of robots, for tests."""

from hypothesis import strategies as st

from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import PlanValue

energies = st.integers(1, 400).map(float)


@st.composite
def where_facts(draw: st.DrawFn) -> WhereFacts:
    left = tuple(Room(number) for number in sorted(draw(st.sets(st.integers(1, 8), min_size=1))))
    costs = {room: draw(energies) for room in left if draw(st.booleans())}
    energy = draw(energies)
    tour = draw(st.permutations(left))
    payable = [room for room, cost in costs.items() if cost <= energy]
    return WhereFacts(
        robot=0,
        here=Room(0),
        energy=energy,
        costs=costs,
        left=left,
        under_way={room: 1 for room in left if draw(st.booleans()) and draw(st.booleans())},
        values={room: PlanValue(draw(st.integers(1, 5)), draw(energies)) for room in payable},
        others={room: (1, draw(energies)) for room in left if draw(st.booleans())},
        tour=tuple(tour[: draw(st.integers(0, len(tour)))]),
        failed=frozenset(room for room in left if draw(st.booleans()) and draw(st.booleans())),
    )


@st.composite
def what_facts(draw: st.DrawFn) -> WhatFacts:
    names = tuple(sorted(draw(st.sets(st.sampled_from(["cup", "hat", "key", "vase"]), min_size=1))))
    costs = st.integers(0, 60).map(float)
    return WhatFacts(
        Room(draw(st.integers(1, 8))), draw(energies), draw(costs), draw(costs), names, draw(st.booleans())
    )
