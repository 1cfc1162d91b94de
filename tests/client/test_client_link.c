/* SPDX-License-Identifier: MIT */
/* test_client_link.c: rkmctl and an answer while the machine is busy. What runs between two polls moves the clock and sends bytes
 * (--wrap=client_now).
 * One case alone: CK_RUN_CASE=busy ./test_client_link */
#include <check.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "client/client_link.h"
#include "client/client_port.h"

#define MS UINT64_C(1000)

static const uint8_t position[] = {4, '1'};
static const uint8_t answer[] = {4, '1', '\n', ' ', ' ', ' ', ' ', ' ', ' ', ' ', ' ', ' ', '7'};

static struct client client;
static uint8_t bytes[64]; /* of the answer's frame, of which the unit has sent the first `sent` */
static size_t length, sent;
static int unit; /* its end of the line */
static uint64_t now;
static size_t piece;   /* bytes that come between two looks of the client */
static uint64_t gap; /* us between these */

uint64_t __wrap_client_now(void);

uint64_t __wrap_client_now(void)
{
    return now;
}

static void between(void *context, size_t gone)
{
    (void)context, (void)gone;
    size_t count = length - sent < piece ? length - sent : piece;
    ck_assert_int_eq(write(unit, bytes + sent, count), (ssize_t)count);
    sent += count;
    now += gap;
}

/* The answer in this framing, in pieces with pauses between them. */
static enum client_outcome ask(const struct rkm04_framing *framing, size_t piece_length, uint64_t gap_us)
{
    int ends[2];
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends), 0);
    client = (struct client){
        .fd = ends[0], .port = "unit", .framing = framing, .node = 1, .timeout_ms = 1000, .progress = between};
    unit = ends[1];
    piece = piece_length;
    gap = gap_us;
    struct rkm04_sender sender;
    length = framing->begin(&sender, 0, 1, sizeof answer, true, bytes);
    for (size_t i = 0; i < sizeof answer; i++)
        length += framing->put(&sender, answer[i], bytes + length);
    length += framing->end(&sender, bytes + length);
    sent = 0;
    enum client_outcome outcome = client_exchange(&client, position, sizeof position);
    close(ends[0]);
    close(ends[1]);
    return outcome;
}

static void assert_answered(const struct rkm04_framing *framing, size_t piece_length, uint64_t gap_us)
{
    ck_assert_int_eq(ask(framing, piece_length, gap_us), CLIENT_ANSWERED);
    ck_assert_mem_eq(client.answer, answer, sizeof answer);
    ck_assert_uint_eq(client.length, sizeof answer);
}

START_TEST(an_answer_that_is_there_counts_though_its_time_is_over)
{
    assert_answered(&rkm04_hdlc, sizeof bytes, 3600000 * MS);
    assert_answered(&rkm04_plain, sizeof bytes, 3600000 * MS);
}
END_TEST

START_TEST(a_pause_within_an_answer_does_not_spoil_it)
{
    assert_answered(&rkm04_hdlc, 9, 300 * MS);
    assert_answered(&rkm04_plain, 9, 300 * MS);
    assert_answered(&rkm04_plain, 5, 900 * MS);
}
END_TEST

START_TEST(an_answer_of_which_a_part_is_missing_is_none)
{
    length = 0;
    ck_assert_int_eq(ask(&rkm04_plain, 0, 300 * MS), CLIENT_SILENT);
}
END_TEST

static Suite *client_link_suite(void)
{
    Suite *suite = suite_create("client_link");
    TCase *busy = tcase_create("busy");
    tcase_set_timeout(busy, 60);
    tcase_add_test(busy, an_answer_that_is_there_counts_though_its_time_is_over);
    tcase_add_test(busy, a_pause_within_an_answer_does_not_spoil_it);
    tcase_add_test(busy, an_answer_of_which_a_part_is_missing_is_none);
    suite_add_tcase(suite, busy);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(client_link_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=busy ./test_client_link\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
