// SPDX-License-Identifier: MIT
// serve.mjs: a Pico whose bus is a TCP port, in real time: bytes as they are, one client.
//
//     node serve.mjs ELF [--tcp PORT]
//
// Prints `READY HOST:PORT`. Standard input, a line each: `input N LEVEL`, `power` (off and on), `outputs` (prints DO as a number),
// `quit`. For tools/conformance there is kit.mjs.
import { createServer } from 'node:net';
import { createInterface } from 'node:readline';

import { Board, readElf } from './board.mjs';

const [elf, option, port = '0'] = process.argv.slice(2);
if (elf === undefined || (option ?? '--tcp') !== '--tcp') {
    console.error('usage: node serve.mjs ELF [--tcp PORT]');
    process.exit(2);
}

let client = null;
const answer = [];
const board = new Board(readElf(elf), { onByte: (byte) => answer.push(byte) });

// The board's time follows ours. Where the machine is too slow it falls behind, and never catches up: what takes its time on the
// board takes as long or longer for whoever is connected.
let last = performance.now();
function turn() {
    const now = performance.now(), pass = Math.min(now - last, 50);
    last = now;
    board.run(pass * 1e6);
    if (answer.length > 0)
        client?.write(Buffer.from(answer.splice(0)));
    setTimeout(turn, 1);
}

function obey(line) {
    const [word, ...numbers] = line.trim().split(/\s+/), [number, level] = numbers.map(Number);
    switch (word) {
    case 'input': return board.setInputs(level ? board.inputs | 1 << number - 1 : board.inputs & ~(1 << number - 1));
    case 'power': return board.power();
    case 'outputs': return console.log(board.outputs);
    case 'quit': return process.exit(0);
    default: console.error(`serve.mjs: ${word}: expected input, power, outputs, quit`);
    }
}

const server = createServer((socket) => {
    client = socket.setNoDelay(true).on('data', (data) => board.send(data)).on('error', () => {});
    socket.on('close', () => { client = client === socket ? null : client; });
});
server.listen(Number(port), '127.0.0.1', () => {
    console.log(`READY 127.0.0.1:${server.address().port}`);
    createInterface({ input: process.stdin }).on('line', obey).on('close', () => process.exit(0));
    turn();
});
