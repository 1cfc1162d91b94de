// SPDX-License-Identifier: MIT
// recording.mjs: what the pins of a Board did, compared with what the core asks for when it is called as the firmware called it.
import { spawnSync } from 'node:child_process';

const WATCH = ['rkm04_init', 'rkm04_advance', 'rkm04_receive', 'rkm04_set_inputs', 'rkm04_send'];

export class Recording {
    constructor() {
        this.calls = [];
        this.powers = [{ events: new Map() }]; // events of each time that it was on: `name number` -> [[nanos, value], ...]
        this.options = { watch: WATCH, onEvent: (...event) => this.event(...event), onCall: (name, chip) => this.call(name, chip) };
    }

    attach(board) {
        return Object.assign(this, { board });
    }

    // Power off and on.
    power() {
        this.finish();
        this.powers.push({ events: new Map() });
        this.board.power();
    }

    event(name, number, value, nanos) {
        const { events } = this.powers.at(-1), key = `${name} ${number}`;
        if (!events.has(key))
            events.set(key, []);
        events.get(key).push([nanos, value]);
    }

    call(name, chip) {
        const [, r1, r2, r3] = chip.core.registers;
        switch (name) {
        case 'rkm04_init': return void this.calls.push(`i ${chip.readUint8(r1)}`);
        case 'rkm04_advance': return void this.calls.push(`a ${r2 + r3 * 2 ** 32}`);
        case 'rkm04_set_inputs': return void this.calls.push(`d ${r1}`);
        case 'rkm04_send': return void this.calls.push(`s ${r2}`);
        case 'rkm04_receive':
            if (r2 > 0)
                this.calls.push(`r ${Array.from({ length: r2 }, (_, i) => chip.readUint8(r1 + i).toString(16).padStart(2, '0')).join('')}`);
        }
    }

    finish() {
        Object.assign(this.powers.at(-1), { began: this.board.word('began') * 1000, end: this.board.nanos });
    }

    // Returns { steps, others, offsets: smallest and largest distance in ns of an event from its tick, per kind }; an error if
    // an event is missing or one too many.
    compare(program) {
        this.finish();
        const done = spawnSync(program, { input: `${this.calls.join('\n')}\n`, maxBuffer: 2 ** 30, encoding: 'latin1' });
        if (done.status !== 0)
            throw new Error(`${program}: ${done.error ?? done.stderr}`);
        const found = { steps: 0, others: 0, offsets: {} };
        done.stdout.split('i\n').slice(1).forEach((text, power) => this.comparePower(text, this.powers[power], found));
        return found;
    }

    comparePower(text, { events, began, end }, found) {
        const wanted = new Map();
        for (const line of text.split('\n').filter((line) => line)) {
            const [name, number, tick, value] = line.split(' '), key = `${name} ${number}`;
            if (!wanted.has(key))
                wanted.set(key, []);
            wanted.get(key).push([Number(tick), Number(value)]);
        }
        for (const key of new Set([...wanted.keys(), ...events.keys()])) {
            const name = key.split(' ')[0];
            if (!['step', 'direction', 'outputs'].includes(name))
                continue;
            const list = (wanted.get(key) ?? []).sort((a, b) => a[0] - b[0]);
            const changes = name === 'step' ? list : list.filter(([tick, value], i) =>
                list[i + 1]?.[0] !== tick && value !== (list.slice(0, i).findLast(([before]) => before !== tick)?.[1] ?? 0));
            const due = changes.filter(([tick]) => began + tick * 1000 < end - 1e6);
            const seen = (events.get(key) ?? []).slice(0, due.length);
            const extra = (events.get(key) ?? []).filter(([nanos]) => nanos < end - 1e6).length;
            if (seen.length < due.length || extra > due.length)
                throw new Error(`${key}: expected ${due.length} events, got ${extra}`);
            due.forEach(([tick, value], i) => {
                const [nanos, level] = seen[i], distance = nanos - began - tick * 1000;
                if (level !== value)
                    throw new Error(`${key} at tick ${tick}: expected ${value}, got ${level}`);
                const range = found.offsets[name] ??= [distance, distance];
                found.offsets[name] = [Math.min(range[0], distance), Math.max(range[1], distance)];
            });
            found[name === 'step' ? 'steps' : 'others'] += due.length;
        }
    }
}
