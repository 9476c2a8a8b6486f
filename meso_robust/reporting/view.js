// The view of a plan: knobs, the run at their values, and the player that shows it.
const INSTANTS = 160; // of a move that are drawn
const WORST_OF = 200, SLICE = 24; // random runs, and milliseconds before the page is let breathe
let draw_ = nominalDraw(), which = "all", shown = null, searching = 0;
const run = () => shown;
data.part = data.task.corners;

function inGoal(one) {
  if (one.end) return false;
  const { goal } = data, [x, y, theta] = one.final;
  return Math.abs(x - goal.x) <= goal.dx && Math.abs(y - goal.y) <= goal.dy
    && Math.abs(theta / DEG - goal.theta) <= goal.dtheta;
}

// The largest miss in tolerances: above 1 the goal is missed; early ends are worst.
function badness(one) {
  if (one.end) return 1e6 - one.moves.length;
  const { goal } = data, [x, y, theta] = one.final;
  return Math.max(Math.abs(x - goal.x) / goal.dx, Math.abs(y - goal.y) / goal.dy,
    Math.abs(theta / DEG - goal.theta) / goal.dtheta);
}

// A run at the instants that the player shows, in um and deg.
function played(one) {
  return { made: one, words: one.end || (inGoal(one) ? "ends in the goal" : "misses the goal"),
    moves: one.moves.map((move) => {
      const stop = Math.min(Math.max(move.share, 0), 1);
      const seen = sampled(move.path);
      return { x: seen.map(({ pose }) => pose[0]), y: seen.map(({ pose }) => pose[1]),
        t: seen.map(({ pose }) => pose[2] / DEG), tips: move.tips, travel: move.travel, radii: move.radii,
        stop: move.end ? stop : 1,
        modes: move.tips.map((_, p) => seen.map(({ codes }) => codes[p]).join("")) };
    }) };
}

function sampled(path) {
  const found = [];
  for (let i = 0, k = 0; i <= INSTANTS; i++) {
    const s = i / INSTANTS;
    while (k < path.length - 2 && path[k + 1].s < s) k += 1;
    const one = path[k], next = path[Math.min(k + 1, path.length - 1)];
    const f = next.s > one.s ? Math.min(Math.max((s - one.s) / (next.s - one.s), 0), 1) : 1;
    found.push({ codes: f >= 1 ? next.codes : one.codes,
      pose: one.pose.map((value, j) => value + f * (next.pose[j] - value)) });
  }
  return found;
}

function show(keep) {
  const one = runPlan(data.task, data.rules, draw_);
  shown = played(one);
  if (keep) remember(one);
  const said = promise(draw_), good = inGoal(one);
  at("box-tag").className = "tag " + (said.good ? "good" : "open");
  say("box-tag", said.tag);
  say("box-words", said.words);
  at("end-tag").className = "tag " + (good ? "good" : "bad");
  say("end-tag", good ? "✓ ends in the goal" : one.end ? "✕ ends early" : "✕ misses the goal");
  const [x, y, theta] = one.final;
  say("end-words", one.end ? `Move ${one.moves.length}: ${one.end}.`
    : `x ${fixed(x, 1)} µm, y ${fixed(y, 1)} µm, θ ${fixed(theta / DEG, 2)}°: `
      + `at ${fixed(100 * badness(one), 0)} % of the tolerance.`);
  showMargins(one);
  draw();
}

// A slider can move more often than frames are drawn: at most one run a frame.
let waiting = false;

function soon() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    show(true);
  });
}

// -- knobs ---------------------------------------------------------------------------------------

const WIDTHS = 2.5; // half widths that a slider reaches on either side

function limits(knob) {
  if (knob.free) return knob.free;
  const ends = rangeOf(knob), centre = middle(ends);
  const half = halfWidth(ends) || 0.1 * Math.abs(centre) || 1;
  const least = knob.positive ? 0.02 * centre : -Infinity;
  return [Math.max(centre - WIDTHS * half, least), centre + WIDTHS * half];
}

// The stated range, as the task's file has it.
function stated(knob) {
  if (knob.free) return "any";
  const [low, high] = rangeOf(knob), short = (value) => String(Number(value.toPrecision(4)));
  if (knob.of === "film_ratio") return `± ${short((100 * halfWidth([low, high])) / middle([low, high]))} %`;
  return Math.abs(low + high) < 1e-9 * (high - low) ? "± " + short(high)
    : `${short(low)} … ${short(high)}`.replaceAll("-", "−");
}

function makeKnob(knob, i) {
  const row = element(at("knobs-" + knob.group), "div", "knob");
  const label = element(row, "label", "", knob.label + " ");
  element(label, "small", "", stated(knob));
  const input = element(row, "input");
  const value = element(row, "output");
  input.type = "range";
  input.id = label.htmlFor = value.htmlFor = "knob-" + i;
  const [low, high] = limits(knob), ends = rangeOf(knob);
  [input.min, input.max, input.step] = [low, high, (high - low) / 200];
  const percent = (end) => ((end - low) / (high - low)).toFixed(4);
  input.style.setProperty("--low", percent(ends[0]));
  input.style.setProperty("--high", percent(ends[1]));
  input.addEventListener("input", () => {
    knob.places(which).forEach((k) => knob.set(draw_, Number(input.value), k));
    searching += 1; // a search that still runs is given up
    showKnobs();
    soon();
  });
  Object.assign(knob, { row, input, value });
}

function showKnobs() {
  for (const knob of KNOBS) {
    const places = knob.places(which), values = places.map((k) => knob.get(draw_, k));
    knob.row.classList.toggle("off", places.length === 0);
    knob.input.disabled = places.length === 0;
    if (places.length === 0) { write(knob.value, "—"); continue; }
    const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
    const mixed = values.some((value) => Math.abs(value - mean) > 1e-9 * (1 + Math.abs(mean)));
    const most = Math.max(...values.map((value) => share(knob, value)));
    const words = mixed ? "varies" : fixed(mean, knob.digits) + (knob.unit && " " + knob.unit);
    if (Number(knob.input.value) !== mean) knob.input.value = String(mean);
    knob.input.setAttribute("aria-valuetext", words);
    knob.row.classList.toggle("beyond", most > 1 + 1e-9);
    write(knob.value, words + (most > 1 + 1e-9 ? ` × ${fixed(most, 1)}` : ""));
  }
}

function take(next) {
  draw_ = next;
  showKnobs();
  show(true);
}

// Runs are tried in slices, so that the page answers meanwhile.
function searchWorst() {
  const mine = ++searching;
  let worst = null, left = WORST_OF;
  at("worst").disabled = true;
  const slice = () => {
    const end = performance.now() + SLICE;
    while (left > 0 && mine === searching && performance.now() < end) {
      const next = randomDraw(true), one = runPlan(data.task, data.rules, next);
      remember(one);
      if (!worst || badness(one) > worst.miss) worst = { next, miss: badness(one) };
      left -= 1;
    }
    say("worst", left ? `${WORST_OF - left} of ${WORST_OF} …` : "Worst of " + WORST_OF);
    if (mine !== searching || left === 0) {
      at("worst").disabled = false;
      say("worst", "Worst of " + WORST_OF);
      if (mine === searching) take(worst.next);
      return;
    }
    setTimeout(slice);
  };
  slice();
}

function listenView() {
  const pick = (id, make) => at(id).addEventListener("click", () => { searching += 1; take(make()); });
  pick("nominal", nominalDraw);
  pick("inside", () => randomDraw(false));
  pick("corner", () => randomDraw(true));
  at("worst").addEventListener("click", searchWorst);
  at("knobs").addEventListener("submit", (event) => event.preventDefault());
  const redraw = () => showMargins(shown.made);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  option(at("which"), "all", "every move");
  data.moves.forEach((move, k) => option(at("which"), String(k), `move ${k + 1}, ${move.name}`));
  at("which").addEventListener("change", (event) => {
    which = event.target.value === "all" ? "all" : Number(event.target.value);
    showKnobs();
  });
}

// -- the scene -----------------------------------------------------------------------------------

layers.push((pen, seen) => {
  data.moves.forEach(({ box, proved }, k) => {
    if (!box) return;
    const [x, y] = seen.to(box[0][0], box[1][1]), [u, v] = seen.to(box[0][1], box[1][0]);
    pen.strokeStyle = pen.fillStyle = css("--box");
    pen.lineWidth = 1.6;
    pen.setLineDash(proved ? [] : [4, 3]);
    pen.strokeRect(x - 1, y - 1, u - x + 2, v - y + 2);
    pen.setLineDash([]);
    text(pen, String(k + 1), u + 8, v + 13, "left");
  });
});

// Everything that the nominal run touches, and some room for other runs.
function extentOf(one) {
  const reach = Math.max(...data.part.map(([x, y]) => Math.hypot(x, y))), xs = [data.goal.x], ys = [data.goal.y], tips = [];
  for (const move of one.moves) {
    move.path.forEach(({ pose }) => { xs.push(pose[0]); ys.push(pose[1]); });
    tips.push(...move.tips);
  }
  const around = (values, i) => [Math.min(...values.map((v) => v - reach), ...tips.map((tip) => tip[i])),
    Math.max(...values.map((v) => v + reach), ...tips.map((tip) => tip[i]))];
  const [left, right] = around(xs, 0), [low, high] = around(ys, 1);
  return [left, low, right, high];
}

const nominalRun = runPlan(data.task, data.rules, draw_);
data.extent = extentOf(nominalRun);
state.speed = 8;
KNOBS.forEach(makeKnob);
makeCards(nominalRun);
listenView();
fillPlayer();
listenPlayer(at("view"));
drawLegend();
showKnobs();
show(false);
