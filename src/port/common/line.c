/* SPDX-License-Identifier: MIT */
#include "line.h"

#include "board.h"

struct queue {
    volatile uint32_t in, out; /* bytes ever; each has one writer */
    uint8_t byte[LINE_ROOM];
};

static struct queue received, sending;
static uint32_t seen; /* received.in when the main loop looked last */
static bool driving;

static uint32_t used(const struct queue *queue)
{
    return queue->in - queue->out;
}

static void put(struct queue *queue, uint8_t byte)
{
    uint32_t in = queue->in;
    queue->byte[in % LINE_ROOM] = byte;
    __atomic_signal_fence(__ATOMIC_SEQ_CST); /* the byte is there before the other side sees that there is one */
    queue->in = in + 1;
}

size_t line_poll(const uint8_t **bytes)
{
    seen = received.in;
    uint32_t at = received.out % LINE_ROOM, count = seen - received.out;
    *bytes = received.byte + at;
    return count < LINE_ROOM - at ? count : LINE_ROOM - at;
}

void line_take(size_t count)
{
    received.out += (uint32_t)count;
    if (count > 0)
        board_line();
}

size_t line_room(void)
{
    return LINE_ROOM - used(&sending);
}

void line_send(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        put(&sending, bytes[i]);
    board_line();
}

bool line_needs_main_loop(bool more)
{
    return received.in != seen || (more && used(&sending) <= LINE_ROOM / 2);
}

bool line_has_room(void)
{
    return used(&received) < LINE_ROOM;
}

void line_came(uint8_t byte)
{
    put(&received, byte);
}

bool line_next(uint8_t *byte)
{
    if (used(&sending) == 0)
        return false;
    *byte = sending.byte[sending.out % LINE_ROOM];
    sending.out++;
    return true;
}

bool line_drives(bool idle)
{
    if (used(&sending) > 0)
        driving = true;
    else if (idle)
        driving = false;
    return driving;
}
