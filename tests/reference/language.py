# SPDX-License-Identifier: MIT
"""The command language of the RKM04: text to commands and back (docs/SPEC.md, section 5)."""

INPUTS = range(1, 9)
VARIABLES = range(80, 96)
FUNCTIONS = range(40, 59)
CALLS = b"\x27\x22\xb4\x84"

NUMBERS = {
    "@": range(1, 81), "A": range(1, 60001), "B": range(1, 16000001), "F": range(1, 16000001), "J": range(1, 81),
    "L": range(1, 256), "M": INPUTS, "N": INPUTS, "S": range(1, 2001), "V": range(1, 16001), "W": range(1, 16000001),
    "X": INPUTS, ")": INPUTS, "(": INPUTS, "'": range(1, 81),
}
ALONE = "\\DEHKRUY.[]"
SIGNED = range(-2000000000, 2000000001)
GOAL = range(1, 2000000001)


def switch(letter, number):
    if number in INPUTS or number in VARIABLES or number in FUNCTIONS:
        return True
    return letter == "C" and number in (75, 100)


class Refused(Exception):
    """flag 1: a bad value; flag 2: an unknown command (P1). character: a byte."""

    def __init__(self, flag, character):
        super().__init__(flag, character)
        self.flag, self.character = flag, character


class Reader:
    def __init__(self, text, negative=True):
        self.text, self.at, self.negative = text, 0, negative

    def blanks(self):
        while self.at < len(self.text) and self.text[self.at] <= 0x20:
            self.at += 1

    def peek(self):
        return self.text[self.at] if self.at < len(self.text) else None

    def digits(self):
        """A number, or None."""
        begin = self.at
        while self.at < len(self.text) and 0x30 <= self.text[self.at] <= 0x39:
            self.at += 1
        return int(self.text[begin:self.at]) if self.at > begin else None

    def comment(self):
        """Passes over a comment. An unclosed one is an unknown command."""
        end = self.text.find(b"}", self.at)
        if end < 0:
            raise Refused(2, ord("{"))
        self.at = end + 1

    def number(self, allowed, character):
        self.blanks()
        value = self.digits()
        if value is None or value not in allowed:
            raise Refused(1, character)
        return value

    def command(self):
        character = self.text[self.at]
        self.at += 1
        letter = "'" if character in CALLS else chr(character)
        if letter in ALONE:
            return (letter,)
        if letter in NUMBERS:
            return (letter, self.number(NUMBERS[letter], character))
        if letter in "CT":
            value = self.number(range(1, 101), character)
            if not switch(letter, value):
                raise Refused(1, character)
            return (letter, value)
        if letter in "OZ":
            return (letter, self.number([*INPUTS, *VARIABLES], character))
        if letter == "I":
            return self.branch(character)
        if letter == "G":
            return self.go(character)
        if letter == "=":
            return self.counter(character)
        raise Refused(2, character)

    def branch(self, character):
        source = self.number([*INPUTS, *VARIABLES], character)
        self.blanks()
        level = self.peek()
        if level is None or level not in b"HL":
            raise Refused(1, character)
        self.at += 1
        return ("I", source, chr(level), self.number(range(1, 81), character))

    def go(self, character):
        self.blanks()
        sign = self.peek()
        if sign is not None and sign in b"+-":
            self.at += 1
            return ("G", chr(sign))
        return ("G", self.number(GOAL, character))

    def counter(self, character):
        self.blanks()
        negative = self.peek() == ord("-")
        if negative:
            self.at += 1
            self.blanks()
        value = self.digits()
        if value is None or (-value if negative else value) not in SIGNED or (negative and value and not self.negative):
            raise Refused(1, character)
        return ("=", -value if negative else value)


def is_bare(text):
    """Is a text of one command nothing but this command?"""
    return text[0] > 0x20 and text[-1] > 0x20 and b"{" not in text


def parse(text, negative=True):
    """Commands of a text (bytes), or Refused. negative: is there a `=-5`?"""
    reader, commands = Reader(text, negative), []
    while True:
        reader.blanks()
        if reader.peek() is None:
            return commands
        if reader.peek() == ord("{"):
            reader.comment()
        else:
            commands.append(reader.command())


def canonical(command):
    """Text of a command as Get Command shows it (P8)."""
    letter = command[0]
    if letter == "I":
        return "I%02d%s%d" % command[1:]
    if len(command) == 1:
        return letter
    if letter in "CTMNXOZ()":
        return "%s%02d" % command
    return "%s%s" % command
