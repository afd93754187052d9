// Starts the language server; all else is the server's.
const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

exports.activate = () => {
  const settings = vscode.workspace.getConfiguration("lightloom");
  const server = { command: settings.get("path"), args: settings.get("arguments") };
  const documentSelector = [{ scheme: "file", language: "ron" }, { scheme: "file", language: "wgsl" }];
  client = new LanguageClient("lightloom", "Lightloom", server, { documentSelector });
  return client.start();
};

exports.deactivate = () => client?.stop();
