/* SPDX-License-Identifier: MIT */
#include "device/rkm04_device.h"
#include "soak.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define PATIENCE (30u * SECOND)
#define VERSION_TEXT RKM04_VERSION_TEXT

static const char error_text[] = "ERROR COMMAND! ";

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

void host_receive(void *context, const uint8_t *bytes, size_t length)
{
    struct soak *soak = context;
    soak->in += length;
    for (size_t i = 0; i < length; i++)
        if (rkm04_hdlc.receive(&soak->receiver, bytes[i], 0, soak->answer, sizeof soak->answer)) {
            if (soak->exact && soak->heard > 0)
                soak_fail(soak, "an answer too many, of unit %u", soak->receiver.snode);
            soak->heard = soak->receiver.length;
        }
}

void host_send(struct soak *soak, const uint8_t *bytes, size_t length)
{
    while (length > 0) {
        size_t room = sim_room(&soak->sim), piece = room < length ? room : length;
        sim_queue_bytes(&soak->sim, bytes, piece, sim_now(&soak->sim));
        soak->out += piece;
        bytes += piece;
        length -= piece;
        if (length > 0 && piece == 0)
            sim_advance(&soak->sim, sim_due(&soak->sim));
    }
}

size_t host_frame(uint8_t node, uint8_t snode, const void *message, size_t length, uint8_t *frame)
{
    struct rkm04_sender sender = {0};
    size_t at = rkm04_hdlc.begin(&sender, node, snode, length, false, frame);
    for (size_t i = 0; i < length; i++)
        at += rkm04_hdlc.put(&sender, ((const uint8_t *)message)[i], frame + at);
    return at + rkm04_hdlc.end(&sender, frame + at);
}

void host_finish(struct soak *soak)
{
    uint64_t end = sim_now(&soak->sim) + PATIENCE;
    while (!segment_idle(&soak->sim.segment) && sim_now(&soak->sim) < end) {
        uint64_t due = sim_due(&soak->sim);
        sim_advance(&soak->sim, due < end ? due : end);
    }
    if (soak->exact && !segment_idle(&soak->sim.segment))
        soak_fail(soak, "the line does not come to rest");
}

/* ---- Requests ------------------------------------------------------------------------------------------------------- */

static void send_request(struct soak *soak, uint8_t node, const void *message, size_t length)
{
    uint8_t frame[2 * JOB_TEXT];
    soak->heard = 0;
    soak->requests++;
    host_send(soak, frame, host_frame(node, 0, message, length, frame));
    host_finish(soak);
}

size_t host_ask(struct soak *soak, unsigned unit, const void *message, size_t length)
{
    uint8_t node = (uint8_t)(unit + 1u);
    send_request(soak, node, message, length);
    for (unsigned i = 0; i < UNITS; i++)
        soak->unit[i].others += i == unit ? 0 : 2; /* receives the request and the answer */
    soak->unit[unit].requests++;
    soak->unit[unit].answers++;
    if (!soak->exact)
        return soak->heard;
    if (soak->heard == 0)
        soak_fail(soak, "unit %u does not answer message %u", node, *(const uint8_t *)message);
    soak->answers++;
    if (soak->receiver.dnode != 0 || soak->receiver.snode != node)
        soak_fail(soak, "the answer of unit %u is from %u to %u", node, soak->receiver.snode, soak->receiver.dnode);
    return soak->heard;
}

void host_send_all(struct soak *soak, const void *message, size_t length)
{
    send_request(soak, 0, message, length);
    for (unsigned i = 0; i < UNITS; i++)
        soak->unit[i].requests++;
    if (soak->exact && soak->heard > 0)
        soak_fail(soak, "unit %u answers a broadcast", soak->receiver.snode);
}

static void show(char *text, size_t room, const uint8_t *bytes, size_t length)
{
    size_t at = 0;
    for (size_t i = 0; i < length && at + 5 < room; i++)
        at += (size_t)snprintf(text + at, room - at, bytes[i] >= ' ' && bytes[i] < 127 ? "%c" : "<%02X>", bytes[i]);
    text[at] = '\0';
}

static void expect(struct soak *soak, unsigned unit, const void *wanted, size_t length)
{
    char want[300] = "", got[300] = "";
    if (soak->heard == length && memcmp(soak->answer, wanted, length) == 0)
        return;
    show(want, sizeof want, wanted, length);
    show(got, sizeof got, soak->answer, soak->heard);
    soak_fail(soak, "unit %u answers '%s', expected '%s'", unit + 1u, got, want);
}

void host_set(struct soak *soak, unsigned unit, char motor, const char *text, uint8_t flag, uint8_t character)
{
    uint8_t message[JOB_TEXT + 8] = {2, (uint8_t)motor};
    size_t length = strlen(text);
    memcpy(message + 2, text, length);
    host_ask(soak, unit, message, length + 2u);
    if (soak->exact)
        expect(soak, unit, (uint8_t[]){2, (uint8_t)motor, flag, character}, 4);
}

/* ---- Questions ------------------------------------------------------------------------------------------------------ */

/* Read a field of Get Position. Returns where it ends; 0: it is none. */
static size_t read_field(const struct soak *soak, size_t at, int64_t *position)
{
    char text[16] = "", *end;
    size_t length = at < soak->heard ? soak->answer[at] : 0;
    if (length < 10 || length >= sizeof text || at + 1u + length > soak->heard)
        return 0;
    memcpy(text, soak->answer + at + 1, length);
    *position = strtoll(text, &end, 10);
    return *end == '\0' ? at + 1u + length : 0;
}

/* While a job is under way, a position within its way will do. */
static void check_position(struct soak *soak, unsigned unit, unsigned motor, int64_t position, bool ended)
{
    const struct soak_motor *m = &soak->unit[unit].motor[motor - 1u];
    int64_t low = ended ? m->end.position : m->way.lowest, high = ended ? m->end.position : m->way.highest;
    if (position < low || position > high)
        soak_fail(soak, "unit %u, motor %u stands at %" PRId64 ", expected %" PRId64 " to %" PRId64 " after %s", unit + 1u, motor,
                  position, low, high, m->job.text);
}

static void ask_position(struct soak *soak, unsigned unit, unsigned motor, bool ended)
{
    int64_t position = 0;
    size_t at = 2;
    host_ask(soak, unit, (uint8_t[]){4, (uint8_t)('0' + motor)}, 2);
    for (unsigned i = motor > 0 ? motor : 1; i <= (motor > 0 ? motor : RKM04_MOTORS) && at > 0; i++) {
        at = read_field(soak, at, &position);
        if (at > 0)
            check_position(soak, unit, i, position, ended);
    }
    if (at != soak->heard || soak->answer[0] != 4 || soak->answer[1] != '0' + motor)
        soak_fail(soak, "unit %u: no answer to Get Position", unit + 1u);
}

void host_check_ends(struct soak *soak, unsigned unit)
{
    ask_position(soak, unit, 0, true);
}

static void ask_command(struct soak *soak, unsigned unit, unsigned motor)
{
    uint8_t wanted[JOB_TEXT + 2] = {5, (uint8_t)('0' + motor)};
    const char *text = soak->unit[unit].motor[motor - 1u].job.text;
    memcpy(wanted + 2, text, strlen(text));
    host_ask(soak, unit, wanted, 2);
    expect(soak, unit, wanted, 2 + strlen(text));
}

/* The text of an answer after message number and motor. */
static const char *answer_text(struct soak *soak, uint8_t number, unsigned motor)
{
    if (soak->heard < 2 || soak->answer[0] != number || soak->answer[1] != '0' + motor || soak->heard >= sizeof soak->answer)
        soak_fail(soak, "no answer to message %u", number);
    soak->answer[soak->heard] = '\0';
    return (const char *)soak->answer + 2;
}

static void ask_profile(struct soak *soak, unsigned unit, unsigned motor)
{
    unsigned points = 0, counted = 0;
    int end = 0;
    host_ask(soak, unit, (uint8_t[]){6, (uint8_t)('0' + motor)}, 2);
    const char *text = answer_text(soak, 6, motor), *close = strchr(text, ']');
    for (const char *at = text; (at = strchr(at, '(')) != NULL; at++)
        counted++;
    if (sscanf(text, " %u;[%n", &points, &end) != 1 || end == 0 || points != counted || !close || close[1] != '\0')
        soak_fail(soak, "unit %u, motor %u: profile '%s'", unit + 1u, motor, text);
}

static void ask_place(struct soak *soak, unsigned unit, unsigned motor)
{
    const struct soak_motor *m = &soak->unit[unit].motor[motor - 1u];
    unsigned steps = 0, index = 0;
    int end = 0;
    host_ask(soak, unit, (uint8_t[]){7, (uint8_t)('0' + motor)}, 2);
    const char *text = answer_text(soak, 7, motor);
    if (sscanf(text, " %u; %u%n", &steps, &index, &end) != 2 || text[end] != '\0' || index > m->job.count || steps > m->way.steps)
        soak_fail(soak, "unit %u, motor %u: at place '%s' of %u commands", unit + 1u, motor, text, m->job.count);
}

static void ask_version(struct soak *soak, unsigned unit)
{
    uint8_t wanted[64] = {1, sizeof VERSION_TEXT - 1};
    memcpy(wanted + 2, VERSION_TEXT, sizeof VERSION_TEXT - 1);
    host_ask(soak, unit, wanted, 1);
    expect(soak, unit, wanted, sizeof VERSION_TEXT + 1);
}

/* Requests that are refused: for all motors (P5), and unknown ones. */
static void ask_wrongly(struct soak *soak, unsigned unit)
{
    uint8_t wanted[32] = {(uint8_t)dice_roll(&soak->dice, 5, 7), '0'}, unknown = (uint8_t)dice_roll(&soak->dice, 8, 255);
    memcpy(wanted + 2, error_text, sizeof error_text - 1);
    if (dice_chance(&soak->dice, 50)) {
        host_ask(soak, unit, wanted, 2);
        expect(soak, unit, wanted, sizeof error_text + 1);
    } else {
        host_ask(soak, unit, &unknown, 1);
        expect(soak, unit, (uint8_t[]){255, unknown, 0, 0}, 4);
    }
}

/* Programs of which nothing is executed (P2). */
static void set_wrongly(struct soak *soak, unsigned unit, unsigned motor)
{
    static const struct {
        const char *text;
        uint8_t flag;
        char character;
    } wrong[] = {
        {"\\ F0 R", 1, 'F'}, {"F100 R q", 2, 'q'}, {"\\C100 V16001", 1, 'V'}, {"R R I01X5", 1, 'I'}, {"{ open", 2, '{'},
        {"T09", 1, 'T'}, {"=+5", 1, '='}, {"F5000000000 R", 1, 'F'}, {"7", 2, '7'}, {"\\ @81", 1, '@'},
    };
    size_t which = (size_t)dice_roll(&soak->dice, 0, sizeof wrong / sizeof *wrong - 1);
    host_set(soak, unit, (char)('0' + motor), wrong[which].text, wrong[which].flag, (uint8_t)wrong[which].character);
}

void host_poll(struct soak *soak, unsigned unit)
{
    unsigned motor = (unsigned)dice_roll(&soak->dice, 1, RKM04_MOTORS);
    switch (dice_roll(&soak->dice, 0, 9)) {
    case 0:
        ask_version(soak, unit);
        break;
    case 1:
        ask_command(soak, unit, motor);
        break;
    case 2:
        ask_profile(soak, unit, motor);
        break;
    case 3:
        ask_place(soak, unit, motor);
        break;
    case 4:
        ask_wrongly(soak, unit);
        break;
    case 5:
        set_wrongly(soak, unit, motor);
        break;
    case 6:
        ask_position(soak, unit, motor, false);
        break;
    default:
        ask_position(soak, unit, 0, false);
        break;
    }
}

/* ---- Counters ------------------------------------------------------------------------------------------------------- */

void counters_begin(struct soak *soak)
{
    for (unsigned i = 0; i < UNITS; i++) {
        struct soak_unit *unit = &soak->unit[i];
        unit->begin = rkm04_counters(rkm04_of(sim_core(&soak->sim, i + 1u)));
        unit->requests = unit->answers = unit->others = unit->dropped = 0;
    }
    soak->line_begin = segment_counters(&soak->sim.segment).bytes;
    soak->host_begin = soak->in + soak->out;
}

static void check_counter(struct soak *soak, unsigned unit, const char *name, uint32_t got, uint32_t wanted)
{
    if (got != wanted)
        soak_fail(soak, "unit %u has counted %" PRIu32 " %s, expected %" PRIu32, unit + 1u, got, name, wanted);
}

void counters_check(struct soak *soak)
{
    host_finish(soak);
    for (unsigned i = 0; i < UNITS; i++) {
        const struct soak_unit *unit = &soak->unit[i];
        struct rkm04_counters now = rkm04_counters(rkm04_of(sim_core(&soak->sim, i + 1u)));
        check_counter(soak, i, "requests", now.requests - unit->begin.requests, unit->requests);
        check_counter(soak, i, "answers", now.answers - unit->begin.answers, unit->answers);
        check_counter(soak, i, "frames for others", now.others - unit->begin.others, unit->others);
        check_counter(soak, i, "dropped frames", now.dropped - unit->begin.dropped, unit->dropped);
    }
    uint64_t line = segment_counters(&soak->sim.segment).bytes - soak->line_begin;
    uint64_t host = soak->in + soak->out - soak->host_begin;
    if (line != host)
        soak_fail(soak, "%" PRIu64 " bytes on the line, but the master sent and heard %" PRIu64, line, host);
}
