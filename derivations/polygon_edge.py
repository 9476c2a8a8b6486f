"""The edges of a convex polygon: direction, distance from the centre of drag, range of offsets.

Vertices are counter-clockwise in the part frame, whose origin is the centre of drag. For the edge from
``p = (x0, y0)`` to ``q = (x1, y1)``, with ``a`` along it and ``n`` outward::

             q
             |
    centre   o <- tip at d2 a + d1 n          a = (q - p)/|q - p|,  n = (a_y, -a_x)
             |                                d1 = p . n,           p . a <= d2 <= q . a
             p

Every one-edge condition is written in ``d1``, ``d2`` and the direction of the edge, so it serves any
edge of any convex polygon.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import as_written, for_all, identity, positive_by, there_is
from derivations._tex import tex
from derivations.mechanics import (
    cross,
    d1,
    d2,
    d4,
    film,
    n,
    rho,
    theta,
    velocity_at,
    wrench,
)
from derivations.symmetries import (
    BETA,
    LEFTWARDS,
    Q as EDGE,
    edge_contact,
    sticking_at,
    twist_under,
    two_points,
)

x0, y0, x1, y1 = sp.symbols("x0 y0 x1 y1", real=True)
P, Q = sp.Matrix([x0, y0]), sp.Matrix([x1, y1])
LENGTH = sp.Symbol("length", positive=True)
"""Of the edge, wherever it need not be written out."""
TWIST = sp.symbols("v_x v_y omega", real=True)
NEXT, EXTERIOR = sp.symbols("d1_next exterior", real=True)
ROUNDING = sp.Symbol("rounding", nonnegative=True)
END = (NEXT - d1 * sp.cos(EXTERIOR)) / sp.sin(EXTERIOR)
"""d2 of the corner of an edge with the line at NEXT, whose direction is turned by EXTERIOR."""
# an obtuse triangle about its centroid, in um
OBTUSE = (
    (sp.Integer(100), sp.Integer(-130)),
    (sp.Integer(700), sp.Integer(-130)),
    (sp.Integer(-800), sp.Integer(260)),
)


class Frame(NamedTuple):
    """One edge as the conditions of Section IX-C see it."""

    along: sp.Matrix
    out: sp.Matrix
    depth: sp.Expr
    """d1"""
    first: sp.Expr
    """d2 at the first vertex"""
    last: sp.Expr


def edge_frame(p: sp.Matrix, q: sp.Matrix, length: sp.Expr | None = None) -> Frame:
    """Frame of the edge from ``p`` to ``q``."""
    size = sp.sqrt((q - p).dot(q - p)) if length is None else length
    along = (q - p) / size
    turned = {sp.cos(theta): along[0], sp.sin(theta): along[1]}
    out = n.subs(turned, simultaneous=True)
    return Frame(along, out, p.dot(out), p.dot(along), q.dot(along))


def derive() -> Derivation:
    """Derive the frame of an edge and show that the one-edge conditions hold in it."""
    frame = edge_frame(P, Q)
    names = (x0, y0, x1, y1)
    return Derivation(
        name="polygon_edge",
        summary="Edges of a convex polygon: direction, distance from the centre of drag, offsets.",
        claims=(
            _frame_claim(),
            _end_claim(),
            _inside_claim(),
            _conditions_claim(),
            _rectangle_claim(),
            _two_points_claim(),
            _even_film(),
        ),
        functions={
            "edge_direction": Function(
                arguments=names,
                results=(frame.along[0], frame.along[1]),
                unit="1",
                meaning="cos and sin of the direction of the edge from (x0, y0) to (x1, y1) in the "
                "part frame; vertices counter-clockwise about the centre of drag",
            ),
            "edge_offsets": Function(
                arguments=names,
                results=(_quotient(frame.depth), _quotient(frame.first), _quotient(frame.last)),
                unit="m",
                meaning="d1 of the edge from (x0, y0) to (x1, y1), then d2 at its first and at its "
                "second vertex, m; d1 is positive where the centre of drag is inside of the edge",
            ),
            "end_offset": Function(
                arguments=(d1, NEXT, EXTERIOR, ROUNDING),
                results=(END - ROUNDING * (1 - sp.cos(EXTERIOR)) / sp.sin(EXTERIOR),),
                unit="m",
                meaning="d2, m, where the straight part of an edge at d1 ends that meets the line at "
                "d1_next, turned from it by the exterior angle, in a corner rounded with this radius",
            ),
        },
    )


def _quotient(expression: sp.Expr) -> sp.Expr:
    """Over the length of the edge, written once."""
    top, below = sp.fraction(sp.together(expression))
    return sp.expand(top) / below


def _frame_claim() -> Claim:
    """Distance and offsets from the vertices, and that every point of the edge has them."""
    t = sp.Symbol("t", real=True)
    frame = edge_frame(P, Q, LENGTH)
    point = P + t * (Q - P)
    offset = frame.first + t * (frame.last - frame.first)
    circle = {LENGTH: sp.sqrt((Q - P).dot(Q - P))}
    contact = offset * frame.along + frame.depth * frame.out
    return Claim(
        key="polygon-edge-frame",
        title="Distance and offsets of any edge",
        place="new; the paper treats a rectangle's long edge",
        derived=rf"For the edge from $p = (x_0, y_0)$ to $q = (x_1, y_1)$ of length $L$: $d_1 = (p "
        rf"\times q)/L$ = {tex(sp.expand(frame.depth * LENGTH) / sp.Symbol('L'))}, and $d_2$ runs "
        r"from $p \cdot (q - p)/L$ to $q \cdot (q - p)/L$, its length $L$. With the part at "
        r"$\theta_p$ the edge has the direction $\theta = \theta_p + \mathrm{atan2}(y_1 - y_0,\ "
        r"x_1 - x_0)$.",
        steps=(
            r"$a = (q - p)/L$; the outward normal of a polygon run counter-clockwise lies to the "
            r"right, $n = (a_y, -a_x)$.",
            r"$d_1 = p \cdot n$ is the same at both vertices, as $(q - p) \cdot n = 0$; every point "
            r"$p + t(q - p)$ is $d_2 a + d_1 n$ with $d_2$ affine in $t$.",
        ),
        hypotheses=(
            "coordinates about the centre of drag, where the film's resistance is diagonal",
        ),
        checks=(
            identity(r"$p \cdot n = (p \times q)/L$", frame.depth * LENGTH, cross(P, Q)),
            identity(r"$q \cdot n$ is the same", Q.dot(frame.out), frame.depth),
            identity(r"$p + t(q - p) = d_2 a + d_1 n$", contact.subs(circle), point),
            identity(
                r"length of the range", (frame.last - frame.first).subs(circle), circle[LENGTH]
            ),
        ),
    )


def _end_claim() -> Claim:
    """Where an edge ends, from the line that it meets."""
    beyond = sp.Matrix(
        [sp.sin(EXTERIOR), sp.cos(EXTERIOR)]
    )  # outward normal of the line, on a and n
    half = sp.Symbol("phi", real=True)
    centre = sp.Matrix([END - ROUNDING * sp.tan(EXTERIOR / 2), d1 - ROUNDING])
    return Claim(
        key="polygon-edge-end",
        title="Where an edge out of true ends",
        place="new; the paper's part is an exact rectangle",
        derived=r"An edge at $d_1$ ends where it meets the line at $d_1'$ whose direction is turned by the "
        r"exterior angle $\alpha$: at $d_2 = (d_1' - d_1\cos\alpha)/\sin\alpha$. A corner rounded with "
        r"radius $r_c$ takes $r_c\tan(\alpha/2) = r_c(1 - \cos\alpha)/\sin\alpha$ off its straight part.",
        steps=(
            r"The outward normal of the other line is $\sin\alpha\,a + \cos\alpha\,n$.",
            r"The arc touches both lines: its centre is $r_c$ inside of either.",
        ),
        checks=(
            identity(
                "the corner lies on the other line",
                as_written(lambda: END * beyond[0] + d1 * beyond[1]),
                NEXT,
            ),
            identity(
                "the arc's centre is its radius inside of the other line",
                centre.subs(EXTERIOR, 2 * half).dot(beyond.subs(EXTERIOR, 2 * half)),
                NEXT - ROUNDING,
            ),
            identity(
                "half the angle",
                sp.tan(half),
                as_written(lambda: (1 - sp.cos(2 * half)) / sp.sin(2 * half)),
            ),
        ),
    )  # fmt: skip


def _inside_claim() -> Claim:
    """Sign of d1, and what a centre outside would mean for a push."""
    frame = edge_frame(P, Q, LENGTH)
    return Claim(
        key="polygon-edge-distance",
        title="Sign of $d_1$",
        place="new",
        derived=r"$d_1 > 0$ exactly if the centre of drag lies strictly inside the half plane of "
        r"the edge; for a centre inside a convex polygon this holds of every edge, and $\sum L d_1 "
        r"= 2 \cdot$ area.",
        steps=(
            r"The centre is the origin: its height over the edge's line, measured inwards, is $-n "
            r"\cdot (0 - p) = d_1$.",
            r"A convex polygon is where the heights over all its edges are positive. The triangle "
            r"(centre, $p$, $q$) has the area $L d_1/2$.",
        ),
        checks=(
            identity(r"height of the origin over the edge is $d_1$",
                     sp.MatMul(-frame.out.T, -P), frame.depth),
            identity(r"area of the triangle (centre, $p$, $q$) is $L d_1/2$",
                     cross(P, Q) / 2, LENGTH * frame.depth / 2),
            positive_by("the edge's other side has $d_1 < 0$: run backwards",
                        -edge_frame(Q, P, LENGTH).depth, {"d1": frame.depth},
                        multiplier="1", combination="d1"),
        ),
    )  # fmt: skip


def _conditions_claim() -> Claim:
    """One- and two-point conditions of any edge, from the balance in the part's own frame."""
    turned = sp.symbols("cos_p sin_p", real=True)
    turn = _turn(*turned)
    out = n.subs({sp.cos(theta): EDGE[0], sp.sin(theta): EDGE[1]}, simultaneous=True)
    twist = sp.Matrix(TWIST)
    both = sp.diag(turn, 1)
    forces, size = sticking_at(), rho + d1**2 + d2**2
    held = replace(
        edge_contact(EDGE),
        tip=size * LEFTWARDS,
        normal=forces.normal,
        tangential=forces.tangential,
    )
    moved = twist_under(held)
    return Claim(
        key="polygon-edge-conditions",
        title="The conditions of one edge hold for every edge",
        place="new; Section IX-C for polygonal parts",
        derived=r"With $d_1$, $d_2$ and the direction $\theta$ of the edge, the conditions of "
        r"one-point and two-point sticking hold for every edge of a convex polygon, $\rho$ about "
        "the centre of drag. Both tips of a pair touch the same edge if $d_2$ and $d_2 - d_4/"
        r"\cos\beta$ lie in its range.",
        steps=(
            r"The film has no preferred direction, $R E R^T = E$: the balance may be written in the "
            "world, with the part's frame turned by $R$, and no angle of the part appears in $E$.",
            r"A point of the edge is $d_2 a + d_1 n$ in the part frame, hence $d_2 R a + d_1 R n$ "
            r"in the world, and $R n$ is the outward normal of the direction $R a$.",
            "The balance at this contact is solved again and compared.",
        ),
        hypotheses=(r"$e_y = e_x$", "contact away from the vertices"),
        checks=(
            identity(r"$R E R^T v = E v$", both * film(both.T * twist), film(twist), on=[turned]),
            identity("an edge turned with its part: arm", turn * (d2 * EDGE + d1 * out),
                 edge_contact(turn * EDGE).arm()),
            identity("at an edge of any direction the forces of one-point sticking leave no slip and no "
                     "opening, and turn the part as derived", [*held.relative(moved), moved[2]],
                     [0, 0, forces.turning], on=[EDGE]),
        ),
    )  # fmt: skip


def _turn(x: sp.Expr, y: sp.Expr) -> sp.Matrix:
    return sp.Matrix([[x, -y], [y, x]])


def _rectangle_claim() -> Claim:
    """The four edges of a rectangle."""
    length, width = sp.symbols("length width", positive=True)
    corners = _rectangle(length / 2, width / 2)
    edges, frame = zip(corners, corners[1:] + corners[:1], strict=True), edge_frame(P, Q)
    quarters = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    depths = [width / 2, length / 2] * 2
    return Claim(
        key="rectangle-edges",
        title="The four edges of a rectangle",
        place="new; Section IX-C1 names them",
        derived=r"A rectangle of length $\ell$ and width $w$ at orientation $\theta$ has edges of "
        r"directions $\theta$, $\theta + \pi/2$, $\theta + \pi$, $\theta - \pi/2$ with $d_1 = w/2, "
        r"\ell/2, w/2, \ell/2$ and $|d_2| \le \ell/2, w/2, \ell/2, w/2$. Upright ($\theta = \pi/2$) "
        r"the first faces $+x$; after a quarter turn counter-clockwise the last does.",
        checks=tuple(
            identity(
                f"edge {k + 1}: direction, $d_1$ and ends of $d_2$",
                [sp.Subs(entry, (*P, *Q), (*p, *q)) for entry in (*frame.along, *frame[2:])],
                [*quarter, depth, *_ends(depth, length, width)],
            )
            for k, ((p, q), quarter, depth) in enumerate(zip(edges, quarters, depths, strict=True))
        ),
    )


def _rectangle(along: sp.Expr, across: sp.Expr) -> list[sp.Matrix]:
    """Counter-clockwise, first the long edge whose outward normal is -y."""
    signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return [sp.Matrix([i * along, j * across]) for i, j in signs]


def _ends(depth: sp.Expr, length: sp.Expr, width: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    other = (length + width) / 2 - depth
    return -other, other


def _two_points_claim() -> Claim:
    """Two tips on one edge: the centre's foot, shifted by the misalignment, must be on the edge."""
    u, v, spacing = sp.symbols("u v d4", real=True)
    lever = sp.Symbol("lever", real=True)
    x, y = BETA
    upper, lower, _ = two_points(d2)
    reach = [lever > 0, lever < spacing, lever < v, lever - spacing > u]
    ends = [u < 0, v > 0, spacing > 0, spacing < v - u]
    chosen = spacing * v / (v - u)
    p, q = (sp.Matrix(corner) for corner in OBTUSE[:2])
    edge = edge_frame(p, q)
    return Claim(
        key="polygon-edge-two-points",
        title="Which edges can be pushed with two tips",
        place="new",
        derived=r"A pair with $|\tan\beta| < \mu$ can stick on an edge exactly if $u < -d_1 "
        r"\tan\beta < v$, with $u, v$ the values of $d_2$ at its vertices, and $d_4 < (v - u) "
        r"\cos\beta$: for an aligned pair, if the centre's foot lies within the edge. $d_2 = (d_4 "
        r"v' /(v' - u') - d_1 \sin\beta)/\cos\beta$ with $u' = u \cos\beta + d_1 \sin\beta$, $v'$ "
        r"likewise, is such a place. An edge whose foot lies beyond a vertex can be pushed with one "
        rf"tip only: in the triangle {_corners(OBTUSE)} µm about its centroid the first edge has "
        rf"$d_2$ from {edge.first} to {edge.last} µm.",
        steps=(
            r"Lever $\Lambda = d_1 \sin\beta + d_2 \cos\beta$ of the upper tip: the normal forces "
            r"are positive exactly for $0 < \Lambda < d_4$.",
            r"Both tips on the edge: $\Lambda < v'$ and $\Lambda - d_4 > u'$.",
        ),
        checks=(
            identity("force at the lower tip", lower * d4, x * (d1 * y + d2 * x)),
            identity("force at the upper tip", upper * d4, x * (d4 - d1 * y - d2 * x)),
            for_all("a place exists only if $u' < 0 < v'$ and $d_4 < v' - u'$", reach,
                    sp.And(*ends)),
            for_all(r"then $\Lambda = d_4 v'/(v' - u')$ is one", ends,
                    sp.And(*(r.subs(lever, chosen) for r in reach))),
            there_is("the triangle's first edge: the centre inside, its foot beyond the first vertex",
                     [sp.Gt(edge.depth, 0), u > 0, u < v], at={u: edge.first, v: edge.last}),
        ),
    )  # fmt: skip


def _corners(corners: tuple[tuple[sp.Expr, sp.Expr], ...]) -> str:
    return ", ".join(f"${sp.latex(corner)}$" for corner in corners)


def _even_film() -> Claim:
    """Drag of a film of even thickness under a polygon, triangle by triangle."""
    force, moment = _drag_of_triangle()
    u_x, u_y, omega = TWIST
    area = cross(P, Q) / 2
    centroid = (P + Q) / 3
    second = (P.dot(P) + P.dot(Q) + Q.dot(Q)) / 6
    length, width = sp.symbols("length width", positive=True)
    corners = _rectangle(length / 2, width / 2)
    sides = list(zip(corners, corners[1:] + corners[:1], strict=True))
    sums = [
        sum(
            part.subs({x0: p[0], y0: p[1], x1: q[0], y1: q[1]}, simultaneous=True) for p, q in sides
        )
        for part in (area, area * second)
    ]
    return Claim(
        key="polygon-even-film",
        title=r"$\rho$ of an even film under a polygon",
        place="new; Section IX-B takes $E$ as diagonal",
        derived=r"A film of even thickness under a polygon has the resistance $E = e_x\, "
        r"\mathrm{diag}(1, 1, \rho)$ about the centroid, the same in every direction, with $\rho = "
        r"\sum (p_i \times p_{i+1})(p_i \cdot p_i + p_i \cdot p_{i+1} + p_{i+1} \cdot p_{i+1}) / (6 "
        r"\sum p_i \times p_{i+1})$; about any other point force and moment are coupled. Rectangle: "
        rf"$\rho = (\ell^2 + w^2)/12$, {_rho_of_paper()} mm² for 1616 × 837 µm; the paper's fit is "
        "0.3769 mm².",
        steps=(
            r"The film resists with $k (v + \omega z \times r)$ per area; integrated over the triangle "
            r"(centre, $p_i$, $p_{i+1}$) with $r = s (p_i + t (p_{i+1} - p_i))$.",
        ),
        hypotheses=("drag proportional to speed, film of even thickness, centroid as reference",),
        checks=(
            identity(r"force of a triangle, $x$", force[0], area * (u_x - omega * centroid[1])),
            identity(r"force of a triangle, $y$", force[1], area * (u_y + omega * centroid[0])),
            identity(r"moment of a triangle", moment,
                     area * (cross(centroid, sp.Matrix([u_x, u_y])) + omega * second)),
            identity(r"rectangle: $\rho = (\ell^2 + w^2)/12$", sums[1] / sums[0],
                     (length**2 + width**2) / 12),
        ),
    )  # fmt: skip


def _drag_of_triangle() -> tuple[sp.Matrix, sp.Expr]:
    """Force and moment about the origin over the drag per area, of the triangle (origin, p, q)."""
    along, across = sp.symbols("s t", real=True)
    place = along * (P + across * (Q - P))
    stretch = cross(place.diff(along), place.diff(across))
    density = velocity_at(sp.Matrix(TWIST), place)
    wrenches = [sp.expand(part * stretch) for part in wrench(density, place)]
    total = [sp.integrate(sp.integrate(part, (across, 0, 1)), (along, 0, 1)) for part in wrenches]
    return sp.Matrix(total[:2]), total[2]


def _rho_of_paper() -> str:
    return f"{(1616**2 + 837**2) / 12e6:.4f}"
