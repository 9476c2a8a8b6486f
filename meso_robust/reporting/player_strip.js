// The strip: a band a probe, a colour and a pattern a mode.
function band(draw, mode, x, y, wide, tall) {
  const color = css(MODES[mode].color);
  if (mode === 0) {
    draw.fillStyle = color;
    draw.fillRect(x, y + tall / 2 - 1, wide, 2);
    return;
  }
  draw.fillStyle = color;
  draw.globalAlpha = mode === 1 ? 1 : 0.35;
  draw.fillRect(x, y, wide, tall);
  draw.globalAlpha = 1;
  if (mode === 1) return;
  draw.save();
  draw.beginPath(); draw.rect(x, y, wide, tall); draw.clip();
  draw.strokeStyle = color;
  draw.lineWidth = 2.5;
  const lean = mode === 2 ? -1 : 1; // slip + leans like /, slip − like \
  draw.beginPath();
  for (let u = Math.floor((x - tall) / 8) * 8; u < x + wide + tall; u += 8) {
    draw.moveTo(u, lean < 0 ? y + tall : y);
    draw.lineTo(u + tall, lean < 0 ? y : y + tall);
  }
  draw.stroke();
  draw.strokeStyle = color;
  draw.lineWidth = 1;
  draw.strokeRect(x + 0.5, y + 0.5, wide - 1, tall - 1);
  draw.restore();
}

const stripHeight = () => HEAD + data.probes.length * (BAND + GAP) + 4;

function drawStrip(now, time) {
  const height = stripHeight();
  const [draw, width] = prepared(strip, height);
  const px = (t) => (t / total) * width;
  const one = run(), over = endOf(one);
  data.moves.forEach((move, k) => {
    const x = px(startOf(k)), wide = px(move.seconds);
    draw.fillStyle = css(k % 2 ? "--page" : "--soft");
    draw.fillRect(x, HEAD - 2, wide, height - HEAD);
    draw.fillStyle = css(k === now.k ? "--ink" : "--muted");
    moveLabel(draw, move, k, x, wide);
  });
  one.moves.forEach((move, k) => drawBands(draw, move, k, px));
  if (over < total - 1e-9) drawEnded(draw, px(over), width, height);
  draw.strokeStyle = css("--muted");
  draw.lineWidth = 1;
  draw.beginPath();
  for (const end of [0, ...ends]) {
    const x = Math.min(Math.max(Math.round(px(end)) + 0.5, 0.5), width - 0.5);
    draw.moveTo(x, 2); draw.lineTo(x, height);
  }
  draw.stroke();
  const x = Math.min(Math.max(px(Math.min(time, total)), 1), width - 1);
  draw.strokeStyle = css("--ink");
  draw.lineWidth = 2;
  draw.beginPath(); draw.moveTo(x, 0); draw.lineTo(x, height); draw.stroke();
}

function moveLabel(draw, move, k, x, wide) {
  const bold = k === instant(state.time).k;
  draw.font = (bold ? "600 " : "") + "12.5px system-ui, sans-serif";
  draw.textAlign = "left";
  draw.textBaseline = "alphabetic";
  const choices = [(k + 1) + " " + move.name, String(k + 1)];
  const words = choices.find((choice) => draw.measureText(choice).width < wide - 8);
  if (words) draw.fillText(words, x + 5, 13);
}

function drawBands(draw, move, k, px) {
  const names = data.moves[k].probes, x0 = px(startOf(k)), wide = px(data.moves[k].seconds);
  names.forEach((name, p) => {
    const y = HEAD + data.probes.indexOf(name) * (BAND + GAP) + GAP / 2;
    const modes = move.modes[p], last = modes.length - 1;
    // an instant stands for the interval half way to its neighbours
    const edge = (i) => (i > move.stop * last ? move.stop : Math.max((i - 0.5) / last, 0));
    for (let i = 0; i <= last;) {
      let j = i;
      while (j <= last && modes[j] === modes[i]) j++;
      const from = edge(i), till = j > last ? move.stop : edge(j);
      if (till > from) band(draw, Number(modes[i]), x0 + from * wide, y, (till - from) * wide, BAND);
      i = j;
    }
  });
}

function drawEnded(draw, x, width, height) {
  draw.fillStyle = css("--bad-soft");
  draw.fillRect(x, HEAD - 2, width - x, height - HEAD);
  draw.strokeStyle = css("--bad");
  draw.lineWidth = 2;
  draw.beginPath(); draw.moveTo(x + 1, HEAD - 2); draw.lineTo(x + 1, height); draw.stroke();
  draw.fillStyle = css("--bad");
  draw.font = "600 13px system-ui, sans-serif";
  draw.textBaseline = "middle";
  draw.textAlign = "left";
  const words = [run().words, "ended"].find((one) => draw.measureText(one).width + 20 < width - x);
  if (words) draw.fillText(words, x + 10, HEAD + (height - HEAD) / 2);
  draw.textBaseline = "alphabetic";
}
