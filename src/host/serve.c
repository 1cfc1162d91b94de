/* rkm04 serve: one unit on a serial line, driven by one event loop.
 *
 *     line --on_readable--> paced_unit --gather--> line
 *     clock --on_timer----> paced_unit
 *
 * Nothing of a motion is seen outside except in answers, so the loop sleeps until a byte is to be moved or comes in, and the
 * unit catches up then. Only in order that this never takes long it also wakes every REST while something is going on. */
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/timerfd.h>
#include <unistd.h>
#include <uv.h>

#include "flash_file.h"
#include "line.h"
#include "link_path.h"
#include "log.h"
#include "paced_unit.h"
#include "serve_options.h"
#include "subcommands.h"

#define NS_PER_MS 1000000u
#define NS_PER_SECOND 1000000000u
#define REST (100u * NS_PER_MS)  /* longest sleep while motors or programs run */
#define STINT (5u * NS_PER_MS)   /* longest time without a look at the line and at signals */
#define STEP 100000u             /* ticks that the unit is advanced at once while it is at work */
#define LEAP 10000u              /* ticks: shortest leap of --clock max; less would cost more than it shows */
#define FRAME_SILENCE (100u * NS_PER_MS) /* --clock max: how long the rest of a frame is waited for (L2) */

static const int end_signals[] = {SIGINT, SIGTERM, SIGHUP};
#define END_SIGNALS (sizeof end_signals / sizeof end_signals[0])

struct serve {
    struct serve_options options;
    struct paced_unit paced;
    struct flash_file flash;
    struct link_path link;
    struct line line;
    struct virtual_clock clock;
    uint64_t heard;       /* ns at which the last bytes came */
    uint64_t told;        /* of line.dropped, those in the log already */
    uint32_t place[RKM04_MOTORS]; /* of the command executed last, for the log */
    int timer_fd;
    bool reading;         /* the line is being polled */
    enum exit_status status;
    size_t gathered;      /* bytes in `out` */
    uint8_t out[4096];

    uv_loop_t loop;
    uv_poll_t readable, notices, timer;
    uv_signal_t signals[END_SIGNALS];
};

static uint64_t now_tick(const struct serve *serve)
{
    return rkm04_now(&serve->paced.unit);
}

/* The present, for the log; the unit may be behind it while nobody looks. */
static uint64_t present(const struct serve *serve)
{
    return virtual_clock_tick(&serve->clock, uv_hrtime());
}

static void fail(struct serve *serve)
{
    serve->status = STATUS_FAILURE;
    uv_stop(&serve->loop);
}

/* ---- The unit's port ------------------------------------------------------------------------------------------------ */

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    struct serve *serve = context;
    if (what == RKM04_EVENT_COMMAND && value != 0)
        serve->place[motor - 1] = value;
    if (what == RKM04_EVENT_FAULT && value != RKM04_FAULT_NONE)
        log_at(tick, "motor %u: fault %s at command %" PRIu32, motor, rkm04_fault_name((enum rkm04_fault)value),
               serve->place[motor - 1]);
}

static int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct serve *serve = context;
    return flash_file_read(&serve->flash, block, offset, data, length);
}

static int flash_erase(void *context, unsigned block)
{
    struct serve *serve = context;
    return flash_file_erase(&serve->flash, block);
}

static int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct serve *serve = context;
    return flash_file_program(&serve->flash, block, offset, data, length);
}

static const struct rkm04_port port = {
    .event = on_event,
    .flash_read = flash_read,
    .flash_erase = flash_erase,
    .flash_program = flash_program,
};

/* ---- Bytes to the host ---------------------------------------------------------------------------------------------- */

static void send_gathered(struct serve *serve)
{
    size_t dropped = line_write(&serve->line, serve->out, serve->gathered);
    serve->gathered = 0;
    if (dropped > 0 && serve->line.clients > 0 && serve->told == serve->line.dropped - dropped) {
        log_at(present(serve), "the client does not read: bytes are being dropped");
        serve->told = serve->line.dropped;
    }
}

static void gather(void *context, const uint8_t *bytes, size_t length)
{
    struct serve *serve = context;
    if (length > sizeof serve->out - serve->gathered)
        send_gathered(serve);
    memcpy(serve->out + serve->gathered, bytes, length);
    serve->gathered += length;
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

/* --clock max: the tick to leap to at `now` (ns): that of the next byte under way; else, unless the rest of a frame is on its
 * way, past the next thing that happens. RKM04_NEVER: no reason to leap. */
static uint64_t leap_to(const struct serve *serve, uint64_t now)
{
    const struct paced_unit *paced = &serve->paced;
    uint64_t byte = paced_unit_due(paced);
    if (!serve->clock.runs_ahead || byte != RKM04_NEVER)
        return serve->clock.runs_ahead ? byte : RKM04_NEVER;
    if (paced->in_frame && now - serve->heard < FRAME_SILENCE)
        return RKM04_NEVER;
    uint64_t event = rkm04_next_event(&paced->unit), least = now_tick(serve) + LEAP;
    return event == RKM04_NEVER ? RKM04_NEVER : event < least ? least : event + 1;
}

/* Up to which tick the unit is to be at `now` (ns). */
static uint64_t goal(struct serve *serve, uint64_t now)
{
    uint64_t tick = virtual_clock_tick(&serve->clock, now), leap = leap_to(serve, now);
    if (leap == RKM04_NEVER || leap <= tick)
        return tick;
    virtual_clock_leap(&serve->clock, now, leap);
    return leap;
}

/* One step towards `tick`: a span in which nothing happens, or STEP. Anything may be reached in one call of the unit, but
 * then nobody would look at the line and at signals for a long while. */
static void step(struct serve *serve, uint64_t tick)
{
    uint64_t event = rkm04_next_event(&serve->paced.unit), end = now_tick(serve) + STEP;
    if (end <= event)
        end = event == RKM04_NEVER ? RKM04_NEVER : event + 1;
    paced_unit_advance(&serve->paced, tick < end ? tick : end);
}

/* When (ns) there will be something to do; 0: not before bytes come. */
static uint64_t next_wake(const struct serve *serve, uint64_t now)
{
    uint64_t byte = paced_unit_due(&serve->paced), event = rkm04_next_event(&serve->paced.unit), when = 0;
    if (leap_to(serve, now) != RKM04_NEVER)
        return now;
    if (byte != RKM04_NEVER)
        when = virtual_clock_when(&serve->clock, byte);
    if (event != RKM04_NEVER) {
        uint64_t look = virtual_clock_when(&serve->clock, event + 1);
        if (look < now + REST)
            look = now + REST;
        if (when == 0 || look < when)
            when = look;
    }
    return when;
}

static void set_timer(struct serve *serve, uint64_t when)
{
    struct itimerspec spec = {
        .it_value = {.tv_sec = (time_t)(when / NS_PER_SECOND), .tv_nsec = (long)(when % NS_PER_SECOND)},
    };
    timerfd_settime(serve->timer_fd, TFD_TIMER_ABSTIME, &spec, NULL);
}

static void set_reading(struct serve *serve);

/* Bring the unit up to the present, send what is due, and sleep. */
static void catch_up(struct serve *serve)
{
    uint64_t start = uv_hrtime(), now = start, tick;
    do {
        tick = goal(serve, now);
        step(serve, tick);
        now = uv_hrtime();
    } while (now - start < STINT && (now_tick(serve) < tick || leap_to(serve, now) != RKM04_NEVER));
    send_gathered(serve);
    set_reading(serve);
    set_timer(serve, now_tick(serve) < tick ? now : next_wake(serve, now));
}

static void on_timer(uv_poll_t *handle, int status, int events)
{
    (void)status;
    (void)events;
    catch_up(handle->data);
}

/* ---- Bytes from the host -------------------------------------------------------------------------------------------- */

static void on_news(void *context, enum line_news news)
{
    struct serve *serve = context;
    const struct line *line = &serve->line;
    uint64_t tick = present(serve), dropped = line->dropped - serve->told;
    switch (news) {
    case LINE_DETACHED:
        log_at(tick, "the client has closed the line");
        break;
    case LINE_ATTACHED:
        if (dropped > 0)
            log_at(tick, "a client has opened the line; %" PRIu64 " bytes for nobody were dropped before", dropped);
        else
            log_at(tick, "a client has opened the line");
        serve->told = line->dropped;
        break;
    case LINE_SHARED:
        log_at(tick, "one more client has opened the line: they will take each other's answers (%u now)", line->clients);
        break;
    case LINE_FAILED:
        fail(serve);
    }
}

static void on_notice(uv_poll_t *handle, int status, int events)
{
    struct serve *serve = handle->data;
    (void)status;
    (void)events;
    line_pty_notice(&serve->line);
}

/* Read all there is room for. Returns false if the line is gone. */
static bool read_line(struct serve *serve)
{
    uint8_t bytes[1024];
    size_t room;
    while ((room = paced_unit_room(&serve->paced)) > 0) {
        ssize_t length = line_read(&serve->line, bytes, room < sizeof bytes ? room : sizeof bytes);
        if (length < 0)
            return false;
        if (length == 0)
            return true;
        serve->heard = uv_hrtime();
        uint64_t tick = virtual_clock_tick(&serve->clock, serve->heard);
        paced_unit_take(&serve->paced, bytes, (size_t)length, tick);
        if (serve->line.clients == 0)
            line_pty_count_again(&serve->line);
    }
    return true;
}

static void on_readable(uv_poll_t *handle, int status, int events)
{
    struct serve *serve = handle->data;
    (void)status; /* a hang-up shows when reading */
    (void)events;
    if (serve->line.notices >= 0)
        line_pty_notice(&serve->line);
    if (!read_line(serve)) {
        const char *why = errno ? strerror(errno) : "hung up";
        log_at(present(serve), "%s is gone: %s; start again when it is back",
               serve->options.port ? serve->options.port : serve->line.path, why);
        fail(serve);
        return;
    }
    catch_up(serve);
}

/* Listen to the line while there is room for what it brings. */
static void set_reading(struct serve *serve)
{
    size_t room = paced_unit_room(&serve->paced);
    if (serve->reading && room == 0) {
        uv_poll_stop(&serve->readable);
        serve->reading = false;
    } else if (!serve->reading && room >= PACED_UNIT_ROOM / 2) {
        serve->reading = uv_poll_start(&serve->readable, UV_READABLE, on_readable) == 0;
    }
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static void on_signal(uv_signal_t *handle, int number)
{
    struct serve *serve = handle->data;
    log_at(present(serve), "ended by SIG%s", sigabbrev_np(number));
    uv_stop(&serve->loop);
}

/* Report what libuv could not do. Returns true if nothing is wrong. */
static bool check(const char *what, int error)
{
    if (error != 0)
        log_error("cannot %s: %s", what, uv_strerror(error));
    return error == 0;
}

static bool start_poll(struct serve *serve, uv_poll_t *poll, int fd, uv_poll_cb callback)
{
    poll->data = serve;
    return check("watch the line", uv_poll_init(&serve->loop, poll, fd)) &&
           check("watch the line", uv_poll_start(poll, UV_READABLE, callback));
}

static bool start_signals(struct serve *serve)
{
    for (size_t i = 0; i < END_SIGNALS; i++) {
        struct sigaction present;
        if (sigaction(end_signals[i], NULL, &present) == 0 && present.sa_handler == SIG_IGN && end_signals[i] == SIGHUP)
            continue; /* nohup */
        serve->signals[i].data = serve;
        if (!check("handle signals", uv_signal_init(&serve->loop, &serve->signals[i])) ||
            !check("handle signals", uv_signal_start(&serve->signals[i], on_signal, end_signals[i])))
            return false;
    }
    return true;
}

static bool start_loop(struct serve *serve)
{
    serve->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    if (serve->timer_fd < 0) {
        log_error("cannot make a timer: %s", strerror(errno));
        return false;
    }
    serve->reading = start_poll(serve, &serve->readable, serve->line.fd, on_readable);
    return serve->reading && start_poll(serve, &serve->timer, serve->timer_fd, on_timer) &&
           (serve->line.notices < 0 || start_poll(serve, &serve->notices, serve->line.notices, on_notice)) &&
           start_signals(serve);
}

static bool open_line(struct serve *serve)
{
    if (serve->options.port)
        return line_serial_open(&serve->line, serve->options.port);
    return link_path_claim(&serve->link, serve->options.link) && line_pty_open(&serve->line, on_news, serve);
}

static void tell_start(const struct serve *serve)
{
    const struct serve_options *options = &serve->options;
    if (options->port)
        log_at(0, "unit %u on %s", options->config.node, options->port);
    else
        log_at(0, "unit %u on %s, link %s", options->config.node, serve->line.path, serve->link.path);
    log_at(0, "framing %s, %s, clock %s", options->config.framing->name,
           options->baud ? "bytes paced at 19200 baud" : "bytes not paced", options->clock_text);
    if (options->flash)
        log_at(0, "flash image %s", options->flash);
    else
        log_at(0, "no flash image: stored programs are lost when the emulator ends (--flash FILE keeps them)");
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        struct rkm04_motor_state state;
        rkm04_motor_state(&serve->paced.unit, motor, &state);
        if (state.slot == RKM04_SLOT_LOADED)
            log_at(0, "motor %u: starts the program of %u commands from flash", motor, state.commands);
        else if (state.slot == RKM04_SLOT_UNTRUSTED)
            log_at(0, "motor %u: its flash slot holds no whole program and counts as empty", motor);
    }
}

/* Print the READY line. Returns false if nobody can get it (reported). */
static bool tell_ready(const struct serve *serve)
{
    const struct serve_options *options = &serve->options;
    json_t *ready = json_pack("{s:s?, s:s?, s:i, s:s?, s:s, s:i, s:s, s:s?}", "pty", options->port ? NULL : serve->line.path,
                              "link", options->port ? NULL : serve->link.path, "node", (int)options->config.node, "port",
                              options->port, "framing", options->config.framing->name, "baud", (int)options->baud, "clock",
                              options->clock_text, "flash", options->flash);
    bool done = ready && fputs("READY ", stdout) >= 0 && json_dumpf(ready, stdout, JSON_COMPACT) == 0 &&
                putchar('\n') != EOF && fflush(stdout) == 0;
    json_decref(ready);
    if (!done)
        log_error("cannot print the READY line on stdout: %s", strerror(errno));
    return done;
}

static bool start(struct serve *serve)
{
    const struct serve_options *options = &serve->options;
    if (!flash_file_open(&serve->flash, options->flash) || !open_line(serve))
        return false;
    serve->paced.paced = options->baud != 0;
    serve->paced.out = gather;
    serve->paced.context = serve;
    paced_unit_begin(&serve->paced, &options->config, &port, serve);
    if (!start_loop(serve) || (!options->port && !link_path_make(&serve->link, serve->line.path)))
        return false;
    tell_start(serve);
    serve->clock = options->clock;
    virtual_clock_start(&serve->clock, uv_hrtime());
    return tell_ready(serve);
}

static void close_handle(uv_handle_t *handle, void *unused)
{
    (void)unused;
    uv_close(handle, NULL);
}

/* The link goes first, so that nobody follows it to a pty that is gone. */
static void end(struct serve *serve)
{
    link_path_release(&serve->link);
    uv_walk(&serve->loop, close_handle, NULL);
    uv_run(&serve->loop, UV_RUN_DEFAULT);
    uv_loop_close(&serve->loop);
    line_close(&serve->line);
    if (serve->timer_fd >= 0)
        close(serve->timer_fd);
    if (!flash_file_close(&serve->flash))
        serve->status = STATUS_FAILURE;
}

int serve_main(int argc, char **argv)
{
    static struct serve serve; /* too large for the stack of some systems */
    serve.line.fd = serve.line.slave = serve.line.notices = -1;
    serve.link.lock = serve.flash.fd = serve.timer_fd = -1;
    serve_options_read(&serve.options, argc, argv);
    signal(SIGPIPE, SIG_IGN);
    setvbuf(stderr, NULL, _IOLBF, 0);
    if (!check("make an event loop", uv_loop_init(&serve.loop)))
        return STATUS_FAILURE;
    serve.status = STATUS_FAILURE;
    if (start(&serve)) {
        serve.status = STATUS_WELL;
        catch_up(&serve);
        uv_run(&serve.loop, UV_RUN_DEFAULT);
        struct rkm04_counters counters = rkm04_counters(&serve.paced.unit);
        log_at(present(&serve), "requests %" PRIu32 ", answers %" PRIu32 ", frames dropped %" PRIu32 ", bytes dropped %" PRIu64,
               counters.requests, counters.answers, counters.dropped, serve.line.dropped);
    }
    end(&serve);
    return serve.status;
}
