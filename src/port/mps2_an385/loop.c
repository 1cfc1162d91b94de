/* SPDX-License-Identifier: MIT */
#include "loop.h"

#include "board.h"
#include "flash.h"
#include "port.h"
#include "uart.h"

/* How far the unit runs ahead, in ticks. It must be more than planning takes, and as little as possible else: commands and
 * inputs take effect later by as much, and an answer is ahead by as much. */
#define AHEAD 7000u
#define AHEAD_LEAST 6000u /* with so much left before the next event it is advanced again */
#define LED_TICKS 100000u /* how often the LEDs are checked, at least */

struct rkm04_unit unit;

static void receive(void)
{
    const uint8_t *bytes;
    size_t count = uart_poll(&bytes), taken = rkm04_receive(&unit, bytes, count);
    uart_take(taken);
    if (taken == count && count > 0) { /* the queue may continue at its beginning */
        count = uart_poll(&bytes);
        uart_take(rkm04_receive(&unit, bytes, count));
    }
}

static void transmit(void)
{
    uint8_t bytes[64];
    size_t room = uart_room();
    size_t count = rkm04_send(&unit, bytes, room < sizeof bytes ? room : sizeof bytes);
    if (count > 0)
        uart_send(bytes, count);
}

static void show_leds(void)
{
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
    return next < latest + AHEAD_LEAST ? next - AHEAD_LEAST : latest;
}

/* Readings other than the defaults (docs/READINGS.md), members of struct rkm04_readings, as in
 * -DBOARD_READINGS='.hold_exit = RKM04_HOLD_EXIT_LATCH, .planning = 20'. */
#ifndef BOARD_READINGS
#define BOARD_READINGS .label = RKM04_LABEL_WAIT
#endif

void loop_start(void)
{
    board_start();
    uart_start();
    flash_start();
    const struct rkm04_config config = {.node = (uint8_t)(board_switch() + 1), .readings = {BOARD_READINGS}};
    rkm04_init(&unit, &config, &port, NULL);
    rkm04_advance(&unit, AHEAD); /* programs from flash have their head start, too */
    board_clock_start();
}

void loop_turn(void)
{
    uint64_t now = board_clock();
    rkm04_advance(&unit, now + AHEAD - rkm04_now(&unit));
    rkm04_set_inputs(&unit, board_inputs());
    receive();
    transmit();
    show_leds();
    board_play((uint32_t)back_at(now));
    board_sleep(rkm04_sending(&unit));
}
