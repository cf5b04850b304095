"use strict";
// The page of a scene: shows what the server says, and sends where a person looks from.

const at = (id) => document.getElementById(id);
const canvas = at("canvas");
const paper = canvas.getContext("2d", { alpha: false });

let shown = null; // The newest state of the server.
let camera = null; // Where a person looks from.
let drawn = 0; // The number of the picture on the canvas.
let moving = 0; // Pictures from elsewhere that are on their way.
let pending = null; // The camera that is to be asked for next.
let settling = 0; // The timer that ends a movement.

const coarse = document.createElement("canvas");

function draw(buffer, columns, rows) {
  const [width, height] = shown.size;
  if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
  const picture = new ImageData(new Uint8ClampedArray(buffer), columns, rows);
  if (columns === width && rows === height) {
    paper.putImageData(picture, 0, 0);
    return;
  }
  // One of fewer pixels is drawn larger.
  [coarse.width, coarse.height] = [columns, rows];
  coarse.getContext("2d").putImageData(picture, 0, 0);
  paper.drawImage(coarse, 0, 0, width, height);
}

function size(answer) {
  return [Number(answer.headers.get("X-Columns")), Number(answer.headers.get("X-Rows"))];
}

// Pictures.

let fetching = false;
async function fetchPicture() {
  if (fetching) return;
  fetching = true;
  try {
    while (shown && shown.picture > drawn && !isMoving()) {
      const answer = await fetch("picture");
      if (!answer.ok) break;
      const number = Number(answer.headers.get("X-Picture"));
      const buffer = await answer.arrayBuffer();
      if (isMoving()) break;
      draw(buffer, ...size(answer));
      drawn = number;
      canvas.dataset.picture = number;
    }
  } finally {
    fetching = false;
  }
}

function isMoving() {
  return moving > 0 || pending !== null || settling !== 0;
}

// While the server traces one picture, the one before is on its way: two are asked for at once.
const ASKED = 2;
let asked = 0;
let newest = 0;
function look() {
  while (pending && moving < ASKED) {
    const view = { ...pending, settle: false };
    pending = null;
    moving += 1;
    const number = ++asked;
    send(view)
      .then(async (answer) => {
        if (!answer.ok) throw new Error(await answer.text());
        const buffer = await answer.arrayBuffer();
        if (number < newest) return;
        newest = number;
        draw(buffer, ...size(answer));
        at("statement").textContent = answer.headers.get("X-Camera");
        canvas.dataset.looks = Number(canvas.dataset.looks || 0) + 1;
      })
      .catch((error) => { at("stage").textContent = error.message; })
      .finally(() => {
        moving -= 1;
        look();
      });
  }
}

function send(view) {
  return fetch("view", { method: "POST", body: JSON.stringify(view) });
}

// A movement ends when nothing has moved for a while; then the picture gets better.
const REST = 150;
function move(to) {
  camera = to;
  pending = to;
  look();
  clearTimeout(settling);
  settling = setTimeout(settle, REST);
}

async function settle() {
  if (moving > 0 || held) {
    settling = setTimeout(settle, REST);
    return;
  }
  const to = camera;
  await send({ ...to, settle: true }).catch(() => {});
  if (to === camera) {
    settling = 0;
    fetchPicture();
  }
}

// Cameras.

const sum = (a, b) => a.map((x, k) => x + b[k]);
const times = (a, s) => a.map((x) => x * s);
const minus = (a, b) => a.map((x, k) => x - b[k]);
const long = (a) => Math.hypot(...a);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => times(a, 1 / long(a));

// Digits that a person would write: five of the distance.
function tidy(view) {
  const step = 10 ** (Math.floor(Math.log10(long(minus(view.position, view.target)))) - 4);
  const decimals = Math.max(0, Math.min(20, -Math.log10(step)));
  const round = (x) => Number((Math.round(x / step) * step).toFixed(Math.round(decimals)));
  return { ...view, position: view.position.map(round), target: view.target.map(round) };
}

const PITCH = 89 * Math.PI / 180;

function orbit(view, right, up) {
  const arm = minus(view.position, view.target);
  const length = long(arm);
  const yaw = Math.atan2(arm[0], arm[2]) - right;
  const pitch = Math.max(-PITCH, Math.min(PITCH, Math.asin(arm[1] / length) + up));
  const level = Math.cos(pitch) * length;
  const turned = [Math.sin(yaw) * level, Math.sin(pitch) * length, Math.cos(yaw) * level];
  return tidy({ ...view, position: sum(view.target, turned) });
}

function pan(view, right, up) {
  const forward = minus(view.target, view.position);
  let side = cross(forward, [0, 1, 0]);
  if (long(side) < 1e-9 * long(forward)) side = [1, 0, 0];
  side = unit(side);
  const top = unit(cross(side, forward));
  // The frame is 24 mm high and wide at the target, about.
  const width = 24 / view.focal_length * long(forward);
  const shift = sum(times(side, -right * width), times(top, up * width));
  return tidy({ ...view, position: sum(view.position, shift), target: sum(view.target, shift) });
}

function zoom(view, factor) {
  return tidy({ ...view, position: sum(view.target, times(minus(view.position, view.target), factor)) });
}

// What a person does.

let held = null; // Where the pointer went down, and the camera then.
const CLICK = 4; // Pixels that a click may move.

canvas.addEventListener("pointerdown", (event) => {
  if (!camera || event.button > 2) return;
  canvas.setPointerCapture(event.pointerId);
  held = { x: event.clientX, y: event.clientY, camera, pan: event.shiftKey || event.button > 0, moved: false };
});
canvas.addEventListener("pointermove", (event) => {
  if (!held) return;
  const [x, y] = [event.clientX - held.x, event.clientY - held.y];
  if (!held.moved && Math.hypot(x, y) < CLICK) return;
  held.moved = true;
  const box = canvas.getBoundingClientRect();
  if (held.pan) move(pan(held.camera, x / box.width, y / box.height));
  else move(orbit(held.camera, x / box.width * Math.PI, y / box.height * Math.PI));
});
canvas.addEventListener("pointerup", (event) => {
  const was = held;
  held = null;
  if (was && !was.moved && event.button === 0) ask(event);
});
canvas.addEventListener("pointercancel", () => { held = null; });
canvas.addEventListener("contextmenu", (event) => event.preventDefault());
canvas.addEventListener("wheel", (event) => {
  if (!camera) return;
  event.preventDefault();
  const lines = event.deltaMode === 0 ? event.deltaY / 400 : event.deltaY / 12;
  move(zoom(camera, Math.exp(Math.max(-1, Math.min(1, lines)))));
}, { passive: false });
canvas.addEventListener("keydown", (event) => {
  if (!camera) return;
  const step = Math.PI / 36;
  const turns = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] };
  const near = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[event.key];
  if (turns[event.key]) move(orbit(camera, ...turns[event.key]));
  else if (near) move(zoom(camera, near));
  else return;
  event.preventDefault();
});

at("copy").addEventListener("click", async () => {
  const text = at("statement").textContent;
  const button = at("copy");
  try {
    await navigator.clipboard.writeText(text);
    button.textContent = "Copied";
  } catch {
    // Without leave to use the clipboard: marked, to be copied by hand.
    getSelection().selectAllChildren(at("statement"));
    button.textContent = "Marked";
  }
  setTimeout(() => { button.textContent = "Copy"; }, 1500);
});
at("reset").addEventListener("click", () => {
  clearTimeout(settling);
  [pending, settling, camera] = [null, 0, null];
  fetch("reset", { method: "POST" });
});

async function ask(event) {
  const box = canvas.getBoundingClientRect();
  const along = (place, start, length, count) => Math.max(0, Math.min(count - 1, Math.floor((place - start) / length * count)));
  const x = along(event.clientX, box.left, box.width, canvas.width);
  const y = along(event.clientY, box.top, box.height, canvas.height);
  const answer = await fetch(`pixel?x=${x}&y=${y}`);
  if (!answer.ok) return;
  const { found } = await answer.json();
  const lines = [line(`Pixel ${x}, ${y}`, "quiet")];
  if (found) {
    lines.push(line(found.name ? `${found.name} (object ${found.object})` : `object ${found.object}, without a name`));
    if (found.place) {
      lines.push(line(`${found.place.file}, line ${found.place.line}, column ${found.place.column}`));
      const text = document.createElement("pre");
      text.textContent = found.place.text;
      lines.push(text);
    }
    lines.push(line(`depth ${short(found.depth)}`));
    lines.push(line(`normal (${found.normal.map(short).join(", ")})`));
  } else {
    lines.push(line("The background."));
  }
  at("pick").replaceChildren(...lines);
}

const short = (x) => String(Number(x.toPrecision(6)));

function line(text, kind) {
  const p = document.createElement("p");
  p.textContent = text;
  if (kind) p.className = kind;
  return p;
}

// What the server says.

function row(cells, title) {
  const tr = document.createElement("tr");
  for (const cell of cells) {
    const td = document.createElement("td");
    td.textContent = cell;
    tr.append(td);
  }
  if (title) tr.title = title;
  return tr;
}

const STAGES = {
  "nothing": "no picture yet",
  "coarse": "coarse; more samples are on the way",
  "at once": "one sample a pixel; more are on the way",
  "refining": "getting better",
  "finished": "finished",
};

function show(state) {
  const same = shown && JSON.stringify(shown.camera) === JSON.stringify(state.camera);
  shown = state;
  document.title = `${state.scene} – portray`;
  at("scene").textContent = state.scene;
  const wrong = state.problems.some((problem) => problem.error);
  at("stage").textContent = wrong
    ? state.picture ? "errors; this is the last good picture" : "errors"
    : STAGES[state.stage];
  document.body.dataset.stage = wrong ? "error" : state.stage;
  at("problems").hidden = state.problems.length === 0;
  at("problems").replaceChildren(...state.problems.map((problem) => {
    const pre = document.createElement("pre");
    pre.className = problem.error ? "error" : "warning";
    pre.textContent = problem.text.trimEnd();
    return pre;
  }));
  if (state.camera && (!camera || (!same && !isMoving()))) camera = state.camera;
  if (!isMoving()) at("statement").textContent = state.statement;
  at("figures").replaceChildren(...state.figures.map((cells) => row(cells)));
  const left = state.omissions.filter((pass) => pass.before !== pass.after);
  at("omissions").replaceChildren(...(left.length === 0
    ? [row(["Nothing: the scene needs all of it.", ""])]
    : left.map((pass) => row([pass.why, `${pass.before} → ${pass.after}`], pass.name))));
  fetchPicture();
}

const events = new EventSource("events");
events.onmessage = (event) => show(JSON.parse(event.data));
events.onerror = () => {
  at("stage").textContent = "portray has ended, or cannot be reached";
  document.body.dataset.stage = "gone";
};
