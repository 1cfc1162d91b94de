/* SPDX-License-Identifier: MIT */
/* test_service_port.c: a port for many clients, with real sockets on the loopback. Time passes in calls alone: each takes a
 * millisecond. One test alone: CK_RUN_CASE=turns ./test_service_port */
#include <arpa/inet.h>
#include <check.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "line/line.h"

#define CLIENTS 20u
#define CALL_NS 1000000u
#define LENGTH (64u * SERVICE_IN) /* what each client sends; it fits in its socket */

static uv_loop_t loop;
static struct service_port port;
static uint64_t now_ns;
static unsigned opened, calls, called[CLIENTS + 1u], closed;
static size_t taken, most_taken = SIZE_MAX; /* most_taken: at once */
static size_t answer;                  /* bytes of an answer to each call; 0: none */

uint64_t __wrap_uv_hrtime(void);

uint64_t __wrap_uv_hrtime(void)
{
    return now_ns;
}

static unsigned on_open(void *context, const char *peer)
{
    (void)context;
    (void)peer;
    return ++opened;
}

static size_t on_bytes(void *context, unsigned client, const uint8_t *bytes, size_t length)
{
    static const uint8_t answers[SERVICE_OUT_MAX];
    (void)context;
    ck_assert_uint_eq(bytes[0], answer > 0 ? (uint8_t)taken : 0);
    length = length < most_taken ? length : most_taken;
    calls++;
    called[client]++;
    taken += length;
    now_ns += CALL_NS;
    service_port_send(&port, client, answers, answer);
    return length;
}

static void on_closed(void *context, unsigned client, const char *why)
{
    (void)context;
    (void)client;
    (void)why;
    closed++;
}

static const struct service_port_calls port_calls = {.open = on_open, .bytes = on_bytes, .closed = on_closed};

static void turn_until_opened(unsigned count)
{
    while (opened < count)
        uv_run(&loop, UV_RUN_ONCE);
}

static int connect_client(void)
{
    struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    address.sin_port = htons((uint16_t)atoi(strrchr(port.address, ':') + 1));
    ck_assert_int_eq(connect(fd, (struct sockaddr *)&address, sizeof address), 0);
    turn_until_opened(opened + 1u);
    return fd;
}

static void flood(const int *fd, unsigned count)
{
    static const uint8_t bytes[LENGTH];
    for (unsigned i = 0; i < count; i++)
        ck_assert_int_eq(send(fd[i], bytes, sizeof bytes, MSG_DONTWAIT), (ssize_t)sizeof bytes);
}

static void begin(int *fd, unsigned count)
{
    uv_loop_init(&loop);
    ck_assert(service_port_open(&port, &loop, "127.0.0.1:0", NULL, &port_calls, NULL));
    for (unsigned i = 0; i < count; i++)
        fd[i] = connect_client();
}

static void end(const int *fd, unsigned count)
{
    service_port_close(&port);
    for (unsigned i = 0; i < count; i++)
        close(fd[i]);
    uv_run(&loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
}

START_TEST(a_turn_of_the_loop_ends_however_much_has_come)
{
    int fd[CLIENTS];
    begin(fd, CLIENTS);
    flood(fd, CLIENTS);
    for (size_t turns = 0; taken < (size_t)CLIENTS * LENGTH; turns++) {
        calls = 0;
        uv_run(&loop, UV_RUN_NOWAIT);
        ck_assert_uint_le(calls, SERVICE_STINT / CALL_NS);
        ck_assert_uint_lt(turns, (size_t)2 * CLIENTS * LENGTH / SERVICE_IN);
    }
    end(fd, CLIENTS);
}
END_TEST

START_TEST(each_client_is_read_in_its_turn)
{
    int fd[CLIENTS];
    begin(fd, CLIENTS);
    flood(fd, CLIENTS);
    while (taken < (size_t)CLIENTS * LENGTH / 2u) {
        unsigned least = UINT32_MAX, most = 0;
        uv_run(&loop, UV_RUN_NOWAIT);
        for (unsigned client = 1; client <= CLIENTS; client++) {
            least = called[client] < least ? called[client] : least;
            most = called[client] > most ? called[client] : most;
        }
        ck_assert_uint_le(most, least + 1u);
    }
    end(fd, CLIENTS);
}
END_TEST

/* One that sends nothing delays no other, and a loop with nothing to do waits. */
START_TEST(one_client_is_read_to_its_end_beside_others_that_rest)
{
    int fd[CLIENTS];
    begin(fd, CLIENTS);
    flood(fd, 1);
    for (unsigned turns = 0; taken < LENGTH; turns++) {
        ck_assert_uint_lt(turns, 3u * LENGTH / SERVICE_IN);
        uv_run(&loop, UV_RUN_NOWAIT);
    }
    for (unsigned i = 0; i < 3; i++)
        uv_run(&loop, UV_RUN_NOWAIT);
    ck_assert_int_ne(uv_backend_timeout(&loop), 0);
    end(fd, CLIENTS);
}
END_TEST

/* A packet of many short requests with long answers, far more than may wait: the client gets them all, however late it reads. */
START_TEST(a_client_that_reads_late_gets_all_answers_and_the_rest_of_its_requests_waits)
{
    enum { REQUESTS = 1000 };
    uint8_t requests[REQUESTS], bytes[4096];
    size_t read = 0;
    int fd;
    for (unsigned i = 0; i < REQUESTS; i++)
        requests[i] = (uint8_t)i;
    most_taken = 1;
    answer = SERVICE_OUT_MAX / 2u;
    begin(&fd, 1);
    ck_assert_int_eq(send(fd, requests, sizeof requests, 0), REQUESTS);
    for (unsigned i = 0; i < 3u * REQUESTS; i++)
        uv_run(&loop, UV_RUN_NOWAIT);
    ck_assert_uint_lt(taken, REQUESTS); /* its socket is full */
    ck_assert_int_ne(uv_backend_timeout(&loop), 0);
    while (read < REQUESTS * answer) {
        uv_run(&loop, UV_RUN_NOWAIT);
        ssize_t length = recv(fd, bytes, sizeof bytes, MSG_DONTWAIT);
        ck_assert_int_ne(length, 0);
        read += length > 0 ? (size_t)length : 0;
    }
    ck_assert_uint_eq(taken, REQUESTS);
    ck_assert_uint_eq(closed, 0);
    end(&fd, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("service_port");
    TCase *turns = tcase_create("turns");
    tcase_add_test(turns, a_turn_of_the_loop_ends_however_much_has_come);
    tcase_add_test(turns, each_client_is_read_in_its_turn);
    tcase_add_test(turns, a_client_that_reads_late_gets_all_answers_and_the_rest_of_its_requests_waits);
    tcase_add_test(turns, one_client_is_read_to_its_end_beside_others_that_rest);
    suite_add_tcase(suite, turns);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
