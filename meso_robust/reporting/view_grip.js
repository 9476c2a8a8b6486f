// A moving tip D and a passive tip S on opposite edges (derivations/two_sided_rotation.py), which are
// as far from the centre as each other, as those of a rectangle are: the
// orientation follows from the tips alone; the slide sigma of the centre from the middle of the
// contacts has a rate of its own in each contact mode.
const opposite = (edge, other) => Math.abs(edge.depth - other.depth) < LOOSE
  && Math.cos(edge.turn - other.turn) < EVEN - 1;

function gripOf(tips, D, S, edge, other) {
  return { D, S, edge, other, d1: edge.depth, V: tips[D].y - tips[S].y,
    across: (s) => tipAt(tips[D], s)[0] - tips[S].x,
    middle: (s) => [(tipAt(tips[D], s)[0] + tips[S].x) / 2, (tips[D].y + tips[S].y) / 2] };
}

function slideOf(grip, now) {
  const angle = edgeAngle(now.theta, grip.edge), [x, y] = grip.middle(now.s);
  return (now.x - x) * Math.cos(angle) + (now.y - y) * Math.sin(angle);
}

// The ratio at a sticking contact: rate (T + d1 (tau_D − tau_S)) is linear in either ratio, so the
// one at which the rate is `wanted` follows from the rates at both sides of the cone.
function stickingRatio(mu, low, high, openLow, openHigh, wanted) {
  const below = (low - wanted) * openLow, above = (high - wanted) * openHigh;
  return -mu + (2 * mu * below) / (below - above);
}

// Every contact mode at (h, sigma): its rate, its friction ratios, and its slack, which is positive
// where the mode satisfies Coulomb's law with both tips pressing.
function gripModes(part, grip, h, sigma) {
  const { V, d1 } = grip, { mu, rho } = part;
  const [down, downUp, upDown, up, v] = twoSided.slide_rates(h, V, d1, sigma, rho, mu);
  const [T] = twoSided.pair(h, V, d1);
  const open = (tauD, tauS) => T + d1 * (tauD - tauS);
  const opens = v > 0; // the contacts move apart along the edges
  const slips = opens ? upDown : downUp, way = opens ? 1 : -1;
  const tauD = stickingRatio(mu, opens ? down : downUp, opens ? upDown : up,
    open(-mu, -way * mu), open(mu, -way * mu), v);
  const tauS = stickingRatio(mu, opens ? upDown : down, opens ? up : downUp,
    open(way * mu, -mu), open(way * mu, mu), -v);
  const found = [
    { name: "both slip down", rate: down, tauD: -mu, tauS: -mu, slack: down - Math.abs(v) },
    { name: "both slip up", rate: up, tauD: mu, tauS: mu, slack: -Math.abs(v) - up },
    { name: opens ? "slip apart" : "slip together", rate: slips, tauD: way * mu, tauS: -way * mu,
      slack: Math.abs(v) - Math.abs(slips) },
    { name: "D sticks", rate: v, tauD, tauS: -way * mu, slack: mu - Math.abs(tauD) },
    { name: "S sticks", rate: -v, tauD: way * mu, tauS, slack: mu - Math.abs(tauS) }];
  for (const mode of found) {
    const [press] = twoSided.passive_force(h, V, d1, sigma, rho, mode.tauD, mode.tauS);
    mode.press = press;
    mode.slack = Math.min(mode.slack, open(mode.tauD, mode.tauS) / T, press);
    if (!(mode.slack > -Infinity)) mode.slack = -Infinity;
  }
  return found;
}

const bestGripMode = (part, grip, h, sigma) =>
  gripModes(part, grip, h, sigma).reduce((best, mode) => (mode.slack > best.slack ? mode : best));

// How far both contacts are from the ends of their edges.
const gripRoom = ({ edge, other }, T, sigma) =>
  Math.min(room(edge, T / 2 - sigma), room(other, T / 2 + sigma));

function gripped(part, tips, grip, mode) {
  const code = (name, tau, opposite) => mode.name === name ? STICK : slipCode(tau, opposite);
  return { kind: "grip", grip, edge: grip.edge, pusher: grip.D,
    touching: [[grip.D, code("D sticks", mode.tauD, false)], [grip.S, code("S sticks", mode.tauS, true)]],
    advance: (from, ds) => onGrip(part, grip, mode, from, ds),
    guards: (now) => {
      const h = grip.across(now.s), sigma = slideOf(grip, now);
      const [T] = twoSided.pair(h, grip.V, grip.d1);
      const same = gripModes(part, grip, h, sigma).find((one) => one.name === mode.name);
      return [[gripRoom(grip, T, sigma), { end: "a tip passes the end of an edge" }],
        [same ? same.slack + EVEN : -1, { change: "another contact mode" }]];
    } };
}

function onGrip(part, grip, mode, from, ds) {
  const { V, d1 } = grip, h0 = grip.across(from.s), h1 = h0 - ds;
  const grown = (twoSided.pair(h1, V, d1)[0] - twoSided.pair(h0, V, d1)[0]) / 2;
  const before = slideOf(grip, from);
  const corner = [-1, 1].flatMap((d) => [-1, 1].map((s) => [d, s]))
    .findIndex(([d, s]) => d * mode.tauD > 0 && s * mode.tauS > 0);
  const rates = ([sigma], passed) =>
    [twoSided.slide_rates(h0 - passed, V, d1, sigma, part.rho, part.mu)[corner]];
  const sigma = mode.name === "D sticks" ? before + grown
    : mode.name === "S sticks" ? before - grown : rungeKutta(rates, [before], ds)[0];
  const [c, s] = twoSided.orientation(h1, V, d1), [x, y] = grip.middle(from.s + ds);
  const angle = Math.atan2(s, c) + grip.edge.turn;
  const turns = Math.round((from.theta - angle) / TURN);
  return { s: from.s + ds, x: x + sigma * c, y: y + sigma * s, theta: angle + TURN * turns };
}
