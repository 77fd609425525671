"""Stress intensity factors of cracked plates by finite elements (plane stress).

Units: mm, N, MPa; stress intensity factors leave this module in MPa sqrt(m).

Six-node triangles; each crack tip lies in a disc of concentric rings whose innermost
elements have quarter points (Barsoum 1976). The crack is a line of doubled nodes.
K_I and K_II come from the interaction integral in domain form (Yau, Wang and Corten 1980;
Shih, Moran and Nakamura 1986) over the disc, where the crack is straight and its flanks
carry no traction.
"""
from dataclasses import dataclass, field

import gmsh
import numpy as np
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, FacetBasis, LinearForm, MeshTri, MeshTri2
from skfem.helpers import ddot, dot, sym_grad, trace

SQRT_M = np.sqrt(1000.0)  # 1 MPa sqrt(m) in MPa sqrt(mm)


@dataclass
class Crack:
    """A crack: points in mm from start to end; tips = (number or None, number or None) of its two ends."""
    points: np.ndarray
    tips: tuple


@dataclass
class Plate:
    """A plate: outline in mm (counter-clockwise), holes (x, y, radius) in mm, loads at their maximum."""
    outline: np.ndarray
    thickness: float
    holes: list = field(default_factory=list)
    edge_loads: list = field(default_factory=list)  # (from mm, to mm, traction in MPa)
    pin_loads: list = field(default_factory=list)  # (hole number, direction, force in N, half angle in rad)
    youngs_modulus: float = 70e3
    poisson_ratio: float = 0.3
    rim_fineness: float = 1.0  # how much smaller elements are on holes


@dataclass
class Tip:
    """Result at a crack tip: position in mm, direction of the crack in rad, K in MPa sqrt(m)."""
    position: np.ndarray
    direction: float
    k_i: float
    k_ii: float


def distance_to_segments(point, start, end):
    """Distances in mm from a point to segments given by their ends."""
    along = end - start
    place = np.clip(np.sum((point - start) * along, axis=1) / np.sum(along**2, axis=1), 0.0, 1.0)
    return np.linalg.norm(start + place[:, None] * along - point, axis=1)


def simplified(crack):
    """The points of a crack in mm without those that lie on a line: tolerance 2e-4 of the distance to a tip, at most 3 um."""
    points = crack.points
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    tolerance = np.full(len(points), 3e-3)
    for tip, run in zip(crack.tips, (length, length[-1] - length)):
        if tip is not None:
            tolerance = np.minimum(tolerance, 2e-4 * run + 1e-9)
    keep, stack = {0, len(points) - 1}, [(0, len(points) - 1)]
    while stack:
        a, b = stack.pop()
        if b - a < 2:
            continue
        chord = (points[b] - points[a]) / np.linalg.norm(points[b] - points[a])
        off = points[a + 1:b] - points[a]
        excess = np.abs(off[:, 0] * chord[1] - off[:, 1] * chord[0]) / tolerance[a + 1:b]
        worst = a + 1 + int(np.argmax(excess))
        if excess.max() > 1.0:
            keep.add(worst)
            stack += [(a, worst), (worst, b)]
    return points[sorted(keep)]


def distance_to_rest(plate, lines, number, point):
    """Distance in mm from a tip of crack `number` to the outline, the holes and the other cracks."""
    closest = distance_to_segments(point, plate.outline, np.roll(plate.outline, -1, axis=0)).min()
    for x, y, radius in plate.holes:
        closest = min(closest, abs(np.hypot(point[0] - x, point[1] - y) - radius))
    for other, line in enumerate(lines):
        if other != number:
            closest = min(closest, distance_to_segments(point, line[:-1], line[1:]).min())
    return closest


@dataclass
class Disc:
    """The meshed disc about a tip: centre in mm, direction in rad, radii of its rings in mm, sectors."""
    centre: np.ndarray
    direction: float
    radii: np.ndarray
    sectors: int

    def ring(self, radius):
        """Points in mm of a ring; the first lies on the crack."""
        angle = self.direction + np.pi + 2 * np.pi * np.arange(self.sectors) / self.sectors
        return self.centre + radius * np.c_[np.cos(angle), np.sin(angle)]

    def mesh(self):
        """Points in mm, triangles and crack edges of the disc; point 0 is the tip."""
        n = self.sectors
        points = np.vstack([self.centre] + [self.ring(radius) for radius in self.radii])
        triangles = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
        for ring in range(len(self.radii) - 1):
            inner, outer = 1 + ring * n, 1 + (ring + 1) * n
            for k in range(n):
                a, b, c, d = inner + k, outer + k, outer + (k + 1) % n, inner + (k + 1) % n
                triangles += [(a, b, c), (a, c, d)] if (k + ring) % 2 else [(a, b, d), (b, c, d)]
        edges = [(0, 1)] + [(1 + ring * n, 1 + (ring + 1) * n) for ring in range(len(self.radii) - 1)]
        return points, np.array(triangles), np.array(edges)


def discs_and_lines(plate, cracks, fineness):
    """Discs of the tips by tip number, and the lines of the cracks in mm outside the discs."""
    lines = [simplified(crack) for crack in cracks]
    discs, outside = {}, [line.copy() for line in lines]
    sectors, rings, ratio = (20, 8, 1.38) if fineness <= 1.0 else (32, 13, 1.22)
    for number, crack in enumerate(cracks):
        for end, tip in zip((0, -1), crack.tips):
            if tip is None:
                continue
            centre, behind = lines[number][end], lines[number][1 if end == 0 else -2]
            ahead = centre - behind
            piece = np.linalg.norm(ahead)
            radius = min(0.75 * piece, 0.3 * distance_to_rest(plate, lines, number, centre), 2.0)
            if len(lines[number]) == 2 and None not in crack.tips:
                radius = min(radius, 0.3 * piece)
            radii = radius * ratio ** -np.arange(rings - 1, -1, -1.0)
            discs[tip] = Disc(centre, np.arctan2(ahead[1], ahead[0]), radii, sectors)
            outside[number][end] = discs[tip].ring(radius)[0]
    return discs, outside


def triangulate(plate, cracks, discs, lines, fineness):
    """Linear triangles of the plate outside the discs by gmsh: points in mm, triangles, edges on the cracks."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 5)
    gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
    geo = gmsh.model.geo
    places = {}

    def point(xy):
        """The gmsh point at a place in mm, made once."""
        key = (round(float(xy[0]), 7), round(float(xy[1]), 7))
        if key not in places:
            places[key] = geo.addPoint(float(xy[0]), float(xy[1]), 0.0)
        return places[key]

    mouths = [line[end] for crack, line in zip(cracks, lines) for end, tip in zip((0, -1), crack.tips) if tip is None]
    marks = mouths + [np.array(end) for load in plate.edge_loads for end in load[:2]]
    loop = []
    for start, end in zip(plate.outline, np.roll(plate.outline, -1, axis=0)):
        side = np.linalg.norm(end - start)
        on = [p for p in marks if distance_to_segments(p, start[None], end[None])[0] < 1e-7]
        runs = sorted({0.0, side} | {round(float(np.dot(p - start, end - start) / side), 7) for p in on})
        ids = [point(start + run / side * (end - start)) for run in runs]
        loop += [geo.addLine(a, b) for a, b in zip(ids[:-1], ids[1:]) if a != b]
    loops = [geo.addCurveLoop(loop)]
    for number, (x, y, radius) in enumerate(plate.holes):
        angles = {0.0, np.pi / 2, np.pi, -np.pi / 2}
        for mouth in mouths:
            if abs(np.hypot(mouth[0] - x, mouth[1] - y) - radius) < 1e-6:
                angles.add(np.arctan2(mouth[1] - y, mouth[0] - x))
        for hole, direction, _, half in plate.pin_loads:
            if hole == number:
                middle = np.arctan2(direction[1], direction[0])
                angles |= {np.angle(np.exp(1j * (middle + side * half))) for side in (-1, 1)}
        centre = geo.addPoint(x, y, 0.0)
        ids = []
        for angle in sorted(angles):
            place = point((x + radius * np.cos(angle), y + radius * np.sin(angle)))
            if not ids or place not in ids:
                ids.append(place)
        loops.append(geo.addCurveLoop([geo.addCircleArc(a, centre, b) for a, b in zip(ids, ids[1:] + ids[:1])]))
    for disc in discs.values():
        ids = [point(p) for p in disc.ring(disc.radii[-1])]
        sides = [geo.addLine(a, b) for a, b in zip(ids, ids[1:] + ids[:1])]
        for side in sides:
            geo.mesh.setTransfiniteCurve(side, 2)
        loops.append(geo.addCurveLoop(sides))
    surface = geo.addPlaneSurface(loops)
    crack_lines = [geo.addLine(point(a), point(b)) for line in lines for a, b in zip(line[:-1], line[1:])]
    geo.synchronize()
    gmsh.model.mesh.embed(1, crack_lines, 2, surface)

    growth = 0.3 / fineness
    size = np.ptp(plate.outline, axis=0).min() / (14.0 * fineness)
    fields = [f"{size:.9g}"]
    for disc in discs.values():
        (x, y), r = disc.centre, disc.radii[-1]
        fields.append(f"{2 * np.pi * r / disc.sectors:.9g}+{growth:.9g}*(sqrt((x-({x:.9g}))^2+(y-({y:.9g}))^2)-{r:.9g})")
    for x, y, radius in plate.holes:
        fields.append(f"{radius / (4 * fineness * plate.rim_fineness):.9g}+{growth:.9g}*Fabs(sqrt((x-({x:.9g}))^2+(y-({y:.9g}))^2)-{radius:.9g})")
        for line in lines:  # a narrow bridge between a hole and a crack
            fine = np.vstack([np.linspace(a, b, 20) for a, b in zip(line[:-1], line[1:])])
            gap = np.hypot(fine[:, 0] - x, fine[:, 1] - y) - radius
            near = int(np.argmin(gap))
            if 1e-6 < gap[near] < 2 * radius:
                px, py = fine[near]
                fields.append(f"{0.6 * gap[near] / fineness:.9g}+{growth:.9g}*sqrt((x-({px:.9g}))^2+(y-({py:.9g}))^2)")
    numbers = []
    for text in fields:
        numbers.append(gmsh.model.mesh.field.add("MathEval"))
        gmsh.model.mesh.field.setString(numbers[-1], "F", text)
    least = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(least, "FieldsList", numbers)
    gmsh.model.mesh.field.setAsBackgroundMesh(least)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    index = np.zeros(int(tags.max()) + 1, dtype=int)
    index[tags.astype(int)] = np.arange(len(tags))
    points = coordinates.reshape(-1, 3)[:, :2].copy()
    triangles = index[gmsh.model.mesh.getElementsByType(2)[1].astype(int)].reshape(-1, 3)
    edges = [index[gmsh.model.mesh.getElementsByType(1, line)[1].astype(int)].reshape(-1, 2) for line in crack_lines]
    gmsh.finalize()
    return points, triangles, np.vstack(edges)


def split_nodes(points, triangles, edges):
    """Double the nodes along the crack edges: round a node, triangles parted by crack edges get nodes of their own."""
    cut = {tuple(sorted(edge)) for edge in edges.tolist()}
    on_crack = np.unique(edges)
    member = np.zeros(len(points), dtype=bool)
    member[on_crack] = True
    around = {node: [] for node in on_crack.tolist()}
    for number in np.flatnonzero(member[triangles].any(axis=1)).tolist():
        for node in triangles[number].tolist():
            if node in around:
                around[node].append(number)
    original, result, extra = triangles.tolist(), triangles.copy(), []
    for node, fan in around.items():
        by_edge = {}
        for number in fan:
            for other in original[number]:
                if other != node and tuple(sorted((node, other))) not in cut:
                    by_edge.setdefault(other, []).append(number)
        left, first = set(fan), True
        while left:
            group, stack = set(), [min(left)]
            while stack:
                number = stack.pop()
                if number in group:
                    continue
                group.add(number)
                for other in original[number]:
                    stack += by_edge.get(other, [])
            left -= group
            if not first:
                extra.append(points[node])
                for number in group:
                    result[number][result[number] == node] = len(points) + len(extra) - 1
            first = False
    return (np.vstack([points] + [np.array(extra)]) if extra else points), result


def build_mesh(plate, cracks, fineness=1.0):
    """Mesh of six-node triangles with doubled cracks, quarter points and round holes; discs and triangles of each disc."""
    discs, lines = discs_and_lines(plate, cracks, fineness)
    points, triangles, edges = triangulate(plate, cracks, discs, lines, fineness)
    used = np.unique(triangles)
    renumber = np.full(len(points), -1)
    renumber[used] = np.arange(len(used))
    points, triangles, edges = points[used], renumber[triangles], renumber[edges]
    members = {}
    for tip, disc in discs.items():
        own, corners, own_edges = disc.mesh()
        rim = len(own) - disc.sectors
        matches = np.array([np.argmin(np.sum((points - p) ** 2, axis=1)) for p in own[rim:]])
        assert np.abs(points[matches] - own[rim:]).max() < 1e-6, "the rim of a disc does not fit"
        index = np.r_[len(points) + np.arange(rim), matches]
        members[tip] = np.arange(len(triangles), len(triangles) + len(corners))
        points = np.vstack([points, own[:rim]])
        triangles = np.vstack([triangles, index[corners]])
        edges = np.vstack([edges, index[own_edges]])
    assert np.unique(triangles).size == len(points)
    points, triangles = split_nodes(points, triangles, edges)
    p = points[triangles]
    area = np.cross(np.c_[p[:, 1] - p[:, 0], np.zeros(len(p))], np.c_[p[:, 2] - p[:, 0], np.zeros(len(p))])[:, 2]
    assert np.abs(area).min() > 0
    mesh = MeshTri2.from_mesh(MeshTri(points.T.copy(), triangles.T.copy()))
    places = mesh.doflocs.copy()
    middle = mesh.dofs.facet_dofs[0]
    for disc in discs.values():
        tip = int(np.argmin(np.sum((points - disc.centre) ** 2, axis=1)))
        for near, far in ((0, 1), (1, 0)):
            spokes = np.flatnonzero(mesh.facets[near] == tip)
            places[:, middle[spokes]] = 0.75 * points[tip][:, None] + 0.25 * points[mesh.facets[far][spokes]].T
    rims = mesh.boundary_facets()
    for x, y, radius in plate.holes:
        centre = np.array([[x], [y]])
        off = [np.abs(np.linalg.norm(points[mesh.facets[k][rims]].T - centre, axis=0) - radius) for k in (0, 1)]
        on = rims[(off[0] < 1e-6) & (off[1] < 1e-6)]
        ray = places[:, middle[on]] - centre
        places[:, middle[on]] = centre + radius * ray / np.linalg.norm(ray, axis=0)
    return MeshTri2(doflocs=places, t=mesh.t), discs, members


def solve(plate, mesh):
    """Displacements in mm under the maximum load; three degrees of freedom are held (the loads balance)."""
    young, poisson = plate.youngs_modulus, plate.poisson_ratio
    shear, lame = young / (2 + 2 * poisson), young * poisson / (1 - poisson**2)
    element = ElementVector(ElementTriP2())
    basis = Basis(mesh, element, intorder=4)

    @BilinearForm
    def stiffness(u, v, w):
        """Strain energy density in MPa."""
        a, b = sym_grad(u), sym_grad(v)
        return 2 * shear * ddot(a, b) + lame * trace(a) * trace(b)

    matrix = stiffness.assemble(basis).tocsc()
    load = np.zeros(basis.N)
    corners = mesh.p[:, mesh.facets]
    rims = mesh.boundary_facets()

    @LinearForm
    def push(v, w):
        """Power of a traction in MPa."""
        return dot(w["traction"], v)

    for start, end, traction in plate.edge_loads:
        start, end = np.array([start], float), np.array([end], float)
        off = np.max([distance_to_segments(corners[:, k, rims].T[:, None].reshape(-1, 2), start, end) for k in (0, 1)], axis=0)
        sides = FacetBasis(mesh, element, facets=rims[off < 1e-7], intorder=4)
        value = np.zeros_like(sides.global_coordinates().value)
        value += np.array(traction, float)[:, None, None]
        load += push.assemble(sides, traction=value)
    for hole, direction, force, half in plate.pin_loads:
        x, y, radius = plate.holes[hole]
        centre = np.array([x, y])[:, None]
        off = np.max([np.abs(np.linalg.norm(corners[:, k, rims] - centre, axis=0) - radius) for k in (0, 1)], axis=0)
        middle = corners[:, :, rims].mean(axis=1) - centre
        turn = np.angle((middle[0] + 1j * middle[1]) / complex(*direction))
        sides = FacetBasis(mesh, element, facets=rims[(off < 1e-6) & (np.abs(turn) < half)], intorder=8)
        ray = sides.global_coordinates().value - centre[:, :, None]
        angle = np.angle((ray[0] + 1j * ray[1]) / complex(*direction))
        shape = np.clip(np.cos(0.5 * np.pi * angle / half), 0.0, None)
        normal = ray / np.hypot(*ray)
        along = np.tensordot(np.array(direction, float), normal, axes=1)
        scale = force / plate.thickness / np.sum(shape * along * sides.dx)
        load += push.assemble(sides, traction=scale * shape * normal)
    dofs = basis.nodal_dofs
    first, second = (int(np.argmin(np.sum((mesh.p[:, :mesh.nvertices].T - corner) ** 2, axis=1))) for corner in plate.outline[:2])
    held = [dofs[0, first], dofs[1, first], dofs[1, second]]
    free = np.setdiff1d(np.arange(basis.N), held)
    displacement = np.zeros(basis.N)
    factors = splu(matrix[free][:, free], permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    displacement[free] = factors.solve(load[free])
    reaction = np.abs(matrix[held] @ displacement - load[held]).max()
    assert reaction < 1e-5 * np.abs(load).sum(), f"the loads do not balance: {reaction} N/mm"
    return displacement


def williams(z, k_i, k_ii, young, poisson):
    """Near-tip field of K in MPa sqrt(mm) at z = x + iy in mm (Muskhelishvili 1953): stresses in MPa, u,x and v,x."""
    shear, kappa = young / (2 + 2 * poisson), (3 - poisson) / (1 + poisson)
    root = 2 * np.sqrt(2 * np.pi * z)
    phi, slope, mirror = (k_i - 1j * k_ii) / root, -(k_i - 1j * k_ii) / (2 * root * z), (k_i + 1j * k_ii) / root
    psi = mirror - phi - z * slope
    mean, deviator = 2 * phi.real, np.conj(z) * slope + psi
    gradient = (kappa * phi - np.conj(phi) - z * np.conj(slope) - np.conj(psi)) / (2 * shear)
    return (mean - deviator.real, mean + deviator.real, deviator.imag), (gradient.real, gradient.imag)


def stress_intensity(plate, mesh, displacement, disc, triangles):
    """K_I and K_II in MPa sqrt(m) by the interaction integral over a disc (Yau, Wang and Corten 1980)."""
    young, poisson = plate.youngs_modulus, plate.poisson_ratio
    basis = Basis(mesh, ElementVector(ElementTriP2()), elements=triangles, intorder=8)
    scalar = Basis(mesh, ElementTriP2(), elements=triangles, intorder=8)
    inner, outer = disc.radii[1], disc.radii[-1]
    radius = np.linalg.norm(mesh.doflocs[:, :mesh.nvertices] - disc.centre[:, None], axis=0)
    corner = np.where(radius > outer * (1 - 1e-9), 0.0, np.clip((outer - radius) / (outer - inner), 0.0, 1.0))
    weight = np.zeros(scalar.N)
    weight[scalar.nodal_dofs[0]] = corner
    weight[scalar.facet_dofs[0]] = corner[mesh.facets].mean(axis=0)
    c, s = np.cos(disc.direction), np.sin(disc.direction)
    turn = np.array([[c, s], [-s, c]])
    grad = np.einsum("ij,jkeq,lk->ileq", turn, basis.interpolate(displacement).grad, turn)
    q = np.einsum("ij,jeq->ieq", turn, scalar.interpolate(weight).grad)
    place = np.einsum("ij,jeq->ieq", turn, basis.global_coordinates().value - disc.centre[:, None, None])
    shear, lame = young / (2 + 2 * poisson), young * poisson / (1 - poisson**2)
    volume = lame * (grad[0, 0] + grad[1, 1])
    sxx, syy = 2 * shear * grad[0, 0] + volume, 2 * shear * grad[1, 1] + volume
    sxy = shear * (grad[0, 1] + grad[1, 0])
    result = []
    for k_i, k_ii in ((1.0, 0.0), (0.0, 1.0)):
        (axx, ayy, axy), (ux, vx) = williams(place[0] + 1j * place[1], k_i, k_ii, young, poisson)
        energy = axx * grad[0, 0] + ayy * grad[1, 1] + axy * (grad[0, 1] + grad[1, 0])
        flow_x = sxx * ux + sxy * vx + axx * grad[0, 0] + axy * grad[1, 0] - energy
        flow_y = sxy * ux + syy * vx + axy * grad[0, 0] + ayy * grad[1, 0]
        integral = np.sum((flow_x * q[0] + flow_y * q[1]) * basis.dx)
        result.append(0.5 * young * integral / SQRT_M)
    return result


def analyse(plate, cracks, fineness=1.0):
    """Tips by number with K in MPa sqrt(m) under the maximum load; fineness 2 halves the elements."""
    mesh, discs, members = build_mesh(plate, cracks, fineness)
    displacement = solve(plate, mesh)
    tips = {}
    for tip, disc in discs.items():
        k_i, k_ii = stress_intensity(plate, mesh, displacement, disc, members[tip])
        tips[tip] = Tip(disc.centre.copy(), disc.direction, float(k_i), float(k_ii))
    return tips
