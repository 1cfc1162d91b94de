/* SPDX-License-Identifier: MIT */
/* chaos.c: everything goes wrong at once, nothing of it is foreseen; then the line is as before. */
#include "soak.h"

#include <stdlib.h>
#include <string.h>

static const char *const programs[] = {
    "\\S50 V900 A3000 F90 R B40 R", "V3000 F300 R", "L5 T03 W2 C03 W3 E", "G-", "G+", "K", "C75", "V700", "[F10 R", "] D R",
    "M01 F200 R U", "(01 C100 F30 R", "T80 O81 F3 R", "T81 Z80 B3 R", "Y F20 Y B50 V400 Y R", "\\", "T41 F500 R", "@1 F2 R D J1",
    "I01H1 J2", "X02 G+", "F100 V100 R W5 H", ")02 =7 H", "T40", "C41", "'9", "E", ".", "L255 L255 W1 E E",
    "T51 T52 F10 Y F20 Y R",
};

static const char *const faults[] = {
    "\"kind\":\"drop\",\"probability\":0.02,\"for\":\"2s\"", "\"kind\":\"flip\",\"mask\":4,\"probability\":0.05,\"count\":3",
    "\"kind\":\"duplicate\",\"count\":2", "\"kind\":\"insert\",\"byte\":126,\"probability\":0.01",
    "\"kind\":\"delay\",\"delay\":\"70ms\",\"count\":1", "\"kind\":\"no_answer\",\"count\":1,\"after\":\"20ms\"",
    "\"kind\":\"wrong_fcs\",\"probability\":0.5,\"for\":\"3s\"", "\"kind\":\"cut\",\"bytes\":3,\"count\":1",
    "\"kind\":\"break\",\"duration\":\"3ms\",\"every\":\"50ms\",\"count\":9", "\"kind\":\"cable\",\"duration\":\"300ms\"",
    "\"kind\":\"echo\",\"for\":\"1s\"", "\"kind\":\"unplugged\",\"duration\":\"200ms\"",
    "\"kind\":\"input\",\"input\":2,\"level\":1,\"duration\":\"40ms\",\"every\":\"90ms\",\"count\":4",
    "\"kind\":\"cable\",\"unit\":3,\"for\":\"1s\"", "\"kind\":\"delay\",\"delay\":\"2s\",\"unit\":5,\"count\":2",
};

/* They change what is stored. */
static const char *const flash_faults[] = {
    "\"kind\":\"flash\",\"operation\":\"program\",\"torn\":true,\"count\":2",
    "\"kind\":\"flash\",\"probability\":0.3,\"for\":\"5s\"",
    "\"kind\":\"flash\",\"operation\":\"read\",\"count\":3", "\"kind\":\"power\",\"operation\":2,\"duration\":\"1s\"",
    "\"kind\":\"power\",\"operation\":3",
};

static const char plant[] =
    "{\"plant\":{\"motors\":{\"1\":{\"offset\":20,\"stops\":{\"low\":-5,\"high\":400}},\"2\":{}},\"switches\":["
    "{\"input\":1,\"motor\":1,\"at_most\":0,\"hysteresis\":3,\"bounce\":\"30ms\"},{\"input\":2,\"motor\":2,\"at_least\":50}]}}";

static void pass(struct soak *soak, uint64_t ticks)
{
    sim_advance(&soak->sim, sim_now(&soak->sim) + ticks);
}

/* Obeyed or refused, as it comes. */
static void try_command(struct soak *soak, const char *method, const char *text)
{
    struct refusal refusal;
    json_t *params = json_loads(text, 0, NULL);
    if (!params)
        soak_fail(soak, "no JSON: %s", text);
    json_t *result = sim_command(&soak->sim, method, params, &refusal);
    if (!result && *refusal.text == '\0')
        soak_fail(soak, "%s %s is refused without a word", method, text);
    json_decref(params);
    json_decref(result);
}

static void act_fault(struct soak *soak, bool flash)
{
    char text[200];
    size_t all = sizeof faults / sizeof *faults, some = flash ? sizeof flash_faults / sizeof *flash_faults : 0;
    size_t which = (size_t)dice_roll(&soak->dice, 0, (int64_t)(all + some) - 1);
    snprintf(text, sizeof text, "{%s}", which < all ? faults[which] : flash_faults[which - all]);
    try_command(soak, "fault.inject", text);
    soak->faults++;
}

/* By hand, and questions. */
static void act_command(struct soak *soak, unsigned unit)
{
    static const char *const asked[] = {"state", "plant.get", "state", "reset"};
    char text[120];
    snprintf(text, sizeof text, "{\"unit\":%u}", unit + 1u);
    switch (dice_roll(&soak->dice, 0, 7)) {
    case 0:
        snprintf(text, sizeof text, "{\"unit\":%u,\"on\":%s}", unit + 1u, dice_chance(&soak->dice, 60) ? "true" : "false");
        try_command(soak, "power", text);
        break;
    case 1:
        try_command(soak, "fault.list", "{}");
        break;
    case 2:
        try_command(soak, "fault.clear", "{}");
        break;
    case 3:
        try_command(soak, "plant.set", dice_chance(&soak->dice, 60) ? plant : "{\"plant\":null}");
        break;
    case 4:
        snprintf(text, sizeof text, "{\"unit\":%u,\"motor\":1,\"position\":30}", unit + 1u);
        try_command(soak, "plant.set", text);
        break;
    case 5:
        snprintf(text, sizeof text, "{\"unit\":%u,\"mask\":%u}", unit + 1u, (unsigned)dice_roll(&soak->dice, 0, 255));
        try_command(soak, "di.set", text);
        break;
    default:
        try_command(soak, asked[dice_roll(&soak->dice, 0, 3)], text);
        break;
    }
}

static void act_line(struct soak *soak)
{
    uint8_t bytes[64];
    size_t length = (size_t)dice_roll(&soak->dice, 1, sizeof bytes);
    switch (dice_roll(&soak->dice, 0, 7)) {
    case 0:
        sim_purge(&soak->sim);
        break;
    case 1:
        sim_break(&soak->sim, dice_chance(&soak->dice, 50));
        break;
    case 2:
        sim_set_timed(&soak->sim, dice_chance(&soak->dice, 50));
        break;
    default:
        for (size_t i = 0; i < length; i++)
            bytes[i] = dice_chance(&soak->dice, 10) ? 0x7E : (uint8_t)dice_roll(&soak->dice, 0, 255);
        if (sim_room(&soak->sim) >= length)
            sim_queue_bytes(&soak->sim, bytes, length, sim_now(&soak->sim));
        break;
    }
}

/* A request, perhaps into the middle of others' answers. */
static void act_request(struct soak *soak, bool flash)
{
    uint8_t message[200] = {2, (uint8_t)dice_roll(&soak->dice, '0', '4')}, frame[400];
    uint8_t node = (uint8_t)dice_roll(&soak->dice, 0, 16);
    size_t length = 2;
    if (dice_chance(&soak->dice, 60)) {
        const char *text = programs[dice_roll(&soak->dice, 0, sizeof programs / sizeof *programs - 1)];
        length += strlen(text);
        memcpy(message + 2, text, strlen(text));
    } else {
        message[0] = (uint8_t)dice_roll(&soak->dice, 1, 8);
        if (message[0] == 3 && !flash)
            message[0] = 4;
    }
    size_t size = host_frame(node, 0, message, length, frame);
    soak->requests++;
    if (sim_room(&soak->sim) >= size)
        sim_queue_bytes(&soak->sim, frame, size, sim_now(&soak->sim));
}

static void act(struct soak *soak, bool flash)
{
    switch (dice_roll(&soak->dice, 0, 9)) {
    case 0:
        act_fault(soak, flash);
        break;
    case 1:
    case 2:
        act_command(soak, (unsigned)dice_roll(&soak->dice, 0, UNITS - 1));
        break;
    case 3:
        act_line(soak);
        break;
    default:
        act_request(soak, flash);
        break;
    }
}

static void look(void *context, const struct watch_event *event)
{
    (void)context;
    (void)event;
}

static void everything_goes_wrong(struct soak *soak, bool flash)
{
    struct watcher watcher = {.kinds = (uint32_t)dice_roll(&soak->dice, 0, WATCH_ALL), .on_event = look};
    bool watched = dice_chance(&soak->dice, 50);
    soak->exact = false;
    if (watched)
        sim_watch(&soak->sim, &watcher);
    for (int64_t acts = dice_scale(&soak->dice, 5, 150); acts > 0; acts--) {
        pass(soak, (uint64_t)dice_scale(&soak->dice, 1, SECOND));
        act(soak, flash);
    }
    if (watched)
        sim_unwatch(&soak->sim, &watcher);
}

/* Coming back: jobs that were under way continue as if nothing had been. */
static void come_back(struct soak *soak)
{
    struct soak_unit *units = malloc(sizeof soak->unit);
    char name[32];
    if (!units)
        soak_fail(soak, "out of memory");
    counters_check(soak);
    memcpy(units, soak->unit, sizeof soak->unit);
    snprintf(name, sizeof name, "{\"name\":\"%d\"}", (int)dice_roll(&soak->dice, 1, 4));
    uint64_t taken = sim_now(&soak->sim);
    soak_command(soak, "snapshot", "%s", name);
    everything_goes_wrong(soak, true);
    sim_set_timed(&soak->sim, true); /* a snapshot is of a line of one kind */
    soak_command(soak, "restore", "%s", name);
    memcpy(soak->unit, units, sizeof soak->unit);
    free(units);
    uint64_t later = sim_now(&soak->sim) - taken;
    for (unsigned i = 0; i < UNITS * RKM04_MOTORS; i++)
        soak->unit[i / RKM04_MOTORS].motor[i % RKM04_MOTORS].done += later;
    soak->snapshots++;
}

void soak_clear(struct soak *soak)
{
    static const char clear[] = "\2" "0\\C100 C41",
        quiet[] = "\2" "1C01 C02 C03 C04 C05 C06 C07 C08 C80 C81 C82 C83 C84 C85 C86 C87 C88 C89 "
        "C90 C91 C92 C93 C94 C95", empty[] = "\2" "0\\";
    for (unsigned unit = 0; unit < UNITS; unit++) {
        soak_command(soak, "power", "{\"unit\":%u,\"on\":true}", unit + 1u);
        sim_set_di(&soak->sim, unit + 1u, 0);
    }
    const uint8_t flag = 0x7E;
    host_send(soak, &flag, 1);   /* ends what was left half sent */
    pass(soak, 10 * SECOND);     /* answers that were late */
    host_send_all(soak, clear, sizeof clear - 1);
    pass(soak, SECOND);
    host_send_all(soak, quiet, sizeof quiet - 1);
    pass(soak, SECOND);
    host_send_all(soak, empty, sizeof empty - 1);
    memset(soak->unit, 0, sizeof soak->unit);
    counters_begin(soak);
}

/* Clearing up: by hand. */
static void clear_up(struct soak *soak)
{
    soak_settle(soak);
    everything_goes_wrong(soak, false);
    soak_command(soak, "fault.clear", "{}");
    soak_command(soak, "plant.set", "{\"plant\":null}");
    sim_break(&soak->sim, false);
    sim_set_timed(&soak->sim, true);
    sim_purge(&soak->sim);
    soak_clear(soak);
    soak->exact = true;
    soak->receiver = (struct rkm04_receiver){0};
    for (unsigned unit = 0; unit < UNITS; unit++) { /* what power-up would begin is not known otherwise */
        size_t length = host_ask(soak, unit, "\3" "0", 2);
        if (length != 3 || soak->answer[2] != 0)
            soak_fail(soak, "unit %u: Store Flash is answered with error %u", unit + 1u, soak->answer[2]);
    }
    soak_settle(soak);
}

void round_chaos(struct soak *soak)
{
    if (dice_chance(&soak->dice, 60))
        come_back(soak);
    else
        clear_up(soak);
    soak->exact = true;
    soak->heard = 0;
    soak->receiver = (struct rkm04_receiver){0};
    counters_begin(soak);
}
