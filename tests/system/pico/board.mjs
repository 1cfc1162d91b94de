// SPDX-License-Identifier: MIT
// board.mjs: a Pico in rp2040js with a firmware in its flash, what is wired to it, and a record of what it does.
//
// The ROM of the chip is not part of rp2040js: what the firmware uses of it is here (RP2040 datasheet 2.8): start of the second
// stage, after a look at its CRC, and the functions for the flash, which take as long as those of a real chip do.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

import { Uart, ShiftRegister, keepTime } from './parts.mjs';

const require = createRequire(import.meta.url); // finds modules by NODE_PATH
const { RP2040, FIFO } = require('rp2040js');

export const BYTE_NANOS = 10e9 / 19200;
const PIN = { driver: 2, data: 3, clock: 4, latch: 5, step: 6, inputs: 14, switches: [22, 26, 27, 28] };
const FLASH = 0x10000000, STAGE2 = 0x20041f00, BLOCKS = 0x1f0000;
const ERASE_NANOS = 45e6, PROGRAM_NANOS = 0.7e6; // typical for the W25Q16JV

function crc32(bytes) {
    let crc = 0xffffffff;
    for (const byte of bytes) {
        crc ^= byte << 24;
        for (let i = 0; i < 8; i++)
            crc = crc << 1 ^ (crc & 0x80000000 ? 0x04c11db7 : 0);
    }
    return crc >>> 0;
}

// An ELF file: { image: what goes into flash from its begin on, symbols: name -> address, ends: name -> address behind it }.
export function readElf(path) {
    const file = readFileSync(path), view = new DataView(file.buffer, file.byteOffset, file.length);
    const image = new Uint8Array(BLOCKS).fill(0xff), symbols = new Map(), ends = new Map();
    for (let i = 0, at = view.getUint32(28, true); i < view.getUint16(44, true); i++, at += 32) {
        const [kind, offset, , address, length] = [0, 4, 8, 12, 16].map((field) => view.getUint32(at + field, true));
        if (kind === 1 && length > 0)
            image.set(file.subarray(offset, offset + length), address - FLASH);
    }
    const sections = view.getUint32(32, true), word = (at) => view.getUint32(at, true);
    for (let i = 0; i < view.getUint16(48, true); i++) {
        const section = sections + 40 * i;
        if (word(section + 4) !== 2)
            continue;
        const names = word(sections + 40 * word(section + 24) + 16);
        for (let at = word(section + 16); at < word(section + 16) + word(section + 20); at += 16) {
            const begin = names + word(at), name = file.toString('latin1', begin, file.indexOf(0, begin));
            symbols.set(name, word(at + 4));
            ends.set(name, word(at + 4) + word(at + 8));
        }
    }
    return { image, symbols, ends };
}

export class Board {
    // options: onByte(byte) what leaves on the bus while the driver is on; onEvent(name, number, value, nanos): step 1-4,
    // direction 1-4, outputs, leds, driver; onCall(name, chip): a call of a function of `watch`; node: 1-16; megahertz: of the
    // processor alone, 125 if not given; PIO, timer and UART stay as they are.
    constructor(elf, options = {}) {
        Object.assign(this, { elf, options, flash: null, inputs: 0, past: 0 });
        this.power();
    }

    // Off and on again; the flash stays.
    power() {
        const chip = this.chip = new RP2040();
        const complain = (name, text) => { throw new Error(`${name}: ${text}`); };
        chip.logger = { debug() {}, info() {}, warn: complain, error: complain };
        this.flash ??= (() => {
            const flash = new Uint8Array(16 << 20).fill(0xff);
            flash.set(this.elf.image);
            return flash;
        })();
        this.past += this.nanos ?? 0;
        Object.assign(this, { interrupt: 0, interrupts: 0, inInterrupts: 0, worst: 0 }); // cycles; entry and exit are none here
        Object.assign(this, { driving: false, waiting: 0, busyUntil: 0, commands: false, outputs: 0, leds: 0, queue: [] });
        chip.flash.set(this.flash);
        this.flash = chip.flash;
        this.addParts();
        this.addRom();
        this.watchCalls();
        this.setInputs(this.inputs);
        const node = (this.options.node ?? 1) - 1;
        PIN.switches.forEach((pin, bit) => chip.gpio[pin].setInputValue(!(node >> bit & 1)));
        this.startStage2();
    }

    addParts() {
        const { chip } = this, { clock } = chip, event = (...what) => this.options.onEvent?.(...what, clock.nanos);
        const uart = this.uart = new Uart(clock, (byte) => {
            if (!this.driving)
                throw new Error('a byte left while the RS485 driver was off');
            this.options.onByte?.(byte);
        });
        chip.peripherals[0x40034] = uart;
        const ssi = {}; // its registers keep what is written
        chip.peripherals[0x18000] = { readUint32: (at) => ssi[at] ?? 0, writeUint32Atomic: (at, value) => void (ssi[at] = value) };
        this.pio = chip.pio.map((pio) => keepTime(pio, clock, FIFO));
        chip.peripherals[0x40058].onWatchdogTrigger = () => { throw new Error('the firmware resets the board'); };
        const chain = new ShiftRegister((bits) => {
            if ((bits & 0xff) !== this.outputs)
                event('outputs', 0, this.outputs = bits & 0xff);
            if (bits >> 8 !== this.leds)
                event('leds', 0, this.leds = bits >> 8);
        });
        const listen = (pin, heard) => {
            let last = 0;
            chip.gpio[pin].addListener((state) => {
                const level = state === 1 ? 1 : 0; // or it is no output yet
                if (level !== last)
                    heard(last = level);
            });
        };
        listen(PIN.data, (level) => { chain.data = level; });
        listen(PIN.clock, (level) => chain.clock(level));
        listen(PIN.latch, (level) => chain.latch(level));
        listen(PIN.driver, (level) => { this.driving = level === 1; event('driver', 0, level); });
        for (let motor = 1; motor <= 4; motor++) {
            let rose = 0;
            listen(PIN.step + 2 * motor - 2, (level) => {
                if (level)
                    event('step', motor, 1), rose = clock.nanos;
                else if (rose > 0 && clock.nanos - rose !== 10000)
                    throw new Error(`a pulse of motor ${motor} took ${clock.nanos - rose} ns`);
            });
            listen(PIN.step + 2 * motor - 1, (level) => event('direction', motor, level));
        }
        this.lineAlarm = clock.createAlarm(() => {
            uart.receive(this.queue.shift());
            if (this.queue.length > 0)
                this.lineAlarm.schedule(BYTE_NANOS);
        });
    }

    // The ROM's functions: a breakpoint that does the work, and a loop around it for as long as it takes.
    addRom() {
        const { chip } = this, rom = new Uint16Array(chip.bootrom.buffer);
        const functions = {};
        rom[0x14 / 2] = 0x100;
        rom[0x18 / 2] = 0x201;
        rom.set([0xbe00, 0x4770], 0x200 / 2); // bkpt 0; bx lr
        ['IF', 'EX', 'RE', 'RP', 'FC', 'CX'].forEach((name, i) => {
            functions[name] = 0x301 + 16 * i;
            rom.set([0xbe01 + i, 0x2800, 0xd001, 0xbf30, 0xe7fa, 0x4770], (0x300 + 16 * i) / 2);
        }); // L: bkpt n; cmp r0, #0; beq M; wfi; b L; M: bx lr
        const work = {
            IF: () => 0,
            EX: () => { this.setCommands(true); return 0; },
            RE: (offset, length) => this.change(offset, length, ERASE_NANOS * length / 4096, (at) => { this.flash[at] = 0xff; }),
            RP: (offset, from, length) => this.change(offset, length, PROGRAM_NANOS * length / 256,
                (at, i) => { this.flash[at] &= chip.readUint8(from + i); }),
            FC: () => 0,
            CX: () => { this.setCommands(false); return 0; },
        };
        chip.onBreak = (number) => {
            const { registers } = chip.core, [r0, r1, r2] = registers;
            if (number === 0) {
                registers[0] = functions[String.fromCharCode(r1 & 0xff, r1 >> 8)] ?? 0;
                return;
            }
            const name = Object.keys(functions)[number - 1];
            if (this.busyUntil > 0) {
                registers[0] = chip.clock.nanos < this.busyUntil ? 1 : 0;
                if (registers[0] === 0)
                    this.busyUntil = 0;
            } else {
                registers[0] = work[name](r0, r1, r2);
            }
        };
    }

    setCommands(on) {
        this.commands = on;
        const { chip } = this;
        for (const name of ['readUint32', 'readUint16', 'readUint8']) {
            delete chip[name];
            const read = chip[name];
            if (on)
                chip[name] = (address) => {
                    if (address >>> 24 >= 0x10 && address >>> 24 <= 0x13)
                        throw new Error(`the flash is read at ${address.toString(16)} while it takes commands`);
                    return read.call(chip, address);
                };
            else if (name !== 'readUint32') // rp2040js has the mirror past the cache for words alone
                chip[name] = (address) => read.call(chip, address >>> 24 === 0x13 ? address - 0x3000000 : address);
        }
    }

    change(offset, length, nanos, apply) {
        if (!this.commands || offset < BLOCKS || offset + length > BLOCKS + 0x10000)
            throw new Error(`the flash is changed at ${offset.toString(16)}, ${length} bytes`);
        if (this.cutPowerAfter !== undefined && this.cutPowerAfter-- === 0) { // in the middle of it
            for (let i = 0; i < length / 2; i++)
                apply(offset + i, i);
            throw new PowerCut();
        }
        for (let i = 0; i < length; i++)
            apply(offset + i, i);
        this.busyUntil = this.chip.clock.nanos + nanos;
        return 1;
    }

    watchCalls() {
        const { core } = this.chip, { onCall, watch = [] } = this.options;
        if (!onCall)
            return;
        const names = new Map(watch.map((name) => [this.elf.symbols.get(name) & ~1, name]));
        core.blTaken = () => {
            const name = names.get(core.PC);
            if (name)
                onCall(name, this.chip);
        };
    }

    // As the ROM does after a reset.
    startStage2() {
        const { chip } = this, { core } = chip, stage2 = chip.flash.subarray(0, 256);
        const crc = new DataView(stage2.buffer).getUint32(252, true);
        if (crc32(stage2.subarray(0, 252)) !== crc)
            throw new Error('the CRC of the second stage is wrong: the ROM would not start it');
        for (let i = 0; i < 256; i++)
            chip.writeUint8(STAGE2 + i, stage2[i]);
        this.setCommands(false);
        core.SP = 0x20041f00;
        core.LR = 0;
        core.PC = STAGE2;
    }

    get nanos() {
        return this.chip?.clock.nanos;
    }

    // A word of the firmware's memory, by the symbol.
    word(name) {
        return this.chip.readUint32(this.elf.symbols.get(name));
    }

    // By how many microseconds the latest pulse was late: the last member of board_pulses.
    get latest() {
        return this.chip.readUint32(this.elf.ends.get('board_pulses') - 4);
    }

    // Bytes on the bus, one after the other.
    send(bytes) {
        if (this.queue.length === 0 && bytes.length > 0)
            this.lineAlarm.schedule(BYTE_NANOS);
        this.queue.push(...bytes);
    }

    setInputs(mask) {
        this.inputs = mask;
        for (let i = 0; i < 8; i++)
            this.chip.gpio[PIN.inputs + i].setInputValue(!(mask >> i & 1)); // current pulls the pin low
    }

    // Let so much time pass.
    run(nanos) {
        const { chip } = this, { core, clock } = chip, end = clock.nanos + nanos, cycle = 1000 / (this.options.megahertz ?? 125);
        while (clock.nanos < end) {
            if (core.waiting && core.pendingInterrupts & core.enabledInterrupts) {
                core.waiting = false; // it came before WFI, with interrupts off: rp2040js would sleep through it
                core.interruptsUpdated = true;
            } else if (core.waiting) {
                const pass = Math.min(clock.nextAlarm ? clock.nextAlarm.nanos - clock.nanos : Infinity, end - clock.nanos);
                clock.tick(pass);
                this.waiting += pass;
            } else {
                const cycles = core.executeInstruction();
                clock.tick(cycles * cycle);
                if (core.IPSR !== 0) {
                    this.interrupt += cycles;
                } else if (this.interrupt > 0) {
                    this.interrupts++;
                    this.inInterrupts += this.interrupt;
                    this.worst = Math.max(this.worst, this.interrupt);
                    this.interrupt = 0;
                }
            }
        }
    }
}

export class PowerCut extends Error {}
