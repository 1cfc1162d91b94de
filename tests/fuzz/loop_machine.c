/* SPDX-License-Identifier: MIT */
#include "loop_machine.h"

#include <dirent.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>
#include <uv.h>

#include "command/command.h"
#include "fuzz.h"
#include "line/log.h"
#include "record/snapshot.h"
#include "trace/trace_file.h"
#include "trace/wire_file.h"

#define NS_PER_SECOND UINT64_C(1000000000)
#define NS_PER_MS UINT64_C(1000000)
#define TIMERS 12u
#define AN_HOUR UINT64_C(3600000) /* ms */

static uint64_t now, a_look;
static unsigned looks;

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

uint64_t __wrap_uv_hrtime(void);
uint64_t __wrap_uv_now(const uv_loop_t *loop);
int __wrap_timerfd_create(clockid_t clock, int flags);
int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *spec, struct itimerspec *old);
int __wrap_uv_timer_start(uv_timer_t *handle, uv_timer_cb call, uint64_t timeout, uint64_t repeat);
int __wrap_uv_timer_stop(uv_timer_t *handle);
int __real_uv_timer_start(uv_timer_t *handle, uv_timer_cb call, uint64_t timeout, uint64_t repeat);
int __real_uv_timer_stop(uv_timer_t *handle);

/* A timer of the system: readable when it is due. */
static struct alarm {
    int fd;
    uint64_t when; /* 0: it is not set */
} alarms[TIMERS];
static unsigned alarm_count;

/* A timer of libuv. The real one is on as well, but for so long that it never goes off. */
static struct bell {
    uv_timer_t *handle; /* NULL: free */
    uv_timer_cb call;
    uint64_t when, repeat; /* ns */
} bells[TIMERS];

uint64_t machine_now(void)
{
    return now;
}

void machine_pass(uint64_t ns)
{
    now += ns;
}

unsigned machine_looks(void)
{
    return looks;
}

uint64_t __wrap_uv_hrtime(void)
{
    looks++;
    now += a_look;
    return now;
}

uint64_t __wrap_uv_now(const uv_loop_t *loop)
{
    (void)loop;
    return now / NS_PER_MS;
}

int __wrap_timerfd_create(clockid_t clock, int flags)
{
    FUZZ_CHECK(clock == CLOCK_MONOTONIC && alarm_count < TIMERS, "%u timers", alarm_count);
    int fd = eventfd(0, (flags & TFD_NONBLOCK ? EFD_NONBLOCK : 0) | (flags & TFD_CLOEXEC ? EFD_CLOEXEC : 0));
    alarms[alarm_count++] = (struct alarm){.fd = fd};
    return fd;
}

int __wrap_timerfd_settime(int fd, int flags, const struct itimerspec *spec, struct itimerspec *old)
{
    eventfd_t count;
    FUZZ_CHECK(flags == TFD_TIMER_ABSTIME && !old && spec->it_interval.tv_sec == 0 && spec->it_interval.tv_nsec == 0, "a repeat");
    FUZZ_CHECK(spec->it_value.tv_nsec >= 0 && spec->it_value.tv_nsec < (long)NS_PER_SECOND, "EINVAL");
    for (unsigned i = 0; i < alarm_count; i++)
        if (alarms[i].fd == fd)
            alarms[i].when = (uint64_t)spec->it_value.tv_sec * NS_PER_SECOND + (uint64_t)spec->it_value.tv_nsec;
    eventfd_read(fd, &count); /* it may have gone off before */
    return 0;
}

static struct bell *bell_of(const uv_timer_t *handle)
{
    for (unsigned i = 0; i < TIMERS; i++)
        if (bells[i].handle == handle)
            return &bells[i];
    return NULL;
}

int __wrap_uv_timer_start(uv_timer_t *handle, uv_timer_cb call, uint64_t timeout, uint64_t repeat)
{
    struct bell *bell = bell_of(handle);
    if (!bell)
        bell = bell_of(NULL);
    FUZZ_CHECK(bell, "too many timers");
    *bell = (struct bell){handle, call, now + timeout * NS_PER_MS, repeat * NS_PER_MS};
    return __real_uv_timer_start(handle, call, AN_HOUR, repeat > 0 ? AN_HOUR : 0);
}

int __wrap_uv_timer_stop(uv_timer_t *handle)
{
    struct bell *bell = bell_of(handle);
    if (bell)
        bell->handle = NULL;
    return __real_uv_timer_stop(handle);
}

static bool ring(struct bell *bell)
{
    uv_timer_t *handle = bell->handle;
    if (!handle || !uv_is_active((uv_handle_t *)handle)) {
        bell->handle = NULL; /* it was closed */
        return false;
    }
    if (now < bell->when)
        return false;
    if (bell->repeat > 0)
        bell->when = now + bell->repeat;
    else
        __wrap_uv_timer_stop(handle);
    bell->call(handle);
    return true;
}

bool machine_ring(void)
{
    bool rung = false;
    for (unsigned i = 0; i < TIMERS; i++)
        rung = ring(&bells[i]) || rung;
    for (unsigned i = 0; i < alarm_count; i++) {
        if (alarms[i].when == 0 || now < alarms[i].when)
            continue;
        alarms[i].when = 0;
        eventfd_write(alarms[i].fd, 1);
        rung = true;
    }
    return rung;
}

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

struct trace_file *__wrap_trace_file_begin(struct sim *sim, const char *path, unsigned flags, char **error);
struct trace_file *__real_trace_file_begin(struct sim *sim, const char *path, unsigned flags, char **error);
struct wire_file *__wrap_wire_file_begin(struct sim *sim, const char *path, unsigned flags, char **error);
struct wire_file *__real_wire_file_begin(struct sim *sim, const char *path, unsigned flags, char **error);
json_t *__wrap_sim_command(struct sim *sim, const char *method, const json_t *params, struct refusal *refusal);
json_t *__real_sim_command(struct sim *sim, const char *method, const json_t *params, struct refusal *refusal);
struct restore *__wrap_restore_begin(struct sim *sim, const json_t *params, struct refusal *refusal);
struct restore *__real_restore_begin(struct sim *sim, const json_t *params, struct refusal *refusal);

static char folder[PATH_MAX];
static bool used; /* files have been made in it */

static void remove_folder(void)
{
    machine_end();
    rmdir(folder);
}

static void make_folder(void)
{
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/rkm04-fuzz-XXXXXX", base && base[0] == '/' ? base : "/tmp");
    FUZZ_CHECK(mkdtemp(folder), "no folder %s", folder);
    atexit(remove_folder);
}

void machine_path(char path[PATH_MAX], const char *name)
{
    FUZZ_CHECK(snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX, "TMPDIR is too long");
}

/* A name that a client gives: what is behind its last slash, of harmless characters. */
static const char *tame(char path[PATH_MAX], const char *name)
{
    const char *slash = strrchr(name, '/');
    const char *last = slash ? slash + 1 : name;
    size_t length = strlen(last);
    if (length > 40)
        last += length - 40;
    machine_path(path, "file-");
    size_t at = strlen(path);
    for (; *last; last++)
        path[at++] = strchr("abcdefghijklmnopqrstuvwxyz0123456789.-", *last) ? *last : '_';
    path[at] = '\0';
    used = true;
    return path;
}

/* What a trace is written to: "…/full.csv" is a disk that is full. */
static const char *tame_trace(char path[PATH_MAX], const char *name)
{
    tame(path, name);
    const char *dot = strrchr(path, '.');
    size_t length = dot ? (size_t)(dot - path) : 0;
    if (length > 5 && strncmp(dot - 5, "-full", 5) == 0 && access(path, F_OK) != 0)
        FUZZ_CHECK(symlink("/dev/full", path) == 0, "no link %s", path);
    return path;
}

struct trace_file *__wrap_trace_file_begin(struct sim *sim, const char *path, unsigned flags, char **error)
{
    char safe[PATH_MAX];
    return __real_trace_file_begin(sim, tame_trace(safe, path), flags, error);
}

struct wire_file *__wrap_wire_file_begin(struct sim *sim, const char *path, unsigned flags, char **error)
{
    char safe[PATH_MAX];
    return __real_wire_file_begin(sim, tame_trace(safe, path), flags, error);
}

/* Parameters with another name for `file`. */
static json_t *with_safe_file(const json_t *params)
{
    const char *file = json_string_value(json_object_get(params, "file"));
    if (!file || !*file)
        return json_incref((json_t *)params);
    char safe[PATH_MAX];
    json_t *changed = json_copy((json_t *)params);
    if (strncmp(file, "/dev/", 5) == 0)
        machine_path(safe, "no-folder/file");
    else
        tame(safe, file);
    json_object_set_new(changed, "file", json_string(safe));
    return changed;
}

json_t *__wrap_sim_command(struct sim *sim, const char *method, const json_t *params, struct refusal *refusal)
{
    bool is_snapshot = strcmp(method, "snapshot") == 0 && json_is_object(params);
    json_t *safe = is_snapshot ? with_safe_file(params) : json_incref((json_t *)params);
    json_t *result = __real_sim_command(sim, method, safe, refusal);
    json_decref(safe);
    return result;
}

struct restore *__wrap_restore_begin(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    json_t *safe = with_safe_file(params);
    struct restore *restore = __real_restore_begin(sim, safe, refusal);
    json_decref(safe);
    return restore;
}

/* ---- The log -------------------------------------------------------------------------------------------------------- */

static void put_into_words(const char *format, va_list list)
{
    char text[1000];
    vsnprintf(text, sizeof text, format, list);
    FUZZ_CHECK(!strchr(text, '\n'), "a line of the log is two: %s", text);
}

void log_error(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    put_into_words(format, list);
    va_end(list);
}

void log_at(uint64_t tick, const char *format, ...)
{
    va_list list;
    (void)tick;
    va_start(list, format);
    put_into_words(format, list);
    va_end(list);
}

void log_text(const char *text)
{
    FUZZ_CHECK(strchr(text, '\n'), "a line without its end: %s", text);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

void machine_begin(uint64_t look)
{
    if (!folder[0])
        make_folder();
    now = NS_PER_SECOND;
    a_look = look;
    looks = alarm_count = 0;
    memset(bells, 0, sizeof bells);
}

void machine_end(void)
{
    alarm_count = 0;
    memset(bells, 0, sizeof bells);
    DIR *list = used ? opendir(folder) : NULL;
    const struct dirent *entry;
    char path[PATH_MAX];
    while (list && (entry = readdir(list)) != NULL) {
        if (strncmp(entry->d_name, "file-", 5) == 0) {
            machine_path(path, entry->d_name);
            unlink(path);
        }
    }
    if (list)
        closedir(list);
    used = false;
}
