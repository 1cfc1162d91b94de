/* SPDX-License-Identifier: MIT */
#include "condition.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "condition_term.h"

/* ---- What there is -------------------------------------------------------------------------------------------------- */

static bool is_idle(struct sim *sim, unsigned unit, unsigned motor)
{
    if (motor != 0)
        return sim_axis(sim, unit, motor).idle;
    for (motor = 1; motor <= sim_device(sim)->axes; motor++) {
        if (!sim_axis(sim, unit, motor).idle)
            return false;
    }
    return true;
}

static int64_t motor_value(const struct term *term, struct sim *sim)
{
    const struct device_axis state = sim_axis(sim, term->unit, term->motor);
    int64_t true_position;
    const struct plant *plant = sim->unit[term->unit - 1].plant;
    switch ((enum term_kind)term->kind) {
    case TERM_TRUE_POSITION:
        if (plant != NULL && plant_position(plant, term->motor, &true_position))
            return true_position;
        return state.position;
    case TERM_STEPS:
        return state.steps;
    case TERM_INDEX:
        return state.index;
    case TERM_COMMANDS:
        return state.commands;
    case TERM_STATE:
        return state.state;
    case TERM_LED:
        return state.led;
    case TERM_FAULT:
        return state.fault;
    default:
        return state.position;
    }
}

static int64_t term_value(const struct term *term, struct sim *sim)
{
    switch ((enum term_kind)term->kind) {
    case TERM_TIME:
        return (int64_t)sim_now(sim);
    case TERM_IDLE:
        return is_idle(sim, term->unit, term->motor);
    case TERM_INPUT:
        return sim_device(sim)->inputs_of(sim_core(sim, term->unit)) >> (term->number - 1) & 1;
    case TERM_OUTPUT:
        return sim_device(sim)->outputs_of(sim_core(sim, term->unit)) >> (term->number - 1) & 1;
    case TERM_VARIABLE:
        return sim_device(sim)->variables_of(sim_core(sim, term->unit)) >> (term->number - sim_device(sim)->first_variable) & 1;
    case TERM_POWERED:
        return sim_powered(sim, term->unit);
    case TERM_CELL:
        return sim_device(sim)->cell(sim_core(sim, term->unit), term->cell);
    default:
        return motor_value(term, sim);
    }
}

bool term_compares(int64_t is, enum term_relation relation, int64_t wanted)
{
    switch (relation) {
    case TERM_EQUAL:
        return is == wanted;
    case TERM_UNEQUAL:
        return is != wanted;
    case TERM_LESS:
        return is < wanted;
    case TERM_LESS_EQUAL:
        return is <= wanted;
    case TERM_GREATER:
        return is > wanted;
    default:
        return is >= wanted;
    }
}

static bool term_holds(const struct term *term, struct sim *sim)
{
    if (term->kind == TERM_MESSAGE)
        return term->message.seen;
    if (term->kind != TERM_ALL && term->kind != TERM_ANY)
        return term_compares(term_value(term, sim), (enum term_relation)term->relation, term->value);
    bool any = term->kind == TERM_ANY;
    for (size_t i = 0; i < term->subs; i++) {
        if (term_holds(&term->sub[i], sim) == any)
            return any;
    }
    return !any;
}

bool condition_holds(struct condition *condition)
{
    return term_holds(&condition->root, condition->sim);
}

/* ---- Messages ------------------------------------------------------------------------------------------------------- */

static bool matches_message(const struct term_message *wanted, const struct wire_message *message)
{
    if (wanted->dropped != (message->dropped != NULL))
        return false;
    if (wanted->from == 0 && message->answer)
        return false;
    if (wanted->from == TERM_ANY_UNIT && !message->answer)
        return false;
    if (wanted->from > 0 && wanted->from != TERM_ANY_UNIT && (message->senders >> wanted->from & 1) == 0)
        return false;
    if (wanted->number >= 0 && (message->length < 1 || message->message[0] != wanted->number))
        return false;
    return wanted->motor < 0 || (message->length >= 2 && message->message[1] == wanted->motor);
}

static void note_message(struct term *term, const struct wire_message *message)
{
    if (term->kind == TERM_MESSAGE && matches_message(&term->message, message))
        term->message.seen = true;
    for (size_t i = 0; i < term->subs; i++)
        note_message(&term->sub[i], message);
}

static void on_event(void *context, const struct watch_event *event)
{
    struct condition *condition = context;
    note_message(&condition->root, event->message);
}

static void clear_seen(struct term *term)
{
    term->message.seen = false;
    for (size_t i = 0; i < term->subs; i++)
        clear_seen(&term->sub[i]);
}

void condition_arm(struct condition *condition)
{
    clear_seen(&condition->root);
    if (!condition->messages || condition->armed)
        return;
    condition->armed = true;
    condition->watcher = (struct watcher){.kinds = WATCH_BIT(WATCH_MESSAGE), .on_event = on_event, .context = condition};
    sim_watch(condition->sim, &condition->watcher);
}

void condition_free(struct condition *condition)
{
    if (condition == NULL)
        return;
    if (condition->armed)
        sim_unwatch(condition->sim, &condition->watcher);
    term_clear(&condition->root);
    free(condition);
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

/* The next tick, of those after `now`, from which a term about time may turn out otherwise. */
static uint64_t next_time(const struct term *term, uint64_t now)
{
    uint64_t next = DEVICE_NEVER;
    if (term->kind == TERM_TIME && term->value >= 0) {
        uint64_t at = (uint64_t)term->value;
        if (at > now)
            next = at;
        else if (at == now) /* it is no longer equal, no longer less or equal, but greater */
            next = now + 1;
    }
    for (size_t i = 0; i < term->subs; i++) {
        uint64_t sub = next_time(&term->sub[i], now);
        next = sub < next ? sub : next;
    }
    return next;
}

/* Does a term ask for anything but time? */
static bool depends_on_units(const struct term *term)
{
    if (term->kind != TERM_ALL && term->kind != TERM_ANY)
        return term->kind != TERM_TIME;
    for (size_t i = 0; i < term->subs; i++) {
        if (depends_on_units(&term->sub[i]))
            return true;
    }
    return false;
}

/* Cells may change in each slot, also while nothing else happens: when the next slot of a unit with a cell is over. */
static uint64_t next_slot(const struct term *term, const struct sim *sim)
{
    uint64_t next = DEVICE_NEVER;
    if (term->kind == TERM_CELL) {
        const uint64_t since = segment_since(&sim->segment, term->unit), slot = sim_device(sim)->slot;
        next = since + (sim_now(sim) - since + slot - 1u) / slot * slot + 1u;
    }
    for (size_t i = 0; i < term->subs; i++) {
        uint64_t sub = next_slot(&term->sub[i], sim);
        next = sub < next ? sub : next;
    }
    return next;
}

uint64_t condition_next(const struct condition *condition)
{
    struct sim *sim = condition->sim;
    uint64_t now = sim_now(sim), next = next_time(&condition->root, now);
    if (!depends_on_units(&condition->root))
        return next;
    uint64_t event = sim_next_event(sim), due = sim_due(sim);
    if (event != DEVICE_NEVER && event + 1 < next)
        next = event + 1; /* it is over then */
    if (due < next)
        next = due > now ? due : now + 1;
    uint64_t slot = next_slot(&condition->root, sim);
    next = slot < next ? slot : next;
    if (condition->messages && sim->watch.count > 0) /* a message of this tick is handed out when the tick is over */
        next = now + 1;
    return next > now ? next : now + 1;
}

bool condition_step(struct condition *condition, uint64_t limit)
{
    uint64_t next = condition_next(condition);
    if (next > limit)
        next = limit;
    if (next != DEVICE_NEVER && next > sim_now(condition->sim))
        sim_advance(condition->sim, next);
    return condition_holds(condition);
}

bool condition_run(struct condition *condition, uint64_t limit)
{
    bool held = condition_holds(condition);
    while (!held && sim_now(condition->sim) < limit) {
        if ((limit == DEVICE_NEVER && condition_next(condition) == DEVICE_NEVER) || sim_time_is_over(condition->sim))
            break; /* nothing will ever happen */
        held = condition_step(condition, limit);
    }
    return held;
}

/* ---- For people ----------------------------------------------------------------------------------------------------- */

static const char *term_name(enum term_kind kind)
{
    static const char *const names[] = {
        [TERM_TIME] = "t", [TERM_POSITION] = "position", [TERM_TRUE_POSITION] = "true position", [TERM_STEPS] = "steps",
        [TERM_INDEX] = "index", [TERM_COMMANDS] = "commands", [TERM_STATE] = "state", [TERM_LED] = "led",
        [TERM_FAULT] = "fault", [TERM_IDLE] = "idle", [TERM_INPUT] = "DI", [TERM_OUTPUT] = "DO", [TERM_VARIABLE] = "VAR",
        [TERM_POWERED] = "powered", [TERM_CELL] = "cell",
    };
    return names[kind];
}

static void print_value(FILE *out, const struct term *term, const struct sim *sim, int64_t number)
{
    switch ((enum term_kind)term->kind) {
    case TERM_TIME:
        fprintf(out, "%" PRId64 ".%06" PRId64 " s", number / US_PER_SECOND, number % US_PER_SECOND);
        break;
    case TERM_STATE:
        fputs(sim_device(sim)->state_name((unsigned)number), out);
        break;
    case TERM_LED:
        fputs(sim_device(sim)->led_name((unsigned)number), out);
        break;
    case TERM_FAULT:
        fputs(sim_device(sim)->fault_name((unsigned)number), out);
        break;
    case TERM_IDLE:
    case TERM_POWERED:
        fputs(number != 0 ? "true" : "false", out);
        break;
    default:
        fprintf(out, "%" PRId64, number);
    }
}

enum part { PART_WANTED, PART_FOUND, PART_BOTH };

static void print_message(FILE *out, const struct term_message *message, struct sim *sim, enum part part)
{
    fputs(message->dropped ? "a dropped message" : "a message", out);
    if (message->number >= 0)
        fprintf(out, " %d", message->number);
    if (message->motor >= 0)
        fprintf(out, " for motor %c", message->motor);
    if (message->from == 0)
        fputs(" from the host", out);
    else if (message->from == TERM_ANY_UNIT)
        fputs(" from a unit", out);
    else if (message->from > 0)
        fprintf(out, " from unit %s", sim->unit[message->from - 1].name);
    if (part != PART_WANTED)
        fputs(message->seen ? " (one has passed)" : " (none has passed)", out);
}

/* Its name, or its number where it has none. */
static void print_bit(FILE *out, const struct term *term, const struct device_kind *device)
{
    const char *const *names = term->kind == TERM_INPUT    ? device->input_names
                               : term->kind == TERM_OUTPUT ? device->output_names
                                                           : NULL;
    if (names)
        fprintf(out, " %s", names[term->number - 1]);
    else
        fprintf(out, " %02u", term->number);
}

static void print_term(FILE *out, const struct term *term, struct sim *sim, enum part part)
{
    bool bit = term->kind == TERM_INPUT || term->kind == TERM_OUTPUT || term->kind == TERM_VARIABLE;
    if (term->kind == TERM_MESSAGE) {
        print_message(out, &term->message, sim, part);
        return;
    }
    if (term->unit != 0 && sim_units(sim) > 1)
        fprintf(out, "unit %s ", sim->unit[term->unit - 1].name);
    if (term->motor != 0)
        fprintf(out, "motor %u ", term->motor);
    fputs(term_name((enum term_kind)term->kind), out);
    if (bit)
        print_bit(out, term, sim_device(sim));
    if (term->kind == TERM_CELL)
        fprintf(out, " %s", term->cell_name);
    fputc(' ', out);
    if (part == PART_FOUND) {
        print_value(out, term, sim, term_value(term, sim));
        return;
    }
    fprintf(out, "%s ", term_relation_name((enum term_relation)term->relation));
    print_value(out, term, sim, term->value);
    if (part == PART_WANTED)
        return;
    fputs(" (is ", out);
    print_value(out, term, sim, term_value(term, sim));
    fputc(')', out);
}

/* Do both ask for the same number, as in {">=": 1, "<": 9}? */
static bool has_same_subject(const struct term *left, const struct term *right)
{
    return left->kind == right->kind && left->unit == right->unit && left->motor == right->motor &&
           left->number == right->number && left->cell == right->cell &&
           left->subs == 0 && right->subs == 0 && left->kind != TERM_MESSAGE;
}

/* What is found is a list; what is wanted has its structure. */
static void print_terms(FILE *out, const struct term *term, struct sim *sim, enum part part, bool inside)
{
    if (term->kind != TERM_ALL && term->kind != TERM_ANY) {
        print_term(out, term, sim, part);
        return;
    }
    bool brackets = inside && term->subs > 1 && part != PART_FOUND;
    const char *between = part == PART_FOUND ? ", " : term->kind == TERM_ANY ? " or " : " and ";
    if (brackets)
        fputc('(', out);
    for (size_t i = 0; i < term->subs; i++) {
        if (part == PART_FOUND && i > 0 && has_same_subject(&term->sub[i - 1], &term->sub[i]))
            continue;
        if (i > 0)
            fputs(between, out);
        print_terms(out, &term->sub[i], sim, part, inside || term->subs > 1);
    }
    if (brackets)
        fputc(')', out);
}

static char *print_to_text(struct condition *condition, enum part part)
{
    char *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    if (out == NULL)
        return NULL;
    print_terms(out, &condition->root, condition->sim, part, false);
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

char *condition_text(struct condition *condition)
{
    return print_to_text(condition, PART_BOTH);
}

char *condition_wanted_text(struct condition *condition)
{
    return print_to_text(condition, PART_WANTED);
}

char *condition_found_text(struct condition *condition)
{
    return print_to_text(condition, PART_FOUND);
}
