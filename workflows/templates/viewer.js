/* The plate in three dimensions, on WebGL2 and nothing else: a figure holds a canvas, a form and its data as JSON.

   Displacements come as few vectors, of which every shape is a sum. The vertex shader moves the surface through a
   period, u = in phase × cos + behind × sin; the fragment shader colours it by how far each place swings. */
"use strict";
(() => {

const COLOURS = ["#4903a0", "#7401a8", "#99159f", "#ba3388", "#d35171", "#e87059", "#f79342", "#feb82c", "#f7e425"];
const LARGEST = 0.14;      // swing drawn at full amplitude, in lengths of the plate
const PERIOD = 1.8;        // seconds that a period takes on the screen
const THINNEST = 0.006;    // thickness drawn at least, to catch the light
const LENS = Math.tan(Math.PI / 12);
const HOME = { yaw: -0.75, rise: 0.55, near: 1 };

const MOVE = `
uniform mat4 camera; uniform vec2 phase;
vec3 moved(vec3 place, vec3 inPhase, vec3 behind) { return place + inPhase * phase.x + behind * phase.y; }`;

const SURFACE = [`#version 300 es
${MOVE}
in vec3 place; in float offset; in vec3 inPhase; in vec3 behind; in vec4 slopes;
out vec3 normal; out vec3 at; out vec3 swing; out vec3 late;
void main() {
  vec2 slope = slopes.xy * phase.x + slopes.zw * phase.y;
  normal = normalize(vec3(-slope, 1.));
  at = moved(place, inPhase, behind) + offset * normal;
  swing = inPhase; late = behind;
  gl_Position = camera * vec4(at, 1.);
}`, `#version 300 es
precision highp float;
uniform vec3 colours[${COLOURS.length}]; uniform vec3 eye; uniform vec3 plain; uniform float wall, facets, still;
in vec3 normal; in vec3 at; in vec3 swing; in vec3 late;
out vec4 colour;
float reach() {  // the longer half axis of the ellipse that a place moves on
  float a = dot(swing, swing), b = dot(late, late), c = dot(swing, late);
  return sqrt(max(0., .5 * (a + b + sqrt((a - b) * (a - b) + 4. * c * c))));
}
vec3 shade(float part) {
  float x = clamp(part, 0., 1.) * ${COLOURS.length - 1}.;
  int k = min(int(x), ${COLOURS.length - 2});
  return mix(colours[k], colours[k + 1], x - float(k));
}
void main() {
  vec3 n = max(wall, facets) > .5 ? normalize(cross(dFdx(at), dFdy(at))) : normalize(normal);
  vec3 to = normalize(eye - at);
  float part = reach(), steps = part * 10., width = fwidth(steps);
  float line = width < .5 ? 1. - smoothstep(0., 1.5 * width, abs(fract(steps + .5) - .5)) : 0.;
  vec3 base = still > .5 ? plain : shade(part) * (1. - .28 * line * (1. - wall));
  vec3 sun = normalize(to + vec3(.25, -.35, .6));
  float light = .5 + .5 * abs(dot(n, sun)) + .12 * pow(abs(dot(n, normalize(sun + to))), 40.);
  colour = vec4(base * light * (1. - .3 * wall), 1.);
}`];

const LINES = [`#version 300 es
${MOVE}
uniform vec2 screen; uniform float width, bias;
in vec3 place, other; in float side; in vec3 inPhase, behind, otherInPhase, otherBehind;
void main() {  // a line is a strip as wide on the screen as it is to be
  vec4 a = camera * vec4(moved(place, inPhase, behind), 1.);
  vec4 b = camera * vec4(moved(other, otherInPhase, otherBehind), 1.);
  vec2 on = (b.xy / b.w - a.xy / a.w) * screen;
  vec2 aside = length(on) > 0. ? normalize(vec2(-on.y, on.x)) : vec2(0.);
  gl_Position = a + vec4(aside * side * width / screen * a.w, -bias * a.w, 0.);
}`, `#version 300 es
precision highp float; uniform vec4 tint; out vec4 colour; void main() { colour = vec4(tint.rgb * tint.a, tint.a); }`];

const CELLS = [`#version 300 es
${MOVE}
in vec3 place; in float offset; in vec3 inPhase, behind; in vec4 slopes;
void main() {
  vec2 slope = slopes.xy * phase.x + slopes.zw * phase.y;
  gl_Position = camera * vec4(moved(place, inPhase, behind) + offset * normalize(vec3(-slope, 1.)), 1.);
  gl_Position.z -= 1e-4 * gl_Position.w;
}`, LINES[1]];

const MARK = [`#version 300 es
${MOVE}
uniform float size; in vec3 place; in vec3 inPhase, behind;
void main() { gl_Position = camera * vec4(moved(place, inPhase, behind), 1.); gl_PointSize = size; }`, `#version 300 es
precision highp float; uniform vec4 tint; uniform vec3 ring; out vec4 colour;
void main() {
  float r = 2. * length(gl_PointCoord - .5);
  if (r > 1.) discard;
  colour = vec4(r > .68 ? ring : tint.rgb, 1.);
}`];

/* ---- data ---- */

const bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0)).buffer;
const whole = text => new Uint16Array(bytes(text));
const shorts = text => new Int16Array(bytes(text));

/* The plate, or the surface of what lies in space, in its own lengths, its middle at the origin. */
function unpacked(data) {
  const axes = data.span.length, size = Math.max(...data.span), raw = whole(data.points), count = raw.length / axes;
  const scaled = (x, k) => (x - data.low[k] - data.span[k] / 2) / size;
  const places = new Float32Array(3 * count);
  raw.forEach((q, i) => { const k = i % axes; places[3 * ((i - k) / axes) + k] = scaled(data.low[k] + q / 65535 * data.span[k], k); });
  const parts = data.thickness.parts ? shorts(data.thickness.parts) : null;
  const half = Float32Array.from({ length: count }, (_, k) =>
    axes > 2 ? 0 : Math.max(data.thickness.largest / size * (parts ? parts[k] / 32767 : 1), THINNEST) / 2);
  return {
    count, places, half, size, solid: axes > 2,
    triangles: whole(data.triangles), edges: whole(data.edges), outline: whole(data.outline), root: whole(data.root),
    damper: data.damper && data.damper.map(scaled),
    directions: data.shapes.map(along => ({
      rank: along.rank, unit: along.largest / 32767,
      vectors: shorts(along.vectors), shares: new Float32Array(bytes(along.shares)),
    })),
  };
}

/* Displacement (3 numbers a point) of a packed shape. */
function displacement(plate, number) {
  const found = new Float32Array(3 * plate.count);
  plate.directions.forEach((along, axis) => {
    for (let r = 0; r < along.rank; r++) {
      const share = along.shares[number * along.rank + r] * along.unit, from = r * plate.count;
      for (let k = 0; k < plate.count; k++) found[3 * k + axis] += share * along.vectors[from + k];
    }
  });
  return found;
}

/* Slopes of the surface along x and y at each point: the means of those of the triangles about it. */
function slopes(plate, shape) {
  const { places: p, triangles: t } = plate, sum = new Float32Array(2 * plate.count), area = new Float32Array(plate.count);
  if (plate.solid) return sum;
  for (let i = 0; i < t.length; i += 3) {
    const [a, b, c] = [t[i], t[i + 1], t[i + 2]];
    const ux = p[3 * b] - p[3 * a], uy = p[3 * b + 1] - p[3 * a + 1];
    const vx = p[3 * c] - p[3 * a], vy = p[3 * c + 1] - p[3 * a + 1], twice = ux * vy - uy * vx;
    const uz = shape[3 * b + 2] - shape[3 * a + 2], vz = shape[3 * c + 2] - shape[3 * a + 2], sign = Math.sign(twice);
    for (const k of [a, b, c]) {
      sum[2 * k] += sign * (uz * vy - vz * uy);
      sum[2 * k + 1] += sign * (vz * ux - uz * vx);
      area[k] += sign * twice;
    }
  }
  return sum.map((value, i) => value / (area[i >> 1] || 1));
}

/* Three points and their weights where the plate is at a place. */
function located(plate, [x, y, z]) {
  const { places: p, triangles: t } = plate;
  if (plate.solid) {  // the point next to it
    let next = 0, least = Infinity;
    for (let k = 0; k < plate.count; k++) {
      const off = Math.hypot(p[3 * k] - x, p[3 * k + 1] - y, p[3 * k + 2] - z);
      if (off < least) [next, least] = [k, off];
    }
    return { points: [next], weights: [1] };
  }
  let best = { points: [0, 0, 0], weights: [1, 0, 0], least: -Infinity };
  for (let i = 0; i < t.length; i += 3) {
    const [a, b, c] = [t[i], t[i + 1], t[i + 2]];
    const ux = p[3 * b] - p[3 * a], uy = p[3 * b + 1] - p[3 * a + 1];
    const vx = p[3 * c] - p[3 * a], vy = p[3 * c + 1] - p[3 * a + 1];
    const dx = x - p[3 * a], dy = y - p[3 * a + 1], twice = ux * vy - uy * vx;
    const v = (dx * vy - dy * vx) / twice, w = (ux * dy - uy * dx) / twice, least = Math.min(1 - v - w, v, w);
    if (least > best.least) best = { points: [a, b, c], weights: [1 - v - w, v, w], least };
  }
  return best;
}

/* ---- drawing ---- */

class Painter {
  constructor(gl, plate) {
    this.gl = gl;
    this.plate = plate;
    this.programs = {};
    for (const [name, sources] of Object.entries({ surface: SURFACE, lines: LINES, cells: CELLS, mark: MARK }))
      this.programs[name] = this.program(sources);
    this.buffers = {};
    const twice = array => { const both = new Float32Array(2 * array.length); both.set(array); both.set(array, array.length); return both; };
    this.twice = twice;
    const n = plate.count, t = plate.triangles;
    this.fill("place", twice(plate.places));
    this.fill("offset", Float32Array.from({ length: 2 * n }, (_, k) => k < n ? plate.half[k] : -plate.half[k - n]));
    this.top = this.indices(t);
    this.bottom = this.indices(plate.solid ? [] : t.map(k => k + n), 2 * n);
    const walls = [];
    for (let i = 0; i < plate.outline.length && !plate.solid; i += 2) {
      const a = plate.outline[i], b = plate.outline[i + 1];
      walls.push(a, b, b + n, a, b + n, a + n);
    }
    this.walls = this.indices(walls, 2 * n);
    this.cells = [this.indices(plate.edges), this.indices(plate.edges.map(k => k + n), 2 * n)];
    this.strips = { outline: this.strip(plate.outline), root: this.strip(plate.root) };
    this.colours = new Float32Array(COLOURS.flatMap(hex => rgb(hex)));
    this.shaped(null, null);
  }

  program(sources) {
    const gl = this.gl, program = gl.createProgram();
    [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, k) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, sources[k]);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }

  fill(name, array) {
    const gl = this.gl;
    this.buffers[name] ??= gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
    gl.bufferData(gl.ARRAY_BUFFER, array, gl.DYNAMIC_DRAW);
  }

  indices(numbers, points = 0) {
    const gl = this.gl, wide = points > 65535, buffer = gl.createBuffer();
    const array = wide ? Uint32Array.from(numbers) : Uint16Array.from(numbers);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, array, gl.STATIC_DRAW);
    return { buffer, count: array.length, type: wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT };
  }

  /* Edges as strips of two triangles; `pairs` are filled again for every shape. */
  strip(edges) {
    const corners = [];
    for (let i = 0; i < edges.length; i += 2) {
      const [a, b] = [edges[i], edges[i + 1]];
      corners.push([a, b, 1], [a, b, -1], [b, a, 1], [b, a, 1], [a, b, 1], [b, a, -1]);
    }
    return corners;
  }

  strips_of(name, inPhase, behind) {
    const corners = this.strips[name], p = this.plate.places;
    const of = (array, size, end) => Float32Array.from({ length: size * corners.length },
      (_, i) => array[size * corners[Math.floor(i / size)][end] + i % size]);
    this.fill(name + "Place", of(p, 3, 0));
    this.fill(name + "Other", of(p, 3, 1));
    this.fill(name + "Side", Float32Array.from(corners, corner => corner[2]));
    for (const [end, label] of [[0, ""], [1, "Other"]]) {
      this.fill(name + label + "InPhase", of(inPhase, 3, end));
      this.fill(name + label + "Behind", of(behind, 3, end));
    }
  }

  /* Take up a shape, in phase and behind, 3 numbers a point; null: at rest. */
  shaped(inPhase, behind) {
    const { plate, twice } = this, none = new Float32Array(3 * plate.count);
    inPhase ??= none;
    behind ??= none;
    this.fill("inPhase", twice(inPhase));
    this.fill("behind", twice(behind));
    const a = slopes(plate, inPhase), b = slopes(plate, behind), both = new Float32Array(4 * plate.count);
    for (let k = 0; k < plate.count; k++) both.set([a[2 * k], a[2 * k + 1], b[2 * k], b[2 * k + 1]], 4 * k);
    this.fill("slopes", twice(both));
    this.strips_of("outline", none, none);
    this.strips_of("root", inPhase, behind);
    if (plate.damper) {
      const { points, weights } = located(plate, plate.damper);
      const at = (array, size) => Float32Array.from({ length: size },
        (_, i) => weights.reduce((sum, weight, k) => sum + weight * array[size * points[k] + i], 0));
      this.fill("markPlace", Float32Array.from({ length: 3 }, (_, k) => plate.damper[k] ?? 0));
      this.fill("markInPhase", at(inPhase, 3));
      this.fill("markBehind", at(behind, 3));
    }
  }

  use(name, uniforms, attributes) {
    const gl = this.gl, program = this.programs[name];
    gl.useProgram(program);
    for (const [key, value] of Object.entries(uniforms)) {
      const place = gl.getUniformLocation(program, key);
      if (place === null) continue;
      if (key === "camera") gl.uniformMatrix4fv(place, false, value);
      else if (key === "colours") gl.uniform3fv(place, value);
      else if (typeof value === "number") gl.uniform1f(place, value);
      else gl[`uniform${value.length}fv`](place, value);
    }
    for (let k = 0; k < 8; k++) gl.disableVertexAttribArray(k);
    for (const [key, [buffer, size]] of Object.entries(attributes)) {
      const place = gl.getAttribLocation(program, key);
      if (place < 0) continue;
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[buffer]);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 0, 0);
    }
  }

  draw({ camera, eye, screen, phase, moving, look, cells, ratio }) {
    const gl = this.gl, shared = { camera, phase, screen, colours: this.colours };
    const points = { place: ["place", 3], offset: ["offset", 1], inPhase: ["inPhase", 3], behind: ["behind", 3], slopes: ["slopes", 4] };
    gl.viewport(0, 0, ...screen);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    for (const [set, wall] of [[this.top, 0], [this.bottom, 0], [this.walls, 1]]) {
      this.use("surface", { ...shared, eye, wall, facets: this.plate.solid ? 1 : 0, still: moving ? 0 : 1, plain: look.plate }, points);
      this.elements(gl.TRIANGLES, set);
    }
    if (cells) for (const set of this.cells) {
      this.use("cells", { ...shared, tint: moving ? [1, 1, 1, 0.32] : [...look.ink, 0.55] }, points);
      this.elements(gl.LINES, set);
    }
    this.line("outline", { ...shared, width: 1.1 * ratio, bias: 2e-4, tint: [...look.muted, moving ? 0.9 : 1] });
    this.line("root", { ...shared, width: 3.5 * ratio, bias: 4e-3, tint: [...look.root, 1] });
    if (!this.plate.damper) return;
    gl.disable(gl.DEPTH_TEST);
    this.use("mark", { ...shared, size: 13 * ratio, tint: [...look.damper, 1], ring: look.paper },
      { place: ["markPlace", 3], inPhase: ["markInPhase", 3], behind: ["markBehind", 3] });
    gl.drawArrays(gl.POINTS, 0, 1);
  }

  line(name, uniforms) {
    this.use("lines", uniforms, {
      place: [name + "Place", 3], other: [name + "Other", 3], side: [name + "Side", 1],
      inPhase: [name + "InPhase", 3], behind: [name + "Behind", 3],
      otherInPhase: [name + "OtherInPhase", 3], otherBehind: [name + "OtherBehind", 3],
    });
    this.gl.drawArrays(this.gl.TRIANGLES, 0, this.strips[name].length);
  }

  elements(kind, { buffer, count, type }) {
    this.gl.bindBuffer(this.gl.ELEMENT_ARRAY_BUFFER, buffer);
    this.gl.drawElements(kind, count, type, 0);
  }
}

function rgb(colour) {
  const paint = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  paint.fillStyle = colour;
  paint.fillRect(0, 0, 1, 1);
  return Array.from(paint.getImageData(0, 0, 1, 1).data.slice(0, 3), part => part / 255);
}

/* ---- camera: turned about the plate's normal and raised above it, far enough that the box about the plate fits ---- */

function camera({ yaw, rise, near }, [width, height], box) {
  const [cy, sy, cr, sr] = [Math.cos(yaw), Math.sin(yaw), Math.cos(rise), Math.sin(rise)];
  const right = [cy, sy, 0], back = [sy * cr, -cy * cr, sr], up = [-sy * sr, cy * sr, cr];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const across = LENS * width / height;
  let far = 0;
  for (const x of [-1, 1]) for (const y of [-1, 1]) for (const z of [-1, 1]) {
    const corner = [x * box[0], y * box[1], z * box[2]];
    far = Math.max(far, dot(corner, back)
      + 1.06 * Math.max(Math.abs(dot(corner, right)) / across, Math.abs(dot(corner, up)) / LENS));
  }
  far /= near;
  const low = Math.max(0.01, far - 1.2), high = far + 1.2, a = -(high + low) / (high - low), b = -2 * high * low / (high - low);
  const rows = [right.map(v => v / across), up.map(v => v / LENS), back.map(v => a * v), back.map(v => -v)];
  const shift = [0, 0, -a * far + b, far];
  const matrix = new Float32Array(16);
  rows.forEach((row, r) => { row.forEach((v, c) => { matrix[4 * c + r] = v; }); matrix[12 + r] = shift[r]; });
  return { matrix, eye: back.map(v => far * v), flat: axis => [dot(axis, right), -dot(axis, up)] };
}

/* The directions of the axes as they are seen, in a corner of the picture; the spin axis reaches both ways. */
function triad(svg, axes, flat) {
  svg.innerHTML = Object.entries(axes).map(([name, axis]) => {
    const [x, y] = flat(axis).map(v => 30 * v), kind = name.length > 1 ? "spin" : "";
    const [back, out] = kind ? [-1, -1.4] : [0, 1.4];
    return `<line class="${kind}" x1="${back * x}" y1="${back * y}" x2="${x}" y2="${y}"/>`
      + `<text class="${kind}" x="${out * x}" y="${out * y + 4}">${name}</text>`;
  }).join("");
}

/* ---- a figure ---- */

function start(figure) {
  const canvas = figure.querySelector("canvas"), corner = figure.querySelector(".triad"), form = figure.querySelector("form"), says = figure.querySelector("output");
  const gl = canvas.getContext("webgl2", { antialias: true });
  const beside = text => { figure.querySelector(".viewer-remark").textContent = text; };
  if (!gl) {
    beside("This browser does not support WebGL2: a still picture is shown instead.");
    return;
  }
  const data = JSON.parse(figure.querySelector("script").textContent), plate = unpacked(data);
  let painter = new Painter(gl, plate);
  const moving = data.speeds.length > 0, calm = matchMedia("(prefers-reduced-motion: reduce)");
  const view = { ...HOME }, state = { phase: 0, playing: moving && !calm.matches, seen: true, last: 0, asked: 0 };
  let look;

  function looks() {
    const style = getComputedStyle(figure), colour = name => rgb(style.getPropertyValue(name).trim());
    look = { paper: colour("--paper"), ink: colour("--ink"), muted: colour("--muted"), plate: colour("--rule"),
      root: colour("--line-0"), damper: colour("--line-1") };
  }

  function draw() {
    const ratio = Math.min(devicePixelRatio || 1, 2), { clientWidth: w, clientHeight: h } = canvas;
    if (!w || !h) return;
    const screen = [Math.round(w * ratio), Math.round(h * ratio)];
    if (canvas.width !== screen[0] || canvas.height !== screen[1]) [canvas.width, canvas.height] = screen;
    const swing = moving ? LARGEST * form.amplitude.value : 0;
    const sides = data.span.map(side => side / plate.size / 2);
    const high = sides[2] ?? 0, seen = camera(view, screen, [sides[0], sides[1], high + (moving ? 0.75 * LARGEST : 0)]);
    painter.draw({
      camera: seen.matrix, eye: seen.eye, screen, moving, look, ratio, cells: !form.cells || form.cells.checked,
      phase: [swing * Math.cos(state.phase), swing * Math.sin(state.phase)],
    });
    triad(corner, data.axes, seen.flat);
    canvas.dataset.phase = state.phase.toFixed(3);
  }

  function frame(now) {
    state.asked = 0;
    const step = Math.min(Math.max(now - state.last, 0), 100) / 1000;
    state.last = now;
    if (state.playing) state.phase = (state.phase + 2 * Math.PI * step / PERIOD) % (2 * Math.PI);
    draw();
    if (state.playing && state.seen) later();
  }
  function later() { state.asked ||= requestAnimationFrame(frame); }

  function play(on) {
    state.playing = on && moving;
    if (form.play) {
      form.play.textContent = state.playing ? "pause" : "play";
      form.play.setAttribute("aria-pressed", String(state.playing));
    }
    state.last = performance.now();
    later();
  }

  const number = value => value.toLocaleString("en", { maximumFractionDigits: 2 }).replaceAll(",", "\u2009");
  const speed = () => data.speeds[form.speed.selectedIndex];

  function fill_modes(chosen) {
    form.mode.replaceChildren(...speed().modes.map((mode, k) => {
      const name = `${k + 1} · ${mode.family} · ${mode.hz.toLocaleString("en", { maximumFractionDigits: 1, useGrouping: false })} Hz`;
      return new Option(name, k, false, k === chosen);
    }));
  }

  /* Show a mode at one of the speeds kept, both counted from 0. */
  function show(at, mode) {
    form.speed.selectedIndex = at;
    fill_modes(Math.min(mode, speed().modes.length - 1));
    take();
  }

  function take() {
    const at = form.speed.selectedIndex, mode = form.mode.selectedIndex, shapes = data.speeds.map(each => each.modes.length);
    const before = shapes.slice(0, at).reduce((sum, count) => sum + count, 0) + mode;
    const all = shapes.reduce((sum, count) => sum + count, 0);
    painter.shaped(displacement(plate, before), data.behind ? displacement(plate, all + before) : null);
    const found = speed().modes[mode];
    const text = `${found.family} mode at ${number(speed().rpm)} rpm: ${found.hz.toFixed(2)} Hz`;
    says.textContent = text;
    canvas.setAttribute("aria-label", `${canvas.ariaLabel.split(/ in three|,/)[0]} in three dimensions, ${text}. Arrow keys turn it.`);
    figure.dispatchEvent(new CustomEvent("shown", { bubbles: true, detail: { speed: at, rpm: speed().rpm, mode } }));
    later();
  }

  if (moving) {
    form.speed.replaceChildren(...data.speeds.map((each, k) => new Option(`${number(each.rpm)} rpm`, k)));
    form.speed.addEventListener("change", () => {
      const branch = state.branch, modes = speed().modes, same = modes.findIndex(mode => mode.branch === branch);
      show(form.speed.selectedIndex, same < 0 ? 0 : same);
    });
    form.mode.addEventListener("change", () => take());
    figure.addEventListener("shown", event => { state.branch = data.speeds[event.detail.speed].modes[event.detail.mode].branch; });
    form.amplitude.addEventListener("input", later);
    form.play.addEventListener("click", () => play(!state.playing));
  }
  form.cells?.addEventListener("change", later);
  form.home.addEventListener("click", () => { Object.assign(view, HOME); later(); });
  form.addEventListener("submit", event => event.preventDefault());

  const turn = (yaw, rise) => {
    view.yaw += yaw;
    view.rise = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, view.rise + rise));
    later();
  };
  const approach = factor => { view.near = Math.min(6, Math.max(0.4, view.near * factor)); later(); };
  const KEYS = {
    ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
    "+": () => approach(1.15), "=": () => approach(1.15), "-": () => approach(1 / 1.15), Home: () => form.home.click(),
    " ": () => play(!state.playing),
  };
  canvas.addEventListener("keydown", event => {
    if (!KEYS[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    KEYS[event.key]();
  });

  const fingers = new Map();
  canvas.addEventListener("pointerdown", event => {
    fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", event => {
    const before = fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const other = [...fingers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) approach(Math.hypot(now[0] - other[0], now[1] - other[1]) / Math.max(1, Math.hypot(before[0] - other[0], before[1] - other[1])));
    else turn(-(now[0] - before[0]) / 160, (now[1] - before[1]) / 160);
    fingers.set(event.pointerId, now);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"])
    canvas.addEventListener(end, event => fingers.delete(event.pointerId));
  canvas.addEventListener("wheel", event => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;  // the page scrolls by, unless the plate was chosen
    event.preventDefault();
    approach(Math.exp(-event.deltaY / 600));
  }, { passive: false });

  canvas.addEventListener("webglcontextlost", event => { event.preventDefault(); state.playing = false; });
  canvas.addEventListener("webglcontextrestored", () => { painter = new Painter(gl, plate); moving ? take() : later(); });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { looks(); later(); });
  new ResizeObserver(later).observe(canvas);
  new IntersectionObserver(([entry]) => { state.seen = entry.isIntersecting; if (state.seen) { state.last = performance.now(); later(); } }).observe(canvas);

  /* Marks in a figure that lead to a mode: a click shows it, and the mode in motion is marked. */
  const marks = moving ? [...document.querySelectorAll("a[data-mode]")] : [];
  const mark = ({ speed, mode }) => marks.forEach(each => each.classList.toggle("now", each.dataset.mode === `${speed},${mode}`));
  figure.addEventListener("shown", event => mark(event.detail));
  for (const each of marks) each.addEventListener("click", event => {
    event.preventDefault();
    show(...each.dataset.mode.split(",").map(Number));
    figure.scrollIntoView({ block: "nearest", behavior: "smooth" });
  });

  figure.viewer = { show, draw, frame, play, view, at: () => moving && { speed: form.speed.selectedIndex, mode: form.mode.selectedIndex } };
  figure.classList.add("live");
  form.hidden = false;
  looks();
  if (moving) show(...data.first);
  play(state.playing);
  draw();
}

for (const figure of document.querySelectorAll("figure.viewer")) start(figure);
})();
