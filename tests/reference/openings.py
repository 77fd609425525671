"""Largest and least stress of openings in plates of 400 mm and in strips, over the stress on their edges: `python openings.py`.

A quarter of the plate between an ellipse and a rectangle is mapped by quadrilaterals of nine nodes, with sides curved on the ellipse and rings whose
width grows from it; stresses are those of the elements at its two ends. Units: mm, MPa.
"""
import numpy as np
from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, FacetBasis, LinearForm, MeshQuad, MeshQuad2, condense, solve
from skfem.helpers import ddot, sym_grad, trace

YOUNG, POISSON = 70e3, 0.3
SHEAR, LAME = YOUNG / (2 + 2 * POISSON), YOUNG * POISSON / (1 - POISSON**2)
OFF = 1e-6


def quarter(axes, size, count):
    """Mesh between the ellipse with these half axes and the sides x, y = size, with so many elements around and across."""
    (a, b), (width, height) = axes, size
    at_corner = round(count * height / (width + height))
    up, back = np.linspace(0, height, at_corner + 1), np.linspace(width, 0, count - at_corner + 1)[1:]
    outer = np.vstack([np.c_[np.full(up.size, width), up], np.c_[back, np.full(back.size, height)]])
    angles = np.linspace(0, np.pi / 2, count + 1)
    inner = np.c_[a * np.cos(angles), b * np.sin(angles)]
    across = (np.linspace(0, 1, count + 1) ** 2)[:, None, None]
    places = ((1 - across) * inner + across * outer).reshape(-1, 2)
    index = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    corners = [index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]]
    mesh = MeshQuad2.from_mesh(MeshQuad(places.T.copy(), np.array([corner.ravel() for corner in corners])))
    nodes = mesh.doflocs.copy()
    ratio = np.hypot(nodes[0] / a, nodes[1] / b)
    near = (ratio > 1 - 1 / count**2) & (ratio < 1 + OFF)
    angle = np.arctan2(nodes[1, near] / b, nodes[0, near] / a)
    nodes[:, near] = a * np.cos(angle), b * np.sin(angle)
    return MeshQuad2(nodes, mesh.t)


def stresses(axes, size, loads, is_symmetric, count):
    """Stress along the rim at (a, 0) and (0, b) under unit stress on the sides x = size and y = size times `loads`."""
    mesh, element = quarter(axes, size, count), ElementVector(ElementQuad2())
    basis = Basis(mesh, element, intorder=6)

    @BilinearForm
    def stiffness(u, v, _):
        """Strain energy density."""
        return 2 * SHEAR * ddot(sym_grad(u), sym_grad(v)) + LAME * trace(sym_grad(u)) * trace(sym_grad(v))

    force = np.zeros(basis.N)
    for part, load in enumerate(loads):
        side = mesh.facets_satisfying(lambda x, part=part: np.abs(x[part] - size[part]) < OFF, boundaries_only=True)
        pull = LinearForm(lambda v, _, part=part: v[part])
        force += load * pull.assemble(FacetBasis(mesh, element, facets=side))
    of_part = np.zeros(basis.N, int)
    for dofs in (basis.nodal_dofs, basis.facet_dofs, basis.interior_dofs):
        of_part[dofs[1::2]] = 1
    x, y = basis.doflocs
    # Half a plate with an open left side is held where its lower right corner lies, else by symmetry.
    beside = np.abs(x) < OFF if is_symmetric else np.hypot(x - size[0], y) < OFF
    held = np.flatnonzero((np.abs(y) < OFF) & (of_part == 1) | beside & (of_part == 0))
    u = solve(*condense(stiffness.assemble(basis), force, D=held))
    found = []
    # Elements of the innermost ring, the corner of each that lies at the end of the ellipse, and the stress along the rim there.
    for ring, corner, along in ((0, (0.0, 0.0), 1), (count - 1, (0.0, 1.0), 0)):
        at = Basis(mesh, element, quadrature=(np.array([corner]).T, np.ones(1)), elements=np.array([ring]))
        gradient = at.interpolate(u).grad[:, :, 0, 0]
        strain = (gradient + gradient.T) / 2
        found.append(2 * SHEAR * strain[along, along] + LAME * np.trace(strain))
    return found


if __name__ == "__main__":
    for name, axes, size, loads, is_symmetric in (
        ("hole of 20 mm, tension", (10, 10), (200, 200), (0, 1), True),
        ("hole of 20 mm, equal stresses", (10, 10), (200, 200), (1, 1), True),
        ("hole of 20 mm, shear", (10, 10), (200, 200), (-1, 1), True),
        *((f"hole of {2 * radius} mm in a strip of 100 mm", (radius, radius), (50, 150), (0, 1), True) for radius in (5, 10, 15, 20, 25)),
        ("ellipse 2:1 at the middle of 800 mm", (20, 10), (400, 200), (0, 1), True),
        ("semicircle at an edge", (10, 10), (400, 200), (0, 1), False),
    ):
        for count in (40, 80, 160):
            print(name, count, *(f"{stress:.4f}" for stress in stresses(axes, size, loads, is_symmetric, count)), flush=True)
