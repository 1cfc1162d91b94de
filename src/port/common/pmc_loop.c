/* SPDX-License-Identifier: MIT */
#include "pmc_loop.h"

#include "board.h"
#include "line.h"
#include "wake.h"

#define LEAST (BOARD_TICKS_AHEAD - 1000u) /* us: with so little left before the next event the unit is advanced again */
#define BACK_US 50000u                    /* how often the main loop comes back, at least */
#define TURN_US 1000u                     /* of the unit's time in one turn of the loop: the line's bytes do not wait longer */
#define BATCH 16u                         /* pulses handed to the interrupt together */

struct pmc_unit unit;
struct pulses board_pulses;

/* ---- Callbacks ------------------------------------------------------------------------------------------------------- */

/* us that the unit's time is behind the clock for good. */
static uint64_t behind;

/* The us of the clock at which a tick of the unit is due; of 32 bits, as pulses.h has them. */
static uint32_t due_at(uint64_t tick)
{
    return (uint32_t)(tick / PMC_TICKS_PER_US + behind);
}

/* A lane is full only when the board has fallen far behind: then wait for the interrupt. */
static void wait_for_room(unsigned lane, uint64_t tick)
{
    while (!pulses_room(&board_pulses, lane))
        board_play(due_at(tick));
}

static void put(unsigned lane, uint64_t tick, uint8_t item)
{
    wait_for_room(lane, tick);
    pulses_put(&board_pulses, lane, due_at(tick), item);
}

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)position, (void)forward;
    while (count > 0) {
        uint64_t at[BATCH];
        const size_t batch = count < BATCH ? count : BATCH;
        for (size_t i = 0; i < batch; i++)
            at[i] = tick[i] / PMC_TICKS_PER_US + behind;
        wait_for_room(axis + 1u, tick[0]);
        const size_t taken = pulses_put_steps(&board_pulses, axis + 1u, at, batch);
        tick += taken;
        count -= taken;
    }
}

static void on_direction(void *context, uint64_t tick, unsigned axis, bool forward)
{
    (void)context;
    put(axis + 1u, tick, forward ? PULSE_FORWARD : PULSE_BACK);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    put(0, tick, mask);
}

const struct pmc_port pmc_loop_port = {
    .steps = on_steps,
    .direction = on_direction,
    .outputs = on_outputs,
    .flash_read = board_flash_read,
    .flash_erase = board_flash_erase,
    .flash_program = board_flash_program,
};

/* ---- Loop ------------------------------------------------------------------------------------------------------------- */

static void receive(void)
{
    const uint8_t *bytes;
    size_t count = line_poll(&bytes), taken = unit.config.face->receive(&unit, bytes, count);
    line_take(taken);
    if (taken == count && count > 0) { /* the queue may continue at its beginning */
        count = line_poll(&bytes);
        line_take(unit.config.face->receive(&unit, bytes, count));
    }
}

static void transmit(void)
{
    uint8_t bytes[64];
    const size_t room = line_room();
    const size_t count = unit.config.face->send(&unit, bytes, room < sizeof bytes ? room : sizeof bytes);
    if (count > 0)
        line_send(bytes, count);
}

/* X has bits 0 to 7 with emg, Y bits 8 to 14. */
static void read_inputs(void)
{
    const unsigned first = board_inputs(), second = unit.config.axes > 1 ? board_more_inputs() : 0;
    pmc_set_inputs(&unit, (uint16_t)(first | second << PMC_INPUT_SHIFT));
}

static uint64_t us_of(uint64_t tick)
{
    return tick == PMC_NEVER ? PMC_NEVER : tick / PMC_TICKS_PER_US + behind;
}

/* Bring the unit nearer to being BOARD_TICKS_AHEAD ahead of the clock. If it has fallen behind, its time stays behind: what it
 * caught up would be pulses faster than they are to come. Returns whether it is there. */
static bool advance(uint64_t now)
{
    uint64_t at = us_of(pmc_now(&unit));
    if (at < now) {
        behind += now - at;
        at = now;
    }
    const uint64_t left = now + BOARD_TICKS_AHEAD - at;
    pmc_advance(&unit, (left < TURN_US ? left : TURN_US) * PMC_TICKS_PER_US);
    return left <= TURN_US;
}

/* When the main loop has to be back, if nothing comes in. */
static uint64_t back_at(uint64_t now)
{
    const uint64_t next = us_of(pmc_next_event(&unit)), latest = now + BACK_US;
    return next < latest + LEAST ? next - LEAST : latest;
}

static void set_baud(void)
{
    static uint32_t baud = LINE_BAUD;
    if (unit.config.baud != baud && !unit.config.face->has_answer(&unit))
        board_baud(baud = unit.config.baud);
}

void pmc_loop_start(void)
{
    board_start();
    const struct pmc_config config = {
        .face = &BOARD_FACE, .axes = BOARD_AXES, .address = (uint8_t)(board_switch() + 1u), .baud = LINE_BAUD};
    pmc_init(&unit, &config, &pmc_loop_port, NULL);
    for (unsigned axis = 0; axis < BOARD_AXES; axis++)
        on_direction(NULL, 0, axis, true); /* as it is at power-up; the unit reports changes */
    read_inputs();
    pmc_advance(&unit, (uint64_t)BOARD_TICKS_AHEAD * PMC_TICKS_PER_US); /* programs from flash have their head start, too */
    board_clock_start();
}

void pmc_loop_turn(void)
{
    const uint64_t now = board_clock();
    const bool is_ahead = advance(now);
    read_inputs();
    receive();
    transmit();
    set_baud();
    board_play((uint32_t)back_at(now));
    if (is_ahead)
        wake_wait(unit.config.face->has_answer(&unit));
}
