/* SPDX-License-Identifier: MIT */
/* test_line_settings.c: the client's settings, and what is received between ends that do not agree (U7).
 * One test alone: CK_RUN_CASE=ear ./test_line_settings */
#include <asm/termbits.h>
#include <check.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <rkm04/unit.h>

#include "line/line_settings.h"

#define RECEIVED_MAX 2000

static const struct line_settings at_9600 = {9600, 8, 'N', 2}, at_19200 = {19200, 8, 'N', 2}, at_38400 = {38400, 8, 'N', 2};

/* What has been received since listen_to(). */
static struct line_received received[RECEIVED_MAX];
static size_t count;
static struct line_receiver receiver;

/* ---- The client's settings ------------------------------------------------------------------------------------------ */

/* A pty whose slave has been set up like this. Returns the master. */
static int pty_with(unsigned baud, unsigned flags, int *slave)
{
    struct termios2 settings;
    int master = posix_openpt(O_RDWR | O_NOCTTY);
    ck_assert_int_ge(master, 0);
    ck_assert_int_eq(grantpt(master) | unlockpt(master), 0);
    *slave = open(ptsname(master), O_RDWR | O_NOCTTY);
    ck_assert_int_ge(*slave, 0);
    ck_assert_int_eq(ioctl(*slave, TCGETS2, &settings), 0);
    settings.c_cflag = BOTHER | CREAD | flags;
    settings.c_ispeed = settings.c_ospeed = baud;
    ck_assert_int_eq(ioctl(*slave, TCSETS2, &settings), 0);
    return master;
}

static void assert_read(unsigned baud, unsigned flags, const char *expected)
{
    struct line_settings settings;
    char text[LINE_SETTINGS_TEXT_MAX];
    int slave, master = pty_with(baud, flags, &slave);
    ck_assert(line_settings_read(master, &settings));
    ck_assert_str_eq(line_settings_text(settings, text), expected);
    close(slave);
    close(master);
}

START_TEST(a_pty_tells_speed_and_stop_bits_of_its_client)
{
    assert_read(19200, CS8, "19200 8N1");
    assert_read(9600, CS8, "9600 8N1");
    assert_read(115200, CS8 | CSTOPB, "115200 8N2");
    assert_read(31250, CS8, "31250 8N1");
}
END_TEST

START_TEST(what_is_no_terminal_has_no_settings)
{
    struct line_settings settings;
    int fds[2];
    ck_assert_int_eq(pipe(fds), 0);
    ck_assert(!line_settings_read(fds[0], &settings));
    ck_assert(!line_settings_read(-1, &settings));
    close(fds[0]);
    close(fds[1]);
}
END_TEST

START_TEST(settings_are_written_as_everybody_writes_them)
{
    char text[LINE_SETTINGS_TEXT_MAX];
    ck_assert_str_eq(line_settings_text(line_settings_of(9600, 7, 'E', 1), text), "9600 7E1");
    ck_assert_str_eq(line_settings_text(line_settings_of(300, 5, 'O', 3), text), "300 5O1.5");
    ck_assert_str_eq(line_settings_text(line_settings_of(UINT32_MAX, 8, 'M', 2), text), "4294967295 8M2");
    ck_assert(line_settings_equal(line_settings_of(19200, 8, 'N', 1), line_settings_unit));
}
END_TEST

START_TEST(U7_a_difference_is_told_once_and_again_when_it_changes)
{
    struct line_settings known = line_settings_unit;
    char change[LINE_SETTINGS_CHANGE_MAX];
    ck_assert(!line_settings_changed(&known, at_19200, line_settings_unit, change));
    ck_assert(line_settings_changed(&known, at_9600, line_settings_unit, change));
    ck_assert_str_eq(change, "client is 9600 8N1, unit is 19200 8N1");
    ck_assert(!line_settings_changed(&known, at_9600, line_settings_unit, change));
    ck_assert(line_settings_changed(&known, line_settings_of(9600, 7, 'E', 3), line_settings_unit, change));
    ck_assert_str_eq(change, "client is 9600 7E1.5, unit is 19200 8N1");
    ck_assert(line_settings_changed(&known, at_19200, line_settings_unit, change));
    ck_assert_str_eq(change, "client is 19200 8N1, as the unit is");
    ck_assert(!line_settings_changed(&known, at_19200, line_settings_unit, change));
}
END_TEST

/* ---- What is received ------------------------------------------------------------------------------------------------------ */

static void say(uint8_t byte, uint64_t tick)
{
    ck_assert_uint_le(count + LINE_RECEIVER_MAX, RECEIVED_MAX);
    count += line_receiver_byte(&receiver, byte, tick, received + count);
}

static void listen_to(struct line_settings from, struct line_settings to, bool keeps_bad)
{
    line_receiver_begin(&receiver, from, to, keeps_bad);
    count = 0;
}

/* Bytes without gaps at tick 0, then silence. */
static void hear_all(struct line_settings from, struct line_settings to, bool keeps_bad, const uint8_t *bytes, size_t length)
{
    listen_to(from, to, keeps_bad);
    for (size_t i = 0; i < length; i++)
        say(bytes[i], 0);
    count += line_receiver_silence(&receiver, received + count);
}

/* One byte alone; `expected` is what is received. */
static void assert_heard(struct line_settings from, struct line_settings to, uint8_t byte, size_t length, const char *expected,
                         unsigned framing_errors)
{
    hear_all(from, to, false, &byte, 1);
    ck_assert_msg(count == length, "of %02X %zu bytes are heard, not %zu", byte, count, length);
    for (size_t i = 0; i < length; i++)
        ck_assert_uint_eq(received[i].byte, (uint8_t)expected[i]);
    ck_assert_uint_eq(receiver.framing_errors, framing_errors);
}

START_TEST(U7_equal_ends_receive_what_is_sent)
{
    static const uint32_t speeds[] = {50, 9600, 19200, 31250, 115200};
    static const char parities[] = "NEOMS";
    uint8_t bytes[256];
    for (unsigned i = 0; i < 256; i++)
        bytes[i] = (uint8_t)i;
    for (size_t i = 0; i < sizeof speeds / sizeof speeds[0]; i++)
        for (const char *parity = parities; *parity; parity++)
            for (unsigned data_bits = 5; data_bits <= 8; data_bits++) {
                struct line_settings both = line_settings_of(speeds[i], data_bits, *parity, 1 + data_bits % 3);
                hear_all(both, both, false, bytes, 256);
                ck_assert_uint_eq(count, 256);
                for (unsigned j = 0; j < 256; j++)
                    ck_assert_uint_eq(received[j].byte, j & ((1u << data_bits) - 1));
                ck_assert_uint_eq(receiver.framing_errors, 0);
            }
}
END_TEST

START_TEST(a_byte_begins_when_it_is_said_or_when_the_line_is_free)
{
    listen_to(at_19200, at_19200, false);
    say('a', 1000000);
    say('b', 1000000);
    say('c', 3000000000000);
    count += line_receiver_silence(&receiver, received + count);
    ck_assert_uint_eq(count, 3);
    ck_assert_uint_eq(received[0].tick, 1000000);
    ck_assert_uint_eq(received[1].tick, 1000520); /* 520 5/6 us a byte */
    ck_assert_uint_eq(received[2].tick, 3000000000000);
}
END_TEST

START_TEST(silence_takes_no_time_from_what_follows)
{
    listen_to(at_9600, at_19200, false);
    for (unsigned i = 0; i < 2; i++) {
        say('A', 0);
        ck_assert_uint_eq(count, i); /* what begins with its last bit is under way still */
        count += line_receiver_silence(&receiver, received + count);
        ck_assert_uint_eq(count, i + 1);
    }
    ck_assert_uint_eq(received[0].tick, 833);  /* eight bits at 9600 baud */
    ck_assert_uint_eq(received[1].tick, 1875); /* ten more */
}
END_TEST

/* Each bit is sampled twice; the first sample is lost in the long start bit: 0 b0 b0 b1 b1 b2 b2 b3, b3 is taken as stop bit. */
START_TEST(U7_a_client_at_half_the_speed_is_received_as_garbage)
{
    assert_heard(at_9600, at_19200, 0x00, 0, "", 1);
    assert_heard(at_9600, at_19200, 0xFF, 1, "\xFE", 0);
    assert_heard(at_9600, at_19200, 'A', 1, "\xFE", 1);
    assert_heard(at_9600, at_19200, 0x08, 2, "\x80\x80", 0);
    assert_heard(at_9600, at_19200, 0x7E, 2, "\xF8\xFE", 0);
}
END_TEST

/* Every other bit is seen: the start bit is b0, then come b2, b4, b6 and the stop bit. */
START_TEST(U7_a_client_at_twice_the_speed_is_received_as_garbage_or_not_at_all)
{
    assert_heard(at_38400, at_19200, 0x00, 1, "\xF8", 0);
    assert_heard(at_38400, at_19200, 0x54, 1, "\xFF", 0);
    assert_heard(at_38400, at_19200, 0x10, 1, "\xFA", 0);
    assert_heard(at_38400, at_19200, 0xFF, 0, "", 0);
}
END_TEST

START_TEST(U7_far_from_the_speed_there_is_silence)
{
    const struct line_settings slow = {600, 8, 'N', 2}, fast = {UINT32_MAX, 8, 'N', 2};
    assert_heard(slow, at_19200, 0x55, 0, "", 5);
    assert_heard(fast, at_19200, 0x55, 0, "", 0);
    assert_heard(at_19200, fast, 0x55, 0, "", 5);
}
END_TEST

START_TEST(a_line_that_is_hung_up_sends_and_receives_nothing)
{
    const struct line_settings hung_up = {0, 8, 'N', 2};
    assert_heard(hung_up, at_19200, 'A', 0, "", 0);
    assert_heard(at_19200, hung_up, 'A', 0, "", 0);
}
END_TEST

START_TEST(U7_parity_of_the_client_is_taken_as_the_top_bit_or_the_stop_bit)
{
    assert_heard(line_settings_of(19200, 7, 'E', 1), at_19200, 'A', 1, "A", 0);
    assert_heard(line_settings_of(19200, 7, 'E', 1), at_19200, 'C', 1, "\xC3", 0);
    assert_heard(line_settings_of(19200, 7, 'O', 1), at_19200, 'A', 1, "\xC1", 0);
    assert_heard(line_settings_of(19200, 8, 'E', 1), at_19200, 'A', 0, "", 1);
    assert_heard(line_settings_of(19200, 8, 'E', 1), at_19200, 'C', 1, "C", 0);
    assert_heard(line_settings_of(19200, 8, 'N', 2), at_19200, 'A', 1, "A", 0);
}
END_TEST

START_TEST(a_client_on_Linux_receives_characters_with_a_wrong_stop_bit_too)
{
    const uint8_t zero = 0x00;
    hear_all(at_19200, line_settings_of(38400, 8, 'N', 1), true, &zero, 1);
    ck_assert_uint_eq(count, 1);
    ck_assert_uint_eq(received[0].byte, 0x00);
    ck_assert_uint_eq(receiver.framing_errors, 1);
}
END_TEST

START_TEST(only_the_ratio_of_the_speeds_matters)
{
    static struct line_received slow[RECEIVED_MAX];
    for (unsigned i = 0; i < 65536; i += 13) {
        const uint8_t bytes[] = {(uint8_t)i, (uint8_t)(i >> 8)};
        hear_all(at_9600, at_19200, false, bytes, 2);
        size_t heard_slow = count;
        memcpy(slow, received, sizeof received[0] * count);
        hear_all(at_19200, at_38400, false, bytes, 2);
        ck_assert_uint_eq(count, heard_slow);
        for (size_t j = 0; j < count; j++)
            ck_assert_uint_eq(received[j].byte, slow[j].byte);
    }
}
END_TEST

/* ---- A second opinion: the levels as a row, and a receiver that looks at it from outside ---------------------------------- */

struct row {
    const struct line_settings *from, *to;
    const uint8_t *bytes;
    size_t length;
};

/* Level of the row at a time in units of 1 / (2 from.baud to.baud) s. */
static bool level_at(const struct row *row, uint64_t time)
{
    const uint64_t half = time / row->to->baud, halves = 2u + 2u * 8 + row->from->stop_halves; /* 8 data bits, no parity */
    uint64_t byte = half / halves, within = half % halves / 2;
    if (byte >= row->length || within > 8)
        return true;
    return within > 0 && (row->bytes[byte] >> (within - 1) & 1);
}

static size_t reference(const struct row *row, uint8_t *out)
{
    const uint64_t half = row->from->baud, end = (uint64_t)row->to->baud * 22 * (row->length + 1);
    size_t found = 0;
    for (uint64_t time = 0; time < end;) {
        unsigned bits = 0;
        if (level_at(row, time)) {
            time = (time / row->to->baud + 1) * row->to->baud; /* levels change on the sender's half bits only */
            continue;
        }
        if (level_at(row, time + half)) {
            time += half;
            continue;
        }
        for (unsigned bit = 0; bit < 8; bit++)
            bits |= (unsigned)level_at(row, time + half * (2 * bit + 3)) << bit;
        time += half * 19;
        if (level_at(row, time))
            out[found++] = (uint8_t)bits;
        while (!level_at(row, time))
            time = (time / row->to->baud + 1) * row->to->baud;
    }
    return found;
}

START_TEST(any_bytes_at_any_two_speeds_are_received_as_a_second_receiver_receives_them)
{
    static const uint32_t speeds[] = {300, 1200, 4800, 9600, 14400, 18000, 18700, 19200, 19700, 20400, 31250, 38400, 57600,
                                      115200};
    const size_t number = sizeof speeds / sizeof speeds[0];
    srand(7);
    for (unsigned round = 0; round < 2000; round++) {
        uint8_t bytes[20], expected[RECEIVED_MAX];
        const struct line_settings from = {speeds[(size_t)rand() % number], 8, 'N', (uint8_t)(2 + rand() % 3)};
        const struct line_settings to = {speeds[(size_t)rand() % number], 8, 'N', 2};
        const size_t length = 1 + (size_t)rand() % sizeof bytes;
        for (size_t i = 0; i < length; i++)
            bytes[i] = (uint8_t)rand();
        hear_all(from, to, false, bytes, length);
        size_t found = reference(&(struct row){&from, &to, bytes, length}, expected);
        ck_assert_msg(found == count, "%u -> %u: %zu bytes heard, not %zu", from.baud, to.baud, count, found);
        for (size_t i = 0; i < found; i++)
            ck_assert_uint_eq(received[i].byte, expected[i]);
    }
}
END_TEST

START_TEST(U7_two_per_cent_off_the_speed_does_no_harm)
{
    const struct line_settings off[] = {{18816, 8, 'N', 2}, {19584, 8, 'N', 2}};
    uint8_t bytes[256];
    for (unsigned i = 0; i < 256; i++)
        bytes[i] = (uint8_t)i;
    for (size_t i = 0; i < 2; i++) {
        hear_all(off[i], at_19200, false, bytes, 256);
        ck_assert_uint_eq(count, 256);
        for (unsigned j = 0; j < 256; j++)
            ck_assert_uint_eq(received[j].byte, j);
    }
}
END_TEST

/* Requests that a unit takes out of a well-framed one, received at the unit's speed. */
static unsigned requests_taken(struct line_settings client)
{
    static struct rkm04_unit unit;
    static const struct rkm04_port nothing;
    const struct rkm04_config config = {.node = 1};
    struct rkm04_sender sender = {0};
    uint8_t frame[32];
    size_t length = rkm04_hdlc.begin(&sender, 1, 0, 3, false, frame);
    length += rkm04_hdlc.put(&sender, 2, frame + length);
    length += rkm04_hdlc.put(&sender, '1', frame + length);
    length += rkm04_hdlc.put(&sender, 'D', frame + length);
    length += rkm04_hdlc.end(&sender, frame + length);
    hear_all(client, line_settings_unit, false, frame, length);
    rkm04_init(&unit, &config, &nothing, NULL);
    for (size_t i = 0; i < count; i++)
        ck_assert_uint_eq(rkm04_receive(&unit, &received[i].byte, 1), 1);
    return rkm04_counters(&unit).requests;
}

START_TEST(U7_a_unit_obeys_a_client_of_its_own_speed_only)
{
    static const uint32_t others[] = {1200, 4800, 9600, 38400, 57600, 115200};
    ck_assert_uint_eq(requests_taken(at_19200), 1);
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        ck_assert_uint_eq(requests_taken(line_settings_of(others[i], 8, 'N', 1)), 0);
    ck_assert_uint_eq(requests_taken(line_settings_of(19200, 7, 'E', 1)), 0);
    ck_assert_uint_eq(requests_taken(line_settings_of(19200, 8, 'N', 2)), 1);
}
END_TEST

static Suite *line_settings_suite(void)
{
    Suite *suite = suite_create("line_settings");
    TCase *settings = tcase_create("settings"), *hearing = tcase_create("ear");
    tcase_add_test(settings, a_pty_tells_speed_and_stop_bits_of_its_client);
    tcase_add_test(settings, what_is_no_terminal_has_no_settings);
    tcase_add_test(settings, settings_are_written_as_everybody_writes_them);
    tcase_add_test(settings, U7_a_difference_is_told_once_and_again_when_it_changes);
    suite_add_tcase(suite, settings);
    tcase_add_test(hearing, U7_equal_ends_receive_what_is_sent);
    tcase_add_test(hearing, a_byte_begins_when_it_is_said_or_when_the_line_is_free);
    tcase_add_test(hearing, silence_takes_no_time_from_what_follows);
    tcase_add_test(hearing, U7_a_client_at_half_the_speed_is_received_as_garbage);
    tcase_add_test(hearing, U7_a_client_at_twice_the_speed_is_received_as_garbage_or_not_at_all);
    tcase_add_test(hearing, U7_far_from_the_speed_there_is_silence);
    tcase_add_test(hearing, a_line_that_is_hung_up_sends_and_receives_nothing);
    tcase_add_test(hearing, U7_parity_of_the_client_is_taken_as_the_top_bit_or_the_stop_bit);
    tcase_add_test(hearing, a_client_on_Linux_receives_characters_with_a_wrong_stop_bit_too);
    tcase_add_test(hearing, only_the_ratio_of_the_speeds_matters);
    tcase_add_test(hearing, any_bytes_at_any_two_speeds_are_received_as_a_second_receiver_receives_them);
    tcase_add_test(hearing, U7_two_per_cent_off_the_speed_does_no_harm);
    tcase_add_test(hearing, U7_a_unit_obeys_a_client_of_its_own_speed_only);
    tcase_set_timeout(hearing, 60);
    suite_add_tcase(suite, hearing);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(line_settings_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
