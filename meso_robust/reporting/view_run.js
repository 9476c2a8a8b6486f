// A whole plan for one set of values, from contact mode to contact mode.
const STEP = 16; // um of travel at most between two instants
const SHORTEST = 0.5; // um: shorter steps are only taken to meet an event
const GRAZES = 1; // um: closer to a corner a free tip is not told to hit or to miss
const MOST_CHANGES = 60; // of the contact mode in a move
const LEAVES = "leaves what the closed forms describe: ";
const JAM = { jam: true, end: "jams: no contact mode lets the tips keep moving" };
const IN_NOTCH = "a tip comes between two corners of the part that no edge joins";

// Which mode follows from the tips that touch; what it cannot tell ends the run in words.
function modeOf(part, tips, touching, now) {
  const active = touching.filter(({ i }) => tips[i].active);
  const passive = touching.filter(({ i }) => !tips[i].active);
  if (!touching.every(({ edge }) => isEdge(edge))) return { end: LEAVES + IN_NOTCH };
  if (active.length === 0) return rest();
  if (touching.length > 2) return { end: LEAVES + "three tips touch the part" };
  if (active.length === 2) return modeOfPair(part, tips, active, now);
  const { i, edge } = active[0], alone = single(part, tips, i, edge, now);
  if (passive.length === 0) return alone;
  return modeOfGrip(part, tips, { D: i, S: passive[0].i, edge, other: passive[0].edge }, alone, now);
}

function modeOfPair(part, tips, active, now) {
  const [upper, lower] = active.map(({ i }) => i).sort((a, b) => tips[b].y - tips[a].y);
  const { edge } = active[0];
  if (active[1].edge.turn !== edge.turn) return { end: LEAVES + "the tips touch two edges" };
  const { forces, sticks } = pairForces(part, tips, upper, lower, edge, now);
  if (forces[0] <= 0) return single(part, tips, lower, edge, now);
  if (forces[1] <= 0) return single(part, tips, upper, edge, now);
  if (!(sticks(Math.min(tips[upper].mu, tips[lower].mu)) > 0)) {
    return { end: LEAVES + "the pair of tips slips" };
  }
  return pair(upper, lower, edge, now);
}

function modeOfGrip(part, tips, { D, S, edge, other }, alone, now) {
  if (!opposite(edge, other)) return { end: LEAVES + "the tips touch edges that are not opposite" };
  const grip = gripOf(tips, D, S, edge, other), contacts = gripContacts(part, tips, grip, now);
  const best = bestWays(part, contacts);
  if (best.slack > -EVEN) return gripped(part, tips, grip, best.ways);
  const closing = dot(other.out, balanced(part, contacts.slice(0, 1), alone.ways).at(contacts[1]));
  return closing <= 0 ? alone : JAM;
}

// Tips that the moving part may meet.
const freeTips = (tips, mode) => mode.kind === "rest" ? []
  : tips.map((_, i) => i).filter((i) => !mode.touching.some(([used]) => used === i));

// No free tip comes a quarter of its way to the part closer in one step, so none is jumped over.
function longest(part, tips, mode, now) {
  const gaps = freeTips(tips, mode).map((i) => gap(part, now, tipAt(tips[i], now.s)) - tips[i].r);
  return Math.min(STEP, Math.max(SHORTEST, Math.min(...gaps) / 4));
}

// What must stay positive in any mode: the tips that do not touch stay clear, and nothing meets a wall.
function freedom(part, tips, mode, walls, now) {
  const clear = freeTips(tips, mode).flatMap((i) => {
    const point = tipAt(tips[i], now.s);
    return [[gap(part, now, point) - tips[i].r + LOOSE, { touch: i }],
      [cornerDistance(part, now, point) - tips[i].r - GRAZES, { end: LEAVES + "a tip grazes a corner" }]];
  });
  const apart = Math.min(walls.part(now), ...tips.map((tip) => walls.tip(tipAt(tip, now.s)) - tip.r));
  return [...clear, [apart, { end: "touches a wall of the slot, which the closed forms leave out" }]];
}

function firstBroken(part, tips, mode, walls, now) {
  if (![now.x, now.y, now.theta].every(Number.isFinite)) {
    return mode.kind === "grip" ? JAM : { end: LEAVES + "no finite pose" };
  }
  const found = [...mode.guards(now), ...freedom(part, tips, mode, walls, now)]
    .find(([value]) => !(value > 0));
  return found ? found[1] : null;
}

// One step: to its end, or to where the first guard breaks (found by bisection).
function stepped(part, tips, mode, walls, now, whole) {
  const broken = (state) => firstBroken(part, tips, mode, walls, state);
  let next = mode.advance(now, whole), why = broken(next);
  if (!why) return [next, null];
  for (let from = now, width = whole, i = 0; i < 60 && width > 1e-11; i++) {
    const there = mode.advance(from, width / 2), how = broken(there);
    width /= 2;
    if (how) { next = there; why = how; } else from = there;
  }
  return [next, why];
}

// While the part rests, the next touch is known in closed form.
function nextTouch(part, tips, now) {
  return tips.map((tip, i) => ({ i, ...(tip.active ? flight(part, now, tip, tipAt(tip, now.s)) : { travel: Infinity }) }))
    .reduce((first, other) => (other.travel < first.travel ? other : first));
}

// One move in its own axes. `seen` is shown every instant with its mode.
function runMove(part, tips, length, walls, start, seen) {
  let now = { s: 0, ...start }, mode = rest(), touching = [];
  seen(now, mode);
  for (let changes = 0; changes < MOST_CHANGES;) {
    let whole = Math.min(longest(part, tips, mode, now), length - now.s), touch = null;
    if (mode.kind === "rest") {
      const next = nextTouch(part, tips, now);
      if (next.travel <= whole) [whole, touch] = [next.travel, next.corner
        ? { end: LEAVES + "a tip meets a corner" } : { touch: next.i }];
    }
    const [next, why] = stepped(part, tips, mode, walls, now, whole);
    if (why === JAM) return { now, mode, ...JAM };
    now = next;
    seen(now, mode);
    const change = why || touch;
    if (change && change.end) return { now, mode, ...change };
    if (change) {
      changes += 1;
      if (change.touch !== undefined) touching.push({ i: change.touch,
        edge: nearestLine(part, now, tipAt(tips[change.touch], now.s)) });
      mode = modeOf(part, tips, touching, now);
      if (mode.end) return { now, mode: rest(), end: mode.end, jam: mode.jam };
      touching = touching.filter(({ i }) => mode.touching.some(([used]) => used === i));
      seen(now, mode);
    }
    if (now.s >= length) return { now, mode, end: null };
  }
  return { now, mode, end: LEAVES + "the contact mode changes too often" };
}

// Where the probes really go in a move, in its own axes, for the pose sensed before it.
function tipsOf(rule, frame, sensed, draw, k) {
  const [x, y] = frame.stated(sensed);
  const aim = (one, base) => (one.relative_to === "world" ? 0 : base) + one.offset_um;
  const half = draw.spacing / 2, lead = half * Math.tan(frame.sign * draw.misalignment);
  const middle = [aim(rule.dual_x, x), aim(rule.dual_y, y)];
  const places = [[middle[0] - lead, middle[1] + half], [middle[0] + lead, middle[1] - half]];
  if (rule.single_x) places.push([aim(rule.single_x, x), aim(rule.single_y, y)]);
  const tips = places.map((place, i) => {
    const error = frame.stated(i < 2 ? draw.dual[k] : draw.single[k]);
    const [u, v] = frame.fromStated(combined(1, place, 1, error));
    // the draw has the tip on the right first, seen along the push: the lower one in mirrored axes
    const drawn = frame.sign < 0 && i < 2 ? 1 - i : i;
    return { x: u, y: v, active: i < 2, r: draw.radius[drawn], mu: draw.friction[drawn] };
  });
  return { tips, length: (middle[0] - aim(rule.dual_end_x, x)) * (1 + draw.scale[k]) };
}

function wallsOf(task, draw, frame) {
  const part = partOf(task, draw, false); // the walls stand in the world's axes
  const worldPose = (own) => {
    const [x, y] = frame.toWorld([own.x, own.y]);
    return { x, y, theta: frame.angleToWorld(own.theta) };
  };
  const least = (distance) => Math.min(Infinity, ...task.walls.map(distance));
  return { part: (own) => least((wall) => wallDistance(part, worldPose(own), wall)),
    tip: (own) => least((wall) => pointToWall(frame.toWorld(own), wall)) };
}

// The plan: task {corners, hull, corner_radius, walls}, rules as plan.json states them, draw as Draws has it.
function runPlan(task, rules, draw) {
  const moves = [];
  let pose = draw.start, end = null;
  for (let k = 0; k < rules.length && !end; k++) {
    const sensed = pose.map((value, i) => value + draw.sensing[k][i]);
    const move = oneMove(task, rules[k], pose, sensed, draw, k);
    moves.push(move);
    end = move.end;
    pose = move.after;
  }
  return { moves, final: pose, end };
}

// Why the probes cannot start a move where they stand; null if they can.
function hindrance(part, tips, length, start) {
  const within = tips.filter(({ x, y, r }) => gap(part, start, [x, y]) < r).map(({ x, y }) => [x, y]);
  const hollow = part.lines.some((line) => !isEdge(line));
  if (within.some((point) => !hollow || inPart(part, start, point))) {
    return { inside: true, end: "a probe would start inside the part" };
  }
  if (within.length > 0) return { end: LEAVES + IN_NOTCH };
  return length > 0 ? null : { end: LEAVES + "the probe does not push" };
}

function oneMove(task, rule, pose, sensed, draw, k) {
  const frame = frameOf(rule, draw.direction[k]), { tips, length } = tipsOf(rule, frame, sensed, draw, k);
  const [x, y] = frame.toOwn(pose), start = { x, y, theta: frame.angleToOwn(pose[2]) };
  const part = partOf(task, draw, frame.sign < 0);
  const walls = wallsOf(task, draw, frame), path = [], found = conditions();
  const anyWay = new Set(rule.any_way || []), creep = rule.creep || {};
  const watch = watcher({ rule, part, tips, length, walls, start, found, anyWay, creep });
  const hindered = hindrance(part, tips, length, start);
  const done = hindered ? { now: { s: 0, ...start }, mode: rest(), ...hindered }
    : runMove(part, tips, length, walls, start, (now, mode) => {
      path.push({ ...now, codes: codes(tips, mode, frame) });
      watch.during(now, mode);
    });
  if (path.length === 0) path.push({ ...done.now, codes: codes(tips, done.mode, frame) });
  watch.after(done.now, done.mode, done.end);
  const world = (own) => [...frame.toWorld([own.x, own.y]), frame.angleToWorld(own.theta)];
  return {
    end: done.end, jam: Boolean(done.jam), inside: Boolean(done.inside), share: length > 0 ? done.now.s / length : 0,
    path: path.map((now) => ({ s: now.s / length, pose: world(now), codes: now.codes })),
    after: world(done.now), conditions: found.all,
    tips: tips.map((tip) => frame.toWorld([tip.x, tip.y])),
    travel: tips.map((tip) => frame.toWorld([tip.active ? -length : 0, 0])),
    radii: tips.map(({ r }) => r),
  };
}

// What every tip does, seen in the world: a mirror swaps left and right.
function codes(tips, mode, frame) {
  const swapped = [SEPARATE, STICK, SLIP_RIGHT, SLIP_LEFT];
  const found = tips.map(() => SEPARATE);
  for (const [i, code] of mode.touching) found[i] = frame.sign < 0 ? swapped[code] : code;
  return found;
}
