/* SPDX-License-Identifier: MIT */
/* clocks.c: the clocks of the STM32F405. */
#include "board.h"
#include "stm32f405.h"

#define PATIENCE 200000u /* turns of a loop at 16 MHz: more than 50 ms; a crystal takes 2 ms, the PLL 0.3 ms */

bool emulated;

/* Do these bits of the register come to these values? */
static bool comes(const volatile uint32_t *state, uint32_t bits, uint32_t value)
{
    for (uint32_t turn = 0; turn < PATIENCE; turn++)
        if ((*state & bits) == value)
            return true;
    return false;
}

/* Crystal / its MHz * 336 / 2 = 168 MHz (7.2.3), half of it for APB2, a quarter for APB1, whose timers have twice that (7.2).
 * Without a crystal it is the chip's own oscillator of 16 MHz, 1 % exact. */
void clocks_start(void)
{
    emulated = RCC_CR == 0; /* after a reset of the chip its own oscillator is on: not 0 */
    RCC_AHB1ENR |= RCC_GPIOA | RCC_GPIOB | RCC_GPIOC;
    RCC_APB1ENR |= RCC_TIM2;
    RCC_APB2ENR |= RCC_USART1 | RCC_SYSCFG;
    if (emulated)
        return;
    RCC_CR |= RCC_HSE_ON;
    bool crystal = comes(&RCC_CR, RCC_HSE_READY, RCC_HSE_READY);
    RCC_PLLCFGR = 2u << 28 | 7u << 24 | (crystal ? 1u << 22 : 0u) | 336u << 6 | (crystal ? BOARD_CRYSTAL : 16u);
    RCC_CR |= RCC_PLL_ON;
    FLASH->acr = 5; /* wait states at 168 MHz, 3.5.1; the caches are off: everything runs in RAM */
    bool started = comes(&RCC_CR, RCC_PLL_READY, RCC_PLL_READY) && comes(&FLASH->acr, 7, 5);
    RCC_CFGR = 4u << 13 | 5u << 10 | 2u; /* APB2 / 2, APB1 / 4, the PLL */
    if (!started || !comes(&RCC_CFGR, 3u << 2, 2u << 2))
        board_reset();
}
