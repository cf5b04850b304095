// Starts prlsp for every .sdl file.
const { workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

exports.activate = () => {
  const command = workspace.getConfiguration("sdl").get("server");
  client = new LanguageClient("sdl", "SDL", { command }, { documentSelector: [{ language: "sdl" }] });
  return client.start();
};

exports.deactivate = () => client?.stop();
