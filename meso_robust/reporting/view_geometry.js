// The part in the axes of a move, whose active tips travel along −x; lengths in um, angles in rad.
// Its lines are the sides of its convex hull, run counter-clockwise about it: orientation of the part
// minus direction of the line (turn), distance from the centre (depth), and for an edge of the part
// where it begins and ends from the foot of the centre (first, last). Upright, facing +x, its angle is
// a quarter turn.
const { drag_tensor: tensor, sticking_motion: sticking, contact_response: response,
  polygon_edge: polygonEdge, opposite_edges: edges } = formulas;
const QUARTER = Math.PI / 2, TURN = 2 * Math.PI;

const dot = ([x, y], [u, v]) => x * u + y * v;
const combined = (p, [x, y], q, [u, v]) => [p * x + q * u, p * y + q * v];
const turnedBy = (angle, [x, y]) => {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [c * x - s * y, s * x + c * y];
};

const edgeAngle = (theta, line) => theta - line.turn;
const isEdge = (line) => line.first !== null;
// To the nearer end of the straight piece of an edge.
const room = (edge, offset) => Math.min(offset - edge.first - edge.cut[0], edge.last - edge.cut[1] - offset);
const tipAt = (tip, s) => (tip.active ? [tip.x - s, tip.y] : [tip.x, tip.y]);

// The corners of a part as made: every edge moved outward and turned by its own amount.
function made(corners, moved, skewed) {
  if (moved.every((by) => by === 0) && skewed.every((by) => by === 0)) return corners;
  const lines = corners.map(([x, y], k) => {
    const [u, v] = corners[(k + 1) % corners.length];
    const [depth] = polygonEdge.edge_offsets(x, y, u, v);
    return { out: turnedBy(skewed[k] - QUARTER, polygonEdge.edge_direction(x, y, u, v)), depth: depth + moved[k] };
  });
  return lines.map((line, k) => {
    const before = lines.at(k - 1);
    return solved([before.out, line.out], [before.depth, line.depth]);
  });
}

// The sides of the convex hull; one that is an edge has its ends, and how much a rounded corner takes.
function linesOf(corners, hull, rounded) {
  const count = corners.length;
  const between = (i, j) => polygonEdge.edge_direction(...corners[i], ...corners[j]);
  const cut = (i) => {
    const [before, after] = [between((i + count - 1) % count, i), between(i, (i + 1) % count)];
    return rounded * Math.tan(Math.acos(Math.min(dot(before, after), 1)) / 2);
  };
  return hull.map((i, k) => {
    const j = hull[(k + 1) % hull.length], along = between(i, j), edge = j === (i + 1) % count;
    const [depth, first, last] = polygonEdge.edge_offsets(...corners[i], ...corners[j]);
    return { turn: -Math.atan2(along[1], along[0]), along, out: [along[1], -along[0]], depth,
      first: edge ? first : null, last: edge ? last : null, cut: edge ? [cut(i), cut(j)] : null };
  });
}

const mirroredPoint = ([x, y]) => [x, -y];

// The part that a draw makes, seen from axes whose y may be mirrored: its outline runs the other way then.
function partOf(task, draw, mirrored) {
  const own = made(task.corners, draw.size, draw.squareness), last = own.length - 1;
  const corners = mirrored ? own.map(mirroredPoint).reverse() : own;
  const hull = mirrored ? task.hull.map((i) => last - i).reverse() : task.hull;
  const flip = mirrored ? -1 : 1, centre = turnedBy(draw.bearing, [draw.centre, 0]);
  const [stretch, shear] = turnedBy(2 * draw.axis, [draw.anisotropy / 2, 0]);
  return { rho: draw.film_ratio, stretch, shear: flip * shear, centre: [centre[0], flip * centre[1]], corners,
    lines: linesOf(corners, hull, task.corner_radius) };
}

// A line with its angle, by whole turns, closest to upright.
const upright = (line, theta) => ({ ...line,
  turn: line.turn + TURN * Math.round((edgeAngle(theta, line) - QUARTER) / TURN) });

// The edge that is closest to upright, facing +x.
function facing(part, theta) {
  const off = (edge) => Math.abs(edgeAngle(theta, edge) - QUARTER);
  return part.lines.filter(isEdge).map((line) => upright(line, theta))
    .reduce((best, edge) => (off(edge) < off(best) ? edge : best));
}

const clearance = (line, pose, [x, y]) =>
  sticking.clearance(edgeAngle(pose.theta, line), line.depth, x - pose.x, y - pose.y)[0];

// Distance of a point from every line; outside the convex hull one of them is positive.
const clearances = (part, pose, point) => part.lines.map((line) => clearance(line, pose, point));

function cornersAt(part, { x, y, theta }) {
  const c = Math.cos(theta), s = Math.sin(theta);
  return part.corners.map(([u, v]) => [x + c * u - s * v, y + s * u + c * v]);
}

// Distance of a point from the nearest corner.
const cornerDistance = (part, pose, [x, y]) =>
  Math.min(...cornersAt(part, pose).map(([u, v]) => Math.hypot(u - x, v - y)));

// Distance of a point from the line of a side of the hull that it is farthest beyond.
const offLine = (part, pose, point) => Math.max(...clearances(part, pose, point));

// Distance of a point from the convex hull; inside it the negative one from the nearest side.
function gap(part, pose, point) {
  const all = clearances(part, pose, point), most = Math.max(...all);
  if (most <= 0) return most;
  const line = part.lines[all.indexOf(most)];
  if (!isEdge(line)) return most;
  const along = dot(turnedBy(pose.theta, line.along), [point[0] - pose.x, point[1] - pose.y]);
  return along >= line.first && along <= line.last ? most : cornerDistance(part, pose, point);
}

// Whether a point lies in the part: a ray from it meets the outline an odd number of times.
function inPart(part, pose, [x, y]) {
  const all = cornersAt(part, pose);
  return all.filter(([x0, y0], i) => {
    const [x1, y1] = all[(i + 1) % all.length];
    return (y0 > y) !== (y1 > y) && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0);
  }).length % 2 === 1;
}

function nearestLine(part, pose, point) {
  const all = clearances(part, pose, point);
  return upright(part.lines[all.indexOf(Math.max(...all))], pose.theta);
}

// How far a tip outside can travel along −x until it touches the hull, and whether on a corner;
// Infinity if it never does.
function flight(part, pose, tip, [x, y]) {
  let enters = -Infinity, leaves = Infinity;
  clearances(part, pose, [x, y]).forEach((far, k) => {
    const closing = Math.sin(edgeAngle(pose.theta, part.lines[k])), distance = far - tip.r;
    if (closing > 0) enters = Math.max(enters, distance / closing);
    else if (closing < 0) leaves = Math.min(leaves, distance / closing);
    else if (distance >= 0) enters = Infinity;
  });
  if (!(enters >= 0 && enters < leaves)) return { travel: Infinity, corner: false };
  // where two sides meet, the tip comes later: it is round
  return { travel: enters, corner: gap(part, pose, [x - enters, y]) > tip.r + GRAZES };
}

// Distance of the part's hull and a wall along the best of their sides (separating axes); world axes.
function wallDistance(part, pose, [x0, x1, y0, y1]) {
  const all = cornersAt(part, pose), xs = all.map(([x]) => x), ys = all.map(([, y]) => y);
  const wall = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
  return Math.max(Math.min(...xs) - x1, x0 - Math.max(...xs), Math.min(...ys) - y1,
    y0 - Math.max(...ys), ...part.lines.map(
      (line) => Math.min(...wall.map((corner) => clearance(line, pose, corner)))));
}

const pointToWall = ([x, y], [x0, x1, y0, y1]) => Math.max(x - x1, x0 - x, y - y1, y0 - y);

// Axes of a move: world = R(quarters) diag(1, ±1) own, as meso_robust/primitives/frame.py has them.
const HEADINGS = ["-x", "-y", "+x", "+y"];

// They are turned once more by the direction of the true travel, so that it goes along −x.
function frameOf(rule, direction) {
  const quarters = HEADINGS.indexOf(rule.heading), sign = rule.mirrored ? -1 : 1;
  const [c, s] = [[1, 0], [0, 1], [-1, 0], [0, -1]][quarters], lean = sign * direction;
  const stated = ([x, y]) => [c * x + s * y, sign * (c * y - s * x)];
  return {
    sign,
    stated, // axes in which the rule is stated
    fromStated: (point) => turnedBy(-lean, point),
    toWorld: (own) => {
      const [x, y] = turnedBy(lean, own);
      return [c * x - s * sign * y, s * x + c * sign * y];
    },
    toOwn: (point) => turnedBy(-lean, stated(point)),
    angleToWorld: (theta) => sign * (theta + lean) + quarters * QUARTER,
    angleToOwn: (theta) => sign * (theta - quarters * QUARTER) - lean,
  };
}
