# SPDX-License-Identifier: MIT
"""control_examples.py: executes the examples of docs/CONTROL.md and compares the answers.

    RKM04=… RKMCTL=… control_examples.py CONTROL.md [HEADING | --write] [-- OPTIONS]

Each section of the document meets a fresh unit with a stepped clock and the OPTIONS of rkm04 serve; `$ rkm04 serve OPTIONS` as
its first example has others. In its blocks `-->` is sent, `<--` has to come, `$` is run.
A line that is indented goes on with the one before. HEADING: that section alone. --write: put what came into the document, for
those who change an answer; look at the difference then."""
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import textwrap

from control_client import Client

WIDTH = 118


def statements(text):
    """Sections with their examples: a list of (heading, [(kind, content, first line, last line)])."""
    sections, inside = [("", [])], False
    for number, line in enumerate(text.split("\n")):
        if line.startswith("```"):
            inside = not inside
        elif not inside and re.match("##+ ", line):
            sections.append((line.lstrip("# "), []))
        elif inside and re.match(r"(-->|<--|\$) ", line):
            kind, content = line.split(" ", 1)
            sections[-1][1].append([kind, content, number, number])
        elif inside and line.startswith(" ") and sections[-1][1] and sections[-1][1][-1][3] == number - 1:
            sections[-1][1][-1][1] += "\n" + line.strip()
            sections[-1][1][-1][3] = number
    return [section for section in sections if section[1]]


def content(text):
    """JSON whose lines were broken between members."""
    return json.loads(text.replace("\n", " "))


def wrapped(answer):
    lines = textwrap.wrap(json.dumps(answer), WIDTH, break_long_words=False, break_on_hyphens=False)
    return ["<-- " + lines[0]] + ["    " + line for line in lines[1:]]


class Session:
    """A fresh unit, and a client of it."""

    def __init__(self, options):
        self.folder = tempfile.TemporaryDirectory()
        path = os.path.join(self.folder.name, "bus")
        bus = [] if "cnc872" in options else ["--link", path]
        command = [os.environ["RKM04"], "serve", *bus, "--control", path + ".control", "--clock", "stepped", *options]
        self.emulator = subprocess.Popen(command,
                                         cwd=self.folder.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        ready = self.emulator.stdout.readline()
        assert ready.startswith("READY "), f"no unit: {self.emulator.stderr.read()}"
        self.link = path
        self.client = Client(path + ".control")

    def run(self, command):
        programs = {"rkmctl": os.environ["RKMCTL"], "LINK": self.link}
        command = re.sub(r"\b(rkmctl|LINK)\b", lambda word: programs[word[0]], command)
        command = command.replace("--timeout 200 ", "--timeout 2000 ")  # or the unit of a busy machine has not read it yet
        done = subprocess.run(command, shell=True, cwd=self.folder.name, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, f"`{command}' ended with {done.returncode}: {done.stdout}{done.stderr}"

    def end(self):
        self.client.close()
        self.emulator.terminate()
        self.emulator.communicate(timeout=60)
        self.folder.cleanup()


def run_section(heading, examples, lines, write, options):
    """Returns what is wrong; with `write`, the lines are changed instead."""
    serve = "rkm04 serve "
    if examples[0][0] == "$" and examples[0][1].startswith(serve):
        options = shlex.split(examples.pop(0)[1][len(serve):])
    session, wrong = Session(options), []
    try:
        for kind, text, first, last in examples:
            if kind == "$":
                session.run(text)
            elif kind == "-->":
                session.client.send(text.replace("\n", " ").encode() + b"\n")
            else:
                answer = session.client.line()
                if write:
                    lines[first:last + 1] = ["\n".join(wrapped(answer))] + [None] * (last - first)
                elif answer != content(text):
                    wrong.append(f"line {first + 1}: expected {content(text)}\n    got {answer}")
        if not session.client.silent(0.05) and session.client.line() is not None:
            wrong.append("there is more to be read than the document says")
    except Exception as error:  # pylint: disable=broad-except
        wrong.append(f"line {first + 1}: {type(error).__name__}: {error}")
    finally:
        session.end()
    return [f"{heading}: {text}" for text in wrong]


def main():
    cut = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    path, choice, options = sys.argv[1], sys.argv[2] if cut > 2 else None, sys.argv[cut + 1:]
    with open(path, encoding="utf-8") as file:
        text = file.read()
    lines, failed, count = text.split("\n"), 0, 0
    for heading, examples in statements(text):
        if choice in (None, "--write", heading):
            wrong = run_section(heading, examples, lines, choice == "--write", options)
            count += len(examples)
            failed += len(wrong)
            print("\n".join(["FAILED " + entry for entry in wrong]) or f"ok {heading}")
    assert count > 0, "no examples found"
    if choice == "--write":
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(line for line in lines if line is not None))
    sys.exit(failed > 0)


main()
