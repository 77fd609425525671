"""K of plates whose pins touch their holes as elasticity says. `python pin_contact.py [NAME ...]` prints contact and K of every scene.

Plate and pins are meshed by six-node triangles, the plate with tips as in fracture_fe.py, every pin as a disc of rings whose rim has the
angles of the nodes on its hole, held by a force at its middle. Unit pressures on each side of the rims, and on both flanks of a crack from
the rim of a pin, give, by the factors of both meshes, the mean gap of every side. Unknown are the pressure of every side and the motion of
every pin: no overlap, no pull, the force of each pin along its direction, none across it. Pressures are those of least complementary energy,
found by interior points (Mehrotra 1992). K is that of the interaction integral under them.
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

# Share of a crack, from its start on, on which its flanks may press each other: short of the disc about its tip.
FLANKS = 0.6


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


def unit_loads(mesh, facets, direction):
    """Loads of a unit traction on every facet along a direction at places: a column a facet."""
    sides = FacetBasis(mesh, ElementVector(ElementTriP2()), facets=facets, intorder=6)
    columns = np.zeros((sides.N, len(facets)))
    data = push.coo_data(sides, traction=direction(sides.global_coordinates().value))
    np.add.at(columns, (data.indices[0], np.tile(np.arange(len(facets)), len(data.data) // len(facets))), data.data)
    return columns


def outwards(centre):
    """Unit vectors from a centre at places."""
    def direction(at):
        ray = at - np.array(centre)[:, None, None]
        return ray / np.hypot(*ray)
    return direction


def flanks_of(mesh, crack):
    """Loads of a unit pressure on both sides of every piece of a straight crack near its start, and lengths of the pieces."""
    start, along = crack.points[0], crack.points[-1] - crack.points[0]
    length, along = np.hypot(*along), along / np.hypot(*along)
    normal, rims = np.array([-along[1], along[0]]), mesh.boundary_facets()
    ends = (mesh.p[:, mesh.facets[:, rims]] - start[:, None, None]).transpose(1, 2, 0)
    way = ends @ along
    on = (np.abs(ends @ normal) < 1e-7).all(axis=0) & (way.min(axis=0) > -1e-7) & (way.max(axis=0) < FLANKS * length)
    facets, way, size = rims[on], way[:, on].mean(axis=0), np.ptp(way[:, on], axis=0)
    inside = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1).T - start
    left, right = (np.flatnonzero(sign * (inside @ normal) > 0) for sign in (1, -1))
    left, right = (side[np.argsort(way[side])] for side in (left, right))
    assert np.allclose(way[left], way[right])
    of_side = lambda side, sign: unit_loads(mesh, facets[side], lambda at: sign * np.broadcast_to(normal[:, None, None], at.shape))
    return of_side(left, 1) + of_side(right, -1), size[left]


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


def least_energy(stiff, constant, motions, wanted):
    """x of least x stiff x / 2 + constant x with motions' x = wanted, x >= 0."""
    x, y, slack, z = np.zeros(len(constant)), np.zeros(motions.shape[1]), np.ones(len(constant)), np.ones(len(constant))
    longest = lambda v, step: min(1.0, (-v[step < 0] / step[step < 0]).min(initial=np.inf))
    for _ in range(100):
        force, miss, balance = stiff @ x + constant - z - motions @ y, slack - x, motions.T @ x - wanted
        mean = slack @ z / len(x)
        if max(np.abs(force).max(), np.abs(miss).max(), np.abs(balance).max()) < 1e-10 and mean < 1e-13:
            return x
        factors = lu_factor(np.block([[stiff + np.diag(z / slack), -motions], [motions.T, np.zeros((len(y),) * 2)]]))

        def step(product):
            """Steps of x, y, slack and z towards slack z = 0, from a product of both that is too large."""
            moved = lu_solve(factors, np.r_[-force + (z * miss - product) / slack, -balance])
            of_slack = moved[:len(x)] - miss
            return moved[:len(x)], moved[len(x):], of_slack, (-product - z * of_slack) / slack

        *_, of_slack, of_z = step(slack * z)
        ahead = (slack + longest(slack, of_slack) * of_slack) @ (z + longest(z, of_z) * of_z) / len(x)
        of_x, of_y, of_slack, of_z = step(slack * z + of_slack * of_z - ahead**3 / mean**2)
        share = min(1.0, 0.995 * min(longest(slack, of_slack), longest(z, of_z)))
        x, y, slack, z = x + share * of_x, y + share * of_y, slack + share * of_slack, z + share * of_z
    raise RuntimeError("interior points find no contact")


def contact(plate, cracks, pins, fineness=1.0, reach=165.0, edge=None, flanks=()):
    """K_I and K_II by tip, and half angles in degrees, of a plate with pins (hole, direction, force N, radius, E, poisson), its edge
    (start, end) held, with contact of the flanks of some cracks."""
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
        loads.append(unit_loads(mesh, facets, outwards((x, y))))
        whole = np.sort(np.unique(np.round(ends.ravel(), 9) % (2 * np.pi)))
        whole = whole[np.r_[True, np.diff(whole) > 1e-6]]
        body = disc(radius, whole)
        rim_of_pin, ends_of_pin = sides_of(body, (0, 0), radius)
        middle_of_pin = np.angle(np.exp(1j * ends_of_pin).sum(axis=0))
        match = [int(np.argmin(np.abs(np.exp(1j * middle_of_pin) - np.exp(1j * m)))) for m in middle]
        basis_of_pin, solved_pin = factor_of(body, young, poisson, [(0, 0), (1, 0), (1, 1)])
        on_pin = unit_loads(body, rim_of_pin[match], outwards((0, 0)))
        # A traction on a pin acts against that on the plate.
        own.append((on_pin.T @ solved_pin(on_pin)) * (rim / radius) ** 2)
        clear = rim - radius
        angle = turn(middle)
        gaps.append(rim - clear * np.cos(angle) - np.sqrt(radius**2 - (clear * np.sin(angle)) ** 2))
        turns.append(angle)
        lengths.append(np.array([np.ptp(np.unwrap(ends[:, near][:, k])) * rim for k in range(len(facets))]))
    angle, of_pin = np.concatenate(turns), np.repeat(np.arange(len(pins)), [len(t) for t in turns])
    for crack in flanks:
        load, length = flanks_of(mesh, cracks[crack])
        loads.append(load)
        lengths.append(length)
        gaps.append(np.zeros(len(length)))
    load, length, gap = np.hstack(loads), np.concatenate(lengths), np.concatenate(gaps)
    field = solved(load)
    energy, start = load.T @ field, 0
    for block in own:
        energy[start:start + len(block), start:start + len(block)] += block
        start += len(block)
    rigid = np.zeros((len(length), 2 * len(pins)))
    for k, pin in enumerate(of_pin):
        rigid[k, 2 * pin:2 * pin + 2] = np.cos(angle[k]), np.sin(angle[k])
    wanted = np.zeros(2 * len(pins))
    wanted[::2] = [force / plate.thickness for _, _, force, *_ in pins]
    # Tractions over their scale, forces over that and the mean length, energy over the mean compliance.
    scale, mean, unit = np.abs(wanted).max() / length.sum(), length.mean(), np.diag(energy).mean()
    x = least_energy(0.5 * (energy + energy.T) / unit, gap * length / (unit * scale), rigid * length[:, None] / mean, wanted / (mean * scale))
    closed, displacement = x[:len(angle)] > 1e-4 * x.max(), field @ (x * scale)
    k = {tip: stress_intensity(plate, mesh, displacement, d, members[tip]) for tip, d in discs.items()}
    ends = [np.degrees([angle[(of_pin == pin) & closed].min(), angle[(of_pin == pin) & closed].max()]) for pin in range(len(pins))]
    return k, ends, float(np.degrees(np.mean(lengths[0]) / plate.holes[0][2]))


def lug(crack, radius_share, at=0.0, towards=90.0, fineness=1.0, rim=10.0, young=210e3, force=1e4):
    """A lug of 50 x 5 mm with a round head, a hole of 20 mm, a crack of this length, mm, at this angle, a pin that pulls towards another, held
    100 mm below by an edge."""
    head = np.radians(np.arange(0, 181, 2))
    outline = np.vstack([[[-25, -100], [25, -100.0]], 25 * np.c_[np.cos(head), np.sin(head)]])
    plate = Plate(outline, 5.0, [(0, 0, 10)], rim_fineness=rim)
    ray, pull = (np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))]) for angle in (at, towards))
    cracks = [Crack(np.array([10 * ray, (10 + crack) * ray]), (None, 0))]
    return contact(plate, cracks, [(0, pull, force, 10 * radius_share, young, 0.3)], fineness, edge=outline[:2], flanks=(0,))


def strip(crack, radius_share, young=210e3, force=2e4):
    """A strip of 60 x 200 x 5 mm with pins in holes of 20 mm that pull it apart, a crack of this length, mm, at the side of one."""
    outline = np.array([[-30, -100], [30, -100], [30, 100], [-30, 100.0]])
    plate = Plate(outline, 5.0, [(0, 60, 10), (0, -60, 10)], rim_fineness=10.0)
    pins = [(hole, (0, sign), force, 10 * radius_share, young, 0.3) for hole, sign in ((0, 1), (1, -1))]
    return contact(plate, [Crack(np.array([[10, 60], [10 + crack, 60.0]]), (None, 0))], pins)


def example(a, fineness=1.0, rim=10.0):
    """C(T) and pins of data/cases/compact_with_pins.toml."""
    plate, cracks = compact_tension(a)
    size = 50.8 / 50.0
    plate.outline, plate.holes, plate.thickness = plate.outline * size, [tuple(size * x for x in hole) for hole in plate.holes], 6.35
    plate.youngs_modulus, plate.poisson_ratio, plate.rim_fineness, plate.pin_loads = 73.1e3, 0.33, rim, []
    cracks[0].points[0] *= size
    return contact(plate, cracks, [(0, (0, 1), 2500, 6.325, 210e3, 0.3), (1, (0, -1), 2500, 6.325, 210e3, 0.3)], fineness)


def scene(a, radius_share, young=210e3, force=1e4, fineness=1.0, rim=10.0):
    """C(T) of standard.py under this force with pins of this share of the radius of the hole."""
    plate, cracks = compact_tension(a)
    plate.rim_fineness = rim
    pins = [(hole, direction, force, radius_share * plate.holes[hole][2], young, 0.3) for hole, direction, *_ in plate.pin_loads]
    plate.pin_loads = []
    return contact(plate, cracks, pins, fineness)


def with_arc(a, degrees):
    """K of the same with a cosine over an arc, 10 kN."""
    plate, cracks = compact_tension(a)
    plate.pin_loads = [(hole, direction, force, np.radians(degrees)) for hole, direction, force, _ in plate.pin_loads]
    mesh, discs, members = build_mesh(plate, cracks, 1.5)
    return stress_intensity(plate, mesh, solve(plate, mesh), discs[0], members[0])[0]


# Crack length mm, radius of the pin over that of the hole (but for `example`), angles of the crack and of the force.
SCENES = {
    "e647": (scene, 20.0, 0.96), "e647_short": (scene, 10.0, 0.96), "snug": (scene, 10.0, 1.0), "close": (scene, 10.0, 0.998),
    "strip_snug": (strip, 5.0, 1.0), "strip_close": (strip, 5.0, 0.997),
    **{f"example_{a}": (example, a) for a in (20.32, 30.48)},
    **{f"lug_{share}_{crack}": (lug, crack, share) for share in (0.9975, 1.0) for crack in (3.0, 7.5, 12.0)},
    **{f"lug_{share}_{crack}_{at}_{towards}": (lug, crack, share, at, towards) for share, crack, at, towards in (
        (0.995, 5.0, 90.0, 0.0), (0.995, 2.0, 90.0, 0.0), (0.9995, 5.0, 90.0, 0.0), (0.98, 5.0, 90.0, 0.0), (0.995, 5.0, 0.0, 45.0),
        (0.995, 5.0, 0.0, 90.0), (0.995, 5.0, 60.0, 90.0), (0.995, 5.0, 90.0, 90.0), (0.995, 4.0, 100.0, 90.0))},
}

if __name__ == "__main__":
    for a in () if sys.argv[1:] else (10.0, 20.0):
        x = a / 50.0
        formula = 1e4 / (10 * 50**0.5) * (2 + x) / (1 - x) ** 1.5 * (0.886 + 4.64 * x - 13.32 * x**2 + 14.72 * x**3 - 5.6 * x**4) / 1000**0.5
        print(f"a {a}: E647 {formula:.4f}, arcs of 15, 30, 90 degrees", *(f"{with_arc(a, arc):.4f}" for arc in (15, 30, 90)), flush=True)
    for name in sys.argv[1:] or SCENES:
        clock, (make, *given) = time.time(), SCENES[name]
        k, ends, side = make(*given)
        words = "; ".join(f"{low:.1f} to {high:.1f}" for low, high in ends)
        answer = f"{name}: K_I {k[0][0]:.4f}, K_II {k[0][1]:.4f}, contact {words} degrees, sides of {side:.2f}"
        print(f"{answer}, {time.time() - clock:.0f} s", flush=True)
