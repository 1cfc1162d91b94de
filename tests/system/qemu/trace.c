/* SPDX-License-Identifier: MIT */
/* trace.c: linked into the firmware of src/port/stm32f405 for tests (make TRACE=...): what the board does with the unit and when
 * it plays pulses, as words written to a device that QEMU lacks, so that they are in its log between those written to the pins.
 * From the second serial port come two bytes each: `i' and the levels of the inputs, or `c' and the number of the operation of
 * the flash in whose middle the power fails, 1 for the next one, or `f' and anything: what interrupts and idleness have taken
 * is logged. See stm32.py. */
#include <string.h>

#include <rkm04/unit.h>

#include "cortex.h"
#include "pulses.h"
#include "stm32f405.h"

#define LOG ((volatile uint32_t *)0x50050000) /* DCMI */
enum { LOG_INIT, LOG_ADVANCE, LOG_BYTE, LOG_RECEIVE, LOG_INPUTS, LOG_SEND, LOG_PLAY, LOG_CUT, LOG_NOW, LOG_IDLE,
       LOG_INTERRUPTS, LOG_WORST };

#define TIM5 ((struct stm32_tim *)0x40000c00) /* counts ns here */
#define USART2 ((struct stm32_usart *)0x40004400)

/* The linker calls __wrap_f for f, and f for __real_f. */
void __real_rkm04_init(struct rkm04_unit *, const struct rkm04_config *, const struct rkm04_port *, void *);
void __wrap_rkm04_init(struct rkm04_unit *, const struct rkm04_config *, const struct rkm04_port *, void *);
void __real_rkm04_advance(struct rkm04_unit *, uint64_t);
void __wrap_rkm04_advance(struct rkm04_unit *, uint64_t);
size_t __real_rkm04_receive(struct rkm04_unit *, const uint8_t *, size_t);
size_t __wrap_rkm04_receive(struct rkm04_unit *, const uint8_t *, size_t);
void __real_rkm04_set_inputs(struct rkm04_unit *, uint8_t);
void __wrap_rkm04_set_inputs(struct rkm04_unit *, uint8_t);
size_t __real_rkm04_send(struct rkm04_unit *, uint8_t *, size_t);
size_t __wrap_rkm04_send(struct rkm04_unit *, uint8_t *, size_t);
void __real_pulses_start(struct pulses *, uint32_t);
void __wrap_pulses_start(struct pulses *, uint32_t);
uint32_t __real_pulses_play(struct pulses *, const struct pulse_pins *, uint32_t, uint32_t);
uint32_t __wrap_pulses_play(struct pulses *, const struct pulse_pins *, uint32_t, uint32_t);
void __wrap_board_wait(void);
uint8_t __real_board_inputs(void);
uint8_t __wrap_board_inputs(void);
int __real_flash_erase(void *, unsigned);
int __wrap_flash_erase(void *, unsigned);
int __real_flash_program(void *, unsigned, unsigned, const void *, unsigned);
int __wrap_flash_program(void *, unsigned, unsigned, const void *, unsigned);
int flash_read(void *, unsigned, unsigned, void *, unsigned);

/* ns, of the interrupts that play pulses. The vectors are in RAM. */
static uint32_t idle, in_interrupts, worst;
static handler *plays, *plays_in_qemu;

static void count(handler *interrupt)
{
    uint32_t begin = TIM5->cnt;
    interrupt();
    uint32_t took = TIM5->cnt - begin;
    in_interrupts += took;
    worst = took > worst ? took : worst;
}

static void count_timer(void)
{
    count(plays);
}

static void count_systick(void)
{
    count(plays_in_qemu);
}

static void start_counting(void)
{
    handler **vectors = (handler **)(uintptr_t)SCB_VTOR, **timer = &vectors[16 + IRQ_TIM2], **systick = &vectors[15];
    plays = *timer;
    plays_in_qemu = *systick;
    *timer = count_timer;
    *systick = count_systick;
    TIM5->arr = UINT32_MAX;
    TIM5->cr1 = TIM_ON;
}

void __wrap_rkm04_init(struct rkm04_unit *unit, const struct rkm04_config *config, const struct rkm04_port *port, void *context)
{
    start_counting();
    USART2->cr1 = USART_ON & ~(1u << 5); /* without an interrupt */
    LOG[LOG_INIT] = config->node;
    __real_rkm04_init(unit, config, port, context);
}

void __wrap_rkm04_advance(struct rkm04_unit *unit, uint64_t ticks)
{
    LOG[LOG_ADVANCE] = (uint32_t)ticks;
    __real_rkm04_advance(unit, ticks);
}

size_t __wrap_rkm04_receive(struct rkm04_unit *unit, const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        LOG[LOG_BYTE] = bytes[i];
    if (count > 0)
        LOG[LOG_RECEIVE] = count;
    return __real_rkm04_receive(unit, bytes, count);
}

void __wrap_rkm04_set_inputs(struct rkm04_unit *unit, uint8_t mask)
{
    LOG[LOG_INPUTS] = mask;
    __real_rkm04_set_inputs(unit, mask);
}

size_t __wrap_rkm04_send(struct rkm04_unit *unit, uint8_t *bytes, size_t room)
{
    LOG[LOG_SEND] = room;
    return __real_rkm04_send(unit, bytes, room);
}

/* On the chip TIM2's compare matches at 0, before there is anything to play. */
void __wrap_pulses_start(struct pulses *pulses, uint32_t now)
{
    NVIC_PEND[0] = 1u << IRQ_TIM2;
    __real_pulses_start(pulses, now);
}

uint32_t __wrap_pulses_play(struct pulses *pulses, const struct pulse_pins *pins, uint32_t now, uint32_t latest)
{
    LOG[LOG_PLAY] = now;
    return __real_pulses_play(pulses, pins, now, latest);
}

/* QEMU 7.2 does not know how late it is after WFI, if it counts instructions. It does these in no time, and counts them. */
void __wrap_board_wait(void)
{
    uint32_t before = in_interrupts, begin = TIM5->cnt;
    interrupts_on();
    for (unsigned i = 0; i < 10; i++)
        __asm__ volatile(".rept 400\n nop\n .endr");
    interrupts_off();
    idle += TIM5->cnt - begin - (in_interrupts - before);
}

static uint8_t inputs, operations_left; /* 0: the power does not fail */

static void obey(uint8_t what, uint8_t value)
{
    if (what == 'i') {
        inputs = value;
        EXTI->swier = 0xff; /* as a change of the pins would do */
    } else if (what == 'f') {
        LOG[LOG_IDLE] = idle;
        LOG[LOG_INTERRUPTS] = in_interrupts;
        LOG[LOG_WORST] = worst;
        LOG[LOG_NOW] = TIM5->cnt;
    } else {
        LOG[LOG_CUT] = operations_left = value;
    }
}

uint8_t __wrap_board_inputs(void)
{
    static uint8_t what;
    uint8_t levels = __real_board_inputs();
    while (USART2->sr & USART_RECEIVED) {
        uint8_t byte = (uint8_t)USART2->dr;
        if (what != 0)
            obey(what, byte);
        what = what != 0 ? 0 : byte;
    }
    return levels | inputs;
}

static bool fails(void)
{
    return operations_left > 0 && --operations_left == 0;
}

static void power_off(void)
{
    SCB_AIRCR = AIRCR_RESET;
    for (;;)
        ;
}

/* An erase that was cut: half of the block is as before. */
int __wrap_flash_erase(void *context, unsigned block)
{
    static uint8_t half[RKM04_FLASH_BLOCK_SIZE / 2];
    bool cut = fails();
    if (!cut)
        return __real_flash_erase(context, block);
    (void)flash_read(context, block, 0, half, sizeof half);
    (void)__real_flash_erase(context, block);
    (void)__real_flash_program(context, block, 0, half, sizeof half);
    power_off();
    return 1;
}

int __wrap_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    bool cut = fails();
    int bad = __real_flash_program(context, block, offset, data, cut ? length / 16 * 8 : length);
    if (cut)
        power_off();
    return bad;
}
