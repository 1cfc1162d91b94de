// SPDX-License-Identifier: MIT
// kit.mjs: a Pico for tools/conformance --port 'board:node kit.mjs ELF [REPLAY]', in its own time: however busy the machine is,
// nothing comes late. A request a line on standard input, `= TICK [RESULT]` on standard output: `bytes HEX`, they go to the bus;
// `wait TICKS`, until the board sends something, in hexadecimal; `advance TICKS`; `inputs MASK`; `outputs`; `reset`, power off and
// on. With REPLAY (replay.c) all changes of the pins are compared with the core's at the end, and standard error says so.
import { createInterface } from 'node:readline';

import { Board, readElf } from './board.mjs';
import { Recording } from './recording.mjs';

const [elf, replay] = process.argv.slice(2), heard = [], recording = new Recording(), STEP = 500; // us
const board = new Board(readElf(elf), { onByte: (byte) => heard.push(byte), ...(replay ? recording.options : {}) });
recording.attach(board);

const now = () => Math.floor((board.past + board.nanos) / 1000);

const obey = {
    bytes: (hex) => board.send(Buffer.from(hex ?? '', 'hex')),
    advance: (ticks) => board.run(ticks * 1000),
    wait: (ticks) => {
        for (const end = now() + Number(ticks); heard.length === 0 && now() < end;)
            board.run(Math.min(STEP, end - now()) * 1000);
        return Buffer.from(heard.splice(0)).toString('hex');
    },
    inputs: (mask) => board.setInputs(Number(mask)),
    outputs: () => board.outputs,
    reset: () => replay ? recording.power() : board.power(),
};

function report() {
    const { steps, others, offsets } = recording.compare(replay);
    console.error(`${steps} pulses and ${others} changes of directions and outputs compared:`);
    for (const [name, [from, to]] of Object.entries(offsets)) {
        console.error(`${name}: ${from} to ${to} ns from its tick`);
        if (from < -500 || to > 500)
            process.exitCode = 1;
    }
}

for await (const line of createInterface({ input: process.stdin })) {
    const [word, argument] = line.split(' ');
    if (!(word in obey))
        throw new Error(`${word}: expected ${Object.keys(obey).join(', ')}`);
    const result = obey[word](argument) ?? '';
    console.log(`= ${now()} ${result}`);
}
if (replay)
    report();
