# SPDX-License-Identifier: MIT
"""The command lines of the tools written in Python."""
import argparse
import os
import sys


class Parser(argparse.ArgumentParser):
    """One whose help that cannot be written is a failure: argparse says nothing then, and ends with 0."""

    def print_help(self, file=None):
        if file is not None:
            super().print_help(file)
            return
        sys.stdout.flush()
        left = self.format_help().encode()
        try:
            while left:
                left = left[os.write(1, left):]
        except OSError as error:
            self.exit(1, f"{self.prog}: cannot write: {error.strerror}\n")
