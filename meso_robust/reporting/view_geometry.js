// The part in the axes of a move, whose active tips travel along −x; lengths in um, angles in rad.
// Its lines are the sides of its convex hull, run counter-clockwise about it: orientation of the part
// minus direction of the line (turn), distance from the centre (depth), and for an edge of the part
// where it begins and ends from the foot of the centre (first, last). Upright, facing +x, its angle is
// a quarter turn.
const { one_point_sticking: onePoint, sticking_motion: sticking,
  two_point_sticking: twoPoint, two_sided_rotation: twoSided } = formulas;
const QUARTER = Math.PI / 2, TURN = 2 * Math.PI;

const edgeAngle = (theta, line) => theta - line.turn;
const isEdge = (line) => line.first !== null;
const room = (edge, offset) => Math.min(offset - edge.first, edge.last - offset);
const tipAt = (tip, s) => (tip.active ? [tip.x - s, tip.y] : [tip.x, tip.y]);

// The outline with the y axis mirrored: a line is run the other way there.
const mirroredLine = ({ turn, depth, first, last }) => ({ turn: -turn - Math.PI, depth,
  first: first === null ? null : -last, last: last === null ? null : -first });

const partOf = (task, draw, mirrored) => ({ mu: draw.friction, rho: draw.film_ratio,
  corners: mirrored ? task.corners.map(([x, y]) => [x, -y]).reverse() : task.corners,
  lines: mirrored ? task.lines.map(mirroredLine) : task.lines });

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

const gap = (part, pose, point) => Math.max(...clearances(part, pose, point));

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

// How far a point outside can travel along −x until it touches the hull; Infinity if it never does.
function flight(part, pose, point) {
  let enters = -Infinity, leaves = Infinity;
  clearances(part, pose, point).forEach((distance, k) => {
    const closing = Math.sin(edgeAngle(pose.theta, part.lines[k]));
    if (closing > 0) enters = Math.max(enters, distance / closing);
    else if (closing < 0) leaves = Math.min(leaves, distance / closing);
    else if (distance >= 0) enters = Infinity;
  });
  return enters >= 0 && enters < leaves ? enters : Infinity;
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
