// A moving tip D and a passive tip S on edges that face away from each other: the orientation follows
// from the tips, the slide of the part between them has a rate of its own in each contact mode.
const opposite = (edge, other) => dot(edge.out, other.out) < -0.9;

const gripOf = (tips, D, S, edge, other) => ({ D, S, edge, other, V: tips[D].y - tips[S].y,
  across: (s) => tipAt(tips[D], s)[0] - tips[S].x });

const gripContacts = (part, tips, { D, S, edge, other }, now) =>
  contactsOf(part, tips, [{ i: D, edge }, { i: S, edge: other }], now);

// How far both contacts are from the ends of their edges.
const gripRoom = (contacts) => Math.min(...contacts.map(({ edge, offset }) => room(edge, offset)));

const gripped = (part, tips, grip, ways) => ({ kind: "grip", grip, edge: grip.edge, pusher: grip.D, ways,
  touching: [[grip.D, slipCode(ways[0])], [grip.S, slipCode(ways[1])]],
  advance: (from, ds) => onGrip(part, tips, grip, ways, from, ds),
  guards: (now) => {
    const contacts = gripContacts(part, tips, grip, now);
    return [[gripRoom(contacts), { end: "a tip passes the end of an edge" }],
      [slackOf(contacts, ways, balanced(part, contacts, ways)) + EVEN, { change: "another contact mode" }]];
  } });

function onGrip(part, tips, grip, ways, from, ds) {
  const pose = ([x, y, theta], s) => ({ s, x, y, theta });
  const rates = (values, passed) => {
    const now = pose(values, from.s + passed), contacts = gripContacts(part, tips, grip, now);
    const motion = balanced(part, contacts, ways);
    return [...turnedBy(now.theta, motion.reference()), motion.turn];
  };
  return touchingBoth(tips, grip, pose(rungeKutta(rates, [from.x, from.y, from.theta], ds), from.s + ds));
}

// The nearest pose at which both tips touch their edges: steps leave them by a little.
function touchingBoth(tips, { D, S, edge, other }, now) {
  const far = Math.hypot(edge.depth, other.depth); // an angle counts as so long a way
  for (let i = 0; i < 3; i++) {
    const off = [[D, edge], [S, other]].map(([k, line]) => {
      const reach = combined(1, tipAt(tips[k], now.s), -1, [now.x, now.y]);
      const out = turnedBy(now.theta, line.out);
      return { gap: dot(out, reach) - line.depth - tips[k].r,
        row: [-out[0], -out[1], dot(turnedBy(now.theta, line.along), reach) / far] };
    });
    const product = (p, q) => p.reduce((sum, value, k) => sum + value * q[k], 0);
    const sizes = solved(off.map((one) => off.map((two) => product(one.row, two.row))), off.map(({ gap: g }) => -g));
    const [dx, dy, turn] = [0, 1, 2].map((k) => sizes[0] * off[0].row[k] + sizes[1] * off[1].row[k]);
    now = { s: now.s, x: now.x + dx, y: now.y + dy, theta: now.theta + turn / far };
  }
  return now;
}
