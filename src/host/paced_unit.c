#include "paced_unit.h"

#define PARTS 6u         /* of a tick */
#define BYTE_PARTS 3125u /* 10 bits at 19200 baud = 520 5/6 us */

/* A byte sets out at `tick` or when the line is free; within the tick in which the line gets free it follows without a gap, so
 * that no rounding adds up. Returns the tick at which it has passed. */
static uint64_t pass(const struct paced_unit *paced, uint64_t *free_at, uint64_t tick)
{
    if (!paced->paced)
        return tick;
    if (*free_at + PARTS <= tick * PARTS)
        *free_at = tick * PARTS;
    *free_at += BYTE_PARTS;
    return (*free_at + PARTS - 1) / PARTS;
}

/* If an answer goes out and its next byte has not set out yet, let it. */
static void start_byte(struct paced_unit *paced)
{
    if (paced->out_due == RKM04_NEVER && rkm04_sending(&paced->unit))
        paced->out_due = pass(paced, &paced->out_free, rkm04_now(&paced->unit));
}

static void send_due(struct paced_unit *paced)
{
    uint8_t bytes[256];
    size_t length = rkm04_send(&paced->unit, bytes, paced->paced ? 1 : sizeof bytes);
    if (length > 0)
        paced->out(paced->context, bytes, length);
    paced->out_due = RKM04_NEVER;
    paced->refused = false;
    start_byte(paced);
}

static void receive_due(struct paced_unit *paced)
{
    if (rkm04_receive(&paced->unit, &paced->queue[paced->head].byte, 1) == 0) {
        paced->refused = true;
        return;
    }
    paced->head = (paced->head + 1) % PACED_UNIT_ROOM;
    paced->count--;
    struct rkm04_counters counters = rkm04_counters(&paced->unit);
    uint32_t frames = counters.requests + counters.others + counters.dropped;
    paced->in_frame = frames == paced->frames;
    paced->frames = frames;
    start_byte(paced);
}

static bool to_receive(const struct paced_unit *paced)
{
    return paced->count > 0 && !paced->refused;
}

/* Move what is due at the present tick. */
static void move_due(struct paced_unit *paced)
{
    uint64_t now = rkm04_now(&paced->unit);
    for (;;) {
        if (paced->out_due <= now)
            send_due(paced);
        else if (to_receive(paced) && paced->queue[paced->head].due <= now)
            receive_due(paced);
        else
            return;
    }
}

void paced_unit_begin(struct paced_unit *paced, const struct rkm04_config *config, const struct rkm04_port *port, void *context)
{
    rkm04_init(&paced->unit, config, port, context);
    paced->in_free = paced->out_free = 0;
    paced->out_due = RKM04_NEVER;
    paced->refused = paced->in_frame = false;
    paced->frames = 0;
    paced->head = paced->count = 0;
}

size_t paced_unit_room(const struct paced_unit *paced)
{
    return PACED_UNIT_ROOM - paced->count;
}

void paced_unit_take(struct paced_unit *paced, const uint8_t *bytes, size_t length, uint64_t tick)
{
    for (size_t i = 0; i < length; i++) {
        size_t at = (paced->head + paced->count) % PACED_UNIT_ROOM;
        paced->queue[at].due = pass(paced, &paced->in_free, tick);
        paced->queue[at].byte = bytes[i];
        paced->count++;
    }
}

uint64_t paced_unit_due(const struct paced_unit *paced)
{
    uint64_t due = paced->out_due;
    if (to_receive(paced) && paced->queue[paced->head].due < due)
        due = paced->queue[paced->head].due;
    return due;
}

void paced_unit_advance(struct paced_unit *paced, uint64_t tick)
{
    move_due(paced);
    for (uint64_t now; (now = rkm04_now(&paced->unit)) < tick;) {
        uint64_t due = paced_unit_due(paced);
        rkm04_advance(&paced->unit, (due < tick ? due : tick) - now);
        move_due(paced);
    }
}
