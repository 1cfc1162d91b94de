/* SPDX-License-Identifier: MIT */
/* stm32f405.h: the registers used of the STM32F405. Sections are those of its reference manual, ST RM0090. */
#ifndef STM32F405_H
#define STM32F405_H

#include <stdbool.h>
#include <stdint.h>

#define REGISTER(address) (*(volatile uint32_t *)(address))

/* 3.9: flash. Keys that unlock its control register: 3.6.1. */
struct stm32_flash {
    volatile uint32_t acr, key, option_key, sr, cr;
};
#define FLASH ((struct stm32_flash *)0x40023c00)
#define FLASH_KEY1 0x45670123u
#define FLASH_KEY2 0xcdef89abu
enum { FLASH_WRONG = 0xf2, FLASH_BUSY = 1 << 16 }; /* sr; WRONG: all errors, write 1 to clear */
enum { FLASH_PROGRAM = 1, FLASH_ERASE = 2, FLASH_WORDS = 2 << 8, FLASH_START = 1 << 16 }; /* cr; WORDS: from 2.7 V on, 3.6.2 */
#define FLASH_SECTOR(number) ((uint32_t)(number) << 3)
#define FLASH_LOCK (1u << 31)

/* 7.3: clocks and resets. */
#define RCC_CR REGISTER(0x40023800)
#define RCC_PLLCFGR REGISTER(0x40023804)
#define RCC_CFGR REGISTER(0x40023808)
#define RCC_AHB1ENR REGISTER(0x40023830)
#define RCC_APB1ENR REGISTER(0x40023840)
#define RCC_APB2ENR REGISTER(0x40023844)
enum { RCC_HSE_ON = 1 << 16, RCC_HSE_READY = 1 << 17, RCC_PLL_ON = 1 << 24, RCC_PLL_READY = 1 << 25 }; /* CR */
enum { RCC_GPIOA = 1, RCC_GPIOB = 2, RCC_GPIOC = 4 };                                                /* AHB1ENR */
enum { RCC_TIM2 = 1 };                                                                               /* APB1ENR */
enum { RCC_USART1 = 1 << 4, RCC_SYSCFG = 1 << 14 };                                                  /* APB2ENR */

/* 8.4: pins. bsrr sets by its lower half and clears by its upper, in one access. */
struct stm32_gpio {
    volatile uint32_t moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afr[2];
};
#define GPIOA ((struct stm32_gpio *)0x40020000)
#define GPIOB ((struct stm32_gpio *)0x40020400)
#define GPIOC ((struct stm32_gpio *)0x40020800)

/* 9.2.3: which port an EXTI line belongs to. 12.3: EXTI. */
#define SYSCFG_EXTICR ((volatile uint32_t *)0x40013808)
struct stm32_exti {
    volatile uint32_t imr, emr, rtsr, ftsr, swier, pr;
};
#define EXTI ((struct stm32_exti *)0x40013c00)

/* 18.4: TIM2, a counter of 32 bits with four compare registers. */
struct stm32_tim {
    volatile uint32_t cr1, cr2, smcr, dier, sr, egr, ccmr1, ccmr2, ccer, cnt, psc, arr, unused, ccr1;
};
#define TIM2 ((struct stm32_tim *)0x40000000)
enum { TIM_ON = 1, TIM_UPDATE = 1, TIM_COMPARE1 = 2 }; /* cr1; egr; dier and sr */

/* 30.6: USART1. */
struct stm32_usart {
    volatile uint32_t sr, dr, brr, cr1, cr2, cr3;
};
#define USART1 ((struct stm32_usart *)0x40011000)
enum { USART_WRONG = 1 << 0 | 1 << 1, USART_OVERRUN = 1 << 3, USART_RECEIVED = 1 << 5, USART_SENT = 1 << 6,
       USART_EMPTY = 1 << 7 }; /* sr; WRONG: parity, stop bit. SENT: the stop bit has left. EMPTY: takes a byte. */
enum { USART_ON = 1 << 13 | 1 << 5 | 1 << 3 | 1 << 2, USART_SENT_INTERRUPT = 1 << 6, USART_EMPTY_INTERRUPT = 1 << 7 }; /* cr1 */

/* 12.2: interrupts. */
enum { IRQ_EXTI0 = 6, IRQ_EXTI1, IRQ_EXTI2, IRQ_EXTI3, IRQ_EXTI4, IRQ_EXTI9_5 = 23, IRQ_TIM2 = 28, IRQ_USART1 = 37 };

/* MHz. 168 for the processor from a crystal of BOARD_CRYSTAL; TIM2 and USART1 have half of it. */
#define CLOCK_CPU 168u
#define CLOCK_TIM2 84u
#define CLOCK_USART1 84u
#ifndef BOARD_CRYSTAL
#define BOARD_CRYSTAL 8
#endif
_Static_assert(BOARD_CRYSTAL >= 4 && BOARD_CRYSTAL <= 26, "BOARD_CRYSTAL: expected 4 to 26 (MHz)");

/* clocks.c: all clocks; what is used gets one. */
void clocks_start(void);

/* Is this QEMU's netduinoplus2? It has no RCC, GPIO or flash to write, and its TIM2 counts at 1000 MHz and compares nothing. */
extern bool emulated;
#define CLOCK_TIM2_EMULATED 1000u

#endif
