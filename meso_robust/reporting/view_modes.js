// Contact modes. Each tells how the part moves while the tips travel on (advance), what must stay
// positive for it to last (guards), and what every touching tip does (touching: tip, code).
const SEPARATE = 0, STICK = 1, SLIP_LEFT = 2, SLIP_RIGHT = 3; // as the simulator numbers them
const LOOSE = 1e-7; // um: what counts as touching
const EVEN = 1e-9; // slack below which a mode is not left: it was just entered

// Where friction drags the part, seen from a tip: tau > 0 drags it along the edge's direction, which
// lies to the right of a tip that looks along −x and to the left of one on the opposite edge.
const slipCode = (tau, opposite) => (tau > 0) !== opposite ? SLIP_RIGHT : SLIP_LEFT;

const rest = () => ({
  kind: "rest", touching: [], advance: (now, ds) => ({ ...now, s: now.s + ds }), guards: () => [],
});

// The angle after so much travel in sticking contact: the closed form, inverted by Newton's method.
function turned(start, ds, d1, d2, rho) {
  const rate = (theta) => twoSided.one_contact_turning(
    theta, d1, d2, rho, onePoint.stick_ratio(theta, d1, d2, rho)[0])[0];
  let theta = start + rate(start) * ds;
  if (Math.abs(theta - start) < 1e-13) return theta; // pushed through the centre: it does not turn
  for (let i = 0; i < 30; i++) {
    const step = (sticking.travel(start, theta, d1, d2, rho)[0] - ds) * rate(theta);
    theta -= step;
    if (Math.abs(step) < 1e-15) break;
  }
  return theta;
}

// One tip pushes: it sticks, or slips with the ratio of the friction cone's nearer side.
function single(part, tips, i, edge, now) {
  const { depth: d1 } = edge, { mu, rho } = part;
  const offset = (pose, s = pose.s) => sticking.contact_offset(
    edgeAngle(pose.theta, edge), d1, tipAt(tips[i], s)[1] - pose.y)[0];
  const margins = (pose) => onePoint.friction_margin(
    edgeAngle(pose.theta, edge), d1, offset(pose), rho, mu);
  const force = (pose) => onePoint.normal_force(
    edgeAngle(pose.theta, edge), d1, offset(pose), rho)[0];
  const common = (pose) => [
    [room(edge, offset(pose)), { end: "a tip passes the end of an edge" }],
    [Math.min(force(pose), ...onePoint.only_solution(d1, offset(pose), rho, mu)),
      { end: "a pushing tip may let go or slip in more than one way" }]];
  const [left, right] = margins(now);
  const base = { kind: "single", pusher: i, edge, offset };
  if (left >= 0 && right >= 0) {
    const d2 = offset(now);
    return { ...base, tau: 0, touching: [[i, STICK]], offset: () => d2,
      advance: (from, ds) => onSticking(part, tips[i], edge, d2, from, ds),
      guards: (pose) => [...common(pose),
        [Math.min(...margins(pose)) / rho + EVEN, { change: "slips" }]] };
  }
  const tau = left < 0 ? mu : -mu, broken = left < 0 ? 0 : 1;
  return { ...base, tau, touching: [[i, slipCode(tau, false)]],
    advance: (from, ds) => onSlipping(part, tips[i], edge, tau, from, ds),
    guards: (pose) => [...common(pose),
      [EVEN - margins(pose)[broken] / rho, { change: "sticks again" }]] };
}

function onSticking(part, tip, edge, d2, from, ds) {
  const angle = turned(edgeAngle(from.theta, edge), ds, edge.depth, d2, part.rho);
  const [x, y] = tipAt(tip, from.s + ds), [dx, dy] = sticking.arm(angle, edge.depth, d2);
  return { s: from.s + ds, x: x - dx, y: y - dy, theta: angle + edge.turn };
}

function onSlipping(part, tip, edge, tau, from, ds) {
  const d1 = edge.depth, height = tip.y;
  const rates = ([angle, y]) => {
    const d2 = sticking.contact_offset(angle, d1, height - y)[0];
    return [twoSided.one_contact_turning(angle, d1, d2, part.rho, tau)[0],
      twoSided.one_contact_motion(angle, d1, d2, part.rho, tau)[1]];
  };
  const [angle, y] = rungeKutta(rates, [edgeAngle(from.theta, edge), from.y], ds);
  const reach = sticking.contact_reach(angle, d1, height - y)[0];
  return { s: from.s + ds, x: tipAt(tip, from.s + ds)[0] - reach, y, theta: angle + edge.turn };
}

// Classical fourth-order step; `rates` may also depend on how far the step has come.
function rungeKutta(rates, start, ds) {
  const moved = (by, share) => start.map((value, i) => value + share * ds * by[i]);
  const k1 = rates(start, 0), k2 = rates(moved(k1, 0.5), 0.5 * ds);
  const k3 = rates(moved(k2, 0.5), 0.5 * ds), k4 = rates(moved(k3, 1), ds);
  return start.map((value, i) => value + (ds / 6) * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]));
}

// Both tips of the active probe touch one edge: the part travels with them.
function pairForces(tips, upper, lower, edge, now, offset) {
  const rise = tips[upper].y - tips[lower].y;
  const beta = Math.atan2(tips[lower].x - tips[upper].x, rise);
  return { beta, forces: twoPoint.normal_forces(beta, edge.depth, offset, rise) };
}

const pair = (upper, lower, edge, offset, beta) => ({
  kind: "pair", upper, lower, edge, offset, beta, touching: [[upper, STICK], [lower, STICK]],
  advance: (from, ds) => ({ ...from, s: from.s + ds, x: from.x - ds }),
  guards: () => [],
});
