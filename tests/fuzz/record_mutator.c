/* SPDX-License-Identifier: MIT */
/* record_mutator.c: mutants of recordings that are recordings (docs/RECORD.md): lines go, come, change places; ticks, commands,
 * parameters, requests and settings change. The lines about what goes out are left out of most mutants, because they would not
 * agree any more; times are put in order again in most. Bytes are mutated only now and then: that gets no further than JSON. */
#include <jansson.h>
#include <stdbool.h>
#include <string.h>

#include "crc16.h"
#include "fuzz.h"

#define LINES_MAX 400u
#define EDITS_MAX 4u

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t *one, size_t one_size, const uint8_t *other, size_t other_size, uint8_t *data,
                                 size_t most, unsigned seed);

struct lines {
    json_t *line[LINES_MAX];
    size_t count;
    uint64_t random;
};

static const char head[] =
    "{\"rkm04_record\":1,\"emulator\":\"rkm04\",\"nodes\":[1,2],\"framing\":\"hdlc\",\"timed\":true,\"turnaround\":521,"
    "\"seed\":\"1\",\"outputs\":false}";

/* What can come in, with parameters that are executed: mutants of these are near to them. */
static const char *const inputs[] = {
    "{\"t\":0,\"purge\":true}",
    "{\"t\":0,\"break\":true}",
    "{\"t\":0,\"break\":false}",
    "{\"t\":0,\"timed\":false}",
    "{\"t\":0,\"timed\":true}",
    "{\"t\":0,\"moved\":1000}",
    "{\"t\":0,\"end\":true}",
    "{\"t\":0,\"command\":\"di.set\",\"params\":{\"unit\":\"1\",\"di\":{\"01\":1,\"05\":0}}}",
    "{\"t\":0,\"command\":\"di.set\",\"params\":{\"mask\":255}}",
    "{\"t\":0,\"command\":\"reset\",\"params\":{\"unit\":\"1\"}}",
    "{\"t\":0,\"command\":\"power\",\"params\":{\"on\":false}}",
    "{\"t\":0,\"command\":\"power\",\"params\":{\"on\":true}}",
    "{\"t\":0,\"command\":\"switch\",\"params\":{\"node\":3,\"reset\":true}}",
    "{\"t\":0,\"command\":\"snapshot\",\"params\":{\"name\":\"a\"}}",
    "{\"t\":0,\"command\":\"restore\",\"params\":{\"name\":\"a\"}}",
    "{\"t\":0,\"command\":\"snapshot\",\"params\":{\"file\":\"a\"}}",
    "{\"t\":0,\"command\":\"plant.set\",\"params\":{\"plant\":{\"motors\":{\"1\":{\"stops\":{\"low\":-5,\"high\":20},"
    "\"stall\":{\"start\":500}}},\"switches\":[{\"input\":1,\"motor\":1,\"at_least\":10,\"bounce\":\"2ms\"}]}}}",
    "{\"t\":0,\"command\":\"plant.set\",\"params\":{\"motor\":1,\"position\":3}}",
    "{\"t\":0,\"command\":\"plant.set\",\"params\":{\"plant\":null}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"drop\",\"probability\":0.5}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"flip\",\"mask\":4,\"count\":2,\"after\":\"1ms\"}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"input\",\"input\":3,\"level\":1,\"duration\":\"5ms\","
    "\"every\":\"20ms\"}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"delay\",\"delay\":\"3ms\"}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"cut\",\"bytes\":3}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"flash\",\"operation\":\"write\",\"torn\":true}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"power\",\"operation\":\"erase\",\"duration\":\"9ms\"}}",
    "{\"t\":0,\"command\":\"fault.inject\",\"params\":{\"kind\":\"echo\",\"for\":\"100ms\"}}",
    "{\"t\":0,\"command\":\"fault.clear\",\"params\":{\"id\":1}}",
    "{\"t\":0,\"command\":\"fault.clear\",\"params\":{}}",
};

static const char *const words[] = {
    "drop", "flip", "duplicate", "insert", "no_answer", "delay", "cut", "break", "cable", "echo", "flash", "power", "input",
    "unplugged", "to_units", "to_master", "both", "write", "erase", "program", "read", "1ms", "250us", "2.5s", "0s", "a", "b",
    "1", "2", "0", "hdlc", "plain", "unit", "motor", "kind", "count", "skip", "probability", "after", "for", "every", "duration",
    "name", "file", "hold-exit", "latch", "fault-exit", "new", "planning", "store-time", "input-filter",
};

static const char *const requests[] = {
    "2" "1\\F100 R",     "2" "0S50 V2000 A3000 B70 R H", "2" "2L3 F5 R W3 E", "2" "1K", "2" "1C75", "2" "1V300", "2" "3G+",
    "2" "4M01N02X03F900R", "2" "1F9Y V50 B9 Y R", "2" "2[", "2" "2]", "2" "1'7 J9 @7 T01 . @9 T41 C41", "3" "0", "3" "2", "1",
    "4" "0", "5" "1", "6" "1", "7" "2", "\x08", "2" "1)01(02", "2" "0\\",
};

#define SIZE_OF(list) (sizeof(list) / sizeof(list)[0])

static uint64_t draw(struct lines *lines, uint64_t below)
{
    lines->random = lines->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (lines->random >> 33) % below;
}

/* Lines that are JSON objects; others are left out. */
static void read_lines(struct lines *lines, const uint8_t *data, size_t size)
{
    struct fuzz all = {data, size};
    while (all.left > 0 && lines->count < LINES_MAX) {
        size_t length;
        const char *text = (const char *)fuzz_until(&all, '\n', &length);
        json_t *line = length > 0 ? json_loadb(text, length, 0, NULL) : NULL;
        if (json_is_object(line))
            lines->line[lines->count++] = line;
        else
            json_decref(line);
    }
    if (lines->count == 0)
        lines->line[lines->count++] = json_loads(head, 0, NULL);
}

static size_t write_lines(struct lines *lines, uint8_t *data, size_t most)
{
    size_t size = 0;
    for (size_t i = 0; i < lines->count; i++) {
        char *text = json_dumps(lines->line[i], JSON_COMPACT);
        size_t length = text ? strlen(text) : 0;
        if (text && length < most - size) {
            memcpy(data + size, text, length);
            data[size + length] = '\n';
            size += length + 1u;
        }
        free(text);
        json_decref(lines->line[i]);
    }
    return size;
}

static void remove_line(struct lines *lines, size_t at)
{
    json_decref(lines->line[at]);
    lines->count--;
    memmove(&lines->line[at], &lines->line[at + 1u], (lines->count - at) * sizeof lines->line[0]);
}

/* Put a line, which is handed over, after the head, at the tick of one that is there. */
static void insert_line(struct lines *lines, json_t *line)
{
    size_t at = 1u + draw(lines, lines->count);
    if (!line || lines->count == LINES_MAX) {
        json_decref(line);
        return;
    }
    json_t *tick = json_object_get(lines->line[at - 1u], "t");
    json_object_set_new(line, "t", json_integer(json_integer_value(tick) + (json_int_t)draw(lines, 3) * 1000));
    memmove(&lines->line[at + 1u], &lines->line[at], (lines->count - at) * sizeof lines->line[0]);
    lines->line[at] = line;
    lines->count++;
}

/* A request in a frame to node 0, 1 or 2 (L1). */
static json_t *new_request(struct lines *lines)
{
    const char *request = requests[draw(lines, SIZE_OF(requests))];
    uint8_t bytes[64] = {(uint8_t)draw(lines, 3), 0, (uint8_t)(*request - (*request > '0' ? '0' : 0))};
    uint16_t crc = CRC16_START;
    size_t length = 2u + strlen(request);
    char hex[300] = "7e";
    memcpy(bytes + 3, request + 1, strlen(request) - 1u);
    for (size_t i = 0; i < length; i++)
        crc = crc16_update(crc, bytes[i]);
    bytes[length] = (uint8_t)crc16_final(crc);
    bytes[length + 1u] = (uint8_t)(crc16_final(crc) >> 8);
    for (size_t i = 0; i < length + 2u; i++) {
        bool escaped = bytes[i] == 0x7e || bytes[i] == 0x7d;
        sprintf(hex + strlen(hex), escaped ? "7d%02x" : "%02x", escaped ? bytes[i] ^ 0x20u : bytes[i]);
    }
    return json_pack("{s:s}", "in", strcat(hex, "7e"));
}

static json_int_t near(struct lines *lines, json_int_t number)
{
    static const json_int_t known[] = {0, 1, 2, 8, 16, 255, 256, 1000, 100000, 99999, 2147483647, -1, 1000000000000000};
    json_int_t by = (json_int_t)draw(lines, 2000) - 1000;
    return draw(lines, 2) ? known[draw(lines, SIZE_OF(known))] : number > INT64_MAX - 1000 || number < 1000 ? by : number + by;
}

static json_t *any_line(struct lines *lines)
{
    return draw(lines, 3) == 0 ? new_request(lines) : json_loads(inputs[draw(lines, SIZE_OF(inputs))], 0, NULL);
}

/* Something like this value, or quite another one. */
static json_t *other_value(struct lines *lines, const json_t *value)
{
    const char *word = words[draw(lines, SIZE_OF(words))];
    if (draw(lines, 24) == 0)
        return draw(lines, 2) ? json_null() : json_pack("[i]", (int)draw(lines, 20));
    if (json_is_integer(value))
        return json_integer(near(lines, json_integer_value(value)));
    if (json_is_real(value))
        return json_real((double)draw(lines, 11) / 10.0);
    if (json_is_boolean(value))
        return json_boolean(!json_is_true(value));
    return json_is_string(value) ? json_string(word) : json_integer((json_int_t)draw(lines, 20));
}

static void change_object(struct lines *lines, json_t *object);

/* Change a value, or something within it. */
static void change_member(struct lines *lines, json_t *object, const char *key)
{
    json_t *value = json_object_get(object, key);
    if (json_is_object(value) && draw(lines, 8) > 0) {
        change_object(lines, value);
    } else if (json_is_array(value) && json_array_size(value) > 0 && draw(lines, 8) > 0) {
        size_t at = draw(lines, json_array_size(value));
        json_t *one = json_array_get(value, at);
        if (json_is_object(one))
            change_object(lines, one);
        else if (draw(lines, 3) > 0)
            json_array_set_new(value, at, other_value(lines, one));
        else
            json_array_append_new(value, other_value(lines, one));
    } else {
        json_object_set_new(object, key, other_value(lines, value));
    }
}

static void change_object(struct lines *lines, json_t *object)
{
    size_t count = json_object_size(object), chosen = count > 0 ? draw(lines, count) : 0;
    void *at = json_object_iter(object);
    while (chosen-- > 0)
        at = json_object_iter_next(object, at);
    uint64_t how = draw(lines, 8);
    if (!at || how == 0) {
        json_object_set_new(object, words[draw(lines, SIZE_OF(words))], other_value(lines, NULL));
    } else if (how == 1) {
        char *key = strdup(json_object_iter_key(at));
        json_object_del(object, key);
        free(key);
    } else {
        char *key = strdup(json_object_iter_key(at));
        change_member(lines, object, key);
        free(key);
    }
}

/* One of the settings in the head. */
static void change_head(struct lines *lines)
{
    static const char *const settings[] = {
        "{\"framing\":\"plain\"}", "{\"framing\":\"hdlc\"}", "{\"nodes\":[1]}", "{\"nodes\":[3,1,2]}", "{\"nodes\":[1,1]}",
        "{\"timed\":false}", "{\"turnaround\":0}", "{\"seed\":\"77\"}", "{\"readings\":{\"hold-exit\":\"latch\"}}",
        "{\"readings\":{\"planning\":20,\"store-time\":30}}", "{\"readings\":{\"input-filter\":5,\"fault-exit\":\"new\"}}",
        "{\"speed_change_latency\":100}", "{\"version_text\":\"x\"}",
        "{\"plant\":\"{\\\"switches\\\":[{\\\"input\\\":1,\\\"motor\\\":1,\\\"at_least\\\":9}]}\"}",
    };
    json_t *more = json_loads(settings[draw(lines, SIZE_OF(settings))], 0, NULL);
    if (draw(lines, 4) == 0)
        change_object(lines, lines->line[0]);
    else
        json_object_update(lines->line[0], more);
    json_decref(more);
}

/* Restore a file: the head of this recording and some of its lines. */
static void embed(struct lines *lines)
{
    size_t count = 1u + draw(lines, lines->count < 8 ? lines->count : 8), at = lines->count;
    if (lines->count + count + 2u > LINES_MAX)
        return;
    json_int_t tick = json_integer_value(json_object_get(lines->line[at - 1u], "t"));
    lines->line[at++] = json_pack("{s:I, s:i}", "t", tick, "embedded", (int)count);
    for (size_t i = 0; i < count; i++)
        lines->line[at++] = json_deep_copy(lines->line[i]);
    lines->line[at++] = json_pack("{s:I, s:s, s:{s:s}}", "t", tick, "command", "restore", "params", "file", "f");
    lines->count = at;
}

static void edit(struct lines *lines)
{
    size_t at = draw(lines, lines->count), other = draw(lines, lines->count);
    uint64_t how = draw(lines, 16);
    json_t *tick = json_object_get(lines->line[at], "t"), *params = json_object_get(lines->line[at], "params");
    if (how < 4)
        insert_line(lines, any_line(lines));
    else if (how < 6)
        insert_line(lines, json_deep_copy(lines->line[at]));
    else if (how < 8 && at > 0)
        remove_line(lines, at);
    else if (how < 10 && tick)
        json_integer_set(tick, near(lines, json_integer_value(tick)));
    else if (how < 13 && params)
        change_object(lines, params);
    else if (how == 13 && draw(lines, 4) == 0)
        embed(lines);
    else if (how == 14 && at > 0 && other > 0) {
        json_t *line = lines->line[at];
        lines->line[at] = lines->line[other];
        lines->line[other] = line;
    } else if (draw(lines, 4) > 0)
        change_head(lines);
    else
        change_object(lines, lines->line[at]);
}

static void leave_out_outputs(struct lines *lines)
{
    json_object_set_new(lines->line[0], "outputs", json_false());
    for (size_t i = lines->count - 1u; i > 0; i--)
        if (json_object_get(lines->line[i], "out") || json_object_get(lines->line[i], "digest"))
            remove_line(lines, i);
}

/* No time before that of the line before, but in embedded files, whose times are their own. */
static void order_times(struct lines *lines)
{
    json_int_t last = 0;
    for (size_t i = 1; i < lines->count; i++) {
        json_t *tick = json_object_get(lines->line[i], "t");
        if (json_is_integer(tick) && json_integer_value(tick) < last)
            json_integer_set(tick, last);
        last = json_is_integer(tick) ? json_integer_value(tick) : last;
        if (json_object_get(lines->line[i], "embedded"))
            i += (size_t)(json_integer_value(json_object_get(lines->line[i], "embedded")) & 0xff);
    }
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    static struct lines lines;
    lines.count = 0;
    lines.random = seed;
    if (draw(&lines, 16) == 0)
        return LLVMFuzzerMutate(data, size, most);
    read_lines(&lines, data, size);
    if (draw(&lines, 8) > 0)
        leave_out_outputs(&lines);
    for (uint64_t edits = 1u + draw(&lines, EDITS_MAX); edits > 0; edits--)
        edit(&lines);
    if (draw(&lines, 8) > 0)
        order_times(&lines);
    return write_lines(&lines, data, most);
}

/* The first lines of one, and lines of the other after them. */
size_t LLVMFuzzerCustomCrossOver(const uint8_t *one, size_t one_size, const uint8_t *other, size_t other_size, uint8_t *data,
                                 size_t most, unsigned seed)
{
    static struct lines lines, more;
    lines.count = more.count = 0;
    lines.random = seed;
    read_lines(&lines, one, one_size);
    read_lines(&more, other, other_size);
    leave_out_outputs(&lines);
    leave_out_outputs(&more);
    for (size_t keep = 1u + draw(&lines, lines.count); lines.count > keep;)
        remove_line(&lines, lines.count - 1u);
    for (size_t i = 1u + draw(&lines, more.count); i < more.count && lines.count < LINES_MAX; i++)
        lines.line[lines.count++] = json_incref(more.line[i]);
    for (size_t i = 0; i < more.count; i++)
        json_decref(more.line[i]);
    order_times(&lines);
    return write_lines(&lines, data, most);
}
