/* SPDX-License-Identifier: MIT */
/* What the host of a scenario sends, and what it makes of the answers. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "scenario_running.h"

/* ---- Listening ------------------------------------------------------------------------------------------------------ */

static const struct device_framing *framing_of(const struct running *running)
{
    return device_framing_of(sim_device(running->sim), &running->scenario->config.unit);
}

static const struct rkm04_framing *link_of(const struct running *running)
{
    return framing_of(running)->link;
}

static void keep_answer(struct host *host)
{
    if (!host->listening)
        return;
    host->answered = true;
    host->dnode = host->receiver.dnode;
    host->snode = host->receiver.snode;
    host->length = host->receiver.length;
}

uint64_t running_silence_end(const struct running *running)
{
    const struct host *host = &running->host;
    bool open = framing_of(running)->end && host->listening && !host->answered && host->receiver.length > 0;
    return open ? host->receiver.last + framing_of(running)->silence : DEVICE_NEVER;
}

void running_end_silence(struct running *running)
{
    struct host *host = &running->host;
    if (running_silence_end(running) > sim_now(running->sim))
        return;
    if (framing_of(running)->end(&host->receiver, host->buffer, true))
        keep_answer(host);
    else
        host->receiver.length = 0;
}

void running_receive(void *context, const uint8_t *bytes, size_t length)
{
    struct running *running = context;
    struct host *host = &running->host;
    running_end_silence(running);
    for (size_t i = 0; i < length && !host->answered; i++)
        if (link_of(running)->receive(&host->receiver, bytes[i], sim_now(running->sim), host->buffer, sizeof host->buffer))
            keep_answer(host);
}

static void start_listening(struct host *host)
{
    host->receiver = (struct rkm04_receiver){0};
    host->listening = true;
    host->answered = false;
}

/* ---- Sending -------------------------------------------------------------------------------------------------------- */

static unsigned address_of(const struct running *running, unsigned unit)
{
    return unit == 0 ? 0 : sim_device(running->sim)->node(sim_core(running->sim, unit));
}

/* The bytes on the line. Returns them, to be freed, or NULL if out of memory. */
static uint8_t *make_frame(const struct running *running, const struct scenario_step *step, size_t *length)
{
    const struct rkm04_framing *framing = link_of(running);
    const struct scenario_bytes *bytes = &step->bytes;
    struct rkm04_sender sender;
    uint8_t *out = malloc(bytes->length * RKM04_FRAME_EDGE_MAX + 2 * RKM04_FRAME_EDGE_MAX);
    if (out == NULL)
        return NULL;
    if (step->action == ACTION_BYTES) {
        memcpy(out, bytes->byte, bytes->length);
        *length = bytes->length;
        return out;
    }
    *length = framing->begin(&sender, (uint8_t)address_of(running, step->unit), 0, bytes->length, false, out);
    for (size_t i = 0; i < bytes->length; i++)
        *length += framing->put(&sender, bytes->byte[i], out + *length);
    *length += framing->end(&sender, out + *length);
    return out;
}

/* Hand the bytes over and let them pass. *passed: when the last one has. */
static bool send_bytes(struct running *running, const uint8_t *bytes, size_t length, uint64_t *passed)
{
    struct sim *sim = running->sim;
    size_t handed = 0;
    *passed = sim_now(sim);
    while (handed < length) {
        size_t room = sim_room(sim), part = length - handed < room ? length - handed : room;
        if (part > 0) {
            sim_queue_bytes(sim, bytes + handed, part, sim_now(sim));
            if (sim->segment.config.timed)
                *passed = (sim->segment.host_free + WIRE_TICK - 1) / WIRE_TICK;
            handed += part;
            sim_advance(sim, sim_now(sim));
        } else if (!running_advance(running, sim_now(sim) + sim_device(sim)->slot, NULL)) {
            return false;
        }
    }
    while (!running->over && !running->host.answered && sim_now(sim) < *passed)
        running_advance(running, *passed, NULL);
    return !running->over;
}

/* ---- Judging -------------------------------------------------------------------------------------------------------- */

static char *bytes_text(const struct scenario_bytes *bytes)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    if (out == NULL)
        return NULL;
    scenario_bytes_print(out, bytes);
    if (bytes->length == 0 && !bytes->rest)
        fputs("an empty message", out);
    fclose(out);
    return text;
}

/* `format` has one %s, for the bytes. */
__attribute__((format(printf, 2, 0))) static char *text_with(const struct scenario_bytes *bytes, const char *format)
{
    char *inside = bytes_text(bytes), *text = NULL;
    if (inside != NULL && asprintf(&text, format, inside) < 0)
        text = NULL;
    free(inside);
    return text;
}

static char *wanted_text(const struct scenario_step *step)
{
    if (step->action == ACTION_SET)
        return running_text("the answer to the program with flag %u", step->flag);
    if (step->answer == ANSWER_ANY)
        return running_text("an answer");
    if (step->answer == ANSWER_NONE)
        return running_text("no answer");
    return text_with(&step->wanted, "the answer %s");
}

/* Why there is none. */
static char *silence_text(const struct running *running, uint64_t since)
{
    const struct rkm04_receiver *receiver = &running->host.receiver;
    uint64_t ticks = sim_now(running->sim) - since;
    unsigned dropped = receiver->bad_check + receiver->malformed + receiver->too_long;
    char why[80] = "";
    if (dropped > 0)
        snprintf(why, sizeof why, "; dropped: %u with a wrong check sum, %u malformed, %u too long", receiver->bad_check,
                 receiver->malformed, receiver->too_long);
    else if (receiver->length > 0)
        snprintf(why, sizeof why, "; an incomplete one, of %u bytes so far", receiver->length);
    return running_text("no answer within %" PRIu64 ".%06" PRIu64 " s%s", ticks / US_PER_SECOND,
                        ticks % US_PER_SECOND, why);
}

/* `wrong`: what is wrong with the program; NULL: nothing is known of it. */
static char *flag_text(const struct device_program_message *kind, unsigned flag, const uint8_t *answer, const char *wrong)
{
    char meaning[DEVICE_ERROR_SIZE];
    if (kind->explain(answer, meaning) && wrong)
        return running_text("flag %u (%s): %s", flag, meaning, wrong);
    return running_text("flag %u (%s)", flag, meaning);
}

static bool check_program_answer(struct running *running, const struct scenario_step *step)
{
    const struct device_program_message *kind = sim_device(running->sim)->program_message;
    struct scenario_bytes answer = {.length = running->host.length, .byte = running->host.buffer};
    const int flag = kind->flag(step->bytes.byte, answer.byte, answer.length);
    if (flag == step->flag)
        return true;
    return running_failed(running, step, sim_now(running->sim), wanted_text(step),
                          flag < 0 ? text_with(&answer, "the answer %s")
                                   : flag_text(kind, (unsigned)flag, answer.byte, step->wrong));
}

static bool check_answer(struct running *running, const struct scenario_step *step)
{
    const struct host *host = &running->host;
    struct scenario_bytes answer = {.length = host->length, .byte = running->host.buffer};
    unsigned from = link_of(running)->answer_names_sender ? host->snode : host->dnode;
    uint64_t now = sim_now(running->sim);
    if (step->answer == ANSWER_NONE)
        return running_failed(running, step, now, wanted_text(step), text_with(&answer, "the answer %s"));
    if (step->unit > 0 && from > 0 && from != address_of(running, step->unit)) /* 0: the framing does not name it */
        return running_failed(running, step, now, wanted_text(step), running_text("an answer from address %u", from));
    if (step->action == ACTION_SET)
        return check_program_answer(running, step);
    if (step->answer == ANSWER_THIS && !scenario_bytes_match(&step->wanted, answer.byte, answer.length))
        return running_failed(running, step, now, wanted_text(step), text_with(&answer, "the answer %s"));
    return true;
}

/* Where a silence ends messages, one goes before each. */
static bool keep_silence(struct running *running)
{
    const struct host *host = &running->host;
    uint64_t last = host->sent > host->receiver.last ? host->sent : host->receiver.last;
    uint64_t end = framing_of(running)->end && last > 0 ? last + framing_of(running)->silence : 0;
    while (!running->over && sim_now(running->sim) < end)
        running_advance(running, end, NULL);
    return !running->over;
}

bool running_send(struct running *running, const struct scenario_step *step)
{
    size_t length;
    uint64_t passed;
    uint8_t *bytes = make_frame(running, step, &length);
    if (bytes == NULL)
        return running_no_memory(running);
    bool ok = step->action == ACTION_BYTES || keep_silence(running);
    if (step->answer != ANSWER_UNASKED)
        start_listening(&running->host);
    ok = ok && send_bytes(running, bytes, length, &passed);
    running->host.sent = ok ? passed : 0;
    free(bytes);
    if (step->answer == ANSWER_UNASKED || !ok)
        return ok;
    while (!running->over && !running->host.answered && sim_now(running->sim) < passed + step->within)
        running_advance(running, passed + step->within, NULL);
    running->host.listening = false;
    if (running->over)
        return false;
    if (running->host.answered)
        return check_answer(running, step);
    return step->answer == ANSWER_NONE ||
           running_failed(running, step, sim_now(running->sim), wanted_text(step), silence_text(running, passed));
}
