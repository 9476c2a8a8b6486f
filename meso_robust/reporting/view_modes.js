// Contact modes. Each tells how the part moves while the tips travel on (advance), what must stay
// positive for it to last (guards), and what every touching tip does (touching: tip, code).
// Tips are discs that do not turn. The travel that turns the part is a quadrature, done here by steps
// of Runge and Kutta: a picture, not a proof.
const SEPARATE = 0, STICK = 1, SLIP_LEFT = 2, SLIP_RIGHT = 3; // as the simulator numbers them
const LOOSE = 1e-7; // um: what counts as touching
const EVEN = 1e-9; // slack below which a mode is not left: it was just entered
const STRIDE = 4; // um of travel in one step of Runge and Kutta, at most

// Friction drags the part along the edge where its ratio is positive: to the right of a tip that looks at it.
const slipCode = (way) => (way === 0 ? STICK : way > 0 ? SLIP_RIGHT : SLIP_LEFT);

const rest = () => ({
  kind: "rest", touching: [], advance: (now, ds) => ({ ...now, s: now.s + ds }), guards: () => [],
});

// How far along its edge a tip touches it, from the foot of the reference point.
const offsetAt = (tip, edge, now) =>
  sticking.contact_offset(edgeAngle(now.theta, edge), edge.depth + tip.r, tip.y - now.y)[0];

// A contact in the part's axes: its place from the centre of drag, and the velocity of the tip.
function contactOf(part, tip, edge, theta, offset) {
  const arm = combined(offset, edge.along, edge.depth, edge.out);
  return { tip, edge, offset, arm: combined(1, arm, -1, part.centre),
    velocity: tip.active ? turnedBy(-theta, [-1, 0]) : [0, 0] };
}

const contactsOf = (part, tips, touched, now) => touched.map(({ i, edge }) =>
  contactOf(part, tips[i], edge, now.theta, offsetAt(tips[i], edge, now)));

// Linear equations by elimination, the largest entry of a column first.
function solved(matrix, right) {
  const rows = matrix.map((row, i) => [...row, right[i]]), size = rows.length;
  for (let k = 0; k < size; k++) {
    const best = rows.slice(k).reduce((b, row, i) => (Math.abs(row[k]) > Math.abs(rows[b][k]) ? k + i : b), k);
    [rows[k], rows[best]] = [rows[best], rows[k]];
    for (let i = 0; i < size; i++) {
      if (i === k) continue;
      const factor = rows[i][k] / rows[k][k];
      for (let j = k; j <= size; j++) rows[i][j] -= factor * rows[k][j];
    }
  }
  return rows.map((row, k) => row[size] / row[k]);
}

// The balance where each contact sticks (way 0) or slips with its friction ratio at way mu: the rate of
// the turn, and of each contact the pressing force, the force along the edge and the slip of the part.
function balanced(part, contacts, ways) {
  const { rho, stretch, shear } = part;
  const answers = ({ arm }, pushed, force) => response.velocity(...arm, ...pushed.arm, ...force, rho, stretch, shear);
  const rows = [], pushes = [];
  contacts.forEach((contact, k) => {
    const { along, out } = contact.edge, inward = [-out[0], -out[1]];
    rows.push({ contact, along: out });
    if (ways[k] === 0) rows.push({ contact, along });
    if (ways[k] === 0) pushes.push({ contact, force: inward }, { contact, force: along });
    else pushes.push({ contact, force: combined(1, inward, ways[k] * contact.tip.mu, along) });
  });
  const matrix = rows.map((row) => pushes.map(({ contact, force }) =>
    dot(row.along, answers(row.contact, contact, force))));
  const sizes = solved(matrix, rows.map(({ contact, along }) => dot(along, contact.velocity)));
  const at = (place) => pushes.reduce((sum, { contact, force }, k) =>
    combined(1, sum, sizes[k], answers(place, contact, force)), [0, 0]);
  const forces = contacts.map((contact) => pushes.reduce((sum, push, k) =>
    (push.contact === contact ? combined(1, sum, sizes[k], push.force) : sum), [0, 0]));
  return {
    turn: pushes.reduce((sum, { contact, force }, k) => sum + sizes[k] * response.turning(...contact.arm, ...force, rho)[0], 0),
    reference: () => at({ arm: [-part.centre[0], -part.centre[1]] }), // its velocity, in the part's axes
    at,
    press: contacts.map(({ edge }, k) => -dot(forces[k], edge.out)),
    drag: contacts.map(({ edge }, k) => dot(forces[k], edge.along)),
    slip: contacts.map((contact) => dot(contact.edge.along, combined(1, at(contact), -1, contact.velocity))),
  };
}

// Positive where the mode satisfies Coulomb's law with every tip pressing.
function slackOf(contacts, ways, motion) {
  const each = contacts.map(({ tip }, k) => Math.min(motion.press[k], ways[k] === 0
    ? tip.mu * motion.press[k] - Math.abs(motion.drag[k]) : -ways[k] * motion.slip[k]));
  const least = Math.min(...each);
  return least > -Infinity ? least : -Infinity;
}

const WAYS = { 1: [[0], [1], [-1]],
  2: [[1, 1], [1, -1], [-1, 1], [-1, -1], [0, 1], [0, -1], [1, 0], [-1, 0]] };

function bestWays(part, contacts) {
  const all = WAYS[contacts.length].map((ways) =>
    ({ ways, slack: slackOf(contacts, ways, balanced(part, contacts, ways)) }));
  return all.reduce((best, one) => (one.slack > best.slack ? one : best));
}

// A contact gives way under a force at either side of its friction cone: else it slips in two ways.
function givesWay(part, contact) {
  const { edge: { along, out }, arm, tip } = contact, { rho, stretch, shear } = part;
  return Math.min(...[-tip.mu, tip.mu].map((tau) => {
    const force = combined(-1, out, tau, along);
    return -dot(out, response.velocity(...arm, ...arm, ...force, rho, stretch, shear));
  }));
}

// One tip pushes: it sticks, or slips with the ratio of the friction cone's nearer side.
function single(part, tips, i, edge, now) {
  const contacts = (pose) => contactsOf(part, tips, [{ i, edge }], pose);
  const { ways } = bestWays(part, contacts(now));
  return { kind: "single", pusher: i, edge, ways, touching: [[i, slipCode(ways[0])]],
    offset: (pose) => offsetAt(tips[i], edge, pose),
    advance: (from, ds) => onOne(part, tips[i], edge, ways, from, ds),
    guards: (pose) => {
      const [contact] = contacts(pose), motion = balanced(part, [contact], ways);
      return [[room(edge, contact.offset), { end: "a tip passes the end of an edge" }],
        [Math.min(motion.press[0], givesWay(part, contact)),
          { end: "a pushing tip may let go or slip in more than one way" }],
        [slackOf([contact], ways, motion) + EVEN, { change: "sticks or slips" }]];
    } };
}

// The angle and the offset change; the pose follows from them and the tip. The contact slips over the
// edge, and a round tip rolls along it while the part turns.
function onOne(part, tip, edge, ways, from, ds) {
  const rates = ([theta, offset]) => {
    const motion = balanced(part, [contactOf(part, tip, edge, theta, offset)], ways);
    return [motion.turn, -motion.slip[0] - tip.r * motion.turn];
  };
  const [theta, offset] = rungeKutta(rates, [from.theta, offsetAt(tip, edge, from)], ds);
  const arm = turnedBy(theta, combined(offset, edge.along, edge.depth + tip.r, edge.out));
  const [x, y] = combined(1, tipAt(tip, from.s + ds), -1, arm);
  return { s: from.s + ds, x, y, theta };
}

// Classical fourth-order steps; `rates` may also depend on how far they have come.
function rungeKutta(rates, start, ds) {
  const count = Math.max(Math.ceil(Math.abs(ds) / STRIDE), 1), step = ds / count;
  let now = start;
  for (let i = 0; i < count; i++) {
    const moved = (by, part) => now.map((value, j) => value + part * step * by[j]);
    const k1 = rates(now, i * step), k2 = rates(moved(k1, 0.5), (i + 0.5) * step);
    const k3 = rates(moved(k2, 0.5), (i + 0.5) * step), k4 = rates(moved(k3, 1), (i + 1) * step);
    now = now.map((value, j) => value + (step / 6) * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]));
  }
  return now;
}

// What the formulas of one contact take: its angle, and depth, offset and drag in the edge's axes about
// the centre of drag.
function ofContact(part, tip, edge, now) {
  const { arm } = contactOf(part, tip, edge, now.theta, offsetAt(tip, edge, now));
  const { along, out } = edge, { rho, stretch, shear } = part;
  const dragged = [(1 + stretch) * along[0] + shear * along[1], shear * along[0] + (1 - stretch) * along[1]];
  return { angle: edgeAngle(now.theta, edge), d1: dot(arm, out), d2: dot(arm, along), rho,
    stretch: dot(dragged, along) - 1, shear: dot(dragged, out) };
}

// Both tips of the active probe touch one edge: the part travels with them. The forces along the edge
// act in one line, so that only their sum is known; so far apart are the contacts.
function pairForces(part, tips, upper, lower, edge, now) {
  const { angle, d1, d2, stretch, shear } = ofContact(part, tips[upper], edge, now);
  const apart = d2 - ofContact(part, tips[lower], edge, now).d2;
  return { apart, forces: tensor.pair_forces(angle, d1, d2, apart, stretch, shear, 0),
    sticks: (mu) => Math.min(...tensor.pair_friction(angle, stretch, shear, 0, mu)) };
}

const pair = (upper, lower, edge, now) => ({
  kind: "pair", upper, lower, edge, touching: [[upper, STICK], [lower, STICK]],
  advance: (from, ds) => ({ ...from, s: from.s + ds, x: from.x - ds }),
  guards: () => [],
});
