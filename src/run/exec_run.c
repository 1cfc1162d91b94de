/* SPDX-License-Identifier: MIT */
#include "exec_run.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define ANSWER_MAX 16384     /* the longest answer, a full memory, has 9101 bytes */
#define PLACE_SIZE 512u     /* bytes of a file's name, a line and a column */
#define PROGRESS_AFTER 2.0   /* s of real time */
#define PROGRESS_EVERY 0.5   /* s */
#define LEAPS_A_LOOK 4096    /* leaps between two readings of the real clock */

struct progress {
    struct timespec start;
    double next; /* s since start */
    unsigned leaps;
    bool shown;
};

static volatile sig_atomic_t interrupted;

void exec_run_interrupt(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static int flash_read(void *context, unsigned number, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct exec_run *run = context;
    (void)number;
    return flash_file_read(&run->flash, block, offset, data, length);
}

static int flash_erase(void *context, unsigned number, unsigned block)
{
    struct exec_run *run = context;
    (void)number;
    return flash_file_erase(&run->flash, block);
}

static int flash_program(void *context, unsigned number, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct exec_run *run = context;
    (void)number;
    return flash_file_program(&run->flash, block, offset, data, length);
}

bool exec_run_begin(struct exec_run *run)
{
    struct sim_config config = {.nodes = {.count = 1, .node = {1}}, .device = run->device, .unit = run->config};
    if (run->flash_path) {
        config.flash = (struct sim_flash){flash_read, flash_erase, flash_program, run};
        if (!flash_file_open(&run->flash, run->flash_path, run->device->flash_name, run->device->flash_blocks,
                             run->device->flash_block_size)) {
            run->flash_path = NULL;
            return false;
        }
    }
    run->repeat = calloc(1, run->device->repeat_size + 1u);
    return run->repeat && sim_begin(&run->sim, &config);
}

bool exec_run_store(struct exec_run *run)
{
    sim_store(&run->sim);
    return !run->flash_path || flash_file_sync(&run->flash);
}

void exec_run_end(struct exec_run *run)
{
    free(run->repeat);
    sim_end(&run->sim);
    if (run->flash_path)
        flash_file_close(&run->flash);
}

struct device_unit *exec_run_unit(struct exec_run *run)
{
    return sim_core(&run->sim, 1);
}

bool exec_run_is_running(struct exec_run *run)
{
    bool running = false;
    struct device_axis axis;
    for (unsigned motor = 1; motor <= run->device->axes; motor++) {
        run->device->axis(exec_run_unit(run), motor, &axis);
        running = running || axis.running;
    }
    return running;
}

bool exec_run_set(struct exec_run *run, unsigned motor, const void *text, size_t length, const char *place)
{
    char error[DEVICE_ERROR_SIZE];
    int flag = run->device->set_text(exec_run_unit(run), motor, text, length, error);
    if (flag == DEVICE_TEXT_OVERFLOWS)
        fprintf(stderr, "%s: warning: more than the %u commands that a motor can hold\n", place, run->device->program);
    else if (flag != 0)
        fprintf(stderr, "%s: error: %s\n", place, error);
    run->refused = run->refused || (flag != 0 && flag != DEVICE_TEXT_OVERFLOWS);
    return flag == 0 || flag == DEVICE_TEXT_OVERFLOWS;
}

/* ---- Progress for a person who waits ------------------------------------------------------------------------------ */

static double seconds_since(const struct timespec *start)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - start->tv_sec) + (double)(now.tv_nsec - start->tv_nsec) * 1e-9;
}

static void progress_begin(struct progress *progress)
{
    *progress = (struct progress){.next = PROGRESS_AFTER};
    clock_gettime(CLOCK_MONOTONIC, &progress->start);
}

static void progress_update(struct progress *progress, const struct exec_run *run)
{
    if (!run->progress || ++progress->leaps % LEAPS_A_LOOK != 0)
        return;
    double real = seconds_since(&progress->start);
    if (real < progress->next)
        return;
    progress->next = real + PROGRESS_EVERY;
    progress->shown = true;
    double virtual = (double)sim_now(&run->sim) / US_PER_SECOND;
    fprintf(stderr, "\r%.1f s of the unit's time, %.0f times real time; Ctrl-C ends the run\033[K", virtual, virtual / real);
}

static void progress_end(const struct progress *progress)
{
    if (progress->shown)
        fputs("\r\033[K", stderr);
}

/* ---- The run ------------------------------------------------------------------------------------------------------ */

static void deliver_input(struct exec_run *run, const struct stimulus *s)
{
    uint32_t mask = run->device->inputs_of(exec_run_unit(run)), bit = UINT32_C(1) << (s->input - 1u);
    sim_set_di(&run->sim, 1, s->level ? mask | bit : mask & ~bit);
}

static void deliver_stimulus(struct exec_run *run, const struct stimulus *s)
{
    uint8_t answer[ANSWER_MAX];
    char place[PLACE_SIZE];
    size_t length;

    switch (s->kind) {
    case STIMULUS_INPUT:
        deliver_input(run, s);
        break;
    case STIMULUS_SET:
        snprintf(place, sizeof place, "%.400s:%zu:%zu", run->stimulus_name, s->line, s->column);
        exec_run_set(run, s->motor, s->data, s->length, place);
        break;
    case STIMULUS_MESSAGE:
        length = run->device->exchange ? run->device->exchange(exec_run_unit(run), s->data, s->length, answer, sizeof answer) : 0;
        run->answered(run->context, s->tick, s, answer, length < sizeof answer ? length : sizeof answer);
        break;
    }
    run->reached = s->tick;
}

/* First tick not to be done in the next leap: it ends with the slot in which something is due, or where something comes from
 * outside. DEVICE_NEVER: nothing is to be done. */
static uint64_t leap_end(struct exec_run *run, uint64_t stimulus)
{
    uint64_t end = sim_next_report(&run->sim);
    /* A motor continues without end: the state repeats from slot to slot. */
    if (run->open && end > run->until && exec_run_is_running(run))
        end = sim_next_event(&run->sim);
    if (end <= run->until)
        end = (end + run->device->slot - 1) / run->device->slot * run->device->slot + 1;
    if (stimulus < end)
        end = stimulus;
    return end == DEVICE_NEVER || end <= run->until ? end : run->until + 1;
}

static bool repeats(struct exec_run *run)
{
    if (run->device->repeat_size > 0)
        run->period = run->device->find_repeat(run->repeat, exec_run_unit(run));
    return run->period > 0;
}

static enum exec_end run_loop(struct exec_run *run, struct progress *progress)
{
    while (!interrupted) {
        uint64_t now = sim_now(&run->sim);
        bool left = run->next < run->stimuli->count;
        uint64_t stimulus = left ? run->stimuli->list[run->next].tick : DEVICE_NEVER;
        if (now > run->until)
            return EXEC_UNTIL;
        if (stimulus <= now) {
            deliver_stimulus(run, &run->stimuli->list[run->next++]);
            continue;
        }
        uint64_t end = leap_end(run, stimulus);
        if (end == DEVICE_NEVER)
            return EXEC_DONE;
        sim_advance(&run->sim, end);
        run->reached = end - 1;
        if (run->advanced != NULL)
            run->advanced(run->context);
        if (run->trace != NULL && trace_file_failed(run->trace) != 0)
            return EXEC_NO_TRACE;
        if (run->open && !left && repeats(run))
            return EXEC_ENDLESS;
        progress_update(progress, run);
    }
    return EXEC_INTERRUPTED;
}

enum exec_end exec_run(struct exec_run *run)
{
    struct progress progress;
    run->open = run->until == DEVICE_NEVER;
    if (run->until >= SIM_TIME_MAX)
        run->until = SIM_TIME_MAX - 1u;
    progress_begin(&progress);
    enum exec_end end = run_loop(run, &progress);
    progress_end(&progress);
    return end;
}
