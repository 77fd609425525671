"""K of plates whose pins touch their holes as elasticity says. `python pin_contact.py [NAME ...]` prints contact and K of every scene.

Plate and pins are meshed by six-node triangles, the plate with tips as in fracture_fe.py, every pin as a disc of rings whose rim has the
angles of the nodes on its hole, held by a force at its middle. Unit pressures and unit shears on each side of the rims give, by the factors
of both meshes, the mean gap and slip of every side. Unknown are pressure and shear of every side and the motion and turn of every pin: no
overlap, no pull, |q| <= mu p (Coulomb, one step from no load to the largest), the force of each pin along its direction, none across it, no
moment. With the bound of |q| given, tractions are those of least complementary energy, found by interior points (Mehrotra 1992); the bound
is that of the pressure before, from no friction on, until it no longer changes. K is that of the interaction integral under these tractions.
A crack may begin at the rim of a pin, at a node of the rim of both bodies: contact goes on beyond its mouth. Sides away from a hole may be held.
Units: mm, N, MPa; K in MPa sqrt(m).
"""
import sys
import time

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri, MeshTri2
from skfem.helpers import ddot, dot, sym_grad, trace

from fracture_fe import Crack, Plate, build_mesh, distance_to_segments, solve, stress_intensity
from standard import compact_tension


def factor_of(mesh, young, poisson, held, edge=None):
    """Basis of a mesh, and a function that solves for loads with degrees of freedom held: (part, node), or all on an edge (start, end)."""
    shear, lame = young / (2 + 2 * poisson), young * poisson / (1 - poisson**2)
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=4)

    @BilinearForm
    def stiffness(u, v, w):
        """Strain energy density in MPa."""
        a, b = sym_grad(u), sym_grad(v)
        return 2 * shear * ddot(a, b) + lame * trace(a) * trace(b)

    matrix = stiffness.assemble(basis).tocsc()
    dofs = [basis.nodal_dofs[part, node] for part, node in held]
    if edge is not None:
        rims, ends = mesh.boundary_facets(), [np.array([end], float) for end in edge]
        off = np.max([distance_to_segments(mesh.p[:, mesh.facets[k, rims]].T[:, None].reshape(-1, 2), *ends) for k in (0, 1)], axis=0)
        dofs = basis.get_dofs(rims[off < 1e-7]).all()
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
    sides = FacetBasis(mesh, ElementVector(ElementTriP2()), facets=facets, intorder=6)
    ray = sides.global_coordinates().value - np.array(centre)[:, None, None]
    ray = ray / np.hypot(*ray)
    columns = np.zeros((sides.N, 2 * len(facets)))
    for part, traction in enumerate((ray, np.array([-ray[1], ray[0]]))):
        data = push.coo_data(sides, traction=traction)
        facet = np.tile(np.arange(len(facets)), len(data.data) // len(facets))
        np.add.at(columns, (data.indices[0], 2 * facet + part), data.data)
    return columns


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


def least_energy(stiff, constant, motions, wanted, bound):
    """x of least x stiff x / 2 + constant x with motions' x = wanted, every even x >= 0, every odd |x| <= bound; no odd x without bound."""
    use = np.arange(len(constant)) % 2 == 0 if bound is None else np.ones(len(constant), bool)
    stiff, constant, motions = stiff[np.ix_(use, use)], constant[use], motions[use]
    place, n = np.arange(len(constant)), len(use) // 2
    even, odd = (place, place[:0]) if bound is None else (place[::2], place[1::2])
    # sign x + slack = limit, slack >= 0, with the multipliers z >= 0.
    at, sign = np.r_[even, odd, odd], np.r_[-np.ones(n), np.ones(len(odd)), -np.ones(len(odd))]
    limit = np.zeros(n) if bound is None else np.r_[np.zeros(n), bound, bound]
    x, y, slack, z = np.zeros(len(place)), np.zeros(motions.shape[1]), np.ones(len(at)), np.ones(len(at))
    on_all = lambda v: np.bincount(at, sign * v, len(place))
    longest = lambda v, step: min(1.0, (-v[step < 0] / step[step < 0]).min(initial=np.inf))
    for _ in range(100):
        force, miss, balance = stiff @ x + constant + on_all(z) - motions @ y, sign * x[at] + slack - limit, motions.T @ x - wanted
        mean = slack @ z / len(at)
        if max(np.abs(force).max(), np.abs(miss).max(), np.abs(balance).max()) < 1e-10 and mean < 1e-13:
            result = np.zeros(2 * n)
            result[use] = x
            return result
        matrix = stiff.copy()
        np.add.at(matrix, (at, at), z / slack)
        factors = lu_factor(np.block([[matrix, -motions], [motions.T, np.zeros((len(y),) * 2)]]))

        def step(product):
            """Steps of x, y, slack and z towards slack z = 0, from a product of both that is too large."""
            moved = lu_solve(factors, np.r_[-force - on_all((z * miss - product) / slack), -balance])
            of_slack = -miss - sign * moved[:len(x)][at]
            return moved[:len(x)], moved[len(x):], of_slack, (-product - z * of_slack) / slack

        *_, of_slack, of_z = step(slack * z)
        ahead = (slack + longest(slack, of_slack) * of_slack) @ (z + longest(z, of_z) * of_z) / len(at)
        of_x, of_y, of_slack, of_z = step(slack * z + of_slack * of_z - ahead**3 / mean**2)
        share = min(1.0, 0.995 * min(longest(slack, of_slack), longest(z, of_z)))
        x, y, slack, z = x + share * of_x, y + share * of_y, slack + share * of_slack, z + share * of_z
    raise RuntimeError("interior points find no contact")


def contact(plate, cracks, pins, friction, fineness=1.0, reach=165.0, edge=None):
    """K_I and K_II by tip, and half angles in degrees, of a plate with pins (hole, direction, force N, radius, E, poisson), its edge (start, end) held."""
    mesh, discs, members = build_mesh(plate, cracks, fineness)
    corner = [int(np.argmin(np.sum((mesh.p[:, :mesh.nvertices].T - c) ** 2, axis=1))) for c in plate.outline[:2]]
    basis, solved = factor_of(mesh, plate.youngs_modulus, plate.poisson_ratio, [(0, corner[0]), (1, corner[0]), (1, corner[1])], edge)
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
    rigid = np.zeros((2 * n, 3 * len(pins)))
    for k in range(n):
        c, s = np.cos(angle[k]), np.sin(angle[k])
        rigid[2 * k, 3 * of_pin[k]:3 * of_pin[k] + 3] = c, s, 0
        rigid[2 * k + 1, 3 * of_pin[k]:3 * of_pin[k] + 3] = -s, c, 1
    wanted = np.zeros(3 * len(pins))
    wanted[::3] = [force / plate.thickness for _, _, force, *_ in pins]
    # Tractions over their scale, forces over that and the mean length, energy over the mean compliance.
    scale, mean = np.abs(wanted).max() / length.sum(), length.mean()
    energy = compliance * np.repeat(length, 2)[:, None]
    unit = np.diag(energy).mean()
    stiff, constant = 0.5 * (energy + energy.T) / unit, np.zeros(2 * n)
    constant[::2] = gap * length / (unit * scale)
    motions, wanted, moves = rigid * np.repeat(length, 2)[:, None] / mean, wanted / (mean * scale), np.arange(3 * len(pins)) % 3 < 2
    x = least_energy(stiff, constant, motions[:, moves], wanted[moves], None)
    turn, change = 0, 1.0 if friction else 0.0
    while change > 1e-5:
        before, x = x, least_energy(stiff, constant, motions, wanted, np.maximum(friction * x[::2], 1e-7))
        turn, change = turn + 1, np.abs(x - before)[::2].max() / x[::2].max()
        if turn == 100:
            raise RuntimeError("the bound of friction does not settle")
    traction = x * scale
    closed = x[::2] > 1e-4 * x[::2].max()
    displacement = field @ traction
    k = {tip: stress_intensity(plate, mesh, displacement, d, members[tip]) for tip, d in discs.items()}
    ends = [np.degrees([angle[(of_pin == pin) & closed].min(), angle[(of_pin == pin) & closed].max()]) for pin in range(len(pins))]
    return k, ends, float(np.degrees(np.mean(lengths[0]) / plate.holes[0][2])), turn


def lug(crack, radius_share, friction, fineness=1.0, rim=10.0, young=210e3, force=1e4):
    """A lug of 50 x 5 mm with a round head, a hole of 20 mm, a crack of this length, mm, at its right side, held 100 mm below by an edge."""
    head = np.radians(np.arange(0, 181, 2))
    outline = np.vstack([[[-25, -100], [25, -100.0]], 25 * np.c_[np.cos(head), np.sin(head)]])
    plate = Plate(outline, 5.0, [(0, 0, 10)], rim_fineness=rim)
    pins = [(0, (0, 1), force, 10 * radius_share, young, 0.3)]
    cracks = [Crack(np.array([[10, 0], [10 + crack, 0.0]]), (None, 0))]
    return contact(plate, cracks, pins, friction, fineness, edge=outline[:2])


def strip(crack, radius_share, friction, young=210e3, force=2e4):
    """A strip of 60 x 200 x 5 mm with pins in holes of 20 mm that pull it apart, a crack of this length, mm, at the side of one."""
    outline = np.array([[-30, -100], [30, -100], [30, 100], [-30, 100.0]])
    plate = Plate(outline, 5.0, [(0, 60, 10), (0, -60, 10)], rim_fineness=10.0)
    pins = [(hole, (0, sign), force, 10 * radius_share, young, 0.3) for hole, sign in ((0, 1), (1, -1))]
    return contact(plate, [Crack(np.array([[10, 60], [10 + crack, 60.0]]), (None, 0))], pins, friction)


def example(a, friction, fineness=1.0, rim=10.0):
    """C(T) and pins of data/cases/compact_with_pins.toml."""
    plate, cracks = compact_tension(a)
    size = 50.8 / 50.0
    plate.outline, plate.holes, plate.thickness = plate.outline * size, [tuple(size * x for x in hole) for hole in plate.holes], 6.35
    plate.youngs_modulus, plate.poisson_ratio, plate.rim_fineness, plate.pin_loads = 73.1e3, 0.33, rim, []
    cracks[0].points[0] *= size
    return contact(plate, cracks, [(0, (0, 1), 2500, 6.325, 210e3, 0.3), (1, (0, -1), 2500, 6.325, 210e3, 0.3)], friction, fineness)


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


# Crack length mm, radius of the pin over that of the hole (but for `example`), friction.
SCENES = {
    "e647": (scene, 20.0, 0.96, 0.0), "e647_short": (scene, 10.0, 0.96, 0.0), "snug": (scene, 10.0, 1.0, 0.0), "close": (scene, 10.0, 0.998, 0.0),
    "snug_friction": (scene, 10.0, 1.0, 0.3), "close_friction": (scene, 10.0, 0.998, 0.3),
    "strip_snug": (strip, 5.0, 1.0, 0.0), "strip_close": (strip, 5.0, 0.997, 0.0),
    **{f"example_{a}_{friction}": (example, a, friction) for a in (20.32, 30.48) for friction in (0.0, 0.1, 0.3)},
    **{f"lug_{share}_{crack}_{friction}": (lug, crack, share, friction)
       for share in (0.9975, 1.0) for crack in (3.0, 7.5, 12.0) for friction in (0.0, 0.2)},
}

if __name__ == "__main__":
    for a in () if sys.argv[1:] else (10.0, 20.0):
        x = a / 50.0
        formula = 1e4 / (10 * 50**0.5) * (2 + x) / (1 - x) ** 1.5 * (0.886 + 4.64 * x - 13.32 * x**2 + 14.72 * x**3 - 5.6 * x**4) / 1000**0.5
        print(f"a {a}: E647 {formula:.4f}, arcs of 15, 30, 90 degrees", *(f"{with_arc(a, arc):.4f}" for arc in (15, 30, 90)), flush=True)
    for name in sys.argv[1:] or SCENES:
        clock, (make, *given) = time.time(), SCENES[name]
        k, ends, side, turns = make(*given)
        words = "; ".join(f"{low:.1f} to {high:.1f}" for low, high in ends)
        answer = f"{name}: K_I {k[0][0]:.4f}, K_II {k[0][1]:.4f}, contact {words} degrees, sides of {side:.2f}"
        print(f"{answer}, {turns} bounds of friction, {time.time() - clock:.0f} s", flush=True)
