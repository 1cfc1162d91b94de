/* SPDX-License-Identifier: MIT */
/* pmc_device.h: the PMC-1HS and PMC-2HS as kinds of device, what is only true of them. For the room. */
#ifndef RKM04_DEVICE_PMC_DEVICE_H
#define RKM04_DEVICE_PMC_DEVICE_H

#include <jansson.h>

#include "device.h"
#include "pmc/pmc.h"

/* A unit: what struct device_unit is for these kinds. */
struct pmc_device {
    struct pmc_unit unit;
    struct pmc_port port;            /* calls that pass on to `outer` */
    const struct device_port *outer; /* NULL before the first power-up */
    void *context;                   /* of `outer` */
};

struct pmc_unit *pmc_of(struct device_unit *unit);
const struct pmc_unit *pmc_in(const struct device_unit *unit);

/* ---- pmc_device_settings.c ------------------------------------------------------------------------------------------------- */

/* What a config has of a PMC: nothing is the default. */
struct pmc_own {
    bool is_modbus, passes, refuse;
    uint32_t baud, late;     /* Bd, 0: the default; ms */
    const char *program;     /* texts that the unit has stored at its first power-up; NULL: none */
    const char *parameters;
};

struct pmc_own pmc_own_of(const struct device_config *config);

/* The settings of a unit with so many axes. */
struct pmc_config pmc_config_of(const struct device_config *config, unsigned axes);

extern const struct device_option pmc_1hs_options[], pmc_2hs_options[];
extern const char *const pmc_setting_names[];
void pmc_put_settings(const struct device_config *config, json_t *object);
bool pmc_read_setting_1hs(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE]);
bool pmc_read_setting_2hs(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE]);
const char *pmc_settings_difference(const struct device_config *a, const struct device_config *b);

/* ---- pmc_device_files.c ---------------------------------------------------------------------------------------------------- */

/* A program or parameters as text, for a unit with `axes` axes. */
enum pmc_file { PMC_FILE_PROGRAM, PMC_FILE_PARAMETERS };

/* Is there anything wrong in the text? It, and warnings, are written to `out` as NAME:LINE:COLUMN: error: ...; NULL: they are
 * not. */
bool pmc_file_is_wrong(enum pmc_file what, unsigned axes, const char *name, const char *text, size_t length, FILE *out);

/* Give a unit the content of a text. Returns PMC_OK; PMC_BUSY; PMC_RANGE and in `error` the first that is wrong, as
 * "LINE:COLUMN: expected ...". Nothing changes unless it is PMC_OK. */
enum pmc_answer pmc_file_load(struct pmc_unit *unit, enum pmc_file what, const char *text, size_t length,
                              char error[DEVICE_ERROR_SIZE]);

/* The canonical text of what a unit has. Returns a text to be freed; NULL: out of memory. */
char *pmc_file_text(const struct pmc_unit *unit, enum pmc_file what);

/* ---- pmc_device_json.c ----------------------------------------------------------------------------------------------------- */

/* As struct device_kind's of the same names. */
json_t *pmc_json_state(const struct device_unit *unit, uint64_t t_us);
json_t *pmc_json_describe(const struct device_unit *unit, uint64_t t_us);

const char *pmc_state_name(unsigned state);

/* The name of an error: 0 is none, n the bit n - 1 of enum pmc_error. */
const char *pmc_fault_name(unsigned fault);

/* Which of the errors is shown where there is room for one: that of the highest bit. */
unsigned pmc_fault_of(uint8_t errors);

/* The errors by name, as a list. */
json_t *pmc_errors_json(uint8_t errors);

/* ---- pmc_device_methods.c, pmc_device_wire.c, pmc_device_plan.c, pmc_device_repeat.c, pmc_services.c --------------------- */

extern const struct device_method pmc_methods[];
extern const struct device_service pmc_services[];
extern const struct device_words pmc_words;
const struct device_framing *pmc_framing(const struct device_config *config);
size_t pmc_device_plan(const struct device_unit *unit, unsigned axis, struct device_plan_point *point, size_t room);

struct pmc_repeat {
    struct pmc_unit copy, present;
    uint64_t tick, power, looks;
};
uint64_t pmc_find_repeat(void *memory, const struct device_unit *unit);

#endif
