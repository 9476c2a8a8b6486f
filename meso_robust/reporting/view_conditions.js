// What the certificate proves of each move, evaluated along one run: the least value of every
// inequality, under the name of its obligation (names.py). Units: um, um² or none.
function conditions() {
  const all = new Map();
  return { all, low(name, value, unit) {
    const known = all.get(name);
    if (!known || value < known.value) all.set(name, { value, unit });
  },
  // the largest of several values, each at its least
  best(name, values, unit) {
    const known = all.get(name), each = known ? known.each.map((value, k) => Math.min(value, values[k])) : values;
    all.set(name, { value: Math.max(...each), unit, each });
  } };
}

const WAYS_BACK = 24; // instants of a withdrawal that are looked at
const NAMES = ["upper", "lower"];

function watcher(move) {
  const own = { tilt: tiltWatch, straighten: straightenWatch, rotate: rotateWatch,
    regrasp: regraspWatch, guide: guideWatch }[move.rule.action](move);
  const { found, walls, tips } = move, { during } = own;
  if (move.rule.action !== "regrasp") freeAtStart(move);
  const clear = (now) => {
    if (walls.part(now) === Infinity) return;
    if (move.rule.action !== "guide") found.low("part_clear_of_walls", walls.part(now), "um");
    const least = Math.min(...tips.map((tip) => walls.tip(tipAt(tip, now.s)) - tip.r));
    found.low("tips_clear_of_walls", least, "um");
  };
  return { during: (now, mode) => { clear(now); during(now, mode); }, after: own.after };
}

// The edge on the side of the part that is away from the active probe.
const behind = (part, theta) => facing(part, theta + Math.PI);

function freeAtStart({ part, tips, start, found }) {
  const edge = facing(part, start.theta);
  ["upper", "lower", "passive"].forEach((name, i) => {
    if (!tips[i]) return;
    const seen = name === "passive" ? behind(part, start.theta) : edge;
    const distance = clearance(seen, start, [tips[i].x, tips[i].y]) - tips[i].r;
    found.low(`tip_free_at_start/${name}`, distance, "um");
  });
}

const withdrawn = (found, tips, now, edge) =>
  found.low(`withdraws_free/${tips}`, Math.sin(edgeAngle(now.theta, edge)), "");

// One contact alone: `which` names it in the certificate, `side` is the way it must turn the part.
function sticks({ part, found, anyWay }, which, now, edge, tip, side) {
  const { angle, d1, d2, rho, stretch, shear } = ofContact(part, tip, edge, now);
  const name = `tip_turns_part/${which}/${side > 0 ? "counter_clockwise" : "clockwise"}`;
  found.low(`tip_pushes/${which}`, tensor.normal_force(angle, d1, d2, rho, stretch, shear, 0)[0], "um²");
  found.low(`tip_sticks/${which}`,
    Math.min(...tensor.friction_margin(angle, d1, d2, rho, stretch, shear, 0, tip.mu)), "um²");
  found.low(name, anyWay.has(name) ? tensor.turns_any_way(d1, d2, tip.mu, side)[0]
    : tensor.turning(angle, d1, d2, stretch, shear, 0, side)[0], "um");
  found.low(`no_slipping/${which}`,
    Math.min(...tensor.only_solution(d1, d2, rho, stretch, shear, tip.mu)), "um²");
}

// The same of a tip that may slip while it turns the part to its own side; it touched at `first`. What
// it may have slipped by grows with the turn, and must grow faster than the slip does there.
function slips({ part, found, creep }, which, now, edge, tip, side, first) {
  const { angle, d1, d2, rho, stretch, shear } = ofContact(part, tip, edge, now);
  const name = `tip_turns_part/${which}/${side > 0 ? "counter_clockwise" : "clockwise"}`;
  const film = [rho, stretch, shear, 0, tip.mu, side];
  found.low(`tip_pushes/${which}`, Math.min(...tensor.slips_one_way(angle, d1, d2, ...film)), "um²");
  found.low(name, Math.min(...tensor.turns_back(angle, d1, d2, ...film.slice(1))), "um");
  const rolled = first.d2 - tip.r * (angle - first.angle);
  const farthest = rolled - tensor.slipped(angle, first.angle, creep[which])[0];
  found.low(`slip_bounded/${which}`,
    tensor.creeps_less(angle, d1, farthest, ...film, creep[which])[0], "um²");
}

const onEdge = ({ found }, which, edge, offset) =>
  found.low(`tip_on_edge/${which}`, room(edge, offset), "um");

// The tip that does not push passes the part: it is off the line of a side of the convex hull, in a tilt
// of the same one all the time.
function passes({ rule, part, tips, found }, now, when, idle, back = 0) {
  const point = tipAt(tips[idle], now.s - back);
  const values = clearances(part, now, point).map((far) => far - tips[idle].r);
  const name = `idle_tip_passes/${when}`;
  if (rule.action === "tilt") found.best(name, values, "um");
  else found.low(name, Math.max(...values), "um");
}

function passesBack(move, now, idle) {
  for (let i = 0; i <= WAYS_BACK; i++) passes(move, now, "on_withdrawal", idle, (now.s * i) / WAYS_BACK);
}

function tiltWatch(move) {
  const { rule, part, tips, length, start, found } = move, { side } = rule;
  const [pusher, idle] = side > 0 ? [1, 0] : [0, 1], tip = tips[pusher];
  const edge = facing(part, start.theta);
  const reach = tip.x - start.x
    - sticking.contact_reach(edgeAngle(start.theta, edge), edge.depth + tip.r, tip.y - start.y)[0];
  found.low("tip_reaches_part", length - reach, "um");
  onEdge(move, "pushing", edge, offsetAt(tip, edge, start));
  let touched = false;
  return {
    during(now, mode) {
      if (mode.kind === "rest") {
        passes(move, now, "before_touch", idle);
      } else if (mode.kind === "single" && mode.pusher === pusher) {
        touched = true;
        sticks(move, "pushing", now, edge, tip, side);
        onEdge(move, "pushing", edge, mode.offset(now));
        passes(move, now, "while_turning", idle);
      }
    },
    after(now) {
      withdrawn(found, "pushing", now, edge);
      if (touched) passesBack(move, now, idle);
    },
  };
}

function straightenWatch(move) {
  const { part, tips, length, start, found } = move, edge = facing(part, start.theta);
  let first = null, both = false, touch = null;
  const sideOf = (i) => (i === 0 ? 1 : -1);
  return {
    during(now, mode) {
      if (mode.kind === "single") {
        first ??= mode.pusher;
        const which = NAMES[mode.pusher], tip = tips[mode.pusher], side = sideOf(mode.pusher);
        touch ??= ofContact(part, tip, edge, now);
        if (move.creep[which] && mode.pusher === first) slips(move, which, now, edge, tip, side, touch);
        else sticks(move, which, now, edge, tip, side);
        onEdge(move, which, edge, mode.offset(now));
      }
      if (mode.kind === "pair" && !both) {
        both = true;
        found.low("second_tip_touches", length - now.s, "um");
        pairWatch(move, now, edge, first);
      }
    },
    after(now) {
      if (first !== null && !both) found.low("second_tip_touches", -LOOSE, "um");
      withdrawn(found, "pair", now, edge);
    },
  };
}

// What the walls do is not followed: a run that touches one ends in words.
function guideWatch({ part, start, found }) {
  const edge = facing(part, start.theta);
  return { during() {}, after: (now) => withdrawn(found, "pair", now, edge) };
}

function pairWatch(move, now, edge, first) {
  const { part, tips, found } = move;
  const { forces, sticks: friction } = pairForces(part, tips, 0, 1, edge, now);
  found.low("pair_sticks", friction(Math.min(tips[0].mu, tips[1].mu)), "");
  found.low("pair_pushes", Math.min(...forces), "um");
  [0, 1].filter((i) => i !== first).forEach((i) => {
    onEdge(move, NAMES[i], edge, offsetAt(tips[i], edge, now));
    sticks(move, NAMES[i], now, edge, tips[i], i === 0 ? 1 : -1);
  });
}

function rotateWatch(move) {
  const { part, tips, length, start, found } = move, edge = facing(part, start.theta);
  const grip = gripOf(tips, 1, 2, edge, behind(part, start.theta)), idle = 0;
  const hEnd = grip.across(length);
  let touched = null;
  const rests = "rests_before_end";
  const across = [edge.depth + grip.other.depth, tips[1].r + tips[2].r, Math.min(tips[1].mu, tips[2].mu)];
  found.low("no_jam", edges.no_jam(grip.V, ...across)[0], "um");
  return {
    during(now, mode) {
      if (mode.kind === "rest") {
        passes(move, now, "before_touch", idle);
      } else if (mode.kind === "single" && mode.pusher === 1) {
        onEdge(move, "active", edge, mode.offset(now));
        passes(move, now, "early_in_turn", idle);
        if (touched === null) aloneWatch(move, now, edge, tips[1]);
      } else if (mode.kind === "grip") {
        if (touched === null) {
          touched = grip.across(now.s);
          found.low(rests, touched - hEnd, "um");
        }
        gripWatch(move, grip, now);
        const early = grip.across(now.s) >= touched - 0.15 * (touched - hEnd);
        passes(move, now, early ? "early_in_turn" : "late_in_turn", idle);
      }
    },
    after(now) {
      if (touched === null) found.low(rests, -LOOSE, "um");
      withdrawn(found, "both", now, edge);
      passesBack(move, now, idle);
    },
  };
}

function aloneWatch({ part, found }, now, edge, tip) {
  const { angle, d1, d2, rho, stretch, shear } = ofContact(part, tip, edge, now);
  found.low("pushes_until_rest", tensor.normal_force(angle, d1, d2, rho, stretch, shear, 0)[0], "um²");
  found.low("unique_until_rest",
    Math.min(...tensor.only_solution(d1, d2, rho, stretch, shear, tip.mu)), "um²");
}

// The force at the passive tip is monotone in both friction ratios: the corners are enough.
function gripWatch({ part, tips, found }, grip, now) {
  const contacts = gripContacts(part, tips, grip, now);
  const corners = [-1, 1].flatMap((d) => [-1, 1].map((s) => balanced(part, contacts, [d, s]).press[1]));
  found.low("both_tips_touch", Math.min(...corners), "");
  found.low("both_tips_on_edges", gripRoom(contacts), "um");
}

function regraspWatch({ part, tips, found }) {
  return {
    during(now) {
      NAMES.forEach((name, i) => found.low(`tip_clear_of_part/${name}`,
        offLine(part, now, tipAt(tips[i], now.s)) - tips[i].r, "um"));
    },
    after() {},
  };
}
