"""K of standard specimens by finite elements, to compare lives with: writes standard_specimens.csv."""
import csv
import os
from pathlib import Path

import numpy as np

from fracture_fe import Crack, Plate, analyse
from verify import pulled

HERE = Path(__file__).resolve().parents[2] / "data" / "reference"


def middle_tension(a):
    """M(T), W = 100 mm, L = 300 mm, half length a in mm, 100 MPa."""
    return pulled(100, 300, 100.0), [Crack(np.array([[-a, 0], [a, 0.0]]), (0, 1))]


def compact_tension(a):
    """C(T), W = 50 mm, B = 10 mm, proportions of ASTM E647, pins of 0.24 W over 15 degrees to both sides, 10 kN."""
    width, half = 50.0, 30.0
    corners = np.array([[-0.25 * width, -half], [width, -half], [width, half], [-0.25 * width, half]])
    pins = [(0, (0, 1), 1e4, np.radians(15)), (1, (0, -1), 1e4, np.radians(15))]
    plate = Plate(corners, 10.0, [(0, 0.275 * width, 0.125 * width), (0, -0.275 * width, 0.125 * width)], [], pins)
    return plate, [Crack(np.array([[-0.25 * width, 0.0], [a, 0.0]]), (None, 0))]


def single_edge_tension(a):
    """SE(T), W = 50 mm, L = 150 mm, uniform stress of 100 MPa, ends free to turn."""
    return pulled(50, 150, 100.0), [Crack(np.array([[-25, 0], [-25 + a, 0.0]]), (None, 0))]


def double_edge_tension(a):
    """DE(T), W = 100 mm, L = 300 mm, both cracks of length a in mm, 100 MPa."""
    cracks = [Crack(np.array([[-50, 0], [-50 + a, 0.0]]), (None, 0)), Crack(np.array([[50, 0], [50 - a, 0.0]]), (None, 1))]
    return pulled(100, 300, 100.0), cracks


SPECIMENS = {
    "middle_tension": (middle_tension, np.arange(10, 38.1, 4)),
    "compact_tension": (compact_tension, np.arange(15, 35.1, 2.5)),
    "single_edge_tension": (single_edge_tension, np.arange(8, 28.1, 2.5)),
    "double_edge_tension": (double_edge_tension, np.r_[12:37:4, 38.0]),
}

if __name__ == "__main__":
    path = HERE / "standard_specimens.csv"
    with open(path.with_suffix(".part"), "w", newline="") as out:
        table = csv.writer(out, lineterminator="\n")
        table.writerow(["specimen", "crack_length_mm", "k_i_mpa_sqrt_m"])
        for name, (build, lengths) in SPECIMENS.items():
            for a in lengths:
                tips = analyse(*build(float(a)))
                table.writerow([name, f"{a:.2f}", f"{np.mean([tip.k_i for tip in tips.values()]):.5f}"])
    os.replace(path.with_suffix(".part"), path)
