/* SPDX-License-Identifier: MIT */
/* figures_pmc.c: what the firmware of a PMC costs, counted as figures.c counts. See tools/port-figures. */
#include "board.h"
#include "figures_count.h"
#include "pmc_loop.h"

static void fresh_unit(void)
{
    static const struct pmc_config config = {.face = &BOARD_FACE, .axes = BOARD_AXES, .address = 1};
    static const struct pmc_port no_flash;
    pmc_init(&unit, &config, &no_flash, NULL);
    unit.port = &pmc_loop_port;
}

static void ask(unsigned kind, int32_t value)
{
    (void)pmc_request(&unit, &(struct pmc_request){.kind = (uint8_t)kind, .axes = 3, .value = {value, value}});
}

static uint32_t take_pulses(void)
{
    uint32_t sum = 0;
    for (unsigned i = 0; i < PULSES_LANES; i++) {
        struct pulse_lane *lane = &board_pulses.lane[i];
        sum += i > 0 ? lane->in - lane->out : 0;
        lane->out = lane->in;
    }
    return sum;
}

/* Advance slot by slot. Returns the instructions of all, and in *worst those of the slot that took most. */
static uint32_t run(unsigned slots, uint32_t *pulses, uint32_t *worst)
{
    uint32_t sum = 0;
    *pulses = *worst = 0;
    for (unsigned i = 0; i < slots; i++) {
        begin();
        pmc_advance(&unit, PMC_SLOT_TICKS);
        const uint32_t count = counted();
        sum += count;
        *worst = count > *worst ? count : *worst;
        *pulses += take_pulses();
    }
    return sum;
}

/* Both axes at 16 000 pulses/s, from 500 on with 500 000 pulses/s^2; and on a ramp of 20 000 pulses/s^2. */
static void count_pulses(void)
{
    uint32_t pulses, worst, sum;
    fresh_unit();
    ask(PMC_SET_SPEED, 1600);
    ask(PMC_JOG, 1);
    (void)run(200, &pulses, &worst);
    report("pmc_begin_of_two_moves", worst);
    sum = run(500, &pulses, &worst);
    report("pmc_per_pulse_at_16000", sum / pulses);
    ask(PMC_STOP, 0);
    (void)run(2, &pulses, &worst);
    report("pmc_stop_of_two_moves", worst);
    fresh_unit();
    for (unsigned axis = 0; axis < BOARD_AXES; axis++)
        (void)pmc_set_parameter(&unit, axis, PMC_ACCELERATION, 16);
    ask(PMC_SET_SPEED, 1600);
    ask(PMC_JOG, 1);
    (void)run(20, &pulses, &worst);
    sum = run(700, &pulses, &worst);
    report("pmc_per_pulse_on_a_ramp", sum / pulses);
    ask(PMC_SET_SPEED, 800);
    (void)run(2, &pulses, &worst);
    report("pmc_change_of_two_speeds", worst);
}

/* Both axes repeat a command of a program. */
static void count_slots(void)
{
    uint32_t pulses, worst;
    fresh_unit();
    for (unsigned axis = 0; axis < BOARD_AXES; axis++) {
        (void)pmc_set_command(&unit, axis, 0, &(struct pmc_command){.op = PMC_OUT, .argument = 1});
        (void)pmc_set_command(&unit, axis, 1, &(struct pmc_command){.op = PMC_JMP});
    }
    ask(PMC_RUN, 0);
    (void)run(10, &pulses, &worst);
    (void)run(100, &pulses, &worst);
    report("pmc_slot_of_two_programs", worst);
}

int main(void)
{
    count_start();
    pulses_start(&board_pulses, 0);
    count_pulses();
    count_slots();
    report("pmc_bytes_of_a_unit", sizeof unit);
    return count_end();
}
