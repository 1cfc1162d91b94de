/* SPDX-License-Identifier: MIT */
/* registers.c: the table of registers (BL7, BL8). */
#include "apply.h"
#include "cib.h"
#include "cib_report.h"
#include "drive.h"
#include "outputs.h"
#include "pwm.h"

enum {
    AT_OUTPUTS = 0, /* output zone */
    AT_DUTY = 1,
    AT_DUTY_END = AT_DUTY + CIB_OUTPUTS,
    AT_INPUTS = 0, /* input zone */
    AT_DRIVEN = 1,
    AT_BUTTONS = 2,
    AT_DRIVE = 0x10, /* both; the second drive 10H further on */
    AT_TYPE = 0x30,
    AT_FIRMWARE = 0x31,
    ORDER_WORDS = 5,  /* of a drive in the output zone */
    STATE_WORDS = 11, /* and in the input zone */
    DRIVE_STRIDE = 0x10
};

/* ---- Configuration: 101H-125H -------------------------------------------------------------------------------------- */

#define AT_APPLY 0x100u
#define AT_SETUP 0x101u
#define SETUP_DRIVE 0x110u
#define SETUP_DRIVE_WORDS 6u
#define SETUP_PERIOD 0x104u
#define SETUP_BIPOLAR 0x10au
#define SETUP_ACTIVE 0x10bu

static bool has_setup_word(unsigned address)
{
    if (address >= SETUP_DRIVE)
        return address < SETUP_DRIVE + CIB_DRIVES * DRIVE_STRIDE && address % DRIVE_STRIDE < SETUP_DRIVE_WORDS;
    return address >= AT_SETUP && address <= SETUP_ACTIVE;
}

/* A word of a drive's setup. */
static uint16_t *drive_word(struct cib_setup *setup, unsigned address)
{
    struct cib_drive_setup *drive = &setup->drive[(address - SETUP_DRIVE) / DRIVE_STRIDE];
    uint16_t *const word[SETUP_DRIVE_WORDS] = {&drive->mode,
                                               &drive->start_speed,
                                               &drive->speed_max,
                                               &drive->acceleration_max,
                                               &drive->deceleration_max,
                                               &drive->ramps};
    return word[address % DRIVE_STRIDE];
}

static uint16_t read_setup(const struct cib_setup *from, unsigned address)
{
    struct cib_setup setup = *from;
    if (address >= SETUP_DRIVE)
        return *drive_word(&setup, address);
    if (address >= SETUP_BIPOLAR)
        return address == SETUP_BIPOLAR ? setup.bipolar : setup.active;
    if (address < SETUP_PERIOD)
        return setup.use[address - AT_SETUP];
    const uint32_t period = setup.period[(address - SETUP_PERIOD) / 2];
    return (uint16_t)(address % 2 == 0 ? period >> 16 : period);
}

static void write_setup(struct cib_setup *setup, unsigned address, uint16_t value)
{
    if (address >= SETUP_DRIVE) {
        *drive_word(setup, address) = value;
    } else if (address == SETUP_BIPOLAR) {
        setup->bipolar = value;
    } else if (address == SETUP_ACTIVE) {
        setup->active = value;
    } else if (address < SETUP_PERIOD) {
        setup->use[address - AT_SETUP] = value;
    } else {
        uint32_t *period = &setup->period[(address - SETUP_PERIOD) / 2];
        *period = address % 2 == 0 ? (*period & 0xffff) | (uint32_t)value << 16 : (*period & 0xffff0000) | value;
    }
}

/* ---- Reading ------------------------------------------------------------------------------------------------------- */

/* Is `address` one of the first `words` of a drive? */
static bool is_of_drive(unsigned address, unsigned words)
{
    return address >= AT_DRIVE && address < AT_DRIVE + CIB_DRIVES * DRIVE_STRIDE && address % DRIVE_STRIDE < words;
}

bool cib_has_register(enum cib_zone zone, uint16_t address)
{
    if (address == AT_APPLY || has_setup_word(address))
        return true;
    if (zone == CIB_OUTPUT_ZONE)
        return address < AT_DUTY_END || is_of_drive(address, ORDER_WORDS);
    return address <= AT_BUTTONS || is_of_drive(address, STATE_WORDS) || address == AT_TYPE || address == AT_FIRMWARE;
}

static uint16_t read_order(const struct cib_drive *drive, unsigned word)
{
    const uint16_t words[ORDER_WORDS] = {
        drive->sequence, drive->command, (uint16_t)(drive->p1 >> 16), (uint16_t)drive->p1, drive->p2};
    return words[word];
}

static uint16_t read_state(const struct cib_unit *unit, unsigned drive, unsigned word)
{
    struct cib_drive_state state;
    cib_drive_state(unit, drive, &state);
    const uint32_t position = (uint32_t)state.position;
    const uint16_t words[STATE_WORDS] = {state.ack,
                                         state.status,
                                         state.error,
                                         (uint16_t)(position >> 16),
                                         (uint16_t)position,
                                         (uint16_t)state.speed,
                                         state.row,
                                         state.start_speed,
                                         state.acceleration,
                                         state.deceleration,
                                         state.stop_deceleration};
    return words[word];
}

static uint16_t read_output_zone(const struct cib_unit *unit, unsigned address)
{
    if (address == AT_APPLY)
        return 0;
    if (address >= AT_SETUP)
        return read_setup(&unit->proposal, address);
    if (address >= AT_DRIVE)
        return read_order(&unit->drive[address / DRIVE_STRIDE - 1], address % DRIVE_STRIDE);
    return address == AT_OUTPUTS ? unit->outputs : unit->pwm[address - AT_DUTY].duty;
}

static uint16_t read_input_zone(const struct cib_unit *unit, unsigned address)
{
    switch (address) {
    case AT_INPUTS:
        return cib_shown_inputs(unit);
    case AT_DRIVEN:
        return cib_driven(unit);
    case AT_BUTTONS:
        return unit->buttons;
    case AT_TYPE:
        return CIB_TYPE;
    case AT_FIRMWARE:
        return unit->config.firmware;
    case AT_APPLY:
        return unit->result;
    default:
        if (address >= AT_SETUP)
            return read_setup(&unit->setup, address);
        return read_state(unit, address / DRIVE_STRIDE - 1, address % DRIVE_STRIDE);
    }
}

uint16_t cib_read(const struct cib_unit *unit, enum cib_zone zone, uint16_t address)
{
    if (!cib_has_register(zone, address))
        return 0;
    return zone == CIB_OUTPUT_ZONE ? read_output_zone(unit, address) : read_input_zone(unit, address);
}

uint16_t cib_read_bits(const struct cib_unit *unit, enum cib_zone zone)
{
    if (zone == CIB_OUTPUT_ZONE)
        return unit->outputs;
    return (uint16_t)(cib_shown_inputs(unit) | (cib_driven(unit) & 0xff) << 8);
}

/* ---- Writing ------------------------------------------------------------------------------------------------------- */

static bool takes_value(unsigned address, uint16_t value)
{
    if (address == AT_OUTPUTS)
        return value <= 0xff;
    if (address < AT_DUTY_END)
        return value <= CIB_DUTY_MAX;
    return address != AT_APPLY || value <= 1;
}

static void write_outputs(struct cib_unit *unit, uint8_t outputs)
{
    unit->outputs = outputs;
    outputs_changed(unit, unit->now);
}

static void write_duty(struct cib_unit *unit, unsigned output, uint16_t duty)
{
    if (duty == unit->pwm[output].duty)
        return;
    pwm_write(unit, output, duty);
    outputs_find_edge(unit, unit->now);
    report_event(unit, unit->now, output + 1, CIB_EVENT_DUTY, duty);
}

static void write_order(struct cib_drive *drive, unsigned word, uint16_t value)
{
    uint16_t *const words[ORDER_WORDS] = {&drive->sequence, &drive->command, NULL, NULL, &drive->p2};
    if (word == 2)
        drive->p1 = (drive->p1 & 0xffff) | (uint32_t)value << 16;
    else if (word == 3)
        drive->p1 = (drive->p1 & 0xffff0000) | value;
    else
        *words[word] = value;
}

static void write_register(struct cib_unit *unit, unsigned address, uint16_t value)
{
    if (address >= AT_SETUP)
        write_setup(&unit->proposal, address, value);
    else if (address == AT_OUTPUTS)
        write_outputs(unit, (uint8_t)value);
    else if (address < AT_DUTY_END)
        write_duty(unit, address - AT_DUTY, value);
    else if (address != AT_APPLY)
        write_order(&unit->drive[address / DRIVE_STRIDE - 1], address % DRIVE_STRIDE, value);
}

enum cib_answer cib_write(struct cib_unit *unit, uint16_t address, const uint16_t *value, unsigned count)
{
    for (unsigned i = 0; i < count; i++)
        if (address + i > UINT16_MAX || !cib_has_register(CIB_OUTPUT_ZONE, (uint16_t)(address + i)))
            return CIB_NO_REGISTER;
    for (unsigned i = 0; i < count; i++)
        if (!takes_value(address + i, value[i]))
            return CIB_BAD_VALUE;
    for (unsigned i = 0; i < count; i++)
        write_register(unit, address + i, value[i]);
    if (address <= AT_APPLY && count > AT_APPLY - address && value[AT_APPLY - address] == 1)
        apply_proposal(unit);
    for (unsigned i = 0; i < CIB_DRIVES; i++)
        if (unit->drive[i].sequence != unit->drive[i].ack)
            drive_take(unit, &unit->drive[i]);
    return CIB_DONE;
}

void cib_write_coils(struct cib_unit *unit, uint8_t mask, uint8_t bits)
{
    write_outputs(unit, (uint8_t)((unit->outputs & ~mask) | (bits & mask)));
}
