/* SPDX-License-Identifier: MIT */
/* modbus_map.h: what lies at an address of the Modbus face (AB3-AB6, and the addresses of AP1). */
#ifndef PMC_MODBUS_MAP_H
#define PMC_MODBUS_MAP_H

#include "pmc.h"

enum pmc_place_kind {
    PMC_PLACE_NONE,
    PMC_PLACE_COMMAND,   /* AB4 */
    PMC_PLACE_BLOCK,     /* AB5 */
    PMC_PLACE_PARAMETER, /* AP1; index: of pmc_parameter_rows[] */
    PMC_PLACE_SPEED,     /* the fifth speed */
    PMC_PLACE_START,     /* register from which command 07 runs the program */
    PMC_PLACE_REGISTER   /* index: of the program register */
};

#define PMC_REGISTER_WORDS 8u /* of a program register */

struct pmc_place {
    uint8_t kind;  /* enum pmc_place_kind */
    uint8_t axis;  /* 0, 1 */
    uint8_t index;
    uint8_t word;  /* 0: the first */
    uint8_t words; /* of the whole value */
};

/* What lies at an address of the holding registers of a unit. */
struct pmc_place pmc_holding_place(const struct pmc_unit *unit, uint16_t address);

/* The present word there. */
uint16_t pmc_read_holding(const struct pmc_unit *unit, const struct pmc_place *place);

/* The value at `words`, high byte first, for a whole parameter, speed, start or register: could it be written there? */
bool pmc_is_holding_value(const struct pmc_place *place, const uint8_t *words);

/* Write a value that may be written there. */
enum pmc_answer pmc_write_holding(struct pmc_unit *unit, const struct pmc_place *place, const uint8_t *words);

/* A value of two words, the high one first, as two's complement. */
int32_t pmc_signed_words(const uint8_t *words);

/* Is there an input register at this address, and its present word. */
bool pmc_has_input(const struct pmc_unit *unit, uint16_t address);
uint16_t pmc_read_input(const struct pmc_unit *unit, uint16_t address);

#endif
