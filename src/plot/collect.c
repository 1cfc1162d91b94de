/* SPDX-License-Identifier: MIT */
/* The planned speed is asked of the unit after everything that may have changed it, and what was planned before is cut off there:
 * so the curve is exact, however short an interval between two pulses is. */
#include "collect.h"

#include <math.h>
#include <string.h>

#define SPEED_ALIKE 1e-4 /* steps/s */
#define TRUTHS 4000u /* true positions kept of a motor: beyond, every other one is dropped */

static const struct device_kind *kind_of(const struct collector *collector)
{
    return sim_device(collector->sim);
}

/* ---- A look ----------------------------------------------------------------------------------------------------------- */

/* The first leg of a plan, in us of the bus. */
struct leg {
    double us, speed, position, slope; /* steps/s, steps/s a us */
};

static struct leg leg_of(const struct device_plan_point *point, size_t count, double since)
{
    struct leg leg = {since + point[0].us, point[0].speed, point[0].position, 0};
    if (count > 1 && point[1].us > point[0].us)
        leg.slope = (point[1].speed - point[0].speed) / (point[1].us - point[0].us);
    return leg;
}

/* Where the leg was at `us`, a moment before. */
static struct plot_point point_before(const struct leg *leg, double us)
{
    double past = leg->us - us, speed = leg->speed - leg->slope * past;
    return (struct plot_point){us, speed, leg->position - (leg->speed + speed) / 2 * past * 1e-6};
}

/* The motion began at `us`, a moment before the plan was read. */
static void add_begin(struct collector *collector, struct plot_motor *motor, double us, const struct leg *leg)
{
    struct plot_point first = point_before(leg, us), rest = {us, 0, first.position};
    plot_cut(collector->curves, motor, us);
    plot_add_point(collector->curves, motor, rest);
    plot_add_point(collector->curves, motor, first);
}

/* The plan is another one than before, and has been since a moment before the look: where the two speeds meet. */
static void add_turn(struct collector *collector, struct plot_motor *motor, const struct leg *leg)
{
    struct plot_point old = plot_point_at(motor, leg->us), before = plot_point_at(motor, leg->us - 1);
    double apart = leg->speed - old.speed, turn = leg->slope - (old.speed - before.speed);
    double past = turn != 0 ? apart / turn : 0;
    if (past <= 0 || past > 2.0 * kind_of(collector)->slot)
        return;
    plot_cut(collector->curves, motor, leg->us - past);
    plot_add_point(collector->curves, motor, point_before(leg, leg->us - past));
}

static void add_planned_points(struct collector *collector, unsigned axis, double now)
{
    struct plot_motor *motor = &collector->curves->motor[axis - 1];
    struct device_plan_point point[DEVICE_PLAN_POINTS];
    const struct device_kind *kind = kind_of(collector);
    double since = (double)segment_since(&collector->sim->segment, collector->unit);
    const struct device_unit *unit = sim_core(collector->sim, collector->unit);
    size_t count = kind->plan == NULL ? 0 : kind->plan(unit, axis, point, DEVICE_PLAN_POINTS);
    double *begin = &collector->begin[axis - 1];
    if (count > 0) {
        struct leg leg = leg_of(point, count, since);
        if (*begin >= 0)
            add_begin(collector, motor, *begin, &leg);
        else if (fabs(leg.speed - plot_point_at(motor, leg.us).speed) > SPEED_ALIKE)
            add_turn(collector, motor, &leg);
    }
    *begin = -1;
    plot_cut(collector->curves, motor, now);
    if (count == 0)
        plot_add_point(collector->curves, motor,
                       (struct plot_point){now, 0, (double)sim_axis(collector->sim, collector->unit, axis).position});
    for (size_t i = 0; i < count; i++)
        plot_add_point(collector->curves, motor, (struct plot_point){since + point[i].us, point[i].speed, point[i].position});
}

static void note_state(struct collector *collector, unsigned axis, double now)
{
    const struct device_kind *kind = kind_of(collector);
    const struct device_axis state = sim_axis(collector->sim, collector->unit, axis);
    const char *name = kind->state_name(state.state);
    char text[DEVICE_COMMAND_SIZE + 1] = "";
    if (state.fault != 0)
        name = kind->fault_name(state.fault);
    else if (state.moving || state.idle || strcmp(name, "ready") == 0 || strcmp(name, "moving") == 0)
        name = NULL;
    if (name != NULL && kind->command_text != NULL)
        text[kind->command_text(sim_core(collector->sim, collector->unit), axis, text)] = '\0';
    plot_mark_state(collector->curves, &collector->curves->motor[axis - 1], now, name, text);
}

/* Every other one is enough when there are many. */
static void thin_truths(struct collector *collector, struct plot_motor *motor)
{
    size_t kept = 0;
    for (size_t i = 0; i < motor->truths; i += 2)
        motor->truth[kept++] = motor->truth[i];
    motor->truths = kept;
    collector->truth_every *= 2;
}

static void add_true_position(struct collector *collector, unsigned axis, double now)
{
    struct plot_motor *motor = &collector->curves->motor[axis - 1];
    const struct plant *plant = collector->sim->unit[collector->unit - 1].plant;
    int64_t position;
    if (plant == NULL || !plant_position(plant, axis, &position))
        return;
    if (motor->truths > 0 && now < motor->truth[motor->truths - 1].us + collector->truth_every)
        return;
    if (motor->truths >= TRUTHS)
        thin_truths(collector, motor);
    struct plot_point *truth = plot_grow_list(collector->curves, motor->truth, motor->truths, &motor->truths_room, sizeof *truth);
    if (truth == NULL)
        return;
    motor->truth = truth;
    motor->truth[motor->truths++] = (struct plot_point){now, 0, (double)position};
}

void collector_update(struct collector *collector)
{
    double now = (double)sim_now(collector->sim);
    collector->looked = sim_now(collector->sim);
    if (!sim_powered(collector->sim, collector->unit))
        return;
    for (unsigned axis = 1; axis <= collector->curves->motors; axis++) {
        add_planned_points(collector, axis, now);
        note_state(collector, axis, now);
        add_true_position(collector, axis, now);
    }
}

/* ---- Watching --------------------------------------------------------------------------------------------------------- */

static void keep_event(struct collector *collector, const struct watch_event *event)
{
    struct plot_curves *curves = collector->curves;
    double us = (double)event->tick;
    if (event->motor > curves->motors)
        return;
    struct plot_motor *motor = event->motor == 0 ? NULL : &curves->motor[event->motor - 1];
    switch ((enum watch_kind)event->kind) {
    case WATCH_MOTION:
        plot_mark_motion(curves, motor, us, event->value != 0);
        if (event->value != 0)
            collector->begin[event->motor - 1] = us;
        break;
    case WATCH_INPUTS:
        plot_add_level(curves, PLOT_INPUTS, us, (uint32_t)event->value);
        break;
    case WATCH_OUTPUTS:
        plot_add_level(curves, PLOT_OUTPUTS, us, (uint32_t)event->value);
        break;
    case WATCH_VARIABLES:
        plot_add_level(curves, PLOT_VARIABLES, us, (uint32_t)event->value);
        break;
    default:
        break;
    }
}

static void on_event(void *context, const struct watch_event *event)
{
    struct collector *collector = context;
    if (event->unit == collector->unit)
        keep_event(collector, event);
}

/* The same for a caller that cannot read after each advance: pulses are wanted so that events come with their slot. */
static void on_event_and_update(void *context, const struct watch_event *event)
{
    struct collector *collector = context;
    on_event(context, event);
    if (event->unit == collector->unit && sim_now(collector->sim) > collector->looked)
        collector_update(collector);
}

static void begin_levels(struct collector *collector)
{
    const struct device_kind *kind = kind_of(collector);
    const struct device_unit *unit = sim_core(collector->sim, collector->unit);
    double now = (double)sim_now(collector->sim);
    collector->curves->mask[PLOT_INPUTS].first = collector->curves->mask[PLOT_OUTPUTS].first = 1;
    collector->curves->mask[PLOT_VARIABLES].first = kind->first_variable;
    plot_add_level(collector->curves, PLOT_INPUTS, now, kind->inputs_of(unit));
    plot_add_level(collector->curves, PLOT_OUTPUTS, now, kind->outputs_of(unit));
    plot_add_level(collector->curves, PLOT_VARIABLES, now, kind->variables_of(unit));
}

void collector_begin(struct collector *collector, struct plot_curves *curves, struct sim *sim, unsigned unit, bool follow)
{
    *collector = (struct collector){.curves = curves, .sim = sim, .unit = unit};
    curves->motors = sim_device(sim)->axes;
    for (unsigned i = 0; i < PLOT_MOTORS; i++)
        collector->begin[i] = -1;
    begin_levels(collector);
    collector->watcher.kinds = WATCH_BIT(WATCH_MOTION) | WATCH_BIT(WATCH_INPUTS) | WATCH_BIT(WATCH_OUTPUTS) |
                               WATCH_BIT(WATCH_VARIABLES) | WATCH_BIT(WATCH_COMMAND) | WATCH_BIT(WATCH_POSITION);
    if (follow)
        collector->watcher.kinds |= WATCH_BIT(WATCH_STEP);
    collector->watcher.on_event = follow ? on_event_and_update : on_event;
    collector->watcher.context = collector;
    sim_watch(sim, &collector->watcher);
    collector_update(collector);
}

void collector_end(struct collector *collector)
{
    struct plot_curves *curves = collector->curves;
    double us = (double)sim_now(collector->sim);
    sim_unwatch(collector->sim, &collector->watcher);
    collector_update(collector);
    curves->end = us;
    for (unsigned i = 0; i < curves->motors; i++) {
        struct plot_motor *motor = &curves->motor[i];
        plot_cut(curves, motor, us);
        plot_mark_motion(curves, motor, us, false);
        plot_mark_state(curves, motor, us, NULL, "");
        motor->is_used = motor->motions > 0 || motor->bands > 0;
    }
}
