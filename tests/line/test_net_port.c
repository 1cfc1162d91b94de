/* SPDX-License-Identifier: MIT */
/* test_net_port.c: a line over TCP, with real sockets on the loopback. One test alone: CK_RUN_CASE=clients ./test_net_port */
#include <arpa/inet.h>
#include <check.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "net_rig.h"

/* ---- Addresses ------------------------------------------------------------------------------------------------------ */

START_TEST(an_address_is_host_and_port)
{
    static const char *const good[] = {"0", "65535", ":4000", "localhost:1", "10.0.0.1:0", "[::1]:0", "a-b.example:80", "00080"};
    static const char *const bad[] = {"", ":", "localhost", "localhost:", "65536", "-1", "1x", "::1", "::1:80", "[::1]", "1:2:3",
                                      " 1", "99999", "[]:1", "123456"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        ck_assert_msg(net_address_valid(good[i]), "%s", good[i]);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        ck_assert_msg(!net_address_valid(bad[i]), "%s", bad[i]);
}
END_TEST

START_TEST(an_address_too_long_is_refused)
{
    char text[1000];
    memset(text, 'a', sizeof text);
    strcpy(text + sizeof text - 5, ":123");
    ck_assert(!net_address_valid(text));
}
END_TEST

START_TEST(without_a_host_only_this_machine_gets_in)
{
    open_line(NET_RAW, "0");
    ck_assert_int_eq(strncmp(line.port.address, "127.0.0.1:", 10), 0);
    ck_assert_int_gt(atoi(line.port.address + 10), 0);
    close_line();
}
END_TEST

START_TEST(an_address_in_use_is_reported)
{
    struct net_port second = {0};
    open_line(NET_RAW, "127.0.0.1:0");
    ck_assert(!net_port_open(&second, &line.loop, line.port.address, NET_RAW, &net_rig_calls, &line));
    close_line();
}
END_TEST

/* ---- Clients -------------------------------------------------------------------------------------------------------- */

START_TEST(bytes_pass_both_ways_as_they_are)
{
    open_line(NET_RAW, "0");
    int fd = attach_client();
    send_all(fd, "\x7e\xff\xff\xff\x0d", 5);
    is_heard("\x7e\xff\xff\xff\x0d");
    ck_assert_uint_eq(net_port_send(&line.port, (const uint8_t *)"\xff\xf0\n\0", 4), 0);
    GETS(fd, "\xff\xf0\n\0");
    close(fd);
    AWAIT(!line.port.attached);
    ck_assert_str_eq(line.story, "attached detached ");
    close_line();
}
END_TEST

START_TEST(bytes_for_nobody_are_dropped_and_counted)
{
    open_line(NET_RAW, "0");
    ck_assert_uint_eq(net_port_send(&line.port, (const uint8_t *)"abc", 3), 3);
    ck_assert_uint_eq(line.port.dropped, 3);
    int fd = attach_client();
    net_port_send(&line.port, (const uint8_t *)"new", 3);
    GETS(fd, "new");
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_second_client_is_told_why_and_sent_away)
{
    char text[200] = "";
    open_line(_i ? NET_RFC2217 : NET_RAW, "0");
    int first = attach_client(), second = connect_client();
    send_all(second, "\x01\x02\x03", 3); /* must not get to the units, nor destroy the text */
    ck_assert_uint_gt(receive(second, text, sizeof text - 1), 0);
    ck_assert(strstr(text, "refused: the bus is in use by 127.0.0.1:") && strchr(text, '\n'));
    close(second);
    send_all(first, "x", 1);
    is_heard("x");
    ck_assert_str_eq(line.story, "attached refused ");
    close(first);
    close_line();
}
END_TEST

START_TEST(a_client_is_refused_while_somebody_else_has_the_line)
{
    char text[200] = "";
    open_line(NET_RAW, "0");
    line.owner = "the pty";
    int fd = connect_client();
    receive(fd, text, sizeof text - 1);
    ck_assert_str_eq(text, "rkm04: refused: the bus is in use by the pty\r\n");
    close(fd);
    line.owner = NULL;
    fd = attach_client();
    close(fd);
    close_line();
}
END_TEST

START_TEST(many_at_once_are_all_sent_away)
{
    enum { CROWD = 3 * NET_CONNECTIONS };
    int crowd[CROWD];
    char text[200];
    open_line(NET_RAW, "0");
    int first = attach_client();
    for (size_t i = 0; i < CROWD; i++)
        crowd[i] = connect_client();
    for (size_t i = 0; i < CROWD; i++) {
        ck_assert_uint_gt(receive(crowd[i], text, sizeof text), 0);
        close(crowd[i]);
    }
    send_all(first, "x", 1);
    is_heard("x");
    close(first);
    close_line();
}
END_TEST

START_TEST(a_client_that_only_stops_sending_gets_its_answer)
{
    open_line(NET_RAW, "0");
    int fd = attach_client();
    send_all(fd, "ask", 3);
    shutdown(fd, SHUT_WR);
    AWAIT(net_port_client(&line.port) == NULL);
    is_heard("ask");
    net_port_send(&line.port, (const uint8_t *)"answer", 6);
    GETS(fd, "answer");
    AWAIT(!line.port.attached);
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_client_that_stops_sending_gives_way_to_the_next)
{
    open_line(NET_RAW, "0");
    int first = attach_client();
    shutdown(first, SHUT_WR);
    AWAIT(net_port_client(&line.port) == NULL);
    line.story[0] = '\0';
    int second = connect_client();
    AWAIT(net_port_client(&line.port) != NULL);
    ck_assert_str_eq(line.story, "detached attached ");
    net_port_send(&line.port, (const uint8_t *)"to you", 6);
    GETS(second, "to you");
    close(first);
    close(second);
    close_line();
}
END_TEST

/* Each way with room for a part of what waits, for all of it, and for more. */
static const size_t rooms[] = {977, NET_TO_LINE, NET_TO_LINE + NET_IN + 1, 20000};
#define ROOMS (int)(sizeof rooms / sizeof *rooms)

START_TEST(bytes_wait_for_room_and_none_is_lost)
{
    uint8_t bytes[40000];
    size_t sent = 0, room = rooms[_i / 2];
    open_line(_i % 2 ? NET_RFC2217 : NET_RAW, "0");
    line.room = 0;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)(i % 251);
    int fd = attach_client();
    while (line.heard_count < sizeof bytes) {
        size_t wanted = line.heard_count + room < sizeof bytes ? line.heard_count + room : sizeof bytes;
        ssize_t n = sent < sizeof bytes ? send(fd, bytes + sent, sizeof bytes - sent, MSG_NOSIGNAL) : 0;
        sent += n > 0 ? (size_t)n : 0;
        line.room = wanted - line.heard_count;
        net_port_wake(&line.port);
        AWAIT(line.heard_count == wanted);
    }
    ck_assert_mem_eq(line.heard, bytes, sizeof bytes);
    close(fd);
    close_line();
}
END_TEST

START_TEST(what_a_client_has_written_reaches_the_units_after_it_has_gone)
{
    open_line(NET_RAW, "0");
    line.room = 0;
    int fd = attach_client();
    send_all(fd, "first", 5);
    close(fd);
    AWAIT(net_port_client(&line.port) == NULL);
    fd = connect_client();
    send_all(fd, "second", 6);
    AWAIT(net_port_client(&line.port) != NULL);
    line.room = HEARD_MAX;
    net_port_wake(&line.port);
    is_heard("firstsecond");
    close(fd);
    close_line();
}
END_TEST

/* ---- Clients that have gone */

START_TEST(a_client_that_has_sent_much_and_gone_gives_way_at_once)
{
    uint8_t much[60000];
    memset(much, _i ? 0xff : 'm', sizeof much); /* FF FF is one byte of data with RFC 2217 */
    open_line(_i ? NET_RFC2217 : NET_RAW, "0");
    line.room = 100; /* and no more: the units are slow */
    int first = _i ? attach_rfc2217() : attach_client();
    send_all(first, much, sizeof much);
    close(first);
    line.story[0] = '\0';
    int second = connect_client();
    AWAIT(strstr(line.story, "attached") || strstr(line.story, "refused"));
    ck_assert_str_eq(line.story, "detached attached ");
    size_t data = _i ? sizeof much / 2 : sizeof much;
    size_t taken = 100 + line.port.to_line_count;
    ck_assert_uint_le(taken, 100 + NET_TO_LINE);
    ck_assert_uint_gt(line.port.unread, 0);
    if (_i == 0)
        ck_assert_uint_eq(taken + line.port.unread, data);
    close(second);
    close_line();
}
END_TEST

START_TEST(a_client_that_comes_again_at_once_is_not_refused_by_itself)
{
    open_line(_i ? NET_RFC2217 : NET_RAW, "0");
    for (unsigned i = 0; i < 100; i++) {
        int fd = _i ? attach_rfc2217() : attach_client();
        for (unsigned turns = 0; turns < 3; turns++)
            uv_run(&line.loop, UV_RUN_NOWAIT); /* it is being listened to */
        send_all(fd, "to all", 6);
        close(fd);
    }
    close(attach_client());
    ck_assert(!strstr(line.story, "refused"));
    AWAIT(line.heard_count == 600);
    for (size_t i = 0; i < 600; i++)
        ck_assert_int_eq(line.heard[i], "to all"[i % 6]);
    close_line();
}
END_TEST

START_TEST(a_client_that_was_torn_away_after_much_gives_way_at_once)
{
    struct linger now = {.l_onoff = 1, .l_linger = 0};
    uint8_t much[20000] = {0};
    open_line(NET_RAW, "0");
    line.room = 0;
    int fd = attach_client();
    send_all(fd, much, sizeof much);
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close(fd);
    line.story[0] = '\0';
    fd = connect_client();
    AWAIT(strstr(line.story, "attached") || strstr(line.story, "refused"));
    ck_assert_str_eq(line.story, "detached attached ");
    close(fd);
    close_line();
}
END_TEST

static size_t count_refused(void)
{
    size_t count = 0;
    for (const char *at = line.story; (at = strstr(at, "refused")) != NULL; at++)
        count++;
    return count;
}

/* Each of them would be waited for, a second long. */
START_TEST(a_crowd_that_is_sent_away_and_stays_delays_nobody)
{
    enum { CROWD = 12 * NET_CONNECTIONS };
    int crowd[CROWD];
    open_line(NET_RAW, "0");
    line.owner = "the pty";
    uint64_t begun = now_ms();
    for (size_t i = 0; i < CROWD; i++)
        crowd[i] = connect_client();
    AWAIT(count_refused() == CROWD);
    line.owner = NULL;
    int fd = attach_client();
    send_all(fd, "x", 1);
    is_heard("x");
    ck_assert_uint_lt(now_ms() - begun, 8000);
    for (size_t i = 0; i < CROWD; i++)
        close(crowd[i]);
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_client_that_does_not_read_loses_bytes_which_are_counted)
{
    uint8_t bytes[8192];
    uint64_t sent = 0, got = 0;
    char sink[65536];
    memset(bytes, 'a', sizeof bytes);
    open_line(_i ? NET_RFC2217 : NET_RAW, "0");
    int fd = _i ? attach_rfc2217() : attach_client();
    while (line.port.dropped == 0) {
        net_port_send(&line.port, bytes, sizeof bytes);
        sent += sizeof bytes;
        uv_run(&line.loop, UV_RUN_NOWAIT);
        if (sent > 1u << 30)
            ck_abort_msg("nothing is dropped");
    }
    while (got < sent - line.port.dropped) {
        size_t rest = sent - line.port.dropped - got;
        got += receive(fd, sink, rest < sizeof sink ? rest : sizeof sink);
    }
    net_port_send(&line.port, (const uint8_t *)"end", 3);
    GETS(fd, "end");
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_client_that_is_torn_away_leaves_the_line_to_the_next)
{
    struct linger now = {.l_onoff = 1, .l_linger = 0};
    open_line(_i ? NET_RFC2217 : NET_RAW, "0");
    int fd = attach_client();
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close(fd); /* a reset */
    AWAIT(!line.port.attached);
    net_port_send(&line.port, (const uint8_t *)"abc", 3);
    close(attach_client());
    close_line();
}
END_TEST

START_TEST(closing_the_line_lets_go_of_everybody)
{
    char text[200];
    open_line(NET_RAW, "0");
    int first = attach_client(), second = connect_client();
    AWAIT(strstr(line.story, "refused"));
    close_line();
    ck_assert_uint_eq(receive(first, text, sizeof text), 0);
    close(first);
    close(second);
}
END_TEST

/* ---- RFC 2217 ------------------------------------------------------------------------------------------------------- */

/* A dialogue whose requests come in two parts, the first of `cut` bytes; 0: byte by byte. */
static void dialogue_in_parts(size_t cut, const char *from, size_t length, const char *to, size_t to_length)
{
    open_line(NET_RFC2217, "0");
    int fd = attach_rfc2217();
    for (size_t at = 0; at < length;) {
        size_t part = cut == 0 ? 1 : at < cut ? cut - at : length - at;
        send_all(fd, from + at, part);
        at += part;
        for (unsigned i = 0; i < 3; i++)
            uv_run(&line.loop, UV_RUN_NOWAIT);
    }
    gets_bytes(fd, to, to_length);
    is_heard("a\xff" "bcd");
    ck_assert_str_eq(line.story, "attached 9600-8N1 9600-8E1 break unbreak rts purge ");
    net_port_send(&line.port, (const uint8_t *)"\xff!", 2);
    GETS(fd, "\xff\xff!");
    close(fd);
    close_line();
}

START_TEST(a_dialogue_is_the_same_however_it_is_cut)
{
    static const char from[] = "\xff\xfb\x2c\xff\xfa\x2c\x01\x00\x00\x25\x80\xff\xf0" "a\xff\xff"
                               "b\xff\xfa\x2c\x03\x03\xff\xf0\xff\xf3"
                               "c\xff\xfa\x2c\x05\x09\xff\xf0\xff\xfa\x2c\x0c\x02\xff\xf0" "d";
    static const char to[] = "\xff\xfa\x2c\x6b\xb0\xff\xf0\xff\xfa\x2c\x65\x00\x00\x25\x80\xff\xf0\xff\xfa\x2c\x67\x03\xff\xf0"
                             "\xff\xfa\x2c\x69\x09\xff\xf0\xff\xfa\x2c\x70\x02\xff\xf0";
    size_t length = sizeof from - 1;
    for (size_t cut = 0; cut < length; cut++)
        dialogue_in_parts(cut, from, length, to, sizeof to - 1);
}
END_TEST

START_TEST(commands_are_obeyed_while_data_wait)
{
    open_line(NET_RFC2217, "0");
    line.room = 1;
    int fd = attach_rfc2217();
    send_all(fd, "data\xff\xfa\x2c\x02\x07\xff\xf0", 11);
    GETS(fd, "\xff\xfa\x2c\x66\x07\xff\xf0");
    is_heard("d");
    send_all(fd, "\xff\xfa\x2c\x0c\x02\xff\xf0" "new", 10);
    GETS(fd, "\xff\xfa\x2c\x70\x02\xff\xf0");
    line.room = HEARD_MAX;
    net_port_wake(&line.port);
    is_heard("dnew");
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_client_that_has_suspended_gets_data_when_it_resumes)
{
    open_line(NET_RFC2217, "0");
    int fd = attach_rfc2217();
    send_all(fd, "\xff\xfa\x2c\x08\xff\xf0", 6);
    settle(fd);
    net_port_send(&line.port, (const uint8_t *)"later", 5);
    settle(fd); /* replies are not held */
    send_all(fd, "\xff\xfa\x2c\x09\xff\xf0", 6);
    GETS(fd, "later");
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_purge_forgets_what_waits_for_the_client)
{
    open_line(NET_RFC2217, "0");
    int fd = attach_rfc2217();
    send_all(fd, "\xff\xfa\x2c\x08\xff\xf0", 6);
    settle(fd);
    net_port_send(&line.port, (const uint8_t *)"stale", 5);
    send_all(fd, "\xff\xfa\x2c\x0c\x01\xff\xf0\xff\xfa\x2c\x09\xff\xf0", 13);
    GETS(fd, "\xff\xfa\x2c\x70\x01\xff\xf0");
    net_port_send(&line.port, (const uint8_t *)"fresh", 5);
    GETS(fd, "fresh");
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_break_ends_and_settings_are_fresh_when_the_client_has_gone)
{
    open_line(NET_RFC2217, "0");
    int fd = attach_rfc2217();
    send_all(fd, "\xff\xfa\x2c\x05\x05\xff\xf0\xff\xfa\x2c\x02\x07\xff\xf0\xff\xfa\x2c\x08\xff\xf0", 20);
    AWAIT(line.port.rfc2217.suspended);
    close(fd);
    AWAIT(!line.port.attached);
    ck_assert_str_eq(line.story, "attached break 19200-7N1 unbreak detached ");
    fd = attach_rfc2217();
    send_all(fd, "\xff\xfa\x2c\x02\x00\xff\xf0", 7);
    GETS(fd, "\xff\xfa\x2c\x66\x08\xff\xf0");
    net_port_send(&line.port, (const uint8_t *)"x", 1);
    GETS(fd, "x");
    close(fd);
    close_line();
}
END_TEST

START_TEST(a_client_that_asks_and_never_reads_loses_no_reply)
{
    enum { TIMES = 100000 };
    static const char ask[] = "\xff\xfa\x2c\x00\xff\xf0", reply[] = "\xff\xfa\x2c\x64rkm04\xff\xf0";
    size_t asked = 0;
    char got[sizeof reply - 1];
    open_line(NET_RFC2217, "0");
    int fd = attach_rfc2217();
    for (unsigned still = 0; asked < TIMES * (sizeof ask - 1) && still < 1000; still++) {
        ssize_t n = send(fd, ask + asked % (sizeof ask - 1), sizeof ask - 1 - asked % (sizeof ask - 1), MSG_NOSIGNAL);
        asked += n > 0 ? (size_t)n : 0;
        still = n > 0 ? 0 : still;
        uv_run(&line.loop, UV_RUN_NOWAIT);
    }
    for (size_t i = 0; i < asked / (sizeof ask - 1); i++) {
        if (receive(fd, got, sizeof got) != sizeof got || memcmp(got, reply, sizeof got) != 0)
            ck_abort_msg("reply %zu", i);
    }
    close(fd);
    close_line();
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("net_port");
    TCase *addresses = tcase_create("addresses"), *clients = tcase_create("clients"), *rfc2217 = tcase_create("rfc2217");
    tcase_add_test(addresses, an_address_is_host_and_port);
    tcase_add_test(addresses, an_address_too_long_is_refused);
    tcase_add_test(addresses, without_a_host_only_this_machine_gets_in);
    tcase_add_test(addresses, an_address_in_use_is_reported);
    suite_add_tcase(suite, addresses);
    tcase_add_test(clients, bytes_pass_both_ways_as_they_are);
    tcase_add_test(clients, bytes_for_nobody_are_dropped_and_counted);
    tcase_add_loop_test(clients, a_second_client_is_told_why_and_sent_away, 0, 2);
    tcase_add_test(clients, a_client_is_refused_while_somebody_else_has_the_line);
    tcase_add_test(clients, many_at_once_are_all_sent_away);
    tcase_add_test(clients, a_client_that_only_stops_sending_gets_its_answer);
    tcase_add_test(clients, a_client_that_stops_sending_gives_way_to_the_next);
    tcase_add_loop_test(clients, bytes_wait_for_room_and_none_is_lost, 0, 2 * ROOMS);
    tcase_add_test(clients, what_a_client_has_written_reaches_the_units_after_it_has_gone);
    tcase_add_loop_test(clients, a_client_that_does_not_read_loses_bytes_which_are_counted, 0, 2);
    tcase_add_loop_test(clients, a_client_that_is_torn_away_leaves_the_line_to_the_next, 0, 2);
    tcase_add_loop_test(clients, a_client_that_has_sent_much_and_gone_gives_way_at_once, 0, 2);
    tcase_add_loop_test(clients, a_client_that_comes_again_at_once_is_not_refused_by_itself, 0, 2);
    tcase_add_test(clients, a_client_that_was_torn_away_after_much_gives_way_at_once);
    tcase_add_test(clients, a_crowd_that_is_sent_away_and_stays_delays_nobody);
    tcase_add_test(clients, closing_the_line_lets_go_of_everybody);
    suite_add_tcase(suite, clients);
    tcase_add_test(rfc2217, a_dialogue_is_the_same_however_it_is_cut);
    tcase_add_test(rfc2217, commands_are_obeyed_while_data_wait);
    tcase_add_test(rfc2217, a_client_that_has_suspended_gets_data_when_it_resumes);
    tcase_add_test(rfc2217, a_purge_forgets_what_waits_for_the_client);
    tcase_add_test(rfc2217, a_break_ends_and_settings_are_fresh_when_the_client_has_gone);
    tcase_add_test(rfc2217, a_client_that_asks_and_never_reads_loses_no_reply);
    suite_add_tcase(suite, rfc2217);
    tcase_set_timeout(clients, 60);
    tcase_set_timeout(rfc2217, 60);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=addresses|clients|rfc2217 ./test_net_port");
    return failed > 0;
}
