/* SPDX-License-Identifier: MIT */
/* figures.c: what the firmware costs, counted. Runs under QEMU with -icount shift=10: each instruction takes 1024 ns of the
 * board's time, so that its clock of 25 MHz counts 25.6 for each. Reports by semihosting, one figure a line: name, number.
 * See tools/port-figures, which builds and runs it. */
#include <string.h>

#include "board.h"
#include "figures_count.h"
#include "loop.h"

/* ---- Count ------------------------------------------------------------------------------------------------------------ */

static void drop_pulses(void)
{
    for (unsigned i = 0; i < PULSES_LANES; i++)
        board_pulses.lane[i].out = board_pulses.lane[i].in;
}

static uint32_t pulses_waiting(void)
{
    uint32_t sum = 0;
    for (unsigned i = 1; i < PULSES_LANES; i++)
        sum += board_pulses.lane[i].in - board_pulses.lane[i].out;
    return sum;
}

/* A unit at power-up, with this program for all four motors. */
static void fresh_unit(const char *program)
{
    static const struct rkm04_config config = {.node = 1};
    static const struct rkm04_port no_flash;
    rkm04_init(&unit, &config, &no_flash, NULL);
    unit.port = &loop_port;
    (void)rkm04_set_command(&unit, '0', program, strlen(program), NULL);
}

/* Advance slot by slot. Returns the instructions of all, and in *worst those of the slot that took most. */
static uint32_t run(unsigned slots, uint32_t *pulses, uint32_t *worst)
{
    uint32_t sum = 0;
    *pulses = *worst = 0;
    for (unsigned i = 0; i < slots; i++) {
        begin();
        rkm04_advance(&unit, RKM04_SLOT_TICKS);
        uint32_t count = counted();
        sum += count;
        *worst = count > *worst ? count : *worst;
        *pulses += pulses_waiting();
        drop_pulses();
    }
    return sum;
}

/* ---- Figures ---------------------------------------------------------------------------------------------------------- */

static void count_pulses(void)
{
    uint32_t pulses, worst, sum;
    fresh_unit("S2000 V16000 A60000 F1000000 R");
    (void)run(500, &pulses, &worst);
    sum = run(500, &pulses, &worst);
    report("main_loop_per_pulse_at_16000", sum / pulses);
    report("main_loop_worst_slot_at_16000", worst);
    fresh_unit("S100 V16000 A20000 F16000000 R");
    (void)run(20, &pulses, &worst);
    sum = run(700, &pulses, &worst);
    report("main_loop_per_pulse_on_a_ramp", sum / pulses);
}

/* The timer interrupt; time is as if it had come exactly when it was asked for. */
static void play_at(uint32_t now)
{
    pulses_refresh(&board_pulses);
    begin();
    (void)pulses_play(&board_pulses, &board_pins, now, now + PULSES_FAR);
}

static void count_interrupts(void)
{
    pulses_start(&board_pulses, 1000);
    board_play((uint32_t)board_clock() + 1000000);
    begin();
    board_timer_interrupt();
    uint32_t whole = counted();
    report("interrupt_without_pulses", whole);
    play_at(1000);
    uint32_t frame = whole - counted(); /* reading the clock, arming the timer */
    pulses_put(&board_pulses, 1, 2000, PULSE_STEP);
    pulses_put(&board_pulses, 1, 2100, PULSE_STEP);
    play_at(2000);
    uint32_t pair = counted();
    play_at(2010);
    report("interrupts_per_pulse", pair + counted() + 2 * frame);
    uint32_t worst = 0;
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
        pulses_put(&board_pulses, motor, 3000, PULSE_STEP);
    pulses_put(&board_pulses, 0, 3000, 0xff);
    pulses_put(&board_pulses, 0, 3010, 0xff);
    for (uint32_t tick = 3000; tick <= 3010; tick += 10) { /* all begin, all end */
        play_at(tick);
        uint32_t count = counted();
        worst = count > worst ? count : worst;
    }
    report("interrupt_worst_four_pulses_and_DO", worst + frame);
    pulses_start(&board_pulses, 0);
}

static const char compound_of_ten[] =
    "V9973 A3571 F3000 Y F1001 V15013 A1777 Y F1003 V501 A59999 Y F1007 V7013 A2333 Y F1009 V16000 A101 Y "
    "F1013 V99 A77 Y F1019 V12007 A33331 Y F1021 V1999 A17 Y F1031 V15991 A59999 Y F3001 V777 A333 Y R";

static void set(char motor, const char *program)
{
    (void)rkm04_set_command(&unit, motor, program, strlen(program), NULL);
}

/* Everything in one tick, in the core: what a port's timer interrupt would take that called rkm04_advance itself. */
static void count_slots(void)
{
    uint32_t pulses, worst;
    fresh_unit("L255 T01 C01 E");
    (void)run(10, &pulses, &worst);
    (void)run(100, &pulses, &worst);
    report("slot_four_commands", worst);
    fresh_unit("S1000 V1000 F1000000 R");
    rkm04_advance(&unit, 5000);
    drop_pulses();
    begin();
    rkm04_advance(&unit, 1); /* a pulse of each is due */
    report("tick_four_pulses", counted());
    report("tick_four_pulses_of_which", pulses_waiting());
    drop_pulses();
    fresh_unit("S100 V10000 A20000 F100000 R");
    (void)run(10, &pulses, &worst);
    report("slot_four_motions_begin", worst);
    fresh_unit("S137");
    set('0', compound_of_ten);
    (void)run(45, &pulses, &worst);
    report("slot_four_compounds_of_ten_begin", worst);
    (void)rkm04_set_command(&unit, '0', "V5003", 5, NULL);
    (void)run(3, &pulses, &worst);
    report("slot_four_speeds_change_in_compounds", worst);
    (void)rkm04_set_command(&unit, '0', "K", 1, NULL);
    (void)run(3, &pulses, &worst);
    report("slot_four_stops_in_compounds", worst);
}

/* The longest request: commands for all four motors. */
static void long_request(void)
{
    static uint8_t message[RKM04_MESSAGE_MAX], answer[16];
    static const char command[] = "F16000000 ";
    message[0] = 2;
    message[1] = '0';
    size_t length = 2;
    for (; length + sizeof command - 1 <= sizeof message; length += sizeof command - 1)
        memcpy(message + length, command, sizeof command - 1);
    (void)rkm04_exchange(&unit, message, length, answer, sizeof answer);
}

static void count_messages(void)
{
    uint8_t answer[16];
    fresh_unit("");
    begin();
    long_request();
    report("message_of_1024_bytes_to_four_motors", counted());
    begin();
    (void)rkm04_exchange(&unit, (const uint8_t *)"\0041", 2, answer, sizeof answer);
    report("message_get_position", counted());
}

/* Run the firmware as it is until this tick. Returns the most by which a pulse was late. */
static uint32_t run_until(uint64_t tick)
{
    board_pulses.latest = 0;
    while (board_clock() < tick)
        loop_turn();
    return board_pulses.latest;
}

/* The firmware as it is, at as many instructions a tick as it was built for. How late was the latest pulse? */
static void try_all(void)
{
    loop_start();
    report("instructions_per_tick", (BOARD_TICK_CYCLES * 10 + 128) / 256);
    set('0', "S2000 V16000 A60000 F12000 R");
    report("latest_of_four_at_16000_begun_together", run_until(1300000));
    set('0', "\\ S2000 V16000 A60000");
    for (char motor = '1'; motor <= '4'; motor++) { /* not together: hardly two pulses share an interrupt */
        set(motor, "F12000 R");
        (void)run_until(board_clock() + 1313);
    }
    report("latest_of_four_at_16000_begun_apart", run_until(2600000));
    set('0', "\\ S2000 V16000 A60000 F14000 R");
    (void)run_until(2950000);
    long_request();
    report("latest_while_a_long_request_comes", run_until(3900000));
    set('0', "\\ S137");
    set('4', "\\ S2000 V16000 A60000 F16000 R");
    (void)run_until(4200000);
    for (char motor = '1'; motor <= '3'; motor++)
        set(motor, compound_of_ten);
    report("latest_while_three_compounds_of_ten_begin", run_until(4700000));
    report("steps_of_motor_4", (uint32_t)unit.motor[3].position);
}

int main(void)
{
    count_start();
    if (BOARD_TICK_CYCLES == 25) {
        count_pulses();
        count_interrupts();
        count_slots();
        count_messages();
    } else {
        try_all();
    }
    return count_end();
}
