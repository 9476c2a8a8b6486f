// More to draw over the part, below path and tips: (draw, seen, now) => …
const layers = [];

// The scene: y up, one scale for x and y, everything that any run touches in view.
function view(width) {
  const [left, low, right, high] = data.extent;
  const pad = 0.04 * Math.max(right - left, high - low);
  const wide = right - left + 2 * pad, tall = high - low + 2 * pad;
  const most = Math.max(240, Math.min(600, 0.6 * window.innerHeight));
  const scale = Math.min(width / wide, most / tall);
  const height = Math.ceil(tall * scale);
  const x0 = 0.5 * (width - scale * (left + right)), y0 = 0.5 * (height + scale * (low + high));
  return { scale, height, to: (x, y) => [x0 + scale * x, y0 - scale * y] };
}

function corners(pose) {
  const c = Math.cos(pose[2] * Math.PI / 180), s = Math.sin(pose[2] * Math.PI / 180);
  return data.part.map(([x, y]) => [pose[0] + c * x - s * y, pose[1] + s * x + c * y]);
}

function outline(draw, to, pose) {
  draw.beginPath();
  corners(pose).forEach(([x, y], k) => (k ? draw.lineTo(...to(x, y)) : draw.moveTo(...to(x, y))));
  draw.closePath();
}

function line(draw, to, xs, ys, count) {
  draw.beginPath();
  for (let i = 0; i < count; i++) i ? draw.lineTo(...to(xs[i], ys[i])) : draw.moveTo(...to(xs[i], ys[i]));
  draw.stroke();
}

function scaleStep(wanted) {
  const power = Math.pow(10, Math.floor(Math.log10(wanted)));
  return [5, 2, 1].map((n) => n * power).find((n) => n <= wanted) || power;
}

function drawScene(now) {
  const width0 = scene.parentElement.clientWidth;
  const seen = view(width0);
  const [draw, width] = prepared(scene, seen.height);
  const to = seen.to;
  drawGrid(draw, seen, width);
  drawGoal(draw, seen);
  draw.lineWidth = 1;
  draw.strokeStyle = css("--ghost");
  run().moves.forEach((move, k) => {
    if (k <= now.k) { outline(draw, to, [move.x[0], move.y[0], move.t[0]]); draw.stroke(); }
  });
  drawTravel(draw, to, now);
  drawPart(draw, to, now);
  layers.forEach((layer) => layer(draw, seen, now));
  drawTrace(draw, to, now);
  drawTips(draw, seen, now);
  drawScaleBar(draw, seen, width);
}

function drawGrid(draw, seen, width) {
  const step = scaleStep(140 / seen.scale);
  const [left, low, right, high] = data.extent;
  draw.lineWidth = 1;
  draw.strokeStyle = css("--grid");
  draw.beginPath();
  const more = width / seen.scale;
  for (let x = Math.ceil((left - more) / step) * step; x <= right + more; x += step) {
    draw.moveTo(seen.to(x, 0)[0], 0); draw.lineTo(seen.to(x, 0)[0], seen.height);
  }
  for (let y = Math.ceil((low - more) / step) * step; y <= high + more; y += step) {
    draw.moveTo(0, seen.to(0, y)[1]); draw.lineTo(width, seen.to(0, y)[1]);
  }
  draw.stroke();
}

function drawGoal(draw, seen) {
  const goal = data.goal;
  draw.strokeStyle = css("--goal");
  draw.lineWidth = 1.5;
  draw.setLineDash([7, 5]);
  outline(draw, seen.to, [goal.x, goal.y, goal.theta]);
  draw.stroke();
  draw.setLineDash([]);
  const [x, y] = seen.to(goal.x - goal.dx, goal.y + goal.dy);
  draw.fillStyle = css("--goal-soft");
  draw.fillRect(x, y, 2 * goal.dx * seen.scale, 2 * goal.dy * seen.scale);
  draw.strokeRect(x, y, 2 * goal.dx * seen.scale, 2 * goal.dy * seen.scale);
  draw.fillStyle = css("--goal");
  text(draw, "goal ±" + goal.dx + " µm", x + goal.dx * seen.scale, y - 7, "center");
}

function text(draw, words, x, y, align) {
  draw.font = "13px system-ui, sans-serif";
  draw.textAlign = align;
  draw.textBaseline = "alphabetic";
  draw.lineWidth = 3;
  draw.lineJoin = "round";
  const stroke = draw.strokeStyle;
  draw.strokeStyle = css("--page");
  draw.strokeText(words, x, y);
  draw.fillText(words, x, y);
  draw.strokeStyle = stroke;
  draw.lineWidth = 1.5;
}

function drawPart(draw, to, now) {
  outline(draw, to, now.pose);
  draw.globalAlpha = 0.82;
  draw.fillStyle = css("--part");
  draw.fill();
  draw.globalAlpha = 1;
  draw.strokeStyle = css("--part-edge");
  draw.lineWidth = 2;
  draw.stroke();
  const angle = now.pose[2] * Math.PI / 180, arm = data.arm;
  const [x, y] = to(now.pose[0], now.pose[1]);
  const [u, v] = to(now.pose[0] + arm * Math.cos(angle), now.pose[1] + arm * Math.sin(angle));
  draw.lineWidth = 1.5;
  draw.beginPath(); draw.moveTo(x, y); draw.lineTo(u, v); draw.stroke();
  const back = Math.atan2(v - y, u - x);
  draw.beginPath();
  draw.moveTo(u, v);
  draw.lineTo(u - 9 * Math.cos(back - 0.4), v - 9 * Math.sin(back - 0.4));
  draw.moveTo(u, v);
  draw.lineTo(u - 9 * Math.cos(back + 0.4), v - 9 * Math.sin(back + 0.4));
  draw.stroke();
}

function drawTrace(draw, to, now) {
  draw.strokeStyle = css("--trace");
  draw.lineWidth = 1.6;
  run().moves.forEach((move, k) => {
    if (k > now.k) return;
    const last = move.x.length - 1;
    const count = k < now.k ? last + 1 : Math.floor(now.share * last) + 1;
    const xs = move.x.slice(0, count), ys = move.y.slice(0, count);
    if (k === now.k) { xs.push(now.pose[0]); ys.push(now.pose[1]); }
    line(draw, to, xs, ys, xs.length);
  });
  const [x, y] = to(now.pose[0], now.pose[1]);
  draw.fillStyle = css("--trace");
  draw.beginPath(); draw.arc(x, y, 3.5, 0, 2 * Math.PI); draw.fill();
}

// What the tips of this move have still before them.
function drawTravel(draw, to, now) {
  const move = run().moves[now.k];
  draw.strokeStyle = css("--tip");
  draw.globalAlpha = 0.55;
  draw.lineWidth = 1;
  draw.setLineDash([2, 4]);
  move.tips.forEach((tip, p) => {
    const [dx, dy] = move.travel[p];
    draw.beginPath();
    draw.moveTo(...to(tip[0], tip[1]));
    draw.lineTo(...to(tip[0] + dx, tip[1] + dy));
    draw.stroke();
  });
  draw.setLineDash([]);
  draw.globalAlpha = 1;
}

function drawTips(draw, { to, scale }, now) {
  const move = data.moves[now.k];
  now.tips.forEach((tip, p) => {
    const [x, y] = to(tip[0], tip[1]);
    const mode = now.modes[p];
    draw.fillStyle = mode ? css(MODES[mode].color) : css("--page");
    draw.strokeStyle = css("--tip");
    draw.lineWidth = 2.2;
    draw.beginPath();
    if (move.passive[p]) { // at rest: a diamond
      draw.moveTo(x, y - 8); draw.lineTo(x + 8, y); draw.lineTo(x, y + 8); draw.lineTo(x - 8, y);
      draw.closePath();
    } else draw.arc(x, y, 6, 0, 2 * Math.PI);
    draw.fill();
    draw.stroke();
    const wide = (now.radii[p] || 0) * scale; // the tip itself, to scale
    draw.beginPath();
    draw.arc(x, y, wide, 0, 2 * Math.PI);
    draw.stroke();
    draw.fillStyle = css("--ink");
    const right = x < scene.clientWidth - 150;
    const said = move.probes[p] + (mode ? ": " + MODES[mode].name : "");
    text(draw, said, x + (right ? 13 : -13), y + 5, right ? "left" : "right");
  });
}

function drawScaleBar(draw, seen, width) {
  const length = scaleStep(Math.min(180, width / 3) / seen.scale), wide = length * seen.scale;
  const x = width - 18 - wide, y = seen.height - 18;
  draw.strokeStyle = draw.fillStyle = css("--ink");
  draw.lineWidth = 3;
  draw.beginPath(); draw.moveTo(x, y); draw.lineTo(x + wide, y); draw.stroke();
  draw.lineWidth = 1.5;
  draw.beginPath();
  for (const end of [x, x + wide]) { draw.moveTo(end, y - 5); draw.lineTo(end, y + 5); }
  draw.stroke();
  text(draw, length + " µm", x + wide / 2, y - 9, "center");
}
