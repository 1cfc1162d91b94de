/* SPDX-License-Identifier: MIT */
#include "wire_monitor.h"

#include <stdlib.h>
#include <string.h>

#include "wire_words.h"

#define MASTER_BIT 1u
#define HDLC_FLAG 0x7E
#define HDLC_ESCAPE 0x7D
#define SILENCE (US_PER_SECOND / 10u) /* L2 */
#define ASTRAY_MAX 256u /* bytes without a frame that are told of at a time */
#define REASON_MAX 120u /* characters of a reason put together */

static const char *const fates[] = {
    [WIRE_WHOLE] = NULL,
    [WIRE_WRONG_CHECK] = "wrong FCS",
    [WIRE_ABORTED] = "aborted",
    [WIRE_TOO_SHORT] = "too short",
    [WIRE_TOO_LONG] = "too long",
    [WIRE_OUTSIDE] = "no frame",
    [WIRE_NO_ADDRESS] = "no frame, no address above 16",
    [WIRE_NO_LENGTH] = "impossible length",
    [WIRE_SILENT] = "silence inside",
    [WIRE_MALFORMED] = "malformed",
    [WIRE_UNFINISHED] = "unfinished",
    [WIRE_FRAMING_ERROR] = "framing error",
    [WIRE_BREAK] = "break",
};

/* ---- Why nobody obeys ----------------------------------------------------------------------------------------------- */

static void ignored_for_address(struct wire_text *out, const struct segment *segment, uint8_t dnode)
{
    bool there = false;
    for (unsigned number = 1; number <= segment->units; number++) {
        const struct segment_unit *unit = &segment->unit[number - 1u];
        if (dnode != 0 && segment->config.kind->node(unit->unit) != dnode)
            continue;
        if (unit->powered)
            return;
        there = true;
    }
    if (dnode == 0)
        wire_text_string(out, "no unit has power");
    else {
        wire_text_string(out, there ? "no power at unit " : "there is no unit ");
        wire_text_number(out, dnode, 0);
    }
}

/* Why a whole request is obeyed by nobody. Nothing if somebody may obey it. */
static void words_ignored(struct wire_text *out, const struct segment *segment, const struct wire_ear_monitor *ear)
{
    const struct rkm04_receiver *frame = &ear->receiver;
    if (frame->snode >= 1 && frame->snode <= RKM04_NODE_MAX)
        wire_text_string(out, "by its sender's address it is the answer of a unit (L1)");
    else if (frame->dnode == 0 && ear->message[0] != 2 && ear->message[0] != 3)
        wire_text_string(out, "a request to all units is not answered (P10)");
    else
        ignored_for_address(out, segment, frame->dnode);
    if (out->length == 0 && ear->overruns > 0)
        wire_text_string(out, "bytes lost, a unit had a request waiting (P10)");
}

/* ---- Messages ------------------------------------------------------------------------------------------------------- */

static const uint8_t *append(struct wire_message *message, size_t *used, const void *bytes, size_t length)
{
    uint8_t *place = message->bytes + *used;
    if (length > 0)
        memcpy(place, bytes, length);
    *used += length;
    return place;
}

/* A message out of what stands in the ear. Returns NULL if out of memory. */
static struct wire_message *make_message(const struct segment *segment, const struct wire_ear_monitor *ear,
                                         enum wire_fate fate)
{
    size_t length = fate == WIRE_WHOLE ? ear->receiver.length : 0, used = 0;
    char reason[REASON_MAX];
    struct wire_text text = {.text = reason, .room = sizeof reason};
    struct wire_message *message = malloc(sizeof *message + ear->raw_length + length + sizeof reason);
    if (!message)
        return NULL;
    *message = (struct wire_message){
        .start = ear->start,
        .end = ear->last,
        .senders = ear->senders,
        .collided = ear->collided,
        .lost = ear->lost,
        .fate = fate,
        .answer = ear->answer,
        .dropped = fates[fate],
        .raw_total = ear->raw_total,
        .raw_length = ear->raw_length,
        .length = length,
    };
    message->raw = append(message, &used, ear->raw, ear->raw_length);
    message->message = append(message, &used, ear->message, length);
    if (fate != WIRE_WHOLE)
        return message;
    message->dnode = ear->receiver.dnode;
    message->snode = ear->receiver.snode;
    if (ear->answer)
        wire_words_refusal(&text, message->message, length);
    else
        words_ignored(&text, segment, ear);
    wire_text_end(&text);
    if (text.length == 0)
        return message;
    const char *why = (const char *)append(message, &used, text.text, text.length + 1u);
    if (ear->answer)
        message->refused = why;
    else
        message->ignored = why;
    return message;
}

static void empty_ear(struct wire_ear_monitor *ear)
{
    ear->raw_length = ear->raw_total = 0;
    ear->senders = ear->collided = 0;
    ear->lost = 0;
    ear->overruns = 0;
}

/* What stands in the ear has come to an end. */
static void report(const struct wire_monitor *monitor, struct wire_ear_monitor *ear, uint64_t tick, enum wire_fate fate)
{
    const struct wire_monitor_calls *calls = &monitor->calls;
    if (ear->raw_total > 0 && calls->is_wanted && calls->is_wanted(calls->context))
        calls->message(calls->context, tick, make_message(monitor->segment, ear, fate));
    empty_ear(ear);
}

/* A byte that nobody has got. */
static void report_lost(const struct wire_monitor *monitor, const struct segment_byte *byte, bool answer)
{
    uint8_t raw = byte->byte;
    struct wire_ear_monitor ear = {
        .raw = &raw,
        .raw_length = 1,
        .raw_total = 1,
        .start = byte->start,
        .last = byte->tick,
        .senders = byte->senders,
        .collided = (byte->senders & (byte->senders - 1u)) != 0 ? byte->senders : 0,
        .answer = answer,
    };
    report(monitor, &ear, byte->tick, raw == 0 && ear.collided == 0 ? WIRE_BREAK : WIRE_FRAMING_ERROR);
}

/* ---- Framings ------------------------------------------------------------------------------------------------------- */

static void keep_byte(struct wire_ear_monitor *ear, const struct segment_byte *byte)
{
    if (ear->raw_total++ == 0)
        ear->start = byte->start;
    if (ear->raw_length < WIRE_RAW_MAX)
        ear->raw[ear->raw_length++] = byte->byte;
    ear->senders |= byte->senders;
    if ((byte->senders & (byte->senders - 1u)) != 0)
        ear->collided |= byte->senders;
    ear->last = byte->tick;
}

/* What the framing has to say about a byte; UNDECIDED: nothing yet. */
enum verdict { UNDECIDED, GOOD, BAD_CHECK, MALFORMED, TOO_LONG };

static enum verdict receive(const struct rkm04_framing *framing, struct wire_ear_monitor *ear, const struct segment_byte *byte)
{
    uint32_t bad_check = ear->receiver.bad_check, malformed = ear->receiver.malformed, too_long = ear->receiver.too_long;
    if (framing->receive(&ear->receiver, byte->byte, byte->tick, ear->message, ear->room))
        return GOOD;
    if (ear->receiver.bad_check != bad_check)
        return BAD_CHECK;
    if (ear->receiver.malformed != malformed)
        return MALFORMED;
    return ear->receiver.too_long != too_long ? TOO_LONG : UNDECIDED;
}

/* A flag ends what goes before it, frames or what is none. What is astray is told of after a silence, too, so that a client that
 * never sends a flag is not passed over. */
static void receive_hdlc(const struct wire_monitor *monitor, struct wire_ear_monitor *ear, const struct segment_byte *byte)
{
    bool flag = byte->byte == HDLC_FLAG;
    if (ear->astray != WIRE_WHOLE &&
        (flag || byte->tick - ear->last >= SILENCE || (ear->astray == WIRE_OUTSIDE && ear->raw_total == ASTRAY_MAX))) {
        report(monitor, ear, byte->tick, ear->astray);
        ear->astray = flag ? WIRE_WHOLE : WIRE_OUTSIDE;
    }
    if (flag && ear->raw_length == 1 && ear->raw[0] == HDLC_FLAG)
        empty_ear(ear); /* an empty frame is nothing; this flag may begin one */
    keep_byte(ear, byte);
    switch (receive(&rkm04_hdlc, ear, byte)) {
    case UNDECIDED:
        break;
    case GOOD:
        report(monitor, ear, byte->tick, WIRE_WHOLE);
        break;
    case BAD_CHECK:
        report(monitor, ear, byte->tick, WIRE_WRONG_CHECK);
        break;
    case MALFORMED: {
        bool aborted = ear->raw_length >= 2 && ear->raw[ear->raw_length - 2u] == HDLC_ESCAPE;
        report(monitor, ear, byte->tick, aborted ? WIRE_ABORTED : WIRE_TOO_SHORT);
        break;
    }
    case TOO_LONG:
        ear->astray = WIRE_TOO_LONG;
        break;
    }
}

/* Bytes that cannot be an address are gathered until one comes that can. */
static void receive_plain(const struct wire_monitor *monitor, struct wire_ear_monitor *ear, const struct segment_byte *byte)
{
    if (ear->raw_total > 0 && byte->tick - ear->last >= SILENCE) {
        report(monitor, ear, byte->tick, ear->astray != WIRE_WHOLE ? ear->astray : WIRE_SILENT);
        ear->receiver = (struct rkm04_receiver){.phase = 0};
        ear->astray = WIRE_WHOLE;
    }
    bool first = ear->raw_total == 0 || ear->astray == WIRE_NO_ADDRESS;
    enum verdict verdict = receive(&rkm04_plain, ear, byte);
    if (ear->astray == WIRE_NO_ADDRESS && (verdict != MALFORMED || ear->raw_total == ASTRAY_MAX)) {
        report(monitor, ear, byte->tick, WIRE_NO_ADDRESS);
        ear->astray = WIRE_WHOLE;
    }
    keep_byte(ear, byte);
    if (verdict == GOOD) {
        report(monitor, ear, byte->tick, WIRE_WHOLE);
    } else if (verdict == MALFORMED && first) {
        ear->astray = WIRE_NO_ADDRESS;
    } else if (verdict == MALFORMED) {
        report(monitor, ear, byte->tick, WIRE_NO_LENGTH);
    } else if (verdict == TOO_LONG) {
        ear->astray = WIRE_TOO_LONG;
    } else if (ear->astray == WIRE_TOO_LONG && ear->receiver.left == 0) {
        report(monitor, ear, byte->tick, WIRE_TOO_LONG);
        ear->astray = WIRE_WHOLE;
    }
}

/* A framing of which nothing is known but its receiver. */
static void receive_other(const struct wire_monitor *monitor, struct wire_ear_monitor *ear, const struct segment_byte *byte)
{
    static const enum wire_fate fate_of[] = {
        [GOOD] = WIRE_WHOLE,
        [BAD_CHECK] = WIRE_WRONG_CHECK,
        [MALFORMED] = WIRE_MALFORMED,
        [TOO_LONG] = WIRE_TOO_LONG,
    };
    keep_byte(ear, byte);
    enum verdict verdict = receive(monitor->framing, ear, byte);
    if (verdict != UNDECIDED)
        report(monitor, ear, byte->tick, fate_of[verdict]);
}

/* Is there anything in the ear that makes a message? */
static bool holds_something(const struct wire_ear_monitor *ear)
{
    return ear->raw_total > 1 || (ear->raw_total == 1 && ear->raw[0] != HDLC_FLAG);
}

static void receive_byte(const struct wire_monitor *monitor, struct wire_ear_monitor *ear, const struct segment_byte *byte)
{
    if (byte->lost)
        ear->lost += ear->raw_total > 0;
    else if (monitor->framing == &rkm04_hdlc)
        receive_hdlc(monitor, ear, byte);
    else if (monitor->framing == &rkm04_plain)
        receive_plain(monitor, ear, byte);
    else
        receive_other(monitor, ear, byte);
}

/* ---- Public --------------------------------------------------------------------------------------------------------- */

static bool begin_ear(struct wire_ear_monitor *ear, bool answer, size_t room, enum wire_fate astray)
{
    ear->message = malloc(room);
    ear->raw = malloc(WIRE_RAW_MAX);
    ear->room = room;
    ear->answer = answer;
    ear->astray = astray;
    return ear->message && ear->raw;
}

bool wire_monitor_begin(struct wire_monitor *monitor, const struct rkm04_framing *framing, const struct segment *segment,
                        struct wire_monitor_calls calls)
{
    *monitor = (struct wire_monitor){.framing = framing ? framing : &rkm04_hdlc, .segment = segment, .calls = calls};
    enum wire_fate astray = monitor->framing == &rkm04_hdlc ? WIRE_OUTSIDE : WIRE_WHOLE;
    bool requests = begin_ear(&monitor->requests, false, RKM04_MESSAGE_MAX, astray);
    return begin_ear(&monitor->answers, true, WIRE_ANSWER_MAX, astray) && requests;
}

static void end_ear(struct wire_ear_monitor *ear)
{
    free(ear->message);
    free(ear->raw);
    ear->message = ear->raw = NULL;
}

void wire_monitor_end(struct wire_monitor *monitor)
{
    end_ear(&monitor->requests);
    end_ear(&monitor->answers);
}

static void copy_ear(struct wire_ear_monitor *to, const struct wire_ear_monitor *from, uint64_t later)
{
    uint8_t *message = to->message, *raw = to->raw;
    memcpy(message, from->message, from->room);
    memcpy(raw, from->raw, from->raw_length);
    *to = *from;
    to->message = message;
    to->raw = raw;
    to->start += later;
    to->last += later;
    to->receiver.last += later;
}

void wire_monitor_copy(struct wire_monitor *to, const struct wire_monitor *from, uint64_t later)
{
    copy_ear(&to->requests, &from->requests, later);
    copy_ear(&to->answers, &from->answers, later);
    to->framing = from->framing;
    to->overruns = from->overruns;
}

void wire_monitor_add_byte(struct wire_monitor *monitor, const struct segment_byte *byte)
{
    bool from_unit = (byte->senders & ~MASTER_BIT) != 0, from_master = !from_unit || (byte->senders & MASTER_BIT) != 0;
    uint64_t overruns = segment_counters(monitor->segment).overruns;
    monitor->requests.overruns += overruns - monitor->overruns;
    monitor->overruns = overruns;
    if (byte->lost)
        report_lost(monitor, byte, !from_master);
    if (from_master)
        receive_byte(monitor, &monitor->requests, byte);
    if (from_unit)
        receive_byte(monitor, &monitor->answers, byte);
}

struct wire_message *wire_monitor_rest(const struct wire_monitor *monitor, bool answer)
{
    const struct wire_ear_monitor *ear = answer ? &monitor->answers : &monitor->requests;
    if (!holds_something(ear))
        return NULL;
    return make_message(monitor->segment, ear, ear->astray != WIRE_WHOLE ? ear->astray : WIRE_UNFINISHED);
}
