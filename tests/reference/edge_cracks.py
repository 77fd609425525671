"""F = K_I / (stress sqrt(pi a)) of edge cracks in plates 50 mm wide, ends pulled evenly: `python edge_cracks.py` prints length, height and F
with the elements of the reference and with elements half the size (10 seconds)."""
import numpy as np

from fracture_fe import Crack, Plate
from grow import analyse

STRESS = 60.0  # MPa

if __name__ == "__main__":
    for a, height in ((10.0, 50.0), (10.0, 200.0), (25.0, 50.0), (25.0, 200.0)):
        x, y = 25.0, height / 2
        corners = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
        loads = [(corners[0], corners[1], (0, -STRESS)), (corners[3], corners[2], (0, STRESS))]
        crack = Crack(np.array([[-x, 0.0], [a - x, 0.0]]), (None, 0))
        for fineness in (1.0, 2.0):
            found = analyse(Plate(corners, 2.0, [], loads, []), [crack], fineness)[0]
            print(f"a {a:.0f}, height {height:.0f}, fineness {fineness:.0f}: F = {found.k_i / (STRESS * np.sqrt(np.pi * a * 1e-3)):.4f}")
