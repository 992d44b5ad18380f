"""A whole session whose robots are vehicles, while somebody sends them all that should not be."""

import hashlib
import random
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import TICKS_PER_SECOND
from tests.support.mavlink.hostile_frames import Foe
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.compose.vehicles import vehicle_factory
from thbridge.app.session.session import Session
from thbridge.mavlink.role.parameters import VehicleParameters
from thbridge.mavlink.wire.dialect import mav
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import FrameParser
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study

ROBOTS = 2
SYSTEMS = range(1, ROBOTS + 1)


def stormed(seed, ticks, bytes_a_tick):
    """What a session's robots did and said in a storm, as a digest, and how often hearts beat."""
    study = replace(Study(), robots=ROBOTS, mavlink=MavlinkSection(on=True), seed=1)
    setting = read_setting(study, Path())
    simr = build_simr(setting)
    session = Session(
        build_keeper(setting),
        [simr, build_hider(setting.templates, setting.study.seed)],
        vehicles=vehicle_factory(setting, simr),
    )
    chance = random.Random(seed)
    session.step()
    names = [parameter.name for parameter in VehicleParameters(0, simr).settings()]
    foe, framer, link = Foe(chance, SYSTEMS, names), FrameParser(), session.links.open_link("storm")
    digest, beats = hashlib.sha256(), dict.fromkeys(SYSTEMS, 0)
    for tick in range(1, ticks):
        some = 0
        while some < bytes_a_tick:
            data = foe.says()
            some += len(data)
            for found in framer.receive_data(data):
                if isinstance(found, Frame):
                    session.links.receive_frame(link, found)
        tick_record = session.step()
        for one in tick_record.traffic:
            digest.update(one.frame.to_bytes())
            if one.frame.message_id == mav.MAVLINK_MSG_ID_HEARTBEAT and not one.incoming:
                beats[one.frame.system] = tick
        assert all(tick - last <= TICKS_PER_SECOND for last in beats.values())
        poses = tick_record.snapshot.truth.poses
        assert np.isfinite(poses).all()
        digest.update(poses.tobytes())
    return digest.hexdigest()


def test_robots_live_through_a_storm_and_it_does_the_same_to_them_again():
    assert stormed(5, 150, 600) == stormed(5, 150, 600)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "bytes_a_tick"), [(1, 200), (2, 200), (13, 1500), (14, 1500)])
def test_robots_live_through_a_long_storm(seed, bytes_a_tick):
    stormed(seed, 30 * TICKS_PER_SECOND, bytes_a_tick)
