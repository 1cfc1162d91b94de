/* SPDX-License-Identifier: MIT */
/* cnc872_device.h: the CNC872 as a kind of device without a bus, what is only true of it. For the room. */
#ifndef RKM04_DEVICE_CNC872_DEVICE_H
#define RKM04_DEVICE_CNC872_DEVICE_H

#include <jansson.h>

#include "cnc872/cnc872.h"
#include "device.h"

/* ---- cnc872_texts.c: files that a cnc is made from ---------------------------------------------------------------------- */

enum cnc_text_kind { CNC_TEXT_CONFIG, CNC_TEXT_NC, CNC_TEXT_PLC, CNC_TEXT_MACHINE, CNC_TEXT_KINDS };

/* Of the different texts that a process reads; the same text again is the same one. */
#define CNC_TEXTS_MAX 4096u
#define CNC_TEXTS_BYTES_MAX ((size_t)512 << 20) /* together, with what is made from them */

#define CNC_SWITCHES_MAX 10000u /* of a machine: a YAML file of the emulator has at most 65 536 values */

struct cnc_machine_switches {
    struct cnc_switch *list;
    uint16_t count;
};

/* A text that was read, constant from then on: it is shared by all units and snapshots, and stays to the end of the process. */
struct cnc_text {
    enum cnc_text_kind kind;
    const struct cnc_text *needs; /* of an NC program the configuration, of switches the PLC program; NULL: none */
    const char *text;             /* ends with 0 */
    size_t length;
    const struct cnc_config *config;
    const struct cnc_nc_program *program;
    const struct cnc_plc_program *plc;
    struct cnc_machine_switches machine;
    unsigned number; /* of all texts of the process */
};

/* Read a text. Returns NULL if it is wrong; each thing that is wrong is written to `errors` as NAME:LINE:COLUMN: error: ... */
const struct cnc_text *cnc_text_read(enum cnc_text_kind kind, const struct cnc_text *needs, const char *name, const char *text,
                                     size_t length, FILE *errors);

/* A text by its number; NULL: there is none. */
const struct cnc_text *cnc_text_numbered(unsigned number);

/* The configuration of a cnc without one: X, Y, Z with defaults. */
const struct cnc_config *cnc_default_config(void);

/* ---- A unit ------------------------------------------------------------------------------------------------------------- */

/* What a config has of a CNC872. */
struct cnc_own {
    const struct cnc_text *text[CNC_TEXT_KINDS]; /* NULL: none */
};

struct cnc_device {
    struct cnc cnc;
    struct cnc_own own;              /* the texts that it has now */
    const struct cnc_text *loaded[CNC_TEXT_KINDS]; /* those of cnc.load, which stay without power; NULL: none */
    struct cnc_port port;            /* calls that pass on to `outer` */
    const struct device_port *outer;
    void *context;                   /* of `outer` */
    uint64_t now;                    /* the first us that is not yet done */
    int64_t last[CNC_AXES];          /* commanded positions after the last T, u of POS0 */
    int32_t shown[CNC_AXES];         /* um of POS5 that were reported last */
    uint32_t backup;                 /* number of the image of the backup memory that counts */
    uint32_t loads;                  /* PLC programs and switches that have been loaded since power-up */
    uint16_t moving;                 /* axes whose motion has been reported as begun */
    bool is_critical;                /* BZH13 has been reported */
    uint8_t refused;                 /* why a START was, enum cnc_result; CNC_RESULTS: a block was; CNC_OK: none */
    bool is_quiet;                   /* nothing is to happen of itself but that time passes */
};

/* Report in words. */
void cnc_note(const struct cnc_device *device, const char *format, ...) __attribute__((format(printf, 2, 3)));

struct cnc_device *cnc_of(struct device_unit *unit);
const struct cnc_device *cnc_in(const struct device_unit *unit);

/* ---- cnc872_settings.c -------------------------------------------------------------------------------------------------- */

struct cnc_own cnc_own_of(const struct device_config *config);
extern const struct device_option cnc_options[];
extern const char *const cnc_setting_names[];
void cnc_put_settings(const struct device_config *config, json_t *object);
/* The text that one of this kind is read with: an NC program has the axes and M functions of the configuration, a switch may be a
 * bit of the PLC program. NULL: none. */
const struct cnc_text *cnc_needed_text(const struct cnc_own *own, enum cnc_text_kind kind);

/* Has the configuration the axes of all switches? What is wrong goes to `errors`. */
bool cnc_has_axes(const struct cnc_own *own, const char *name, FILE *errors);

bool cnc_read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE]);
const char *cnc_settings_difference(const struct device_config *a, const struct device_config *b);

/* Is there anything wrong in an NC program? As struct device_kind's check_text. */
bool cnc_check_text(const struct device_config *config, const char *name, const char *text, size_t length, FILE *out);

/* ---- cnc872_json.c, cnc872_cells.c, cnc872_names.c, cnc872_methods.c ---------------------------------------------------- */

json_t *cnc_json_state(const struct device_unit *unit, uint64_t t_us);
json_t *cnc_json_describe(const struct device_unit *unit, uint64_t t_us);
const char *cnc_state_name(unsigned state);
const char *cnc_fault_name(unsigned fault);

/* What an axis does: names of states. */
enum cnc_axis_state { CNC_AXIS_IDLE, CNC_AXIS_BLOCK, CNC_AXIS_STOPPED, CNC_AXIS_MANUAL, CNC_AXIS_REFERENCE, CNC_AXIS_STATES };
enum cnc_axis_state cnc_axis_state(const struct cnc *cnc, unsigned axis);

/* um of POS5, rounded down, within 32 bits. */
int32_t cnc_shown_position(const struct cnc *cnc, unsigned axis);

/* Cells by name: an array of operands -> {operand: value}; NULL: refused. */
json_t *cnc_get_cells(const struct cnc_device *device, const json_t *cells, struct device_refusal *refusal);
/* {operand: value}: all of them, or none. False: refused. */
bool cnc_set_cells(struct cnc_device *device, const json_t *cells, struct device_refusal *refusal);

/* "; did you mean `PO_STOP'?": the cell, or variable of the PLC program (`names`; NULL: none), nearest to a name that is none by
 * `fault`, valid until the next call; "" if none is near, or the fault is another. */
const char *cnc_nearest_cell(const struct cnc_names *names, const char *name, const struct cnc_text_fault *fault);

/* The value of a cell as JSON: bits are 0 or 1, REAL has a point, or is null. */
json_t *cnc_cell_json(const struct cnc *cnc, const struct cnc_operand *operand);
json_t *cnc_real_json(double real);

/* A whole number from `low` to `high`. False: it is none, and refused. */
bool cnc_read_number_param(const char *name, const json_t *value, int64_t low, int64_t high, int64_t *number,
                           struct device_refusal *refusal);

/* {search, section, limit} -> {cells: [{name, type, access, section}], more}: the cells whose name has this part; NULL:
 * refused. */
json_t *cnc_find_names(const struct cnc_device *device, const json_t *params, struct device_refusal *refusal);

/* As struct device_kind's find_cell and cell. */
uint64_t cnc_find_cell_code(const struct device_unit *unit, const char *name, char error[DEVICE_ERROR_SIZE]);
int64_t cnc_cell_value(const struct device_unit *unit, uint64_t found);

extern const struct device_method cnc_methods[];

/* Refuse; always returns NULL. CNC_REFUSE: the same, false. */
#define CNC_REFUSE(...) (cnc_refuse(__VA_ARGS__), false)
json_t *cnc_refuse(struct device_refusal *refusal, bool is_state, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* ---- cnc872_load.c ------------------------------------------------------------------------------------------------------ */

/* Load an NC program. False: it cannot be done now, and the refusal says why. */
bool cnc_load_program(struct cnc_device *device, const struct cnc_text *program, struct device_refusal *refusal);

/* The method cnc.load: an NC program, a PLC program, switches, as texts; all of them or none. */
json_t *cnc_load_texts(struct device_unit *unit, const json_t *params, struct device_refusal *refusal);

/* The method cnc.plc: the PLC program that runs, its text with the values of its cells. In cnc872_plc.c. */
json_t *cnc_show_plc(struct device_unit *unit, const json_t *params, struct device_refusal *refusal);

/* What a cnc with these texts begins with. `backup`: CNC_BACKUP_SIZE bytes. */
struct cnc_setup cnc_setup_of(struct cnc_device *device, const struct cnc_own *own, const uint8_t *backup);

#endif
