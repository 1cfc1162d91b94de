# SPDX-License-Identifier: MIT
"""differential.py: the core against the reference interpreter, on random stories (docs/TESTING.md)."""

import argparse
import os
import sys
import time
from collections import Counter
from copy import deepcopy

import programs
import story as stories
from compare import Comparison, Subject, reference
from readings import Readings
from story import Send, Story

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "conformance"))
from command_line import Parser  # noqa: E402


def difference(subject, story):
    """What differs that may not, as (tick, text), or None; the reference's result; the Comparison."""
    ours = reference(story)
    try:
        comparison = Comparison(story, ours, subject.run(story))
    except RuntimeError as error:
        return (0, str(error)), ours, None
    return None if comparison.edge else comparison.hard, ours, comparison


def smaller(story):
    """Stories with something left out, the boldest first."""
    actions = story.actions
    size = len(actions) // 2
    while size:
        for at in range(0, len(actions), size):
            yield Story(story.readings, actions[:at] + actions[at + size:], story.end)
        size //= 2
    for at, action in enumerate(actions):
        if not isinstance(action, Send):
            continue
        size = max(1, len(action.commands) // 2)
        while size:
            for first in range(0, len(action.commands), size):
                copy = deepcopy(story)
                del copy.actions[at].commands[first:first + size]
                yield copy
            size //= 2
    for name, value in story.readings.items():
        if value != Readings.default(name):
            yield Story(Readings(**{**story.readings, name: Readings.default(name)}), actions, story.end)


def minimise(subject, story, found, seconds=60):
    """The smallest story that still differs, found by leaving out."""
    until = time.monotonic() + seconds
    story = shortened(story, found)
    again = True
    while again and time.monotonic() < until:
        again = False
        for candidate in smaller(story):
            if time.monotonic() > until:
                break
            try:
                now, _, _ = difference(subject, candidate)
            except Exception as error:  # the reference itself fails: as good a difference
                now = (candidate.end, repr(error))
            if now is not None:
                story, found, again = shortened(candidate, now), now, True
                break
    return story, found


def shortened(story, found):
    """The story up to a little after the difference."""
    end = min(story.end, found[0] + 2000)
    return Story(story.readings, [action for action in story.actions if action.tick < end], end)


def report(story, found):
    lines = "\n".join("  " + line for line in story.lines())
    print(f"at tick {found[0]}: {found[1]}\n{lines}", flush=True)


def main():
    parser = Parser(prog="tools/differential", description=(
        "Runs random programs on the core and on an independent reference interpreter and compares every pulse, "
        "motion, command, output, variable, fault, LED and answer."))
    parser.add_argument("--count", type=int, default=2000, metavar="N", help="stories (2000)")
    parser.add_argument("--seed", default="1", help="seed (1)")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="number of the first story (0)")
    parser.add_argument("--seconds", type=float, metavar="S", help="end after this time")
    parser.add_argument("--story", metavar="FILE", help="run this story only; - is standard input")
    parser.add_argument("--print", action="store_true", help="print the stories, run nothing")
    parser.add_argument("--clauses", action="store_true", help="print how often each clause was met")
    parser.add_argument("--keep-going", type=int, default=1, metavar="N", help="stop after N differences (1)")
    parser.add_argument("--subject", required=True, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.story:
        with sys.stdin if options.story == "-" else open(options.story, encoding="latin-1") as file:
            work = [(options.story, stories.read(file.read()))]
    else:
        numbers = range(options.first, options.first + options.count)
        work = ((number, programs.write(options.seed, number)) for number in numbers)
    if options.print:
        for number, story in work:
            print(f"# {number}", *story.lines(), sep="\n")
        return 0
    return run(options, work)


class Tally:
    def __init__(self):
        self.stories = self.events = self.soft = self.edges = self.failures = 0
        self.seen = Counter()

    def add(self, ours, comparison):
        self.stories += 1
        self.events += ours.size()
        self.seen += ours.seen
        if comparison is not None:
            self.soft += len(comparison.soft)
            self.edges += comparison.edge

    def line(self):
        return (f"{self.stories} stories, {self.events} events compared, {self.failures} differences; "
                f"{self.soft} a tick apart, {self.edges} stories cut short by that")


def run(options, work):
    subject, began, tally = Subject(options.subject), time.monotonic(), Tally()
    for number, story in work:
        found, ours, comparison = difference(subject, story)
        tally.add(ours, comparison)
        if found is not None:
            tally.failures += 1
            print(f"story {number} differs at tick {found[0]}: {found[1]}\n"
                  f"  alone: tools/differential --seed {options.seed} --first {number} --count 1")
            if not options.story:
                report(*minimise(subject, story, found))
            if tally.failures >= options.keep_going:
                break
        if options.seconds and time.monotonic() - began > options.seconds:
            break
    subject.close()
    if options.clauses:
        for clause, count in sorted(tally.seen.items()):
            print(f"{count:9}  {clause}")
    print(f"{tally.line()}; {time.monotonic() - began:.1f} s")
    return 1 if tally.failures or not tally.stories else 0


if __name__ == "__main__":
    sys.exit(main())
