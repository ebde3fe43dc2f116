"""How long ten minutes of motion capture take to load: `python -m tests.bench.mocap`."""

import resource
import tempfile
import time
from pathlib import Path
from typing import TypeAlias

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.characters.formats import load_motion

RATE_HZ = 120
MINUTES = 10
MAX_LOAD_S = 5.0
"""Time allowed for ten minutes of motion capture [s]."""

RUNS = 3

Bone: TypeAlias = tuple[str, str, tuple[float, ...], float, tuple[float, ...], str]

# A performer like CMU's: bone, parent, direction, length, axis, degrees of freedom.
LEG: list[Bone] = [
    ("hipjoint", "root", (0.64, -0.71, 0.3), 2.5, (0, 0, 0), ""),
    ("femur", "hipjoint", (0.34, -0.94, 0), 7.0, (0, 0, 20), "rx ry rz"),
    ("tibia", "femur", (0.34, -0.94, 0), 7.8, (0, 0, 20), "rx"),
    ("foot", "tibia", (0.1, -0.26, 0.96), 2.2, (-90, 0, 20), "rx rz"),
    ("toes", "foot", (0, 0, 1), 1.1, (-90, 0, 20), "rx"),
]
ARM: list[Bone] = [
    ("clavicle", "thorax", (0.94, 0.33, -0.07), 3.4, (0, 0, 0), "ry rz"),
    ("humerus", "clavicle", (1, 0, 0), 5.0, (180, 30, 90), "rx ry rz"),
    ("radius", "humerus", (1, 0, 0), 3.1, (180, 30, 90), "rx"),
    ("wrist", "radius", (1, 0, 0), 1.6, (180, 30, 90), "ry"),
    ("hand", "wrist", (1, 0, 0), 0.7, (180, 30, 90), "rx rz"),
    ("fingers", "hand", (1, 0, 0), 0.6, (180, 30, 90), "rx"),
    ("thumb", "wrist", (0.7, 0, 0.7), 0.7, (-90, 45, 0), "rx rz"),
]
SPINE: list[Bone] = [
    ("lowerback", "root", (0, 1, 0), 2.0, (0, 0, 0), "rx ry rz"),
    ("upperback", "lowerback", (0, 1, 0), 2.0, (0, 0, 0), "rx ry rz"),
    ("thorax", "upperback", (0, 1, 0), 2.0, (0, 0, 0), "rx ry rz"),
    ("lowerneck", "thorax", (0, 1, 0.1), 1.6, (0, 0, 0), "rx ry rz"),
    ("upperneck", "lowerneck", (0, 1, 0.1), 1.6, (0, 0, 0), "rx ry rz"),
    ("head", "upperneck", (0, 1, 0.1), 1.6, (0, 0, 0), "rx ry rz"),
]


def bones() -> list[Bone]:
    """Return the bones of both sides and the spine."""
    paired = {name for name, *_ in LEG + ARM}
    found = list(SPINE)
    for side, sign in (("l", 1), ("r", -1)):
        for name, parent, (x, y, z), length, (a, b, c), dof in LEG + ARM:
            above = side + parent if parent in paired else parent
            found.append((side + name, above, (sign * x, y, z), length, (a, b, sign * c), dof))
    return found


def write_acclaim(folder: Path, frames: int) -> Path:
    """Write an .asf and an .amc of a performer who moves smoothly; return the .amc."""
    data = "".join(
        f"  begin\n    id {number}\n    name {name}\n"
        f"    direction {' '.join(map(str, direction))}\n    length {length}\n"
        f"    axis {' '.join(map(str, axis))} XYZ\n"
        + (f"    dof {dof}\n" if dof else "")
        + "  end\n"
        for number, (name, _, direction, length, axis, dof) in enumerate(bones(), start=1)
    )
    links = "".join(f"    {parent} {name}\n" for name, parent, *_ in bones())
    (folder / "fidget.asf").write_text(
        ":version 1.10\n:name fidget\n:units\n  mass 1.0\n  length 0.45\n  angle deg\n"
        ":root\n  order TX TY TZ RX RY RZ\n  axis XYZ\n  position 0 0 0\n  orientation 0 0 0\n"
        f":bonedata\n{data}:hierarchy\n  begin\n{links}  end\n"
    )
    moving = [("root", 6)] + [(name, len(dof.split())) for name, *_, dof in bones() if dof]
    values = fidget(frames, sum(count for _, count in moving))
    lines = "\n".join(name + " %g" * count for name, count in moving)
    path = folder / "fidget.amc"
    with path.open("w") as file:
        file.write(":FULLY-SPECIFIED\n:DEGREES\n")
        for frame, row in enumerate(values.tolist(), start=1):
            file.write(f"{frame}\n{lines % tuple(row)}\n")
    return path


def write_bvh(folder: Path, frames: int) -> Path:
    """Write the same performer as a .bvh, three channels per joint."""
    children: dict[str, list[str]] = {}
    places = {"root": (0.0, 0.0, 0.0)}
    ends = {"root": (0.0, 0.0, 0.0)}
    for name, parent, (x, y, z), length, *_ in bones():
        children.setdefault(parent, []).append(name)
        places[name], ends[name] = ends[parent], (length * x, length * y, length * z)

    def joint(name: str) -> str:
        below = "".join(f"JOINT {joint(child)}" for child in children.get(name, ()))
        if not below:
            below = f"End Site {{ OFFSET {' '.join(map(str, ends[name]))} }}\n"
        moves = "6 Xposition Yposition Zposition" if name == "root" else "3"
        offset = " ".join(map(str, places[name]))
        turns = "Zrotation Yrotation Xrotation"
        return f"{name}\n{{\nOFFSET {offset}\nCHANNELS {moves} {turns}\n{below}}}\n"

    values = fidget(frames, 6 + 3 * len(bones()))
    path = folder / "fidget.bvh"
    with path.open("w") as file:
        file.write(f"HIERARCHY\nROOT {joint('root')}MOTION\nFrames: {frames}\n")
        file.write(f"Frame Time: {1 / RATE_HZ:.7f}\n")
        np.savetxt(file, values, fmt="%.4f")
    return path


def fidget(frames: int, numbers: int) -> np.ndarray:
    """Return smooth angles [degrees]; the first six numbers are hips 17 units up and upright."""
    rng = np.random.default_rng(7)
    slow = rng.uniform(0.5, 3.0, numbers) * np.arange(frames)[:, None] / RATE_HZ
    values: np.ndarray = 20 * np.sin(slow + rng.uniform(0, 6, numbers))
    values[:, :6] = values[:, :6] / 10 + (0, 17, 0, 0, 0, 0)
    return values


def main() -> None:
    """Print the table, and fail above the time limit."""
    frames = MINUTES * 60 * RATE_HZ
    table = Table("file", "size", "joints × frames", "load (best of three)", "target")
    slowest = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for write, target in ((write_acclaim, MAX_LOAD_S), (write_bvh, MAX_LOAD_S)):
            path = write(Path(folder), frames)
            times = []
            for _ in range(RUNS):
                start = time.perf_counter()
                performance = load_motion(path)
                times.append(time.perf_counter() - start)
            joints = len(performance.skeleton)
            table.add_row(
                path.suffix,
                f"{path.stat().st_size / 1e6:.0f} MB",
                f"{joints} × {len(performance.clip)}",
                f"{min(times):.2f} s",
                f"≤ {target:.0f} s",
            )
            slowest = max(slowest, min(times))
    Console().print(table)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    Console().print(f"{MINUTES} minutes at {RATE_HZ} Hz; at most {peak:.1f} GB of memory")
    if slowest > MAX_LOAD_S:
        raise SystemExit(f"slower than {MAX_LOAD_S:.0f} s")


if __name__ == "__main__":
    main()
