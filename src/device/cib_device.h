/* SPDX-License-Identifier: MIT */
/* cib_device.h: the CIB module as a kind of device, what is only true of it. For the room, and for tests that look into
 * a module. */
#ifndef RKM04_DEVICE_CIB_DEVICE_H
#define RKM04_DEVICE_CIB_DEVICE_H

#include <jansson.h>

#include "cib/cib.h"
#include "cib_faces/cib_faces.h"
#include "device.h"

/* A unit: what struct device_unit is for this kind. */
struct cib_device {
    struct cib_unit unit;
    struct cib_rtu rtu;
    struct cib_port port;            /* calls that pass on to `outer` */
    const struct device_port *outer;
    void *context;                   /* of `outer` */
    uint8_t fault[CIB_DRIVES];       /* MCERR as last reported */
    uint16_t status;                 /* MCSTAT of both, as last reported */
};

#define CIB_ERROR_MAX 5u /* MCERR */

static inline struct cib_device *cib_device_of(struct device_unit *unit)
{
    return (struct cib_device *)unit;
}

static inline const struct cib_device *cib_device_read(const struct device_unit *unit)
{
    return (const struct cib_device *)unit;
}

/* ---- cib_json.c --------------------------------------------------------------------------------------------------------- */

/* What a drive does, in a word. */
enum cib_state { CIB_IDLE, CIB_MOVING, CIB_STOPPING, CIB_TURNING };
enum cib_state cib_state_of(const struct cib_drive_state *state);
const char *cib_state_name(unsigned state); /* NULL: no state */

json_t *cib_json_state(const struct device_unit *unit, uint64_t t_us);
json_t *cib_json_describe(const struct device_unit *unit, uint64_t t_us);

/* ---- cib_settings.c ----------------------------------------------------------------------------------------------------- */

/* What a config has of a module. */
struct cib_settings {
    struct cib_config config;
    uint32_t silence; /* us */
};

struct cib_settings cib_settings_of(const struct device_config *config);

extern const struct device_option cib_options[];
extern const char *const cib_setting_names[];
void cib_put_settings(const struct device_config *config, json_t *object);
bool cib_read_setting(struct device_config *config, const char *name, const json_t *value, char error[DEVICE_ERROR_SIZE]);
const char *cib_settings_difference(const struct device_config *a, const struct device_config *b);

/* ---- cib_setup.c: the configuration as people write it ------------------------------------------------------------------ */

/* As JSON: {"do1-2": {"use": "drive", …}, …}; NULL: out of memory. */
json_t *cib_setup_json(const struct cib_setup *setup);

/* Change what the object names. Returns false and a message; then *setup is as it was. Ranges are checked as far as registers
 * have room; cib_setup_check() is due. */
bool cib_setup_read_json(struct cib_setup *setup, const json_t *object, char error[DEVICE_ERROR_SIZE]);

/* The same from a file's node, with errors reported there. */
bool cib_setup_read_node(struct cib_setup *setup, const struct config_node *node);

/* Is it one that APPLY takes? Otherwise the message names what is wrong. */
bool cib_setup_check(const struct cib_setup *setup, uint16_t firmware, char error[DEVICE_ERROR_SIZE]);

/* The name of the entry of a register: "do1-2.use"; NULL: it has none. */
const char *cib_setup_name(uint16_t address, char name[DEVICE_COMMAND_SIZE]);

/* The setup that the host proposes, and the one that counts. */
struct cib_setup cib_setup_read(const struct cib_unit *unit, enum cib_zone zone);

/* Write the proposal. */
void cib_setup_write(struct cib_unit *unit, const struct cib_setup *setup);

/* ---- cib_methods.c, cib_words.c, cib_framing.c ---------------------------------------------------------------------------- */

extern const struct device_method cib_methods[];
extern const struct device_service cib_services[]; /* cib_services.c */
extern const struct device_words cib_words;
extern const struct device_framing cib_framing;

#endif
