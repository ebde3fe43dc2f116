"""The plot of a person's idle motion: her postures, shifts, rests and small variations.

Needs matplotlib, the extra `[plots]`; only `cubeling idle show` and the page of printed tables
import this module.
"""

from pathlib import Path

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch
from numpy.typing import NDArray

from cubeling.app.workshop.moods.colors import CURVE_STYLES, GRID_COLOR, SECONDARY_COLOR, TEXT_COLOR
from cubeling.app.workshop.moods.plot import titled_figure
from cubeling.characters import Character
from cubeling.characters.model import idle_clips, stick_figure
from cubeling.characters.motion import (
    BALANCES,
    IdleDatabase,
    RestingPosture,
    Skeleton,
    StretchStream,
    skeleton_identity,
)
from cubeling.characters.rendering import PAPER_BGR, PortraitRenderer, create_context

SIZE_IN = (13.0, 9.2)
"""Width and height of the plot [in]."""

MAX_POSTURES = 7
"""Postures of a balance that are drawn."""

PORTRAIT_PX = (150, 230)
"""Width and height of a posture."""

COMPONENTS, SHOWN_S, TICK_S = 3, 20.0, 5.0
"""Components, and seconds of small variations at most, that are drawn; and those between ticks."""

_NAMES = {"left": "left foot", "both": "both feet", "right": "right foot"}
_COLORS = dict(zip(BALANCES, ("#0072b2", "#6d7385", "#d55e00"), strict=True))
_NODES = {"left": (0.0, 0.15), "both": (0.5, 0.72), "right": (1.0, 0.15)}
_MIDDLE = np.array([0.5, 0.4])
_SCALES = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # [°]


def save_plot(path: Path, database: IdleDatabase, title: str) -> None:
    """Write the plot of a person's idle motion; the suffix of the path says how.

    Raises
    ------
    AppError
        The file cannot be written.
    """
    with titled_figure(path, title, SIZE_IN, 15) as figure:
        draw(figure, database)


def draw(figure: Figure, database: IdleDatabase) -> None:
    """Draw the plot in an empty figure; see `save_plot`."""
    top, bottom = figure.subfigures(2, 1, squeeze=False, height_ratios=(2.6, 1.0))[:, 0]
    balances = [name for name in BALANCES if name in database.by_balance]
    columns = min(MAX_POSTURES, max(len(own) for own in database.by_balance.values()))
    # As wide as the postures are, and at least as their titles.
    share = max(0.42, 1.7 * columns / MAX_POSTURES)
    left, right = top.subfigures(1, 2, squeeze=False, width_ratios=(share, 1.0))[0]
    for axes, name in zip(np.atleast_1d(left.subplots(len(balances), 1)), balances, strict=True):
        _draw_postures(axes, database, name, columns)
    graph, dwells = right.subplots(2, 1, height_ratios=(1.35, 1.0))
    _draw_transitions(graph, database)
    _draw_rests(dwells, database, balances)
    _draw_variations(bottom.subplots(), database)


def body_of(skeleton: Skeleton) -> Character:
    """Return the bundled character of a skeleton, or a figure of sticks."""
    for name in Character.bundled_names():
        character = Character.load(name)
        if skeleton_identity(character.skeleton) == skeleton_identity(skeleton):
            return character
    return stick_figure("figure", skeleton)


def _draw_postures(axes: Axes, database: IdleDatabase, name: str, columns: int) -> None:
    """Draw postures of a balance, from the shortest rest to the longest one."""
    own = sorted(database.by_balance[name], key=lambda posture: posture.duration)
    chosen = [own[n] for n in np.unique(np.linspace(0, len(own) - 1, columns).astype(int))]
    pictures = _pictures(database, chosen)
    width, height = PORTRAIT_PX
    row = np.full((height, width * columns, 3), PAPER_BGR, np.uint8)
    for number, picture in enumerate(pictures):
        row[:, number * width : (number + 1) * width] = picture
        duration = f"{chosen[number].duration:.1f} s"
        axes.text((number + 0.5) * width, height + 6, duration, ha="center", va="top", fontsize=9)
    axes.imshow(cv2.cvtColor(row, cv2.COLOR_BGR2RGB), interpolation="antialiased")
    axes.set_axis_off()
    axes.set_anchor("W")
    count = f"{len(own)} posture" + ("s" if len(own) > 1 else "")
    shown = "" if len(own) == len(chosen) else f", {len(chosen)} of them drawn"
    where = _NAMES[name] if name == "both" else f"the {_NAMES[name]}"
    axes.set_title(
        f"on {where}: {count}{shown}", loc="left", color=_COLORS[name], fontweight="bold"
    )


def _pictures(database: IdleDatabase, postures: list[RestingPosture]) -> list[NDArray[np.uint8]]:
    """Return portraits of postures by one camera."""
    body = body_of(database.kind.skeleton)
    held = next((clip.poses[0] for clip in idle_clips(body.clips)), None)
    context = create_context()
    renderer = PortraitRenderer(context, PORTRAIT_PX)
    poses = [database.kind.poses(posture.vector, held) for posture in postures]
    try:
        return renderer.portraits(body, poses, azimuth=0.0)
    finally:
        renderer.release()
        context.release()


def _draw_transitions(axes: Axes, database: IdleDatabase) -> None:
    """Draw how often which balance follows which."""
    axes.set_title("balance shifts: what follows how often", loc="left", fontweight="bold")
    axes.set_xlim(-0.15, 1.15)
    axes.set_ylim(0.0, 1.0)
    axes.set_aspect("equal")  # arrows bend across their way on the paper
    axes.set_axis_off()
    for name in database.by_balance:
        axes.text(
            *_NODES[name],
            _NAMES[name],
            ha="center",
            va="center",
            color="white",
            fontweight="bold",
            bbox={"boxstyle": "round,pad=0.6", "facecolor": _COLORS[name], "edgecolor": "none"},
            zorder=3,
        )
        for after, chance in database.probabilities(name).items():
            _draw_shift(axes, name, after, chance)
    if not database.shifts:
        axes.text(0.5, 0.5, "no shifts", ha="center", color=SECONDARY_COLOR)


def _draw_shift(axes: Axes, name: str, after: str, chance: float) -> None:
    """Draw the arrow from one balance to another, or back to itself, with its probability."""
    start, end = np.array(_NODES[name]), np.array(_NODES[after])
    if name == after:
        outward = (start - _MIDDLE) / np.linalg.norm(start - _MIDDLE)
        across = 0.1 * np.array([outward[1], -outward[0]])
        start, end, bend, apart = start + across, start - across, 1.3, 15.0
    else:
        bend, apart = 0.18, 40.0
    way = end - start
    label = (start + end) / 2 + bend / 2 * np.array([way[1], -way[0]])  # the middle of the arc
    if name == after:
        label = _NODES[name] + 0.24 * outward
    arrow = FancyArrowPatch(
        (float(start[0]), float(start[1])),
        (float(end[0]), float(end[1])),
        connectionstyle=f"arc3,rad={bend}",
        arrowstyle="-|>,head_length=7,head_width=4",
        shrinkA=apart,
        shrinkB=apart,
        mutation_scale=1.0,
        color=_COLORS[name],
        linewidth=0.8 + 3.2 * chance,
    )
    axes.add_patch(arrow)
    words = f"{chance:.0%}"
    x, y = label.tolist()
    axes.text(
        x,
        y,
        words,
        color=_COLORS[name],
        ha="center",
        va="center",
        fontsize=10,
        bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none"},
    )


def _draw_rests(axes: Axes, database: IdleDatabase, balances: list[str]) -> None:
    """Draw how long each rest was."""
    axes.set_title("rests: how long", loc="left", fontweight="bold")
    for row, name in enumerate(reversed(balances)):
        own = database.by_balance[name]
        lengths = np.array([posture.duration for posture in own])
        spread = 0.22 * np.cos(np.pi * np.arange(len(own)))  # so that equal ones can be seen
        whole = np.array([not posture.cut for posture in own])
        for full, marker in ((True, "o"), (False, ">")):
            chosen = whole == full
            axes.plot(
                lengths[chosen],
                row + spread[chosen],
                linestyle="none",
                marker=marker,
                color=_COLORS[name],
                alpha=0.7,
                markeredgewidth=0.0,
            )
    axes.set_yticks(range(len(balances)), [_NAMES[name] for name in reversed(balances)])
    axes.set_ylim(-0.6, len(balances) - 0.4)
    axes.set_xlim(left=0.0)
    axes.set_xlabel("duration [s]; ▸ the recording began or ended in it")
    axes.grid(True, axis="x", color=GRID_COLOR, linewidth=0.7)
    axes.spines[["top", "right", "left"]].set_visible(False)


def _draw_variations(axes: Axes, database: IdleDatabase) -> None:
    """Draw the small variations of the longest rest, and generated ones."""
    rate, space = database.rate, database.space
    count = round(SHOWN_S * rate)
    rest = max(database.rests, key=len)[:count]
    stream = StretchStream(database.stretches, np.random.default_rng(1))
    made = np.stack([stream.at(number / rate) for number in range(count)])
    recorded, made = (
        np.degrees(space.project(rows + space.mean, COMPONENTS))
        for rows in (rest - rest.mean(0), made)
    )
    step = 6.0 * float(np.concatenate([recorded, made]).std()) or 1.0
    gap = 0.06 * SHOWN_S
    begins = {"recorded": 0.0, "generated": len(recorded) / rate + gap}
    places, labels = [], []
    for (words, begin), rows, color in zip(
        begins.items(), (recorded, made), (TEXT_COLOR, CURVE_STYLES[1][0]), strict=True
    ):
        times = begin + np.arange(len(rows)) / rate
        axes.plot(times, rows - step * np.arange(COMPONENTS), color=color, linewidth=1.2)
        axes.text(begin, 0.92 * step, words, color=SECONDARY_COLOR)
        seconds = np.arange(0.0, len(rows) / rate + 0.01, TICK_S)
        places += (begin + seconds).tolist()
        labels += [f"{each:g}" for each in seconds]
    axes.set_title("small variations while resting", loc="left", fontweight="bold")
    names = [f"component {number + 1}" for number in range(COMPONENTS)]
    axes.set_yticks(-step * np.arange(COMPONENTS), names)
    axes.set_ylim(-(COMPONENTS - 0.4) * step, 1.2 * step)
    axes.set_xticks(places, labels)
    axes.set_xlabel("time [s]")
    axes.grid(True, axis="x", color=GRID_COLOR, linewidth=0.7)
    axes.spines[["top", "right", "left"]].set_visible(False)
    size = max(each for each in _SCALES if each <= step or each == _SCALES[0])
    beside = begins["generated"] + len(made) / rate + gap / 2
    axes.plot([beside] * 2, [-size, 0.0], color=TEXT_COLOR, linewidth=2.0)
    axes.text(beside + gap / 3, -size / 2, f"{size:g}°", va="center", fontsize=9)
