/* SPDX-License-Identifier: MIT */
/* port.c: template of a port to a board. Copy the folder, fill in what says BOARD, and it is a unit. It compiles unchanged, and
 * does nothing.
 *
 * Build the core (the sources in src/), this file, and of ../common main.c, loop.c, wake.c, line.c, pulses.c and flash.c, all
 * with the same RKM04_MESSAGE_MAX; -DRKM04_MESSAGE_MAX=1024 makes a unit that fits 24 KiB of RAM. The core needs C11, memcpy
 * and its like, and nothing else: no heap, no clock, no interrupt. A Cortex-M takes ../common/cortex.c for its vectors, too.
 *
 * Who runs when: the unit runs in the main loop, ahead of the clock by BOARD_TICKS_AHEAD; rkm04_* are never called from an
 * interrupt. What it wants done at which tick waits in `board_pulses`; the interrupt of a timer does it, exactly then. Other
 * interrupts fill and empty the queues of the line. Inputs and requests act later by BOARD_TICKS_AHEAD.
 *
 * ../mps2_an385 is this filled in with a one-shot timer; ../pico has hardware that plays the pulses (../common/feed.h).
 * ../riscv_virt is as small as a port can be: its pulses come from the main loop. docs/PORTING.md goes through it step by
 * step. */
#include "board.h"

#include "clock.h"
#include "flash.h"
#include "line.h"
#include "pins.h"
#include "wake.h"

/* ---- Registers, as a board may have them ------------------------------------------------------------------------------ */

/* BOARD: these stand for registers of the chip. */
static volatile uint32_t counter;   /* counts microseconds, 32 bits */
static volatile uint32_t levels_in; /* levels of the pins that are inputs */
static volatile uint32_t levels_out;

enum { PIN_STEP = 0, PIN_DIRECTION = 4, PIN_OUTPUTS = 8, PIN_LEDS = 16, PIN_DRIVER = 20 }; /* of levels_out: BOARD */
enum { PIN_INPUTS = 0, PIN_SWITCH = 8 };                                                   /* of levels_in: BOARD */

static void set_pins(uint32_t of, uint32_t mask)
{
    levels_out = (levels_out & ~of) | mask; /* BOARD: in one access, since interrupts do so, too: set and clear registers */
}

/* ---- Time ------------------------------------------------------------------------------------------------------------- */

static uint32_t began; /* counter at tick 0: it need not begin at 0 after a reset */
static uint64_t time;

/* A timer that continues over a reset is read relative to its value here. */
void board_clock_start(void)
{
    began = counter;
    /* BOARD: the interrupts on, timer_interrupt first: what is due at tick 0 waits already. */
}

uint64_t board_clock(void)
{
    return clock_extend(&time, counter - began);
}

/* ---- Pulses ----------------------------------------------------------------------------------------------------------- */

static void set_step(unsigned motor, bool on)
{
    set_pins(pins_with(0, motor, true) << PIN_STEP, pins_with(0, motor, on) << PIN_STEP);
}

static void set_direction(unsigned motor, bool forward)
{
    set_pins(pins_with(0, motor, true) << PIN_DIRECTION, pins_with(0, motor, forward) << PIN_DIRECTION);
}

static void set_outputs(uint8_t mask)
{
    set_pins(PINS(PIN_OUTPUTS, 8), (uint32_t)mask << PIN_OUTPUTS);
}

static const struct pulse_pins pins = {.step = set_step, .direction = set_direction, .outputs = set_outputs};

/* BOARD: the interrupt of a one-shot timer or a compare register, with the highest priority: its latency is the jitter of the
 * pulses. */
void timer_interrupt(void);
void timer_interrupt(void)
{
    uint32_t now, next;
    do {
        now = counter - began;
        wake_check(now);
        next = pulses_play(&board_pulses, &pins, now, wake_tick(now + PULSES_FAR));
    } while ((int32_t)(next - (counter - began)) < 0);
    /* BOARD: have the timer interrupt again at tick `next`. */
}

void board_play(uint32_t wake)
{
    board_interrupts(false);
    pulses_refresh(&board_pulses);
    wake_at(wake);
    /* BOARD: set the timer's interrupt pending. */
    board_interrupts(true);
}

/* BOARD: interrupts of the processor, and its instruction that waits for one. ../common/cortex.c has them for a Cortex-M. */
void board_interrupts(bool on)
{
    (void)on;
}

void board_wait(void) {}

/* BOARD: a reset by software, for faults of the processor. */
void board_reset(void) {}

/* ---- Line ------------------------------------------------------------------------------------------------------------- */

/* BOARD: the UART's interrupt, below the timer's: a byte has 521 us. The RS485 driver is on before the first byte, and off when
 * the stop bit of the last has left: by an interrupt of the UART, or, where there is none, by a timer of one byte's time. */
void uart_interrupt(void);
void uart_interrupt(void)
{
    uint8_t byte;
    if (line_has_room())
        line_came(0); /* BOARD: if the UART has a byte, that byte; without room it stays there, with the interrupt off */
    set_pins(PINS(PIN_DRIVER, 1), line_drives(true) ? PINS(PIN_DRIVER, 1) : 0); /* BOARD: true when the UART is idle */
    if (line_next(&byte))
        (void)byte; /* BOARD: if the UART takes one, to the UART */
}

void board_line(void)
{
    /* BOARD: set the UART's interrupt pending. */
}

/* ---- Terminals -------------------------------------------------------------------------------------------------------- */

/* BOARD: an interrupt when an input changes; it filters bounces, since the unit takes what it gets. */
void input_interrupt(void);
void input_interrupt(void)
{
    wake_changed();
}

uint8_t board_inputs(void)
{
    wake_clear();
    return pins_read(levels_in, PIN_INPUTS, 8, false);
}

uint8_t board_switch(void)
{
    return pins_read(levels_in, PIN_SWITCH, 4, true); /* closed, a switch pulls its pin to ground */
}

void board_led(unsigned motor, bool lit)
{
    set_pins(pins_with(0, motor, true) << PIN_LEDS, pins_with(0, motor, lit) << PIN_LEDS);
}

/* ---- Flash ------------------------------------------------------------------------------------------------------------ */

/* 8 blocks of 4096 bytes. If the chip's pages are smaller, a block is some of them; if they are larger, use one page a block and
 * leave the rest of it alone. BOARD: until then it is RAM that behaves like flash (../common/flash.h).
 *
 * Read: called from rkm04_init (all four slots) and from rkm04_receive (Store Flash). May block, some microseconds. Returns 0, or
 * 1 if the bytes cannot be read; what an ECC of the chip refuses counts as that, and must not end in a trap. */
int board_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    return flash_read(context, block, offset, data, length);
}

/* Called from rkm04_receive on Store Flash, once a motor. May block, typically 20..100 ms: motors that are moving run out of
 * pulses after BOARD_TICKS_AHEAD, and catch up afterwards. Returns 0 when all bytes of the block read FF, 1 if the chip reports
 * an error. */
int board_flash_erase(void *context, unsigned block)
{
    return flash_erase(context, block);
}

/* Called from rkm04_receive on Store Flash, up to 45 times a motor with at most 80 bytes. offset and length are multiples of 8,
 * no byte is programmed twice between two erases. May block, typically 1 ms. Returns 0 when the bytes are in the chip (not in
 * a cache), 1 if it reports an error. */
int board_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    return flash_program(context, block, offset, data, length);
}

/* ---- Start ------------------------------------------------------------------------------------------------------------ */

void board_start(void)
{
    /* BOARD: clocks, pins (all outputs at 0), UART at 19200 8N1 (U7), RS485 driver off, a 1 MHz counter. */
    levels_out = 0;
    pulses_start(&board_pulses, 0);
    flash_start();
}
