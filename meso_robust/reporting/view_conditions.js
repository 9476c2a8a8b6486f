// What the certificate proves of each move, evaluated along one run: the least value of every
// inequality, under the name of its obligation (names.py). Units: um, um² or none.
function conditions() {
  const all = new Map();
  return { all, low(name, value, unit) {
    const known = all.get(name);
    if (!known || value < known.value) all.set(name, { value, unit });
  } };
}

const WAYS_BACK = 24; // instants of a withdrawal that are looked at
const NAMES = ["upper", "lower"];

function watcher(move) {
  const own = { tilt: tiltWatch, straighten: straightenWatch, rotate: rotateWatch,
    regrasp: regraspWatch }[move.rule.action](move);
  const { found, walls, tips } = move, { during } = own;
  if (move.rule.action !== "regrasp") freeAtStart(move);
  const clear = (now) => {
    if (walls.part(now) === Infinity) return;
    found.low("part_clear_of_walls", walls.part(now), "um");
    const least = Math.min(...tips.map((tip) => walls.tip(tipAt(tip, now.s))));
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
    const distance = clearance(seen, start, [tips[i].x, tips[i].y]);
    found.low(`tip_free_at_start/${name}`, distance, "um");
  });
}

const withdrawn = (found, tips, now, edge) =>
  found.low(`withdraws_free/${tips}`, Math.sin(edgeAngle(now.theta, edge)), "");

// One contact alone: `which` names it in the certificate, `side` is the way it must turn the part.
function sticks({ part, found }, which, now, edge, offset, side) {
  const angle = edgeAngle(now.theta, edge), { rho, mu } = part, d1 = edge.depth;
  const turn = side > 0 ? "counter_clockwise" : "clockwise";
  found.low(`tip_pushes/${which}`, onePoint.normal_force(angle, d1, offset, rho)[0], "um²");
  found.low(`tip_sticks/${which}`,
    Math.min(...onePoint.friction_margin(angle, d1, offset, rho, mu)), "um²");
  found.low(`tip_turns_part/${which}/${turn}`,
    onePoint.turning(angle, d1, offset, side)[0], "um");
  found.low(`no_slipping/${which}`,
    Math.min(...onePoint.only_solution(d1, offset, rho, mu)), "um²");
}

const onEdge = ({ found }, which, edge, offset) =>
  found.low(`tip_on_edge/${which}`, room(edge, offset), "um");

// The tip that does not push passes the part: it is off the line of a side of the convex hull.
function passes({ part, tips, found }, now, when, idle, back = 0) {
  const point = tipAt(tips[idle], now.s - back);
  found.low(`idle_tip_passes/${when}`, gap(part, now, point), "um");
}

function passesBack(move, now, idle) {
  for (let i = 0; i <= WAYS_BACK; i++) passes(move, now, "on_withdrawal", idle, (now.s * i) / WAYS_BACK);
}

function offsetOf(part, now, tip, edge) {
  return sticking.contact_offset(edgeAngle(now.theta, edge), edge.depth, tip.y - now.y)[0];
}

function tiltWatch(move) {
  const { rule, part, tips, length, start, found } = move, { side } = rule;
  const [pusher, idle] = side > 0 ? [1, 0] : [0, 1], tip = tips[pusher];
  const edge = facing(part, start.theta);
  const offset = offsetOf(part, start, tip, edge);
  const reach = tip.x - start.x
    - sticking.contact_reach(edgeAngle(start.theta, edge), edge.depth, tip.y - start.y)[0];
  found.low("tip_reaches_part", length - reach, "um");
  onEdge(move, "pushing", edge, offset);
  let last = null;
  return {
    during(now, mode) {
      if (mode.kind === "rest") {
        passes(move, now, "before_touch", idle);
      } else if (mode.kind === "single" && mode.pusher === pusher) {
        last = mode.offset(now);
        sticks(move, "pushing", now, edge, last, side);
        onEdge(move, "pushing", edge, last);
        passes(move, now, "while_turning", idle);
      }
    },
    after(now) {
      withdrawn(found, "pushing", now, edge);
      if (last !== null) passesBack(move, now, idle);
    },
  };
}

function straightenWatch(move) {
  const { part, tips, length, start, found } = move, edge = facing(part, start.theta);
  let first = null, both = false;
  const sideOf = (i) => (i === 0 ? 1 : -1);
  return {
    during(now, mode) {
      if (mode.kind === "single") {
        const offset = mode.offset(now), side = sideOf(mode.pusher), which = NAMES[mode.pusher];
        if (first === null) {
          first = mode.pusher;
          found.low("second_tip_touches",
            length - now.s - travelToBoth(part, tips, edge, now, offset), "um");
        }
        sticks(move, which, now, edge, offset, side);
        onEdge(move, which, edge, offset);
      }
      if (mode.kind === "pair" && !both) {
        both = true;
        pairWatch(move, now, mode, edge, first);
      }
    },
    after(now) { withdrawn(found, "pair", now, edge); },
  };
}

function travelToBoth(part, tips, edge, now, offset) {
  const aligned = QUARTER + Math.atan2(tips[1].x - tips[0].x, tips[0].y - tips[1].y);
  const [needed] = sticking.travel(edgeAngle(now.theta, edge), aligned, edge.depth, offset, part.rho);
  return Number.isFinite(needed) ? needed : Infinity;
}

function pairWatch(move, now, mode, edge, first) {
  const { part, tips, found } = move;
  found.low("pair_sticks", Math.min(...twoPoint.friction_margin(mode.beta, part.mu)), "");
  found.low("pair_pushes",
    Math.min(...pairForces(tips, 0, 1, edge, now, mode.offset).forces), "um");
  [0, 1].filter((i) => i !== first).forEach((i) => {
    const offset = offsetOf(part, now, tips[i], edge);
    onEdge(move, NAMES[i], edge, offset);
    sticks(move, NAMES[i], now, edge, offset, i === 0 ? 1 : -1);
  });
}

function rotateWatch(move) {
  const { part, tips, length, start, found } = move, edge = facing(part, start.theta);
  const grip = gripOf(tips, 1, 2, edge, behind(part, start.theta)), idle = 0;
  const hEnd = grip.across(length);
  let touched = null;
  const rests = "rests_before_end";
  found.low("no_jam",
    twoSided.no_jam(grip.V, edge.depth, part.mu)[0] * Math.sign(grip.V), "um²");
  return {
    during(now, mode) {
      if (mode.kind === "rest") {
        passes(move, now, "before_touch", idle);
      } else if (mode.kind === "single" && mode.pusher === 1) {
        onEdge(move, "active", edge, mode.offset(now));
        passes(move, now, "early_in_turn", idle);
        if (touched === null) aloneWatch(move, now, edge, mode.offset(now));
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
      if (touched === null) {
        const [h] = twoSided.pair_position(edgeAngle(now.theta, edge), grip.V, edge.depth);
        found.low(rests, Math.min(h - hEnd, -LOOSE), "um");
      }
      withdrawn(found, "both", now, edge);
      passesBack(move, now, idle);
    },
  };
}

function aloneWatch({ part, found }, now, edge, offset) {
  const { rho, mu } = part;
  found.low("pushes_until_rest",
    onePoint.normal_force(edgeAngle(now.theta, edge), edge.depth, offset, rho)[0], "um²");
  found.low("unique_until_rest",
    Math.min(...onePoint.only_solution(edge.depth, offset, rho, mu)), "um²");
}

// The force at the passive tip is monotone in both friction ratios: the corners are enough.
function gripWatch({ part, found }, grip, now) {
  const h = grip.across(now.s), sigma = slideOf(grip, now), { rho, mu } = part;
  const corners = [-mu, mu].flatMap((tauD) => [-mu, mu].map((tauS) =>
    twoSided.passive_force(h, grip.V, grip.d1, sigma, rho, tauD, tauS)[0]));
  found.low("both_tips_touch",
    Math.min(...corners), "");
  const [T] = twoSided.pair(h, grip.V, grip.d1);
  found.low("both_tips_on_edges", gripRoom(grip, T, sigma), "um");
}

function regraspWatch({ part, tips, found }) {
  return {
    during(now) {
      NAMES.forEach((name, i) => found.low(`tip_clear_of_part/${name}`,
        gap(part, now, tipAt(tips[i], now.s)), "um"));
    },
    after() {},
  };
}
