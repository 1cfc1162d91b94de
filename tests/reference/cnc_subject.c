/* SPDX-License-Identifier: MIT */
/* cnc_subject.c: a CNC872 that does what cnc872.py says. A line of input is a command:
 *
 *     config XML | nc LINE | power | show NAME        a machine, a line of its NC program, power-up, a cell to be printed
 *     start | stop | reset | pot N | spindle N | rtm N | m01 N | single N | bit NAME N | cell NAME N
 *     tick                                            one T
 *     end
 *
 * Output of a T: X Y Z, speed, phase, block (-1: none), the cells of `show`. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cnc872/cnc_rig.h"
#include "subject_input.h"

static char xml[4000], nc[4000];

#define SHOWN_MAX 128u
static struct cnc_operand shown[SHOWN_MAX];
static unsigned shown_count;

static void show(const char *name)
{
    struct cnc_text_fault fault;
    ck_assert_uint_lt(shown_count, SHOWN_MAX);
    ck_assert(cnc_parse_operand(name, strlen(name), NULL, &shown[shown_count++], &fault));
}

static void print_turn(void)
{
    for (unsigned i = 0; i < 3; i++)
        printf("%" PRId64 " ", cnc.axis[i].position);
    printf("%" PRId64 " %u %" PRId64, cnc.move.v, cnc.machine.phase,
           cnc.machine.block == CNC_NO_BLOCK ? -1 : (int64_t)cnc.machine.block);
    for (const struct cnc_operand *one = shown; one < shown + shown_count; one++)
        printf(" %" PRId64, one->kind == CNC_OPERAND_BIT ? (int64_t)cnc_bit(&cnc.cells, one->place)
                                                        : cnc_read_number(&cnc.cells, one->place, (enum cnc_type)one->type));
    putchar('\n');
}

static void obey(const char *what, const char *name, long long value)
{
    if (strcmp(what, "start") == 0)
        cnc_start(&cnc);
    else if (strcmp(what, "stop") == 0)
        cnc_stop(&cnc);
    else if (strcmp(what, "reset") == 0)
        cnc_reset(&cnc);
    else if (strcmp(what, "pot") == 0)
        cnc.panel.feed = (uint16_t)atoi(name);
    else if (strcmp(what, "spindle") == 0)
        cnc.panel.spindle = (uint16_t)atoi(name);
    else if (strcmp(what, "show") == 0)
        show(name);
    else if (strcmp(what, "rtm") == 0)
        cnc_set_critical(&cnc, (uint8_t)atoi(name));
    else if (strcmp(what, "m01") == 0)
        cnc.panel.m01 = atoi(name) != 0;
    else if (strcmp(what, "single") == 0)
        cnc.panel.block_by_block = atoi(name) != 0;
    else if (strcmp(what, "bit") == 0)
        set_bit(name, value != 0);
    else if (strcmp(what, "cell") == 0)
        set_cell(name, 0, value);
    else
        ck_abort_msg("unexpected command %s", what);
}

static void obey_input(void)
{
    char line[4000];
    while (fgets(line, sizeof line, stdin) != NULL && strcmp(line, "end\n") != 0) {
        char what[8] = "", name[32] = "";
        long long value = 0;
        rig_events = 0;
        if (strncmp(line, "config ", 7) == 0) {
            strcpy(xml, line + 7);
        } else if (strncmp(line, "nc ", 3) == 0) {
            strcat(nc, line + 3);
        } else if (strcmp(line, "power\n") == 0) {
            rig_power(xml, nc);
        } else if (strcmp(line, "tick\n") == 0) {
            cnc_tick(&cnc);
            print_turn();
        } else {
            ck_assert_int_ge(sscanf(line, "%7s %31s %lld", what, name, &value), 1);
            obey(what, name, value);
        }
    }
}

int main(void)
{
    return run_subject("cnc_subject", obey_input);
}
