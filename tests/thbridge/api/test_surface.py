"""The public surface of `thbridge.api`: whoever changes it changes the lists here, and says so in the changelog."""

import inspect

from thbridge import api

PUBLIC = {
    "HuntAgreement": "matter robot room",
    "HuntDialogue": "choices matter robot room said",
    "HuntError": "add_note args with_traceback",
    "HuntEvent": "data kind robot room seconds text",
    "HuntParticipant": "agree answer call_back discuss end_game give_up measure name play_again select send sense "
    "suggest take_picture take_up tell",
    "HuntRecording": "arrays figures messages participant replay seconds study table topics",
    "HuntReplay": "difference equal messages recording ticks",
    "HuntSession": "cancel_goal carry close drive forget_pose hand_back kill leave_treasure name_treasure over play "
    "put_thing ready remove_thing revive run run_until seconds send set_goal set_parameters set_pose snapshot step "
    "stop take_picture tick view",
    "HuntSnapshot": "bound_for commands costs covariances energy game goals lost named odometry over particles places "
    "plans poses remaining scans score seconds states tick true_collisions true_poses true_treasures true_twists "
    "twists visited",
    "HuntStudy": "changed map robots rooms seed treasures yaml",
    "HuntView": "agreements bound_for conditions consent costs dialogues energy known named names over pictures places "
    "points ready refusal score undecided visited",
}


def public(names: list[str]) -> list[str]:
    return [name for name in names if not name.startswith("_")]


def test_public_names_and_their_members() -> None:
    classes = {name: thing for name, thing in inspect.getmembers(api, inspect.isclass) if not name.startswith("_")}
    assert {name: " ".join(public(dir(thing))) for name, thing in classes.items()} == PUBLIC
    assert all(thing.__module__.startswith("thbridge.api.") for thing in classes.values())
    assert not [name for name, _ in inspect.getmembers(api, inspect.isroutine) if not name.startswith("_")]


def test_every_public_member_says_what_it_is() -> None:
    silent = [
        f"{name}.{member}"
        for name, members in PUBLIC.items()
        if name != "HuntError"
        for member in members.split()
        if not hasattr(getattr(api, name), "__dataclass_fields__")
        and not inspect.getdoc(getattr(getattr(api, name), member))
    ]
    assert silent == []
