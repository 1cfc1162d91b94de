/* SPDX-License-Identifier: MIT */
#include "event_json.h"

#include "text/text.h"

#define PLAIN_ROOM 192u                                  /* every member with a number or a name */
#define SENDERS_ROOM ((SEGMENT_UNITS + 1u) * (NODE_NAME_SIZE + 3u)) /* `from` */
#define ESCAPED 6u                                       /* characters for one of a text, as in \u001F */

static size_t text_room(const char *text)
{
    return text ? ESCAPED * strlen(text) + 2u : 4u;
}

size_t event_json_room(const struct watch_event *event)
{
    size_t room = PLAIN_ROOM;
    switch ((enum watch_kind)event->kind) {
    case WATCH_BYTE:
        return room + SENDERS_ROOM;
    case WATCH_MESSAGE:
        room += SENDERS_ROOM + PLAIN_ROOM + 2u * (event->message->raw_length + event->message->length);
        return room + text_room(event->message->dropped) + text_room(event->message->refused);
    case WATCH_PLANT:
    case WATCH_INJECTED:
    case WATCH_NOTE:
        return room + text_room(event->text);
    case WATCH_SERVICE:
        return room + text_room(event->service->name) + 2u * event->service->length;
    case WATCH_CELL:
        return room + ESCAPED * WATCH_CELL_NAME_SIZE;
    default:
        return room;
    }
}

/* A text in quotes; NULL: null. */
static char *put_string(char *at, const char *text)
{
    if (!text)
        return put_text(at, "null");
    *at++ = '"';
    for (; *text; text++) {
        uint8_t character = (uint8_t)*text;
        if (character < ' ') {
            at = put_hex(put_text(at, "\\u00"), &character, 1);
            continue;
        }
        if (character == '"' || character == '\\')
            *at++ = '\\';
        *at++ = *text;
    }
    *at++ = '"';
    return at;
}

static char *put_senders(char *at, const struct sim *sim, uint32_t senders)
{
    at = put_text(at, ",\"from\":[");
    const char *between = "";
    if ((senders & 1u) != 0) {
        at = put_text(at, "\"master\"");
        between = ",";
    }
    for (unsigned number = 1; number <= sim_units(sim); number++) {
        if ((senders >> number & 1u) == 0)
            continue;
        at = put_string(put_text(at, between), sim->unit[number - 1u].name);
        between = ",";
    }
    *at++ = ']';
    return at;
}

static const char *truth(bool holds)
{
    return holds ? "true" : "false";
}

static char *put_byte(char *at, const struct sim *sim, const struct segment_byte *byte)
{
    at = put_number(at, byte->byte);
    at = put_senders(at, sim, byte->senders);
    return put_text(put_text(at, ",\"lost\":"), truth(byte->lost));
}

static char *put_message(char *at, const struct sim *sim, const struct wire_message *message)
{
    at = message->length > 0 ? put_number(at, message->message[0]) : put_text(at, "null");
    at = put_senders(at, sim, message->senders);
    at = put_number(put_text(at, ",\"dnode\":"), message->dnode);
    at = put_number(put_text(at, ",\"snode\":"), message->snode);
    at = put_text(put_text(at, ",\"answer\":"), truth(message->answer));
    at = put_number(put_text(at, ",\"start_us\":"), message->start);
    at = put_hex(put_text(at, ",\"bytes\":\""), message->raw, message->raw_length);
    at = put_hex(put_text(at, "\",\"message\":\""), message->message, message->length);
    at = put_string(put_text(at, "\",\"dropped\":"), message->dropped);
    return put_string(put_text(at, ",\"refused\":"), message->refused);
}

static char *put_service(char *at, const struct watch_service *service)
{
    at = put_string(put_text(at, ",\"service\":"), service->name);
    at = put_string(put_text(at, ",\"act\":"), watch_service_act_name(service->act));
    at = put_hex(put_text(at, ",\"bytes\":\""), service->bytes, service->length);
    return put_text(at, "\"");
}

static char *put_value(char *at, const struct sim *sim, const struct watch_event *event)
{
    switch ((enum watch_kind)event->kind) {
    case WATCH_LED:
        return put_string(at, sim_device(sim)->led_name((unsigned)event->value));
    case WATCH_FAULT:
        return put_string(at, sim_device(sim)->fault_name((unsigned)event->value));
    case WATCH_BYTE:
        return put_byte(at, sim, &event->byte);
    case WATCH_MESSAGE:
        return put_message(at, sim, event->message);
    case WATCH_PLANT:
        return put_string(put_text(put_string(at, plant_event_name((enum plant_event)event->value)), ",\"text\":"), event->text);
    case WATCH_INJECTED:
    case WATCH_NOTE:
        return put_string(put_text(put_signed(at, event->value), ",\"text\":"), event->text);
    case WATCH_SERVICE:
        return put_service(put_signed(at, event->value), event->service);
    case WATCH_CELL:
        return put_signed(at, event->cell);
    case WATCH_INPUTS:
    case WATCH_OUTPUTS:
    case WATCH_VARIABLES:
        return put_number(at, (uint32_t)event->value);
    default:
        return put_signed(at, event->value);
    }
}

char *event_time(char *at, const struct sim *sim, const struct watch_event *event)
{
    at = put_number(at, event->tick);
    if (sim_device(sim)->ticks_per_us == 1)
        return at;
    const unsigned ns = watch_ns(event);
    *at++ = '.';
    *at++ = (char)('0' + ns / 100u);
    *at++ = (char)('0' + ns / 10u % 10u);
    *at++ = (char)('0' + ns % 10u);
    return at;
}

char *event_json(char *at, const struct sim *sim, const struct watch_event *event)
{
    at = event_time(put_text(at, "\"t_us\":"), sim, event);
    at = put_text(put_text(at, ",\"kind\":\""), watch_kind_name((enum watch_kind)event->kind));
    *at++ = '"';
    if (event->unit != 0)
        at = put_string(put_text(at, ",\"unit\":"), sim->unit[event->unit - 1u].name);
    if (event->motor != 0) {
        at = put_number(put_text(at, ",\"motor\":"), event->motor);
    }
    if (event->kind == WATCH_CELL)
        at = put_string(put_text(at, ",\"cell\":"), sim->watch.cells[event->number].name);
    else if (event->number != 0)
        at = put_string(put_text(at, ",\"name\":"), sim_device(sim)->value_names[event->number - 1u]);
    return put_value(put_text(at, ",\"value\":"), sim, event);
}
