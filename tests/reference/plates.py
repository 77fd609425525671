"""Scenes of the reference. `python plates.py [name ...]` grows them and writes NAME.toml and NAME.csv into data/reference.

Options: --half halves steps and elements and writes to a folder `half`; --shift moves the holes by 0.3 mm down and
up and writes nothing; --quiet prints the results only.
Units: mm, N, MPa, MPa sqrt(m).
"""
import os
import sys
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fracture_fe import Crack, Plate
from grow import Law, Run, grow

HERE = Path(__file__).resolve().parents[2] / "data" / "reference"


@dataclass
class Scene:
    """A plate, its cracks, its load at maximum (stress MPa or force kN) and when it stops (mm)."""
    what: str
    cracks: list  # (from mm, to mm)
    size: tuple = None  # width, length in mm
    outline: list = None
    thickness: float = 2.0
    holes: list = field(default_factory=list)  # (x, y, diameter) in mm
    stress: float = None
    force: float = None
    pins: list = field(default_factory=list)  # (hole, direction, half angle in degrees)
    rollers: list = field(default_factory=list)  # (at mm, direction, contact width mm, share)
    stop: object = None
    step: float = 0.5  # mm
    fineness: float = 1.0
    pairs: tuple = ()  # tips that are images of each other in a half turn

    def corners(self):
        """Outline in mm, counter-clockwise from the lower left."""
        if self.outline:
            return np.array(self.outline, float)
        x, y = self.size[0] / 2, self.size[1] / 2
        return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])

    def plate(self):
        """The plate with its loads at maximum (mm, MPa, N)."""
        outline, loads = self.corners(), []
        if self.stress:
            (a, b, c, d), pull = outline, self.stress
            loads = [(a, b, (0, -pull)), (d, c, (0, pull))]
        for at, direction, width, share in self.rollers:
            half = np.array([width / 2, 0.0])
            pressure = 1000 * self.force * share / (width * self.thickness)
            loads.append((np.array(at) - half, np.array(at) + half, pressure * np.array(direction, float)))
        pins = [(hole, direction, 1000 * self.force, np.radians(half)) for hole, direction, half in self.pins]
        return Plate(outline, self.thickness, [(x, y, d / 2) for x, y, d in self.holes], loads, pins)

    def start(self):
        """The starting cracks; an end on the outline is a mouth, the others are tips numbered in order."""
        outline, number, cracks = self.corners(), 0, []
        low, high = outline.min(axis=0), outline.max(axis=0)
        for ends in self.cracks:
            tips = []
            for end in np.array(ends, float):
                mouth = np.min(np.abs(np.r_[end - low, end - high])) < 1e-9
                tips.append(None if mouth else number)
                number += not mouth
            cracks.append(Crack(np.array(ends, float), tuple(tips)))
        return cracks

    def toml(self, name):
        """The scene as a case file."""
        def table(**values):
            """An inline table."""
            return "{" + ",".join(f"{key}={list(v) if isinstance(v, tuple) else v}" for key, v in values.items()) + "}"

        def listed(key, entries):
            """A list of inline tables, one on a line."""
            return f"{key} = [" + ",\n".join(entries) + "]"

        shape = [f"outline_mm = {[list(p) for p in self.outline]}"] if self.outline else [f"width_mm = {self.size[0]}", f"length_mm = {self.size[1]}"]
        lines = [f"# Reference by finite elements: {name}.csv (see README.md). {self.what}", "[specimen]", 'kind = "plate"', *shape,
                 f"thickness_mm = {self.thickness}",
                 listed("holes", [table(x_mm=x, y_mm=y, diameter_mm=d) for x, y, d in self.holes]),
                 listed("cracks", [table(from_mm=a, to_mm=b) for a, b in self.cracks]),
                 "", "[material]", "youngs_modulus_gpa = 70.0", "poisson_ratio = 0.3", 'plane = "stress"',
                 "", "[fatigue]", "paris_c_mm_per_cycle = 1e-7", "paris_m = 3.0",
                 "", "[loading]", f"stress_max_mpa = {self.stress}" if self.stress else f"force_max_kn = {self.force}", "stress_ratio = 0.1"]
        if self.pins:
            lines.append(listed("pins", [table(hole=h, direction=d, contact_half_angle_deg=a) for h, d, a in self.pins]))
        if self.rollers:
            lines.append(listed("rollers", [table(at_mm=p, direction=d, contact_width_mm=w, share=s) for p, d, w, s in self.rollers]))
        return "\n".join(lines) + "\n"


def reach_x(limit):
    """Stop when a tip comes to |x| = limit in mm."""
    return lambda tips: limit - max(abs(p[0]) for p in tips.values())


def right_of(limit):
    """Stop when a tip comes to x = limit in mm."""
    return lambda tips: limit - max(p[0] for p in tips.values())


def overlap(limit):
    """Stop when tip 0 from the left and tip 1 from the right overlap by a limit in mm."""
    return lambda tips: limit - (tips[0][0] - tips[1][0])


COMPACT = dict(outline=[[-12.5, -30.0], [50.0, -30.0], [50.0, 30.0], [-12.5, 30.0]], thickness=8.0, force=3.5,
               pins=[(0, (0, 1), 30), (1, (0, -1), 30)])
PIN_HOLES = [(0.0, 13.75, 12.5), (0.0, -13.75, 12.5)]

SCENES = {
    "slant_severance": Scene(
        "A slanted centre crack, grown until the tips are 2 mm from the side edges.",
        [((-8.660254, -5.0), (8.660254, 5.0))], size=(80.0, 160.0), stress=72.0, stop=reach_x(38.0), pairs=((0, 1),)),
    "hole_attracts": Scene(
        "An edge crack curves into a hole off its line.",
        [((-50.0, 0.0), (-35.0, 0.0))], size=(100.0, 200.0), holes=[(-12.0, 10.0, 16.0)], stress=36.0),
    "hole_missed": Scene(
        "An edge crack curves towards a hole, passes it and goes on to 80 % of the width.",
        [((-50.0, 0.0), (-35.0, 0.0))], size=(100.0, 200.0), holes=[(-12.0, 17.0, 16.0)], stress=36.0, stop=right_of(30.0)),
    "three_point_bending": Scene(
        "A crack off the middle of a beam curves into the middle one of three holes.",
        [((-52.0, -40.0), (-52.0, -28.0))], size=(200.0, 80.0), thickness=10.0, force=30.0,
        holes=[(-40.0, -27.5, 6.0), (-40.0, -7.5, 6.0), (-40.0, 12.5, 6.0)],
        rollers=[((0.0, 40.0), (0, -1), 6.0, 1.0), ((-90.0, -40.0), (0, 1), 6.0, 0.5), ((90.0, -40.0), (0, 1), 6.0, 0.5)]),
    "compact_one_hole_a": Scene(
        "Compact tension: the crack curves into a hole.",
        [((-12.5, 0.0), (15.0, 0.0))], holes=PIN_HOLES + [(28.0, 6.5, 8.0)], **COMPACT),
    "compact_one_hole_b": Scene(
        "Compact tension: the crack curves towards a hole and passes it; stop 8 mm from the back.",
        [((-12.5, 0.0), (15.0, 0.0))], holes=PIN_HOLES + [(28.0, 11.0, 8.0)], stop=right_of(42.0), **COMPACT),
    "offset_edge_cracks": Scene(
        "Two edge cracks, one above the other, turn away from each other and overlap by 4 mm.",
        [((-40.0, 5.0), (-12.0, 5.0)), ((40.0, -5.0), (12.0, -5.0))], size=(80.0, 160.0), stress=25.0, stop=overlap(4.0), pairs=((0, 1),)),
    "double_edge_notched": Scene(
        "Two edge cracks, each curving into a hole; the plate is its own image in a half turn.",
        [((-50.0, 6.0), (-40.0, 6.0)), ((50.0, -6.0), (40.0, -6.0))], size=(100.0, 200.0),
        holes=[(-20.0, -24.0, 40.0), (20.0, 24.0, 40.0)], stress=22.0, fineness=2.0, pairs=((0, 1),)),
    "three_cracks": Scene(
        "Three collinear cracks that join (tips within 0.3 mm); stop 5 mm from an edge.",
        [((-30.0, 0.0), (-16.0, 0.0)), ((-8.0, 0.0), (8.0, 0.0)), ((12.0, 0.0), (20.0, 0.0))],
        size=(100.0, 200.0), stress=55.0, step=0.125, stop=reach_x(45.0)),
}


def write(path, text):
    """Write a file in one piece."""
    part = path.with_suffix(path.suffix + ".part")
    part.write_text(text)
    os.replace(part, path)


def run_scene(name, scene, folder, halves, note, save=True):
    """Grow a scene, with steps and elements divided by `halves`, and write its CSV (and TOML) into a folder."""
    clock = time.time()
    step = scene.step / halves
    settings = Run(step, 0.2 * step, 0.5 * step, scene.fineness * halves, scene.stop, scene.pairs, note)
    rows, notes = grow(scene.plate(), scene.start(), Law(), settings)
    comments = [f"# {at:.1f} cycles: {text}" for at, text in notes]
    if save:
        body = ["cycles,tip,x_mm,y_mm,k_i_mpa_sqrt_m,k_ii_mpa_sqrt_m"]
        body += [",".join([f"{row[0]:.1f}", str(row[1])] + [f"{round(value, 4) + 0.0:.4f}" for value in row[2:]]) for row in rows]
        folder.mkdir(parents=True, exist_ok=True)
        write(folder / f"{name}.toml", scene.toml(name) + "\n".join([""] + comments) + "\n")
        write(folder / f"{name}.csv", "\n".join(body) + "\n")
    print(f"== {name}: life {rows[-1][0]:.1f} cycles, {len(rows)} rows, {time.time() - clock:.0f} s")
    for comment in comments:
        print("  ", comment)
    for tip in sorted({row[1] for row in rows}):
        last = [row for row in rows if row[1] == tip][-1]
        print(f"   tip {tip}: {last[0]:.1f} cycles at ({last[2]:.3f}, {last[3]:.3f}), K_I {last[4]:.2f} K_II {last[5]:.2f}", flush=True)
    return rows, notes


def shifted(scene, up):
    """The scene with its free holes (not those of pins) moved up, or from the middle if symmetric, by a distance in mm."""
    pins = [hole for hole, _, _ in scene.pins]
    holes = [(x, y if number in pins else y + (up * np.sign(y) if scene.pairs else up), d) for number, (x, y, d) in enumerate(scene.holes)]
    return replace(scene, holes=holes)


if __name__ == "__main__":
    options = [word for word in sys.argv[1:] if word.startswith("--")]
    quiet = (lambda text: None) if "--quiet" in options else (lambda text: print(text, flush=True))
    for name in [word for word in sys.argv[1:] if word not in options] or SCENES:
        if "--shift" in options:
            for up in (-0.3, 0.3):
                print(f"holes moved by {up:+} mm")
                run_scene(name, shifted(SCENES[name], up), HERE, 1, quiet, save=False)
        elif "--half" in options:
            run_scene(name, SCENES[name], HERE / "half", 2, quiet)
        else:
            run_scene(name, SCENES[name], HERE, 1, quiet)
