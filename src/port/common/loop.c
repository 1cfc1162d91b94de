/* SPDX-License-Identifier: MIT */
#include "loop.h"

#include "board.h"
#include "line.h"
#include "wake.h"

#define LEAST (BOARD_TICKS_AHEAD - 1000u) /* with so much left before the next event the unit is advanced again */
#define LED_TICKS 50000u /* how often the LEDs are checked */

struct rkm04_unit unit;
struct pulses board_pulses;

/* ---- Callbacks ---------------------------------------------------------------------------------------------------- */

/* Hand it to the interrupt. A lane is full only when the board has fallen far behind: then wait for the interrupt. */
static void put(unsigned lane, uint64_t tick, uint8_t item)
{
    while (!pulses_room(&board_pulses, lane))
        board_play((uint32_t)tick);
    pulses_put(&board_pulses, lane, (uint32_t)tick, item);
}

static void on_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)position, (void)forward;
    size_t done = pulses_put_steps(&board_pulses, motor, tick, count);
    for (; done < count; done++)
        put(motor, tick[done], PULSE_STEP);
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

const struct rkm04_port loop_port = {
    .steps = on_steps,
    .direction = on_direction,
    .outputs = on_outputs,
    .flash_read = board_flash_read,
    .flash_erase = board_flash_erase,
    .flash_program = board_flash_program,
};

/* ---- Loop ----------------------------------------------------------------------------------------------------------- */

static void receive(void)
{
    const uint8_t *bytes;
    size_t count = line_poll(&bytes), taken = rkm04_receive(&unit, bytes, count);
    line_take(taken);
    if (taken == count && count > 0) { /* the queue may continue at its beginning */
        count = line_poll(&bytes);
        line_take(rkm04_receive(&unit, bytes, count));
    }
}

static void transmit(void)
{
    uint8_t bytes[64];
    size_t room = line_room();
    size_t count = rkm04_send(&unit, bytes, room < sizeof bytes ? room : sizeof bytes);
    if (count > 0)
        line_send(bytes, count);
}

/* Not at each turn: the state of a motor is worked out, its speed too. */
static void show_leds(uint64_t now)
{
    static uint64_t due;
    if (now < due)
        return;
    due = now + LED_TICKS;
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        struct rkm04_motor_state state;
        if (rkm04_motor_state(&unit, motor, &state))
            board_led(motor, state.lit);
    }
}

/* When the main loop has to be back, if nothing comes in: before the unit's next event comes too close, and for the LEDs. */
static uint64_t back_at(uint64_t now)
{
    uint64_t next = rkm04_next_event(&unit), latest = now + LED_TICKS;
    return next < latest + LEAST ? next - LEAST : latest;
}

/* Readings other than the defaults (docs/READINGS.md), members of struct rkm04_readings, as in
 * -DBOARD_READINGS='.hold_exit = RKM04_HOLD_EXIT_LATCH, .planning = 20'. */
#ifndef BOARD_READINGS
#define BOARD_READINGS .label = RKM04_LABEL_WAIT
#endif

void loop_start(void)
{
    board_start();
    const struct rkm04_config config = {.node = (uint8_t)(board_switch() + 1), .readings = {BOARD_READINGS}};
    rkm04_init(&unit, &config, &loop_port, NULL);
    rkm04_advance(&unit, BOARD_TICKS_AHEAD); /* programs from flash have their head start, too */
    board_clock_start();
}

void loop_turn(void)
{
    uint64_t now = board_clock();
    rkm04_advance(&unit, now + BOARD_TICKS_AHEAD - rkm04_now(&unit));
    rkm04_set_inputs(&unit, board_inputs());
    receive();
    transmit();
    show_leds(now);
    board_play((uint32_t)back_at(now));
    wake_wait(rkm04_sending(&unit));
}
