# SPDX-License-Identifier: MIT
"""case.py: the cases of the conformance kit, as data in *.json, and how each of their steps is done and judged.

A file is a list of cases:

    {"name": "a sentence", "clauses": ["P1", "M5.3.2"], "needs": ["inputs"], "moves": [1], "steps": [...]}

`clauses` are those of docs/SPEC.md; M is a section of the manual. `moves` names the motors that turn. `needs`: `inputs`
(a person sets them), `outputs` (a person reads them), `time` (things happen at ticks of our choice), `flash` (stored
programs are lost), `power` (off and on again). A step is an object; which one it is stands in its first member:

    set TEXT       Set Command to `motor` (1); answered by `flag` (0) and `ch` (none); `times`: the text so often in one message
    run TEXT       the same, and time is counted from here
    accepts LIST   [text, canonical text]: both texts are taken, behind a `[`, and Get Command gives the canonical one
    refuses LIST   [text, flag, character]
    ask HEX        a message as bytes; its `answer` in hexadecimal, null: silence; `node`: to another node than the unit's
    frame HEX      bytes on the line, only with the framing named `framing`; `answer`, null: silence, empty: whatever
    position M     Get Position: `is`
    positions      Get Position of all: a list of four
    program M      Get Command: `is`, then `then` so many `times`, then `end`
    table M        Get Tabul Run: `is`, a text or the parts of one
    progress M     Get Pozic Run: `is` [steps (null: any), index]
    at T           wait until T µs after the start
    wait T         T µs pass
    idle M         wait until motor M has nothing to do; `at`: when that is, in µs; or `within` µs (5 s)
    input {N: L}   inputs are set
    store M        Store Flash, answered by err 0
    power          off and on again
    outputs MASK   DO 01 in bit 0; with `at`: they became so then, `nth` (1) time, exactly
    motion N       the Nth motion of motor M (1) since the start: `begins`, `ends`, each within `near` (0) µs
    moving M       motor M is on its way (position changes)

`about` N: a number may be N off for each 0.1 s by which we may see things late; nothing where time is ours to stop. `outputs` and
`motion` are looked at where there is a control socket; elsewhere they count as finer expectations that were not looked at.
"""
import json
import os
import re
import time

NEEDS = {"inputs", "outputs", "time", "flash", "power"}
MOTION = re.compile(r"(?<!\d)H|[RG)(]")  # the H of I01H2 is none
MESSAGE_MAX = 1024
REAL_SHARE = 0.002  # by how much the unit's clock or ours may be wrong


class Broken(Exception):
    """A case file says something that has no meaning."""


class Mismatch(Exception):
    def __init__(self, what, expected, observed):
        super().__init__(f"{what}: expected {expected}, observed {observed}")
        self.what, self.expected, self.observed = what, expected, observed


def text_bytes(text):
    return text.encode("latin-1")


def shown(data):
    """Bytes for people: as they are and, if they are text, as text."""
    if data is None:
        return "silence"
    if len(data) > 160:
        return f"{len(data)} bytes, {shown(data[:60])} ..."
    text = data.decode("latin-1")
    return f'{data.hex(" ")} "{"".join(c if " " <= c <= "~" else "." for c in text)}"'


class Case:
    def __init__(self, data, source):
        self.name, self.clauses, self.steps = data["name"], data["clauses"], data["steps"]
        self.needs, self.moves = set(data.get("needs", [])), data.get("moves", [])
        self.us = max((step[key] for step in self.steps for key in ("at", "wait") if isinstance(step.get(key), int)), default=0)
        where = f"{source}: {self.name}"
        if self.needs - NEEDS:
            raise Broken(f"{where}: needs {self.needs - NEEDS}: expected some of {', '.join(sorted(NEEDS))}")
        for step in self.steps:
            verb = next(iter(step))
            if not hasattr(Run, "do_" + verb):
                raise Broken(f"{where}: there is no step `{verb}'")
            text = step.get("set", step.get("run", ""))
            if MOTION.search(text) and not self.moves:
                raise Broken(f"{where}: `{text}' moves a motor, but `moves' is empty")
            if len(text * step.get("times", 1)) + 2 > MESSAGE_MAX:
                raise Broken(f"{where}: a message of more than {MESSAGE_MAX} bytes, which a small port does not take")
            for verb_of, need in (("input", "inputs"), ("store", "flash"), ("power", "power")):
                if verb == verb_of and need not in self.needs:
                    raise Broken(f"{where}: `{verb}' without `{need}' in `needs'")

    def chosen_by(self, only):
        """Is it one of a clause (P1, M9 with all its sections, P with all its numbers), or of that name?"""
        for clause in self.clauses:
            if clause == only or clause.startswith(only + ".") or only.isalpha() and clause.rstrip("0123456789.") == only:
                return True
        return self.name == only

    def skipped(self, has, options):
        """Why it cannot be run; None: it can."""
        framings = {step["framing"] for step in self.steps if "frame" in step}
        if framings - {options.framing}:
            return "about framing " + ", ".join(framings)
        if framings and options.node != 1:
            return "about node 1"
        missing = sorted(self.needs - has)
        if missing:
            return "needs " + ", ".join(missing)
        if options.no_motion and self.moves:
            return "moves motor " + ", ".join(map(str, self.moves))
        if options.still and (any("C41" in str(step) for step in self.steps) or "power" in self.needs and self.moves):
            return "would end T41"
        if options.still and "outputs" in self.needs:
            return "outputs are held at 0 by T41"
        return None


def load(folder):
    cases = []
    for name in sorted(os.listdir(folder)):
        if name.endswith(".json"):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                try:
                    cases += [Case(data, name) for data in json.load(file)]
                except (json.JSONDecodeError, KeyError) as error:
                    raise Broken(f"{name}: {error}") from None
    return cases


class Run:
    """One case on one unit."""

    def __init__(self, line, target, still):
        self.line, self.target, self.still = line, target, still
        self.unseen = 0  # expectations that need a control socket
        self.mismatches = []

    def case(self, case):
        self.line.transcript.clear()
        self.prepare()
        self.line.transcript.clear()
        for step in case.steps:
            try:
                verb, value = next(iter(step.items()))
                getattr(self, "do_" + verb)(value, step)
            except Mismatch as mismatch:
                self.mismatches.append(mismatch)
                if len(self.mismatches) == 5:
                    break

    def prepare(self):
        """The unit as after power-up, but for its flash: no programs, inputs, DO, VAR, counters 0."""
        self.target.rest()
        try:
            self.set("\\ C100", 0)
            self.set(" ".join(f"C{number:02}" for number in (*range(1, 9), *range(80, 96))) + (" T41" if self.still else " C41"))
            self.target.pass_us(50_000)
            self.set("\\", 0)
        except Mismatch as mismatch:
            raise Mismatch("before the case, " + mismatch.what, mismatch.expected, mismatch.observed) from None

    # Messages

    def ask(self, message, wanted, what):
        """wanted: bytes, or None for silence."""
        try:
            got = self.line.ask(message)
        except ValueError as error:
            raise Mismatch(what, shown(wanted), str(error)) from None
        if got != wanted:
            raise Mismatch(what, shown(wanted), shown(got))

    def get(self, number, motor, what):
        """The answer behind number and motor."""
        message = bytes([number]) + str(motor).encode()
        try:
            got = self.line.ask(message)
        except ValueError as error:
            raise Mismatch(what, "an answer", str(error)) from None
        if got is None or got[:2] != message:
            raise Mismatch(what, f"an answer beginning with {shown(message)}", shown(got))
        return got[2:]

    def set(self, text, motor=1, flag=0, character=""):
        wanted = b"\x02" + str(motor).encode() + bytes([flag]) + (text_bytes(character) or b"\0")
        self.ask(b"\x02" + str(motor).encode() + text_bytes(text), wanted, f"Set Command to motor {motor}, `{text[:60]}'")

    def quiet(self, what):
        """The unit says nothing, and answers the next request."""
        heard = self.line.silent(self.target.silence)
        if heard:
            raise Mismatch(what, "silence", shown(heard))
        self.get_version(f"after {what}, Version")

    def get_version(self, what):
        try:
            got = self.line.ask(b"\x01")
        except ValueError as error:
            raise Mismatch(what, "an answer", str(error)) from None
        if got is None or got[:1] != b"\x01" or len(got) < 2 or got[1] != len(got) - 2:
            raise Mismatch(what, "01, length, text", shown(got))
        return got[2:]

    def number(self, what, wanted, got, about, unit=""):
        slack = round(about * self.target.latency_us() / 100_000)
        if abs(got - wanted) > slack:
            raise Mismatch(what, f"{wanted}{f' ± {slack}' if slack else ''}{unit}", f"{got}{unit}")

    # Steps

    def do_set(self, text, step):
        self.set(text * step.get("times", 1), step.get("motor", 1), step.get("flag", 0), step.get("ch", ""))

    def do_run(self, text, step):
        self.target.start()
        self.set(text, step.get("motor", 1))

    def do_accepts(self, texts, step):
        motor = step.get("motor", 1)
        for text, canonical in texts:
            self.set("\\ [ " + text, motor)
            self.same_text(5, motor, f"Get Command after `[ {text}'", "[" + (" " + canonical if canonical else ""))
        self.set("\\", motor)

    def do_refuses(self, texts, step):
        motor = step.get("motor", 1)
        self.set("\\ [", motor)
        for text, flag, character in texts:
            self.set(text, motor, flag, character)
        self.same_text(5, motor, "Get Command after refused texts", "[")

    def do_ask(self, hexadecimal, step):
        message, answer = bytes.fromhex(hexadecimal), step["answer"]
        what = f"message {shown(message)}"
        if answer is not None:
            self.ask(message, bytes.fromhex(answer), what)
            return
        node = step.get("node", self.line.node)
        if node < 0:  # another one than ours
            node = self.line.node % 16 + 1
        self.line.say(self.line.framing.frame(node, message))
        self.quiet(what + f" to node {node}")

    def do_version(self, text, _step):
        got = self.get_version("Version")
        if text and got != text_bytes(text):
            raise Mismatch("Version", shown(text_bytes(text)), shown(got))

    def do_frame(self, hexadecimal, step):
        what, answer, data = f"the bytes {hexadecimal}", step["answer"], bytes.fromhex(hexadecimal)
        before = self.target.bytes_passed()
        self.line.say(data)
        if answer is None:
            self.quiet(what)
            return
        if not answer:
            self.arrive(what, before, len(data))
            return
        wanted = bytes.fromhex(answer)
        got = self.line.hear(lambda heard: len(heard) >= len(wanted), self.line.timeout)
        if got != wanted:
            raise Mismatch(what, wanted.hex(" "), got.hex(" ") or "silence")

    def arrive(self, what, before, length):
        """Nothing answers: wait until so many bytes have been on the line, if the target knows."""
        end = time.monotonic() + self.line.timeout
        while before is not None and (passed := self.target.bytes_passed() - before) < length:
            if time.monotonic() > end:
                raise Mismatch(what, f"{length} bytes on the line", f"{passed}")
            time.sleep(0.001)

    def position(self, motor):
        field = self.get(4, motor, f"Get Position of motor {motor}")
        try:
            if len(field) != field[0] + 1 or field[0] < 10:
                raise ValueError
            return int(field[1:])
        except (ValueError, IndexError):
            raise Mismatch(f"Get Position of motor {motor}", "a length, and a number in at least 10 characters",
                           shown(field)) from None

    def do_position(self, motor, step):
        self.number(f"position of motor {motor}", step["is"], self.position(motor), step.get("about", 0))

    def do_positions(self, wanted, _step):
        self.ask(b"\x040", b"\x040" + b"".join(b"\x0a%10d" % position for position in wanted), "Get Position of all motors")

    def same_text(self, number, motor, what, wanted):
        got = self.get(number, motor, what)
        if got != text_bytes(wanted):
            raise Mismatch(what, f"`{wanted[:200]}'", f"`{got[:200].decode('latin-1')}'")

    def do_program(self, motor, step):
        self.same_text(5, motor, f"Get Command of motor {motor}",
                       step["is"] + step.get("then", "") * step.get("times", 1) + step.get("end", ""))

    def do_table(self, motor, step):
        self.same_text(6, motor, f"Get Tabul Run of motor {motor}", "".join(step["is"]))

    def progress(self, motor):
        what = f"Get Pozic Run of motor {motor}"
        got = self.get(7, motor, what)
        try:
            steps, index = got.decode("ascii").split(";")
            if got != b" %d; %d" % (int(steps), int(index)):
                raise ValueError
            return int(steps), int(index)
        except ValueError:
            raise Mismatch(what, "` STEPS; INDEX'", shown(got)) from None

    def do_progress(self, motor, step):
        steps, index = self.progress(motor)
        if step["is"][0] is not None:
            self.number(f"steps done in the motion of motor {motor}", step["is"][0], steps, step.get("about", 0))
        self.number(f"place of the command of motor {motor}", step["is"][1], index, 0)

    def do_at(self, ticks, _step):
        self.target.pass_us(ticks - self.target.since_start())

    def do_wait(self, ticks, _step):
        self.target.pass_us(ticks)

    def do_idle(self, motor, step):
        wanted = step.get("at")
        limit = max(wanted - self.target.since_start(), 0) * 1.1 + 5_000_000 if wanted else step.get("within", 5_000_000)
        what = f"when motor {motor} has nothing more to do"
        got = self.target.until_idle(motor, limit, lambda number: self.progress(number)[1] == 0)
        if got is None:
            raise Mismatch(what, f"after {wanted} µs" if wanted else "soon", f"not within {limit:.0f} µs")
        if wanted is None:
            return
        early, late = 0, 0
        if not self.target.exact:  # a poll comes late, never early, but for the clocks
            early = wanted * REAL_SHARE + 2_000
            late = wanted * REAL_SHARE + self.target.latency_us()
        if not wanted - early <= got <= wanted + late:
            raise Mismatch(what, f"{wanted} µs" + (f" (-{early:.0f} +{late:.0f})" if late else ""), f"{got:.0f} µs")

    def do_moving(self, motor, _step):
        before = self.position(motor)
        self.target.pass_us(200_000)
        if self.position(motor) == before:
            raise Mismatch(f"motor {motor}", "on its way", f"it stands at {before}")

    def do_input(self, levels, _step):
        self.target.inputs(levels)

    def do_store(self, motor, _step):
        message = b"\x03" + str(motor).encode()
        self.ask(message, message + b"\0", f"Store Flash of motor {motor}")

    def do_power(self, _value, _step):
        self.target.power()

    def do_outputs(self, mask, step):
        if not self.target.exact and ("at" in step or not self.target.sees_outputs) or self.still:  # T41 holds them at 0
            self.unseen += 1
        elif "at" not in step:
            got = self.target.outputs()
            if got != mask:
                raise Mismatch("outputs", f"{mask:#04x}", f"{got:#04x}")
        else:
            times = [when for when, value in self.target.events("outputs") if value == mask]
            nth = step.get("nth", 1)
            got = times[nth - 1] if len(times) >= nth else None
            if got is None or abs(got - step["at"]) > step.get("near", 0):
                raise Mismatch(f"outputs became {mask:#04x}", f"at {step['at']} µs", "never" if got is None else f"at {got} µs")

    def do_motion(self, number, step):
        if not self.target.exact:
            self.unseen += 1
            return
        motor, near = step.get("motor", 1), step.get("near", 0)
        events = self.target.events("motion", motor)
        for key, value in (("begins", 1), ("ends", 0)):
            times = [when for when, kind in events if kind == value]
            got = times[number - 1] if len(times) >= number else None
            if key in step and (got is None or abs(got - step[key]) > near):
                raise Mismatch(f"motion {number} of motor {motor} {key}", f"at {step[key]} µs{f' ± {near}' if near else ''}",
                               "never" if got is None else f"at {got} µs")
