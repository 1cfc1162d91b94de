/* SPDX-License-Identifier: MIT */
/* fuzz_bus_ports.c: a line with a unit and all its ways in: a pty, TCP, RFC 2217; clients that come, set up, send and go, an
 * adapter that is pulled out and put in, at any time (loop_machine.c). The line is never lost; over the network at most one
 * client is there; and when all have gone and the adapter is in, the next one is answered on each way, with the speed of the
 * unit.
 *
 * First byte: 1: --strict-line; 2: bytes take their time; 4, 8: without TCP, RFC 2217; 16, 32: the clock. Then two bytes an
 * action: what and by which way, and a value; a sender takes as many more bytes. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include "bus/bus.h"
#include "fuzz.h"
#include "loop_machine.h"

#define ACTIONS 120u
#define LOOKS 20000u
#define TURNS 400u
#define WAYS 3u /* the pty, TCP, RFC 2217 */

static const uint8_t request[] = {0x7e, 0x01, 0x00, 0x08, 0x58, 0x10, 0x7e}; /* message 8 to unit 1, which does not know it */
static const uint8_t answer[] = {0x08, 0x00, 0x00, 0xdb}; /* the middle of it; FF around it is doubled by RFC 2217 */

static struct bus_options options;
static uv_loop_t loop;
static struct line_watch watch;
static uv_poll_t noticed;
static struct bus *bus;
static int client[WAYS];
static char link_pattern[PATH_MAX];

static void on_failed(void *context)
{
    (void)context;
    FUZZ_CHECK(false, "the line is lost");
}

static void on_presence(void *context)
{
    (void)context;
}

static void on_notice(uv_poll_t *handle, int status, int events)
{
    (void)handle, (void)status, (void)events;
    line_watch_update(&watch);
}

static void start(uint8_t mode)
{
    static const struct bus_calls calls = {.failed = on_failed, .presence = on_presence};
    static const char *const clocks[] = {"real", "max", "x10", "x0.5"};
    machine_path(link_pattern, "bus");
    options = (struct bus_options){
        .device = {.kind = &rkm04_device},
        .lines = 1,
        .clock_text = clocks[mode >> 4 & 3],
        .baud = mode & 2 ? 19200 : 0,
        .strict_line = (mode & 3) == 3,
        .turnaround = SEGMENT_TURNAROUND,
        .pty = true,
        .link = link_pattern,
        .tcp = mode & 4 ? NULL : "0",
        .rfc2217 = mode & 8 ? NULL : "0",
        .no_control = true,
        .seed = 1,
        .min_coverage = -1,
        .ready_fd = -1,
    };
    FUZZ_CHECK(node_list_read(&options.nodes, "1") && virtual_clock_read(&options.clock, options.clock_text), "mode");
    FUZZ_CHECK(uv_loop_init(&loop) == 0 && line_watch_open(&watch) && uv_poll_init(&loop, &noticed, watch.fd) == 0 &&
                   uv_poll_start(&noticed, UV_READABLE, on_notice) == 0, "no watch");
    bus = calloc(1, sizeof *bus);
    FUZZ_CHECK(bus && bus_begin(bus, 0, &options, &loop, &watch, NULL, &calls, NULL) && bus_start(bus), "no line");
}

static void close_handle(uv_handle_t *handle, void *unused)
{
    (void)unused;
    if (!uv_is_closing(handle))
        uv_close(handle, NULL);
}

static void stop(void)
{
    FUZZ_CHECK(bus_end(bus), "it does not end well");
    uv_walk(&loop, close_handle, NULL);
    uv_run(&loop, UV_RUN_DEFAULT);
    FUZZ_CHECK(uv_loop_close(&loop) == 0, "a handle is open");
    bus_free(bus);
    line_watch_close(&watch);
    FUZZ_CHECK(access(link_pattern, F_OK) != 0, "the link is left behind");
}

static void turn(unsigned times)
{
    while (times-- > 0) {
        machine_ring();
        uv_run(&loop, UV_RUN_NOWAIT);
    }
}

static const struct net_port *net_port(unsigned way)
{
    return way == 1 ? bus->ports.tcp : bus->ports.rfc2217;
}

static int come(unsigned way)
{
    struct sockaddr_in to = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    if (way == 0)
        return open(link_pattern, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (!net_port(way))
        return -1;
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    to.sin_port = htons((uint16_t)atoi(strrchr(net_port(way)->address, ':') + 1));
    FUZZ_CHECK(connect(fd, (void *)&to, sizeof to) == 0 || errno == EINPROGRESS, "%s", strerror(errno));
    return fd;
}

static void leave(unsigned way)
{
    struct linger now = {.l_onoff = 1, .l_linger = 0}; /* else its port would be taken for a minute */
    if (client[way] < 0)
        return;
    if (way > 0)
        setsockopt(client[way], SOL_SOCKET, SO_LINGER, &now, sizeof now);
    close(client[way]);
    client[way] = -1;
}

static void set_up(int fd, speed_t speed, uint8_t value)
{
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0)
        return; /* the adapter has been pulled out */
    cfmakeraw(&settings);
    settings.c_cflag = (settings.c_cflag & ~(tcflag_t)CSTOPB) | CLOCAL | CREAD | (value & 1 ? CSTOPB : 0);
    settings.c_lflag |= value & 2 ? ECHO : 0;
    cfsetspeed(&settings, speed);
    tcsetattr(fd, TCSANOW, &settings);
}

/* The system passes bytes on in a thread of its own: wait until they are there, but not without end: the other end may be full.
 * */
static void wait_for(int fd)
{
    struct pollfd ready = {.fd = fd, .events = POLLIN};
    if (fd >= 0)
        poll(&ready, 1, 20);
}

static void say(int fd, struct fuzz *fuzz, uint8_t value)
{
    size_t length;
    const uint8_t *bytes = fuzz_take(fuzz, value & 127u, &length);
    if (value & 128)
        (void)!write(fd, request, sizeof request);
    else
        (void)!write(fd, bytes, length);
    if (fd == client[0] && (length > 0 || (value & 128)))
        wait_for(bus->ports.line.fd);
}

static void act(struct fuzz *fuzz, uint8_t what, uint8_t value)
{
    static const speed_t speeds[] = {B19200, B9600, B38400, B0, B300, B115200, B4000000, B19200};
    uint8_t bytes[512];
    unsigned way = (what >> 4) % WAYS;
    int *fd = &client[way];
    switch (what & 15u) {
    case 0: case 1: case 2: case 3:
        if (*fd < 0)
            *fd = come(way);
        else
            say(*fd, fuzz, value);
        break;
    case 4:
        leave(way);
        break;
    case 5:
        if (*fd >= 0 && way == 0)
            set_up(*fd, speeds[value & 7], value >> 3);
        break;
    case 6:
        if (*fd >= 0)
            (void)!read(*fd, bytes, sizeof bytes);
        break;
    case 7:
        if (*fd >= 0)
            way == 0 ? ioctl(*fd, value & 1 ? TIOCEXCL : TIOCNXCL) : shutdown(*fd, SHUT_WR);
        break;
    case 8:
        bus_ports_plug(&bus->ports, value & 1);
        bus_changed(bus);
        break;
    case 9: case 10:
        machine_pass(value * UINT64_C(1000000));
        break;
    default:
        turn(1 + (value & 7u));
    }
    FUZZ_CHECK(!bus->ports.tcp || !bus->ports.tcp->attached || !bus->ports.rfc2217 || !bus->ports.rfc2217->attached ||
                   net_port_client(bus->ports.tcp) == NULL || net_port_client(bus->ports.rfc2217) == NULL, "two have the line");
}

/* A client that comes now is answered. */
static void check_answer(unsigned way)
{
    uint8_t bytes[4096];
    size_t had = 0;
    client[way] = come(way);
    if (client[way] < 0) {
        FUZZ_CHECK(way > 0 && !net_port(way), "nobody gets in by way %u: %s", way, strerror(errno));
        return;
    }
    if (way == 0)
        set_up(client[way], B19200, 0);
    turn(5);
    FUZZ_CHECK(write(client[way], request, sizeof request) == sizeof request, "way %u: %s", way, strerror(errno));
    wait_for(way == 0 ? bus->ports.line.fd : -1);
    for (unsigned i = 0; i < TURNS && !memmem(bytes, had, answer, sizeof answer); i++) {
        turn(1);
        machine_pass(UINT64_C(1000000));
        if (i > 50)
            wait_for(client[way]);
        ssize_t n = read(client[way], bytes + had, sizeof bytes - had);
        had += n > 0 ? (size_t)n : 0;
    }
    FUZZ_CHECK(memmem(bytes, had, answer, sizeof answer), "no answer by way %u, but %zu bytes", way, had);
    leave(way);
    turn(5);
}

static void check_all_ways(void)
{
    for (unsigned way = 0; way < WAYS; way++)
        leave(way);
    bus_ports_plug(&bus->ports, true);
    bus_changed(bus);
    for (unsigned i = 0; i < 80; i++) { /* what was sent before takes its time, and the silence after it */
        turn(5);
        machine_pass(UINT64_C(200000000));
    }
    FUZZ_CHECK(bus_ports_clients(&bus->ports) == 0, "%u clients are still there", bus_ports_clients(&bus->ports));
    for (unsigned way = 0; way < WAYS; way++)
        check_answer(way);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    uint8_t mode = fuzz_byte(&fuzz);
    signal(SIGPIPE, SIG_IGN);
    machine_begin(50000);
    start(mode);
    for (unsigned way = 0; way < WAYS; way++)
        client[way] = -1;
    for (unsigned i = 0; i < ACTIONS && fuzz.left > 0 && machine_looks() < LOOKS; i++) {
        uint8_t what = fuzz_byte(&fuzz);
        act(&fuzz, what, fuzz_byte(&fuzz));
    }
    check_all_ways();
    stop();
    machine_end();
    return 0;
}
