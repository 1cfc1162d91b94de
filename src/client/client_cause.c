/* SPDX-License-Identifier: MIT */
#include "client_cause.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "client_report.h"
#include "client_rpc.h"

#define CALL_MS 1000 /* of an emulator that hangs; then no more is asked */
#define UNITS_MAX 16u

struct cause {
    struct client_rpc rpc;
    unsigned node;
    unsigned addresses[UNITS_MAX], count; /* of the units that have power */
    unsigned here, unpowered;             /* units with the address that was asked; of these, without power */
    json_int_t collisions;
    bool stepped;
};

/* Connect to the control socket, or by the control file, next to the link. Returns false if there is none. */
static bool connect_beside(struct cause *cause, const char *port)
{
    char path[PATH_MAX];
    struct stat found;
    if (strncmp(port, "tcp:", 4) == 0 || snprintf(path, sizeof path, "%s.control", port) >= PATH_MAX)
        return false;
    cause->rpc.quiet = true;
    return stat(path, &found) == 0 && (S_ISSOCK(found.st_mode) || S_ISREG(found.st_mode)) &&
           client_rpc_open(&cause->rpc, path);
}

/* Returns NULL if the emulator does not answer. */
static json_t *call(struct cause *cause, const char *method, json_t *params)
{
    json_t *result = NULL;
    if (client_rpc_call(&cause->rpc, method, params, CALL_MS, &result) == CLIENT_RPC_RESULT)
        return result;
    json_decref(result);
    return NULL;
}

static bool read_unit(struct cause *cause, const char *name)
{
    json_t *state = call(cause, "state", json_pack("{s:s}", "unit", name));
    if (!state)
        return false;
    unsigned node = (unsigned)json_integer_value(json_object_get(state, "node"));
    const char *clock = json_string_value(json_object_get(state, "clock"));
    bool powered = json_is_true(json_object_get(state, "powered"));
    cause->collisions = json_integer_value(json_object_get(json_object_get(state, "line"), "collisions"));
    cause->stepped = clock && strcmp(clock, "stepped") == 0;
    cause->here += node == cause->node;
    cause->unpowered += node == cause->node && !powered;
    if (powered)
        cause->addresses[cause->count++] = node;
    json_decref(state);
    return true;
}

/* Returns whether there is another framing, and prints it. */
static bool print_framing(const json_t *units, const struct rkm04_framing *asked)
{
    const char *name = json_string_value(json_object_get(units, "framing"));
    const struct rkm04_framing *framing = name ? rkm04_framing_named(name) : NULL;
    if (!framing || framing == asked)
        return false;
    client_advise("  - the units of this emulator use the framing %s: try --framing %s.\n", framing->name, framing->name);
    return true;
}

static void print_addresses(const struct cause *cause)
{
    client_advise("  - no unit of this emulator has the address %u; there %s", cause->node, cause->count ? "are" : "is none");
    for (unsigned i = 0; i < cause->count; i++)
        client_advise("%s %u", i > 0 ? "," : "", cause->addresses[i]);
    client_advise("%s", cause->count ? ": select one with -n.\n" : " that has power.\n");
}

static bool print_units(const struct cause *cause)
{
    unsigned powered = cause->here - cause->unpowered;
    if (cause->here == 0)
        print_addresses(cause);
    else if (powered == 0)
        client_advise("  - unit %u of this emulator is without power (power on).\n", cause->node);
    if (powered > 1)
        client_advise("  - %u units of this emulator have the address %u: their answers collide (%" JSON_INTEGER_FORMAT
                " bytes in collisions so far).\n", powered, cause->node, cause->collisions);
    if (cause->stepped)
        client_advise("  - the time of this emulator is stopped until a control client advances it (--clock stepped).\n");
    return powered != 1 || cause->stepped;
}

bool client_print_emulator_causes(const char *port, const struct rkm04_framing *framing, unsigned node)
{
    size_t i;
    json_t *unit;
    struct cause cause = {.node = node};
    if (!connect_beside(&cause, port))
        return false;
    json_t *units = call(&cause, "units", NULL);
    bool ok = units != NULL, printed = false;
    json_array_foreach(json_object_get(units, "units"), i, unit) {
        ok = ok && i < UNITS_MAX && json_is_string(unit) && read_unit(&cause, json_string_value(unit));
    }
    if (ok) {
        printed = print_framing(units, framing);
        printed = print_units(&cause) || printed;
    }
    json_decref(units);
    client_rpc_close(&cause.rpc);
    return printed;
}
