/* SPDX-License-Identifier: MIT */
#include "port.h"

#include "board.h"
#include "flash.h"

/* Hand it to the timer interrupt. A lane is full only when the board has fallen far behind: then wait for the interrupt. */
static void put(unsigned lane, uint64_t tick, uint8_t item)
{
    while (!pulses_room(&board_pulses, lane))
        board_play((uint32_t)tick);
    pulses_put(&board_pulses, lane, (uint32_t)tick, item);
}

static void on_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)position, (void)forward;
    for (size_t i = 0; i < count; i++)
        put(motor, tick[i], PULSE_STEP);
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    (void)context;
    put(motor, tick, forward ? PULSE_FORWARD : PULSE_BACK);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    put(0, tick, mask);
}

const struct rkm04_port port = {
    .steps = on_steps,
    .direction = on_direction,
    .outputs = on_outputs,
    .flash_read = flash_read,
    .flash_erase = flash_erase,
    .flash_program = flash_program,
};
