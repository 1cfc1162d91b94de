/* SPDX-License-Identifier: MIT */
#include "board.h"

#include <rkm04/limits.h>

#include "clock.h"
#include "flash.h"
#include "line.h"
#include "mps2.h"
#include "pins.h"
#include "wake.h"

/* ---- Pins ----------------------------------------------------------------------------------------------------------- */

static void set_step(unsigned motor, bool on)
{
    unsigned bit = 1u << (motor - 1);
    MPS2_GPIO0->low[bit] = on ? bit : 0;
}

static void set_direction(unsigned motor, bool forward)
{
    unsigned bit = 1u << (motor + 3);
    MPS2_GPIO0->low[bit] = forward ? bit : 0;
}

static void set_outputs(uint8_t mask)
{
    MPS2_GPIO1->low[0xff] = mask;
}

const struct pulse_pins board_pins = {.step = set_step, .direction = set_direction, .outputs = set_outputs};

void board_driver(bool on)
{
    MPS2_GPIO0->high[1u << (BOARD_DRIVER_PIN - 8)] = on ? 1u << BOARD_DRIVER_PIN : 0;
}

/* Have a change of an input interrupt: pins at 1 when they go to 0, and the other way round. */
static uint8_t read_pins(volatile struct mps2_gpio *gpio, unsigned first, unsigned count)
{
    const uint32_t pins = PINS(first, count), levels = gpio->data;
    gpio->high_level_clear = pins & levels;
    gpio->high_level_set = pins & ~levels;
    gpio->interrupt_set = pins;
    return pins_read(levels, first, count, false);
}

uint8_t board_inputs(void)
{
    wake_clear();
    return read_pins(MPS2_GPIO1, BOARD_INPUT_PIN, RKM04_INPUTS);
}

uint8_t board_more_inputs(void)
{
    return read_pins(MPS2_GPIO0, BOARD_MORE_PIN, BOARD_MORE_INPUTS);
}

/* The pin stays as it is, so no more interrupts until the main loop has looked; it filters bounces by being slower. */
void board_input_interrupt(void)
{
    MPS2_GPIO1->interrupt_clear = PINS(BOARD_INPUT_PIN, RKM04_INPUTS);
    MPS2_GPIO0->interrupt_clear = PINS(BOARD_MORE_PIN, BOARD_MORE_INPUTS);
    wake_changed();
}

uint8_t board_switch(void)
{
    return pins_read(MPS2_SWITCHES, 0, 4, false);
}

void board_led(unsigned motor, bool lit)
{
    MPS2_LEDS = pins_with(MPS2_LEDS, motor, lit);
}

/* ---- Time ------------------------------------------------------------------------------------------------------------- */

static uint64_t clock;

void board_clock_start(void)
{
    clock = 0;
    MPS2_COUNTER = 0;
}

uint64_t board_clock(void)
{
    return clock_extend(&clock, MPS2_COUNTER);
}

/* Have the timer run out once, `ticks` from now. What is longer than it can count is cut: the interrupt then looks and arms it
 * again. */
static inline void arm(uint32_t ticks)
{
    const uint32_t longest = UINT32_MAX / BOARD_TICK_CYCLES;
    MPS2_TIMER0->value = (ticks < longest ? ticks : longest) * BOARD_TICK_CYCLES;
}

void board_timer_interrupt(void)
{
    uint32_t next, now, far;
    int32_t left;
    MPS2_TIMER0->interrupt = 1;
    do {
        now = MPS2_COUNTER;
        wake_check(now);
        far = wake_tick(now + PULSES_FAR);
        next = pulses_play(&board_pulses, &board_pins, now, far);
        left = (int32_t)(next - MPS2_COUNTER);
    } while (left <= 0);
    arm((uint32_t)left);
}

void board_play(uint32_t wake)
{
    interrupts_off();
    pulses_refresh(&board_pulses);
    wake_at(wake);
    NVIC_PEND[0] = 1u << IRQ_TIMER0;
    interrupts_on();
}

void board_reset(void)
{
    SCB_AIRCR = AIRCR_RESET;
}

void board_start(void)
{
    MPS2_PRESCALE = BOARD_TICK_CYCLES - 1;
    MPS2_GPIO0->low[0xff] = 0;
    MPS2_GPIO0->high[0xff] = 0;
    MPS2_GPIO1->low[0xff] = 0;
    MPS2_GPIO0->enable_set = 0x1ff;
    MPS2_GPIO1->enable_set = 0xff;
    MPS2_LEDS = 0;
    board_clock_start();
    pulses_start(&board_pulses, 0);
    MPS2_TIMER0->reload = 0;
    MPS2_TIMER0->value = UINT32_MAX; /* until board_play */
    MPS2_TIMER0->control = TIMER_ON;
    NVIC_PRIORITY[IRQ_TIMER0] = BOARD_PRIORITY_PULSES;
    NVIC_PRIORITY[IRQ_GPIO0] = NVIC_PRIORITY[IRQ_GPIO1] = BOARD_PRIORITY_INPUTS;
    NVIC_ENABLE[0] = 1u << IRQ_TIMER0 | 1u << IRQ_GPIO0 | 1u << IRQ_GPIO1;
    uart_start();
    flash_start();
}

/* ---- Flash: memory that stands for it --------------------------------------------------------------------------------- */

int board_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    return flash_read(context, block, offset, data, length);
}

int board_flash_erase(void *context, unsigned block)
{
    return flash_erase(context, block);
}

int board_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    return flash_program(context, block, offset, data, length);
}

INTERRUPTS interrupts[] = {
    [IRQ_UART0_RECEIVE] = uart_receive_interrupt, [IRQ_UART0_SENT] = uart_sent_interrupt,
    [IRQ_GPIO0] = board_input_interrupt, [IRQ_GPIO1] = board_input_interrupt,
    [IRQ_TIMER0] = board_timer_interrupt, [IRQ_TIMER1] = uart_timer_interrupt,
};
