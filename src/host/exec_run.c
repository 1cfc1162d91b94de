#include "exec_run.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define ANSWER_MAX 16384     /* the longest answer, a full memory, has 9101 bytes */
#define PROGRESS_AFTER 2.0   /* s of real time */
#define PROGRESS_EVERY 0.5   /* s */
#define LEAPS_A_LOOK 4096    /* leaps between two looks at the real clock */

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

/* ---- What the unit does ------------------------------------------------------------------------------------------ */

static void add_row(struct exec_run *run, uint64_t tick, unsigned motor, enum trace_event event, int32_t value)
{
    if (run->trace != NULL)
        trace_add(run->trace, tick, run->delivering ? TRACE_DELIVERED : TRACE_TURNS, motor, event, value);
}

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    struct exec_run *run = context;
    trace_add(run->trace, tick, TRACE_PULSES, motor, TRACE_STEP, position);
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    add_row(context, tick, motor, TRACE_DIRECTION, forward ? 1 : -1);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    add_row(context, tick, 0, TRACE_OUTPUTS, mask);
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    static const enum trace_event events[] = {
        [RKM04_EVENT_MOTION] = TRACE_MOTION,
        [RKM04_EVENT_COMMAND] = TRACE_COMMAND,
        [RKM04_EVENT_LED] = TRACE_LED,
        [RKM04_EVENT_VARIABLE] = TRACE_VARIABLES,
    };
    if (what != RKM04_EVENT_FAULT) /* a fault is seen in the final state */
        add_row(context, tick, motor, events[what], (int32_t)value);
}

static int on_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct exec_run *run = context;
    memcpy(data, &run->flash[block][offset], length);
    return 0;
}

static int on_flash_erase(void *context, unsigned block)
{
    struct exec_run *run = context;
    memset(run->flash[block], 0xFF, sizeof run->flash[block]);
    return 0;
}

static int on_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct exec_run *run = context;
    memcpy(&run->flash[block][offset], data, length);
    return 0;
}

static const struct rkm04_port traced_port = {
    .step = on_step,
    .direction = on_direction,
    .outputs = on_outputs,
    .event = on_event,
    .flash_read = on_flash_read,
    .flash_erase = on_flash_erase,
    .flash_program = on_flash_program,
};

static const struct rkm04_port quiet_port = {
    .flash_read = on_flash_read,
    .flash_erase = on_flash_erase,
    .flash_program = on_flash_program,
};

void exec_run_begin(struct exec_run *run)
{
    static const struct rkm04_config config = {.node = 1};
    run->reached = 0;
    run->next = 0;
    run->delivering = true;
    memset(run->flash, 0xFF, sizeof run->flash);
    rkm04_init(&run->unit, &config, run->trace != NULL ? &traced_port : &quiet_port, run);
}

int exec_run_set(struct exec_run *run, char motor, const void *text, size_t length)
{
    return rkm04_set_command(&run->unit, motor, text, length, NULL);
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

static void progress_look(struct progress *progress, const struct exec_run *run)
{
    if (!run->progress || ++progress->leaps % LEAPS_A_LOOK != 0)
        return;
    double real = seconds_since(&progress->start);
    if (real < progress->next)
        return;
    progress->next = real + PROGRESS_EVERY;
    progress->shown = true;
    double virtual = (double)rkm04_now(&run->unit) / RKM04_TICKS_PER_SECOND;
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
    uint8_t old = rkm04_inputs(&run->unit);
    uint8_t bit = (uint8_t)(1u << (s->input - 1));
    uint8_t mask = s->level ? (uint8_t)(old | bit) : (uint8_t)(old & ~bit);
    if (mask == old)
        return;
    add_row(run, s->tick, 0, TRACE_INPUTS, mask);
    rkm04_set_inputs(&run->unit, mask);
}

static void deliver(struct exec_run *run, const struct stimulus *s)
{
    uint8_t answer[ANSWER_MAX];
    size_t length;

    run->delivering = true;
    switch (s->kind) {
    case STIMULUS_INPUT:
        deliver_input(run, s);
        break;
    case STIMULUS_SET:
        if (exec_run_set(run, s->motor, s->data, s->length) == 3)
            fprintf(stderr, "%s:%zu:%zu: warning: more commands than the %d a motor has room for\n", run->stimulus_name,
                    s->line, s->column, RKM04_PROGRAM_MAX);
        break;
    case STIMULUS_MESSAGE:
        length = rkm04_exchange(&run->unit, s->data, s->length, answer, sizeof answer);
        run->answered(run->context, s->tick, s, answer, length < sizeof answer ? length : sizeof answer);
        break;
    }
    run->delivering = false;
    run->reached = s->tick;
}

/* First tick not to be done in the next leap: it ends with the slot in which something is due, so that the trace need
 * not put more than a slot in order, and sooner where something comes from outside. RKM04_NEVER: nothing is to be done. */
static uint64_t leap_end(const struct exec_run *run, uint64_t stimulus)
{
    uint64_t end = rkm04_next_event(&run->unit);
    if (end != RKM04_NEVER)
        end = (end + RKM04_SLOT_TICKS - 1) / RKM04_SLOT_TICKS * RKM04_SLOT_TICKS + 1;
    if (stimulus < end)
        end = stimulus;
    if (end != RKM04_NEVER && run->until != RKM04_NEVER && end > run->until + 1)
        end = run->until + 1;
    return end;
}

static enum exec_end run_loop(struct exec_run *run, struct progress *progress)
{
    while (!interrupted) {
        uint64_t now = rkm04_now(&run->unit);
        bool left = run->next < run->stimuli->count;
        uint64_t stimulus = left ? run->stimuli->list[run->next].tick : RKM04_NEVER;
        if (run->until != RKM04_NEVER && now > run->until)
            return EXEC_UNTIL;
        if (stimulus <= now) {
            deliver(run, &run->stimuli->list[run->next++]);
            continue;
        }
        uint64_t end = leap_end(run, stimulus);
        if (end == RKM04_NEVER)
            return EXEC_DONE;
        rkm04_advance(&run->unit, end - now);
        run->reached = end - 1;
        if (run->trace != NULL) {
            trace_write_before(run->trace, end);
            if (run->trace->failed)
                return EXEC_NO_TRACE;
        }
        progress_look(progress, run);
    }
    return EXEC_INTERRUPTED;
}

enum exec_end exec_run(struct exec_run *run)
{
    struct progress progress;
    run->delivering = false;
    progress_begin(&progress);
    enum exec_end end = run_loop(run, &progress);
    progress_end(&progress);
    return end;
}
