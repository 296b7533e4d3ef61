/* The ball in its cavity: it moves in the drawing that stands there, and a line in the curves beside says when.

   Keys, once the figure is chosen: space plays, left and right go on by steps, up and down from event to event. */
"use strict";
(() => {

const STEPS = 60;       // of a second on the screen at the middle pace, by one press of a key
const TRAIL = 0.2;      // of the time shown, that the ball's trail is long
const FLASH = 0.35;     // seconds on the screen that a hit glows

const bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer;

function unpacked(data) {
  const t = new Float32Array(bytes(data.t)), count = t.length;
  const places = ({ largest, places }) => {
    const raw = new Int16Array(bytes(places));
    return [0, 1].map(axis => Float32Array.from({ length: count }, (_, k) => raw[axis * count + k] * largest / 32767));
  };
  return { ...data, t, count, ball: places(data.ball), structure: places(data.structure) };
}

function start(figure) {
  const data = unpacked(JSON.parse(figure.querySelector("script").textContent));
  const box = figure.querySelector(".player-box"), form = figure.querySelector("form"), says = figure.querySelector("output");
  const last = data.t[data.count - 1], cycle = 1 / data.frequency;
  const state = { at: 0, playing: false, before: 0, asked: 0, seen: true };
  const moments = [...new Set(data.events.map(([k]) => data.t[k]))];

  /* The last of the times that is not after t. */
  function index(t) {
    let low = 0, high = data.count - 1;
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (data.t[middle] <= t) low = middle; else high = middle - 1;
    }
    return low;
  }

  function place(motion, t) {
    const k = Math.min(index(t), data.count - 2), share = (t - data.t[k]) / (data.t[k + 1] - data.t[k]);
    return motion.map(along => along[k] + share * (along[k + 1] - along[k]));
  }

  /* What is added to a drawing, and how its axes turn values into places. */
  const sheets = [...box.querySelectorAll("svg[data-axes]")].map(svg => {
    const frames = JSON.parse(svg.dataset.axes);
    const put = (name, kind) => {
      const made = document.createElementNS(svg.namespaceURI, name);
      made.setAttribute("class", kind);
      svg.append(made);
      return made;
    };
    const on = ({ box: [left, right, top, bottom], x, y }, [a, b]) =>
      [left + (a - x[0]) / (x[1] - x[0]) * (right - left), bottom - (b - y[0]) / (y[1] - y[0]) * (bottom - top)];
    const [cavity, ...curves] = frames;
    const scale = (cavity.box[1] - cavity.box[0]) / (cavity.x[1] - cavity.x[0]);
    const parts = { trail: put("polyline", "trail"), ball: put("circle", "ball"), spot: put("circle", "spot"), hit: put("circle", "hit") };
    parts.ball.setAttribute("r", data.radius * scale);
    parts.spot.setAttribute("r", 1.6);
    parts.hit.setAttribute("r", 5);
    parts.lines = curves.map(() => put("line", "cursor"));
    return { svg, parts, on, cavity, curves, scale };
  });

  const to = (element, names, values) => names.forEach((name, i) => element.setAttribute(name, values[i].toFixed(2)));

  function draw() {
    const t = state.at, ball = place(data.ball, t), from = Math.max(0, t - TRAIL * last), first = index(from);
    const trail = [place(data.ball, from)];
    for (let k = first + 1; k < data.count && data.t[k] < t; k++) trail.push(data.ball.map(along => along[k]));
    trail.push(ball);
    const hit = data.events.filter(([k, words]) => words.startsWith("hits") && data.t[k] <= t && t - data.t[k] < FLASH * cycle / pace()).at(-1);
    for (const { parts, on, cavity, curves } of sheets) {
      const centre = on(cavity, ball);
      to(parts.ball, ["cx", "cy"], centre);
      to(parts.spot, ["cx", "cy"], centre);
      parts.trail.setAttribute("points", trail.map(at => on(cavity, at).map(v => v.toFixed(2)).join(",")).join(" "));
      parts.hit.style.display = hit ? "" : "none";
      if (hit) {
        const at = data.ball.map(along => along[hit[0]]), axis = hit[2] - 1;
        at[axis] += data.radius * Math.sign(at[axis]);
        to(parts.hit, ["cx", "cy"], on(cavity, at));
      }
      parts.lines.forEach((line, i) => {
        const [x] = on(curves[i], [data.begin + t, 0]), [, , top, bottom] = curves[i].box;
        to(line, ["x1", "x2", "y1", "y2"], [x, x, top, bottom]);
      });
    }
    form.time.value = t / last;
    tell(t);
  }

  const pace = () => Number(form.pace.value);  // seconds on the screen that a cycle takes
  const plain = (value, places = 2) => value.toFixed(places).replace("-", "\u2212");
  const DOING = ["at rest in the cavity", "rolling", "slipping"];

  function tell(t) {
    const k = index(t), code = Number(data.regime[k]), regimes = [Math.floor(code / 3), code % 3];
    const doing = DOING[Math.max(...data.moving[0].map(i => regimes[i]), 0)];
    const past = data.events.filter(([at]) => data.t[at] <= t), hits = past.filter(([, words]) => words.startsWith("hits")).length;
    const now = past.filter(([at]) => Math.abs(data.t[at] - t) < 1e-6 * last).map(([, words, axis]) => `${words}, axis ${axis}`);
    const parts = [`${plain(data.begin + t)} ms, cycle ${plain(t / cycle, 1)}`, now.length ? now.join("; ") : doing];
    parts.push(`${hits} wall ${hits === 1 ? "hit" : "hits"} so far`);
    says.textContent = parts.join(" · ");
    form.time.setAttribute("aria-valuetext", parts.join(", "));
  }

  function frame(now) {
    state.asked = 0;
    const step = Math.min(Math.max(now - state.before, 0), 100) / 1000 / pace() * cycle;
    state.before = now;
    if (state.playing) state.at = Math.min(last, state.at + step);
    if (state.at >= last) play(false);
    draw();
    if (state.playing && state.seen) later();
  }
  function later() { state.asked ||= requestAnimationFrame(frame); }

  function play(on) {
    if (on && state.at >= last) state.at = 0;
    state.playing = on;
    form.play.textContent = on ? "pause" : "play";
    form.play.setAttribute("aria-pressed", String(on));
    state.before = performance.now();
    if (on) later();
  }

  function go(t) {
    play(false);
    state.at = Math.min(last, Math.max(0, t));
    draw();
  }
  const near = 1e-6 * last;
  const onwards = () => go(moments.find(t => t > state.at + near) ?? last);
  const back = () => go(moments.findLast(t => t < state.at - near) ?? 0);

  const KEYS = {
    " ": () => play(!state.playing), ArrowRight: () => go(state.at + cycle / STEPS), ArrowLeft: () => go(state.at - cycle / STEPS),
    ArrowUp: back, ArrowDown: onwards, Home: () => go(0), End: () => go(last),
  };
  box.addEventListener("keydown", event => {
    if (!KEYS[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    KEYS[event.key]();
  });
  form.addEventListener("submit", event => event.preventDefault());
  form.play.addEventListener("click", () => play(!state.playing));
  form.on.addEventListener("click", onwards);
  form.back.addEventListener("click", back);
  form.time.addEventListener("input", () => go(form.time.value * last));
  new IntersectionObserver(([entry]) => {
    state.seen = entry.isIntersecting;
    if (state.seen && state.playing) { state.before = performance.now(); later(); }
  }).observe(box);

  figure.player = { go, play, frame, data, at: () => state.at, place: t => place(data.ball, t), moments };
  box.tabIndex = 0;
  form.hidden = false;
  figure.classList.add("live");
  draw();
}

for (const figure of document.querySelectorAll("figure.player")) start(figure);
})();
