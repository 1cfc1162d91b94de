/* SPDX-License-Identifier: MIT */
/* test_wire.c: two wires, bit by bit (U7). Times are parts of a tick. One case alone: CK_RUN_CASE=CASE ./test_wire */
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "wire/levels.h"

#define HEARD_MAX 4096
#define BAUD 115200u /* the fewest parts */
#define BIT 625u
#define BYTE 6250u

static struct wire wire;
static struct wire_byte received[HEARD_MAX];
static size_t count;

/* Hear all there is by `until`. */
static void hear(uint64_t until)
{
    while (count < HEARD_MAX && wire_receive(&wire, until, &received[count]))
        count++;
}

static void begin(unsigned units)
{
    count = 0;
    wire_begin(&wire, BAUD);
    for (unsigned unit = 1; unit <= units; unit++)
        wire_join(&wire, unit, 0);
}

/* The n-th (0..) byte that an ear has received, lost ones included; NULL if there are fewer. */
static const struct wire_byte *at(unsigned receiver, size_t n)
{
    for (size_t i = 0; i < count; i++)
        if (received[i].receiver == receiver && n-- == 0)
            return &received[i];
    return NULL;
}

static size_t number(unsigned receiver)
{
    size_t n = 0;
    while (at(receiver, n))
        n++;
    return n;
}

static void expect(unsigned receiver, size_t n, uint64_t start, uint8_t byte, uint32_t senders)
{
    const struct wire_byte *found = at(receiver, n);
    ck_assert_msg(found != NULL, "ear %u has heard %zu bytes only", receiver, number(receiver));
    ck_assert_uint_eq(found->start, start);
    ck_assert_uint_eq(found->end, start + BYTE);
    ck_assert_uint_eq(found->byte, byte);
    ck_assert_uint_eq(found->senders, senders);
    ck_assert(!found->lost);
}

/* ---- One sender ----------------------------------------------------------------------------------------------------- */

START_TEST(U7_every_byte_is_received_as_it_was_sent_by_all_but_the_sender)
{
    begin(2);
    wire_send(&wire, 1, (uint8_t)_i, 1000);
    ck_assert_uint_eq(wire_due(&wire), 1000 + BYTE);
    hear(1000 + BYTE - 1);
    ck_assert_uint_eq(count, 0);
    hear(1000 + BYTE);
    ck_assert_uint_eq(count, 3);
    expect(WIRE_HOST, 0, 1000, (uint8_t)_i, 1u << 1);
    expect(2, 0, 1000, (uint8_t)_i, 1u << 1);
    expect(WIRE_MONITOR, 0, 1000, (uint8_t)_i, 1u << 1);
    ck_assert_uint_eq(wire_due(&wire), RKM04_NEVER);
    ck_assert_uint_eq(wire.collisions, 0);
}
END_TEST

START_TEST(U7_bytes_without_a_gap_are_received_one_after_the_other)
{
    begin(1);
    for (unsigned k = 0; k < 600; k++) {
        hear(77 + k * (uint64_t)BYTE);
        wire_send(&wire, WIRE_HOST, (uint8_t)(k * 37), 77 + k * (uint64_t)BYTE);
    }
    hear(RKM04_NEVER);
    for (unsigned k = 0; k < 600; k++)
        expect(1, k, 77 + k * (uint64_t)BYTE, (uint8_t)(k * 37), 1u << WIRE_HOST);
    ck_assert_uint_eq(number(1), 600);
    ck_assert_uint_eq(number(WIRE_HOST), 0);
    ck_assert_uint_eq(wire.sent, 600);
}
END_TEST

START_TEST(a_station_that_is_not_there_receives_nothing)
{
    begin(2);
    wire_leave(&wire, 2, 0);
    wire_send(&wire, 1, 0x55, 0);
    hear(RKM04_NEVER);
    ck_assert_uint_eq(number(2), 0);
    ck_assert_uint_eq(number(WIRE_HOST), 1);
}
END_TEST

/* ---- Several senders ------------------------------------------------------------------------------------------------ */

START_TEST(the_same_byte_sent_twice_at_once_is_received_as_it_is)
{
    begin(3);
    wire_send(&wire, 1, 0xA5, 0);
    wire_send(&wire, 2, 0xA5, 0);
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, 0, 0xA5, 1u << 1 | 1u << 2);
    expect(3, 0, 0, 0xA5, 1u << 1 | 1u << 2);
    ck_assert_uint_eq(number(1), 0);
    ck_assert_uint_eq(number(2), 0);
    ck_assert_uint_eq(wire.collisions, 2);
}
END_TEST

START_TEST(of_two_bytes_at_once_a_0_wins_in_every_bit)
{
    begin(2);
    wire_send(&wire, 1, 0xF6, 0);
    wire_send(&wire, 2, 0x5F, 0);
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, 0, 0xF6 & 0x5F, 1u << 1 | 1u << 2);
}
END_TEST

START_TEST(a_byte_that_comes_three_bits_late_is_received_as_part_of_the_first)
{
    begin(2);
    wire_send(&wire, 1, 0xFF, 0);          /* 0 1111 1111 1 */
    wire_send(&wire, 2, 0xB9, 3 * BIT);    /*    0 1001 1101 1, so 0 11 0 1001 1 | 101 1 */
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, 0, 0xCB, 1u << 1 | 1u << 2); /* 1 1 0 1 0 0 1 1 upwards, then 1 for the stop bit */
    ck_assert_ptr_nonnull(at(WIRE_HOST, 1));          /* and the 0 after it passes for one more start bit */
    ck_assert_uint_eq(at(WIRE_HOST, 1)->start, 10 * BIT);
    ck_assert_uint_eq(wire.collisions, 2);
}
END_TEST

START_TEST(a_wrong_stop_bit_loses_the_byte)
{
    begin(2);
    wire_send(&wire, 1, 0x00, 0);
    wire_send(&wire, 2, 0x00, 5 * BIT); /* 0 from the start of the one to the stop bit of the other */
    hear(RKM04_NEVER);
    ck_assert_uint_eq(number(WIRE_HOST), 0);
    ck_assert_uint_eq(wire.receiver[WIRE_HOST].framing_errors, 1);
    ck_assert_uint_eq(number(WIRE_MONITOR), 1);
    ck_assert(at(WIRE_MONITOR, 0)->lost);
    uint64_t later = 20 * BIT;
    wire_send(&wire, 1, 0x42, later);
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, later, 0x42, 1u << 1);
}
END_TEST

START_TEST(a_small_shift_does_no_harm)
{
    begin(2);
    wire_send(&wire, 1, 0x3C, 0);
    wire_send(&wire, 2, 0x3C, BIT / 3);
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, 0, 0x3C, 1u << 1 | 1u << 2);
    ck_assert_uint_eq(number(WIRE_HOST), 1);
}
END_TEST

START_TEST(bytes_that_touch_do_not_collide)
{
    begin(2);
    wire_send(&wire, 1, 0x00, 0);
    hear(BYTE);
    wire_send(&wire, 2, 0x00, BYTE);
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, 0, 0x00, 1u << 1);
    expect(WIRE_HOST, 1, BYTE, 0x00, 1u << 2);
    ck_assert_uint_eq(wire.collisions, 0);
}
END_TEST

/* ---- Who sends does not receive ------------------------------------------------------------------------------------------ */

START_TEST(who_begins_to_send_within_a_byte_does_not_receive_it)
{
    begin(2);
    wire_send(&wire, 1, 0xFF, 0);
    wire_send(&wire, 2, 0xFF, 8 * BIT);
    hear(RKM04_NEVER);
    ck_assert_uint_eq(number(2), 0);
    ck_assert_uint_eq(number(1), 0); /* the rest of what 2 sends is a 1 */
    ck_assert_uint_eq(wire.receiver[2].framing_errors, 0);
}
END_TEST

START_TEST(who_has_sent_joins_in_the_middle_of_what_others_send)
{
    begin(2);
    wire_send(&wire, 1, 0xFF, 0);
    wire_send(&wire, 2, 0x00, 5 * BIT); /* 0 from 5 to 14 bits; 1 receives from 10 bits on: 0 for 4 bits */
    hear(RKM04_NEVER);
    expect(1, 0, 10 * BIT, 0xF8, 1u << 2);
}
END_TEST

/* ---- Power and breaks ------------------------------------------------------------------------------------------------- */

START_TEST(a_start_bit_that_is_gone_in_its_middle_was_none)
{
    begin(2);
    wire_send(&wire, 1, 0x00, 0);
    wire_leave(&wire, 1, BIT / 2 - 10);
    hear(RKM04_NEVER);
    ck_assert_uint_eq(count, 0);
    wire_send(&wire, 2, 0x17, BIT);
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, BIT, 0x17, 1u << 2);
}
END_TEST

START_TEST(a_sender_without_power_leaves_the_line_at_1)
{
    begin(2);
    wire_send(&wire, 1, 0x00, 0);
    wire_leave(&wire, 1, 5 * BIT);
    hear(RKM04_NEVER);
    expect(WIRE_HOST, 0, 0, 0xF0, 1u << 1);
}
END_TEST

START_TEST(who_joins_within_a_byte_waits_for_the_line_to_fall)
{
    begin(1);
    wire_send(&wire, WIRE_HOST, 0xC0, 0); /* 0 000000 11 1 */
    hear(3 * BIT);
    wire_join(&wire, 2, 3 * BIT);
    hear(RKM04_NEVER);
    ck_assert_uint_eq(number(1), 1);
    ck_assert_uint_eq(number(2), 0);
}
END_TEST

START_TEST(a_break_is_one_lost_byte_and_then_silence)
{
    begin(1);
    wire_hold(&wire, WIRE_HOST, true, 0);
    wire_hold(&wire, WIRE_HOST, true, 10);
    hear(100 * BYTE);
    ck_assert_uint_eq(wire.receiver[1].framing_errors, 1);
    ck_assert_uint_eq(wire.receiver[WIRE_HOST].framing_errors, 0);
    wire_hold(&wire, WIRE_HOST, false, 100 * BYTE);
    wire_send(&wire, WIRE_HOST, 0x99, 101 * BYTE);
    hear(RKM04_NEVER);
    expect(1, 0, 101 * BYTE, 0x99, 1u << WIRE_HOST);
    ck_assert_uint_eq(wire.receiver[1].framing_errors, 1);
}
END_TEST

START_TEST(what_is_sent_during_a_break_is_not_received)
{
    begin(2);
    wire_hold(&wire, WIRE_HOST, true, 0);
    wire_send(&wire, 1, 0x55, 4 * BIT);
    hear(20 * BYTE);
    ck_assert_uint_eq(number(2), 0);
    ck_assert_uint_eq(number(WIRE_HOST), 0);
    ck_assert_uint_eq(wire.collisions, 1);
    wire_send(&wire, WIRE_HOST, 0x55, 30 * BYTE); /* none collides with itself */
    ck_assert_uint_eq(wire.collisions, 1);
}
END_TEST

START_TEST(bytes_take_the_time_of_the_speed)
{
    static const unsigned speeds[] = {9600, 19200, 38400, 57600, 115200};
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++) {
        struct wire_byte byte;
        wire_begin(&wire, speeds[i]);
        wire_send(&wire, WIRE_HOST, 0xA5, 1000);
        uint64_t end = 1000 + UINT64_C(10000000) * WIRE_TICK / speeds[i];
        ck_assert_uint_eq(wire_due(&wire), end);
        ck_assert(!wire_receive(&wire, end - 1, &byte));
        ck_assert(wire_receive(&wire, end, &byte));
        ck_assert_uint_eq(byte.byte, 0xA5);
        ck_assert_uint_eq(byte.end, end);
        ck_assert(!byte.lost);
    }
}
END_TEST

START_TEST(any_number_of_short_breaks_is_survived)
{
    begin(1);
    for (uint64_t i = 0; i < 1000; i++) {
        wire_hold(&wire, WIRE_HOST, true, i * 24);
        wire_hold(&wire, WIRE_HOST, false, i * 24 + 12);
        hear(i * 24 + 12);
    }
    hear(30000);
    wire_send(&wire, WIRE_HOST, 0x5A, 40000);
    hear(RKM04_NEVER);
    expect(1, number(1) - 1, 40000, 0x5A, 1u << WIRE_HOST);
}
END_TEST

/* ---- Against a UART that is stepped part by part ----------------------------------------------------------------------- */

#define STATIONS 4u
#define LENGTH (14u * BYTE)

static bool low[STATIONS][LENGTH], busy[STATIONS][LENGTH]; /* what each station sends, and when */

struct send {
    uint64_t start;
    unsigned station;
    uint8_t byte;
};

static uint32_t seed;

static uint32_t any(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

static int by_start(const void *a, const void *b)
{
    const struct send *x = a, *y = b;
    return x->start < y->start ? -1 : x->start > y->start;
}

/* Any time below this; in every other round one at which things are likely to meet: at whole and half bits. */
static uint64_t any_time(uint32_t below, int round)
{
    return round % 2 == 0 ? any(below) : any(below / BIT) * (uint64_t)BIT + any(2) * (BIT / 2) + any(2);
}

/* Let each station send bytes with and without gaps, the last one until it loses its power at `off`. Returns their number. */
static size_t draw(struct send *sends, uint64_t off, int round)
{
    size_t n = 0;
    memset(low, 0, sizeof low);
    memset(busy, 0, sizeof busy);
    for (unsigned station = 0; station < STATIONS; station++) {
        uint64_t end = station == STATIONS - 1 ? off : LENGTH;
        for (uint64_t start = any_time(3 * BYTE, round); start < end && start + 2 * BYTE < LENGTH;) {
            uint8_t byte = any(4) == 0 ? 0 : (uint8_t)any(256);
            sends[n++] = (struct send){start, station, byte};
            for (unsigned i = 0; i < BYTE && start + i < end; i++) {
                unsigned bit = i / BIT;
                busy[station][start + i] = true;
                low[station][start + i] = bit == 0 || (bit < 9 && (byte >> (bit - 1) & 1) == 0);
            }
            start += BYTE + (any(2) == 0 ? 0 : any_time(4 * BYTE, round));
        }
    }
    qsort(sends, n, sizeof *sends, by_start);
    return n;
}

/* Step a UART through the line and compare all it receives with what the ear has received. */
static void compare(unsigned receiver, int round)
{
    bool within = false, before = true;
    uint64_t fall = 0;
    unsigned bits = 0;
    size_t n = 0;
    uint64_t lost = 0;
    for (uint64_t time = 0; time < LENGTH; time++) {
        bool high = true;
        for (unsigned station = 0; station < STATIONS; station++)
            high = high && (station == receiver || !low[station][time]);
        uint64_t into = time - fall;
        if (receiver < STATIONS && busy[receiver][time]) {
            within = false;
            before = true;
        } else if (within && into == 9 * BIT + BIT / 2) {
            within = false;
            before = high;
            if (high || receiver == WIRE_MONITOR) {
                const struct wire_byte *found = at(receiver, n++);
                ck_assert_msg(found && found->start == fall && found->byte == bits && found->lost == !high,
                              "round %d, ear %u: byte %zu should be %02x from %llu on", round, receiver, n, bits,
                              (unsigned long long)fall);
            }
            lost += !high;
        } else if (!within) {
            within = before && !high;
            before = high;
            fall = time;
            bits = 0;
        } else if (into == BIT / 2 && high) {
            within = false;
            before = true;
        } else if (into > BIT && into % BIT == BIT / 2) {
            bits |= (unsigned)high << (into / BIT - 1);
        }
    }
    ck_assert_uint_eq(number(receiver), n);
    ck_assert_uint_eq(wire.receiver[receiver].framing_errors, lost);
}

START_TEST(whatever_is_sent_is_received_as_a_UART_receives_it)
{
    static struct send sends[STATIONS * LENGTH / BYTE];
    seed = (uint32_t)_i;
    begin(STATIONS - 1);
    uint64_t off = any(2) ? any_time(LENGTH - BYTE, _i) : LENGTH;
    size_t n = draw(sends, off, _i);
    for (size_t i = 0; i < n; i++) {
        if (off < sends[i].start) {
            hear(off);
            wire_leave(&wire, STATIONS - 1, off);
            off = LENGTH;
        }
        hear(sends[i].start);
        wire_send(&wire, sends[i].station, sends[i].byte, sends[i].start);
    }
    hear(off);
    if (off < LENGTH)
        wire_leave(&wire, STATIONS - 1, off);
    hear(RKM04_NEVER);
    for (unsigned receiver = 0; receiver < STATIONS - ((wire.stations >> (STATIONS - 1) & 1) == 0); receiver++)
        compare(receiver, _i);
    compare(WIRE_MONITOR, _i);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("wire");
    TCase *sender = tcase_create("sender");
    tcase_add_loop_test(sender, U7_every_byte_is_received_as_it_was_sent_by_all_but_the_sender, 0, 256);
    tcase_add_test(sender, U7_bytes_without_a_gap_are_received_one_after_the_other);
    tcase_add_test(sender, a_station_that_is_not_there_receives_nothing);
    suite_add_tcase(suite, sender);
    TCase *collision = tcase_create("collision");
    tcase_add_test(collision, the_same_byte_sent_twice_at_once_is_received_as_it_is);
    tcase_add_test(collision, of_two_bytes_at_once_a_0_wins_in_every_bit);
    tcase_add_test(collision, a_byte_that_comes_three_bits_late_is_received_as_part_of_the_first);
    tcase_add_test(collision, a_wrong_stop_bit_loses_the_byte);
    tcase_add_test(collision, a_small_shift_does_no_harm);
    tcase_add_test(collision, bytes_that_touch_do_not_collide);
    tcase_add_test(collision, who_begins_to_send_within_a_byte_does_not_receive_it);
    tcase_add_test(collision, who_has_sent_joins_in_the_middle_of_what_others_send);
    suite_add_tcase(suite, collision);
    TCase *power = tcase_create("power");
    tcase_add_test(power, a_start_bit_that_is_gone_in_its_middle_was_none);
    tcase_add_test(power, a_sender_without_power_leaves_the_line_at_1);
    tcase_add_test(power, who_joins_within_a_byte_waits_for_the_line_to_fall);
    tcase_add_test(power, a_break_is_one_lost_byte_and_then_silence);
    tcase_add_test(power, what_is_sent_during_a_break_is_not_received);
    tcase_add_test(power, any_number_of_short_breaks_is_survived);
    tcase_add_test(power, bytes_take_the_time_of_the_speed);
    suite_add_tcase(suite, power);
    TCase *uart = tcase_create("uart");
    tcase_set_timeout(uart, 60);
    tcase_add_loop_test(uart, whatever_is_sent_is_received_as_a_UART_receives_it, 0, 200);
    suite_add_tcase(suite, uart);
    return rig_run(suite, "./test_wire");
}
