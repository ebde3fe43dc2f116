"""A video as a table of poses."""

import csv

import numpy as np
import pytest

from cubeling.tracking import CubeState, TrackingError, track_video
from cubeling.tracking.pose_table import COLUMNS, _table

HALF_TURN = np.diag([1.0, -1.0, -1.0, 1.0])


def state(timestamp, pose=None, refused=""):
    return CubeState(
        pose is not None and not refused,
        pose,
        np.zeros(6),
        np.eye(6),
        "markers",
        ("top",),
        0.25 if pose is not None else float("nan"),
        timestamp,
        refused,
    )


@pytest.fixture
def table():
    pose = HALF_TURN.copy()
    pose[:3, 3] = 0.1, -0.2, 0.5
    return _table([state(0.0), state(0.5, pose), state(1.0, pose, "blurred")])


def test_a_pose_counts_where_it_is_trusted(table):
    assert table.verdicts == ("unseen", "trusted", "blurred")
    assert table.visible.tolist() == [False, True, False]
    assert table.positions[1].tolist() == [0.1, -0.2, 0.5]
    assert np.abs(table.quaternions[1]) == pytest.approx([1.0, 0.0, 0.0, 0.0])
    assert np.isnan(table.positions[[0, 2]]).all()
    assert np.isnan(table.quaternions[[0, 2]]).all()


def test_the_file_has_a_row_for_each_frame_and_leaves_out_what_is_not_known(table, tmp_path):
    table.save(tmp_path / "poses.csv")
    with (tmp_path / "poses.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == COLUMNS
    assert [row["time_s"] for row in rows] == ["0.000000", "0.500000", "1.000000"]
    assert [row["x_m"] for row in rows] == ["", "0.1", ""]
    assert rows[1]["reprojection_error_px"] == "0.25"


def test_a_file_that_cannot_be_written_is_refused_with_its_name(table, tmp_path):
    with pytest.raises(TrackingError, match=r"none.poses\.csv"):
        table.save(tmp_path / "none" / "poses.csv")


def test_a_missing_video_is_refused():
    with pytest.raises(TrackingError, match=r"missing\.mp4"):
        track_video("missing.mp4")
