# SPDX-License-Identifier: MIT
"""estimate_random.py RKM04 FOLDER SEED COUNT: random programs of two motors. What `rkm04 estimate` prints of steps, positions and
the end is what a trace of `rkm04 exec` has."""
import json
import os
import random
import subprocess
import sys

program, folder, seed, count = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
draw = random.Random(seed)
problems = []


def one_of_many():
    number = draw.randrange
    return draw.choice([
        lambda: f"S{number(1, 400)} V{number(1, 5000)} A{number(1, 60000)}",
        lambda: f"F{number(1, 4000)} R",
        lambda: f"B{number(1, 4000)} R D R",
        lambda: f"L{number(1, 4)} F{number(1, 900)} R W{number(1, 90)} E",
        lambda: f"G{number(1, 9000)}",
        lambda: "H",
        lambda: f"F{number(1, 900)} Y V{number(1, 3000)} Y F{number(1, 900)} Y R",
        lambda: draw.choice(["T80", "T81", "C80", "T01", "C01"]),
        lambda: draw.choice(["O80", "Z81", "I80H5", "W7", "@5"]),
    ])()


def run(*arguments):
    result = subprocess.run([program, *arguments], capture_output=True, text=True, cwd=folder, check=False)
    return json.loads(result.stdout) if result.stdout else {"end": f"nothing: {result.stderr}"}


def compare(texts):
    estimate = run("estimate", "--json", "1=x.rks", "2=y.rks")
    state = run("exec", "--json", "1=x.rks", "2=y.rks", "--trace", "run.csv")
    if (estimate["end"] in ("round", "endless")) != (state["end"] == "endless"):
        problems.append(f"ends with {estimate['end']}, {state['end']}: {texts}")
    if state["end"] != "done" or problems:
        return
    steps = [0, 0]
    with open(os.path.join(folder, "run.csv"), encoding="utf-8") as trace:
        for line in trace:
            fields = line.split(",")
            if fields[2] == "step":
                steps[int(fields[1][1]) - 1] += 1
    told = [(motor["steps"], motor["position"]) for motor in estimate["motors"][:2]]
    done = [(steps[at], state["motors"][at]["position"]) for at in range(2)]
    if told != done or sum(steps) != sum(motion["all_steps"] for motion in estimate["motions"]):
        problems.append(f"told {told}, done {done}: {texts}")


for _ in range(count):
    programs = {name: " ".join(["C100"] + [one_of_many() for _ in range(draw.randrange(3, 14))]) for name in ("x", "y")}
    for name, text in programs.items():
        with open(os.path.join(folder, f"{name}.rks"), "w", encoding="utf-8") as file:
            file.write(text)
    compare(programs)
print("\n".join(problems))
sys.exit(1 if problems else 0)
