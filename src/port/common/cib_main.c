/* SPDX-License-Identifier: MIT */
/* cib_main.c: a CIB module on a board: loop.c and main.c for the other core. Outputs are DO1-DO8, where a bipolar output is 1 for
 * +; the line is Modbus RTU, the switch the address less one. Push buttons have no pins. PWM is exact as far as the board's timer
 * follows: from periods of some 1000 us on. */
#include "board.h"
#include "cib_faces/cib_faces.h"
#include "line.h"
#include "wake.h"

#define LEAST (BOARD_TICKS_AHEAD - 1000u) /* with so much left before the next event the unit is advanced again */
#define BACK_TICKS 100000u                /* how often the main loop comes back, at least */

/* us without a byte that end a frame. */
#ifndef BOARD_SILENCE
#define BOARD_SILENCE CIB_SILENCE
#endif

struct cib_unit unit;
struct cib_rtu rtu = {.silence = BOARD_SILENCE};
struct pulses board_pulses;

/* Hand the levels to the interrupt. The lane is full only when the board has fallen far behind: then wait for it. */
static void on_outputs(void *context, uint64_t tick, uint16_t driven)
{
    (void)context;
    while (!pulses_room(&board_pulses, 0))
        board_play((uint32_t)tick);
    pulses_put(&board_pulses, 0, (uint32_t)tick, (uint8_t)(driven & 0xffu));
}

static const struct cib_port port = {.outputs = on_outputs, .edges = on_outputs};

/* Silence ends a frame before anything else happens in its tick. */
static void advance(uint64_t end)
{
    while (cib_now(&unit) < end) {
        uint64_t due = cib_rtu_due(&rtu), stop = due < end ? due : end;
        if (stop > cib_now(&unit))
            cib_advance(&unit, stop - cib_now(&unit));
        if (stop < end)
            cib_rtu_check_silence(&rtu, &unit);
    }
}

static void receive(void)
{
    const uint8_t *bytes;
    size_t count = line_poll(&bytes), taken = 0;
    while (taken < count && cib_rtu_receive(&rtu, &unit, bytes[taken]))
        taken++;
    line_take(taken);
}

static void transmit(void)
{
    uint8_t byte;
    while (line_room() > 0 && cib_rtu_send(&rtu, &unit, &byte))
        line_send(&byte, 1);
}

/* When the main loop has to be back, if nothing comes in. */
static uint64_t back_at(uint64_t now)
{
    uint64_t next = cib_next_event(&unit), latest = now + BACK_TICKS, due = cib_rtu_due(&rtu);
    next = due < next ? due : next;
    return next < latest + LEAST ? next - LEAST : latest;
}

int main(void)
{
    board_start();
    rtu.address = (uint8_t)(board_switch() + 1u);
    cib_begin(&unit, &cib_default_config, &port, NULL);
    cib_set_inputs(&unit, board_inputs());
    advance(BOARD_TICKS_AHEAD);
    board_clock_start();
    for (;;) {
        uint64_t now = board_clock();
        advance(now + BOARD_TICKS_AHEAD);
        cib_set_inputs(&unit, board_inputs());
        receive();
        transmit();
        board_play((uint32_t)back_at(now));
        wake_wait(rtu.answer_length > 0);
    }
}
