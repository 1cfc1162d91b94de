/* SPDX-License-Identifier: MIT */
/* What a motor waits for, in words. */
#include <inttypes.h>
#include <stdio.h>

#include "rkm04_device.h"

#define TICKS_PER_MS 1000u

/* "DI 05", "VAR 81". */
static void name_bit(char *text, size_t size, unsigned bit)
{
    snprintf(text, size, "%s %02u", bit >= RKM04_FIRST_VARIABLE ? "VAR" : "DI", bit);
}

static json_t *json_for_command(const struct rkm04_motor *motor, const char *rest)
{
    char text[RKM04_COMMAND_TEXT_MAX];
    int length = (int)rkm04_format(motor->command, text);
    return json_sprintf("the end of %.*s%s", length, text, rest);
}

static json_t *json_for_motion(const struct rkm04_motor *motor)
{
    const struct rkm04_motion *motion = &motor->motion;
    char rest[64], input[16];
    if (motion->stopping) {
        static const char *const after[] = {
            [RKM04_AFTER_GO_ON] = "the end of the stop ramp",
            [RKM04_AFTER_HOLD_REST] = "the end of the stop ramp, to hold",
            [RKM04_AFTER_HOLD_NEXT] = "the end of the stop ramp, to hold",
            [RKM04_AFTER_END] = "the end of the stop ramp, to end the program",
        };
        return json_string(after[motor->after]);
    }
    switch ((enum rkm04_motion_kind)motion->kind) {
    case RKM04_MOTION_ENDLESS:
        return json_string("K, or a guard M, N, X: the motion is endless");
    case RKM04_MOTION_LIMIT:
        name_bit(input, sizeof input, motion->input);
        return json_sprintf("%s to be 1", input);
    default:
        snprintf(rest, sizeof rest, ": %" PRIu32 " of %" PRIu32 " steps done", motion->done, motion->total);
        return json_for_command(motor, rest);
    }
}

/* W, or a motion that is being planned. */
static json_t *json_for_dwell(const struct rkm04_motor *motor, uint64_t left)
{
    char text[RKM04_COMMAND_TEXT_MAX];
    int length = (int)rkm04_format(motor->command, text);
    return json_sprintf("the %s of %.*s: %" PRIu64 " ms left", motor->command.op == 'W' ? "end" : "begin", length, text,
                        (left + TICKS_PER_MS - 1) / TICKS_PER_MS);
}

static json_t *json_for_hold(const struct rkm04_unit *unit, const struct rkm04_motor *motor)
{
    const char *others = unit->config.readings.hold_exit == RKM04_HOLD_EXIT_LATCH ? "" : ", or new commands";
    if (motor->held == RKM04_MOVING)
        return json_sprintf("C75 to resume the motion (%" PRIu32 " steps done)%s", motor->motion.done, others);
    if (motor->held == RKM04_DWELL)
        return json_sprintf("C75 to resume the %s (%" PRIu64 " ms left)%s",
                            motor->command.op == 'W' ? "dwell" : "planning of its motion",
                            (motor->due + TICKS_PER_MS - 1) / TICKS_PER_MS, others);
    return json_sprintf("C75 to resume%s", others);
}

/* O, Z, or a jump or call whose label has not arrived. */
static json_t *json_for_wait(const struct rkm04_motor *motor)
{
    char bit[16];
    unsigned label = rkm04_awaited_label(motor);
    if (label != 0)
        return json_sprintf("label %u to arrive", label);
    name_bit(bit, sizeof bit, (unsigned)motor->command.argument);
    return json_sprintf("%s to be %d", bit, motor->command.op == 'O');
}

unsigned rkm04_awaited_label(const struct rkm04_motor *motor)
{
    if (motor->state != RKM04_WAIT || motor->command.op == 'O' || motor->command.op == 'Z')
        return 0;
    return motor->command.op == 'I' ? motor->command.argument >> 16 : motor->command.argument;
}

json_t *rkm04_waits_json(const struct rkm04_unit *unit, unsigned number)
{
    const struct rkm04_motor *motor = &unit->motor[number - 1];
    switch ((enum rkm04_state)motor->state) {
    case RKM04_MOVING:
        return json_for_motion(motor);
    case RKM04_DWELL:
        return json_for_dwell(motor, motor->due > unit->now ? motor->due - unit->now : 0);
    case RKM04_WAIT:
        return json_for_wait(motor);
    case RKM04_BLOCK:
        return json_string("the ] of its block");
    case RKM04_HELD:
        return json_for_hold(unit, motor);
    case RKM04_ENDED:
        return json_string("new commands: ended by X");
    case RKM04_FAULTY:
        return json_sprintf("%s\\: fault %s",
                            unit->config.readings.fault_exit == RKM04_FAULT_EXIT_NEW ? "new commands, or " : "",
                            rkm04_fault_name((enum rkm04_fault)motor->fault));
    default:
        return json_null();
    }
}
