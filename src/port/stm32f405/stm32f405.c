/* SPDX-License-Identifier: MIT */
/* stm32f405.c: pins, pulses, line and clock of an STM32F405. TIM2 counts microseconds; its compare register calls the interrupt
 * that plays the pulses, at the tick of the next one. */
#include "stm32f405.h"

#include <rkm04/limits.h>

#include "board.h"
#include "clock.h"
#include "cortex.h"
#include "flash.h"
#include "line.h"
#include "pins.h"
#include "wake.h"

/* docs/PORTING.md has the table. */
enum { PIN_STEP = 0, PIN_DIRECTION = 4 };                  /* GPIOA: motors 1-4 */
enum { PIN_DRIVER = 0, PIN_TX = 6, PIN_RX, PIN_OUTPUTS };  /* GPIOB: RS485, DO 01-08 */
enum { PIN_INPUTS = 0, PIN_SWITCH = 8 };                   /* GPIOC: DI 01-08, S1-1 to S1-4; current or closed: low */
static const struct {
    struct stm32_gpio *port;
    uint8_t pin;
} leds[] = {{GPIOA, 15}, {GPIOB, 4}, {GPIOB, 1}, {GPIOC, 12}}; /* motors 1-4 */

enum { PRIORITY_PULSES = 0x00, PRIORITY_LINE = 0x80, PRIORITY_INPUTS = 0xc0 };
enum { MODE_INPUT = 0, MODE_OUTPUT = 1, MODE_OTHER = 2 };

static void set_pin(struct stm32_gpio *port, unsigned pin, bool high)
{
    port->bsrr = 1u << (high ? pin : pin + 16);
}

/* Of the inputs. QEMU has none: nothing is wired there. */
static uint32_t levels(void)
{
    return emulated ? UINT32_MAX : GPIOC->idr;
}

/* ---- Pulses and time ---------------------------------------------------------------------------------------------------- */

static uint64_t time;

static void set_step(unsigned motor, bool on)
{
    set_pin(GPIOA, PIN_STEP + motor - 1, on);
}

static void set_direction(unsigned motor, bool forward)
{
    set_pin(GPIOA, PIN_DIRECTION + motor - 1, forward);
}

static void set_outputs(uint8_t mask)
{
    GPIOB->bsrr = (uint32_t)mask << PIN_OUTPUTS | (uint32_t)(uint8_t)~mask << (PIN_OUTPUTS + 16);
}

static const struct pulse_pins pins = {.step = set_step, .direction = set_direction, .outputs = set_outputs};

uint64_t board_clock(void)
{
    return clock_extend(&time, TIM2->cnt);
}

/* Not before: the compare matches at 0 already. */
void board_clock_start(void)
{
    TIM2->egr = TIM_UPDATE; /* counter and prescaler begin at 0 */
    time = 0;
    NVIC_ENABLE[0] = 1u << IRQ_TIM2;
}

static void timer_interrupt(void)
{
    uint32_t next, now;
    int32_t left;
    TIM2->sr = ~(uint32_t)TIM_COMPARE1;
    do {
        now = TIM2->cnt;
        wake_check(now);
        next = pulses_play(&board_pulses, &pins, now, wake_tick(now + PULSES_FAR));
        TIM2->ccr1 = next;
        left = (int32_t)(next - TIM2->cnt);
    } while (left <= 0);
    if (emulated)
        systick_start((uint32_t)left, CLOCK_CPU);
}

/* QEMU's TIM2 compares nothing: this stands in for it. */
void systick_interrupt(void)
{
    systick_stop();
    timer_interrupt();
}

void board_play(uint32_t wake)
{
    interrupts_off();
    pulses_refresh(&board_pulses);
    wake_at(wake);
    NVIC_PEND[0] = 1u << IRQ_TIM2;
    interrupts_on();
}

/* ---- Line --------------------------------------------------------------------------------------------------------------- */

#define LINE_BIT (1u << IRQ_USART1 % 32)

/* If there is no room the interrupt stays off until there is. */
static void receive(void)
{
    for (uint32_t state; (state = USART1->sr) & (USART_RECEIVED | USART_OVERRUN);) {
        if (!line_has_room()) {
            NVIC_DISABLE[IRQ_USART1 / 32] = LINE_BIT;
            return;
        }
        uint32_t byte = USART1->dr;
        if ((state & USART_RECEIVED) && !(state & USART_WRONG))
            line_came((uint8_t)byte);
    }
}

/* Next: when it takes another byte, or when the stop bit of the last one has left. */
static void transmit(void)
{
    uint8_t byte;
    bool full;
    set_pin(GPIOB, PIN_DRIVER, line_drives(false));
    while (!(full = !(USART1->sr & USART_EMPTY)) && line_next(&byte))
        USART1->dr = byte; /* SENT goes off, since sr has been read before (30.3.2) */
    bool drives = line_drives(USART1->sr & USART_SENT);
    set_pin(GPIOB, PIN_DRIVER, drives);
    USART1->cr1 = USART_ON | (full ? USART_EMPTY_INTERRUPT : drives ? USART_SENT_INTERRUPT : 0u);
}

static void line_interrupt(void)
{
    receive();
    transmit();
}

void board_line(void)
{
    NVIC_PEND[IRQ_USART1 / 32] = LINE_BIT;
    NVIC_ENABLE[IRQ_USART1 / 32] = LINE_BIT;
}

/* ---- Terminals ---------------------------------------------------------------------------------------------------------- */

/* No more of these interrupts until the main loop has looked: it filters bounces by being slower. */
static void input_interrupt(void)
{
    EXTI->imr = 0;
    EXTI->pr = PINS(PIN_INPUTS, RKM04_INPUTS);
    wake_changed();
}

uint8_t board_inputs(void)
{
    wake_clear();
    EXTI->pr = PINS(PIN_INPUTS, RKM04_INPUTS);
    EXTI->imr = PINS(PIN_INPUTS, RKM04_INPUTS);
    return pins_read(levels(), PIN_INPUTS, RKM04_INPUTS, true);
}

uint8_t board_switch(void)
{
#ifdef BOARD_NODE
    _Static_assert(BOARD_NODE >= 1 && BOARD_NODE <= 16, "BOARD_NODE: expected 1 to 16");
    return BOARD_NODE - 1;
#else
    return pins_read(levels(), PIN_SWITCH, 4, true);
#endif
}

void board_led(unsigned motor, bool lit)
{
    set_pin(leds[motor - 1].port, leds[motor - 1].pin, lit);
}

/* ---- Start -------------------------------------------------------------------------------------------------------------- */

static void use_pins(struct stm32_gpio *port, unsigned first, unsigned count, uint32_t mode, bool pull_up)
{
    for (unsigned pin = first; pin < first + count; pin++) {
        port->pupdr = (port->pupdr & ~(3u << 2 * pin)) | (pull_up ? 1u : 0u) << 2 * pin;
        port->moder = (port->moder & ~(3u << 2 * pin)) | mode << 2 * pin;
    }
}

static void start_pins(void)
{
    use_pins(GPIOA, PIN_STEP, 2 * RKM04_MOTORS, MODE_OUTPUT, false);
    GPIOB->afr[0] = (GPIOB->afr[0] & 0x00ffffffu) | 0x77000000u; /* USART1 at 6 and 7 */
    use_pins(GPIOB, PIN_DRIVER, 1, MODE_OUTPUT, false);
    use_pins(GPIOB, PIN_TX, 2, MODE_OTHER, true);
    use_pins(GPIOB, PIN_OUTPUTS, RKM04_OUTPUTS, MODE_OUTPUT, false);
    use_pins(GPIOC, PIN_INPUTS, RKM04_INPUTS, MODE_INPUT, true);
    use_pins(GPIOC, PIN_SWITCH, 4, MODE_INPUT, true);
    for (unsigned i = 0; i < RKM04_MOTORS; i++)
        use_pins(leds[i].port, leds[i].pin, 1, MODE_OUTPUT, false);
}

static void start_interrupts(void)
{
    static const uint8_t inputs[] = {IRQ_EXTI0, IRQ_EXTI1, IRQ_EXTI2, IRQ_EXTI3, IRQ_EXTI4, IRQ_EXTI9_5};
    SYSCFG_EXTICR[0] = SYSCFG_EXTICR[1] = 0x2222; /* GPIOC */
    EXTI->rtsr = EXTI->ftsr = PINS(PIN_INPUTS, RKM04_INPUTS);
    for (unsigned i = 0; i < sizeof inputs; i++) {
        NVIC_PRIORITY[inputs[i]] = PRIORITY_INPUTS;
        NVIC_ENABLE[0] = 1u << inputs[i];
    }
    NVIC_PRIORITY[IRQ_TIM2] = PRIORITY_PULSES;
    NVIC_PRIORITY[IRQ_USART1] = PRIORITY_LINE;
    NVIC_ENABLE[IRQ_USART1 / 32] = LINE_BIT;
}

void board_start(void)
{
    extern uint8_t vectors_begin[]; /* of stm32f405.ld */
    SCB_VTOR = (uint32_t)(uintptr_t)vectors_begin;
    clocks_start();
    start_pins();
    TIM2->psc = (emulated ? CLOCK_TIM2_EMULATED : CLOCK_TIM2) - 1;
    TIM2->arr = UINT32_MAX;
    TIM2->cr1 = TIM_ON;
    TIM2->dier = TIM_COMPARE1;
    pulses_start(&board_pulses, 0);
    USART1->brr = CLOCK_USART1 * 1000000u / LINE_BAUD; /* 4375, 30.3.4 */
    USART1->cr1 = USART_ON;
    start_interrupts();
    if (emulated)
        flash_start();
}

void board_reset(void)
{
    SCB_AIRCR = AIRCR_RESET;
}

INTERRUPTS interrupts[] = {
    [IRQ_EXTI0] = input_interrupt, [IRQ_EXTI1] = input_interrupt, [IRQ_EXTI2] = input_interrupt,
    [IRQ_EXTI3] = input_interrupt, [IRQ_EXTI4] = input_interrupt, [IRQ_EXTI9_5] = input_interrupt,
    [IRQ_TIM2] = timer_interrupt,  [IRQ_USART1] = line_interrupt,
};
