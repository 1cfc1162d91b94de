/* SPDX-License-Identifier: MIT */
#include "variables.h"

#define DRIVE_A 0x10u
#define DRIVE_B 0x20u

/* Where the value of a variable is. */
enum place {
    WORD,      /* a register */
    WORD_PAIR, /* two registers, high word first, signed */
    SIGNED,    /* a register, signed */
    BIT        /* a bit of a register */
};

struct row {
    const char *name; /* after CIBn. or CIBn.MCA. */
    uint8_t zone;     /* enum cib_zone */
    uint8_t place;    /* enum place */
    uint8_t address;  /* of the register; of drives: after SEQ */
    uint8_t bit;
};

#define DI_BIT(n) {"DI" #n, CIB_INPUT_ZONE, BIT, 0, (n) - 1}
#define DO_BIT(n) {"DO" #n, CIB_OUTPUT_ZONE, BIT, 0, (n) - 1}
#define PWM(n) {"PWM" #n, CIB_OUTPUT_ZONE, WORD, n, 0}
#define STATUS(name, bit) {name, CIB_INPUT_ZONE, BIT, 1, bit}

static const struct row module_rows[] = {
    {"DI", CIB_INPUT_ZONE, WORD, 0, 0}, {"DO", CIB_OUTPUT_ZONE, WORD, 0, 0}, {"DRIVEN", CIB_INPUT_ZONE, WORD, 1, 0},
    DI_BIT(1), DI_BIT(2), DI_BIT(3), DI_BIT(4), DI_BIT(5), DI_BIT(6), DI_BIT(7), DI_BIT(8),
    DO_BIT(1), DO_BIT(2), DO_BIT(3), DO_BIT(4), DO_BIT(5), DO_BIT(6), DO_BIT(7), DO_BIT(8),
    PWM(1), PWM(2), PWM(3), PWM(4), PWM(5), PWM(6), PWM(7), PWM(8),
};

static const struct row drive_rows[] = {
    {"SEQ", CIB_OUTPUT_ZONE, WORD, 0, 0}, {"CMD", CIB_OUTPUT_ZONE, WORD, 1, 0}, {"P2", CIB_OUTPUT_ZONE, WORD, 4, 0},
    {"P1", CIB_OUTPUT_ZONE, WORD_PAIR, 2, 0}, {"ACK", CIB_INPUT_ZONE, WORD, 0, 0}, {"MCSTAT", CIB_INPUT_ZONE, WORD, 1, 0},
    {"MCERR", CIB_INPUT_ZONE, WORD, 2, 0}, {"ROW", CIB_INPUT_ZONE, WORD, 6, 0},
    STATUS("MOVE", 0), STATUS("DIR", 1), STATUS("INVEL", 2), STATUS("TRG", 3), STATUS("ERR", 4),
    {"POS", CIB_INPUT_ZONE, WORD_PAIR, 3, 0}, {"VEL", CIB_INPUT_ZONE, SIGNED, 5, 0},
};

#define MODULE_ROWS (sizeof module_rows / sizeof module_rows[0])
#define DRIVE_ROWS (sizeof drive_rows / sizeof drive_rows[0])

_Static_assert(MODULE_ROWS + CIB_DRIVES * DRIVE_ROWS == CIB_UNIT_VARIABLES, "each row is counted");

/* What a variable is: its row, NULL for __PLC_RUN; the address of its register, and the place of its module. */
struct found {
    const struct row *row;
    unsigned module, drive; /* drive: 0 none, 1 A, 2 B */
    uint16_t address;
};

static struct found find(unsigned variable)
{
    struct found found = {.row = NULL};
    if (variable == 0)
        return found;
    unsigned at = (variable - 1u) % CIB_UNIT_VARIABLES;
    found.module = (variable - 1u) / CIB_UNIT_VARIABLES;
    if (at < MODULE_ROWS) {
        found.row = &module_rows[at];
        found.address = found.row->address;
        return found;
    }
    found.row = &drive_rows[(at - MODULE_ROWS) % DRIVE_ROWS];
    found.drive = 1u + (unsigned)((at - MODULE_ROWS) / DRIVE_ROWS);
    found.address = (uint16_t)((found.drive == 1 ? DRIVE_A : DRIVE_B) + found.row->address);
    return found;
}

unsigned cib_variables(const struct cib_modules *modules)
{
    return 1u + modules->count * CIB_UNIT_VARIABLES;
}

/* ---- Names -------------------------------------------------------------------------------------------------------------- */

static size_t put(char *name, size_t length, const char *text)
{
    while (*text != '\0')
        name[length++] = *text++;
    name[length] = '\0';
    return length;
}

size_t cib_variable_name(const struct cib_modules *modules, unsigned variable, char name[CIB_VARIABLE_NAME_SIZE])
{
    static const char *const drives[] = {"", "MCA.", "MCB."};
    const struct found found = find(variable);
    if (!found.row)
        return put(name, 0, "__PLC_RUN");
    size_t length = put(name, 0, "CIB");
    unsigned address = modules->address[found.module];
    for (unsigned unit = address >= 100 ? 100 : address >= 10 ? 10 : 1; unit > 0; unit /= 10)
        name[length++] = (char)('0' + address / unit % 10u);
    length = put(name, length, ".");
    length = put(name, length, drives[found.drive]);
    return put(name, length, found.row->name);
}

const char *cib_variable_type(unsigned variable)
{
    static const char *const types[] = {[WORD] = "UINT", [WORD_PAIR] = "DINT", [SIGNED] = "INT", [BIT] = "BOOL"};
    const struct found found = find(variable);
    return types[found.row ? found.row->place : BIT];
}

/* ---- Values ------------------------------------------------------------------------------------------------------------- */

int32_t cib_variable_value(const struct cib_modules *modules, unsigned variable)
{
    const struct found found = find(variable);
    const struct cib_unit *unit = found.row ? modules->unit[found.module] : NULL;
    if (!unit)
        return found.row == NULL;
    uint16_t value = cib_read(unit, (enum cib_zone)found.row->zone, found.address);
    switch (found.row->place) {
    case WORD_PAIR: {
        uint16_t low = cib_read(unit, (enum cib_zone)found.row->zone, (uint16_t)(found.address + 1u));
        return (int32_t)((uint32_t)value << 16 | low);
    }
    case SIGNED:
        return (int16_t)value;
    case BIT:
        return value >> found.row->bit & 1;
    default:
        return value;
    }
}

bool cib_variable_is_open(const struct cib_modules *modules, unsigned variable)
{
    const struct found found = find(variable);
    return found.row && found.row->zone == CIB_OUTPUT_ZONE && modules->unit[found.module];
}

bool cib_variable_is_bit(unsigned variable)
{
    const struct found found = find(variable);
    return !found.row || found.row->place == BIT;
}

static enum cib_set result_of(enum cib_answer answer)
{
    return answer == CIB_DONE ? CIB_SET_DONE : CIB_SET_VALUE;
}

enum cib_set cib_variable_set(const struct cib_modules *modules, unsigned variable, int64_t value)
{
    const struct found found = find(variable);
    const uint16_t word[2] = {(uint16_t)((uint64_t)value >> 16 & 0xffffu), (uint16_t)((uint64_t)value & 0xffffu)};
    if (!cib_variable_is_open(modules, variable))
        return CIB_SET_READ_ONLY;
    struct cib_unit *unit = modules->unit[found.module];
    if (found.row->place == WORD_PAIR)
        return value < INT32_MIN || value > INT32_MAX ? CIB_SET_VALUE : result_of(cib_write(unit, found.address, word, 2));
    if (value < 0 || value > (found.row->place == BIT ? 1 : UINT16_MAX))
        return CIB_SET_VALUE;
    if (found.row->place == WORD)
        return result_of(cib_write(unit, found.address, &word[1], 1));
    uint8_t mask = (uint8_t)(1u << found.row->bit);
    cib_write_coils(unit, mask, value == 1 ? mask : 0);
    return CIB_SET_DONE;
}
