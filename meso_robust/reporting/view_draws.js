// What is uncertain: one value of everything (a draw, as Draws has it; um and rad), and its knobs.
const DEG = Math.PI / 180, MOVES = data.rules.length;
const middle = ([low, high]) => (low + high) / 2;
const halfWidth = ([low, high]) => (high - low) / 2;

const EXACT = [0, 0]; // what a task does not state
const range = (name) => data.ranges[name] || EXACT;

function nominalDraw() {
  const each = (length) => data.rules.map(() => new Array(length).fill(0));
  const edges = data.task.corners.map(() => 0), active = middle(range("tip_radius"));
  return { start: [...data.start], friction: new Array(3).fill(middle(range("friction"))),
    film_ratio: middle(range("film_ratio")), misalignment: middle(range("misalignment")) * DEG,
    spacing: data.task.spacing + middle(range("tip_spacing")),
    radius: [active, active, middle(range("passive_tip_radius"))],
    size: [...edges], squareness: [...edges],
    centre: 0, bearing: 0, anisotropy: 0, axis: 0,
    direction: data.rules.map(() => middle(range("travel_direction")) * DEG), scale: data.rules.map(() => 0),
    sensing: each(3), dual: each(2), single: each(2) };
}

// A knob: what it shows and sets, in um, deg, percent or plain. `of` names the uncertainty of the task,
// whose range is in units of `times` of them; `places` are the entries of the draw that it sets.
const ONCE = () => [0], TIPS = ["dtp_top", "dtp_bottom", "stp"];
const constant = (name, of, label, unit, digits, factor = 1, more = {}) => ({ group: "constant", of, label, unit,
  digits, places: ONCE, get: (draw) => draw[name] / factor,
  set: (draw, value) => { draw[name] = value * factor; }, ...more });

const ofEach = (name, of, label, unit, digits, factor, entries, more = {}) => ({ group: "constant", of, label, unit,
  digits, places: () => entries, get: (draw, k) => draw[name][k] / factor,
  set: (draw, value, k) => { draw[name][k] = value * factor; }, ...more });

const start = (i, label, unit, digits, of, factor) => ({ group: "start", of, label, unit, digits,
  reversed: true, places: ONCE, get: (draw) => (draw.start[i] - data.start[i]) / factor,
  set: (draw, value) => {
    draw.start[i] = data.start[i] + value * factor;
    draw.sensing[0][i] = data.start[i] - draw.start[i]; // the pose sensed first is the task's
  } });

const inMoves = (label, unit, digits, of, has, get, set) => ({ group: "move", of, label, unit, digits, get, set,
  places: (which) => data.rules.map((_, k) => k).filter((k) => has(k) && (which === "all" || which === k)) });

const error = (name, i, label, unit, digits, of, factor, has) => inMoves(label, unit, digits, of, has,
  (draw, k) => draw[name][k][i] / factor, (draw, value, k) => { draw[name][k][i] = value * factor; });

const ofMove = (name, label, unit, digits, of, factor, more = {}) => ({ ...inMoves(label, unit, digits, of, always,
  (draw, k) => draw[name][k] / factor, (draw, value, k) => { draw[name][k] = value * factor; }), ...more });

const positive = { positive: true }, angle = { free: [0, 180] };
const sensedAgain = (k) => k > 0, always = () => true, held = (k) => Boolean(data.rules[k].single_x);
const EDGES = data.task.corners.map((_, k) => k), USED = data.rules.some((_, k) => held(k)) ? [0, 1, 2] : [0, 1];
const KNOBS = [
  ...(data.friction_common ? [{ ...constant("friction", "friction", "friction µ", "", 3, 1, positive),
    get: (draw) => draw.friction[0], set: (draw, value) => { draw.friction.fill(value); } }]
    : USED.map((k) => ofEach("friction", "friction", "µ, " + TIPS[k], "", 3, 1, [k], positive))),
  ...USED.map((k) => ofEach("radius", k < 2 ? "tip_radius" : "passive_tip_radius", "radius, " + TIPS[k],
    "µm", 1, 1, [k], positive)),
  constant("spacing", "tip_spacing", "tip spacing", "µm", 1, 1, { positive: true, about: data.task.spacing }),
  constant("film_ratio", "film_ratio", "film ratio ρ", "µm²", 0, 1, positive),
  constant("misalignment", "misalignment", "tip angle β", "°", 3, DEG),
  ofEach("size", "size", "edges out by", "µm", 2, 1, EDGES),
  ofEach("squareness", "squareness", "edges turned by", "°", 3, DEG, EDGES),
  constant("centre", "drag_centre", "drag centre off by", "µm", 1),
  constant("bearing", "drag_centre", "… towards", "°", 0, DEG, angle),
  constant("anisotropy", "drag_anisotropy", "anisotropy of the drag", "%", 2, 0.01, { times: 200 }),
  constant("axis", "drag_anisotropy", "… its axis", "°", 0, DEG, angle),
  start(0, "x", "µm", 1, "sensed_position", 1),
  start(1, "y", "µm", 1, "sensed_position", 1),
  start(2, "θ", "°", 2, "sensed_orientation", DEG),
  error("sensing", 0, "seen x", "µm", 1, "sensed_position", 1, sensedAgain),
  error("sensing", 1, "seen y", "µm", 1, "sensed_position", 1, sensedAgain),
  error("sensing", 2, "seen θ", "°", 2, "sensed_orientation", DEG, sensedAgain),
  error("dual", 0, "active probe x", "µm", 1, "probe_position", 1, always),
  error("dual", 1, "active probe y", "µm", 1, "probe_position", 1, always),
  error("single", 0, "passive tip x", "µm", 1, "probe_position", 1, held),
  error("single", 1, "passive tip y", "µm", 1, "probe_position", 1, held),
  ofMove("direction", "travel turned by", "°", 3, "travel_direction", DEG),
  ofMove("scale", "travel longer by", "%", 3, "travel_scale", 0.01, { times: 100 }),
].filter((knob) => data.ranges[knob.of] && knob.places("all").length > 0);

const rangeOf = (knob) => {
  if (knob.free) return knob.free;
  const [low, high] = range(knob.of).map((end) => (knob.about || 0) + end * (knob.times || 1));
  return knob.reversed ? [-high, -low] : [low, high];
};

// How far a value is from the middle of its range, in half widths.
function share(knob, value) {
  if (knob.free) return 0;
  const ends = rangeOf(knob), off = Math.abs(value - middle(ends)), half = halfWidth(ends);
  return off <= 1e-9 * (half + Math.abs(middle(ends))) ? 0 : off / half;
}

// The farthest of all values by uncertainty: 1 is the end of the stated range.
function shares(draw) {
  const found = {};
  for (const knob of KNOBS) {
    for (const k of knob.places("all")) {
      found[knob.of] = Math.max(found[knob.of] || 0, share(knob, knob.get(draw, k)));
    }
  }
  return found;
}

// Every value at random in its range: uniform, or at one of its ends.
function randomDraw(corner) {
  const draw = nominalDraw();
  for (const knob of KNOBS) {
    const [low, high] = rangeOf(knob);
    for (const k of knob.places("all")) {
      const at = corner && !knob.free ? Math.round(Math.random()) : Math.random();
      knob.set(draw, low + at * (high - low), k);
    }
  }
  return draw;
}

// What the certificate promises of these values.
function promise(draw) {
  const found = Object.entries(shares(draw)), proved = data.verdict === "PROVED";
  const outside = found.filter(([, value]) => value > 1 + 1e-9);
  if (outside.length === 0) {
    return proved ? { good: true, tag: "inside: proved", words:
      "All values lie in the stated ranges: the certificate promises that this run ends in the goal." }
      : { good: null, tag: "inside: not proved", words:
        `All values lie in the stated ranges, but the verdict is ${data.verdict}.` };
  }
  const [name, most] = outside.reduce((one, other) => (other[1] > one[1] ? other : one));
  const times = `${name.replaceAll("_", " ")} is × ${fixed(most, 2)} of its half width`;
  const { all, alone, told, toldAlone } = data.margin;
  const single = outside.length === 1 && alone[name] > all;
  const bears = single ? alone[name] : all;
  if (proved && most <= bears) {
    return { good: true, tag: "in the margin: proved", words:
      `Outside the stated ranges (${times}), but within the certified margin of × ${single ? toldAlone[name] : told}.` };
  }
  const more = outside.length > 1 ? ` (and ${outside.length - 1} more)` : "";
  return { good: null, tag: "outside: not promised",
    words: `Outside the stated ranges: ${times}${more}.` };
}
