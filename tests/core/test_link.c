/* SPDX-License-Identifier: MIT */
/* test_link.c: the framings, L1 and L2 of the specification. One test alone: CK_RUN_CASE=hdlc ./test_link */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/link.h>

#include "crc16.h"

#define MESSAGE_MAX 9216
#define WIRE_MAX (2 * MESSAGE_MAX + 2 * RKM04_FRAME_EDGE_MAX)
#define BYTE_TICKS 520 /* at 19200 baud */
#define SILENCE_TICKS 100000

/* One receiving end with what it has delivered. The buffer is allocated to size, for the sanitizer to watch its end. */
static const struct rkm04_framing *framing;
static struct rkm04_receiver receiver;
static uint8_t *buffer;
static size_t room;
static uint64_t now;
static unsigned delivered;

static void listen(const struct rkm04_framing *with, size_t bytes)
{
    framing = with;
    memset(&receiver, 0, sizeof receiver);
    free(buffer);
    buffer = malloc(bytes);
    ck_assert_ptr_nonnull(buffer);
    room = bytes;
    now = 0;
    delivered = 0;
}

static void hang_up(void)
{
    free(buffer);
    buffer = NULL;
}

static bool hear_byte(uint8_t byte)
{
    now += BYTE_TICKS;
    bool whole = framing->receive(&receiver, byte, now, buffer, room);
    if (receiver.length > room) /* an assertion for every byte would take minutes */
        ck_abort_msg("%u bytes in a buffer of %zu", (unsigned)receiver.length, room);
    if (whole)
        delivered++;
    return whole;
}

static unsigned hear(const void *bytes, size_t length)
{
    unsigned before = delivered;
    for (size_t i = 0; i < length; i++)
        hear_byte(((const uint8_t *)bytes)[i]);
    return delivered - before;
}

#define HEAR(...) hear((const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))

static size_t encode(const struct rkm04_framing *with, uint8_t dnode, uint8_t snode, bool answer, const uint8_t *message,
                     size_t length, uint8_t *wire)
{
    struct rkm04_sender sender = {0};
    size_t n = with->begin(&sender, dnode, snode, length, answer, wire);
    size_t head = n;
    for (size_t i = 0; i < length; i++)
        n += with->put(&sender, message[i], wire + n);
    size_t tail = with->end(&sender, wire + n);
    if (head > RKM04_FRAME_EDGE_MAX || tail > RKM04_FRAME_EDGE_MAX)
        ck_abort_msg("edges of %zu and %zu bytes", head, tail);
    return n + tail;
}

/* A message that runs through all byte values and differs with its length. */
static void fill(uint8_t *message, size_t length)
{
    for (size_t i = 0; i < length; i++)
        message[i] = (uint8_t)(i * 7 + length);
}

static void assert_message(const uint8_t *message, size_t length)
{
    ck_assert_uint_eq(receiver.length, length);
    ck_assert_mem_eq(buffer, message, length);
}

static const uint8_t hello[] = {0x02, '1', 'F', '1', '0', '0', '0', 'R'};
static const uint8_t version[] = {0x01};

static void assert_hears_hello(void)
{
    uint8_t wire[2 * sizeof hello + 2 * RKM04_FRAME_EDGE_MAX];
    ck_assert_uint_eq(hear(wire, encode(framing, 1, 0, false, hello, sizeof hello, wire)), 1);
    assert_message(hello, sizeof hello);
    ck_assert_uint_eq(receiver.dnode, 1);
    ck_assert_uint_eq(receiver.snode, 0);
}

/* ---- Both --------------------------------------------------------------------------------------------------------- */

START_TEST(L1_the_check_sum_of_123456789_is_906E)
{
    uint16_t crc = CRC16_START;
    for (const char *c = "123456789"; *c != '\0'; c++)
        crc = crc16_update(crc, (uint8_t)*c);
    ck_assert_uint_eq(crc16_final(crc), 0x906E);
}
END_TEST

START_TEST(L1_the_check_sum_of_every_byte_is_that_of_the_bitwise_definition)
{
    for (unsigned start = 0; start < 0x10000; start += 0x101) {
        for (unsigned byte = 0; byte < 256; byte++) {
            unsigned expected = start ^ byte;
            for (int bit = 0; bit < 8; bit++)
                expected = (expected & 1) != 0 ? expected >> 1 ^ 0x8408 : expected >> 1;
            if (crc16_update((uint16_t)start, (uint8_t)byte) != expected)
                ck_abort_msg("byte %02x after %04x", byte, start);
        }
    }
}
END_TEST

START_TEST(L1_L2_a_framing_is_found_by_its_name_only)
{
    ck_assert_ptr_eq(rkm04_framing_named("hdlc"), &rkm04_hdlc);
    ck_assert_ptr_eq(rkm04_framing_named("plain"), &rkm04_plain);
    const char *const wrong[] = {"", "hdl", "hdlcc", "HDLC", "plain "};
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        ck_assert_ptr_null(rkm04_framing_named(wrong[i]));
    ck_assert_ptr_eq(rkm04_framings[0], &rkm04_hdlc);
}
END_TEST

START_TEST(L4_messages_of_every_length_and_every_byte_value_arrive_unchanged)
{
    static uint8_t message[MESSAGE_MAX], wire[WIRE_MAX];
    listen(rkm04_framings[_i], MESSAGE_MAX);
    for (size_t length = 1; length <= MESSAGE_MAX; length++) {
        uint8_t node = (uint8_t)(length % 17);
        fill(message, length);
        size_t n = encode(framing, node, 0, false, message, length, wire);
        ck_assert_uint_eq(hear(wire, n), 1);
        assert_message(message, length);
        ck_assert_uint_eq(receiver.dnode, node);
    }
    ck_assert_uint_eq(receiver.bad_check + receiver.malformed + receiver.too_long, 0);
    hang_up();
}
END_TEST

START_TEST(L4_a_message_as_long_as_the_buffer_fits_and_one_byte_more_is_dropped_and_counted)
{
    uint8_t message[65], wire[2 * 65 + 2 * RKM04_FRAME_EDGE_MAX];
    fill(message, sizeof message);
    listen(rkm04_framings[_i], 64);
    ck_assert_uint_eq(hear(wire, encode(framing, 1, 0, false, message, 64, wire)), 1);
    assert_message(message, 64);
    ck_assert_uint_eq(hear(wire, encode(framing, 1, 0, false, message, 65, wire)), 0);
    ck_assert_uint_eq(receiver.too_long, 1);
    ck_assert_uint_eq(receiver.bad_check + receiver.malformed, 0);
    assert_hears_hello();
    hang_up();
}
END_TEST

START_TEST(L4_random_bytes_neither_overrun_the_buffer_nor_stop_the_receiver)
{
    uint32_t random = 12345;
    listen(rkm04_framings[_i], 40);
    for (unsigned round = 0; round < 200; round++) {
        for (unsigned i = 0; i < 5000; i++) {
            random = random * 1664525u + 1013904223u;
            uint8_t byte = (uint8_t)(random >> 24);
            /* Flags, escapes and small lengths often enough to reach every state. */
            static const uint8_t often[] = {0x7E, 0x7D, 0x00, 0x01};
            hear_byte((random >> 16 & 7) == 0 ? often[random >> 12 & 3] : byte);
        }
        now += SILENCE_TICKS;
        HEAR(0x7E);
        now += SILENCE_TICKS;
        assert_hears_hello();
    }
    hang_up();
}
END_TEST

START_TEST(L4_two_receivers_do_not_know_of_each_other)
{
    uint8_t wire[64], first[16], second[16];
    struct rkm04_receiver one = {0}, two = {0};
    size_t n = encode(rkm04_framings[_i], 3, 0, false, hello, sizeof hello, wire);
    unsigned whole = 0;
    for (size_t i = 0; i < n; i++) {
        whole += rkm04_framings[_i]->receive(&one, wire[i], i, first, sizeof first);
        whole += rkm04_framings[_i]->receive(&two, wire[i], i, second, sizeof second);
    }
    ck_assert_uint_eq(whole, 2);
    ck_assert_mem_eq(first, second, sizeof hello);
}
END_TEST

/* ---- hdlc --------------------------------------------------------------------------------------------------------- */

START_TEST(L1_a_frame_on_the_wire_is_flag_nodes_message_check_flag)
{
    static const uint8_t expected[] = {0x7E, 0x01, 0x00, 0x01, 0x99, 0x8D, 0x7E};
    uint8_t wire[64];
    size_t n = encode(&rkm04_hdlc, 1, 0, false, version, sizeof version, wire);
    ck_assert_uint_eq(n, sizeof expected);
    ck_assert_mem_eq(wire, expected, n);
}
END_TEST

START_TEST(L1_flag_and_escape_are_escaped_in_every_field)
{
    static const uint8_t message[] = {0x7E, 0x7D, 0x5E, 0x20};
    static const uint8_t expected[] = {0x7E, 0x7D, 0x5D, 0x7D, 0x5E, 0x7D, 0x5E, 0x7D, 0x5D, 0x5E, 0x20};
    uint8_t wire[64];
    size_t n = encode(&rkm04_hdlc, 0x7D, 0x7E, true, message, sizeof message, wire);
    ck_assert_mem_eq(wire, expected, sizeof expected);
    ck_assert_ptr_eq(memchr(wire + 1, 0x7E, n - 1), wire + n - 1);
    listen(&rkm04_hdlc, 64);
    ck_assert_uint_eq(hear(wire, n), 1);
    assert_message(message, sizeof message);
    ck_assert_uint_eq(receiver.dnode, 0x7D);
    ck_assert_uint_eq(receiver.snode, 0x7E);
    hang_up();
}
END_TEST

START_TEST(L1_a_check_sum_that_contains_flags_and_escapes_arrives)
{
    /* Every value of the check sum comes by among the 65536 messages of two bytes. */
    uint8_t wire[64];
    unsigned escaped = 0;
    listen(&rkm04_hdlc, 2);
    for (unsigned value = 0; value < 0x10000; value++) {
        const uint8_t message[] = {(uint8_t)value, (uint8_t)(value >> 8)};
        size_t n = encode(&rkm04_hdlc, 1, 0, false, message, sizeof message, wire);
        escaped += memchr(wire + n - 4, 0x7D, 3) != NULL;
        if (hear(wire, n) != 1 || memcmp(buffer, message, sizeof message) != 0)
            ck_abort_msg("message %04x", value);
    }
    ck_assert_uint_gt(escaped, 0x10000 / 128);
    hang_up();
}
END_TEST

START_TEST(L1_an_answer_names_the_asker_and_the_unit)
{
    uint8_t wire[64];
    listen(&rkm04_hdlc, 64);
    ck_assert(framing->answer_names_sender);
    ck_assert_uint_eq(hear(wire, encode(framing, 0, 7, true, hello, sizeof hello, wire)), 1);
    ck_assert_uint_eq(receiver.dnode, 0);
    ck_assert_uint_eq(receiver.snode, 7);
    hang_up();
}
END_TEST

START_TEST(L1_one_flag_may_end_a_frame_and_begin_the_next)
{
    uint8_t wire[64];
    listen(&rkm04_hdlc, 64);
    size_t n = encode(framing, 1, 0, false, hello, sizeof hello, wire);
    ck_assert_uint_eq(hear(wire, n), 1);
    for (int i = 0; i < 3; i++)
        ck_assert_uint_eq(hear(wire + 1, n - 1), 1);
    assert_message(hello, sizeof hello);
    hang_up();
}
END_TEST

START_TEST(L1_empty_frames_are_nothing)
{
    listen(&rkm04_hdlc, 64);
    ck_assert_uint_eq(HEAR(0x7E, 0x7E, 0x7E, 0x7E), 0);
    ck_assert_uint_eq(receiver.malformed + receiver.bad_check + receiver.too_long, 0);
    assert_hears_hello();
    hang_up();
}
END_TEST

START_TEST(L1_an_abort_drops_the_frame_and_begins_the_next)
{
    uint8_t wire[64];
    listen(&rkm04_hdlc, 64);
    size_t n = encode(framing, 1, 0, false, hello, sizeof hello, wire);
    for (size_t cut = 1; cut < n; cut++) {
        struct rkm04_receiver before = receiver;
        ck_assert_uint_eq(hear(wire, cut), 0);
        ck_assert_uint_eq(HEAR(0x7D, 0x7E), 0);
        ck_assert_uint_eq(receiver.malformed, before.malformed + 1);
        ck_assert_uint_eq(hear(wire + 1, n - 1), 1);
    }
    ck_assert_uint_eq(receiver.bad_check, 0);
    hang_up();
}
END_TEST

START_TEST(L1_a_frame_shorter_than_five_bytes_is_dropped_and_counted)
{
    /* The four bytes 01 00 + their right check sum carry no message. */
    uint16_t crc = crc16_final(crc16_update(crc16_update(CRC16_START, 1), 0));
    const uint8_t wire[] = {0x7E, 0x01, 0x00, (uint8_t)(crc & 0xFF), (uint8_t)(crc >> 8), 0x7E};
    listen(&rkm04_hdlc, 64);
    ck_assert_uint_eq(hear(wire, sizeof wire), 0);
    ck_assert_uint_eq(receiver.malformed, 1);
    for (size_t length = 1; length < 4; length++) {
        ck_assert_uint_eq(hear(wire, length + 1), 0);
        ck_assert_uint_eq(HEAR(0x7E), 0);
        ck_assert_uint_eq(receiver.malformed, 1 + length);
    }
    ck_assert_uint_eq(receiver.bad_check, 0);
    assert_hears_hello();
    hang_up();
}
END_TEST

START_TEST(L1_a_wrong_check_sum_drops_the_frame_and_is_counted)
{
    uint8_t wire[64];
    listen(&rkm04_hdlc, 64);
    size_t n = encode(framing, 1, 0, false, hello, sizeof hello, wire);
    wire[n - 2] ^= 0x01;
    ck_assert_uint_eq(hear(wire, n), 0);
    ck_assert_uint_eq(receiver.bad_check, 1);
    ck_assert_uint_eq(receiver.malformed + receiver.too_long, 0);
    assert_hears_hello();
    hang_up();
}
END_TEST

START_TEST(L1_a_frame_with_any_single_bit_flipped_is_dropped)
{
    uint8_t message[64], wire[2 * 64 + 2 * RKM04_FRAME_EDGE_MAX];
    for (unsigned start = 0; start < 256; start += 40) {
        for (size_t i = 0; i < sizeof message; i++)
            message[i] = (uint8_t)(start + i);
        size_t n = encode(&rkm04_hdlc, 1, 0, false, message, sizeof message, wire);
        for (size_t bit = 0; bit < 8 * n; bit++) {
            for (int fresh = 0; fresh <= 1; fresh++) {
                listen(&rkm04_hdlc, 80);
                if (!fresh)
                    HEAR(0x7E);
                wire[bit / 8] ^= (uint8_t)(1u << bit % 8);
                unsigned whole = hear(wire, n);
                wire[bit / 8] ^= (uint8_t)(1u << bit % 8);
                ck_assert_msg(whole == 0, "bit %zu", bit);
                assert_hears_hello();
            }
        }
    }
    hang_up();
}
END_TEST

START_TEST(L1_garbage_before_the_first_flag_is_passed_over)
{
    listen(&rkm04_hdlc, 16);
    for (unsigned i = 0; i < 1000; i++)
        hear_byte((uint8_t)(i % 0x7D));
    ck_assert_uint_eq(delivered, 0);
    ck_assert_uint_eq(receiver.malformed + receiver.bad_check + receiver.too_long, 0);
    assert_hears_hello();
    hang_up();
}
END_TEST

START_TEST(L1_garbage_between_frames_costs_no_frame)
{
    listen(&rkm04_hdlc, 16);
    assert_hears_hello();
    HEAR('n', 'o', 'i', 's', 'e', ' ', 'o', 'n');
    assert_hears_hello();
    ck_assert_uint_eq(receiver.bad_check, 1);
    for (unsigned i = 0; i < 1000; i++)
        hear_byte(0x55);
    assert_hears_hello();
    ck_assert_uint_eq(receiver.too_long, 1);
    hang_up();
}
END_TEST

START_TEST(L1_silence_inside_a_frame_changes_nothing)
{
    uint8_t wire[64];
    listen(&rkm04_hdlc, 16);
    size_t n = encode(framing, 1, 0, false, hello, sizeof hello, wire);
    for (size_t i = 0; i < n; i++) {
        now += 3600ull * RKM04_TICKS_PER_SECOND;
        hear(wire + i, 1);
    }
    ck_assert_uint_eq(delivered, 1);
    assert_message(hello, sizeof hello);
    hang_up();
}
END_TEST

/* ---- plain -------------------------------------------------------------------------------------------------------- */

START_TEST(L2_a_frame_on_the_wire_is_node_length_message)
{
    static const uint8_t expected[] = {0x05, 0x01, 0x02, 'x'};
    static uint8_t message[0x102], wire[WIRE_MAX];
    memset(message, 'x', sizeof message);
    size_t n = encode(&rkm04_plain, 5, 0, false, message, sizeof message, wire);
    ck_assert_uint_eq(n, 3 + sizeof message);
    ck_assert_mem_eq(wire, expected, sizeof expected);
}
END_TEST

START_TEST(L2_an_answer_carries_the_units_own_node)
{
    uint8_t wire[64];
    listen(&rkm04_plain, 64);
    ck_assert(!framing->answer_names_sender);
    ck_assert_uint_eq(hear(wire, encode(framing, 0, 7, true, hello, sizeof hello, wire)), 1);
    ck_assert_uint_eq(receiver.dnode, 7);
    hang_up();
}
END_TEST

START_TEST(L2_frames_for_other_nodes_are_delivered_whole_with_their_node)
{
    listen(&rkm04_plain, 16);
    for (uint8_t node = 0; node <= RKM04_NODE_MAX; node++) {
        ck_assert_uint_eq(HEAR(node, 0, 2, 0x05, 0x31), 1);
        ck_assert_uint_eq(receiver.dnode, node);
        assert_message((const uint8_t *)"\x05\x31", 2);
    }
    hang_up();
}
END_TEST

START_TEST(L2_a_frame_longer_than_the_buffer_is_skipped_by_its_length)
{
    listen(&rkm04_plain, 16);
    const uint16_t lengths[] = {17, 255, 256, 9216};
    for (size_t i = 0; i < 4; i++) {
        HEAR(1, (uint8_t)(lengths[i] >> 8), (uint8_t)lengths[i]);
        /* Taken as a header, each of these bytes would begin a frame of one byte. */
        unsigned before = delivered;
        for (unsigned byte = 0; byte < lengths[i]; byte++)
            hear_byte(byte % 4 == 0 || byte % 4 == 2);
        ck_assert_uint_eq(delivered, before);
        ck_assert_uint_eq(receiver.too_long, i + 1);
        assert_hears_hello();
    }
    ck_assert_uint_eq(receiver.malformed, 0);
    hang_up();
}
END_TEST

START_TEST(L2_a_length_of_0_or_above_9216_drops_what_has_been_gathered)
{
    listen(&rkm04_plain, MESSAGE_MAX);
    const uint16_t lengths[] = {0, 9217, 0x2500, 0xFFFF};
    for (size_t i = 0; i < 4; i++) {
        HEAR(1, (uint8_t)(lengths[i] >> 8), (uint8_t)lengths[i]);
        ck_assert_uint_eq(receiver.malformed, i + 1);
        assert_hears_hello();
    }
    ck_assert_uint_eq(receiver.too_long, 0);
    hang_up();
}
END_TEST

START_TEST(L2_a_node_above_16_is_dropped)
{
    listen(&rkm04_plain, 16);
    for (unsigned node = RKM04_NODE_MAX + 1; node < 256; node++) {
        ck_assert(!hear_byte((uint8_t)node));
        assert_hears_hello();
    }
    ck_assert_uint_eq(receiver.malformed, 255 - RKM04_NODE_MAX);
    hang_up();
}
END_TEST

START_TEST(L2_100_ms_of_silence_inside_a_frame_drop_what_has_been_gathered)
{
    uint8_t wire[64];
    listen(&rkm04_plain, 16);
    size_t n = encode(framing, 1, 0, false, hello, sizeof hello, wire);
    for (size_t cut = 1; cut < n; cut++) {
        ck_assert_uint_eq(hear(wire, cut), 0);
        now += SILENCE_TICKS - BYTE_TICKS;
        assert_hears_hello();
        ck_assert_uint_eq(receiver.malformed, cut);
    }
    hang_up();
}
END_TEST

START_TEST(L2_less_than_100_ms_of_silence_inside_a_frame_change_nothing)
{
    uint8_t wire[64];
    listen(&rkm04_plain, 16);
    size_t n = encode(framing, 1, 0, false, hello, sizeof hello, wire);
    for (size_t i = 0; i < n; i++) {
        now += SILENCE_TICKS - BYTE_TICKS - 1;
        hear(wire + i, 1);
    }
    ck_assert_uint_eq(delivered, 1);
    ck_assert_uint_eq(receiver.malformed, 0);
    hang_up();
}
END_TEST

START_TEST(L2_silence_ends_the_skipping_of_a_long_frame)
{
    listen(&rkm04_plain, 16);
    HEAR(1, 0x20, 0x00, 'x', 'y');
    now += SILENCE_TICKS;
    assert_hears_hello();
    ck_assert_uint_eq(receiver.too_long, 1);
    ck_assert_uint_eq(receiver.malformed, 0);
    hang_up();
}
END_TEST

START_TEST(L2_silence_between_frames_is_nothing)
{
    listen(&rkm04_plain, 16);
    for (int i = 0; i < 5; i++) {
        now += 10 * SILENCE_TICKS;
        assert_hears_hello();
    }
    ck_assert_uint_eq(receiver.malformed, 0);
    hang_up();
}
END_TEST

static Suite *link_suite(void)
{
    Suite *suite = suite_create("link");
    TCase *both = tcase_create("both");
    tcase_set_timeout(both, 120);
    tcase_add_test(both, L1_the_check_sum_of_123456789_is_906E);
    tcase_add_test(both, L1_the_check_sum_of_every_byte_is_that_of_the_bitwise_definition);
    tcase_add_test(both, L1_L2_a_framing_is_found_by_its_name_only);
    tcase_add_loop_test(both, L4_messages_of_every_length_and_every_byte_value_arrive_unchanged, 0, 2);
    tcase_add_loop_test(both, L4_a_message_as_long_as_the_buffer_fits_and_one_byte_more_is_dropped_and_counted, 0, 2);
    tcase_add_loop_test(both, L4_random_bytes_neither_overrun_the_buffer_nor_stop_the_receiver, 0, 2);
    tcase_add_loop_test(both, L4_two_receivers_do_not_know_of_each_other, 0, 2);
    suite_add_tcase(suite, both);

    TCase *hdlc = tcase_create("hdlc");
    tcase_set_timeout(hdlc, 60);
    tcase_add_test(hdlc, L1_a_frame_on_the_wire_is_flag_nodes_message_check_flag);
    tcase_add_test(hdlc, L1_flag_and_escape_are_escaped_in_every_field);
    tcase_add_test(hdlc, L1_a_check_sum_that_contains_flags_and_escapes_arrives);
    tcase_add_test(hdlc, L1_an_answer_names_the_asker_and_the_unit);
    tcase_add_test(hdlc, L1_one_flag_may_end_a_frame_and_begin_the_next);
    tcase_add_test(hdlc, L1_empty_frames_are_nothing);
    tcase_add_test(hdlc, L1_an_abort_drops_the_frame_and_begins_the_next);
    tcase_add_test(hdlc, L1_a_frame_shorter_than_five_bytes_is_dropped_and_counted);
    tcase_add_test(hdlc, L1_a_wrong_check_sum_drops_the_frame_and_is_counted);
    tcase_add_test(hdlc, L1_a_frame_with_any_single_bit_flipped_is_dropped);
    tcase_add_test(hdlc, L1_garbage_before_the_first_flag_is_passed_over);
    tcase_add_test(hdlc, L1_garbage_between_frames_costs_no_frame);
    tcase_add_test(hdlc, L1_silence_inside_a_frame_changes_nothing);
    suite_add_tcase(suite, hdlc);

    TCase *plain = tcase_create("plain");
    tcase_add_test(plain, L2_a_frame_on_the_wire_is_node_length_message);
    tcase_add_test(plain, L2_an_answer_carries_the_units_own_node);
    tcase_add_test(plain, L2_frames_for_other_nodes_are_delivered_whole_with_their_node);
    tcase_add_test(plain, L2_a_frame_longer_than_the_buffer_is_skipped_by_its_length);
    tcase_add_test(plain, L2_a_length_of_0_or_above_9216_drops_what_has_been_gathered);
    tcase_add_test(plain, L2_a_node_above_16_is_dropped);
    tcase_add_test(plain, L2_100_ms_of_silence_inside_a_frame_drop_what_has_been_gathered);
    tcase_add_test(plain, L2_less_than_100_ms_of_silence_inside_a_frame_change_nothing);
    tcase_add_test(plain, L2_silence_ends_the_skipping_of_a_long_frame);
    tcase_add_test(plain, L2_silence_between_frames_is_nothing);
    suite_add_tcase(suite, plain);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(link_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=both|hdlc|plain ./test_link\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
