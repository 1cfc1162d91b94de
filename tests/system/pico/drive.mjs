// SPDX-License-Identifier: MIT
// drive.mjs: what the tests of the Pico do with it. Arguments: what to do, the firmware's ELF file, and what else the function
// takes; exits with status 1 and a line that says what is wrong.
import { readFileSync } from 'node:fs';

import { Board, PowerCut, readElf } from './board.mjs';
import { Host } from './host.mjs';
import { Recording } from './recording.mjs';

const SECOND = 1e9, MS = 1e6;

function check(right, what) {
    if (!right)
        throw new Error(what);
}

// A board that has started, with a host on its bus.
function start(elf, options = {}) {
    const host = new Host(), node = options.node ?? 1;
    const board = new Board(elf, { onByte: host.onByte, ...options });
    board.run(20 * MS);
    return host.attach(board, node);
}

// The answers of a unit, and who gives them.
function answers(elf) {
    for (const node of [1, 2, 9, 16]) {
        const host = start(elf, { node });
        check(host.ask('\x01').endsWith('01.02,06.03.2009'), `node ${node}: the version is wrong`);
        host.node = node % 16 + 1;
        let silent = false;
        try {
            host.ask('\x01');
        } catch {
            silent = true;
        }
        check(silent, `the unit at ${node} answers to node ${host.node}`);
    }
    const host = start(elf), answer = host.ask('\x021F100 Q');
    check(answer.charCodeAt(2) === 2 && answer[3] === 'Q', 'an unknown command is not reported');
}

// The RS485 driver is on before a byte leaves (the board checks that) and off soon after the last stop bit.
function driver(elf) {
    let level = 0, off = 0, turns = 0, last = 0;
    const host = new Host();
    const board = new Board(elf, {
        onByte: (byte) => { host.onByte(byte); last = board.nanos; },
        onEvent: (name, number, value, nanos) => {
            if (name === 'driver')
                [level, turns] = [value, turns + value], off = value ? off : nanos;
        },
    });
    board.run(20 * MS);
    host.attach(board);
    check(level === 0, 'the driver is on at rest');
    for (const message of ['\x01', '\x040', '\x050']) {
        host.ask(message);
        board.run(MS);
        check(level === 0, 'the driver stays on');
        check(off - last < 250e3, `the driver stays on for ${(off - last) / 1000} us after the stop bit`);
    }
    check(turns === 3, `the driver is switched on ${turns} times for 3 answers`);
}

// A request longer than all queues on the way, and its answer.
function longRequest(elf) {
    const host = start(elf), text = 'F16000000 V16000 A60000 '.repeat(40).trim();
    host.set('\\ O01');
    host.set(text);
    check(host.ask('\x054').includes(text), 'another program came back');
    check(host.board.uart.lost === 0, 'bytes were lost');
}

// The manual's examples: every pulse, direction and output at its tick. A scenario's inputs and programs come 3 s apart.
function manual(elf, replay, ...scenarios) {
    const all = {};
    let steps = 0;
    for (const path of scenarios) {
        const recording = new Recording(), host = start(elf, recording.options), { board } = host;
        recording.attach(board);
        const text = readFileSync(path, 'utf8'), mask = (di) => [...di.matchAll(/"(\d+)": 1/g)].reduce((sum, [, n]) => sum | 1 << n - 1, 0);
        for (const [, di, one, many] of text.matchAll(/^(?: {2}- )?di: \{(.*)\}$|^ {2}- set: '(.*)'$|^ {2}- set: \|\n((?: {6}.*\n)+)/gm)) {
            if (di !== undefined)
                board.setInputs(mask(di));
            else
                host.set((one ?? many).trim().replace(/\n */g, '\n'), 1);
            board.run(2 * SECOND);
        }
        board.run(2 * SECOND);
        const found = recording.compare(replay);
        steps += found.steps;
        for (const [name, [from, to]] of Object.entries(found.offsets)) {
            const range = all[name] ??= [from, to];
            all[name] = [Math.min(range[0], from), Math.max(range[1], to)];
        }
        check(board.pio.flat().every((machine) => machine.dries === 0), `${path}: a state machine ran dry`);
    }
    check(steps > 50000, `only ${steps} pulses`);
    for (const [name, [from, to]] of Object.entries(all)) {
        console.log(`${name}: ${from} to ${to} ns from its tick`);
        check(from > -500 && to < 500 && to - from < 100, `${name}: ${from} to ${to} ns from its tick`);
    }
    console.log(`${steps} pulses`);
}

// Four motors at 16 000 steps/s: pulses 62 or 63 us apart, all the time, while the host asks; and what it costs.
function load(elf, seconds) {
    const host = new Host(), last = [], between = new Map();
    let pulses = 0, counting = false;
    const board = new Board(elf, {
        onByte: host.onByte,
        onEvent: (name, motor, value, nanos) => {
            if (name !== 'step')
                return;
            if (counting) {
                pulses++;
                between.set(nanos - last[motor], (between.get(nanos - last[motor]) ?? 0) + 1);
            }
            last[motor] = nanos;
        },
    });
    board.run(20 * MS);
    host.attach(board).set('\\ S2000 V16000 A60000 F16000000 R');
    board.run(SECOND);
    counting = true;
    const idle = board.waiting, began = board.nanos, [calls, cycles] = [board.interrupts, board.inInterrupts];
    for (let second = 0; second < seconds; second++) {
        host.ask('\x040');
        board.run(SECOND - (board.nanos - began) % SECOND);
    }
    const free = (board.waiting - idle) / (board.nanos - began);
    check(Math.abs(pulses - 64000 * seconds) < 64, `${pulses} pulses in ${seconds} s`);
    check([...between.keys()].every((nanos) => nanos === 62000 || nanos === 63000), `pulses are ${[...between.keys()]} ns apart`);
    check(board.pio.flat().every((machine) => machine.dries === 0), 'a state machine ran dry');
    console.log(`pulses ${pulses}\nfree_cpu_per_mille ${Math.floor(free * 1000)}\nworst_interrupt_cycles ${board.worst}`);
    console.log(`mean_interrupt_cycles ${Math.round((board.inInterrupts - cycles) / (board.interrupts - calls))}`);
    console.log(`cycles_per_pulse ${Math.round((1 - free) * 125e6 / 64000)}`);
}

// Cycles of the processor for a pulse, in the main loop and in interrupts: at full speed and on a ramp; the longest interrupt.
function figures(elf) {
    let pulses = 0, worst = 0;
    const count = (name, program, from, length) => {
        const host = start(elf, { onEvent: (what) => { pulses += what === 'step'; } }), { board } = host;
        host.set(program);
        board.run(from);
        const idle = board.waiting, before = board.inInterrupts;
        pulses = 0;
        board.run(length);
        const all = (length - board.waiting + idle) / 8 / pulses, interrupts = (board.inInterrupts - before) / pulses;
        worst = Math.max(worst, board.worst);
        console.log(`${name}_main_loop ${Math.round(all - interrupts)}\n${name}_interrupts ${Math.round(interrupts)}`);
        return host;
    };
    const host = count('level', '\\ S2000 V16000 A60000 F16000000 R', 500 * MS, 500 * MS);
    for (const message of ['\x040', '\x051', '\x071', '\x061', '\x01']) { // interrupts that also send answers take longer
        host.ask(message);
        host.board.run(100 * MS);
    }
    worst = host.board.worst;
    count('ramp', '\\ S100 V16000 A20000 F16000000 R', 20 * MS, 700 * MS);
    console.log(`worst_interrupt ${worst}`);
}

// How late the latest pulse is with the processor at a lower clock: four motors at full speed begin together; a request of 1024 bytes comes; three begin compounds of ten segments while one runs.
function late(elf, megahertz) {
    const host = new Host(), board = new Board(elf, { onByte: host.onByte, megahertz: Number(megahertz) });
    const full = '\\ S2000 V16000 A60000 F16000000 R', found = [];
    const after = (milliseconds) => {
        board.run(milliseconds * MS);
        found.push(board.latest);
        board.chip.writeUint32(elf.ends.get('board_pulses') - 4, 0);
    };
    board.run(100 * MS);
    host.attach(board).set(full);
    after(500);
    host.ask(`\x020${'F16000000 V16000 A60000 '.repeat(43).slice(0, 1010).replace(/\S*$/, '')}`);
    after(50);
    host.set('\\ S137');
    host.set(full, 4);
    board.run(300 * MS);
    const speeds = [9973, 15013, 501, 7013, 16000, 99, 12007, 1999, 15991, 777];
    for (const motor of [1, 2, 3])
        host.set(`${speeds.map((speed, i) => `F${1000 + i} V${speed} A${1000 + 997 * i} Y`).join(' ')} R`, motor);
    after(300);
    console.log(`late ${found.join(' ')}`);
}

// Store Flash, and power off in the middle of it, at every operation of the flash: the old program or the new one.
function store(elf) {
    const host = start(elf), { board } = host, old = 'C100 F120 R', fresh = 'C100 F77 R B7 R';
    const stored = () => host.ask('\x054');
    host.set(`\\ ${old}`, 4);
    check(host.ask('\x034').charCodeAt(2) === 0, 'the program is not stored');
    board.power();
    board.run(SECOND);
    check(host.position(4) === 120, `after a reset motor 4 is at ${host.position(4)}, not at 120`);
    const before = board.flash.slice();
    let cuts = 0;
    for (const seen = new Set(); ; cuts++) {
        check(cuts < 60, 'storing never ends');
        board.flash.set(before);
        board.power();
        board.run(SECOND);
        host.set(`\\ ${fresh}`, 4);
        board.cutPowerAfter = cuts;
        let cut = false;
        try {
            host.ask('\x034');
        } catch (error) {
            if (!(error instanceof PowerCut))
                throw error;
            cut = true;
        }
        delete board.cutPowerAfter;
        board.power();
        board.run(20 * MS);
        const program = stored();
        check(program.includes(old) !== program.includes(fresh), `power cut ${cuts}: the program is ${JSON.stringify(program)}`);
        seen.add(program.includes(old) ? 'old' : 'new');
        if (!cut) {
            check(program.includes(fresh) && seen.has('old'), 'the new program is not stored');
            break;
        }
    }
    console.log(`power cut at ${cuts} operations`);
}

const tasks = { answers, driver, longRequest, manual, load, figures, late, store };
const [task, firmware, ...rest] = process.argv.slice(2);
try {
    tasks[task](readElf(firmware), ...rest);
} catch (error) {
    console.error(`drive.mjs: ${task}: ${process.env.STACK ? error.stack : error.message}`);
    process.exit(1);
}
