/* SPDX-License-Identifier: MIT */
#include "cnc_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct cnc cnc;
struct cnc_config config;
struct cnc_nc_program program;
struct rig_event rig_event[RIG_EVENTS_MAX];
unsigned rig_events;
void (*rig_script)(uint64_t turn);

static struct cnc_plc_program plc_program;
static struct rig_turn history[RIG_TURNS_MAX + 1];
static bool has_plc;

static void on_event(void *context, enum cnc_event event, int64_t value)
{
    (void)context;
    ck_assert_uint_lt(rig_events, RIG_EVENTS_MAX);
    rig_event[rig_events++] = (struct rig_event){cnc.turn, event, value};
}

static void on_error(void *context, const struct cnc_text_error *error)
{
    ck_abort_msg("%s:%u:%u: %s", (const char *)context, error->line, error->column, error->text);
}

/* Texts are never freed before the program ends: the cnc uses them. */
static void *get_memory(size_t count, size_t size)
{
    void *memory = calloc(count > 0 ? count : 1, size);
    ck_assert_ptr_nonnull(memory);
    return memory;
}

static void read_nc(const char *nc)
{
    static char name[] = "nc";
    free(program.blocks);
    free(program.values);
    memset(&program, 0, sizeof program);
    cnc_nc_measure(nc, strlen(nc), &program.block_room, &program.value_room);
    program.blocks = get_memory(program.block_room, sizeof *program.blocks);
    program.values = get_memory(program.value_room, sizeof *program.values);
    ck_assert(cnc_nc_read(nc, strlen(nc), &config, &program, on_error, name));
}

void rig_power_plc(const char *xml, const char *nc, const char *plc)
{
    static char name[] = "xml", plc_name[] = "plc";
    static const struct cnc_port port = {.event = on_event};
    rig_events = 0;
    rig_script = NULL;
    cnc_config_clear(&config);
    if (xml != NULL)
        ck_assert(cnc_config_read(xml, strlen(xml), &config, on_error, name));
    if (nc != NULL)
        read_nc(nc);
    if (plc != NULL)
        ck_assert(cnc_translate_plc(plc, strlen(plc), &plc_program, on_error, plc_name));
    has_plc = plc != NULL;
    cnc_begin(&cnc, &(struct cnc_setup){.config = &config,
                                        .program = nc != NULL ? &program : NULL,
                                        .plc = has_plc ? &plc_program : NULL,
                                        .port = &port});
}

void rig_begin_plc(const char *xml, const char *nc, const char *plc)
{
    rig_power_plc(xml, nc, plc);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
}

void rig_power(const char *xml, const char *nc)
{
    rig_power_plc(xml, nc, NULL);
}

void rig_begin_with(const char *xml, const char *nc)
{
    rig_power(xml, nc);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
}

void rig_begin(const char *nc)
{
    rig_begin_with(NULL, nc);
}

void rig_load_nc(const char *nc)
{
    ck_assert_int_eq(cnc_load(&cnc, NULL), CNC_OK);
    read_nc(nc);
    ck_assert_int_eq(cnc_load(&cnc, &program), CNC_OK);
}

void run_to(uint64_t turn)
{
    if (turn > RIG_TURNS_MAX)
        ck_abort_msg("the rig ends with T %u", RIG_TURNS_MAX);
    while (cnc.turn < turn) {
        if (rig_script != NULL)
            rig_script(cnc.turn + 1);
        cnc_tick(&cnc);
        history[cnc.turn] = (struct rig_turn){.x = cnc.axis[0].position,
                                              .y = cnc.axis[1].position,
                                              .z = cnc.axis[2].position,
                                              .v = cnc.move.v,
                                              .block = cnc.machine.block,
                                              .phase = cnc.machine.phase,
                                              .po_f = cnc_bit(&cnc.cells, CNC_BIT_PO_F),
                                              .po_pol = cnc_bit(&cnc.cells, CNC_BIT_PO_POL),
                                              .po_stop = cnc_bit(&cnc.cells, CNC_BIT_PO_STOP),
                                              .sf_stop = cnc_bit(&cnc.cells, CNC_BIT_SF_STOP)};
    }
}

struct rig_turn at(uint64_t turn)
{
    ck_assert_uint_le(turn, cnc.turn);
    return history[turn];
}

#define FIRST(condition)                                        \
    for (uint64_t turn = from; turn <= cnc.turn; turn++) {      \
        const struct rig_turn *is = &history[turn];             \
        if (condition)                                          \
            return turn;                                        \
    }                                                           \
    return 0

uint64_t first_rest(uint64_t from)
{
    FIRST(is->v == 0);
}

uint64_t first_reached(uint64_t from)
{
    FIRST(is->po_pol);
}

uint64_t first_end(uint64_t from)
{
    FIRST(!is->po_f);
}

uint64_t first_stop(uint64_t from)
{
    FIRST(is->po_stop);
}

uint64_t first_speed(uint64_t from, int64_t v)
{
    FIRST(is->v == v);
}

int64_t top_speed(void)
{
    int64_t top = 0;
    for (uint64_t turn = 1; turn <= cnc.turn; turn++)
        top = history[turn].v > top ? history[turn].v : top;
    return top;
}

/* What a name stands for. */
static struct cnc_operand find_operand(const char *name)
{
    struct cnc_operand operand;
    struct cnc_text_fault fault;
    if (!cnc_parse_operand(name, strlen(name), has_plc ? &plc_program.names : NULL, &operand, &fault))
        ck_abort_msg("%s: %s", name, fault.reason); /* Check writes to a file for each of its assertions */
    return operand;
}

bool bit(const char *name)
{
    return cnc_bit(&cnc.cells, find_operand(name).place);
}

void set_bit(const char *name, bool value)
{
    cnc_put_bit(&cnc.cells, find_operand(name).place, value);
}

static unsigned find_element(const struct cnc_operand *operand, unsigned index)
{
    return operand->place + index * cnc_type_size[operand->type];
}

int64_t cell(const char *name, unsigned index)
{
    const struct cnc_operand operand = find_operand(name);
    return cnc_read_number(&cnc.cells, find_element(&operand, index), (enum cnc_type)operand.type);
}

void set_cell(const char *name, unsigned index, int64_t value)
{
    const struct cnc_operand operand = find_operand(name);
    cnc_write_number(&cnc.cells, find_element(&operand, index), (enum cnc_type)operand.type, value);
}

unsigned count_events(enum cnc_event event)
{
    unsigned count = 0;
    for (unsigned i = 0; i < rig_events; i++)
        count += rig_event[i].event == event;
    return count;
}

int64_t last_event(enum cnc_event event)
{
    for (unsigned i = rig_events; i-- > 0;)
        if (rig_event[i].event == event)
            return rig_event[i].value;
    ck_abort_msg("no event %d", event);
}
