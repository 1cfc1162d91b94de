/* SPDX-License-Identifier: MIT */
/* commands.h: every command of the unit (manual chapter 7, specification section 5). The only place to add one.
 *
 * COMMAND_TABLE(ROW) expands ROW(character, name, form, ranges...) for each. parse.c makes from it what may be written,
 * interp.c a dispatch on the functions do_<name>.
 *
 * form, what follows the character:
 *   NONE      nothing
 *   NUMBER    a number in one of the ranges
 *   BIT       the same, the number of an input, output, variable or function: canonically two digits
 *   SIGNED    a number that may have a '-'
 *   ABSOLUTE  a number, or '+' or '-' alone
 *   JUMP_IF   a bit in ranges 0 and 1, 'H' or 'L', a label in range 2
 *
 * Ranges are inclusive, at most RKM04_RANGES_MAX; the reader takes numbers from -INT32_MAX to INT32_MAX. */
#ifndef RKM04_SRC_COMMANDS_H
#define RKM04_SRC_COMMANDS_H

#include <rkm04/limits.h>

#define RANGE_NONE {0, 0}
#define RANGE_INPUT {1, RKM04_INPUTS}
#define RANGE_OUTPUT {1, RKM04_OUTPUTS}
#define RANGE_VARIABLE {RKM04_FIRST_VARIABLE, RKM04_FIRST_VARIABLE + RKM04_VARIABLES - 1}
#define RANGE_FUNCTION {40, 58}
#define RANGE_RESUME {75, 75}    /* C75 */
#define RANGE_POSITION {100, 100} /* C100 */
#define RANGE_LABEL {1, RKM04_LABELS}
#define RANGE_STEPS {1, 16000000}
#define RANGE_DWELL {1, 16000000}
#define RANGE_PASSES {1, 255}
#define RANGE_START_SPEED {1, RKM04_START_SPEED_MAX}
#define RANGE_SPEED {1, RKM04_SPEED_MAX}
#define RANGE_ACCELERATION {1, RKM04_ACCELERATION_MAX}
#define RANGE_PLACE {1, 2000000000}
#define RANGE_COUNTER {-2000000000, 2000000000}

/* clang-format off */
#define COMMAND_TABLE(ROW) \
    ROW('\\', reset,          NONE,     RANGE_NONE) \
    ROW('@',  label,          NUMBER,   RANGE_LABEL) \
    ROW('A',  acceleration,   NUMBER,   RANGE_ACCELERATION) \
    ROW('B',  back,           NUMBER,   RANGE_STEPS) \
    ROW('C',  clear,          BIT,      RANGE_OUTPUT, RANGE_FUNCTION, RANGE_RESUME, RANGE_VARIABLE, RANGE_POSITION) \
    ROW('D',  reverse,        NONE,     RANGE_NONE) \
    ROW('E',  loop_end,       NONE,     RANGE_NONE) \
    ROW('F',  forward,        NUMBER,   RANGE_STEPS) \
    ROW('G',  absolute,       ABSOLUTE, RANGE_PLACE) \
    ROW('H',  home,           NONE,     RANGE_NONE) \
    ROW('I',  jump_if,        JUMP_IF,  RANGE_INPUT, RANGE_VARIABLE, RANGE_LABEL) \
    ROW('J',  jump,           NUMBER,   RANGE_LABEL) \
    ROW('K',  halt,           NONE,     RANGE_NONE) \
    ROW('L',  loop_begin,     NUMBER,   RANGE_PASSES) \
    ROW('M',  guard_high,     BIT,      RANGE_INPUT) \
    ROW('N',  guard_low,      BIT,      RANGE_INPUT) \
    ROW('O',  wait_high,      BIT,      RANGE_INPUT, RANGE_VARIABLE) \
    ROW('R',  run,            NONE,     RANGE_NONE) \
    ROW('S',  start_speed,    NUMBER,   RANGE_START_SPEED) \
    ROW('T',  set,            BIT,      RANGE_OUTPUT, RANGE_FUNCTION, RANGE_VARIABLE) \
    ROW('U',  guards_off,     NONE,     RANGE_NONE) \
    ROW('V',  speed,          NUMBER,   RANGE_SPEED) \
    ROW('W',  dwell,          NUMBER,   RANGE_DWELL) \
    ROW('X',  total_stop,     BIT,      RANGE_INPUT) \
    ROW('Y',  segment,        NONE,     RANGE_NONE) \
    ROW('Z',  wait_low,       BIT,      RANGE_INPUT, RANGE_VARIABLE) \
    ROW(')',  limit_forward,  BIT,      RANGE_INPUT) \
    ROW('(',  limit_back,     BIT,      RANGE_INPUT) \
    ROW('=',  write_position, SIGNED,   RANGE_COUNTER) \
    ROW('\'', call,           NUMBER,   RANGE_LABEL) \
    ROW('.',  call_return,    NONE,     RANGE_NONE) \
    ROW('[',  block_begin,    NONE,     RANGE_NONE) \
    ROW(']',  block_end,      NONE,     RANGE_NONE)
/* clang-format on */

#endif
