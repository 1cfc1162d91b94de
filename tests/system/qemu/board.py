# SPDX-License-Identifier: MIT
"""board.py: the firmware for the STM32F405 under QEMU, for tools/conformance --port 'board:python3 board.py ELF [REPLAY]'. With
REPLAY, the program of replay.c, all changes of the pins are compared with the core's at the end, and standard error says so."""
import sys

sys.dont_write_bytecode = True

from drive import Wrong, compare, told  # noqa: E402
from stm32 import Board  # noqa: E402

STEP = 1000  # us after which it looks whether the board has sent something


def obey(board, word, argument):
    """What the answer holds besides the time."""
    if word == "bytes":
        board.send(bytes.fromhex(argument))
    elif word == "advance":
        board.run(int(argument))
    elif word == "wait":
        end, heard = board.now() + int(argument), board.hear()
        while not heard and board.now() < end:
            board.run(min(STEP, end - board.now()))
            heard = board.hear()
        return heard.hex()
    elif word == "inputs":
        board.set_inputs(int(argument))
    elif word == "outputs":
        return board.outputs
    elif word == "reset":
        board.power()
    else:
        raise Wrong(f"{word}: expected bytes, wait, advance, inputs, outputs, reset")
    return ""


def main():
    board, replay = Board(sys.argv[1]), sys.argv[2:]
    try:
        for line in sys.stdin:
            word, argument = (line.split() + [""])[:2]
            print("=", *obey_in_time(board, word, argument), flush=True)
        for path in replay:
            print(told(compare(board, path)), file=sys.stderr)
    except Wrong as wrong:
        sys.exit(f"board.py: {wrong}")
    finally:
        board.close()


def obey_in_time(board, word, argument):
    said = obey(board, word, argument)
    return board.now(), said


main()
