// The extension with an editor that only listens: what it starts, and what it says where that fails.
const assert = require("node:assert");
const { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } = require("node:fs");
const Module = require("node:module");
const { tmpdir } = require("node:os");
const { delimiter, join } = require("node:path");
const { after, beforeEach, test } = require("node:test");

const folder = join(__dirname, "..");
const manifest = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
const setting = manifest.contributes.configuration.properties["sdl.server"];

// Where programs are found: nowhere, but for what a test puts there.
const programs = mkdtempSync(join(tmpdir(), "sdl-"));
after(() => rmSync(programs, { recursive: true }));
const [onPath, byCargo] = [join(programs, "path"), join(programs, "cargo", "bin")];
for (const place of [onPath, byCargo]) mkdirSync(place, { recursive: true });
process.env.PATH = [join(programs, "none"), onPath].join(delimiter);
process.env.CARGO_HOME = join(programs, "cargo");

let calls, failure, server;

class LanguageClient {
  constructor(...given) {
    calls.push(["new", ...given]);
  }
  async start() {
    calls.push(["start"]);
    if (failure) throw failure;
  }
  async stop() {
    calls.push(["stop"]);
  }
}

const editor = {
  window: { showErrorMessage: (message) => calls.push(["error", message]) },
  workspace: { getConfiguration: (name) => ({ get: (key) => (`${name}.${key}` === "sdl.server" ? server : undefined) }) },
};

const load = Module._load;
Module._load = (name, ...others) => {
  if (name === "vscode") return editor;
  if (name === "vscode-languageclient/node") return { LanguageClient };
  return load(name, ...others);
};

const extension = require(join(folder, manifest.main));

beforeEach(() => {
  calls = [];
  failure = undefined;
  server = setting.default;
});

test("an .sdl file starts prlsp, and closing the editor stops it", async () => {
  await extension.activate();
  await extension.deactivate();
  const [[, id, , server, client], ...later] = calls;
  assert.deepEqual(server, { command: "prlsp" });
  assert.deepEqual(client, { documentSelector: [{ language: "sdl" }] });
  assert.equal(id, "sdl");
  assert.deepEqual(later, [["start"], ["stop"]]);
});

test("the server is found where cargo installs, before that on the path, and first where the setting says", async () => {
  const started = async () => {
    calls = [];
    await extension.activate();
    return calls[0][3].command;
  };
  writeFileSync(join(byCargo, "prlsp"), "");
  assert.equal(await started(), join(byCargo, "prlsp"));
  writeFileSync(join(onPath, "prlsp"), "");
  assert.equal(await started(), join(onPath, "prlsp"));
  server = "/opt/prlsp";
  assert.equal(await started(), "/opt/prlsp");
  for (const place of [onPath, byCargo]) rmSync(join(place, "prlsp"));
});

test("a server that is not there is named, with what to do", async () => {
  failure = new Error("spawn prlsp ENOENT");
  await extension.activate();
  const [word, message] = calls.at(-1);
  assert.equal(word, "error");
  assert.match(message, /cannot start prlsp: spawn prlsp ENOENT.*cargo install --path crates\/lsp.*sdl\.server/);
  assert.equal(await extension.deactivate(), undefined);
});

test("what the manifest names is there", () => {
  const { languages, grammars } = manifest.contributes;
  const [{ id, extensions, configuration }] = languages;
  const [{ language, scopeName, path }] = grammars;
  assert.deepEqual(extensions, [".sdl"]);
  assert.equal(language, id);
  assert.ok(existsSync(join(folder, configuration)), configuration);
  assert.equal(JSON.parse(readFileSync(join(folder, path), "utf8")).scopeName, scopeName);
  assert.ok(manifest.activationEvents.includes(`onLanguage:${id}`));
});
