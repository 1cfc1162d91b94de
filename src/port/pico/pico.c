/* SPDX-License-Identifier: MIT */
/* pico.c: pins, pulses, line and clock of the Pico. Pulses come from the PIO: a state machine a motor gets a word a pulse, which
 * says how long after the one before it comes; one more shifts out DO and LEDs. So no interrupt can delay a pulse. The beat
 * hands over what is due within a millisecond; where nothing is due it hands over words that only wait: a state machine that
 * never runs dry never loses its time. */
#include "board.h"

#include <rkm04/limits.h>

#include "clock.h"
#include "line.h"
#include "pico.h"
#include "pins.h"
#include "rp2040.h"

#define BEAT 200u     /* us */
#define WINDOW 1000   /* us: what is due so soon goes to the PIO */
#define START 50u     /* us from the start of the PIO to tick 0 */

/* ---- PIO -------------------------------------------------------------------------------------------------------------- */

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

/* What a lane of board_pulses has given to its state machine. */
static struct fed {
    uint32_t end;    /* tick at which the pins change by its last word */
    uint32_t levels; /* 0: DO, LEDs above; motors: direction in bit 1 */
} fed[PULSES_LANES];

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

/* A word for the lane: its pins change at `tick`. */
static inline void give(unsigned lane, uint32_t tick, uint32_t step)
{
    uint32_t after = tick - fed[lane].end;
    fed[lane].end = tick;
    if (lane == 0)
        PIO1->txf[0] = fed[0].levels << 16 | (after * 5 - 38);
    else
        PIO0->txf[lane - 1] = (fed[lane].levels | step) << 24 | (after - 14);
}

/* The item has been taken from the lane. Returns 1 if it is a step. */
static inline uint32_t apply(unsigned lane, uint32_t item)
{
    if (lane == 0)
        fed[0].levels = (fed[0].levels & 0xf00) | item;
    else if (item == PULSE_STEP)
        return 1;
    else
        fed[lane].levels = item == PULSE_FORWARD ? 2 : 0;
    return 0;
}

/* Fill the queue of the lane's state machine. */
static inline void feed(unsigned lane, uint32_t now)
{
    const struct pio *pio = lane == 0 ? PIO1 : PIO0;
    const uint32_t full = PIO_TX_FULL(lane == 0 ? 0 : lane - 1);
    const uint32_t apart = lane == 0 ? 8 : PULSES_SETTLE; /* if they are late; in time the unit sees to it */
    int32_t ahead = (int32_t)(fed[lane].end - now);
    uint32_t tick, step;
    uint8_t item;
    if (ahead < -11)
        fed[lane].end = now - 11; /* it has run dry, and begins with the next word */
    while (pulses_peek(&board_pulses, lane, &tick, &item) && (int32_t)(tick - now) < WINDOW) {
        if (pio->fstat & full)
            return;
        pulses_drop(&board_pulses, lane);
        step = apply(lane, item);
        for (uint32_t next; lane == 0 && pulses_peek(&board_pulses, 0, &next, &item) && next == tick;) {
            pulses_drop(&board_pulses, 0);
            (void)apply(0, item); /* all outputs of a tick at once */
        }
        uint32_t earliest = fed[lane].end + apart, late = earliest - tick;
        if ((int32_t)late > 0) {
            tick = earliest;
            board_pulses.latest = late > board_pulses.latest ? late : board_pulses.latest;
        }
        give(lane, tick, step);
    }
    if ((int32_t)(fed[lane].end - now) < WINDOW / 4 && !(pio->fstat & full))
        give(lane, now + WINDOW / 2, 0);
}

/* ---- Time ------------------------------------------------------------------------------------------------------------- */

static uint32_t began; /* TIMER_NOW at tick 0 */
static uint64_t time;
static uint32_t next_beat; /* of TIMER_NOW */
static uint32_t wake_tick; /* when the main loop wants to be woken */
static volatile bool awake;
static uint32_t inputs_seen; /* by the main loop */
static volatile bool changed; /* an input has, since then */

uint64_t board_clock(void)
{
    return clock_extend(&time, TIMER_NOW - began);
}

static void set_pin(unsigned pin, bool high)
{
    if (high)
        SIO_OUT_SET = 1u << pin;
    else
        SIO_OUT_CLEAR = 1u << pin;
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

void beat_interrupt(void)
{
    uint32_t now = TIMER_NOW;
    TIMER_INTR = 1;
    next_beat += BEAT;
    if ((int32_t)(next_beat - now) < (int32_t)BEAT / 2)
        next_beat = now + BEAT; /* a debugger has halted it: an alarm in the past would come in 71 minutes */
    TIMER_ALARM0 = next_beat;
    for (unsigned lane = 0; lane < PULSES_LANES; lane++)
        feed(lane, now - began);
    serve_line();
    if ((SIO_IN ^ inputs_seen) & PINS(PIN_INPUTS, RKM04_INPUTS))
        changed = true;
    if ((int32_t)(wake_tick - (now - began)) <= 0)
        awake = true;
}

void board_clock_start(void)
{
    interrupts_off();
    for (unsigned lane = 0; lane < PULSES_LANES; lane++) {
        fed[lane].end = 0u - START - (lane == 0 ? 0 : 11); /* as if a word had just ended */
        give(lane, 0u - START / 2, 0);
    }
    for (began = TIMER_NOW; TIMER_NOW == began;)
        ;
    PIO0->ctrl = 0xfffu; /* all four: begin anew, divider too, run */
    PIO1->ctrl = 0x111u;
    began = TIMER_NOW + START;
    next_beat = began - START;
    beat_interrupt(); /* before the words given run out */
    TIMER_INTE = 1;
    NVIC_ENABLE = 1u << IRQ_TIMER0;
    while ((int32_t)(TIMER_NOW - began) < 0)
        ;
    interrupts_on();
}

void board_play(uint32_t wake)
{
    interrupts_off();
    wake_tick = wake;
    awake = false;
    interrupts_on();
}

void board_sleep(bool more)
{
    interrupts_off(); /* or what comes between the look and the sleep would be slept through; WFI wakes all the same */
    while (!awake && !changed && !line_needs_main_loop(more)) {
        __asm__ volatile("wfi");
        interrupts_on();
        interrupts_off();
    }
    interrupts_on();
}

/* ---- Pins ------------------------------------------------------------------------------------------------------------- */

void board_line(void)
{
    /* The beat looks. */
}

uint8_t board_inputs(void)
{
    changed = false;
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
    fed[0].levels = pins_with(fed[0].levels, motor + 8, lit);
    set_pin(PIN_BOARD_LED, fed[0].levels & 0xf00);
    interrupts_on();
}

static void use_pins(unsigned first, unsigned count, uint32_t pad, uint32_t function)
{
    for (unsigned pin = first; pin < first + count; pin++) {
        PAD(pin) = pad;
        IO_CTRL(pin) = function;
    }
}

void board_start(void)
{
    SIO_OE_SET = 1u << PIN_DRIVER | 1u << PIN_BOARD_LED; /* at 0 */
    use_pins(PIN_TX, 1, PAD_OUT, FUNCTION_UART);
    use_pins(PIN_RX, 1, PAD_IN_UP, FUNCTION_UART);
    use_pins(PIN_DRIVER, 1, PAD_OUT, FUNCTION_SIO);
    use_pins(PIN_INPUTS, RKM04_INPUTS + 1, PAD_IN_UP, FUNCTION_SIO); /* and S1-1 */
    use_pins(PIN_SWITCH_2, 3, PAD_IN_UP, FUNCTION_SIO);
    use_pins(PIN_BOARD_LED, 1, PAD_OUT, FUNCTION_SIO);
    start_pio();
    use_pins(PIN_DATA, 3, PAD_OUT, FUNCTION_PIO1);
    use_pins(PIN_STEP, 2 * RKM04_MOTORS, PAD_OUT, FUNCTION_PIO0);
    UART0->ibrd = 406; /* 125 MHz / 16 / 19200 = 406 + 58 / 64 */
    UART0->fbrd = 58;
    UART0->line = 3u << 5 | 1u << 4; /* 8 bits, queues */
    UART0->control = 1u << 9 | 1u << 8 | 1u;
    pulses_start(&board_pulses, 0);
}
