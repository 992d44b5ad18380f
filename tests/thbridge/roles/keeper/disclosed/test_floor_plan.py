import base64
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from thbridge.app.compose.game import build_floor_plan
from thbridge.app.compose.setting import read_setting
from thbridge.line_splitter import LINE_LIMIT
from thbridge.roles.keeper.disclosed.floor_plan import MOST_PACKED, floor_plan_of
from thbridge.roles.shared.notices import KEEPER, FloorPlan
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire.notice_format import decode_notice, encode_notice, parse_notice

cells = arrays(np.int8, array_shapes(min_dims=2, max_dims=2, max_side=30), elements=st.sampled_from([0, 100, -1]))


def grid_of(plan):
    codes = np.frombuffer(zlib.decompress(base64.b64decode(plan.cells)), dtype=np.uint8)
    cells = np.array([FREE, OCCUPIED, -1], dtype=np.int8)[codes.reshape(plan.height, plan.width)]
    return OccupancyGrid(cells, plan.resolution, Pose2(*plan.origin))


@given(cells)
def test_a_map_comes_back_as_it_went(cells):
    grid = OccupancyGrid(cells, 0.05, Pose2(-1.0, 2.0, 0.5))
    back = grid_of(floor_plan_of("small", grid, [], ()))
    assert (back.cells == cells).all()
    assert (back.resolution, back.origin) == (grid.resolution, grid.origin)


@pytest.mark.parametrize("name", ["arena8", "office", "warehouse12"])
def test_a_house_fits_into_a_line(name):
    setting = read_setting(replace(Study(), map=name), Path())
    line = encode_notice(KEEPER, "TabUI", build_floor_plan(setting))
    house = decode_notice(parse_notice(line), FloorPlan)
    assert len(line.line()) < LINE_LIMIT
    assert (grid_of(house).cells == setting.map.grid.cells).all()
    assert [room.name for room in house.rooms] == [room.name for room in setting.map.rooms]
    assert house.footprint == setting.study.world.footprint


def test_of_a_large_map_every_wall_stays():
    cells = np.random.default_rng(1).choice(np.array([0, 100, -1], np.int8), (1001, 703), p=[0.5, 0.1, 0.4])
    grid = OccupancyGrid(cells, 0.05, Pose2(-3.0, 4.0, 0.0))
    house = floor_plan_of("large", grid, [], ())
    assert len(house.cells) <= MOST_PACKED
    thin = grid_of(house)
    assert thin.resolution in [0.05 * 2**n for n in range(1, 8)]
    for kind, blanks in ((OCCUPIED, ()), (FREE, (OCCUPIED,))):
        rows, cols = thin.cells_of(centres(grid, kind)).T
        assert np.isin(thin.cells[rows, cols], [kind, *blanks]).all()


def centres(grid, kind):
    rows, cols = np.nonzero(grid.cells == kind)
    return np.column_stack([cols + 0.5, rows + 0.5]) * grid.resolution + [grid.origin.x, grid.origin.y]
