/* SPDX-License-Identifier: MIT */
#include "bus_service.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "command/command.h"

#define LOGGED_MAX 200u             /* clients that come and go, in the log */
#define ANSWERS_MAX (SERVICE_OUT_MAX / 4u) /* bytes; then the client has to read before more of what it has sent is executed */

struct one {
    struct bus_services *all;
    const char *name; /* of the service */
    struct service_port port;
};

struct bus_services {
    const struct bus_log *log;
    const struct bus_service_calls *calls;
    void *context;
    unsigned count, clients, logged;
    struct one one[DEVICE_SERVICES_MAX];
};

static void log_client(struct bus_services *all, const char *name, unsigned client, const char *what)
{
    if (all->logged++ < LOGGED_MAX)
        bus_log_detail(all->log, "%s: client %u %s", name, client, what);
}

/* Do a command on behalf of a client. Returns its result, a new reference; NULL: refused. */
static json_t *call(struct bus_services *all, const char *method, json_t *params)
{
    struct refusal refusal = {0};
    struct sim *sim = all->calls->sim(all->context);
    json_t *result = params ? sim_command(sim, method, params, &refusal) : NULL;
    json_decref(params);
    all->calls->changed(all->context);
    all->calls->presence(all->context);
    return result;
}

/* ---- Calls of a port ------------------------------------------------------------------------------------------------ */

static unsigned from_hex(char c)
{
    return (unsigned)(c <= '9' ? c - '0' : c - 'A' + 10);
}

static void greet(struct one *one, const char *hex)
{
    for (; hex && hex[0] && hex[1]; hex += 2) {
        uint8_t byte = (uint8_t)(from_hex(hex[0]) << 4 | from_hex(hex[1]));
        service_port_greet(&one->port, &byte, 1);
    }
}

static unsigned on_open(void *context, const char *peer)
{
    struct one *one = context;
    json_t *result = call(one->all, "service.open", json_pack("{s:s, s:s}", "service", one->name, "peer", peer));
    unsigned client = result ? (unsigned)json_integer_value(json_object_get(result, "client")) : 0;
    greet(one, json_string_value(json_object_get(result, "sent")));
    json_decref(result);
    one->all->clients += client > 0;
    log_client(one->all, one->name, client, client > 0 ? peer : "refused: too many");
    return client;
}

static size_t on_bytes(void *context, unsigned client, const uint8_t *bytes, size_t length)
{
    struct one *one = context;
    char hex[2u * SERVICE_IN + 1u];
    *put_hex(hex, bytes, length) = '\0';
    json_t *result = call(one->all, "service.bytes",
                          json_pack("{s:i, s:s, s:i}", "client", (int)client, "hex", hex, "room", (int)ANSWERS_MAX));
    const size_t taken = result ? (size_t)json_integer_value(json_object_get(result, "taken")) : length;
    json_decref(result);
    return taken;
}

static void on_closed(void *context, unsigned client, const char *why)
{
    struct one *one = context;
    one->all->clients--;
    log_client(one->all, one->name, client, why ? why : "has gone");
    json_decref(call(one->all, "service.close", json_pack("{s:i}", "client", (int)client)));
}

static const struct service_port_calls port_calls = {.open = on_open, .bytes = on_bytes, .closed = on_closed};

void bus_services_send(struct bus_services *all, unsigned client, const uint8_t *bytes, size_t length)
{
    for (unsigned at = 0; all && at < all->count; at++) {
        if (length > 0)
            service_port_send(&all->one[at].port, client, bytes, length);
        else if (service_port_hang_up(&all->one[at].port, client))
            all->clients--;
    }
}

unsigned bus_services_clients(const struct bus_services *all)
{
    return all ? all->clients : 0;
}

const char *bus_services_address(const struct bus_services *all, unsigned at)
{
    return all && at < all->count ? all->one[at].port.address : NULL;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static const struct device_service *service_named(const struct device_kind *kind, const char *name)
{
    const struct device_service *service = kind->services;
    while (service && service->name && strcmp(service->name, name) != 0)
        service++;
    return service && service->name ? service : NULL;
}

static bool open_one(struct bus_services *all, const struct bus_options *options, unsigned at, uv_loop_t *loop)
{
    char own[NET_NAME_SIZE];
    struct one *one = &all->one[at];
    const struct device_service *service = service_named(options->device.kind, options->service[at].name);
    one->all = all;
    one->name = service->name;
    if (!name_address(options->service[at].address, all->log->number, own, sizeof own)) {
        log_error("%s: no TCP port for bus %u: expected a port of at most 65535 minus the number of buses",
                  options->service[at].address, all->log->number);
        return false;
    }
    all->count = at + 1u;
    return service_port_open(&one->port, loop, own, service->refusal, &port_calls, one);
}

bool bus_services_open(struct bus_services **services, const struct bus_options *options, const struct bus_log *log,
                       uv_loop_t *loop, const struct bus_service_calls *calls, void *context)
{
    struct bus_services *all = *services = calloc(1, sizeof *all);
    if (!all) {
        log_error("out of memory");
        return false;
    }
    *all = (struct bus_services){.log = log, .calls = calls, .context = context};
    for (unsigned at = 0; at < DEVICE_SERVICES_MAX && options->service[at].name; at++)
        if (!open_one(all, options, at, loop))
            return false;
    return true;
}

void bus_services_close(struct bus_services *all)
{
    for (unsigned at = 0; all && at < all->count; at++)
        service_port_close(&all->one[at].port);
}

void bus_services_free(struct bus_services *all)
{
    free(all);
}
