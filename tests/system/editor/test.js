// SPDX-License-Identifier: MIT
// test.js CASE EDITOR RKM04: the extension of VS Code in EDITOR/vscode: grammar, snippets, how it starts the server. Exit status 0:
// they are as they should be.
'use strict';

const assert = require('assert');
const child = require('child_process');
const fs = require('fs');
const Module = require('module');
const path = require('path');

const [name, editor, rkm04] = process.argv.slice(2);
const folder = path.join(editor, 'vscode');
const read = (...parts) => fs.readFileSync(path.join(...parts), 'utf8');
const manifest = JSON.parse(read(folder, 'package.json'));

async function loadGrammar() {
    const oniguruma = require('vscode-oniguruma');
    const { Registry, parseRawGrammar } = require('vscode-textmate');
    await oniguruma.loadWASM(fs.readFileSync(require.resolve('vscode-oniguruma/release/onig.wasm')).buffer);
    const file = path.join(folder, manifest.contributes.grammars[0].path);
    const registry = new Registry({
        onigLib: Promise.resolve({
            createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
            createOnigString: (text) => new oniguruma.OnigString(text),
        }),
        loadGrammar: async (scope) => scope === 'source.rks' ? parseRawGrammar(read(file), file) : null,
    });
    return registry.loadGrammar('source.rks');
}

// The innermost scope of each character of a text, without `.rks`.
function scopesOf(grammar, text) {
    const { INITIAL } = require('vscode-textmate');
    let state = INITIAL;
    const scopes = [];
    for (const line of text.split('\n')) {
        const result = grammar.tokenizeLine(line, state);
        state = result.ruleStack;
        for (const token of result.tokens) {
            const inner = token.scopes[token.scopes.length - 1].replace(/\.rks$/, '');
            for (let i = token.startIndex; i < Math.min(token.endIndex, line.length); i++) scopes.push(inner);
        }
        scopes.push('newline');
    }
    return scopes;
}

async function grammarScopes() {
    const grammar = await loadGrammar();
    const flow = 'keyword.control.flow', label = 'entity.name.label', number = 'constant.numeric';
    const expected = {
        '@12': ['keyword.control.label', label, label],
        'J5': [flow, label], '\'5': [flow, label], '’5': [flow, label],
        'I01H40': [flow, number, number, flow, label, label],
        'G-': ['support.function.motion', number],
        'T01': ['support.function.io', number, number],
        'V9': ['variable.parameter', number], '=-1': ['variable.parameter', number, number],
        'R': ['support.function.motion'], '\\': ['support.function.control'],
        'q': ['invalid.illegal'], 'v': ['invalid.illegal'], '5': [number],
        'L\n9': ['keyword.other', 'newline', number],
        'F R': ['invalid.illegal', 'source', 'support.function.motion'],
    };
    for (const [text, scopes] of Object.entries(expected))
        assert.deepStrictEqual(scopesOf(grammar, text).slice(0, -1), scopes, text);
    const comment = scopesOf(grammar, '{nolint unused-label}\n{ F5\n R } R');
    assert.strictEqual(comment[1], 'keyword.control.directive');
    assert.strictEqual(comment[10], 'comment.block');
    assert.strictEqual(comment[25], 'comment.block');
    assert.strictEqual(comment[comment.length - 2], 'support.function.motion');
}

// Every command that the unit reads is one to the grammar, and nothing in a program without errors is illegal.
async function grammarAgreesWithTheUnit(files) {
    const grammar = await loadGrammar();
    let commands = 0;
    for (const file of files) {
        const text = read(file);
        const scopes = scopesOf(grammar, text);
        assert.ok(!scopes.includes('invalid.illegal'), `${file}: ${scopes.indexOf('invalid.illegal')}`);
        const bytes = Buffer.from(text);
        for (const one of JSON.parse(child.execFileSync(rkm04, ['explain', '--json', file]))) {
            const at = bytes.subarray(0, one.offset).toString().length;
            assert.match(scopes[at], /^(keyword|support|variable)\./, `${file}: ${one.offset}`);
            commands++;
        }
    }
    assert.ok(commands > 50, `${commands} commands`);
}

// What a snippet puts in when nothing is changed in it.
function expand(body) {
    return body.join('\n').replace(/\$\{\d+\|([^,|]*)[^}]*\|\}/g, '$1').replace(/\$\{\d+:([^}]*)\}/g, '$1')
        .replace(/\$0/g, '').replace(/\\\\/g, '\\');
}

function snippets() {
    let count = 0;
    for (const { path: file } of manifest.contributes.snippets)
        for (const [title, { prefix, body, description }] of Object.entries(JSON.parse(read(folder, file)))) {
            const text = expand(body);
            assert.ok(prefix && description, title);
            assert.ok(!text.includes('$'), text);
            const found = child.spawnSync(rkm04, ['check', '--no-warn', 'all', '-'], { input: text, encoding: 'utf8' });
            assert.strictEqual(found.stdout, '', `${title}: ${text}`);
            assert.strictEqual(found.status, 0, title);
            count++;
        }
    assert.ok(count >= 15, `${count} snippets`);
}

function filesOfTheManifest() {
    const { languages, grammars, snippets: lists } = manifest.contributes;
    for (const file of [manifest.main, languages[0].configuration, grammars[0].path, ...lists.map((one) => one.path)])
        assert.ok(fs.existsSync(path.join(folder, file)), file);
    JSON.parse(read(folder, languages[0].configuration));
    assert.deepStrictEqual(languages[0].extensions, ['.rks']);
    assert.strictEqual(JSON.parse(read(folder, 'package-lock.json')).packages[''].dependencies['vscode-languageclient'],
        manifest.dependencies['vscode-languageclient']);
}

// The extension with stand-ins for VS Code and its client; what it would start is started, and spoken to with the library that the
// client is made of.
async function extensionStartsTheServer() {
    const protocol = require('vscode-languageserver-protocol/node');
    let started, selector, stopped = false, complaint;
    const settings = { path: rkm04, arguments: ['--lang', 'cs'] };
    const standIns = {
        vscode: {
            workspace: { getConfiguration: (section) => ({ get: (key) => section === 'rkm04' ? settings[key] : undefined }) },
            window: { showErrorMessage: (text) => { complaint = text; } },
        },
        'vscode-languageclient/node': {
            TransportKind: { stdio: 0 },
            LanguageClient: class {
                constructor(id, title, server, client) { started = server; selector = client.documentSelector; }
                async start() { if (started.command === 'missing') throw new Error('ENOENT'); }
                async stop() { stopped = true; }
            },
        },
    };
    const load = Module._load;
    Module._load = (request, ...rest) => standIns[request] || load(request, ...rest);
    const extension = require(path.join(folder, manifest.main));
    await extension.activate();
    assert.deepStrictEqual(selector, [{ language: manifest.contributes.languages[0].id }]);

    const server = child.spawn(started.command, [...started.args, '--stdio'], { stdio: ['pipe', 'pipe', 'inherit'] });
    const ended = new Promise((resolve) => server.on('exit', resolve));
    const connection = protocol.createProtocolConnection(new protocol.StreamMessageReader(server.stdout),
        new protocol.StreamMessageWriter(server.stdin));
    connection.listen();
    await connection.sendRequest(protocol.InitializeRequest.type, { processId: null, rootUri: null, capabilities: {} });
    const reported = new Promise((resolve) => connection.onNotification(protocol.PublishDiagnosticsNotification.type, resolve));
    const document = { uri: 'file:///p.rks', languageId: 'rks', version: 1, text: 'W5 q' };
    connection.sendNotification(protocol.DidOpenTextDocumentNotification.type, { textDocument: document });
    assert.deepStrictEqual((await reported).diagnostics.map((one) => one.code), ['unknown-command']);
    const hover = await connection.sendRequest(protocol.HoverRequest.type,
        { textDocument: { uri: document.uri }, position: { line: 0, character: 0 } });
    assert.match(hover.contents.value, /čekání 5 ms/);
    await connection.sendRequest(protocol.ShutdownRequest.type);
    connection.sendNotification(protocol.ExitNotification.type);
    assert.strictEqual(await ended, 0);

    await extension.deactivate();
    assert.ok(stopped);
    settings.path = 'missing';
    await extension.activate();
    assert.match(complaint, /cannot start 'missing': ENOENT\. The setting rkm04\.path/);
}

const cases = { grammarScopes, grammarAgreesWithTheUnit, snippets, filesOfTheManifest, extensionStartsTheServer };
Promise.resolve(cases[name](process.argv.slice(5))).catch((error) => {
    console.error(error);
    process.exit(1);
});
