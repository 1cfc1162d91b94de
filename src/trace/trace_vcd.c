/* SPDX-License-Identifier: MIT */
/* Value change dump (IEEE 1364) for GTKWave and PulseView, in us, or in ns if the device counts finer. Every signal has a name
 * of its own, as some readers drop the scopes, and what people want to see in PulseView is a single bit, as it reads nothing
 * else.
 *
 * step is 1 for the 10 us of a pulse (R7); led is bright or dark, so a blinking one blinks; speed is what a counter of pulses
 * shows that is read at the first pulse after each millisecond, hence 0 until there is one. No date: two runs of the same
 * session give the same file (K1). */
#include "text/text.h"
#include "trace_writer.h"

#define BLINK (US_PER_SECOND / 2u)          /* us bright, then dark (U6) */
#define GATE 1000u                          /* us: shortest time over which a speed is taken */
#define FALLS 256u                          /* pulses that may be under way: one a motor is less; a power of 2 */
#define CHANGE_MAX 64u                      /* characters of one change: a time and a number are 40 */
#define ID_BASE 94u                         /* characters of an identifier: ! to ~ */

enum motor_signal { STEP, DIRECTION, LED, MOVING, COMMAND, SPEED, POSITION, MOTOR_SIGNALS };
/* Where the signals of a unit begin, counted from its first one, which is `power`. */
struct vcd_places {
    unsigned inputs, outputs, variables, values, motors, count;
};

struct vcd_motor {
    bool step, forward, lit, moving, counting;
    int32_t command, position;
    uint32_t pulses;  /* since `gate`, while `counting` */
    uint64_t speed;   /* 1/1000 steps/s */
    uint64_t gate;
    uint64_t fall;    /* tick at which the pulse ends */
    uint64_t toggle;  /* of the blinking LED; DEVICE_NEVER: it does not */
};

struct vcd_unit {
    bool power;
    uint32_t inputs, outputs, variables;
    int32_t value[DEVICE_VALUES_MAX];
    struct vcd_motor motor[DEVICE_AXES_MAX];
};

/* Times are in units of the file. */
struct vcd {
    struct vcd_places place;
    unsigned scale;  /* of these units make 1 us */
    uint64_t tick;   /* that has been written */
    uint64_t toggle; /* the next one of all LEDs; DEVICE_NEVER: none */
    unsigned first, falls;
    struct {
        uint64_t tick;
        uint8_t unit, motor;
    } fall[FALLS]; /* in order of time */
    struct vcd_unit unit[SEGMENT_UNITS];
};

/* The time of an event in units of the file. */
static uint64_t time_of(const struct trace_file *file, const struct watch_event *event)
{
    const struct vcd *vcd = file->state;
    return vcd->scale == 1 ? event->tick : event->tick * vcd->scale + watch_ns(event);
}

static uint64_t time_now(const struct trace_file *file)
{
    const struct vcd *vcd = file->state;
    return sim_now(file->sim) * vcd->scale;
}

/* ---- Writing -------------------------------------------------------------------------------------------------------- */

static unsigned first_signal_of(const struct trace_file *file, unsigned unit)
{
    const struct vcd *vcd = file->state;
    return (unit - 1u) * vcd->place.count;
}

static unsigned signal_of(const struct trace_file *file, unsigned unit, unsigned motor, enum motor_signal signal)
{
    const struct vcd *vcd = file->state;
    return first_signal_of(file, unit) + vcd->place.motors + (motor - 1u) * MOTOR_SIGNALS + signal;
}

static char *put_id(char *at, unsigned signal)
{
    if (signal >= ID_BASE)
        *at++ = (char)('!' + signal / ID_BASE - 1u);
    *at++ = (char)('!' + signal % ID_BASE);
    return at;
}

static void write_time(struct trace_file *file, uint64_t tick)
{
    struct vcd *vcd = file->state;
    if (tick <= vcd->tick)
        return;
    char *at = trace_room(file, CHANGE_MAX);
    *at++ = '#';
    at = put_number(at, tick);
    *at++ = '\n';
    trace_wrote(file, at);
    vcd->tick = tick;
}

static void write_bit(struct trace_file *file, unsigned signal, bool level)
{
    char *at = trace_room(file, CHANGE_MAX);
    *at++ = level ? '1' : '0';
    at = put_id(at, signal);
    *at++ = '\n';
    trace_wrote(file, at);
}

static void write_real(struct trace_file *file, unsigned signal, int32_t whole, uint32_t thousandths)
{
    char *at = trace_room(file, CHANGE_MAX);
    *at++ = 'r';
    at = put_signed(at, whole);
    if (thousandths > 0) {
        *at++ = '.';
        for (uint32_t place = 100; thousandths > 0; place /= 10) {
            *at++ = (char)('0' + thousandths / place);
            thousandths %= place;
        }
    }
    *at++ = ' ';
    at = put_id(at, signal);
    *at++ = '\n';
    trace_wrote(file, at);
}

static void write_speed(struct trace_file *file, unsigned unit, unsigned motor, uint64_t speed)
{
    write_real(file, signal_of(file, unit, motor, SPEED), (int32_t)(speed / 1000u), (uint32_t)(speed % 1000u));
}

static void write_mask(struct trace_file *file, unsigned first, uint32_t mask, uint32_t changed)
{
    for (unsigned bit = 0; bit < 32u && changed >> bit != 0; bit++)
        if ((changed >> bit & 1u) != 0)
            write_bit(file, first + bit, (mask >> bit & 1u) != 0);
}

/* ---- What follows of itself: pulses end, LEDs blink ----------------------------------------------------------------- */

static struct vcd_motor *motor_of(struct vcd *vcd, unsigned unit, unsigned motor)
{
    return &vcd->unit[unit - 1u].motor[motor - 1u];
}

static void end_first_pulse(struct trace_file *file)
{
    struct vcd *vcd = file->state;
    unsigned unit = vcd->fall[vcd->first].unit, motor = vcd->fall[vcd->first].motor;
    struct vcd_motor *state = motor_of(vcd, unit, motor);
    uint64_t tick = vcd->fall[vcd->first].tick;
    vcd->first = (vcd->first + 1u) % FALLS;
    vcd->falls--;
    if (!state->step || state->fall != tick)
        return; /* cut off, or another one has begun */
    write_time(file, tick);
    state->step = false;
    write_bit(file, signal_of(file, unit, motor, STEP), false);
}

static void find_toggle(const struct trace_file *file)
{
    struct vcd *vcd = file->state;
    vcd->toggle = DEVICE_NEVER;
    for (unsigned unit = 1; unit <= sim_units(file->sim); unit++)
        for (unsigned motor = 1; motor <= sim_device(file->sim)->axes; motor++)
            if (motor_of(vcd, unit, motor)->toggle < vcd->toggle)
                vcd->toggle = motor_of(vcd, unit, motor)->toggle;
}

static void toggle_leds(struct trace_file *file)
{
    struct vcd *vcd = file->state;
    uint64_t tick = vcd->toggle;
    write_time(file, tick);
    for (unsigned unit = 1; unit <= sim_units(file->sim); unit++) {
        for (unsigned motor = 1; motor <= sim_device(file->sim)->axes; motor++) {
            struct vcd_motor *state = motor_of(vcd, unit, motor);
            if (state->toggle != tick)
                continue;
            state->lit = !state->lit;
            state->toggle += BLINK * vcd->scale;
            write_bit(file, signal_of(file, unit, motor, LED), state->lit);
        }
    }
    find_toggle(file);
}

/* Write what changes up to `tick`, this one included, and the time. */
static void advance_time(struct trace_file *file, uint64_t tick)
{
    const struct vcd *vcd = file->state;
    for (;;) {
        uint64_t fall = vcd->falls > 0 ? vcd->fall[vcd->first].tick : DEVICE_NEVER;
        if (fall > tick && vcd->toggle > tick)
            break;
        if (fall <= vcd->toggle)
            end_first_pulse(file);
        else
            toggle_leds(file);
    }
    write_time(file, tick);
}

/* ---- Events --------------------------------------------------------------------------------------------------------- */

static void set_speed(struct trace_file *file, const struct watch_event *event, struct vcd_motor *state, uint64_t speed)
{
    if (state->speed != speed)
        write_speed(file, event->unit, event->motor, speed);
    state->speed = speed;
}

/* Count the pulses of this motor from here on. */
static void start_speed_gate(struct vcd_motor *state, uint64_t tick)
{
    state->counting = true;
    state->gate = tick;
    state->pulses = 0;
}

/* After those that are not later: pulses of one device may differ in length. */
static void add_fall(struct vcd *vcd, const struct watch_event *event, uint64_t time)
{
    unsigned at = vcd->falls++;
    for (; at > 0 && vcd->fall[(vcd->first + at - 1u) % FALLS].tick > time; at--)
        vcd->fall[(vcd->first + at) % FALLS] = vcd->fall[(vcd->first + at - 1u) % FALLS];
    at = (vcd->first + at) % FALLS;
    vcd->fall[at].tick = time;
    vcd->fall[at].unit = event->unit;
    vcd->fall[at].motor = event->motor;
}

static void on_step(struct trace_file *file, const struct watch_event *event, struct vcd_motor *state)
{
    struct vcd *vcd = file->state;
    const uint64_t time = time_of(file, event);
    if (vcd->falls == FALLS)
        end_first_pulse(file);
    const uint64_t ns = event->pulse_ns > 0 ? event->pulse_ns : sim_device(file->sim)->pulse * UINT64_C(1000);
    state->fall = time + ns * vcd->scale / 1000u;
    add_fall(vcd, event, state->fall);
    if (!state->step)
        write_bit(file, signal_of(file, event->unit, event->motor, STEP), true);
    state->step = true;
    state->position = event->value;
    write_real(file, signal_of(file, event->unit, event->motor, POSITION), event->value, 0);
    if (!state->counting) {
        start_speed_gate(state, time);
        return;
    }
    state->pulses++;
    if (time - state->gate < GATE * vcd->scale)
        return;
    set_speed(file, event, state, state->pulses * UINT64_C(1000) * US_PER_SECOND * vcd->scale / (time - state->gate));
    start_speed_gate(state, time);
}

static void on_motion(struct trace_file *file, const struct watch_event *event, struct vcd_motor *state)
{
    bool moving = event->value != 0;
    if (state->moving != moving)
        write_bit(file, signal_of(file, event->unit, event->motor, MOVING), moving);
    state->moving = moving;
    start_speed_gate(state, time_of(file, event));
    state->counting = moving;
    set_speed(file, event, state, 0);
}

static void on_led(struct trace_file *file, const struct watch_event *event, struct vcd_motor *state)
{
    bool lit = event->value != DEVICE_LED_OFF;
    if (state->lit != lit)
        write_bit(file, signal_of(file, event->unit, event->motor, LED), lit);
    state->lit = lit;
    const struct vcd *vcd = file->state;
    state->toggle = event->value == DEVICE_LED_BLINK ? time_of(file, event) + BLINK * vcd->scale : DEVICE_NEVER;
    find_toggle(file);
}

static void on_motor_event(struct trace_file *file, const struct watch_event *event)
{
    struct vcd_motor *state = motor_of(file->state, event->unit, event->motor);
    switch ((enum watch_kind)event->kind) {
    case WATCH_STEP:
        on_step(file, event, state);
        break;
    case WATCH_MOTION:
        on_motion(file, event, state);
        break;
    case WATCH_LED:
        on_led(file, event, state);
        break;
    case WATCH_DIRECTION:
        state->forward = event->value != 0;
        write_bit(file, signal_of(file, event->unit, event->motor, DIRECTION), state->forward);
        break;
    case WATCH_POSITION:
        state->position = event->value;
        write_real(file, signal_of(file, event->unit, event->motor, POSITION), event->value, 0);
        break;
    case WATCH_COMMAND:
        state->command = event->value;
        write_real(file, signal_of(file, event->unit, event->motor, COMMAND), event->value, 0);
        break;
    default:
        break;
    }
}

static void write_unit(struct trace_file *file, unsigned unit);

/* Without power everything that comes from the unit is 0. */
static void on_power(struct trace_file *file, const struct watch_event *event)
{
    struct vcd *vcd = file->state;
    struct vcd_unit *unit = &vcd->unit[event->unit - 1u];
    uint32_t inputs = unit->inputs;
    if (event->value == 0) {
        *unit = (struct vcd_unit){.inputs = inputs};
        for (unsigned motor = 0; motor < DEVICE_AXES_MAX; motor++)
            unit->motor[motor].toggle = DEVICE_NEVER;
        find_toggle(file);
    }
    unit->power = event->value != 0;
    write_unit(file, event->unit);
}

static void on_masks(struct trace_file *file, const struct watch_event *event)
{
    struct vcd *vcd = file->state;
    struct vcd_unit *unit = &vcd->unit[event->unit - 1u];
    unsigned first = first_signal_of(file, event->unit);
    uint32_t mask = (uint32_t)event->value;
    if (event->kind == WATCH_INPUTS) {
        write_mask(file, first + vcd->place.inputs, mask, mask ^ unit->inputs);
        unit->inputs = mask;
    } else if (event->kind == WATCH_OUTPUTS) {
        write_mask(file, first + vcd->place.outputs, mask, mask ^ unit->outputs);
        unit->outputs = mask;
    } else {
        write_mask(file, first + vcd->place.variables, mask, mask ^ unit->variables);
        unit->variables = mask;
    }
}

static void on_value(struct trace_file *file, const struct watch_event *event)
{
    struct vcd *vcd = file->state;
    vcd->unit[event->unit - 1u].value[event->number - 1u] = event->value;
    write_real(file, first_signal_of(file, event->unit) + vcd->place.values + event->number - 1u, event->value, 0);
}

static void on_event(void *context, const struct watch_event *event)
{
    struct trace_file *file = context;
    advance_time(file, time_of(file, event));
    if (event->motor != 0)
        on_motor_event(file, event);
    else if (event->kind == WATCH_POWER)
        on_power(file, event);
    else if (event->kind == WATCH_VALUE)
        on_value(file, event);
    else
        on_masks(file, event);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

/* A signal in the head: `u3_m1_step` of unit 3 on a line with several, `m1_step` otherwise. */
static void declare_signal(struct trace_file *file, const char *type, const char *prefix, const char *name, unsigned signal)
{
    char *at = trace_room(file, 2u * CHANGE_MAX);
    at = put_text(put_text(at, "$var "), type);
    *at++ = ' ';
    at = put_id(at, signal);
    *at++ = ' ';
    at = put_text(put_text(at, prefix), name);
    trace_wrote(file, put_text(at, " $end\n"));
}

/* `names`: what they are called instead of NAME01, …; NULL: so. */
static void declare_bits(struct trace_file *file, const char *prefix, const char *name, const char *const *names,
                         unsigned count, unsigned number, unsigned signal)
{
    for (unsigned bit = 0; bit < count; bit++, number++) {
        if (names) {
            declare_signal(file, "wire 1", prefix, names[bit], signal + bit);
            continue;
        }
        char text[8], *at = put_text(text, name);
        *at++ = (char)('0' + number / 10u);
        *at++ = (char)('0' + number % 10u);
        *at = '\0';
        declare_signal(file, "wire 1", prefix, text, signal + bit);
    }
}

static void open_scope(struct trace_file *file, const char *name)
{
    char *at = put_text(trace_room(file, CHANGE_MAX), "$scope module ");
    trace_wrote(file, put_text(put_text(at, name), " $end\n"));
}

static void close_scope(struct trace_file *file)
{
    static const char text[] = "$upscope $end\n";
    trace_put(file, text, sizeof text - 1u);
}

static void declare_motor(struct trace_file *file, const char *unit_prefix, unsigned unit, unsigned motor)
{
    static const struct {
        const char *type, *name;
    } signals[MOTOR_SIGNALS] = {
        [STEP] = {"wire 1", "step"},       [DIRECTION] = {"wire 1", "dir"},    [LED] = {"wire 1", "led"},
        [MOVING] = {"wire 1", "moving"},   [COMMAND] = {"real 64", "command"}, [SPEED] = {"real 64", "speed"},
        [POSITION] = {"real 64", "position"},
    };
    char scope[4] = "m", prefix[NODE_NAME_SIZE + 8u], *at = put_text(prefix, unit_prefix);
    *put_number(scope + 1, motor) = '\0';
    memcpy(put_text(at, scope), "_", 2);
    open_scope(file, scope);
    for (unsigned signal = 0; signal < MOTOR_SIGNALS; signal++)
        declare_signal(file, signals[signal].type, prefix, signals[signal].name,
                       signal_of(file, unit, motor, (enum motor_signal)signal));
    close_scope(file);
}

static void declare_unit(struct trace_file *file, unsigned unit)
{
    const struct device_kind *kind = sim_device(file->sim);
    const struct vcd *vcd = file->state;
    char prefix[NODE_NAME_SIZE + 4u] = "";
    unsigned first = first_signal_of(file, unit);
    if (sim_units(file->sim) > 1) {
        char *at = prefix;
        *at++ = 'u';
        for (const char *name = file->sim->unit[unit - 1u].name; *name; name++)
            *at++ = *name == '-' ? '_' : *name; /* of "3-2" */
        *at = '\0';
        open_scope(file, prefix);
        memcpy(at, "_", 2);
    }
    declare_signal(file, "wire 1", prefix, "power", first);
    declare_bits(file, prefix, "di", kind->input_names, kind->inputs, 1, first + vcd->place.inputs);
    declare_bits(file, prefix, "do", kind->output_names, kind->outputs, 1, first + vcd->place.outputs);
    declare_bits(file, prefix, "var", NULL, kind->variables, kind->first_variable, first + vcd->place.variables);
    for (unsigned value = 0; value < kind->values; value++)
        declare_signal(file, "real 64", prefix, kind->value_names[value], first + vcd->place.values + value);
    for (unsigned motor = 1; motor <= sim_device(file->sim)->axes; motor++)
        declare_motor(file, prefix, unit, motor);
    if (sim_units(file->sim) > 1)
        close_scope(file);
}

/* A mask with so many bits. */
static uint32_t full_mask(unsigned bits)
{
    return bits > 0 ? UINT32_MAX >> (32u - bits) : 0;
}

/* All signals of a unit as they are. */
static void write_unit(struct trace_file *file, unsigned unit)
{
    const struct device_kind *kind = sim_device(file->sim);
    const struct vcd *vcd = file->state;
    const struct vcd_unit *state = &vcd->unit[unit - 1u];
    unsigned first = first_signal_of(file, unit);
    write_bit(file, first, state->power);
    write_mask(file, first + vcd->place.inputs, state->inputs, full_mask(kind->inputs));
    write_mask(file, first + vcd->place.outputs, state->outputs, full_mask(kind->outputs));
    write_mask(file, first + vcd->place.variables, state->variables, full_mask(kind->variables));
    for (unsigned value = 0; value < kind->values; value++)
        write_real(file, first + vcd->place.values + value, state->value[value], 0);
    for (unsigned number = 1; number <= sim_device(file->sim)->axes; number++) {
        const struct vcd_motor *motor = &state->motor[number - 1u];
        write_bit(file, signal_of(file, unit, number, STEP), motor->step);
        write_bit(file, signal_of(file, unit, number, DIRECTION), motor->forward);
        write_bit(file, signal_of(file, unit, number, LED), motor->lit);
        write_bit(file, signal_of(file, unit, number, MOVING), motor->moving);
        write_real(file, signal_of(file, unit, number, COMMAND), motor->command, 0);
        write_speed(file, unit, number, motor->speed);
        write_real(file, signal_of(file, unit, number, POSITION), motor->position, 0);
    }
}

static void read_motor_state(struct trace_file *file, unsigned unit, unsigned motor)
{
    struct vcd_motor *state = motor_of(file->state, unit, motor);
    if (!sim_powered(file->sim, unit))
        return;
    const struct device_axis now = sim_axis(file->sim, unit, motor);
    state->forward = now.forward;
    state->lit = now.lit;
    state->moving = now.moving;
    state->command = now.index;
    state->speed = now.speed * UINT64_C(1000);
    state->position = now.position;
    if (now.led != DEVICE_LED_BLINK)
        return;
    uint64_t from = segment_since(&file->sim->segment, unit) + now.blink_from;
    const struct vcd *vcd = file->state;
    state->toggle = (from + ((sim_now(file->sim) - from) / BLINK + 1u) * BLINK) * vcd->scale;
}

static void read_unit_state(struct trace_file *file, unsigned unit)
{
    const struct device_kind *kind = sim_device(file->sim);
    const struct device_unit *core = sim_core(file->sim, unit);
    struct vcd *vcd = file->state;
    struct vcd_unit *state = &vcd->unit[unit - 1u];
    state->power = sim_powered(file->sim, unit);
    state->inputs = kind->inputs_of(core);
    state->outputs = state->power ? kind->outputs_of(core) : 0;
    state->variables = state->power ? kind->variables_of(core) : 0;
    for (unsigned value = 0; value < kind->values; value++)
        state->value[value] = state->power ? kind->value(core, value + 1u) : 0;
    for (unsigned motor = 1; motor <= DEVICE_AXES_MAX; motor++)
        state->motor[motor - 1u].toggle = DEVICE_NEVER;
    for (unsigned motor = 1; motor <= kind->axes; motor++)
        read_motor_state(file, unit, motor);
}

static void find_places(struct vcd_places *place, const struct device_kind *kind)
{
    place->inputs = 1;
    place->outputs = place->inputs + kind->inputs;
    place->variables = place->outputs + kind->outputs;
    place->values = place->variables + kind->variables;
    place->motors = place->values + kind->values;
    place->count = place->motors + kind->axes * MOTOR_SIGNALS;
}

static void begin(struct trace_file *file)
{
    static const char heads[2][64] = {
        "$version rkm04 " RKM04_VERSION " $end\n$timescale 1 us $end\n",
        "$version rkm04 " RKM04_VERSION " $end\n$timescale 1 ns $end\n",
    };
    static const char end_of_head[] = "$enddefinitions $end\n#";
    struct vcd *vcd = file->state;
    find_places(&vcd->place, sim_device(file->sim));
    const char *head = heads[sim_device(file->sim)->ticks_per_us > 1];
    vcd->scale = sim_device(file->sim)->ticks_per_us > 1 ? 1000u : 1u;
    trace_put(file, head, strlen(head));
    open_scope(file, sim_device(file->sim)->name);
    for (unsigned unit = 1; unit <= sim_units(file->sim); unit++)
        declare_unit(file, unit);
    close_scope(file);
    trace_put(file, end_of_head, sizeof end_of_head - 1u);
    vcd->tick = time_now(file);
    trace_wrote(file, put_text(put_number(trace_room(file, CHANGE_MAX), vcd->tick), "\n$dumpvars\n"));
    for (unsigned unit = 1; unit <= sim_units(file->sim); unit++) {
        read_unit_state(file, unit);
        write_unit(file, unit);
    }
    trace_put(file, "$end\n", 5);
    find_toggle(file);
}

static void end(struct trace_file *file)
{
    advance_time(file, time_now(file));
}

const struct trace_writer trace_vcd = {
    .suffix = ".vcd",
    .kind = {.name = "a VCD trace", .begins = {"$version", "$date", "$comment", "$timescale"}},
    .kinds = WATCH_BIT(WATCH_STEP) | WATCH_BIT(WATCH_DIRECTION) | WATCH_BIT(WATCH_MOTION) | WATCH_BIT(WATCH_COMMAND) |
             WATCH_BIT(WATCH_LED) | WATCH_BIT(WATCH_INPUTS) | WATCH_BIT(WATCH_OUTPUTS) | WATCH_BIT(WATCH_VARIABLES) |
             WATCH_BIT(WATCH_POWER) | WATCH_BIT(WATCH_POSITION) | WATCH_BIT(WATCH_VALUE),
    .state = sizeof(struct vcd),
    .begin = begin,
    .on_event = on_event,
    .end = end,
};
