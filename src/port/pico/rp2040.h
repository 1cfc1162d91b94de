/* SPDX-License-Identifier: MIT */
/* rp2040.h: the registers used of the RP2040. Sections are those of the "RP2040 Datasheet". */
#ifndef RP2040_H
#define RP2040_H

#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))
/* 2.1.2: writing to these copies of a register sets or clears bits of it, in one access. */
#define SET(address) REGISTER((address) + 0x2000u)
#define CLEAR(address) REGISTER((address) + 0x3000u)

/* 2.6.3: flash, as it is read through the cache and past it. */
#define XIP_BASE 0x10000000u
#define XIP_NOCACHE_NOALLOC_BASE 0x13000000u

/* 4.10.13: the serial interface to the flash. */
struct ssi {
    volatile uint32_t ctrlr0, ctrlr1, ssienr, mwcr, ser, baudr, unused[55], spi_ctrlr0;
};
#define SSI ((struct ssi *)0x18000000)

/* 2.8.3: addresses that the ROM holds: of its table of functions, and of the function that looks them up by two characters. */
extern const uint16_t rom_table, rom_lookup; /* of pico.ld */

/* 2.14.3: resets. */
#define RESETS_RESET 0x4000c000u
#define RESETS_DONE REGISTER(0x4000c008)
enum { RESET_IO = 1 << 5, RESET_PADS = 1 << 8, RESET_PIO0 = 1 << 10, RESET_PIO1 = 1 << 11, RESET_PLL_SYS = 1 << 12,
       RESET_TIMER = 1 << 21, RESET_UART0 = 1 << 22 };

/* 2.15.7: clocks. 2.16.7: crystal oscillator, 12 MHz on the Pico. 2.18.4: PLL. */
#define CLK_REF_CTRL REGISTER(0x40008030)
#define CLK_REF_SELECTED REGISTER(0x40008038)
#define CLK_SYS_CTRL REGISTER(0x4000803c)
#define CLK_SYS_SELECTED REGISTER(0x40008044)
#define CLK_PERI_CTRL REGISTER(0x40008048)
#define XOSC_CTRL REGISTER(0x40024000)
#define XOSC_STATUS REGISTER(0x40024004)
#define XOSC_STARTUP REGISTER(0x4002400c)
#define PLL_SYS_CS REGISTER(0x40028000)
#define PLL_SYS_PWR REGISTER(0x40028004)
#define PLL_SYS_FBDIV REGISTER(0x40028008)
#define PLL_SYS_PRIM REGISTER(0x4002800c)

/* 2.19.6: functions of the pins, pads. 2.3.1.7: SIO, the levels of all pins. */
#define IO_CTRL(pin) REGISTER(0x40014004u + 8u * (pin))
#define PAD(pin) REGISTER(0x4001c004u + 4u * (pin))
enum { FUNCTION_UART = 2, FUNCTION_SIO = 5, FUNCTION_PIO0 = 6, FUNCTION_PIO1 = 7 };
#define PAD_UP 0x5au /* input and trigger on, pull-up, 4 mA */
#define SIO_IN REGISTER(0xd0000004)
#define SIO_OUT_SET REGISTER(0xd0000014)
#define SIO_OUT_CLEAR REGISTER(0xd0000018)
#define SIO_OE_SET REGISTER(0xd0000024)

/* 3.7: a PIO block: programs of up to 32 instructions, four state machines. */
struct pio {
    volatile uint32_t ctrl, fstat, fdebug, flevel, txf[4], rxf[4], irq, irq_force, bypass, padout, padoe, info, program[32];
    struct {
        volatile uint32_t clkdiv, execctrl, shiftctrl, addr, instr, pinctrl;
    } machine[4];
};
#define PIO0 ((struct pio *)0x50200000)
#define PIO1 ((struct pio *)0x50300000)
#define PIO_LEVEL(pio, machine) ((pio)->flevel >> 8 * (machine) & 0xf) /* of its transmit queue */

/* 4.2.8: UART0, a PL011 with queues of 32 bytes each way. */
struct uart {
    volatile uint32_t data, rsr, unused[4], flags, unused2, ilpr, ibrd, fbrd, line, control;
};
#define UART0 ((struct uart *)0x40034000)
enum { UART_BUSY = 1 << 3, UART_RX_EMPTY = 1 << 4, UART_TX_FULL = 1 << 5 }; /* flags */
#define UART_WRONG 0x700u /* data: a break, parity or stop bit */

/* 4.6.5: the timer counts microseconds; an alarm comes when its low word is reached. 4.7.6: the watchdog makes its tick. */
#define TIMER_ALARM0 REGISTER(0x40054010)
#define TIMER_NOW REGISTER(0x40054028)
#define TIMER_INTR REGISTER(0x40054034)
#define TIMER_INTE REGISTER(0x40054038)
#define WATCHDOG_TICK REGISTER(0x4005802c)
#define WATCHDOG_CTRL REGISTER(0x40058000)
#define PSM_WDSEL REGISTER(0x40010008) /* 2.13.5: what the watchdog resets */

#define IRQ_TIMER0 0u /* 2.3.2 */

/* clocks.c: 125 MHz for processor, peripherals and PIO, microseconds for the timer; what is used comes out of its reset. */
void clocks_start(void);

#endif
