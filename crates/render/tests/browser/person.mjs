// What a person does at the page of `portray --watch`, in a browser without a window.
//
//   node person.mjs CHROMIUM PORTRAY FOLDER [PICTURES]
//
// FOLDER is empty, and gets the scene. With PICTURES screenshots are kept there. With MEASURE=SCENE.sdl in the environment a copy of
// that scene is shown at 512 x 512, with OPTIONS, and the times of saves and the rate of pictures while dragging are printed. The
// browser is spoken to by the DevTools protocol over a pipe.

import { spawn } from "node:child_process";
import { copyFileSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { createInterface } from "node:readline";

const [chromium, portray, folder, pictures] = process.argv.slice(2);
const measured = process.env.MEASURE;
const scene = join(folder, "scene.sdl");
const GOOD = `object ball is red sphere at (0, 1, 0)
object floor is white block at (0, -1, 0) scale (6, 1, 6)
light at (5, 9, 5)
ambient intensity 0.4
background light gray
camera at (0, 3, 9) target at (0, 0.5, 0)
`;
const DEADLINE = 60_000;

const started = [];
function end(status) {
  for (const child of started) {
    try { process.kill(-child.pid); } catch { /* It has ended. */ }
  }
  process.exit(status);
}
for (const signal of ["SIGINT", "SIGTERM"]) process.on(signal, () => end(1));
process.on("uncaughtException", (error) => { console.error(error); end(1); });
process.on("unhandledRejection", (error) => { console.error(error); end(1); });

function start(program, words, stdio) {
  const child = spawn(program, words, { stdio, detached: true });
  started.push(child);
  return child;
}

// The program.

if (measured) copyFileSync(measured, scene);
else writeFileSync(scene, GOOD);
const size = measured ? "512x512" : "160x120";
const more = process.env.OPTIONS?.split(" ") ?? [];
const program = start(portray, [scene, "--watch", "-q", "--size", size, ...more], ["ignore", "pipe", "ignore"]);
const lines = createInterface({ input: program.stdout });
const url = await new Promise((resolve, reject) => {
  lines.once("line", resolve);
  program.once("exit", (status) => reject(new Error(`${portray} ended with status ${status} before it told its address`)));
});

// The browser.

const browser = start(chromium, [
  "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
  "--remote-debugging-pipe", `--user-data-dir=${join(folder, "profile")}`, "about:blank",
], ["ignore", "ignore", "ignore", "pipe", "pipe"]);
let number = 0;
const waiting = new Map();
const problems = [];
let rest = Buffer.alloc(0);
browser.stdio[4].on("data", (data) => {
  rest = Buffer.concat([rest, data]);
  for (let at; (at = rest.indexOf(0)) >= 0; rest = rest.subarray(at + 1)) {
    const message = JSON.parse(rest.subarray(0, at).toString());
    if (message.id) {
      waiting.get(message.id)(message);
      waiting.delete(message.id);
    } else if (message.method === "Runtime.exceptionThrown" || (message.method === "Log.entryAdded" && message.params.entry.level === "error")) {
      problems.push(JSON.stringify(message.params));
    }
  }
});
function call(method, params = {}, sessionId) {
  number += 1;
  const answer = new Promise((resolve) => waiting.set(number, resolve));
  browser.stdio[3].write(`${JSON.stringify({ id: number, method, params, sessionId })}\0`);
  return answer.then((message) => {
    if (message.error) throw new Error(`${method}: ${message.error.message}`);
    return message.result;
  });
}
const { targetId } = await call("Target.createTarget", { url: "about:blank" });
const { sessionId } = await call("Target.attachToTarget", { targetId, flatten: true });
const page = (method, params) => call(method, params, sessionId);
await Promise.all(["Page", "Runtime", "Log"].map((part) => page(`${part}.enable`)));
await call("Browser.grantPermissions", { permissions: ["clipboardReadWrite", "clipboardSanitizedWrite"] });

async function value(expression) {
  const answer = await page("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
  if (answer.exceptionDetails) throw new Error(`${expression}: ${JSON.stringify(answer.exceptionDetails)}`);
  return answer.result.value;
}
async function until(expression, what) {
  const begun = Date.now();
  while (!(await value(expression))) {
    if (Date.now() - begun > DEADLINE) {
      throw new Error(`waited too long until ${what}; the page says: ${await value("document.body.innerText")}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
  console.log(`ok: ${what}`);
}
function check(holds, what) {
  if (!holds) throw new Error(`not so: ${what}`);
  console.log(`ok: ${what}`);
}
const text = (id) => value(`document.getElementById("${id}").innerText`);
const mouse = (type, x, y, more = {}) => page("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: 1, ...more });
async function screen(width, height) {
  await page("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: false });
}
async function screenshot(name) {
  if (!pictures) return;
  const { data } = await page("Page.captureScreenshot", { format: "png" });
  writeFileSync(join(pictures, `${name}.png`), Buffer.from(data, "base64"));
}
// The colour in the middle of the canvas.
const middle = () => value(`(() => { const c = document.getElementById("canvas");
  return [...c.getContext("2d").getImageData(c.width / 2, c.height / 2, 1, 1).data]; })()`);
const box = () => value(`(() => { const b = document.getElementById("canvas").getBoundingClientRect();
  return [b.x + b.width / 2, b.y + b.height / 2, b.width]; })()`);

await screen(1280, 800);
await page("Page.navigate", { url });
await until(`document.getElementById("canvas")?.dataset.picture > 0`, "there is a picture");

if (measured) await measure();
else await person();
check(problems.length === 0, `nothing went wrong on the page ${problems}`);
await call("Browser.close").catch(() => {});
end(0);

async function person() {
  await until(`document.body.dataset.stage === "finished"`, "the picture is finished");
  let [r, g, b] = await middle();
  check(r > 2 * g && r > 2 * b, `the ball is red: ${[r, g, b]}`);
  check(/rays/.test(await text("figures")) && /estimated error/.test(await text("figures")), "there are statistics and an estimated error");
  check((await text("omissions")).length > 0, "what was left out is told");

  console.log("edit");
  writeFileSync(scene, GOOD.replace("red", "green"));
  await until(`(() => { const c = document.getElementById("canvas");
    const [r, g] = c.getContext("2d").getImageData(c.width / 2, c.height / 2, 1, 1).data; return g > 2 * r; })()`, "the ball is green");

  console.log("break");
  writeFileSync(scene, GOOD.replace("red sphere", "red sphre"));
  await until(`document.body.dataset.stage === "error"`, "the error is seen");
  const said = await text("problems");
  check(/scene\.sdl:1:\d+: error: .*sphre/.test(said), `its place is told: ${said}`);
  check(/\^\^\^\^\^/.test(said) && /sphere/.test(said), "a caret and a hint are there");
  [r, g, b] = await middle();
  check(g > 2 * r, "the last good picture stays");
  await screenshot("error");

  console.log("mend");
  writeFileSync(scene, GOOD);
  await until(`document.getElementById("problems").hidden`, "the error is gone");
  await until(`document.body.dataset.stage === "finished"`, "the picture is finished again");
  const before = await text("statement");
  check(before === "camera at (0, 3, 9) target at (0, 0.5, 0) focal length 50", `the camera is the file's: ${before}`);

  console.log("click");
  const [x, y, width] = await box();
  await mouse("mousePressed", x, y);
  await mouse("mouseReleased", x, y);
  await until(`/ball \\(object 1\\)/.test(document.getElementById("pick").innerText)`, "the object is named");
  const pick = await text("pick");
  check(/line 1, column 1/.test(pick) && /object ball is red sphere/.test(pick), `with its line: ${pick}`);
  check(/depth 8\.\d+/.test(pick) && /normal \(/.test(pick), "with depth and normal");

  console.log("drag");
  await mouse("mousePressed", x, y);
  for (let step = 1; step <= 20; step += 1) await mouse("mouseMoved", x + step * width / 80, y);
  await mouse("mouseReleased", x + width / 4, y);
  await until(`document.getElementById("canvas").dataset.looks > 0`, "pictures came while it was dragged");
  await until(`document.getElementById("statement").innerText !== ${JSON.stringify(before)}`, "the camera has moved");
  await until(`document.body.dataset.stage === "finished" && !isMoving()`, "the picture is finished from there");
  // A quarter of the width is an eighth of a turn, the arm from the target is (0, 2.5, 9).
  const after = await text("statement");
  const [, px, py, pz] = after.match(/camera at \(([^,]+), ([^,]+), ([^)]+)\)/).map(Number);
  check(Math.abs(px + 6.364) < 0.1 && Math.abs(py - 3) < 0.01 && Math.abs(pz - 6.364) < 0.1, `by an eighth of a turn: ${after}`);
  await screenshot("page-1280");

  console.log("copy");
  await value(`document.getElementById("copy").click()`);
  await until(`document.getElementById("copy").innerText === "Copied"`, "the statement is copied");
  check((await value("navigator.clipboard.readText()")) === after, "it is on the clipboard");

  console.log("wheel and pan");
  await mouse("mouseWheel", x, y, { button: "none", deltaX: 0, deltaY: -200 });
  await until(`document.getElementById("statement").innerText !== ${JSON.stringify(after)} && !isMoving()`, "the wheel goes nearer");
  const near = await text("statement");
  await mouse("mousePressed", x, y, { modifiers: 8 });
  await mouse("mouseMoved", x + 40, y + 20, { modifiers: 8 });
  await mouse("mouseReleased", x + 40, y + 20, { modifiers: 8 });
  await until(`document.getElementById("statement").innerText !== ${JSON.stringify(near)} && !isMoving()`, "with Shift the camera goes aside");
  check(!/target at \(0, 0\.5, 0\)/.test(await text("statement")), "the target, too");

  console.log("paste");
  writeFileSync(scene, GOOD.replace(/camera.*/, after));
  await until(`document.getElementById("statement").innerText === ${JSON.stringify(after)}`, "the file's new camera counts");

  console.log("narrow");
  await screen(400, 800);
  check(await value("document.documentElement.scrollWidth <= 400"), "nothing is wider than a screen of 400 pixels");
  await screenshot("page-400");
}

// Milliseconds of processors that a program and all that it has started have taken; 0 where the system does not tell.
function taken(program) {
  const times = new Map();
  let numbers = [];
  try {
    numbers = readdirSync("/proc").filter((name) => /^\d+$/.test(name));
  } catch { /* Another system. */ }
  for (const number of numbers) {
    try {
      const fields = readFileSync(`/proc/${number}/stat`, "utf8").replace(/^.*\) /s, "").split(" ");
      times.set(Number(number), [Number(fields[1]), 10 * (Number(fields[11]) + Number(fields[12]))]);
    } catch { /* It has ended. */ }
  }
  const belongs = (number) => number === program.pid || (times.has(number) && belongs(times.get(number)[0]));
  return [...times].filter(([number]) => belongs(number)).reduce((sum, [, [, time]]) => sum + time, 0);
}

async function measure() {
  const original = readFileSync(scene, "utf8");
  await value(`(() => { window.drawnAt = []; const draw = paper.putImageData.bind(paper);
    paper.putImageData = (...all) => { draw(...all); drawnAt.push(Date.now()); drawnAt.revision = shown.revision; }; })()`);
  const [x, y] = await box();
  const saves = [];
  for (let round = 0; round < 8; round += 1) {
    const shown = value(`new Promise((resolve) => { const next = shown.revision + 1;
      const look = () => drawnAt.revision === next ? resolve(Date.now()) : setTimeout(look, 2); setTimeout(look, 2); })`);
    await value("1");
    const begun = Date.now();
    writeFileSync(scene, `${original}// ${round}\n`);
    saves.push((await shown) - begun);
  }
  console.log(`from save to picture in the browser, ms: ${saves.sort((a, b) => a - b).join(" ")}`);
  const before = [program, browser].map(taken);
  const [inBrowser, count] = await value(`new Promise((resolve) => { drawnAt.length = 0; const begun = Date.now();
    const from = camera; let step = 0;
    const drag = () => {
      move(orbit(from, step / 100, 0)); step += 1;
      if (Date.now() - begun < 2000) setTimeout(drag, 8);
      else resolve([drawnAt.length / (Date.now() - begun) * 1000, drawnAt.length]);
    };
    drag(); })`);
  const [made, drawn] = [program, browser].map((process, number) => (taken(process) - before[number]) / count);
  console.log(`pictures a second in the browser while dragging: ${inBrowser.toFixed(1)}`);
  console.log(`milliseconds of processors for each: portray ${made.toFixed(1)}, browser ${drawn.toFixed(1)}`);
  await value(`document.getElementById("reset").click()`);
  await until(`document.body.dataset.stage === "finished"`, "the picture is finished");
  await mouse("mousePressed", x, y);
  await mouse("mouseReleased", x, y);
  await until(`/object/.test(document.getElementById("pick").innerText)`, "the object is named");
  await screenshot("wine-glass");
}
