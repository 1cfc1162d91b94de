// SPDX-License-Identifier: MIT
// serve.mjs: a Pico whose bus is a TCP port, in real time: bytes as they are, one client.
//
//     node serve.mjs ELF [--tcp PORT] [--speed N] [--replay PROGRAM] [COMMAND...]
//
// Prints `READY HOST:PORT`. Standard input, a line each: `input N LEVEL`, `power` (off and on), `outputs` (prints DO as a number),
// `quit`. With a COMMAND it is run with {port} replaced by HOST:PORT, and what it asks a person to do at the unit (tools/conformance
// does) is done here; its exit status is the result. --speed: the board's time goes N times as fast as ours, if the machine can.
// --replay: at the end every pulse is compared with the core's (replay.c).
import { spawn } from 'node:child_process';
import { createServer } from 'node:net';
import { createInterface } from 'node:readline';

import { Board, readElf } from './board.mjs';
import { Recording } from './recording.mjs';

const words = process.argv.slice(2), elf = readElf(words.shift());
const option = (name, otherwise) => {
    const at = words.indexOf(`--${name}`);
    return at < 0 ? otherwise : words.splice(at, 2)[1];
};
const speed = Number(option('speed', 1)), replay = option('replay'), port = Number(option('tcp', 0));

let client = null;
const answer = [];
const recording = new Recording();
const board = new Board(elf, { onByte: (byte) => answer.push(byte), ...(replay ? recording.options : {}) });
recording.attach(board);

// The board's time follows ours. Where the machine is too slow it falls behind, and never catches up: what takes its time on the
// board takes as long or longer for whoever is connected.
let last = performance.now();
function turn() {
    const now = performance.now(), pass = Math.min((now - last) * speed, 50);
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
    case 'power': return replay ? recording.power() : board.power();
    case 'outputs': return console.log(board.outputs);
    case 'quit': return process.exit(0);
    default: console.error(`serve.mjs: ${word}: expected input, power, outputs, quit`);
    }
}

// What the conformance kit asks for on its standard error, and the answer on its standard input.
function lendHand(child) {
    let asked = '';
    child.stderr.on('data', (data) => {
        asked += data;
        const found = /\n>>> (.*?)(?:, then press Enter|then Enter): $/.exec(asked);
        if (!found)
            return;
        asked = '';
        for (const [, number, level] of found[1].matchAll(/set input (\d+) to ([01])/g))
            obey(`input ${number} ${level}`);
        if (found[1].startsWith('switch the unit off and on'))
            obey('power');
        child.stdin.write(found[1].startsWith('is output DO 01 on') ? board.outputs & 1 ? 'y\n' : 'n\n' : '\n');
    });
    child.on('exit', (status) => {
        if (asked)
            process.stderr.write(asked);
        if (replay)
            report();
        process.exit(status ?? 1);
    });
}

// Every pulse of all that was done, compared with the core.
function report() {
    const { steps, others, offsets } = recording.compare(replay);
    console.log(`${steps} pulses and ${others} changes of directions and outputs compared:`);
    for (const [name, [from, to]] of Object.entries(offsets))
        console.log(`${name}: ${from} to ${to} ns from its tick`);
    if (Object.values(offsets).some(([from, to]) => from < -500 || to > 500)) {
        console.error('serve.mjs: not at their ticks');
        process.exit(1);
    }
}

const server = createServer((socket) => {
    client = socket.setNoDelay(true).on('data', (data) => board.send(data)).on('error', () => {});
    socket.on('close', () => { client = client === socket ? null : client; });
});
server.listen(port, '127.0.0.1', () => {
    const where = `127.0.0.1:${server.address().port}`;
    if (words.length === 0) {
        console.log(`READY ${where}`);
        createInterface({ input: process.stdin }).on('line', obey).on('close', () => process.exit(0));
    } else {
        const [command, ...rest] = words.map((word) => word.replace('{port}', where));
        lendHand(spawn(command, rest, { stdio: ['pipe', 'inherit', 'pipe'] }));
    }
    turn();
});
