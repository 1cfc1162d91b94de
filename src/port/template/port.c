/* SPDX-License-Identifier: MIT */
/* port.c: template of a port to a board. Copy the folder, fill in what says BOARD, and it is a unit.
 *
 * Build the core (the sources in src/) and this file with the same RKM04_MESSAGE_MAX; -DRKM04_MESSAGE_MAX=1024 makes a unit
 * that fits 24 KiB of RAM. The core needs C11, memcpy and its like, and nothing else: no heap, no clock, no interrupt.
 *
 * Who runs when: everything runs in the main loop, rkm04_* are never called from an interrupt, and no callback calls back into
 * the unit. Interrupts only fill and empty the queues of the serial line and end the pulses.
 *
 * Exact pulses: a callback gets the tick of the event, and is called when the main loop gets there, some microseconds
 * later. A board that wants its pulses exact to the microsecond lets the unit run ahead by a few slots, puts the callbacks'
 * happenings into a queue with their ticks, and plays the queue from a timer interrupt; inputs then act later by as much.
 * ../mps2_an385 does so; ../riscv_virt is this file filled in. docs/PORTING.md goes through it step by step. */
#include <rkm04/unit.h>

/* What the callbacks need to know of the board; handed to them as `context`. */
struct board {
    uint8_t outputs; /* DO, as last reported */
};

/* ---- BOARD: clock, terminals, line ---------------------------------------------------------------------------------- */

/* Once, before anything else: clocks, pins (all outputs at 0), UART at 19200 8N1 (U7), RS485 driver off, a 1 MHz timer. */
static void board_start(struct board *board)
{
    board->outputs = 0;
}

/* Microseconds since board_start (of a timer that continues over a reset take the difference), never going back. 64 bits: a
 * 32-bit timer wraps after 71 minutes, so count its wraps. */
static uint64_t board_clock(void)
{
    return 0;
}

/* Sleep (WFI) until this tick of the clock, until a byte comes or an input changes, or, if there is `more` to send, until the
 * queue to the UART has room for it, whichever is first. Return at once if the line has bytes already, unless there is more to
 * send: then they may have to wait (P10). Waking too early is harmless. */
static void board_sleep_until(uint64_t tick, bool more)
{
    (void)tick, (void)more;
}

/* Terminals BI 01..08, bit 0 is BI 01; 1 = current flows. Filter bounces here: the unit takes what it gets. */
static uint8_t board_inputs(void)
{
    return 0;
}

/* Switch S1: 0..15, S1-1 is bit 0 (U4). */
static uint8_t board_switch(void)
{
    return 0;
}

/* Take what the UART's interrupt has received. Returns the number of bytes; they stay in the queue until board_received. */
static size_t board_poll_line(const uint8_t **bytes)
{
    *bytes = NULL;
    return 0;
}

static void board_received(size_t count)
{
    (void)count;
}

/* Free places in the queue to the UART. */
static size_t board_line_room(void)
{
    return 0;
}

/* Queue bytes for the UART: switch the RS485 driver on before the first, off when the stop bit of the last has left. */
static void board_transmit(const uint8_t *bytes, size_t count)
{
    (void)bytes;
    (void)count;
}

static void board_show_led(unsigned motor, bool lit)
{
    (void)motor;
    (void)lit;
}

/* ---- Callbacks: what the unit asks of the board ------------------------------------------------------------------- */

/* Called from rkm04_advance at each pulse, up to 64 000 times a second with four motors. Must not block and should take less
 * than 5 us. BOARD: set the step pin of the motor; a one-shot timer clears it after RKM04_PULSE_TICKS (R7). The direction pin
 * has been right for 20 us. */
static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context, (void)tick, (void)motor, (void)position;
}

/* Called from rkm04_init, _advance and _receive when the direction changes, at most once a motion. Must not block, should take
 * less than 5 us. BOARD: write the direction pin, at once: the first pulse follows in 20 us or more. */
static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    (void)context, (void)tick, (void)motor, (void)forward;
}

/* Called from rkm04_advance and _receive when DO change, at most a few times a slot. Must not block, should take less than
 * 5 us. BOARD: write all eight pins. */
static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    struct board *board = context;
    (void)tick;
    board->outputs = mask;
}

/* Called from rkm04_init, _advance and _receive at each command, motion, change of LED and fault. Must not block. For traces
 * only: a board that writes none leaves `event` NULL in the port below and saves the calls. */
static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    (void)context, (void)tick, (void)motor, (void)what, (void)value;
}

/* The flash: 8 blocks of 4096 bytes. If the chip's pages are smaller, a block is some of them; if they are larger, use one page
 * a block and leave the rest of it alone.
 *
 * Called from rkm04_init (all four slots) and from rkm04_receive (Store Flash). May block, some microseconds. Returns 0, or 1
 * if the bytes cannot be read; what an ECC of the chip refuses counts as that, and must not end in a trap. */
static int on_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context, (void)block, (void)offset;
    for (unsigned i = 0; i < length; i++)
        ((uint8_t *)data)[i] = 0xff; /* BOARD: copy from the chip; until then the flash reads as erased */
    return 0;
}

/* Called from rkm04_receive on Store Flash, once a motor. May block, typically 20..100 ms: motors that are moving stand still
 * for so long and catch up afterwards, unless pulses come from a queue as described above. Returns 0 when all bytes of the block
 * read FF, 1 if the chip reports an error. */
static int on_flash_erase(void *context, unsigned block)
{
    (void)context, (void)block;
    return 1; /* BOARD: until then Store Flash answers that the write failed */
}

/* Called from rkm04_receive on Store Flash, up to 45 times a motor with at most 80 bytes. offset and length are multiples of 8,
 * no byte is programmed twice between two erases. May block, typically 1 ms. Returns 0 when the bytes are in the chip (not in
 * a cache), 1 if it reports an error. */
static int on_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context, (void)block, (void)offset, (void)data, (void)length;
    return 1; /* BOARD */
}

static const struct rkm04_port port = {
    .step = on_step,
    .direction = on_direction,
    .outputs = on_outputs,
    .event = on_event,
    .flash_read = on_flash_read,
    .flash_erase = on_flash_erase,
    .flash_program = on_flash_program,
};

/* ---- Main loop ------------------------------------------------------------------------------------------------------ */

#define LED_TICKS 10000u /* how often the LEDs are checked */

static struct rkm04_unit unit;
static struct board board;

/* Offer what has come in. What the unit does not take, because an answer is still going out (P10), stays in the queue. */
static void receive(void)
{
    const uint8_t *bytes;
    size_t count = board_poll_line(&bytes);
    if (count > 0)
        board_received(rkm04_receive(&unit, bytes, count));
}

/* Fetch as much of the answer as the queue to the UART has room for. */
static void transmit(void)
{
    uint8_t bytes[16];
    size_t room = board_line_room();
    size_t count = rkm04_send(&unit, bytes, room < sizeof bytes ? room : sizeof bytes);
    if (count > 0)
        board_transmit(bytes, count);
}

static void show_leds(void)
{
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        struct rkm04_motor_state state;
        if (rkm04_motor_state(&unit, motor, &state))
            board_show_led(motor, state.lit);
    }
}

/* Nothing is due before the next event: the processor may sleep until that tick is over. */
static void sleep_until_next(uint64_t now)
{
    uint64_t next = rkm04_next_event(&unit), latest = now + LED_TICKS;
    board_sleep_until(next < latest ? next + 1 : latest, rkm04_sending(&unit));
}

/* Readings other than the defaults (docs/READINGS.md), members of struct rkm04_readings, as in
 * -DBOARD_READINGS='.hold_exit = RKM04_HOLD_EXIT_LATCH, .planning = 20'. */
#ifndef BOARD_READINGS
#define BOARD_READINGS .label = RKM04_LABEL_WAIT
#endif

int main(void)
{
    board_start(&board);
    const struct rkm04_config config = {.node = (uint8_t)(board_switch() + 1), .readings = {BOARD_READINGS}};
    rkm04_init(&unit, &config, &port, &board);
    for (;;) {
        uint64_t now = board_clock();
        rkm04_advance(&unit, now - rkm04_now(&unit)); /* all ticks before this one */
        rkm04_set_inputs(&unit, board_inputs());
        receive();
        transmit();
        show_leds();
        sleep_until_next(now);
    }
}
