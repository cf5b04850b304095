// Starts prlsp when the first .sdl file is opened.
const { existsSync } = require("node:fs");
const { homedir } = require("node:os");
const { delimiter, join } = require("node:path");
const { window, workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

// A name without a folder is looked for on the path, and where cargo installs: editors that a desktop has started often have
// not that on their path. What is not found keeps its name, so that the system says why it cannot be started.
function located(command) {
  if (/[\\/]/.test(command)) return command;
  const cargo = process.env.CARGO_HOME || join(homedir(), ".cargo");
  const folders = (process.env.PATH || "").split(delimiter).filter(Boolean);
  const names = process.platform === "win32" ? [`${command}.exe`, command] : [command];
  const places = [...folders, join(cargo, "bin")].flatMap((folder) => names.map((name) => join(folder, name)));
  return places.find((place) => existsSync(place)) ?? command;
}

exports.activate = async () => {
  const setting = workspace.getConfiguration("sdl").get("server");
  const command = located(setting);
  client = new LanguageClient("sdl", "SDL", { command }, { documentSelector: [{ language: "sdl" }] });
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    // Colours of words need no server.
    window.showErrorMessage(
      `SDL: cannot start ${setting}: ${error.message}. Build it by "cargo install --path crates/lsp", or say where it is in the setting sdl.server.`,
    );
  }
};

exports.deactivate = () => client?.stop();
