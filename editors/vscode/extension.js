// Starts prlsp when the first .sdl file is opened.
const { window, workspace } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

exports.activate = async () => {
  const command = workspace.getConfiguration("sdl").get("server");
  client = new LanguageClient("sdl", "SDL", { command }, { documentSelector: [{ language: "sdl" }] });
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    // Colours of words need no server.
    window.showErrorMessage(
      `SDL: cannot start ${command}: ${error.message}. Build it by "cargo install --path crates/lsp", or say where it is in the setting sdl.server.`,
    );
  }
};

exports.deactivate = () => client?.stop();
