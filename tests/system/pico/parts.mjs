// SPDX-License-Identifier: MIT
// parts.mjs: parts of the board for rp2040js, with their times: the UART with its queues, the PIO's state machines at their own
// clocks, and the two 74HC595. (rp2040js 1.4.1 sends a byte in no time, and runs the PIO beside its clock.)

const CYCLE = 8; // ns, of 125 MHz

// A PL011. sent(byte) is called when the stop bit of a byte has left. receive(byte): one has come in whole.
export class Uart {
    constructor(clock, sent) {
        Object.assign(this, { clock, sent, toSend: [], came: [], shifting: null, lost: 0, ibrd: 0, fbrd: 0, line: 0, control: 0 });
        this.alarm = clock.createAlarm(() => this.shifted());
    }

    get byteNanos() {
        return 10 * 16 * (this.ibrd + this.fbrd / 64) * CYCLE;
    }

    shifted() {
        const byte = this.shifting;
        this.shifting = null;
        this.shift();
        this.sent(byte);
    }

    shift() {
        if (this.shifting === null && this.toSend.length > 0) {
            this.shifting = this.toSend.shift();
            this.alarm.schedule(this.byteNanos);
        }
    }

    receive(byte) {
        if (this.came.length < 32)
            this.came.push(byte);
        else
            this.lost++;
    }

    readUint32(offset) {
        switch (offset) {
        case 0x00:
            if (this.came.length === 0)
                throw new Error('the firmware reads the UART, but nothing has come');
            return this.came.shift();
        case 0x18:
            return (this.shifting !== null ? 8 : 0) | (this.came.length === 0 ? 16 : 0) | (this.toSend.length >= 32 ? 32 : 0) |
                (this.came.length >= 32 ? 64 : 0) | (this.toSend.length === 0 ? 128 : 0);
        default:
            throw new Error(`the firmware reads the UART's register ${offset.toString(16)}`);
        }
    }

    writeUint32(offset, value) {
        switch (offset) {
        case 0x00:
            if (this.toSend.length >= 32)
                throw new Error('the firmware writes to the UART, but its queue is full');
            if ((this.control & 0x101) !== 0x101)
                throw new Error('the firmware writes to the UART, but it is not on');
            this.toSend.push(value & 0xff);
            return this.shift();
        case 0x24: return void (this.ibrd = value);
        case 0x28: return void (this.fbrd = value);
        case 0x2c: return void (this.line = value);
        case 0x30: return void (this.control = value);
        default:
            throw new Error(`the firmware writes to the UART's register ${offset.toString(16)}`);
        }
    }

    writeUint32Atomic(offset, value, kind) {
        if (kind !== 0)
            throw new Error('the firmware sets bits of the UART');
        this.writeUint32(offset, value);
    }
}

// Run the state machines of a PIO block at the times of the clock: each instruction when it is due, delays included.
export function keepTime(pio, clock, Fifo) {
    const times = pio.machines.map((machine) => ({ machine, started: 0, next: 0, dry: false, dries: 0 }));
    const period = (machine) => (machine.clockDivInt + machine.clockDivFrac / 256) * CYCLE;
    pio.run = () => {};
    for (const time of times) {
        const { machine } = time;
        machine.clkDivRestart = () => {}; // it starts with the machine, below
        const step = () => {
            const length = period(machine), code = pio.instructions[machine.pc];
            if (!machine.enabled)
                return;
            if (code >>> 5 === 2 && (code & 31) === machine.pc) { // jmp x-- to itself
                time.next += (machine.x + 1) * length;
                machine.x = 0xffffffff;
                machine.nextPC();
            } else {
                const before = machine.cycles;
                machine.step();
                if (machine.waiting) {
                    time.dry = true; // a word wakes it
                    time.dries++;
                    return;
                }
                time.next += (machine.cycles - before) * length;
                pio.checkChangedPins();
            }
            time.alarm.schedule(time.next - clock.nanos);
        };
        time.alarm = clock.createAlarm(step);
    }
    const write = pio.writeUint32.bind(pio);
    pio.writeUint32 = (offset, value) => {
        if (offset >= 0x10 && offset <= 0x1c && times[(offset - 0x10) / 4].machine.txFIFO.full)
            throw new Error('the firmware writes to the PIO, but its queue is full');
        write(offset, value);
        for (const time of times) {
            const { machine } = time;
            const length = period(machine);
            if (machine.shiftCtrl & 1 << 30 && machine.txFIFO.size === 4)
                machine.txFIFO = new Fifo(8);
            if (offset === 0 && machine.enabled && value & 1 << 4 + machine.index) {
                time.started = time.next = clock.nanos;
                time.alarm.schedule(0);
            } else if (time.dry && !machine.waiting) {
                time.dry = false;
                time.next = time.started + (Math.ceil((clock.nanos - time.started) / length) + 1) * length;
                time.alarm.schedule(time.next - clock.nanos);
            }
        }
        pio.checkChangedPins();
    };
    return times; // dries: how often it had no word
}

// 74HC595s in a chain: latched(bits) is called at a rising edge of the latch; bit 0 is QA of the first.
export class ShiftRegister {
    constructor(latched) {
        Object.assign(this, { latched, data: 0, bits: 0 });
    }

    clock(level) {
        if (level)
            this.bits = (this.bits << 1 | this.data) & 0xffff;
    }

    latch(level) {
        if (level)
            this.latched(this.bits);
    }
}
