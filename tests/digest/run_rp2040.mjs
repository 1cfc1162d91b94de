// SPDX-License-Identifier: MIT
// run_rp2040.mjs: run the digest, built for the RP2040, in rp2040js: node run_rp2040.mjs ELF. What it says by semihosting goes to
// standard output.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const { RP2040 } = createRequire(import.meta.url)('rp2040js'); // by NODE_PATH
const file = readFileSync(process.argv[2]), view = new DataView(file.buffer, file.byteOffset, file.length);
const chip = new RP2040(), { core } = chip;

for (let i = 0, at = view.getUint32(28, true); i < view.getUint16(44, true); i++, at += 32) {
    const [kind, offset, , address, length] = [0, 4, 8, 12, 16].map((field) => view.getUint32(at + field, true));
    if (kind === 1 && length > 0)
        chip.flash.set(file.subarray(offset, offset + length), address - 0x10000000);
}

let status = -1;
chip.onBreak = () => {
    const [operation, argument] = core.registers;
    if (operation === 4) {
        let text = '';
        for (let at = argument, byte; (byte = chip.readUint8(at)) !== 0; at++)
            text += String.fromCharCode(byte);
        process.stdout.write(text);
    } else {
        status = argument === 0x20026 ? 0 : 1;
    }
};
core.VTOR = 0x10000000;
core.reset();
while (status < 0)
    core.executeInstruction();
process.exitCode = status;
