# SPDX-License-Identifier: MIT
"""check_pages.py RKM04 DOCUMENT FOLDER: the programs of docs/CHECK.md. Each warning has a section with a bad and a good program;
of the bad one this warning alone is reported, of the good one nothing."""
import json
import os
import re
import subprocess
import sys

program, document, folder = sys.argv[1:]
problems = []


def names_of(arguments):
    result = subprocess.run([program, "check", "--json", *arguments], capture_output=True, text=True, cwd=folder, check=False)
    if result.returncode != 0 or result.stderr:
        return [f"exit status {result.returncode}: {result.stderr}"]
    return sorted({one["name"] for one in json.loads(result.stdout)["diagnostics"]})


def write(name, text):
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)
    return name


def arguments_of(blocks):
    """blocks: what stands behind bad or good (a motor, "N times COMMAND,", a plant), and the text."""
    arguments = []
    for note, text in blocks:
        times = re.match(r"(\d+) times (\S+),", note)
        if times:
            text = (times[2] + "\n") * int(times[1]) + text
            note = ""
        if note == "plant":
            arguments += ["--plant", write("plant.yaml", text)]
            continue
        name = write(f"{note or 'program'}.rks", text)
        arguments.append(f"{note}={name}" if note else name)
    return arguments


with open(document, encoding="utf-8") as page:
    sections = dict(re.findall(r"^### (\S+)\n(.*?)(?=^##|\Z)", page.read(), re.M | re.S))
listed = subprocess.run([program, "check", "--list"], capture_output=True, text=True, check=True).stdout.split("\n")
warnings = [line.split()[0] for line in listed if line]
if sorted(sections) != sorted(warnings):
    problems.append(f"sections and warnings differ: {sorted(set(sections) ^ set(warnings))}")
for warning, section in sections.items():
    found = {"bad": [], "good": []}
    for kind, note, text in re.findall(r"^```\w+ (bad|good) ?([^\n]*)\n(.*?)^```", section, re.M | re.S):
        found[kind].append((note, text))
    for kind, expected in ("bad", [warning]), ("good", []):
        if not found[kind]:
            problems.append(f"{warning}: no {kind} program")
        elif (got := names_of(arguments_of(found[kind]))) != expected:
            problems.append(f"{warning}: of the {kind} program is told {got}, expected {expected}")
print("\n".join(problems))
sys.exit(1 if problems else 0)
