/* SPDX-License-Identifier: MIT */
/* fuzz_loop.c: the event loop of `rkm04 serve` with its control socket: real lines (bus*.c), real sockets (control*.c, libuv),
 * time and files of loop_machine.c, so that the same bytes do the same again. Clients send any bytes in any pieces, stop reading,
 * leave in the middle, hang up; each checks what it gets (loop_client.c). When nothing is left to do, nothing is due, none waits
 * for what has come true; at the end nothing is open.
 *
 * First byte: units, how long bytes take, a pty or none, the clock. Next an @ or none: the control socket is a TCP port, whose
 * token all clients show first that are not strangers. Then lines:
 *     A… B… C…   a client sends … and a newline; then everything is done that can be done
 *     a… b… c…   a client sends … alone, its `~` being newlines; not looked at yet
 *     -A /A      it hangs up; it ends its sending (the next thing it says makes it come again)
 *     !A ?A      it reads no more; it reads again
 *     *AN        it sends N thousand blanks and x
 *     #N         N more connections that say nothing
 *     @…         a stranger sends … and a newline to the TCP port, and is not let in
 *     +N         N ms pass; .  the loop takes a turn
 *     <HEX       bytes of the host on line 0, >HEX on the last one */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "control/control_inside.h"
#include "fuzz.h"
#include "loop_client.h"
#include "loop_machine.h"

#define ACTIONS 200u           /* lines of an input */
#define CLIENTS 3u
#define CROWD 70u
#define TURNS 60u              /* of the loop, after a line of the input */
#define TURNS_AT_END 400u
#define LOOKS 3000u            /* at the time: how much is done for an input */
#define SENT_MAX 3000000u      /* bytes, by `*` */
#define PASSED_MAX 20000u      /* ms, by `+` */
#define RECEIVED_MAX 12000000u /* bytes */
#define DESCRIPTORS 256

static struct bus_options options;
static uv_loop_t loop;
static struct line_watch notices;
static uv_poll_t noticed;
static struct bus *bus[CLIENT_LINES];
static struct control *control;
static struct client client[CLIENTS];
static int crowd[CROWD];
static unsigned crowd_count, passed, shutdowns_gone;
static size_t filled;
static char socket_path[PATH_MAX], link_pattern[PATH_MAX];
static bool by_tcp;
static bool ended;     /* a client has asked for it */
static unsigned deaf;  /* who asked then, and could not know of it */

/* ---- The emulator --------------------------------------------------------------------------------------------------- */

static void on_failed(void *context)
{
    (void)context;
    FUZZ_CHECK(false, "the line is lost");
}

static json_t *on_ready(void *context)
{
    (void)context;
    return json_object();
}

static void on_presence(void *context)
{
    (void)context;
}

static void on_shutdown(void *context)
{
    (void)context;
    ended = true;
    for (unsigned i = 0; i < CLIENTS; i++)
        deaf += client[i].reading ? client[i].shutdowns_silent : client[i].shutdowns;
}

static void on_notice(uv_poll_t *handle, int status, int events)
{
    (void)handle, (void)status, (void)events;
    line_watch_update(&notices);
}

static void choose(uint8_t mode)
{
    static const char *const nodes[] = {"1", "3,3", "1,2,7", "1"}, *const clocks[] = {"stepped", "stepped", "max", "real"};
    machine_path(socket_path, "control");
    machine_path(link_pattern, "bus%l");
    options = (struct bus_options){
        .device = {.kind = &rkm04_device},
        .lines = (mode & 3) == 3 ? 2 : 1,
        .clock_text = clocks[mode >> 6],
        .baud = mode & 4 ? 19200 : 0,
        .turnaround = SEGMENT_TURNAROUND,
        .pty = mode & 8,
        .link = link_pattern,
        .seed = 1,
        .control = socket_path,
        .min_coverage = -1,
        .ready_fd = -1,
    };
    FUZZ_CHECK(node_list_read(&options.nodes, nodes[mode & 3]) && virtual_clock_read(&options.clock, options.clock_text), "mode");
}

/* As serve.c does it. */
static void start(void)
{
    static const struct bus_calls bus_calls = {.failed = on_failed, .presence = on_presence};
    static const struct control_calls control_calls = {.shutdown = on_shutdown, .presence = on_presence, .ready = on_ready};
    FUZZ_CHECK(uv_loop_init(&loop) == 0, "no loop");
    notices.fd = -1;
    if (options.pty) {
        FUZZ_CHECK(line_watch_open(&notices) && uv_poll_init(&loop, &noticed, notices.fd) == 0 &&
                       uv_poll_start(&noticed, UV_READABLE, on_notice) == 0, "no watch");
    }
    for (unsigned i = 0; i < options.lines; i++) {
        bus[i] = calloc(1, sizeof *bus[i]);
        FUZZ_CHECK(bus[i] && bus_begin(bus[i], i, &options, &loop, &notices, NULL, &bus_calls, NULL), "no line");
    }
    for (unsigned i = 0; i < options.lines; i++)
        FUZZ_CHECK(bus_start(bus[i]), "no start");
    control = control_open(&loop, socket_path, by_tcp ? "127.0.0.1:0" : NULL, bus, options.lines, &control_calls);
    FUZZ_CHECK(control, "no control socket");
    client_find(socket_path, by_tcp ? control->address : NULL, options.lines);
}

static void close_handle(uv_handle_t *handle, void *unused)
{
    (void)unused;
    if (!uv_is_closing(handle))
        uv_close(handle, NULL);
}

static void stop(void)
{
    char path[PATH_MAX];
    for (unsigned i = 0; i < CLIENTS; i++)
        client[i].over = true;
    control_close(control);
    for (unsigned i = 0; i < options.lines; i++)
        FUZZ_CHECK(bus_end(bus[i]), "line %u does not end well", i);
    control_hang_up(control);
    uv_walk(&loop, close_handle, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    int open = uv_loop_close(&loop);
    FUZZ_CHECK(open == 0, "%s", uv_strerror(open));
    control_free(control);
    for (unsigned i = 0; i < options.lines; i++)
        bus_free(bus[i]);
    line_watch_close(&notices);
    static const char *const names[] = {"control", "control.lock", "bus0", "bus0.lock", "bus1", "bus1.lock"};
    for (unsigned i = 0; i < sizeof names / sizeof names[0]; i++) {
        machine_path(path, names[i]);
        FUZZ_CHECK(access(path, F_OK) != 0, "%s is left behind", path);
    }
}

/* ---- Turns ---------------------------------------------------------------------------------------------------------- */

static bool clients_take(void)
{
    bool some = false;
    for (unsigned i = 0; i < CLIENTS; i++)
        some = client_take(&client[i]) || some;
    return some;
}

static bool is_worn_out(void)
{
    size_t received = 0;
    for (unsigned i = 0; i < CLIENTS; i++)
        received += client[i].received;
    return machine_looks() > LOOKS || received > RECEIVED_MAX;
}

/* Returns true if something has been done but that a clock has gone on by itself. */
static bool turn(void)
{
    unsigned there = control_clients(control);
    bool rung = machine_ring();
    uv_run(&loop, UV_RUN_NOWAIT);
    bool taken = clients_take(), stepped = true, advancing = false;
    for (unsigned i = 0; i < options.lines; i++) {
        stepped = stepped && bus_is_stepped(bus[i]);
        advancing = advancing || bus[i]->time.advancing;
    }
    return taken || (rung && stepped) || advancing || control->working ||
           control->restore.client || there != control_clients(control);
}

/* No client waits for what has come true, or for a time that is over. */
static void check_waiters(void)
{
    for (unsigned i = 0; i < options.lines; i++) {
        uint64_t now = sim_now(&bus[i]->sim);
        for (const struct bus_waiter *waiter = bus[i]->time.waiters; waiter; waiter = waiter->next)
            FUZZ_CHECK(now < waiter->limit && !(waiter->condition && condition_holds(waiter->condition)), "somebody still waits");
    }
}

/* Let everything be done that can be done, but no more than that takes `most` turns. Returns true if nothing is left to do. */
static bool settle(unsigned most)
{
    unsigned quiet = 0;
    while (most-- > 0 && quiet < 3 && !ended && !is_worn_out())
        quiet = turn() ? 0 : quiet + 1u;
    if (quiet < 3)
        return false;
    check_waiters();
    return true;
}

/* ---- What clients and the host do --------------------------------------------------------------------------------- */

static struct client *client_named(uint8_t letter)
{
    return &client[(letter & 0x1fu) % CLIENTS];
}

static void hang_up(struct client *one)
{
    shutdowns_gone += one->shutdowns;
    client_close(one);
}

/* Before anything else, and before others come, who might take its place. */
static void show_token(struct client *one)
{
    unsigned before = control_clients(control);
    char line[200];
    int length = snprintf(line, sizeof line, "{\"jsonrpc\":\"2.0\",\"id\":0,\"method\":\"authenticate\",\"params\":"
                          "{\"token\":\"%s\"}}\n", control->token);
    FUZZ_CHECK(client_send(one, line, (size_t)length) == (size_t)length, "the token is not sent");
    for (unsigned tries = 0; tries < TURNS && !ended && control_clients(control) == before; tries++)
        turn();
    FUZZ_CHECK(ended || control_clients(control) > before || is_worn_out(), "the token does not let in");
}

/* One who is there, or comes. */
static struct client *speaker(uint8_t letter)
{
    struct client *one = client_named(letter);
    if (one->fd >= 0 && (one->left || one->hung_up))
        hang_up(one);
    if (one->fd < 0 && client_connect(one)) {
        one->crowded = !by_tcp && crowd_count + CLIENTS > CONTROL_CLIENTS;
        if (by_tcp)
            show_token(one);
    }
    return one;
}

static void say(struct client *one, const uint8_t *text, size_t length, bool whole)
{
    static char copy[70000];
    if (length > sizeof copy - 1u)
        length = sizeof copy - 1u;
    for (size_t i = 0; i < length; i++)
        copy[i] = !whole && text[i] == '~' ? '\n' : (char)text[i];
    copy[length] = '\n';
    length += whole;
    size_t done = 0;
    for (unsigned tries = 0; tries < 5; tries++) {
        done += client_send(one, copy + done, length - done);
        if (done == length)
            break;
        turn(); /* not read yet */
    }
}

static unsigned number_of(const uint8_t *text, size_t length)
{
    unsigned number = 0;
    for (size_t i = 0; i < length && number < 100000; i++)
        number = number * 10u + (text[i] & 15u) % 10u;
    return number;
}

/* A line that has no end. */
static void fill(struct client *one, unsigned thousands)
{
    uint8_t piece[1000];
    memset(piece, ' ', sizeof piece);
    piece[999] = 'x';
    while (thousands-- > 0 && filled < SENT_MAX && !is_worn_out()) {
        say(one, piece, sizeof piece, false);
        filled += sizeof piece;
    }
}

static void gather_crowd(unsigned number)
{
    struct client one;
    while (number-- > 0 && crowd_count < CROWD && client_connect(&one)) {
        crowd[crowd_count++] = one.fd;
        turn();
    }
}

/* Whatever it sends: it does not know the token. */
static void send_as_stranger(const uint8_t *text, size_t length)
{
    struct client one;
    unsigned before = control_clients(control);
    if (!by_tcp || crowd_count == CROWD || !client_connect(&one))
        return;
    crowd[crowd_count++] = one.fd;
    (void)!send(one.fd, text, length, MSG_NOSIGNAL | MSG_DONTWAIT);
    (void)!send(one.fd, "\n", 1, MSG_NOSIGNAL | MSG_DONTWAIT);
    turn();
    turn();
    FUZZ_CHECK(control_clients(control) <= before, "a stranger is let in");
}

static unsigned digit_of(uint8_t character)
{
    return (character & 15u) + (character > '9' ? 9u : 0);
}

/* As a port hands it over. */
static void host_sends(struct bus *line, const uint8_t *hex, size_t length)
{
    uint8_t bytes[600];
    size_t n = 0;
    for (; n < sizeof bytes && 2 * n + 1 < length; n++)
        bytes[n] = (uint8_t)(digit_of(hex[2 * n]) << 4 | (digit_of(hex[2 * n + 1]) & 15u));
    if (n > 0 && n <= sim_room(&line->sim)) {
        line->ports.calls->take(line, bytes, n, 0);
        bus_time_catch_up(&line->time);
    }
}

static void pass(unsigned ms)
{
    if (ms > PASSED_MAX - passed)
        ms = PASSED_MAX - passed;
    passed += ms;
    machine_pass(ms * UINT64_C(1000000));
}

static void act(uint8_t what, const uint8_t *text, size_t length)
{
    struct client *named = length > 0 ? client_named(text[0]) : &client[0];
    if (what == '<' || what == '>')
        host_sends(bus[what == '>' ? options.lines - 1u : 0], text, length);
    else if (what == '+')
        pass(number_of(text, length));
    else if (what == '-')
        hang_up(named);
    else if (what == '/' && named->fd >= 0)
        client_leave(named);
    else if (what == '!' || what == '?')
        named->reading = what == '?';
    else if (what == '*' && length > 0)
        fill(speaker(text[0]), number_of(text + 1, length - 1));
    else if (what == '#')
        gather_crowd(number_of(text, length));
    else if (what == '@')
        send_as_stranger(text, length);
    else if (what >= 'A' && what <= 'z')
        say(speaker(what), text, length, what <= 'Z');
    if (what == '.')
        turn();
    else if (what < 'a')
        settle(TURNS);
}

/* ---- The end -------------------------------------------------------------------------------------------------------- */

/* A client has asked for the end and got the answer that it comes, unless it wanted none, does not read, or has gone. */
static void check_shutdown(void)
{
    unsigned asked = shutdowns_gone, answered = 0;
    clients_take();
    for (unsigned i = 0; i < CLIENTS; i++) {
        asked += client[i].shutdowns;
        answered += client[i].shutdowns_answered;
    }
    FUZZ_CHECK(asked > 0, "nobody has asked for the end");
    FUZZ_CHECK(answered > 0 || deaf + shutdowns_gone > 0, "nobody was told of the end");
}

/* Everybody reads what is there for him. Then, mostly, all leave. */
static void say_goodbye(bool leave)
{
    for (unsigned i = 0; i < CLIENTS; i++)
        client[i].reading = true;
    if (!settle(TURNS_AT_END) && !ended)
        return;
    for (unsigned i = 0; i < CLIENTS && !ended; i++)
        client_check_quiet(&client[i]);
    if (!leave || ended)
        return;
    for (unsigned i = 0; i < CLIENTS; i++)
        hang_up(&client[i]);
    while (crowd_count > 0)
        close(crowd[--crowd_count]);
    machine_pass(UINT64_C(1000000000)); /* one that had ended its sending is not read: it is checked now and then */
    if (settle(TURNS_AT_END) && !by_tcp) /* TCP does not report who goes after its sending has ended */
        FUZZ_CHECK(control_clients(control) == 0, "%u clients are still there", control_clients(control));
}

/* Those who stayed to the end see it. */
static void check_hung_up(void)
{
    clients_take();
    for (unsigned i = 0; i < CLIENTS; i++) {
        FUZZ_CHECK(client[i].fd < 0 || client[i].hung_up || !client[i].reading, "client %u is still connected", i);
        client_close(&client[i]);
    }
    while (crowd_count > 0)
        close(crowd[--crowd_count]);
}

/* Which descriptors are open. */
static void look_at_descriptors(bool open[DESCRIPTORS])
{
    struct pollfd looks[DESCRIPTORS];
    for (int i = 0; i < DESCRIPTORS; i++)
        looks[i] = (struct pollfd){.fd = i};
    poll(looks, DESCRIPTORS, 0);
    for (int i = 0; i < DESCRIPTORS; i++)
        open[i] = !(looks[i].revents & POLLNVAL);
}

/* libuv opens some for good. */
static void warm_up(void)
{
    static bool warm;
    if (warm)
        return;
    warm = true;
    signal(SIGPIPE, SIG_IGN);
    FUZZ_CHECK(uv_loop_init(&loop) == 0 && uv_loop_close(&loop) == 0, "no loop");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const uint64_t look[] = {100000, 500000, 2000000, 6000000}; /* ns */
    struct fuzz fuzz = {data, size};
    uint8_t mode = fuzz_byte(&fuzz);
    bool open_before[DESCRIPTORS], open_after[DESCRIPTORS];
    by_tcp = fuzz.left > 0 && *fuzz.at == '@';
    if (by_tcp)
        fuzz_byte(&fuzz);
    warm_up();
    look_at_descriptors(open_before);
    machine_begin(look[mode >> 4 & 3]);
    choose(mode);
    start();
    ended = false;
    filled = passed = crowd_count = shutdowns_gone = deaf = 0;
    for (unsigned i = 0; i < CLIENTS; i++)
        client_none(&client[i]);
    for (unsigned i = 0; i < ACTIONS && fuzz.left > 0 && !ended && !is_worn_out(); i++) {
        size_t length;
        const uint8_t *line = fuzz_until(&fuzz, '\n', &length);
        if (length > 0)
            act(line[0], line + 1, length - 1);
    }
    say_goodbye(!(size & 1));
    if (ended)
        check_shutdown();
    stop();
    check_hung_up();
    look_at_descriptors(open_after);
    for (int i = 0; i < DESCRIPTORS; i++)
        FUZZ_CHECK(open_after[i] == open_before[i], "descriptor %d is still open", i);
    machine_end();
    return 0;
}
