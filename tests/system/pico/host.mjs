// SPDX-License-Identifier: MIT
// host.mjs: a host on the bus of a Board, in its time: requests in HDLC framing and their answers.
function fcs16(bytes) {
    let fcs = 0xffff;
    for (const byte of bytes) {
        fcs ^= byte;
        for (let i = 0; i < 8; i++)
            fcs = fcs & 1 ? fcs >> 1 ^ 0x8408 : fcs >> 1;
    }
    return fcs ^ 0xffff;
}

export function frame(node, text) {
    const body = [node, 0, ...Buffer.from(text, 'latin1')], fcs = fcs16(body);
    const escaped = [...body, fcs & 0xff, fcs >> 8].flatMap((byte) => byte === 0x7d || byte === 0x7e ? [0x7d, byte ^ 0x20] : [byte]);
    return [0x7e, ...escaped, 0x7e];
}

// The message in an answer, without its framing.
function unframe(bytes) {
    const body = [];
    for (let i = 1; i < bytes.length - 1; i++)
        body.push(bytes[i] === 0x7d ? bytes[++i] ^ 0x20 : bytes[i]);
    const fcs = fcs16(body.slice(0, -2));
    if (bytes[0] !== 0x7e || body.at(-2) !== (fcs & 0xff) || body.at(-1) !== fcs >> 8)
        throw new Error(`no proper frame: ${Buffer.from(bytes).toString('hex')}`);
    return Buffer.from(body.slice(2, -2)).toString('latin1');
}

export class Host {
    // Takes what the board sends: to be made before the board, which is handed to `attach`.
    constructor() {
        this.heard = [];
        this.onByte = (byte) => this.heard.push(byte);
    }

    attach(board, node = 1) {
        return Object.assign(this, { board, node });
    }

    // The answer to a message; an error if none comes within a second of the bus's time after the request.
    ask(message) {
        const bytes = frame(this.node, message);
        this.heard.length = 0;
        this.board.send(bytes);
        let left = 1000 + bytes.length;
        while (!(this.heard.length > 1 && this.heard.at(-1) === 0x7e) && left-- > 0)
            this.board.run(1e6);
        if (left < 0)
            throw new Error(`no answer to ${JSON.stringify(message)}`);
        return unframe(this.heard);
    }

    // Set Command; an error if it is refused.
    set(text, motor = 0) {
        const answer = this.ask(`\x02${motor}${text}`);
        if (answer.charCodeAt(2) !== 0)
            throw new Error(`${text}: answered ${Buffer.from(answer, 'latin1').toString('hex')}`);
    }

    position(motor) {
        return Number(this.ask(`\x04${motor}`).slice(3));
    }
}
