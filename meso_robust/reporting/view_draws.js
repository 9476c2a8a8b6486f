// What is uncertain: one value of everything (a draw, as Draws has it; um and rad), and its knobs.
const DEG = Math.PI / 180, MOVES = data.rules.length;
const middle = ([low, high]) => (low + high) / 2;
const halfWidth = ([low, high]) => (high - low) / 2;

function nominalDraw() {
  const each = (length) => data.rules.map(() => new Array(length).fill(0));
  return { start: [...data.start], friction: middle(data.ranges.friction),
    film_ratio: middle(data.ranges.film_ratio),
    misalignment: middle(data.ranges.misalignment) * DEG,
    sensing: each(3), dual: each(2), single: each(2) };
}

// A knob: what it shows and sets, in um, deg or plain. `of` names the uncertainty of the task.
const constant = (name, label, unit, digits, factor = 1) => ({ group: "constant", of: name, label, unit,
  digits, places: () => [0], get: (draw) => draw[name] / factor,
  set: (draw, value) => { draw[name] = value * factor; } });

const start = (i, label, unit, digits, of, factor) => ({ group: "start", of, label, unit, digits,
  reversed: true, places: () => [0], get: (draw) => (draw.start[i] - data.start[i]) / factor,
  set: (draw, value) => {
    draw.start[i] = data.start[i] + value * factor;
    draw.sensing[0][i] = data.start[i] - draw.start[i]; // the pose sensed first is the task's
  } });

const error = (name, i, label, unit, digits, of, factor, has) => ({ group: "move", of, label, unit, digits,
  places: (which) => data.rules.map((_, k) => k).filter((k) => has(k) && (which === "all" || which === k)),
  get: (draw, k) => draw[name][k][i] / factor,
  set: (draw, value, k) => { draw[name][k][i] = value * factor; } });

const sensedAgain = (k) => k > 0, always = () => true, held = (k) => Boolean(data.rules[k].single_x);
const KNOBS = [
  constant("friction", "friction µ", "", 3),
  constant("film_ratio", "film ratio ρ", "µm²", 0),
  constant("misalignment", "tip angle β", "°", 3, DEG),
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
].filter((knob) => knob.places("all").length > 0);

const rangeOf = (knob) => {
  const [low, high] = data.ranges[knob.of];
  return knob.reversed ? [-high, -low] : [low, high];
};

// How far a value is from the middle of its range, in half widths.
function share(knob, value) {
  const range = rangeOf(knob), off = Math.abs(value - middle(range)), half = halfWidth(range);
  return off <= 1e-9 * (half + Math.abs(middle(range))) ? 0 : off / half;
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
      const at = corner ? Math.round(Math.random()) : Math.random();
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
