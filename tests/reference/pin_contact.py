"""K of plates whose pins touch their holes as elasticity says. `python pin_contact.py [NAME ...]` prints contact and K of every scene.

Plate and pins are meshed by six-node triangles, the plate with tips as in fracture_fe.py, every pin as a disc of rings whose rim has the
angles of the nodes on its hole, held by a force at its middle. Unit pressures and unit shears on each side of the rims give, by the factors
of both meshes, the mean gap and slip of every side. Unknown are pressure and shear of every side and the motion and turn of every pin: no
overlap, no pull, |q| <= mu p (Coulomb, one step from no load to the largest), the force of each pin along its direction, none across it, no
moment. They are found by a semismooth Newton method. K is that of the interaction integral under these tractions.
Units: mm, N, MPa; K in MPa sqrt(m).
"""
import sys
import time

import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri, MeshTri2
from skfem.helpers import ddot, dot, sym_grad, trace

from fracture_fe import Crack, Plate, build_mesh, solve, stress_intensity
from standard import compact_tension


def factor_of(mesh, young, poisson, held):
    """Basis of a mesh, and a function that solves for loads with three degrees of freedom held."""
    shear, lame = young / (2 + 2 * poisson), young * poisson / (1 - poisson**2)
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)

    @BilinearForm
    def stiffness(u, v, w):
        """Strain energy density in MPa."""
        a, b = sym_grad(u), sym_grad(v)
        return 2 * shear * ddot(a, b) + lame * trace(a) * trace(b)

    matrix = stiffness.assemble(basis).tocsc()
    dofs = [basis.nodal_dofs[part, node] for part, node in held]
    free = np.setdiff1d(np.arange(basis.N), dofs)
    factors = splu(matrix[free][:, free], permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    def solved(load):
        """Displacements in mm."""
        result = np.zeros(load.shape)
        result[free] = factors.solve(load[free])
        return result
    return basis, solved


def sides_of(mesh, centre, radius):
    """Facets on a circle with the angles of their ends, rad."""
    rims = mesh.boundary_facets()
    ends = mesh.p[:, mesh.facets[:, rims]] - np.array(centre)[:, None, None]
    on = (np.abs(np.hypot(*ends) - radius) < 1e-6).all(axis=0)
    return rims[on], np.arctan2(ends[1][:, on], ends[0][:, on])


@LinearForm
def push(v, w):
    """Power of a traction."""
    return dot(w["traction"], v)


def unit_loads(mesh, facets, centre):
    """Loads of a unit traction outwards, and along the rim counter-clockwise, on every facet: two columns a facet."""
    columns = []
    for facet in facets:
        side = FacetBasis(mesh, ElementVector(ElementTriP2()), facets=np.array([facet]), intorder=6)
        ray = side.global_coordinates().value - np.array(centre)[:, None, None]
        ray = ray / np.hypot(*ray)
        columns += [push.assemble(side, traction=ray), push.assemble(side, traction=np.array([-ray[1], ray[0]]))]
    return np.array(columns, order="C").T


def disc(radius, angles):
    """A disc whose rim has nodes at these angles, rising; node 0 is its middle."""
    n, radii, step = len(angles), [radius], radius * 2 * np.pi / len(angles)
    while radii[-1] > 0.02 * radius:
        radii.append(max(radii[-1] - step, 0.0))
        step = min(1.2 * step, 0.12 * radius, max(0.35 * radii[-1], 0.01 * radius))
    radii = [r for r in radii[::-1] if r > 0.01 * radius]
    points = np.vstack([[[0.0, 0.0]]] + [r * np.c_[np.cos(angles), np.sin(angles)] for r in radii])
    triangles = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    for ring in range(len(radii) - 1):
        inner, outer = 1 + ring * n, 1 + (ring + 1) * n
        for k in range(n):
            a, b, c, d = inner + k, outer + k, outer + (k + 1) % n, inner + (k + 1) % n
            triangles += [(a, b, c), (a, c, d)]
    mesh = MeshTri2.from_mesh(MeshTri(points.T.copy(), np.array(triangles).T.copy()))
    places, rims = mesh.doflocs.copy(), mesh.boundary_facets()
    middle = mesh.dofs.facet_dofs[0][rims]
    places[:, middle] *= radius / np.hypot(*places[:, middle])
    return MeshTri2(doflocs=places, t=mesh.t)


def contact(plate, cracks, pins, friction, fineness=1.0, reach=165.0):
    """K by tip, and half angles in degrees, of a plate with pins (hole, direction, force N, radius, E, poisson)."""
    mesh, discs, members = build_mesh(plate, cracks, fineness)
    corner = [int(np.argmin(np.sum((mesh.p[:, :mesh.nvertices].T - c) ** 2, axis=1))) for c in plate.outline[:2]]
    basis, solved = factor_of(mesh, plate.youngs_modulus, plate.poisson_ratio, [(0, corner[0]), (1, corner[0]), (1, corner[1])])
    loads, own, turns, lengths, gaps = [], [], [], [], []
    for hole, direction, force, radius, young, poisson in pins:
        x, y, rim = plate.holes[hole]
        facets, ends = sides_of(mesh, (x, y), rim)
        towards = np.arctan2(direction[1], direction[0])
        turn = lambda angle: np.angle(np.exp(1j * (angle - towards)))
        middle = np.angle(np.exp(1j * ends).sum(axis=0))
        near = np.abs(np.degrees(turn(middle))) < reach
        facets, middle = facets[near], middle[near]
        loads.append(unit_loads(mesh, facets, (x, y)))
        whole = np.sort(np.unique(np.round(ends.ravel(), 9) % (2 * np.pi)))
        whole = whole[np.r_[True, np.diff(whole) > 1e-6]]
        body = disc(radius, whole)
        rim_of_pin, ends_of_pin = sides_of(body, (0, 0), radius)
        middle_of_pin = np.angle(np.exp(1j * ends_of_pin).sum(axis=0))
        match = [int(np.argmin(np.abs(np.exp(1j * middle_of_pin) - np.exp(1j * m)))) for m in middle]
        basis_of_pin, solved_pin = factor_of(body, young, poisson, [(0, 0), (1, 0), (1, 1)])
        on_pin = unit_loads(body, rim_of_pin[match], (0, 0))
        length = np.array([np.ptp(np.unwrap(ends[:, near][:, k])) * rim for k in range(len(facets))])
        # A traction on a pin acts against that on the plate.
        own.append((on_pin.T @ solved_pin(on_pin)) / np.repeat(length, 2)[:, None] * (rim / radius) ** 2)
        clear = rim - radius
        angle = turn(middle)
        gaps.append(rim - clear * np.cos(angle) - np.sqrt(radius**2 - (clear * np.sin(angle)) ** 2))
        turns.append(angle)
        lengths.append(length)
    load = np.hstack(loads)
    length = np.concatenate(lengths)
    field = solved(load)
    compliance = load.T @ field / np.repeat(length, 2)[:, None]
    start = 0
    for block in own:
        compliance[start:start + len(block), start:start + len(block)] += block
        start += len(block)
    angle, gap = np.concatenate(turns), np.concatenate(gaps)
    n, of_pin = len(angle), np.repeat(np.arange(len(pins)), [len(t) for t in turns])
    motion = 3 if friction else 2
    rigid = np.zeros((2 * n, motion * len(pins)))
    for k in range(n):
        c, s = np.cos(angle[k]), np.sin(angle[k])
        rigid[2 * k, motion * of_pin[k]:motion * of_pin[k] + motion] = (c, s, 0)[:motion]
        rigid[2 * k + 1, motion * of_pin[k]:motion * of_pin[k] + motion] = (-s, c, 1)[:motion]
    wanted = np.zeros(motion * len(pins))
    wanted[::motion] = [force / plate.thickness for _, _, force, *_ in pins]
    closed, slips = np.abs(angle) < 0.8, np.zeros(n)
    for turn in range(200):
        rows = np.r_[2 * np.flatnonzero(closed), 2 * np.flatnonzero(closed) + 1] if friction else 2 * np.flatnonzero(closed)
        m, place = len(rows), {row: k for k, row in enumerate(rows)}
        matrix = np.block([[compliance[np.ix_(rows, rows)], -rigid[rows]],
                           [rigid[rows].T * length[rows // 2], np.zeros((rigid.shape[1],) * 2)]])
        right = np.r_[np.where(rows % 2 == 0, -gap[rows // 2], 0.0), wanted]
        for k, row in enumerate(rows):
            if row % 2 and slips[row // 2]:
                matrix[k] = 0.0
                matrix[k, k], matrix[k, place[row - 1]], right[k] = 1.0, -slips[row // 2] * friction, 0.0
        x = np.linalg.solve(matrix, right)
        traction = np.zeros(2 * n)
        traction[rows] = x[:m]
        between = compliance @ traction - rigid @ x[m:]
        p, q, g, slip = traction[::2], traction[1::2], gap + between[::2], between[1::2]
        new = np.where(closed, p > 0, g < -1e-12)
        state = np.where(slips != 0, np.where(slips * slip > 1e-12, 0.0, slips), np.where(np.abs(q) > friction * p * (1 + 1e-9), np.sign(q), 0.0))
        state = np.where(new & closed & (friction > 0), state, 0.0)
        if (new == closed).all() and (state == slips).all():
            break
        closed, slips = new, state
    else:
        raise RuntimeError("no contact found")
    displacement = field @ traction
    k = {tip: stress_intensity(plate, mesh, displacement, d, members[tip])[0] for tip, d in discs.items()}
    ends = [np.degrees([angle[(of_pin == pin) & closed].min(), angle[(of_pin == pin) & closed].max()]) for pin in range(len(pins))]
    return k, ends, float(np.degrees(np.mean(lengths[0]) / plate.holes[0][2])), turn


def strip(crack, radius_share, friction, young=210e3, force=2e4):
    """A strip of 60 x 200 x 5 mm with pins in holes of 20 mm that pull it apart, a crack of this length, mm, at the side of one."""
    outline = np.array([[-30, -100], [30, -100], [30, 100], [-30, 100.0]])
    plate = Plate(outline, 5.0, [(0, 60, 10), (0, -60, 10)], rim_fineness=10.0)
    pins = [(hole, (0, sign), force, 10 * radius_share, young, 0.3) for hole, sign in ((0, 1), (1, -1))]
    return contact(plate, [Crack(np.array([[10, 60], [10 + crack, 60.0]]), (None, 0))], pins, friction)


def scene(a, radius_share, friction, young=210e3, force=1e4, fineness=1.0, rim=10.0):
    """C(T) of standard.py under this force with pins of this share of the radius of the hole."""
    plate, cracks = compact_tension(a)
    plate.rim_fineness = rim
    pins = [(hole, direction, force, radius_share * plate.holes[hole][2], young, 0.3) for hole, direction, *_ in plate.pin_loads]
    plate.pin_loads = []
    return contact(plate, cracks, pins, friction, fineness)


def with_arc(a, degrees):
    """K of the same with a cosine over an arc, 10 kN."""
    plate, cracks = compact_tension(a)
    plate.pin_loads = [(hole, direction, force, np.radians(degrees)) for hole, direction, force, _ in plate.pin_loads]
    mesh, discs, members = build_mesh(plate, cracks, 1.5)
    return stress_intensity(plate, mesh, solve(plate, mesh), discs[0], members[0])[0]


# Crack length mm, radius of the pin over that of the hole, friction.
SCENES = {
    "e647": (20.0, 0.96, 0.0), "e647_short": (10.0, 0.96, 0.0), "snug": (10.0, 1.0, 0.0), "close": (10.0, 0.998, 0.0),
    "snug_friction": (10.0, 1.0, 0.3), "close_friction": (10.0, 0.998, 0.3),
}
# The same of the strip.
STRIPS = {"strip_snug": (5.0, 1.0, 0.0), "strip_close": (5.0, 0.997, 0.0)}

if __name__ == "__main__":
    for a in () if sys.argv[1:] else (10.0, 20.0):
        x = a / 50.0
        formula = 1e4 / (10 * 50**0.5) * (2 + x) / (1 - x) ** 1.5 * (0.886 + 4.64 * x - 13.32 * x**2 + 14.72 * x**3 - 5.6 * x**4) / 1000**0.5
        print(f"a {a}: E647 {formula:.4f}, arcs of 15, 30, 90 degrees", *(f"{with_arc(a, arc):.4f}" for arc in (15, 30, 90)), flush=True)
    for name in sys.argv[1:] or [*SCENES, *STRIPS]:
        clock = time.time()
        k, ends, side, turns = scene(*SCENES[name]) if name in SCENES else strip(*STRIPS[name])
        words = "; ".join(f"{low:.1f} to {high:.1f}" for low, high in ends)
        print(f"{name}: K {k[0]:.4f}, contact {words} degrees, sides of {side:.2f}, {turns} turns, {time.time() - clock:.0f} s", flush=True)
