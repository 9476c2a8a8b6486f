// Time and controls of a player; what is drawn stands in player_scene.js and player_strip.js.
// The page brings `data` (moves, probes, part, arm, goal, extent) and `run()`, the run that is shown.
const at = (id) => document.getElementById(id);
const MODES = [
  { name: "separate", color: "--separate" },
  { name: "stick", color: "--stick" },
  { name: "slip +", color: "--plus" },
  { name: "slip −", color: "--minus" },
];
const SPEEDS = [0.5, 1, 2, 4, 8, 16];
const BAND = 24, GAP = 8, HEAD = 20;
const state = { time: 0, playing: false, speed: 4, last: 0 };
const scene = at("scene"), strip = at("strip"), slider = at("position");
const still = matchMedia("(prefers-reduced-motion: reduce)");

// Time: moves follow each other without a break, each as long as the plan says.
const ends = [];
let total = 0;
for (const move of data.moves) { total += move.seconds; ends.push(total); }

const startOf = (k) => (k > 0 ? ends[k - 1] : 0);
const moveAt = (time) => {
  const k = ends.findIndex((end) => time < end);
  return k < 0 ? data.moves.length - 1 : k;
};

// When a run ends: at its jam, or with the last move.
function endOf(one) {
  const last = one.moves.length - 1;
  return startOf(last) + one.moves[last].stop * data.moves[last].seconds;
}

// Where everything is at a time.
function instant(time) {
  const one = run();
  const shown = Math.min(time, endOf(one));
  const k = Math.min(moveAt(shown), one.moves.length - 1);
  const move = one.moves[k];
  const seconds = data.moves[k].seconds;
  const share = Math.min((shown - startOf(k)) / seconds, move.stop);
  const place = share * (move.x.length - 1);
  const i = Math.min(Math.floor(place), Math.max(move.x.length - 2, 0));
  const f = move.x.length > 1 ? place - i : 0;
  const mix = (list) => (list.length > 1 ? list[i] + f * (list[i + 1] - list[i]) : list[0]);
  // at its end a run shows what held it, not what was recorded after it
  const nearest = share < move.stop || move.stop === 1 ? Math.round(place) : Math.floor(place);
  return {
    k, share,
    over: time >= endOf(one) && one.moves.length - 1 === k,
    pose: [mix(move.x), mix(move.y), mix(move.t)],
    tips: move.tips.map((tip, p) => [
      tip[0] + share * move.travel[p][0], tip[1] + share * move.travel[p][1]]),
    radii: move.radii || [],
    modes: move.modes.map((text) => Number(text[nearest])),
  };
}

const css = (name) => getComputedStyle(scene).getPropertyValue(name).trim();

function prepared(canvas, height) {
  const width = canvas.parentElement.clientWidth;
  const dense = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(width * dense) || canvas.height !== Math.round(height * dense)) {
    canvas.width = Math.round(width * dense);
    canvas.height = Math.round(height * dense);
    canvas.style.height = height + "px";
  }
  const draw = canvas.getContext("2d");
  draw.setTransform(dense, 0, 0, dense, 0, 0);
  draw.clearRect(0, 0, width, height);
  return [draw, width];
}

function say(id, words) { if (at(id).textContent !== words) at(id).textContent = words; }

const fixed = (value, digits) => {
  const words = value.toFixed(digits);
  return (Number(words) === 0 ? (0).toFixed(digits) : words).replace("-", "−");
};

function drawReadout(now) {
  const move = data.moves[now.k];
  say("now-move", (now.k + 1) + " of " + data.moves.length + ", " + move.name);
  say("now-time", fixed(Math.min(state.time, total), 1) + " of " + fixed(total, 1) + " s");
  say("now-x", fixed(now.pose[0], 1));
  say("now-y", fixed(now.pose[1], 1));
  say("now-theta", fixed(now.pose[2], 2));
  const parts = move.probes.map((name, p) =>
    name + ": " + MODES[now.modes[p]].name);
  const shown = at("now-modes");
  if (shown.dataset.words !== parts.join("|")) {
    shown.dataset.words = parts.join("|");
    shown.replaceChildren(...parts.map((words) => {
      const item = document.createElement("span");
      item.textContent = words;
      return item;
    }));
  }
}

function draw() {
  const now = instant(state.time);
  drawScene(now);
  drawStrip(now, state.time);
  drawReadout(now);
  slider.value = String(Math.round((1000 * state.time) / total));
  slider.setAttribute("aria-valuetext",
    "move " + (now.k + 1) + ", " + Math.round(100 * now.share) + " percent");
}

function play(on) {
  if (on && state.time >= endOf(run()) - 1e-9) state.time = 0;
  state.playing = on;
  state.last = performance.now();
  at("play").textContent = on ? "Pause" : "Play";
  at("play").setAttribute("aria-pressed", String(on));
  if (on) requestAnimationFrame(tick);
  draw();
}

function tick(clock) {
  if (!state.playing) return;
  state.time = Math.min(later(clock), endOf(run()));
  if (state.time >= endOf(run()) - 1e-9) { stop(); return; }
  draw();
  requestAnimationFrame(tick);
}

// The time that a clock has come to since it was last read; a second a move for who wants no motion.
function later(clock) {
  const passed = clock - state.last;
  if (still.matches && passed < 1000) return state.time;
  state.last = clock;
  // a hidden tab pauses the clock: no leap when it comes back
  return still.matches ? mark(state.time, 1)
    : state.time + (Math.min(Math.max(passed, 0), 100) / 1000) * state.speed;
}

function stop() {
  state.playing = false;
  at("play").textContent = "Play";
  at("play").setAttribute("aria-pressed", "false");
  draw();
}

function goTo(time) { state.time = Math.min(Math.max(time, 0), total); draw(); }

// The end of a move after (way = 1) or before (-1) a time.
function mark(time, way) {
  const marks = [0, ...ends], near = 1e-6 * total;
  return way > 0 ? marks.find((end) => end > time + near) ?? total
    : marks.reverse().find((end) => end < time - near) ?? 0;
}

const jump = (way) => goTo(mark(state.time, way));

// `upDown` is called with 1 or -1 for the arrows down and up.
function keyed(event, upDown) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const on = event.target;
  if (on instanceof HTMLSelectElement || (on instanceof HTMLInputElement && on !== slider)) return;
  if (on instanceof HTMLButtonElement && (event.key === " " || event.key === "Enter")) return;
  const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  const other = upDown && { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (event.key === " ") play(!state.playing);
  else if (way) event.shiftKey ? jump(way) : goTo(state.time + way * total / 200);
  else if (other) upDown(other);
  else if (event.key === "Home") goTo(0);
  else if (event.key === "End") goTo(total);
  else return;
  event.preventDefault();
}

function scrubbed(event) {
  const box = strip.getBoundingClientRect();
  goTo((total * (event.clientX - box.left)) / box.width);
}

function option(list, value, words) {
  const item = document.createElement("option");
  item.value = value;
  item.textContent = words;
  list.append(item);
}

function drawLegend() {
  at("legend").replaceChildren(...MODES.map((mode, k) => {
    const item = document.createElement("li"), swatch = document.createElement("canvas");
    const dense = window.devicePixelRatio || 1;
    swatch.setAttribute("aria-hidden", "true"); // its name stands beside it
    swatch.width = 34 * dense;
    swatch.height = 16 * dense;
    const pen = swatch.getContext("2d");
    pen.scale(dense, dense);
    band(pen, k, 0, 0, 34, 16);
    item.append(swatch, mode.name);
    return item;
  }));
}

function fillPlayer() {
  SPEEDS.forEach((speed) => option(at("speed"), String(speed), speed + " ×"));
  at("speed").value = String(state.speed);
  at("names").replaceChildren(...data.probes.map((name, p) => {
    const item = document.createElement("span");
    item.textContent = item.title = name;
    item.style.top = HEAD + p * (BAND + GAP) + (BAND + GAP) / 2 + "px";
    return item;
  }));
}

// Keys are taken where `root` has the focus.
function listenPlayer(root, upDown) {
  at("play").addEventListener("click", () => play(!state.playing));
  at("speed").addEventListener("change", (event) => { state.speed = Number(event.target.value); });
  slider.addEventListener("input", () => goTo((total * Number(slider.value)) / 1000));
  strip.addEventListener("pointerdown", (event) => {
    strip.setPointerCapture(event.pointerId);
    scrubbed(event);
  });
  strip.addEventListener("pointermove", (event) => { if (event.buttons) scrubbed(event); });
  root.addEventListener("keydown", (event) => keyed(event, upDown));
  window.addEventListener("resize", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    drawLegend();
    draw();
  });
}
