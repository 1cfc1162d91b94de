/* SPDX-License-Identifier: MIT */
/* port.c: an RKM04 on QEMU's RISC-V machine "virt", as small as a port can be. Pulses are sent from the main loop, so they come
 * late by what else it does; see mps2_an385 for pulses exact to the tick.
 *
 * The machine has no pins. What would be their registers is `pins` below. */
#include <rkm04/unit.h>

#include "flash.h"

/* ---- Clock, terminals, line ----------------------------------------------------------------------------------------- */

#define TIME ((volatile uint32_t *)0x0200bff8)    /* CLINT: 10 MHz, low and high word */
#define COMPARE ((volatile uint32_t *)0x02004000) /* interrupt when TIME reaches it */
#define CYCLES 10u                                /* in a tick */

#define UART ((volatile uint8_t *)0x10000000)     /* 16550, with queues of 16 bytes */
enum { UART_DATA, UART_INTERRUPTS, UART_QUEUES, UART_LINE, UART_MODEM, UART_STATE };
#define CAME 0x01u  /* state: a byte is there */
#define EMPTY 0x20u /* state: the queue to the line is empty */
#define GONE 0x40u  /* state: so is the shift register */
#define RTS 0x02u   /* modem: it switches the RS485 driver */

#define PLIC_PRIORITY ((volatile uint32_t *)0x0c000000)
#define PLIC_ENABLE (*(volatile uint32_t *)0x0c002000)
#define PLIC_CLAIM (*(volatile uint32_t *)0x0c200004)
#define UART_SOURCE 10u

struct pins {
    volatile uint32_t step, direction, outputs, leds; /* a bit each */
    volatile uint32_t pulses[RKM04_MOTORS];           /* pulses sent: a register that no real port has; for the tests */
};
struct pins pins;

static uint8_t line[16]; /* what came in and has not been taken */
static size_t in_line;

static uint64_t began; /* TIME at board_start: it does not begin at 0 after a reset */

static uint64_t board_time(void)
{
    uint32_t high, low;
    do {
        high = TIME[1];
        low = TIME[0];
    } while (high != TIME[1]);
    return (uint64_t)high << 32 | low;
}

static uint64_t board_clock(void)
{
    return (board_time() - began) / CYCLES;
}

static void board_start(void)
{
    UART[UART_LINE] = 0x80; /* 115200 / 6 = 19200 baud, 8N1 */
    UART[UART_DATA] = 6;
    UART[UART_INTERRUPTS] = 0;
    UART[UART_LINE] = 0x03;
    UART[UART_QUEUES] = 0x07;
    UART[UART_MODEM] = 0;
    PLIC_PRIORITY[UART_SOURCE] = 1;
    PLIC_ENABLE = 1u << UART_SOURCE;
    __asm__ volatile("csrw mie, %0" ::"r"(0x880)); /* WFI wakes for the timer and for the UART */
    flash_start();
    began = board_time();
}

/* Until this tick, a byte, or an empty queue to the line if there is `more` for it. While the driver is on, look often enough to
 * switch it off in time. */
static void board_sleep_until(uint64_t tick, bool more)
{
    if (in_line > 0 && !more)
        return; /* left over while an answer went out (P10) */
    bool driving = UART[UART_MODEM] & RTS;
    if (driving && (UART[UART_STATE] & GONE) && !more) {
        UART[UART_MODEM] = 0;
        driving = false;
    }
    uint64_t soon = board_clock() + 100;
    uint64_t compare = (driving && soon < tick ? soon : tick) * CYCLES + began;
    COMPARE[1] = UINT32_MAX; /* no alarm between the two halves */
    COMPARE[0] = (uint32_t)compare;
    COMPARE[1] = (uint32_t)(compare >> 32);
    UART[UART_INTERRUPTS] = (uint8_t)((in_line < sizeof line ? 1u : 0u) | (more ? 2u : 0u));
    __asm__ volatile("wfi" ::: "memory");
    uint32_t source = PLIC_CLAIM;
    if (source != 0)
        PLIC_CLAIM = source;
}

/* No terminals, no switch. */
static uint8_t board_inputs(void)
{
    return 0;
}

static uint8_t board_switch(void)
{
    return 0;
}

static size_t board_poll_line(const uint8_t **bytes)
{
    while (in_line < sizeof line && (UART[UART_STATE] & CAME))
        line[in_line++] = UART[UART_DATA];
    *bytes = line;
    return in_line;
}

static void board_received(size_t count)
{
    in_line -= count;
    for (size_t i = 0; i < in_line; i++)
        line[i] = line[i + count];
}

static size_t board_line_room(void)
{
    return UART[UART_STATE] & EMPTY ? 16 : 0;
}

static void board_transmit(const uint8_t *bytes, size_t count)
{
    UART[UART_MODEM] = RTS;
    for (size_t i = 0; i < count; i++)
        UART[UART_DATA] = bytes[i];
}

static void board_show_led(unsigned motor, bool lit)
{
    uint32_t bit = 1u << (motor - 1);
    pins.leds = lit ? pins.leds | bit : pins.leds & ~bit;
}

/* ---- Callbacks ---------------------------------------------------------------------------------------------------- */

/* No timer is left to end the pulse, so wait for it. */
static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context, (void)tick, (void)position;
    uint32_t bit = 1u << (motor - 1), from = TIME[0];
    pins.step |= bit;
    while (TIME[0] - from < RKM04_PULSE_TICKS * CYCLES)
        ;
    pins.step &= ~bit;
    pins.pulses[motor - 1]++;
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    (void)context, (void)tick;
    uint32_t bit = 1u << (motor - 1);
    pins.direction = forward ? pins.direction | bit : pins.direction & ~bit;
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context, (void)tick;
    pins.outputs = mask;
}

static const struct rkm04_port port = {
    .step = on_step,
    .direction = on_direction,
    .outputs = on_outputs,
    .flash_read = flash_read,
    .flash_erase = flash_erase,
    .flash_program = flash_program,
};

/* ---- Main loop ------------------------------------------------------------------------------------------------------ */

#define LED_TICKS 10000u /* how often the LEDs are checked */

static struct rkm04_unit unit;

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
    board_start();
    const struct rkm04_config config = {.node = (uint8_t)(board_switch() + 1), .readings = {BOARD_READINGS}};
    rkm04_init(&unit, &config, &port, NULL);
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
