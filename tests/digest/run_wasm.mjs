// SPDX-License-Identifier: MIT
// run_wasm.mjs: run a WebAssembly module of main_wasm.c and print its lines.
import { readFileSync } from 'node:fs';

const lines = [];
const host = {
    say(at) {
        const bytes = new Uint8Array(instance.exports.memory.buffer);
        lines.push(String.fromCharCode(...bytes.subarray(at, bytes.indexOf(0, at))));
    },
};
const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), { host });
instance.exports.digest_main();
process.stdout.write(lines.join('\n') + '\n');
