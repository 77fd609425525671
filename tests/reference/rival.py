"""Time of the finite elements. `python rival.py NAME ...` grows plates with the steps and elements of the reference (1) and with both
2 and 4 times as coarse, writes no file, and prints one JSON object a run: plate, coarseness, increments, wall_s, ms_per_increment,
life, error_percent of the life against NAME.csv.
"""
import json
import sys
import time

from fracture_fe import Plate  # noqa: F401  loads its libraries before the clock starts
from grow import Law, Run, grow
from plates import HERE, SCENES


def life_of(name):
    """Last cycles of the reference."""
    return max(float(line.split(",")[0]) for line in (HERE / f"{name}.csv").read_text().splitlines()[1:])


def timed(name, coarse):
    """Figures of one run."""
    scene = SCENES[name]
    step = coarse * scene.step
    settings = Run(step, 0.2 * step, 0.25, scene.fineness / coarse, scene.stop, scene.pairs, lambda text: None)
    clock = time.perf_counter()
    rows, _ = grow(scene.plate(), scene.start(), Law(), settings)
    wall = time.perf_counter() - clock
    increments = len({row[0] for row in rows})
    life = max(row[0] for row in rows)
    error = 100 * (life / life_of(name) - 1)
    return dict(plate=name, coarseness=coarse, increments=increments, wall_s=wall, ms_per_increment=1e3 * wall / increments,
                life=life, error_percent=error)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        for coarse in (1, 2, 4):
            print(json.dumps(timed(name, coarse)), flush=True)
