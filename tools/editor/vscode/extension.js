// SPDX-License-Identifier: MIT
// Starts `rkm04 lsp` for programs of the RKM04.
'use strict';

const vscode = require('vscode');
const { LanguageClient, TransportKind } = require('vscode-languageclient/node');

let client;

async function activate() {
    const settings = vscode.workspace.getConfiguration('rkm04');
    const server = {
        command: settings.get('path'),
        args: ['lsp', ...settings.get('arguments')],
        transport: TransportKind.stdio,
    };
    client = new LanguageClient('rkm04', 'RKM04', server, { documentSelector: [{ language: 'rks' }] });
    try {
        await client.start();
    } catch (error) {
        vscode.window.showErrorMessage(`RKM04: cannot start '${server.command}': ${error.message}. ` +
            'The setting rkm04.path says where rkm04 is.');
    }
}

function deactivate() {
    return client && client.stop();
}

module.exports = { activate, deactivate };
