/* SPDX-License-Identifier: MIT */
/* rkm04_device.h: the RKM04 as a kind of device, what is only true of it. For the room, and for tests that look into an RKM04. */
#ifndef RKM04_DEVICE_RKM04_DEVICE_H
#define RKM04_DEVICE_RKM04_DEVICE_H

#include <jansson.h>

#include <rkm04/unit.h>

#include "device.h"

/* A unit: what struct device_unit is for this kind. */
struct rkm04_device {
    struct rkm04_unit unit;
    struct rkm04_port port;          /* calls that pass on to `outer` */
    const struct device_port *outer;
    void *context;                   /* of `outer` */
};

/* The RKM04 in a unit of this kind. */
struct rkm04_unit *rkm04_of(struct device_unit *unit);

/* ---- rkm04_json.c, rkm04_waits.c: as struct device_kind's of the same names ------------------------------------------ */

json_t *rkm04_json_state(const struct rkm04_unit *unit, uint64_t tick);
json_t *rkm04_json_describe(const struct rkm04_unit *unit, uint64_t tick);
json_t *rkm04_json_program(const struct rkm04_unit *unit, unsigned motor);

/* What motor 1..4 of `unit` waits for, in words. Returns a new reference: a string, or JSON null if it waits for nothing; NULL:
 * out of memory. */
json_t *rkm04_waits_json(const struct rkm04_unit *unit, unsigned motor);

/* The label 1..80 that a jump or call of a motor waits for (C7); 0: it does not. */
unsigned rkm04_awaited_label(const struct rkm04_motor *motor);

/* What a config has of an RKM04. */
struct rkm04_own {
    struct rkm04_config config;
    readings_set chosen; /* by options or a scenario */
};

#define RKM04_VERSION_TEXT_MAX 255u /* bytes */

/* ---- rkm04_options.c ---------------------------------------------------------------------------------------------------- */

extern const struct device_option rkm04_options[];
extern const struct device_readings rkm04_device_readings;

/* ---- rkm04_settings.c: as struct device_kind's ------------------------------------------------------------------------- */

extern const char *const rkm04_setting_names[];
void rkm04_put_settings(const struct device_config *config, json_t *object);
bool rkm04_read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE]);
const char *rkm04_settings_difference(const struct device_config *a, const struct device_config *b);
const struct device_framing *rkm04_settings_framing(const struct device_config *config);

/* ---- rkm04_coverage.c ---------------------------------------------------------------------------------------------------- */

extern const struct device_coverage rkm04_coverage;

/* ---- rkm04_program_message.c --------------------------------------------------------------------------------------------- */

extern const struct device_program_message rkm04_program_message;

/* ---- rkm04_words.c ------------------------------------------------------------------------------------------------------ */

extern const struct device_words rkm04_device_words;

#endif
