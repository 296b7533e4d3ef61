/* Values under the pointer: what a figure's points say, found where its axes put them. A click may lead to a mode.

   Keys, once a figure is chosen: left and right along a curve, up and down to the next one, enter as a click. */
"use strict";
(() => {

const REACH = 34;  // pixels up to which a point is meant

const plain = value => {
  const short = Number(value.toPrecision(6));
  return Math.abs(short) >= 1e-4 || !short ? String(short) : short.toExponential().replace("e-", "·10^−");
};

function start(figure) {
  const data = JSON.parse(figure.querySelector("script.points").textContent);
  const box = figure.querySelector(".live-box"), tip = figure.querySelector(".tip");
  const plate = document.querySelector("figure.viewer");
  let chosen = null;

  const sheet = () => [...box.querySelectorAll("svg[data-axes]")].find(svg => svg.getBoundingClientRect().width > 0);

  /* Where a point is in the drawing's own units. */
  function placed(frame, x, y) {
    const along = (value, [low, high], log, from, to) => {
      const scale = log ? Math.log : v => v;
      return from + (scale(value) - scale(low)) / (scale(high) - scale(low)) * (to - from);
    };
    const [left, right, top, bottom] = frame.box;
    return [along(x, frame.x, frame.log[0], left, right), along(y, frame.y, frame.log[1], bottom, top)];
  }

  function place(svg, [s, k]) {
    const one = data.series[s], frame = JSON.parse(svg.dataset.axes)[one.panel];
    if (frame.log[1] && !(one.y[k] > 0)) return null;
    const [x, y] = placed(frame, one.x[k], one.y[k]), [left, right, top, bottom] = frame.box;
    return x < left - 1 || x > right + 1 || y < top - 1 || y > bottom + 1 ? null : [x, y];
  }

  function nearest(svg, x, y) {
    const view = svg.viewBox.baseVal, shown = svg.getBoundingClientRect(), scale = shown.width / view.width;
    let best = null, least = REACH;
    data.series.forEach((one, s) => one.x.forEach((_, k) => {
      const at = place(svg, [s, k]);
      if (!at) return;
      const off = Math.hypot(shown.left + at[0] * scale - x, shown.top + at[1] * scale - y);
      if (off < least) [best, least] = [[s, k], off];
    }));
    return best;
  }

  const lead = at => at && data.series[at[0]].leads[at[1]];

  function ring(svg, name, at) {
    svg.querySelector("." + name)?.remove();
    const spot = at && place(svg, at);
    if (!spot) return;
    const mark = document.createElementNS(svg.namespaceURI, "circle");
    mark.setAttribute("class", name);
    mark.setAttribute("cx", spot[0]);
    mark.setAttribute("cy", spot[1]);
    mark.setAttribute("r", name === "ring" ? 4.5 : 7);
    svg.append(mark);
  }

  function choose(at) {
    chosen = at;
    const svg = sheet();
    if (!svg) return;
    ring(svg, "ring", at);
    box.style.cursor = lead(at) && plate?.viewer ? "pointer" : "";
    tip.hidden = !at;
    if (!at) return;
    const one = data.series[at[0]], k = at[1];
    const values = data.units?.map((unit, i) => unit.replace("{}", plain((i ? one.y : one.x)[k]))) ?? [];
    const lines = [one.name, values.join(", "), one.notes[k] ?? ""];
    if (lead(at) && plate?.viewer) lines.push("click: this mode in motion");
    tip.replaceChildren(...lines.filter(line => line).map((line, i) => {
      const part = document.createElement(i ? "span" : "b");
      part.textContent = line;
      return part;
    }));
    const view = svg.viewBox.baseVal, outer = box.getBoundingClientRect(), shown = svg.getBoundingClientRect();
    const [x, y] = place(svg, at).map(value => value * shown.width / view.width);
    const left = Math.min(Math.max(0, x + 14), outer.width - tip.offsetWidth);
    const above = y - tip.offsetHeight - 12;
    tip.style.left = `${left}px`;
    tip.style.top = `${above < 0 ? y + 14 : above}px`;
  }

  function follow() {
    const to = lead(chosen);
    if (!to || !plate?.viewer) return;
    plate.viewer.show(...to);
    plate.scrollIntoView({ block: "nearest", behavior: "smooth" });
  }

  box.addEventListener("pointermove", event => { const svg = sheet(); if (svg) choose(nearest(svg, event.clientX, event.clientY)); });
  box.addEventListener("pointerleave", () => { if (document.activeElement !== box) choose(null); });
  box.addEventListener("click", event => { const svg = sheet(); if (svg) choose(nearest(svg, event.clientX, event.clientY)); follow(); });
  box.addEventListener("blur", () => choose(null));

  /* The next point by keys: one further along, or the nearest of the next series. */
  function onwards(along, over) {
    const svg = sheet(), ok = (s, k) => place(svg, [s, k]);
    const there = (s, k) => { while (k >= 0 && k < data.series[s].x.length) { if (ok(s, k)) return [s, k]; k += along || 1; } return null; };
    if (!chosen) return there(0, 0);
    let [s, k] = chosen;
    if (along) return there(s, k + along) ?? chosen;
    for (s += over; s >= 0 && s < data.series.length; s += over) {
      const near = data.series[s].x.map((x, i) => [Math.abs(x - data.series[chosen[0]].x[k]), i]).filter(([, i]) => ok(s, i));
      if (near.length) return [s, near.reduce((a, b) => b[0] < a[0] ? b : a)[1]];
    }
    return chosen;
  }
  const STEPS = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  box.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (STEPS[event.key]) choose(onwards(...STEPS[event.key]));
    else if (event.key === "Enter") follow();
    else if (event.key === "Escape") choose(null);
    else return;
    event.preventDefault();
  });

  /* The mode in motion is marked in the diagram that leads to it. */
  if (data.series.some(one => one.leads.length)) plate?.addEventListener("shown", event => mark(event.detail));
  function mark({ speed, mode }) {
    data.series.forEach((one, s) => one.leads.forEach((to, k) => {
      if (to && to[0] === speed && to[1] === mode) for (const svg of box.querySelectorAll("svg[data-axes]")) ring(svg, "now", [s, k]);
    }));
  }
  box.tabIndex = 0;
  figure.classList.add("live-figure");
  if (plate?.viewer?.at) mark(plate.viewer.at());
  figure.hover = { nearest: (x, y) => nearest(sheet(), x, y), choose, place: at => place(sheet(), at), data };
}

for (const figure of document.querySelectorAll("figure.hover")) start(figure);
})();
