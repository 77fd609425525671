"""Check the stress intensity factors and the life against formulas; prints one line per check."""
import time

import numpy as np
from scipy.integrate import trapezoid
from scipy.special import ellipe, ellipk

from fracture_fe import Crack, Plate, analyse
from grow import Law, Run, grow


def rectangle(width, length):
    """Corners in mm of a rectangle about the origin, counter-clockwise from the lower left."""
    return np.array([[-width, -length], [width, -length], [width, length], [-width, length]]) / 2.0


def pulled(width, length, stress, **more):
    """A rectangular plate (mm) pulled at top and bottom by a stress in MPa."""
    x, y = width / 2, length / 2
    loads = [((-x, y), (x, y), (0, stress)), ((-x, -y), (x, -y), (0, -stress))]
    return Plate(rectangle(width, length), 2.0, edge_loads=loads, **more)


def tada(stress, a, width):
    """K in MPa sqrt(m) of a centre crack 2a mm (Tada, Paris and Irwin 1973)."""
    x = 2 * a / width
    return stress * np.sqrt(np.pi * a / 1000 / np.cos(np.pi * x / 2)) * (1 - 0.025 * x**2 + 0.06 * x**4)


def check_intensities(fineness):
    """Print K of centre cracks, straight and slanted, over the formulas."""
    for a in (10.0, 20.0, 35.0):
        start = time.time()
        tips = analyse(pulled(100, 300, 100.0), [Crack(np.array([[-a, 0], [a, 0.0]]), (0, 1))], fineness)
        print(f"M(T) 2a/W = {a / 50:.1f}: K/Tada {[round(float(t.k_i / tada(100, a, 100)), 5) for t in tips.values()]}, "
              f"K_II/K_I {[round(t.k_ii / t.k_i, 6) for t in tips.values()]}, {time.time() - start:.1f} s")
    half = 10 / np.sqrt(2)
    tips = analyse(pulled(800, 800, 100.0), [Crack(np.array([[-half, -half], [half, half]]), (0, 1))], fineness)
    exact = 50 * np.sqrt(np.pi * 0.01)
    print(f"slant 45 deg, 2a/W = 1/40: K_I, K_II over exact {[(round(float(t.k_i / exact), 5), round(float(t.k_ii / exact), 5)) for t in tips.values()]}")


def point(x, y, force):
    """A force in N up at a place in mm of the edge of a beam 10 mm thick, spread over 0.2 mm."""
    return (x - 0.1, y), (x + 0.1, y), (0, force / (0.2 * 10.0))


def check_other_plates(fineness):
    """Print K of a compact specimen, of edge cracks in tension and bending and of two collinear cracks over the formulas."""
    force, width, thickness, a = 4000.0, 50.0, 8.0, 25.0
    corners = np.array([[-12.5, -30.0], [50.0, -30.0], [50.0, 30.0], [-12.5, 30.0]])
    pins = [(0, (0, 1), force, np.radians(15)), (1, (0, -1), force, np.radians(15))]
    plate = Plate(corners, thickness, [(0, 13.75, 6.25), (0, -13.75, 6.25)], [], pins)
    k = analyse(plate, [Crack(np.array([[-12.5, 0.0], [a, 0.0]]), (None, 0))], fineness)[0].k_i
    x = a / width
    form = (2 + x) / (1 - x) ** 1.5 * (0.886 + 4.64 * x - 13.32 * x**2 + 14.72 * x**3 - 5.6 * x**4)
    print(f"compact tension a/W = 0.5 (ASTM E647; pins over 15 deg): {k / (force / thickness / np.sqrt(width) * form / np.sqrt(1000)):.5f}")

    for x, tension, bending in ((0.2, 1.3673, 1.0553), (0.4, 2.1114, 1.2606), (0.5, 2.8246, 1.4972)):
        root = 100.0 * np.sqrt(np.pi * 40.0 * x / 1000)
        k = analyse(pulled(40, 240, 100.0), [Crack(np.array([[-20, 0], [-20 + 40 * x, 0.0]]), (None, 0))], fineness)[0].k_i
        corners = np.array([[-170.0, 0.0], [170.0, 0.0], [170.0, 40.0], [-170.0, 40.0]])
        force = 100.0 * 10.0 * 40.0**2 / 6 / 80.0
        crack = [Crack(np.array([[0.0, 0.0], [0.0, 40 * x]]), (None, 0))]
        four = [point(-80, 40, -force), point(80, 40, -force), point(-160, 0, force), point(160, 0, force)]
        k_four = analyse(Plate(corners, 10.0, [], four), crack, fineness)[0].k_i
        three = [point(0, 40, -force), point(-80, 0, force / 2), point(80, 0, force / 2)]
        k_three = analyse(Plate(corners, 10.0, [], three), crack, fineness)[0].k_i
        form = 1.090 - 1.735 * x + 8.20 * x**2 - 14.18 * x**3 + 14.57 * x**4
        print(f"edge crack a/W = {x} (Kaya and Erdogan 1987): tension {k / root / tension:.5f}, pure bending {k_four / root / bending:.5f}; "
              f"three-point bending S/W = 4 (Brown and Srawley 1966) {k_three / (0.5 * root) / form:.5f}")

    b, c, stress = 1.0, 11.0, 100.0
    tips = analyse(pulled(800, 800, stress), [Crack(np.array([[-c, 0], [-b, 0.0]]), (0, 1)), Crack(np.array([[b, 0], [c, 0.0]]), (2, 3))], fineness)
    m = 1 - (b / c) ** 2
    square = c**2 * ellipe(m) / ellipk(m)
    exact = [stress * (square - b**2) * np.sqrt(np.pi / b / (c**2 - b**2) / 1000), stress * (c**2 - square) * np.sqrt(np.pi / c / (c**2 - b**2) / 1000)]
    print(f"two collinear cracks 1 to 11 mm from the middle (Willmore 1949): inner {tips[2].k_i / exact[0]:.5f}, outer {tips[3].k_i / exact[1]:.5f}")


def check_life():
    """Print the life of an M(T) by growth over that by quadrature of Tada's formula."""
    law, x = Law(), np.linspace(10.0, 35.0, 20001)
    exact = trapezoid([1 / law.rate(tada(60.0, a, 100)) for a in x], x)
    for step in (1.0, 0.5):
        run = Run(step=step, stop=lambda tips: 35.0 - max(abs(p[0]) for p in tips.values()), note=lambda text: None)
        rows, _ = grow(pulled(100, 300, 60.0), [Crack(np.array([[-10, 0], [10, 0.0]]), (0, 1))], law, run)
        ends = [row[2:4] for row in rows[-2:]]
        print(f"M(T) life 2a = 20 to 70 mm, step {step}: {rows[-1][0]:.1f} over {exact:.1f} = {rows[-1][0] / exact:.5f}, ends {np.round(ends, 4).tolist()}")


if __name__ == "__main__":
    for fineness in (1.0, 2.0):
        print(f"fineness {fineness:g}")
        check_intensities(fineness)
        check_other_plates(fineness)
    check_life()
