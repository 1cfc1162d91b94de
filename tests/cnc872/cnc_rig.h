/* SPDX-License-Identifier: MIT */
/* cnc_rig.h: a CNC872 with a configuration and an NC program given as texts, and what it did in each T.
 *
 *     rig_begin("G1 X10 F1000");       // power up with X, Y, Z as they are without a configuration; START comes in T 1
 *     run_to(100);                     // T 100 is done
 *     ck_assert_int_eq(at(2).x, 32768);
 *     set_bit("STOP_REQ", true);       // acts in T 101 */
#ifndef TESTS_CNC_RIG_H
#define TESTS_CNC_RIG_H

#include <check.h>
#include <stdbool.h>
#include <stdint.h>

#include "cnc872/cnc872.h"

#define RIG_TURNS_MAX 200000u
#define RIG_EVENTS_MAX 256u
#define MM ((int64_t)CNC_U_PER_MM)

extern struct cnc cnc;
extern struct cnc_config config;
extern struct cnc_nc_program program;

/* A T, as it was at its end. */
struct rig_turn {
    int64_t x, y, z, v; /* commanded positions, speed of the path */
    uint32_t block;
    uint8_t phase;
    bool po_f, po_pol, po_stop, sf_stop;
};

struct rig_event {
    uint64_t turn;
    enum cnc_event event;
    int64_t value;
};
extern struct rig_event rig_event[RIG_EVENTS_MAX];
extern unsigned rig_events;

/* Called before each T, with its number, if set. */
extern void (*rig_script)(uint64_t turn);

/* Power up. xml: CONFIG.xml, NULL: none; nc: NULL: none. rig_power() gives no START. */
void rig_power(const char *xml, const char *nc);
void rig_begin(const char *nc);
void rig_begin_with(const char *xml, const char *nc);

/* The same with a PLC program. */
void rig_power_plc(const char *xml, const char *nc, const char *plc);
void rig_begin_plc(const char *xml, const char *nc, const char *plc);

/* Another NC program. */
void rig_load_nc(const char *nc);

void run_to(uint64_t turn);
struct rig_turn at(uint64_t turn);

/* The first T from `from` on in which it is so; 0: it was not so. */
uint64_t first_rest(uint64_t from); /* v = 0 */
uint64_t first_reached(uint64_t from); /* PO_POL 1 */
uint64_t first_end(uint64_t from);  /* PO_F 0 */
uint64_t first_stop(uint64_t from); /* PO_STOP 1 */
uint64_t first_speed(uint64_t from, int64_t v);
int64_t top_speed(void);            /* of all T's */

/* Cells by name: "PO_F", "BZH09", "DIFCIT_X" with an index; bits and variables of the PLC program, too. */
bool bit(const char *name);
void set_bit(const char *name, bool value);
int64_t cell(const char *name, unsigned index);
void set_cell(const char *name, unsigned index, int64_t value);

/* How often an event came, and the value of the last one. */
unsigned count_events(enum cnc_event event);
int64_t last_event(enum cnc_event event);

#endif
