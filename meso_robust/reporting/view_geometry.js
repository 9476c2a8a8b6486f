// The part in the axes of a move, whose active tips travel along −x; lengths in um, angles in rad.
// Edge q (0 to 3) stands upright and faces +x at an orientation of q + 1 quarter turns.
const { one_point_sticking: onePoint, sticking_motion: sticking,
  two_point_sticking: twoPoint, two_sided_rotation: twoSided } = formulas;
const QUARTER = Math.PI / 2;

const edgeOf = (part, q) => ({ q, depth: part.half[(q + 1) % 2], half: part.half[q % 2] });
const edgeAngle = (theta, edge) => theta - edge.q * QUARTER;
const facing = (part, theta) => edgeOf(part, (((Math.round(theta / QUARTER) - 1) % 4) + 4) % 4);
const tipAt = (tip, s) => (tip.active ? [tip.x - s, tip.y] : [tip.x, tip.y]);

// Distance of a point from the line of every edge; outside the part one of them is positive.
function clearances(part, pose, [x, y]) {
  return [0, 1, 2, 3].map((q) => {
    const edge = edgeOf(part, q);
    return sticking.clearance(edgeAngle(pose.theta, edge), edge.depth, x - pose.x, y - pose.y)[0];
  });
}

// Distance of a point from the nearest corner.
function cornerDistance(part, pose, [x, y]) {
  const c = Math.cos(pose.theta), s = Math.sin(pose.theta), dx = x - pose.x, dy = y - pose.y;
  return Math.hypot(Math.abs(c * dx + s * dy) - part.half[0], Math.abs(c * dy - s * dx) - part.half[1]);
}

const gap = (part, pose, point) => Math.max(...clearances(part, pose, point));

function nearestEdge(part, pose, point) {
  const all = clearances(part, pose, point);
  return edgeOf(part, all.indexOf(Math.max(...all)));
}

// How far a point outside can travel along −x until it touches the part; Infinity if it never does.
function flight(part, pose, point) {
  let enters = -Infinity, leaves = Infinity;
  clearances(part, pose, point).forEach((distance, q) => {
    const closing = Math.sin(edgeAngle(pose.theta, edgeOf(part, q)));
    if (closing > 0) enters = Math.max(enters, distance / closing);
    else if (closing < 0) leaves = Math.min(leaves, distance / closing);
    else if (distance >= 0) enters = Infinity;
  });
  return enters >= 0 && enters < leaves ? enters : Infinity;
}

// Distance of part and wall along the best of their sides (separating axes); world axes.
function wallDistance(part, pose, [x0, x1, y0, y1]) {
  const [a, b] = part.half, c = Math.cos(pose.theta), s = Math.sin(pose.theta);
  const along = Math.abs(c), across = Math.abs(s);
  const halfX = (x1 - x0) / 2, halfY = (y1 - y0) / 2;
  const x = pose.x - (x0 + x1) / 2, y = pose.y - (y0 + y1) / 2;
  return Math.max(
    Math.abs(x) - halfX - (a * along + b * across),
    Math.abs(y) - halfY - (a * across + b * along),
    Math.abs(x * c + y * s) - a - (halfX * along + halfY * across),
    Math.abs(y * c - x * s) - b - (halfX * across + halfY * along));
}

const pointToWall = ([x, y], [x0, x1, y0, y1]) => Math.max(x - x1, x0 - x, y - y1, y0 - y);

// Axes of a move: world = R(quarters) diag(1, ±1) own, as meso_robust/primitives/frame.py has them.
const HEADINGS = ["-x", "-y", "+x", "+y"];

function frameOf(rule) {
  const quarters = HEADINGS.indexOf(rule.heading), sign = rule.mirrored ? -1 : 1;
  const [c, s] = [[1, 0], [0, 1], [-1, 0], [0, -1]][quarters];
  return {
    sign,
    toWorld: ([x, y]) => [c * x - s * sign * y, s * x + c * sign * y],
    toOwn: ([x, y]) => [c * x + s * y, sign * (c * y - s * x)],
    angleToWorld: (theta) => sign * theta + quarters * QUARTER,
    angleToOwn: (theta) => sign * (theta - quarters * QUARTER),
  };
}
