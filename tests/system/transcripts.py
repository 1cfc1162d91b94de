# SPDX-License-Identifier: MIT
"""transcripts.py: runs the commands of a document and compares what they print.

    RKM04=… RKMCTL=… transcripts.py DOCUMENT [--write]

A block of code with a line that begins with `$ ' is a transcript: each command is run, its output is what stands below it. Blanks
do not count, `...' stands for anything, a line that is indented goes on with the one before. Comments above a block say more:

    <!-- run: COMMANDS -->     run these first; in a block without `$ ' every line is a command then
    <!-- file: NAME -->        the block is that file
    <!-- not run: REASON -->   the block needs what a test has not got

The blocks of a document share a folder, a shell, and the emulator that was started last. --write: put what came into the
document; look at the difference then."""
import os
import re
import select
import subprocess
import sys
import tempfile
import time

WIDTH = 126
LIMIT = 60  # s until a command counts as hanging
MARK = "=== end "
SERVE = re.compile(r"^(rkm04 serve|build/release/rkm04 serve|tools/run)\b(.*)$")


class Block:
    """A block of code: `lines` without their indentation, from the line `first`, with what the comment above it says."""

    def __init__(self, first, indent, note):
        self.first, self.indent, self.lines = first, indent, []
        kind = re.match(r"<!-- (run|file|not run)(?:: (.*))? -->$", note or "")
        self.kind, self.text = (kind[1], kind[2] or "") if kind else (None, "")

    def is_transcript(self):
        return any(line.startswith("$ ") for line in self.lines)

    def commands(self):
        """[command, expected lines or None, number of the first line of output, of the one behind it]"""
        found = []
        for number, line in enumerate(self.lines):
            if line.startswith("$ "):
                found.append([line[2:], [], number + 1, number + 1])
            elif not self.is_transcript() and line.strip():
                found.append([line, None, number + 1, number + 1])
            elif found and found[-1][1] is not None:
                found[-1][1].append(line)
                found[-1][3] = number + 1
        return found


def blocks(text):
    found, note, fence = [], None, None
    lines = text.split("\n")
    for number, line in enumerate(lines):
        if line.startswith("```"):
            fence = None if fence else Block(number + 1, "", note)
            if fence:
                found.append(fence)
            note = None
        elif fence:
            fence.lines.append(line)
        elif line.startswith("    ") and (found and found[-1].indent and found[-1].first + len(found[-1].lines) == number):
            found[-1].lines.append(line[4:])
        elif line.startswith("    ") and (number == 0 or not lines[number - 1].strip()):
            found.append(Block(number, "    ", note))
            found[-1].lines.append(line[4:])
            note = None
        elif line.startswith("<!-- "):
            note = line
        elif line.strip():
            note = None
    return found


class Shell:
    """A shell in a folder of its own, with the source's tools and examples and the programs under test."""

    def __init__(self, source):
        self.folder = tempfile.TemporaryDirectory()
        self.emulator, self.port = None, None
        place = self.folder.name
        for name in ("examples", "tools"):
            os.symlink(os.path.join(source, name), os.path.join(place, name))
        os.makedirs(os.path.join(place, "build/release"))
        os.mkdir(os.path.join(place, "run"))
        for name in ("RKM04", "RKMCTL"):
            os.symlink(os.path.abspath(os.environ[name]), os.path.join(place, "build/release", name.lower()))
        self.environment = dict(os.environ, XDG_RUNTIME_DIR=os.path.join(place, "run"), HERE=os.path.join(source, "tests/system"),
                                PATH=os.path.join(place, "build/release") + ":" + os.environ["PATH"])
        self.shell = subprocess.Popen(["bash"], cwd=place, env=self.environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT)

    def stop(self):
        if self.emulator:
            self.emulator.terminate()
            self.emulator.communicate(timeout=LIMIT)
        self.emulator = None

    def serve(self, options):
        """Start an emulator in place of the last one; a port in the text becomes one that is free."""
        self.stop()
        options = re.sub(r"(--tcp |--rfc2217 |--service \S+=127.0.0.1:)\d+", r"\g<1>0", options.split("  #")[0])
        self.emulator = subprocess.Popen(["bash", "-c", "exec rkm04 serve" + options], cwd=self.folder.name, text=True,
                                         env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        ready = self.emulator.stdout.readline()
        assert ready.startswith("READY "), f"no unit: {self.emulator.stderr.read()}"
        port = re.search(r'"tcp":"[^"]*:(\d+)"', ready)
        self.port = port and port[1]

    def run(self, command):
        """Returns the exit status and the output."""
        serve = SERVE.match(command)
        if serve:
            self.serve(serve[2])
            return 0, ""
        command = command.replace("/run/user/1000", os.path.join(self.folder.name, "run"))
        command = re.sub(r"\b(rkmctl .*watch)\b", r"\1 --once", command)
        if self.port:
            command = command.replace("localhost:4001", "localhost:" + self.port)
        self.shell.stdin.write(f"{{ {command}\n}} </dev/null; printf '\\n{MARK}%d\\n' $?\n".encode())
        self.shell.stdin.flush()
        output, end = b"", time.monotonic() + LIMIT
        while not (mark := re.search(rb"\n" + MARK.encode() + rb"(\d+)\n$", output)):
            assert select.select([self.shell.stdout], [], [], max(0, end - time.monotonic()))[0], f"`{command}' hangs: {output}"
            piece = os.read(self.shell.stdout.fileno(), 65536)
            assert piece, f"`{command}' ends the shell: {output}"
            output += piece
        text = output[:mark.start()].decode(errors="replace")
        return int(mark[1]), re.sub(r'^Running as user "root".*\n', "", text)  # tshark

    def end(self):
        self.stop()
        self.shell.stdin.close()
        self.shell.wait(timeout=LIMIT)
        self.folder.cleanup()


def agrees(expected, output):
    pattern = ".*".join(re.escape(re.sub(r"\s", "", part)) for part in "\n".join(expected).split("..."))
    return re.fullmatch(pattern, re.sub(r"\s", "", output), re.DOTALL) is not None


def wrapped(output):
    """Lines of output as they stand in a document."""
    for line in output.rstrip("\n").split("\n"):
        while len(line) > WIDTH:
            at = max(line.rfind(mark, 40, WIDTH) for mark in (" ", ","))
            yield line[:at + 1].rstrip()
            line = "    " + line[at + 1:]
        yield line


def run_block(block, shell, lines, write):
    """Returns what is wrong; with `write`, changes the lines of the document."""
    if block.kind == "run":
        for command in filter(None, block.text.split("; ")):
            status, output = shell.run(command)
            assert status == 0, f"`{command}' ended with {status}: {output}"
    wrong = []
    for command, expected, first, last in block.commands():
        status, output = shell.run(command)
        where = f"line {block.first + first}: `{command}'"
        if expected is None:
            if status != 0:
                wrong.append(f"{where} ended with {status}: {output}")
        elif write and not agrees(expected, output):
            above = block.first + first - 1
            lines[above + 1:block.first + last] = [None] * (last - first)
            lines[above] = "\n".join([lines[above]] + [block.indent + line for line in wrapped(output) if output])
        elif not agrees(expected, output):
            wrong.append(f"{where}: expected\n{chr(10).join(expected)}\n  got\n{output}")
    return wrong


def main():
    path, write = sys.argv[1], "--write" in sys.argv[2:]
    source = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    with open(path, encoding="utf-8") as file:
        text = file.read()
    lines, wrong, count = text.split("\n"), [], 0
    shell = Shell(source)
    try:
        for block in blocks(text):
            if block.kind == "file":
                with open(os.path.join(shell.folder.name, block.text), "w", encoding="utf-8") as file:
                    file.write("\n".join(block.lines) + "\n")
        for block in blocks(text):
            if block.kind == "run" or (block.kind is None and block.is_transcript()):
                count += 1
                wrong += run_block(block, shell, lines, write)
    except AssertionError as error:
        wrong.append(str(error))
    finally:
        shell.end()
    if write:
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(line for line in lines if line is not None))
    for entry in wrong:
        print(f"FAILED {path}: {entry}")
    print(f"{count} blocks")
    sys.exit(1 if wrong else 0)


main()
