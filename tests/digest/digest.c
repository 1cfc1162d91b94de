/* SPDX-License-Identifier: MIT */
#include "digest.h"

#define FETCH_AT_ONCE 16

/* A digest has lanes, put together at the end: the unit reports two motors in any order within a slot. */
enum { LANE_COMMON, LANE_ANSWERS = RKM04_MOTORS + 1, LANE_FLASH, LANES };

static struct rkm04_unit unit;
static struct rkm04_config config;
static const struct rkm04_port *port;
static uint8_t flash[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];
static uint64_t lane[LANES];
static uint64_t pulses, all_pulses, all;
static void (*say)(const char *line);

/* ---- What the unit does ------------------------------------------------------------------------------------------- */

/* The tick and, in bits which it does not need for a hundred years, what happened. */
static uint64_t stamp(uint64_t tick, unsigned what)
{
    return tick ^ (uint64_t)what << 56;
}

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context;
    mix(&lane[motor], stamp(tick, 1) ^ (uint64_t)(uint32_t)position << 24);
    pulses++;
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    (void)context;
    mix(&lane[motor], stamp(tick, forward ? 3 : 2));
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    (void)context;
    mix(&lane[LANE_COMMON], stamp(tick, 4));
    mix(&lane[LANE_COMMON], mask);
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    (void)context;
    mix(&lane[motor], stamp(tick, 8 + (unsigned)what));
    mix(&lane[motor], value);
}

static int on_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    uint8_t *to = data;
    (void)context;
    for (unsigned i = 0; i < length; i++)
        to[i] = flash[block][offset + i];
    return 0;
}

static int on_flash_erase(void *context, unsigned block)
{
    (void)context;
    for (unsigned i = 0; i < RKM04_FLASH_BLOCK_SIZE; i++)
        flash[block][i] = 0xff;
    mix(&lane[LANE_FLASH], stamp(rkm04_now(&unit), block));
    return 0;
}

static int on_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    const uint8_t *from = data;
    (void)context;
    mix(&lane[LANE_FLASH], stamp((uint64_t)offset << 32 | length, block));
    for (unsigned i = 0; i < length; i++) {
        flash[block][offset + i] &= from[i];
        mix(&lane[LANE_FLASH], flash[block][offset + i]);
    }
    return 0;
}

static const struct rkm04_port with_pulses = {
    on_step, NULL, on_direction, on_outputs, on_event, on_flash_read, on_flash_erase, on_flash_program,
};
static const struct rkm04_port without_pulses = {
    NULL, NULL, on_direction, on_outputs, on_event, on_flash_read, on_flash_erase, on_flash_program,
};

/* ---- A session ---------------------------------------------------------------------------------------------------- */

void session_begin(const struct session *session)
{
    config = (struct rkm04_config){
        .node = session->node, .readings.speed_change = session->latency, .framing = session->framing};
    port = session->quiet ? &without_pulses : &with_pulses;
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
        on_flash_erase(NULL, block);
    for (unsigned i = 0; i < LANES; i++)
        lane[i] = i;
    pulses = 0;
    rkm04_init(&unit, &config, port, NULL);
}

void session_power_cycle(void)
{
    mix(&lane[LANE_COMMON], stamp(rkm04_now(&unit), 5));
    rkm04_init(&unit, &config, port, NULL);
}

uint64_t session_now(void)
{
    return rkm04_now(&unit);
}

void session_to(uint64_t tick)
{
    if (tick > rkm04_now(&unit))
        rkm04_advance(&unit, tick - rkm04_now(&unit));
}

void session_inputs(uint8_t mask)
{
    rkm04_set_inputs(&unit, mask);
}

void session_fetch(size_t bytes)
{
    uint8_t piece[FETCH_AT_ONCE];
    while (bytes > 0) {
        size_t length = rkm04_send(&unit, piece, bytes < sizeof piece ? bytes : sizeof piece);
        if (length == 0)
            return;
        mix(&lane[LANE_ANSWERS], stamp(rkm04_now(&unit), (unsigned)length));
        for (size_t i = 0; i < length; i++)
            mix(&lane[LANE_ANSWERS], piece[i]);
        bytes -= length;
    }
}

void session_bytes(const uint8_t *bytes, size_t length)
{
    while (length > 0) {
        size_t taken = rkm04_receive(&unit, bytes, length);
        mix(&lane[LANE_ANSWERS], stamp(taken, 6));
        bytes += taken;
        length -= taken;
        if (length > 0)
            session_fetch(FETCH_AT_ONCE);
    }
}

void session_request(const void *message, size_t length)
{
    const uint8_t *bytes = message;
    uint8_t frame[RKM04_FRAME_EDGE_MAX];
    struct rkm04_sender sender = {0};
    session_bytes(frame, config.framing->begin(&sender, config.node, 0, length, false, frame));
    for (size_t i = 0; i < length; i++)
        session_bytes(frame, config.framing->put(&sender, bytes[i], frame));
    session_bytes(frame, config.framing->end(&sender, frame));
}

void session_set(char motor, const char *text, size_t length)
{
    uint8_t message[SESSION_TEXT_MAX + 2] = {2, (uint8_t)motor};
    for (size_t i = 0; i < length && i < SESSION_TEXT_MAX; i++)
        message[2 + i] = (uint8_t)text[i];
    session_request(message, 2 + (length < SESSION_TEXT_MAX ? length : SESSION_TEXT_MAX));
}

void session_ask(uint8_t number, char motor)
{
    const uint8_t message[] = {number, (uint8_t)motor};
    session_request(message, sizeof message);
}

/* What can be seen of a motor. */
static void look_at(unsigned motor)
{
    struct rkm04_motor_state state;
    if (!rkm04_motor_state(&unit, motor, &state))
        return;
    const uint32_t seen[] = {
        (uint32_t)state.position, state.steps, state.speed, state.index, state.commands, (uint32_t)state.state,
        (uint32_t)state.fault, (uint32_t)state.led, state.lit, state.stopping, state.forward, (uint32_t)state.slot,
    };
    for (size_t i = 0; i < sizeof seen / sizeof seen[0]; i++)
        mix(&lane[motor], seen[i]);
}

static void look(void)
{
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++)
        look_at(motor);
    struct rkm04_counters counters = rkm04_counters(&unit);
    const uint64_t seen[] = {
        rkm04_now(&unit), rkm04_next_event(&unit), rkm04_inputs(&unit), rkm04_outputs(&unit), rkm04_variables(&unit),
        rkm04_sending(&unit), counters.requests, counters.answers, counters.others, counters.dropped,
    };
    for (size_t i = 0; i < sizeof seen / sizeof seen[0]; i++)
        mix(&lane[LANE_COMMON], seen[i]);
}

void session_end(const char *name)
{
    uint64_t digest = 0;
    look();
    session_fetch(SIZE_MAX);
    for (unsigned i = 0; i < LANES; i++)
        mix(&digest, lane[i]);
    mix(&all, digest);
    all_pulses += pulses;
    digest_line(say, name, digest, pulses);
}

void digest_run(void (*to)(const char *line))
{
    say = to;
    all = all_pulses = 0;
    run_manual();
    run_stories();
    digest_line(say, "all", all, all_pulses);
}
