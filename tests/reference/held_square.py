"""Griffith's load of the held square of `perilife verify scene_strength` (1 mm, cracked to its middle, plane strain, E 210 GPa, G_c 2.7 N/mm):
energy release from the energies of cuts an element longer and shorter. Upper half, four-node elements with Wilson's bending modes.

    python held_square.py        # prints Poisson's ratio, displacement in mm, load in N
"""

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import spsolve

YOUNG, TOUGHNESS, SIDE = 210e3, 2.7, 200  # N/mm², N/mm, elements a side


def element(nu, h):
    """Stiffness of a square element, the bending modes condensed."""
    scale = YOUNG / ((1 + nu) * (1 - 2 * nu))
    law = scale * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, (1 - 2 * nu) / 2]])
    whole = np.zeros((12, 12))
    sx, sy = np.array([-1, 1, 1, -1]), np.array([-1, -1, 1, 1])
    for x in (-(3**-0.5), 3**-0.5):
        for y in (-(3**-0.5), 3**-0.5):
            dx, dy = sx * (1 + y * sy) / (2 * h), sy * (1 + x * sx) / (2 * h)
            b = np.zeros((3, 12))
            b[0, 0:8:2] = b[2, 1:8:2] = dx
            b[1, 1:8:2] = b[2, 0:8:2] = dy
            b[0, 8] = b[2, 10] = -4 * x / h
            b[1, 11] = b[2, 9] = -4 * y / h
            whole += h * h / 4 * b.T @ law @ b
    return whole[:8, :8] - whole[:8, 8:] @ np.linalg.solve(whole[8:, 8:], whole[8:, :8])


def energy(nu, crack):
    """Strain energy of the whole square at a displacement of 1 mm, N mm per mm; the crack is so many elements long."""
    nx, ny = SIDE, SIDE // 2
    cells = np.arange(nx * ny)
    first = cells % nx + cells // nx * (nx + 1)
    corners = np.stack([first, first + 1, first + nx + 2, first + nx + 1], 1)
    dofs = np.stack([2 * corners, 2 * corners + 1], 2).reshape(-1, 8)
    values = np.tile(element(nu, 1 / SIDE).ravel(), nx * ny)
    matrix = sparse.coo_matrix((values, (np.repeat(dofs, 8, 1).ravel(), np.tile(dofs, (1, 8)).ravel()))).tocsc()
    u, held = np.zeros(matrix.shape[0]), np.zeros(matrix.shape[0], bool)
    top, ahead = np.arange(nx + 1) + ny * (nx + 1), np.arange(crack, nx + 1)
    held[2 * top] = held[2 * top + 1] = held[2 * ahead + 1] = True
    u[2 * top + 1] = 0.5
    u[~held] = spsolve(matrix[~held][:, ~held], -(matrix[~held] @ u))
    return u @ (matrix @ u)


if __name__ == "__main__":
    for nu in (0.1, 0.2, 0.25, 0.3):
        less, same, more = (energy(nu, SIDE // 2 + longer) for longer in (-1, 0, 1))
        opening = (TOUGHNESS / ((less - more) * SIDE / 2)) ** 0.5
        print(f"{nu} {opening:.6f} {2 * same * opening:.1f}")
