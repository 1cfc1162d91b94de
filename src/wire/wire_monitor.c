/* SPDX-License-Identifier: MIT */
#include "wire_monitor.h"

#include <stdlib.h>
#include <string.h>

#include "wire_words.h"

#define MASTER_BIT 1u
#define ASTRAY_MAX 256u               /* bytes without a frame that are reported at a time */
#define REASON_MAX 120u               /* characters of a reason put together */

static const char *const fates[] = {
    [WIRE_WHOLE] = NULL,
    [WIRE_WRONG_CHECK] = "wrong FCS",
    [WIRE_ABORTED] = "aborted",
    [WIRE_TOO_SHORT] = "too short",
    [WIRE_TOO_LONG] = "too long",
    [WIRE_OUTSIDE] = "no frame",
    [WIRE_NO_LENGTH] = "impossible length",
    [WIRE_SILENT] = "silence inside",
    [WIRE_MALFORMED] = "malformed",
    [WIRE_UNFINISHED] = "unfinished",
    [WIRE_FRAMING_ERROR] = "framing error",
    [WIRE_BREAK] = "break",
};

/* ---- Why no unit executes a request -------------------------------------------------------------------------------------- */

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

/* Why no unit executes a complete request. Writes nothing if a unit may execute it. */
static void words_ignored(struct wire_text *out, const struct segment *segment, const struct wire_frame *frame)
{
    const struct rkm04_receiver *head = &frame->receiver;
    const struct device_words *words = segment_kind(segment)->words;
    if (words && words->ignored)
        words->ignored(out, head->dnode, head->snode, frame->message, head->length);
    if (out->length == 0)
        ignored_for_address(out, segment, head->dnode);
    if (out->length == 0 && frame->overruns > 0)
        wire_text_string(out, "bytes lost, a unit had a request waiting (P10)");
}

/* ---- Messages ------------------------------------------------------------------------------------------------------- */

static const uint8_t *append_bytes(struct wire_message *message, size_t *used, const void *bytes, size_t length)
{
    uint8_t *place = message->bytes + *used;
    if (length > 0)
        memcpy(place, bytes, length);
    *used += length;
    return place;
}

static void put_refusal(struct wire_text *out, const struct device_words *words, const struct wire_message *message)
{
    if (words && words->refusal)
        words->refusal(out, message->message, message->length);
}

/* A message from the frame. Returns NULL if out of memory. */
static struct wire_message *make_message(const struct wire_monitor *monitor, const struct wire_frame *frame,
                                         enum wire_fate fate)
{
    const struct segment *segment = monitor->segment;
    size_t length = fate == WIRE_WHOLE ? frame->receiver.length : 0, used = 0;
    char reason[REASON_MAX];
    struct wire_text text = {.text = reason, .room = sizeof reason};
    struct wire_message *message = malloc(sizeof *message + frame->raw_length + length + sizeof reason);
    if (!message)
        return NULL;
    *message = (struct wire_message){
        .start = frame->start,
        .end = frame->last,
        .senders = frame->senders,
        .collided = frame->collided,
        .lost = frame->lost,
        .fate = fate,
        .answer = frame->answer,
        .dropped = fate == WIRE_NO_ADDRESS ? monitor->framing->no_address : fates[fate],
        .raw_total = frame->raw_total,
        .raw_length = frame->raw_length,
        .length = length,
    };
    message->raw = append_bytes(message, &used, frame->raw, frame->raw_length);
    message->message = append_bytes(message, &used, frame->message, length);
    if (fate != WIRE_WHOLE)
        return message;
    message->dnode = frame->receiver.dnode;
    message->snode = frame->receiver.snode;
    if (frame->answer)
        put_refusal(&text, segment_kind(segment)->words, message);
    else
        words_ignored(&text, segment, frame);
    wire_text_end(&text);
    if (text.length == 0)
        return message;
    const char *why = (const char *)append_bytes(message, &used, text.text, text.length + 1u);
    if (frame->answer)
        message->refused = why;
    else
        message->ignored = why;
    return message;
}

static void empty_frame(struct wire_frame *frame)
{
    frame->raw_length = frame->raw_total = 0;
    frame->senders = frame->collided = 0;
    frame->lost = 0;
    frame->overruns = 0;
}

/* The frame has ended. */
static void report(const struct wire_monitor *monitor, struct wire_frame *frame, uint64_t tick, enum wire_fate fate)
{
    const struct wire_monitor_calls *calls = &monitor->calls;
    if (frame->raw_total > 0 && calls->is_wanted && calls->is_wanted(calls->context))
        calls->message(calls->context, tick, make_message(monitor, frame, fate));
    empty_frame(frame);
}

/* A byte that was not received. */
static void report_lost(const struct wire_monitor *monitor, const struct segment_byte *byte, bool answer)
{
    uint8_t raw = byte->byte;
    struct wire_frame frame = {
        .raw = &raw,
        .raw_length = 1,
        .raw_total = 1,
        .start = byte->start,
        .last = byte->tick,
        .senders = byte->senders,
        .collided = (byte->senders & (byte->senders - 1u)) != 0 ? byte->senders : 0,
        .answer = answer,
    };
    report(monitor, &frame, byte->tick, raw == 0 && frame.collided == 0 ? WIRE_BREAK : WIRE_FRAMING_ERROR);
}

/* ---- Framings ------------------------------------------------------------------------------------------------------- */

static void keep_byte(struct wire_frame *frame, const struct segment_byte *byte)
{
    if (frame->raw_total++ == 0)
        frame->start = byte->start;
    if (frame->raw_length < frame->raw_room)
        frame->raw[frame->raw_length++] = byte->byte;
    frame->senders |= byte->senders;
    if ((byte->senders & (byte->senders - 1u)) != 0)
        frame->collided |= byte->senders;
    frame->last = byte->tick;
}

/* What the framing has to say about a byte; UNDECIDED: nothing yet. */
enum verdict { UNDECIDED, GOOD, BAD_CHECK, MALFORMED, TOO_LONG };

static enum verdict receive_frame_byte(const struct wire_monitor *monitor, struct wire_frame *frame,
                                       const struct segment_byte *byte)
{
    const struct rkm04_framing *framing = monitor->framing->link;
    uint32_t bad_check = frame->receiver.bad_check, malformed = frame->receiver.malformed, too_long = frame->receiver.too_long;
    if (framing->receive(&frame->receiver, byte->byte, byte->tick, frame->message, frame->room))
        return GOOD;
    if (frame->receiver.bad_check != bad_check)
        return BAD_CHECK;
    if (frame->receiver.malformed != malformed)
        return MALFORMED;
    return frame->receiver.too_long != too_long ? TOO_LONG : UNDECIDED;
}

/* A flag ends what goes before it, frames or what is none. Bytes without a frame are reported after a silence, too, so that a
 * client that never sends a flag is not passed over. */
static void receive_flagged(const struct wire_monitor *monitor, struct wire_frame *frame, const struct segment_byte *byte)
{
    bool flag = byte->byte == monitor->framing->flag;
    if (frame->astray != WIRE_WHOLE &&
        (flag || byte->tick - frame->last >= monitor->framing->silence ||
         (frame->astray == WIRE_OUTSIDE && frame->raw_total == ASTRAY_MAX))) {
        report(monitor, frame, byte->tick, frame->astray);
        frame->astray = flag ? WIRE_WHOLE : WIRE_OUTSIDE;
    }
    if (flag && frame->raw_length == 1 && frame->raw[0] == monitor->framing->flag)
        empty_frame(frame); /* an empty frame is nothing; this flag may begin one */
    keep_byte(frame, byte);
    switch (receive_frame_byte(monitor, frame, byte)) {
    case UNDECIDED:
        break;
    case GOOD:
        report(monitor, frame, byte->tick, WIRE_WHOLE);
        break;
    case BAD_CHECK:
        report(monitor, frame, byte->tick, WIRE_WRONG_CHECK);
        break;
    case MALFORMED: {
        bool aborted = frame->raw_length >= 2 && frame->raw[frame->raw_length - 2u] == monitor->framing->escape;
        report(monitor, frame, byte->tick, aborted ? WIRE_ABORTED : WIRE_TOO_SHORT);
        break;
    }
    case TOO_LONG:
        frame->astray = WIRE_TOO_LONG;
        break;
    }
}

/* Bytes that cannot be an address are gathered until one comes that can. */
static void receive_timed(const struct wire_monitor *monitor, struct wire_frame *frame, const struct segment_byte *byte)
{
    if (frame->raw_total > 0 && byte->tick - frame->last >= monitor->framing->silence) {
        report(monitor, frame, byte->tick, frame->astray != WIRE_WHOLE ? frame->astray : WIRE_SILENT);
        frame->receiver = (struct rkm04_receiver){.phase = 0};
        frame->astray = WIRE_WHOLE;
    }
    bool first = frame->raw_total == 0 || frame->astray == WIRE_NO_ADDRESS;
    enum verdict verdict = receive_frame_byte(monitor, frame, byte);
    if (frame->astray == WIRE_NO_ADDRESS && (verdict != MALFORMED || frame->raw_total == ASTRAY_MAX)) {
        report(monitor, frame, byte->tick, WIRE_NO_ADDRESS);
        frame->astray = WIRE_WHOLE;
    }
    keep_byte(frame, byte);
    if (verdict == GOOD) {
        report(monitor, frame, byte->tick, WIRE_WHOLE);
    } else if (verdict == MALFORMED && first) {
        frame->astray = WIRE_NO_ADDRESS;
    } else if (verdict == MALFORMED) {
        report(monitor, frame, byte->tick, WIRE_NO_LENGTH);
    } else if (verdict == TOO_LONG) {
        frame->astray = WIRE_TOO_LONG;
    } else if (frame->astray == WIRE_TOO_LONG && frame->receiver.left == 0) {
        report(monitor, frame, byte->tick, WIRE_TOO_LONG);
        frame->astray = WIRE_WHOLE;
    }
}

/* A framing of which nothing is known but its receiver. */
static void receive_other(const struct wire_monitor *monitor, struct wire_frame *frame, const struct segment_byte *byte)
{
    static const enum wire_fate fate_of[] = {
        [GOOD] = WIRE_WHOLE,
        [BAD_CHECK] = WIRE_WRONG_CHECK,
        [MALFORMED] = WIRE_MALFORMED,
        [TOO_LONG] = WIRE_TOO_LONG,
    };
    keep_byte(frame, byte);
    enum verdict verdict = receive_frame_byte(monitor, frame, byte);
    if (verdict != UNDECIDED)
        report(monitor, frame, byte->tick, fate_of[verdict]);
}

/* A silence, or the other side, has ended what was gathered: is it a message? */
static void end_gathered(const struct wire_monitor *monitor, struct wire_frame *frame, uint64_t tick)
{
    struct rkm04_receiver *receiver = &frame->receiver;
    if (frame->raw_total == 0)
        return;
    if (monitor->framing->end(receiver, frame->message, frame->answer))
        report(monitor, frame, tick, WIRE_WHOLE);
    else
        report(monitor, frame, tick,
               receiver->too_long > 0    ? WIRE_TOO_LONG
               : receiver->bad_check > 0 ? WIRE_WRONG_CHECK
                                         : WIRE_MALFORMED);
    *receiver = (struct rkm04_receiver){.phase = 0};
}

/* Messages that end with a silence. */
static void receive_gathered(const struct wire_monitor *monitor, struct wire_frame *frame, const struct segment_byte *byte)
{
    if (frame->raw_total > 0 && byte->tick - frame->last >= monitor->framing->silence)
        end_gathered(monitor, frame, frame->last + monitor->framing->silence);
    keep_byte(frame, byte);
    monitor->framing->link->receive(&frame->receiver, byte->byte, byte->tick, frame->message, frame->room);
}

/* Is there anything in the frame that makes a message? */
static bool holds_something(const struct wire_monitor *monitor, const struct wire_frame *frame)
{
    return frame->raw_total > 1 || (frame->raw_total == 1 && frame->raw[0] != monitor->framing->flag);
}

static void receive_byte(const struct wire_monitor *monitor, struct wire_frame *frame, const struct segment_byte *byte)
{
    if (byte->lost)
        frame->lost += frame->raw_total > 0;
    else if (monitor->framing->end)
        receive_gathered(monitor, frame, byte);
    else if (monitor->framing->flag >= 0)
        receive_flagged(monitor, frame, byte);
    else if (monitor->framing->silence > 0)
        receive_timed(monitor, frame, byte);
    else
        receive_other(monitor, frame, byte);
}

/* ---- Public --------------------------------------------------------------------------------------------------------- */

static bool begin_frame(struct wire_frame *frame, bool answer, size_t room, size_t raw_room, enum wire_fate astray)
{
    frame->message = malloc(room);
    frame->raw = malloc(raw_room);
    frame->room = room;
    frame->raw_room = raw_room;
    frame->answer = answer;
    frame->astray = astray;
    return frame->message && frame->raw;
}

/* Gathered bytes are a message with what is around it. */
static size_t room_for(const struct device_framing *framing, size_t longest)
{
    return longest + (framing->end ? 2u * RKM04_FRAME_EDGE_MAX : 0);
}

bool wire_monitor_begin(struct wire_monitor *monitor, const struct device_kind *kind, const struct device_framing *framing,
                        const struct segment *segment, struct wire_monitor_calls calls)
{
    *monitor = (struct wire_monitor){.framing = framing, .segment = segment, .calls = calls};
    enum wire_fate astray = framing->flag >= 0 ? WIRE_OUTSIDE : WIRE_WHOLE;
    size_t longest = kind->answer_max > kind->request_max ? kind->answer_max : kind->request_max;
    size_t raw = 2u * (room_for(framing, longest) + 4u) + 2u; /* every byte may be escaped */
    bool requests = begin_frame(&monitor->requests, false, room_for(framing, kind->request_max), raw, astray);
    return begin_frame(&monitor->answers, true, room_for(framing, kind->answer_max), raw, astray) && requests;
}

static void end_frame(struct wire_frame *frame)
{
    free(frame->message);
    free(frame->raw);
    frame->message = frame->raw = NULL;
}

void wire_monitor_end(struct wire_monitor *monitor)
{
    end_frame(&monitor->requests);
    end_frame(&monitor->answers);
}

static void copy_frame(struct wire_frame *to, const struct wire_frame *from, uint64_t later)
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
    copy_frame(&to->requests, &from->requests, later);
    copy_frame(&to->answers, &from->answers, later);
    to->framing = from->framing;
    to->overruns = from->overruns;
}

void wire_monitor_add_byte(struct wire_monitor *monitor, const struct segment_byte *byte)
{
    bool from_unit = (byte->senders & ~MASTER_BIT) != 0, from_host = !from_unit || (byte->senders & MASTER_BIT) != 0;
    uint64_t overruns = segment_counters(monitor->segment).overruns;
    monitor->requests.overruns += overruns - monitor->overruns;
    monitor->overruns = overruns;
    if (byte->lost)
        report_lost(monitor, byte, !from_host);
    if (monitor->framing->end && from_host != from_unit)
        end_gathered(monitor, from_host ? &monitor->answers : &monitor->requests, byte->tick);
    if (from_host)
        receive_byte(monitor, &monitor->requests, byte);
    if (from_unit)
        receive_byte(monitor, &monitor->answers, byte);
}

static uint64_t silence_end_of(const struct wire_monitor *monitor, const struct wire_frame *frame)
{
    return frame->raw_total > 0 ? frame->last + monitor->framing->silence : DEVICE_NEVER;
}

uint64_t wire_monitor_due(const struct wire_monitor *monitor)
{
    const struct wire_monitor_calls *calls = &monitor->calls;
    if (!monitor->framing->end || !calls->is_wanted || !calls->is_wanted(calls->context))
        return DEVICE_NEVER;
    uint64_t request = silence_end_of(monitor, &monitor->requests), answer = silence_end_of(monitor, &monitor->answers);
    return request < answer ? request : answer;
}

void wire_monitor_pass_time(struct wire_monitor *monitor, uint64_t tick)
{
    if (!monitor->framing->end)
        return;
    struct wire_frame *frames[] = {&monitor->requests, &monitor->answers};
    for (unsigned i = 0; i < 2u; i++)
        if (silence_end_of(monitor, frames[i]) <= tick)
            end_gathered(monitor, frames[i], silence_end_of(monitor, frames[i]));
}

/* What was gathered may be a message although its silence is not over yet. */
static struct wire_message *gathered_rest(const struct wire_monitor *monitor, const struct wire_frame *frame)
{
    struct wire_message *message = NULL;
    struct wire_frame copy = *frame;
    copy.message = malloc(frame->room);
    if (copy.message) {
        memcpy(copy.message, frame->message, frame->receiver.length);
        bool whole = monitor->framing->end(&copy.receiver, copy.message, frame->answer);
        message = make_message(monitor, &copy, whole ? WIRE_WHOLE : WIRE_UNFINISHED);
    }
    free(copy.message);
    return message;
}

struct wire_message *wire_monitor_rest(const struct wire_monitor *monitor, bool answer)
{
    const struct wire_frame *frame = answer ? &monitor->answers : &monitor->requests;
    if (!holds_something(monitor, frame))
        return NULL;
    if (monitor->framing->end)
        return gathered_rest(monitor, frame);
    return make_message(monitor, frame, frame->astray != WIRE_WHOLE ? frame->astray : WIRE_UNFINISHED);
}
