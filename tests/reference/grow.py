"""Growth of fatigue cracks by remeshing: paths and cycles.

Direction: maximum circumferential stress (Erdogan and Sih 1963); rate: Paris and Erdogan
(1963) with the equivalent K of the same criterion. One solution per step. The direction of
a step and the ratio of the tips' rates are those extrapolated to the middle of the step
from the last two solutions (second order, as Adams and Bashforth 1883); the cycles of a
step are integrated with the rate exponential in the length between two solutions.
Units: mm, MPa sqrt(m), cycles.
"""
from dataclasses import dataclass

import numpy as np

from fracture_fe import Crack, analyse, distance_to_rest

LINK_GAP = 0.3  # mm between two tips that join


@dataclass
class Law:
    """Paris law: mm/cycle with MPa sqrt(m), and the stress ratio."""
    c: float = 1e-7
    m: float = 3.0
    stress_ratio: float = 0.1

    def rate(self, k_max):
        """Growth in mm/cycle at a maximum equivalent K in MPa sqrt(m)."""
        return self.c * ((1 - self.stress_ratio) * max(k_max, 0.0)) ** self.m


def kink(k_i, k_ii):
    """Kink angle in rad and equivalent K in MPa sqrt(m) of maximum circumferential stress (Erdogan and Sih 1963)."""
    angle = 0.0 if abs(k_ii) < 1e-14 else 2 * np.arctan2(-2 * k_ii, k_i + np.hypot(k_i, np.sqrt(8) * k_ii))
    half = np.cos(angle / 2)
    return angle, half * (k_i * half**2 - 1.5 * k_ii * np.sin(angle))


@dataclass
class Run:
    """Settings of a growth run: mm, fineness of the mesh, a stop (falls to 0 with the tip positions in mm), symmetric tips."""
    step: float = 0.5
    first_step: float = 0.1
    rim_gap: float = 0.25  # ahead of a tip to a hole that it enters by straight extension
    fineness: float = 1.0
    stop: object = None
    pairs: tuple = ()  # tips that are images of each other in a half turn
    note: object = print


@dataclass
class Front:
    """State of a tip: mm, direction to grow in rad, ln of the rate; turn and gain per mm for extrapolation (0 at first)."""
    position: np.ndarray
    direction: float
    rate: float
    gap: float = np.inf  # mm ahead to a hole
    turn: float = 0.0
    gain: float = 0.0


def unit(direction):
    """Unit vector of a direction in rad."""
    return np.array([np.cos(direction), np.sin(direction)])


def gap_ahead(plate, point, direction):
    """Distance in mm along a direction (rad) to the next hole, infinite if none lies ahead."""
    nearest = np.inf
    for x, y, radius in plate.holes:
        to = np.array([x, y]) - point
        along, across = to @ unit(direction), to[0] * np.sin(direction) - to[1] * np.cos(direction)
        if along > 0 and abs(across) < radius:
            nearest = min(nearest, along - np.sqrt(radius**2 - across**2))
    return nearest


def time_of(advance, rate, gain):
    """Cycles for an advance in mm from a ln rate that changes by `gain` over it."""
    return advance * np.exp(-rate) * (-np.expm1(-gain) / gain if abs(gain) > 1e-9 else 1.0)


def where(cracks, tip):
    """Crack number and end (0 or -1) of a tip."""
    return next((n, end) for n, c in enumerate(cracks) for end, t in zip((0, -1), c.tips) if t == tip)


def extended(crack, end, point, replace=False):
    """A crack with a point in mm added at one end, or put in place of the last one there."""
    points = crack.points if end == -1 else crack.points[::-1]
    points = np.vstack([points[:-1] if replace else points, point])
    return Crack(points if end == -1 else points[::-1], crack.tips)


def advances(fronts, length):
    """(mm, direction in rad) of every tip while the leading tip goes a length in mm: values at the middle of the step."""
    lead = max(fronts, key=lambda tip: fronts[tip].rate)

    def middle(front):
        """Direction in rad and ln rate at the middle of the step."""
        half = 0.5 * length * np.exp(front.rate - fronts[lead].rate)
        return front.direction + half * front.turn, front.rate + half * front.gain

    return {tip: (length * np.exp(middle(front)[1] - middle(fronts[lead])[1]), middle(front)[0]) for tip, front in fronts.items()}


def margin(cracks, fronts, run, length):
    """Least distance in mm left to a rim, to a joint or to the stop after a step; negative if the step is too long."""
    moves = advances(fronts, length)
    moved = {tip: fronts[tip].position + mm * unit(way) for tip, (mm, way) in moves.items()}
    left = [front.gap - moves[tip][0] - run.rim_gap for tip, front in fronts.items()]
    left += [np.linalg.norm(moved[a] - moved[b]) - LINK_GAP for a in moved for b in moved
             if a < b and where(cracks, a)[0] != where(cracks, b)[0]]
    return min(left + ([run.stop(moved)] if run.stop else []))


def step_length(plate, cracks, fronts, run, step):
    """Step of the leading tip in mm: short near rims and other cracks, cut to end at a rim, a joint or the stop."""
    lead = max(front.rate for front in fronts.values())
    lines = [crack.points for crack in cracks]
    for tip, front in fronts.items():
        room = min(distance_to_rest(plate, lines, where(cracks, tip)[0], front.position), front.gap)
        nearby = max(0.3 * room, 0.1) * run.step
        step = min(step, nearby / np.exp(front.rate - lead))
    if margin(cracks, fronts, run, step) >= 0:
        return step
    low, high = 0.0, step
    for _ in range(40):
        trial = 0.5 * (low + high)
        low, high = (trial, high) if margin(cracks, fronts, run, trial) > 0 else (low, trial)
    return high


def joined(cracks, fronts):
    """Cracks after two tips that lie within the gap have become one crack, and the two tips; (None, None) if none do."""
    for a in fronts:
        for b in fronts:
            (m, end_a), (n, end_b) = where(cracks, a), where(cracks, b)
            if a < b and m != n and np.linalg.norm(fronts[a].position - fronts[b].position) < 1.001 * LINK_GAP:
                first, second = cracks[m].points[::1 if end_a == -1 else -1], cracks[n].points[::1 if end_b == 0 else -1]
                tips = cracks[m].tips[0 if end_a == -1 else 1], cracks[n].tips[1 if end_b == 0 else 0]
                rest = [crack for number, crack in enumerate(cracks) if number not in (m, n)]
                return rest + [Crack(np.vstack([first, second]), tips)], (a, b)
    return None, None


def run_into_holes(cracks, fronts, rim_gap, cycles):
    """Straight extension of the tips within reach of a rim: cracks with those ends, and (cycles, tip, position in mm)."""
    ends = []
    for tip, front in fronts.items():
        if front.gap < 1.1 * rim_gap:
            place = front.position + front.gap * unit(front.direction)
            ends.append((cycles + time_of(front.gap, front.rate, front.gain * front.gap), tip, place))
            number, end = where(cracks, tip)
            longer = extended(cracks[number], end, place)
            cracks = list(cracks)
            cracks[number] = Crack(longer.points, tuple(None if t == tip else t for t in longer.tips))
    return cracks, ends


def grow(plate, cracks, law, run):
    """Rows (cycles, tip, x mm, y mm, K_I, K_II) of the growth, and notes of (cycles, text)."""
    rows, notes, cycles = [], [], 0.0
    fronts, done, age, step, short = {}, {}, 0, run.first_step, {}
    while True:
        old, fronts = fronts, {}
        for tip, found in sorted(analyse(plate, cracks, run.fineness).items()):
            angle, k = kink(found.k_i, found.k_ii)
            fronts[tip] = Front(found.position, found.direction + angle, np.log(max(law.rate(k), 1e-30)))
            rows.append([cycles, tip, *found.position, found.k_i, found.k_ii])
        for a, b in run.pairs:
            one, two = fronts[a], fronts[b]
            one.rate = two.rate = 0.5 * (one.rate + two.rate)
            one.direction -= 0.5 * (np.mod(one.direction - two.direction, 2 * np.pi) - np.pi)
            two.direction = one.direction + np.pi
        for tip, front in fronts.items():
            front.gap = gap_ahead(plate, front.position, front.direction)
            if age > 1 and done[tip] > 0:  # the first direction after a start may jump
                front.turn = np.angle(np.exp(1j * (front.direction - old[tip].direction))) / done[tip]
                front.gain = (front.rate - old[tip].rate) / done[tip]
        if age > 0:
            lead = max(done, key=done.get)
            cycles += time_of(done[lead], old[lead].rate, fronts[lead].rate - old[lead].rate)
            for row in rows[-len(fronts):]:
                row[0] = cycles
        run.note(" ".join([f"{cycles:11.1f}"] + [f"| {r[1]}: {r[2]:.3f} {r[3]:.3f} K {r[4]:.3f} {r[5]:.3f}" for r in rows[-len(fronts):]]))

        if run.stop and run.stop({tip: front.position for tip, front in fronts.items()}) < 1e-6:
            notes.append((cycles, "stop"))
            return rows, notes
        cracks, ends = run_into_holes(cracks, fronts, run.rim_gap, cycles)
        for at, tip, place in ends:
            rows.append([at, tip, *place, *next(row[4:] for row in reversed(rows) if row[1] == tip)])
            notes.append((at, f"tip {tip} enters a hole"))
            cycles = max(cycles, at)
        merged, pair = joined(cracks, {tip: front for tip, front in fronts.items() if tip not in [end[1] for end in ends]})
        if merged:
            cracks = merged
            notes.append((cycles, f"tips {pair[0]} and {pair[1]} join"))
        if ends or merged:
            if all(tip is None for crack in cracks for tip in crack.tips):
                return rows, notes
            fronts, done, age, step, short = {}, {}, 0, run.first_step, {}
            continue

        length = step_length(plate, cracks, fronts, run, step)
        moves = advances(fronts, length)
        for tip, (mm, way) in moves.items():
            number, end = where(cracks, tip)
            cracks = list(cracks)
            cracks[number] = extended(cracks[number], end, fronts[tip].position + mm * unit(way), short.get(tip, False))
            line = cracks[number].points[::1 if end == -1 else -1]
            short[tip] = np.linalg.norm(line[-1] - line[-2]) < 0.3 * run.first_step  # its end is replaced, not added to
        done = {tip: mm for tip, (mm, _) in moves.items()}
        age += 1
        step = min(run.step, 1.3 * step) if age > 1 else step
