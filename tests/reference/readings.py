# SPDX-License-Identifier: MIT
"""The readings of the specification (docs/SPEC.md, section 10): name, values with the default first, or the highest ms."""

NAMED = {
    "label": ("wait", "fault"), "fault-exit": ("reset", "new"), "hold-exit": ("new", "latch"), "x-after": ("armed", "once"),
    "guard-start": ("none", "step"), "v-alone": ("blanks", "first"), "y-eleventh": ("run", "y"),
    "reset-t41": ("keep", "clear"), "negative-position": ("yes", "no"),
}
TIMES = {"input-filter": 100, "speed-change": 2000, "planning": 2000, "store-time": 1000}  # ms


class Readings(dict):
    """All readings by name: a word, or ms."""

    def __init__(self, **others):
        super().__init__({name: values[0] for name, values in NAMED.items()} | {name: 0 for name in TIMES})
        for name, value in others.items():
            self[name.replace("_", "-")] = value

    def others(self):
        """Those that are not the default, as NAME=VALUE."""
        return [f"{name}={value}" for name, value in self.items() if value != Readings.default(name)]

    @staticmethod
    def default(name):
        return NAMED[name][0] if name in NAMED else 0

    def read(self, text):
        """Takes NAME=VALUE,... over."""
        for part in filter(None, text.split(",")):
            name, _, value = part.partition("=")
            if name in NAMED and value in NAMED[name]:
                self[name] = value
            elif name in TIMES and value.isdigit() and int(value) <= TIMES[name]:
                self[name] = int(value)
            else:
                raise ValueError(f"no reading {part!r}")

    def numbers(self):
        """In the order of struct rkm04_readings."""
        return [values.index(self[name]) for name, values in NAMED.items()] + [self[name] for name in TIMES]
