// The runs of a simulation: which one is shown.
let chosen = 0;
const run = () => data.runs[chosen];

function choose(index) {
  chosen = Math.min(Math.max(index, 0), data.runs.length - 1);
  const one = run();
  at("run").value = String(chosen);
  at("ending").className = "tag " + (one.good ? "good" : "bad");
  say("ending", one.words);
  say("miss", one.miss === null ? "" :
    one.miss.toFixed(3) + " tolerances off the goal's middle (1 is the edge of the goal)");
  draw();
}

function fill() {
  data.runs.forEach((one, k) => option(at("run"), String(k), one.name + " — " + one.words));
  at("run").addEventListener("change", (event) => choose(Number(event.target.value)));
  window.addEventListener("hashchange", fromAddress);
}

// animation.html#run=2&at=0.6 opens a run at a part of the plan
function fromAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const number = (name) => Number(asked.get(name)) || 0;
  state.time = total * Math.min(Math.max(number("at"), 0), 1);
  choose(Math.round(number("run")));
}

fill();
fillPlayer();
listenPlayer(document, (way) => choose(chosen + way));
drawLegend();
fromAddress();
