// A card a move: the least value of every proved inequality along the run, beside the nominal run's
// and the certificate's bound, and where the centre lands in the certified box.
const ZERO = 12, FULL = 68; // per cent of a bar's length: where it fails, and the nominal run
const SI = { um: 1e6, "um²": 1e12, "": 1 }; // of the bounds in the certificate
const cards = [];
let lowest = null; // the conditions of the nominal run, by move

function element(parent, name, kind, words) {
  const made = document.createElement(name);
  if (kind) made.className = kind;
  if (words !== undefined) made.textContent = words;
  parent.append(made);
  return made;
}

function write(node, words) { if (node.textContent !== words) node.textContent = words; }

const percentOf = (value, scale) =>
  Math.min(Math.max(ZERO + ((FULL - ZERO) * value) / scale, 0), 100);

function makeCards(nominal) {
  lowest = nominal.moves.map((move) => move.conditions);
  data.moves.forEach((move, k) => cards.push(makeCard(move, k)));
  cards.push(makeGoal());
}

function makeCard(move, k) {
  const card = element(at("sheets"), "details", "sheet");
  const head = element(card, "summary");
  element(head, "b", "", `${k + 1} · ${move.name}`);
  const tag = element(head, "span", "tag");
  const worst = makeRow(element(head, "div", "cond worst"));
  const landing = element(head, "canvas", "landing");
  landing.setAttribute("role", "img");
  landing.setAttribute("aria-label", `End of move ${k + 1}`);
  const where = element(head, "span", "where muted");
  const list = element(card, "div", "conds");
  const bounds = new Map(move.obligations);
  const keys = new Set([...bounds.keys(), ...(lowest[k] ? lowest[k].keys() : [])]);
  const rows = [...keys].map((key) => ({ key, claim: data.words[key], bound: bounds.get(key) ?? null,
    ...makeRow(element(list, "div", "cond"), data.words[key]) }));
  return { card, tag, worst, rows, landing, where };
}

function makeRow(row, claim = "") {
  const name = element(row, "span", "says", claim), meter = element(row, "span", "gauge");
  const bar = element(meter, "i"), mark = element(meter, "b"), value = element(row, "span", "value");
  return { row, name, bar, mark, value };
}

function makeGoal() {
  const card = element(at("sheets"), "div", "sheet"), head = element(card, "div", "head");
  element(head, "b", "", "The end · goal");
  const tag = element(head, "span", "tag"), list = element(card, "div", "conds");
  const { goal } = data, last = data.moves.at(-1);
  const middles = [goal.x, goal.y, goal.theta], reach = [goal.dx, goal.dy, goal.dtheta];
  const rows = ["x", "y", "θ"].map((name, i) => ({
    ...makeRow(element(list, "div", "cond"), `${name} keeps within ± ${reach[i]}${i < 2 ? " µm" : "°"} by`),
    middle: middles[i], reach: reach[i], unit: i < 2 ? " µm" : "°",
    bound: data.verdict === "PROVED" && last.box
      ? Math.min(reach[i] - (last.box[i][1] - middles[i]), reach[i] - (middles[i] - last.box[i][0]))
      : null }));
  return { card, tag, rows, goal: true };
}

// One bar: value against the nominal one; the mark is what is proved.
function showRow(row, value, scale, bound, words) {
  const at = value === null ? ZERO : percentOf(value, scale);
  row.bar.style.left = Math.min(at, ZERO) + "%";
  row.bar.style.width = Math.abs(at - ZERO) + "%";
  row.mark.hidden = bound === null;
  if (bound !== null) row.mark.style.left = percentOf(bound, scale) + "%";
  const failed = value !== null && !(value > 0);
  row.row.classList.toggle("failed", failed);
  write(row.value, value === null ? "not reached" : (failed ? "✕ " : "") + words);
}

function wordsOf(value, unit, scale) {
  if (!(Math.abs(value) < 20 * scale)) return value < 0 ? "≪ 0" : "≫ nominal";
  return unit === "um" ? fixed(value, 1) + " µm" : fixed((100 * value) / scale, 0) + " %";
}

function showCard(card, k, run) {
  const move = run.moves[k];
  let worst = null, failing = 0;
  for (const row of card.rows) {
    const now = move && move.conditions.get(row.key), before = lowest[k] && lowest[k].get(row.key);
    const unit = (now || before || { unit: "" }).unit;
    const bound = row.bound === null ? null : row.bound * SI[unit];
    const value = now ? now.value : null;
    const scale = before && before.value > 0 ? before.value
      : Math.max(Math.abs(value || 0), bound || 0) || 1;
    const words = value === null ? "" : wordsOf(value, unit, scale);
    showRow(row, value, scale, bound, words);
    if (value === null) continue;
    if (!(value > 0)) failing += 1;
    // how often the run could lose what the stated ranges take from the nominal value
    const failed = !(value > 0), room = value / Math.max(scale - (bound ?? scale), 1e-9 * scale);
    if (!worst || (failed && !worst.failed) || (room < worst.room && !worst.failed)) {
      worst = { room, failed, claim: row.claim, value, scale, bound, words };
    }
  }
  if (worst) {
    write(card.worst.name, (worst.failed ? "fails: " : "tightest: ") + worst.claim);
    showRow(card.worst, worst.value, worst.scale, worst.bound, worst.words);
  }
  card.worst.row.hidden = !worst;
  tell(card, move, failing);
}

function tell(card, move, failing) {
  const bad = Boolean(move && (move.end || failing));
  card.tag.className = "tag " + (bad ? "bad" : move ? "good" : "");
  write(card.tag, !move ? "not reached" : move.end ? "✕ ends here"
    : failing ? `✕ ${failing} fail${failing > 1 ? "" : "s"}` : "✓ all hold");
}

function showGoal(card, run) {
  const pose = run.end ? null : [run.final[0], run.final[1], run.final[2] / DEG];
  card.rows.forEach((row, i) => {
    const left = pose ? row.reach - Math.abs(pose[i] - row.middle) : null;
    showRow(row, left, row.reach, row.bound, left === null ? "" : fixed(left, i < 2 ? 1 : 2) + row.unit);
  });
  card.tag.className = "tag " + (inGoal(run) ? "good" : "bad");
  write(card.tag, run.end ? "✕ not reached" : inGoal(run) ? "✓ in the goal" : "✕ misses the goal");
}

// Where the centre ends, seen from the certified box: the plane, and below it the orientation.
const tried = data.moves.map(() => []); // ends of runs shown before, as a trail
const MOST_TRIED = 400;

function landed(k, run) {
  const move = run.moves[k];
  if (!move || move.end) return null;
  return [move.after[0], move.after[1], move.after[2] / DEG];
}

const within = (pose, box) => pose.every((value, i) => value >= box[i][0] && value <= box[i][1]);

function showLanding(card, k, run) {
  const { box } = data.moves[k], pose = landed(k, run);
  card.landing.hidden = card.where.hidden = !box;
  if (!box) return;
  const inside = pose && within(pose, box), stated = data.moves[k].proved ? "certified box" : "box (not proved)";
  const said = !pose ? "does not get here" : `${inside ? "● in" : "✕ outside"} the ${stated}`;
  write(card.where, said);
  card.landing.setAttribute("aria-label", `End of move ${k + 1}: ${said}`);
  const width = 132, height = 92, dense = window.devicePixelRatio || 1;
  card.landing.width = width * dense;
  card.landing.height = height * dense;
  const pen = card.landing.getContext("2d");
  pen.scale(dense, dense);
  drawLanding(pen, box, tried[k], pose, inside, { width, height });
}

function drawLanding(pen, box, trail, pose, inside, { width, height }) {
  const tall = height - 22, zoom = 1.7; // the box takes 1 / zoom of the plot
  const spread = [0, 1].map((i) => Math.max(halfWidth(box[i]), 1e-6));
  const size = Math.min(width / (2 * zoom * spread[0]), tall / (2 * zoom * spread[1]));
  const place = ([x, y]) => [Math.min(Math.max(width / 2 + size * (x - middle(box[0])), 4), width - 4),
    Math.min(Math.max(tall / 2 - size * (y - middle(box[1])), 4), tall - 4)];
  const turn = (theta) => Math.min(Math.max(
    width / 2 + ((theta - middle(box[2])) / (zoom * halfWidth(box[2]))) * (width / 2), 4), width - 4);
  const [left, top] = place([box[0][0], box[1][1]]), [right, low] = place([box[0][1], box[1][0]]);
  pen.strokeStyle = css("--box");
  pen.lineWidth = 1.5;
  pen.strokeRect(left, top, right - left, low - top);
  const line = height - 9;
  pen.beginPath();
  for (const end of box[2]) { pen.moveTo(turn(end), line - 5); pen.lineTo(turn(end), line + 5); }
  pen.moveTo(turn(box[2][0]), line); pen.lineTo(turn(box[2][1]), line);
  pen.stroke();
  pen.fillStyle = css("--muted");
  pen.font = "11px system-ui, sans-serif";
  pen.fillText("θ", 2, line + 4);
  pen.globalAlpha = 0.35;
  for (const one of trail) {
    const [x, y] = place(one);
    pen.fillRect(x - 1, y - 1, 2, 2);
    pen.fillRect(turn(one[2]) - 0.5, line - 2, 1, 4);
  }
  pen.globalAlpha = 1;
  if (!pose) return;
  spot(pen, ...place(pose), inside);
  spot(pen, turn(pose[2]), line, inside);
}

function spot(pen, x, y, inside) {
  pen.beginPath();
  if (inside) {
    pen.fillStyle = css("--box");
    pen.arc(x, y, 4, 0, 2 * Math.PI);
    pen.fill();
    return;
  }
  pen.strokeStyle = css("--warn");
  pen.lineWidth = 2.2;
  pen.moveTo(x - 4, y - 4); pen.lineTo(x + 4, y + 4);
  pen.moveTo(x - 4, y + 4); pen.lineTo(x + 4, y - 4);
  pen.stroke();
}

function showMargins(run) {
  cards.forEach((card, k) => {
    if (card.goal) { showGoal(card, run); return; }
    showCard(card, k, run);
    showLanding(card, k, run);
  });
}

function remember(run) {
  data.moves.forEach((_, k) => {
    const pose = landed(k, run);
    if (pose && tried[k].push(pose) > MOST_TRIED) tried[k].shift();
  });
}
