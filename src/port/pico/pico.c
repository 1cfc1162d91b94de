/* SPDX-License-Identifier: MIT */
/* pico.c: pins, pulses, line and clock of the Pico. Pulses come from the PIO: a state machine a motor gets a word a pulse, which
 * says how long after the one before it comes; one more shifts out DO and LEDs. So no interrupt can delay a pulse. */
#include "board.h"

#include <rkm04/limits.h>

#include "clock.h"
#include "cortex.h"
#include "feed.h"
#include "line.h"
#include "pins.h"
#include "rp2040.h"
#include "wake.h"

#define BEAT 200u /* us */
#define START 50u /* us from the start of the PIO to tick 0 */

enum { /* docs/PICO.md draws them */
    PIN_TX = 0, PIN_RX, PIN_DRIVER,        /* RS485; driver-enable high */
    PIN_DATA = 3, PIN_CLOCK, PIN_LATCH,    /* two 74HC595: DO 01-08, LEDs 1-4 */
    PIN_STEP = 6,                          /* step of motor 1, direction of motor 1, step of motor 2, ... */
    PIN_INPUTS = 14,                       /* DI 01-08; current pulls them low */
    PIN_SWITCH_1 = 22, PIN_SWITCH_2 = 26,  /* S1-1; S1-2 to S1-4. Closed pulls them low. */
    PIN_BOARD_LED = 25                     /* of the Pico itself: one of the LEDs is lit */
};

/* Of a motor, 1 cycle = 1 us. A word: bits 0-23 x, 24 step, 25 direction. The pins change x + 3 after its begin, it takes
 * x + 14. */
static const uint16_t motor_program[] = {
    0x80a0, /*    pull block       */
    0x6038, /*    out x, 24        */
    0x0042, /* 2: jmp x-- 2        */
    0x6902, /*    out pins, 2 [9]  */
    0xe000, /*    set pins, 0      */
};

/* Of the 74HC595, 5 cycles = 1 us. A word: bits 16-31 what is shifted, the highest first, 0-15 x. The latch comes x + 36 after
 * its begin, it takes x + 38. */
static const uint16_t shift_program[] = {
    0x80a0, /*    pull block       side 0 (clock) */
    0xe04f, /*    set y, 15        side 0 */
    0x6001, /* 2: out pins, 1      side 0 */
    0x1082, /*    jmp y-- 2        side 1 */
    0x6030, /*    out x, 16        side 0 */
    0x0045, /* 5: jmp x-- 5        side 0 */
    0xe001, /*    set pins, 1      side 0 (latch) */
    0xe000, /*    set pins, 0      side 0 */
};

#define LENGTH(array) (sizeof(array) / sizeof *(array))
#define SET_OUTPUTS 0xe087u /* set pindirs, 7 */

static void start_machine(struct pio *pio, unsigned machine, uint32_t divider, unsigned wrap, uint32_t shift, uint32_t outputs,
                          uint32_t pins)
{
    pio->machine[machine].clkdiv = divider << 16;
    pio->machine[machine].execctrl = wrap << 12;
    pio->machine[machine].shiftctrl = 1u << 30 | shift; /* the receive queue is joined to the transmit queue */
    pio->machine[machine].pinctrl = outputs;
    pio->machine[machine].instr = SET_OUTPUTS;
    pio->machine[machine].pinctrl = pins;
}

static void start_pio(void)
{
    for (unsigned i = 0; i < LENGTH(motor_program); i++)
        PIO0->program[i] = motor_program[i];
    for (unsigned i = 0; i < LENGTH(shift_program); i++)
        PIO1->program[i] = shift_program[i];
    for (unsigned i = 0; i < RKM04_MOTORS; i++) { /* out and set from `step` on; shifts right */
        uint32_t step = PIN_STEP + 2 * i;
        start_machine(PIO0, i, 125, LENGTH(motor_program) - 1, 1u << 19, 2u << 26 | step << 5,
                      1u << 26 | 2u << 20 | step << 5 | step);
    }
    start_machine(PIO1, 0, 25, LENGTH(shift_program) - 1, 0, 3u << 26 | PIN_DATA << 5,
                  1u << 29 | 1u << 26 | 1u << 20 | PIN_CLOCK << 10 | PIN_LATCH << 5 | PIN_DATA);
}

static const struct feed_timing motor_timing = {.apart = PULSES_SETTLE, .rest = 11}, shift_timing = {.apart = 8, .rest = 0};

unsigned board_feed_room(unsigned lane)
{
    return 8 - (lane == 0 ? PIO_LEVEL(PIO1, 0) : PIO_LEVEL(PIO0, lane - 1));
}

void board_feed_give(unsigned lane, uint32_t after, uint32_t levels)
{
    if (lane == 0)
        PIO1->txf[0] = levels << 16 | (after * 5 - 38);
    else
        PIO0->txf[lane - 1] = levels << 24 | (after - 14);
}

/* ---- Time ------------------------------------------------------------------------------------------------------------- */

static uint32_t began; /* TIMER_NOW at tick 0 */
static uint32_t next_beat;   /* of TIMER_NOW */
static uint32_t inputs_seen; /* by the main loop */
static uint64_t time;

uint64_t board_clock(void)
{
    return clock_extend(&time, TIMER_NOW - began);
}

static void set_pin(unsigned pin, bool high)
{
    *(high ? &SIO_OUT_SET : &SIO_OUT_CLEAR) = 1u << pin;
}

static void serve_line(void)
{
    uint8_t byte;
    while (!(UART0->flags & UART_RX_EMPTY) && line_has_room()) {
        uint32_t came = UART0->data;
        if (!(came & UART_WRONG))
            line_came((uint8_t)came);
    }
    set_pin(PIN_DRIVER, line_drives(!(UART0->flags & UART_BUSY)));
    while (!(UART0->flags & UART_TX_FULL) && line_next(&byte))
        UART0->data = byte;
}

/* Every BEAT us: the PIO and the UART get and give what there is. */
static void beat_interrupt(void)
{
    uint32_t now = TIMER_NOW;
    TIMER_INTR = 1;
    next_beat += BEAT;
    if ((int32_t)(next_beat - now) < (int32_t)BEAT / 2)
        next_beat = now + BEAT; /* a debugger has halted it: an alarm in the past would come in 71 minutes */
    TIMER_ALARM0 = next_beat;
    for (unsigned lane = 0; lane < PULSES_LANES; lane++)
        feed(lane, lane == 0 ? &shift_timing : &motor_timing, now - began);
    serve_line();
    if ((SIO_IN ^ inputs_seen) & PINS(PIN_INPUTS, RKM04_INPUTS))
        wake_changed();
    wake_check(now - began);
}

INTERRUPTS interrupts[] = {[IRQ_TIMER0] = beat_interrupt};

void board_clock_start(void)
{
    interrupts_off();
    for (unsigned lane = 0; lane < PULSES_LANES; lane++) {
        uint32_t rest = lane == 0 ? shift_timing.rest : motor_timing.rest; /* as if a word had just ended */
        feed_start(lane, 0u - START / 2);
        board_feed_give(lane, START / 2 + rest, 0);
    }
    for (began = TIMER_NOW; TIMER_NOW == began;)
        ;
    PIO0->ctrl = 0xfffu; /* all four: begin anew, divider too, run */
    PIO1->ctrl = 0x111u;
    began = TIMER_NOW + START;
    next_beat = began - START;
    beat_interrupt(); /* before the words given run out */
    TIMER_INTE = 1;
    NVIC_ENABLE[0] = 1u << IRQ_TIMER0;
    while ((int32_t)(TIMER_NOW - began) < 0)
        ;
    interrupts_on();
}

void board_play(uint32_t wake)
{
    interrupts_off();
    wake_at(wake);
    interrupts_on();
}

/* ---- Pins ------------------------------------------------------------------------------------------------------------- */

void board_line(void) {} /* the beat looks */

uint8_t board_inputs(void)
{
    wake_clear();
    inputs_seen = SIO_IN;
    return pins_read(inputs_seen, PIN_INPUTS, RKM04_INPUTS, true);
}

uint8_t board_switch(void)
{
    uint32_t levels = SIO_IN;
    return (uint8_t)(pins_read(levels, PIN_SWITCH_1, 1, true) | pins_read(levels, PIN_SWITCH_2, 3, true) << 1);
}

/* The next word of DO takes it along. */
void board_led(unsigned motor, bool lit)
{
    interrupts_off();
    feed_levels(0x100u << (motor - 1), pins_with(0, motor + 8, lit));
    set_pin(PIN_BOARD_LED, feed_level() & 0xf00);
    interrupts_on();
}

/* Outputs first become outputs: no pull-up raises them before. */
static void use_pins(unsigned first, unsigned count, uint32_t function)
{
    for (unsigned pin = first; pin < first + count; pin++) {
        IO_CTRL(pin) = function;
        PAD(pin) = PAD_UP;
    }
}

void board_start(void)
{
    clocks_start();
    SIO_OE_SET = 1u << PIN_DRIVER | 1u << PIN_BOARD_LED; /* at 0 */
    use_pins(PIN_TX, 2, FUNCTION_UART);
    use_pins(PIN_DRIVER, 1, FUNCTION_SIO);
    use_pins(PIN_INPUTS, RKM04_INPUTS + 1, FUNCTION_SIO); /* and S1-1 */
    use_pins(PIN_BOARD_LED, 4, FUNCTION_SIO);             /* and S1-2 to S1-4 */
    start_pio();
    use_pins(PIN_DATA, 3, FUNCTION_PIO1);
    use_pins(PIN_STEP, 2 * RKM04_MOTORS, FUNCTION_PIO0);
    UART0->ibrd = 406; /* 125 MHz / 16 / 19200 = 406 + 58 / 64 */
    UART0->fbrd = 58;
    UART0->line = 3u << 5 | 1u << 4; /* 8 bits, queues */
    UART0->control = 1u << 9 | 1u << 8 | 1u;
    pulses_start(&board_pulses, 0);
}
