/* SPDX-License-Identifier: MIT */
/* service_command.c: service.open, service.bytes, service.close: clients of the servers that a device has. */
#include <stdlib.h>
#include <string.h>

#include "methods.h"
#include "text/text.h"

#define BYTES_MAX 65536u /* of one service.bytes */

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    c = (char)(c | 0x20);
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* Bytes from `hex` ("0007 0a") or `text`, to be freed. NULL: refused. */
static uint8_t *read_bytes(const json_t *params, size_t *length, struct refusal *refusal)
{
    const json_t *text = json_object_get(params, "text"), *hex = json_object_get(params, "hex");
    const json_t *given = text ? text : hex;
    size_t size = json_string_length(given);
    const char *from = json_string_value(given);
    uint8_t *bytes = from && !(text && hex) && size <= 3u * BYTES_MAX ? malloc(size + 1u) : NULL;
    *length = 0;
    for (size_t at = 0; bytes && hex && at < size; at++) {
        int high = hex_digit(from[at]), low = at + 1u < size ? hex_digit(from[at + 1u]) : -1;
        if (from[at] == ' ')
            continue;
        if (high < 0 || low < 0) {
            free(bytes);
            bytes = NULL;
            break;
        }
        bytes[(*length)++] = (uint8_t)(high << 4 | low);
        at++;
    }
    if (bytes && text)
        memcpy(bytes, from, *length = size);
    if (bytes && *length <= BYTES_MAX)
        return bytes;
    free(bytes);
    refuse(refusal, REFUSED_PARAMS, "expected either hex, as in \"0007 0a\", or text, of at most %u bytes", BYTES_MAX);
    return NULL;
}

/* What was sent as text, if it is one: printable characters and the ends of lines. */
static json_t *text_json(const struct sim_service_sent *sent)
{
    for (size_t i = 0; i < sent->length; i++)
        if ((sent->bytes[i] < ' ' && sent->bytes[i] != '\r' && sent->bytes[i] != '\n' && sent->bytes[i] != '\t') ||
            sent->bytes[i] > '~')
            return NULL;
    return json_stringn((const char *)sent->bytes, sent->length);
}

static json_t *result_json(const struct sim *sim, unsigned number, const struct sim_service_sent *sent)
{
    char *hex = malloc(2u * sent->length + 1u);
    if (!hex)
        return NULL;
    *put_hex(hex, sent->bytes, sent->length) = '\0';
    json_t *result = json_pack("{s:I, s:i, s:s, s:o*, s:b, s:b}", "t_us", (json_int_t)sim_now(sim), "client", (int)number, "sent",
                               hex, "text", text_json(sent), "cut", (int)sent->is_cut, "open",
                               (int)sim_service_is_open(sim, number));
    free(hex);
    return result;
}

static json_t *refuse_service(const struct sim *sim, const char *name, struct refusal *refusal)
{
    char list[200] = "";
    for (const struct device_service *service = sim_device(sim)->services; service && service->name; service++)
        snprintf(list + strlen(list), sizeof list - strlen(list), *list ? ", %s" : "%s", service->name);
    if (!*list)
        return refuse(refusal, REFUSED_PARAMS, "service: the device %s has no servers", sim_device(sim)->name);
    return refuse(refusal, REFUSED_PARAMS, "service: there is no server `%.40s': expected one of %s", name ? name : "", list);
}

static json_t *command_open(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"service", "peer", NULL};
    const json_t *peer = json_object_get(params, "peer");
    if (!params_known(params, names, refusal))
        return NULL;
    const char *name = json_string_value(json_object_get(params, "service"));
    const struct device_service *service = name ? sim_service_named(sim, name) : NULL;
    if (!service)
        return refuse_service(sim, name, refusal);
    if (peer && (!json_is_string(peer) || json_string_length(peer) >= DEVICE_PEER_SIZE))
        return refuse(refusal, REFUSED_PARAMS, "peer: expected an address of at most %u characters", DEVICE_PEER_SIZE - 1u);
    struct sim_service_sent *sent = calloc(1, sizeof *sent);
    unsigned number = sent ? sim_service_open(sim, service, peer ? json_string_value(peer) : "control") : 0;
    if (number > 0)
        sim_service_start(sim, number, sent);
    json_t *result = number > 0 ? result_json(sim, number, sent) : NULL;
    free(sent);
    if (number == 0)
        return refuse(refusal, REFUSED_STATE, "service %s: too many clients: expected at most %u at a time", name,
                      service->clients);
    return result ? result : refuse(refusal, REFUSED_MEMORY, "out of memory");
}

static json_t *command_bytes(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"client", "hex", "text", "room", NULL};
    int64_t number, room;
    size_t length, taken = 0;
    if (!params_known(params, names, refusal) || !param_integer(params, "client", 1, DEVICE_CLIENTS_MAX, &number, refusal) ||
        !param_integer_or(params, "room", 1, SIM_SERVICE_ROOM_MAX, INT64_MAX, &room, refusal))
        return NULL;
    if (!sim_service_is_open(sim, (unsigned)number))
        return refuse(refusal, REFUSED_STATE, "client: there is no client %d: open it with service.open", (int)number);
    uint8_t *bytes = read_bytes(params, &length, refusal);
    if (!bytes)
        return NULL;
    struct sim_service_sent *sent = calloc(1, sizeof *sent);
    if (sent)
        taken = sim_service_receive(sim, (unsigned)number, bytes, length, (size_t)room, sent);
    json_t *result = sent ? result_json(sim, (unsigned)number, sent) : NULL;
    if (room <= SIM_SERVICE_ROOM_MAX)
        json_object_set_new(result, "taken", json_integer((json_int_t)taken));
    free(bytes);
    free(sent);
    return result ? result : refuse(refusal, REFUSED_MEMORY, "out of memory");
}

/* Without `client`: all. */
static json_t *command_close(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"client", NULL};
    int64_t number;
    if (!params_known(params, names, refusal) ||
        !param_integer_or(params, "client", 1, DEVICE_CLIENTS_MAX, 0, &number, refusal))
        return NULL;
    if (number > 0)
        sim_service_close(sim, (unsigned)number);
    else
        sim_services_close(sim);
    return json_pack("{s:I}", "t_us", (json_int_t)sim_now(sim));
}

const struct command_method service_methods[] = {
    {"service.open", command_open, true},
    {"service.bytes", command_bytes, true},
    {"service.close", command_close, true},
    {NULL, NULL, false},
};
