/* SPDX-License-Identifier: MIT */
/* fuzz_interp.c: random programs with random inputs, messages and times, on a unit whose pulses are checked as they come
 * (oracle.h). The same story is lived again with time cut into other pieces and through a snapshot (K3), with pulses skipped
 * over, or by one motor alone: no motor influences another but by VAR, DO and T41, and by what readings add (oracle.h). Get
 * Command answers a text that is the same program (P8).
 *
 * First byte: 1 readings in two more bytes, and speed changes take 40 ms, 2 and 4 how time is cut, 8 pulses are skipped, 16 a
 * motor alone, 32 and 64 which.
 * Second byte: action before which the snapshot is taken. Then actions, see read_action(). */
#include <string.h>

#include "fuzz.h"
#include "oracle.h"
#include "program.h"

#define ACTIONS_MAX 96
#define TEXTS_MAX 24000
#define TIME_MAX 1500000u /* ticks in all that are seen pulse by pulse */
#define LEAP_MAX 3u       /* long leaps */

enum kind { ACT_MESSAGE, ACT_INPUTS, ACT_TIME, ACT_LEAP, ACT_POWER };

struct action {
    enum kind kind;
    uint32_t value;         /* inputs, ticks */
    const uint8_t *message;
    size_t length;
};

struct story {
    struct rkm04_config config;
    unsigned count, snapshot, cut;
    uint32_t time, leaps;
    size_t used;
    struct action action[ACTIONS_MAX];
    uint8_t text[TEXTS_MAX];
};

static struct story story;
static struct oracle first, second, kept;
static struct rkm04_unit fresh;
static uint64_t dice;

/* ---- Telling ---------------------------------------------------------------------------------------------------------- */

static void put_text(const char *text)
{
    for (; *text && story.used < TEXTS_MAX; text++)
        story.text[story.used++] = (uint8_t)*text;
}

/* One command from two bytes or more: anything that the table has, its number near what matters. */
static void put_command(struct fuzz *fuzz)
{
    static const char *const forms[] = {
        "R",    "R",    "R",    "F%b",  "F%w",  "B%b",  "V%v",  "V%w",  "S%b",     "S%w",     "A%a",     "Y",
        "Y",    "W%s",  "G%b",  "G+",   "G-",   "H",    "D",    ")0%i", "(0%i",    "M0%i",    "N0%i",    "X0%i",
        "U",    "@%l",  "J%l",  "'%l",  "L%s",  "E",    ".",    "[",    "I0%iH%l", "I8%iL%l", "I0%iL%l", "]",
        "O0%i", "Z0%i", "O8%i", "Z8%i", "T8%i", "C8%i", "T0%i", "C0%i", "T5%i",    "C5%i",    "T41",     "C41",
        "T40",  "C40",  "C100", "=%d",  "=-%b", "F%f",  "G%d",  "L2 F%s R E",      "@%l F%s R J%l",      "F%b Y V%v Y R",
    };
    const char *form = forms[fuzz_byte(fuzz) % (sizeof forms / sizeof *forms)];
    char text[96];
    size_t n = 0;
    for (; *form && n < sizeof text - 16; form++) {
        uint32_t byte;
        if (*form != '%') {
            text[n++] = *form;
            continue;
        }
        form++;
        byte = fuzz_byte(fuzz);
        if (*form == 'w')
            byte = 1 + (byte << 8 | fuzz_byte(fuzz)) % 16000 % (n > 0 && text[n - 1] == 'S' ? 2000 : 16000);
        else if (*form == 'v')
            byte = byte < 128 ? 1 + byte * 7 : byte * 62 % 16000 + 1;
        else if (*form == 'a')
            byte = 1 + byte * byte * 59999 / 65025;
        else if (*form == 'i')
            byte = 1 + byte % 4;
        else if (*form == 'l')
            byte = 1 + byte % 5;
        else if (*form == 's')
            byte = 1 + byte % 20;
        else if (*form == 'd')
            byte = byte * 7654321 + 1;
        else if (*form == 'f')
            byte = byte * 62500 + 1;
        else
            byte = 1 + byte;
        n += (size_t)snprintf(text + n, sizeof text - n, "%u", (unsigned)byte);
    }
    text[n++] = ' ';
    text[n] = '\0';
    put_text(text);
}

static struct action *add(enum kind kind, uint32_t value)
{
    struct action *action = &story.action[story.count++];
    *action = (struct action){.kind = kind, .value = value};
    return action;
}

/* A message from what has been put since `from`. */
static void add_message(size_t from)
{
    struct action *action = add(ACT_MESSAGE, 0);
    action->message = story.text + from;
    action->length = story.used - from;
}

static void begin_set(uint8_t motor)
{
    put_text("\2");
    story.text[story.used < TEXTS_MAX ? story.used++ : TEXTS_MAX - 1] = motor;
}

static void add_time(uint32_t ticks)
{
    if (ticks > TIME_MAX - story.time)
        ticks = TIME_MAX - story.time;
    story.time += ticks;
    add(ACT_TIME, ticks);
}

/* Messages that stand alone: K, C75, V, `\`, questions, Store Flash. */
static void read_special(struct fuzz *fuzz, uint8_t choice)
{
    static const char *const alone[] = {"K", "C75", "\\", "\\C100", "V%u", "", " K {}", "C75"};
    size_t from = story.used;
    uint8_t motor = (uint8_t)('0' + (choice >> 3) % 5), which = fuzz_byte(fuzz);
    char text[16];
    if (which < 160) {
        begin_set(motor);
        snprintf(text, sizeof text, alone[which % 8], (which % 8 == 4 ? fuzz_byte(fuzz) : 0u) * 40u + 1u);
        put_text(text);
    } else if (which < 200) {
        text[0] = (char)(4 + which % 4);
        text[1] = (char)motor;
        text[2] = '\0';
        put_text(text);
    } else if (which < 216) {
        text[0] = 3;
        text[1] = (char)motor;
        text[2] = '\0';
        put_text(text);
    } else if (which < 228) {
        add(ACT_POWER, 0);
        return;
    } else {
        if (story.leaps < LEAP_MAX)
            add(ACT_LEAP, (fuzz_number(fuzz, 2) * 307u) + 1);
        story.leaps++;
        return;
    }
    add_message(from);
}

static void read_action(struct fuzz *fuzz)
{
    uint8_t choice = fuzz_byte(fuzz);
    size_t from = story.used, length;
    const uint8_t *text;
    switch (choice & 7) {
    case 0:
    case 1: /* a program, made of choices */
        begin_set((uint8_t)('0' + (choice >> 3) % 5));
        for (unsigned i = 1u + (choice & 1) * 6u + (fuzz_byte(fuzz) & 15); i > 0; i--)
            put_command(fuzz);
        add_message(from);
        break;
    case 2: /* a program as it is written */
        begin_set((uint8_t)('0' + (choice >> 3) % 5));
        text = fuzz_until(fuzz, '\0', &length);
        for (size_t i = 0; i < length && story.used < TEXTS_MAX; i++)
            story.text[story.used++] = text[i];
        add_message(from);
        break;
    case 3:
        add(ACT_INPUTS, fuzz_byte(fuzz));
        break;
    case 4:
        add_time(fuzz_number(fuzz, 2));
        break;
    case 5:
        add_time((uint32_t)fuzz_byte(fuzz) * 1000u);
        break;
    case 6:
        add_time((uint32_t)(choice >> 3) * 8000u);
        break;
    default:
        read_special(fuzz, choice);
        break;
    }
}

static void read_readings(struct fuzz *fuzz, struct rkm04_readings *readings)
{
    unsigned bits = fuzz_number(fuzz, 2);
    readings->label = bits & 1;
    readings->fault_exit = bits >> 1 & 1;
    readings->hold_exit = bits >> 2 & 1;
    readings->x_after = bits >> 3 & 1;
    readings->guard_start = bits >> 4 & 1;
    readings->v_alone = bits >> 5 & 1;
    readings->y_eleventh = bits >> 6 & 1;
    readings->reset_t41 = bits >> 7 & 1;
    readings->negative_position = bits >> 8 & 1;
    readings->input_filter = bits >> 9 & 1 ? 3 : 0;
    readings->planning = bits >> 10 & 1 ? 5 : 0;
    readings->store_time = bits >> 11 & 1 ? 7 : 0;
}

static void tell(struct fuzz *fuzz)
{
    uint8_t mode = fuzz_byte(fuzz);
    story.count = 0;
    story.time = story.leaps = 0;
    story.used = 0;
    story.config = (struct rkm04_config){.node = 1, .readings.speed_change = mode & 1 ? 40 : 0};
    story.cut = mode >> 1 & 3;
    story.snapshot = fuzz_byte(fuzz) % 32;
    dice = mode + 77u;
    if (mode & 1)
        read_readings(fuzz, &story.config.readings);
    while (story.count < ACTIONS_MAX - 1 && fuzz->left > 0 && story.used < TEXTS_MAX - 2000)
        read_action(fuzz);
    add_time(300000);
}

/* ---- Living ----------------------------------------------------------------------------------------------------------- */

/* Up to the next event nothing happens. */
static uint64_t to_event(struct oracle *oracle, uint64_t ticks)
{
    uint64_t event = rkm04_next_event(&oracle->unit), now = rkm04_now(&oracle->unit), calls = oracle->calls;
    FUZZ_CHECK(event >= now, "the next event is in the past");
    if (event == now)
        return 1;
    if (event - now >= ticks)
        return ticks;
    oracle_advance(oracle, event - now);
    FUZZ_CHECK(oracle->calls == calls, "K3: something before the next event");
    return event - now;
}

static void let_pass(struct oracle *oracle, uint64_t ticks, unsigned cut)
{
    while (ticks > 0) {
        uint64_t before = rkm04_now(&oracle->unit), step = ticks;
        dice = dice * UINT64_C(6364136223846793005) + 1442695040888963407;
        if (cut == 1 && story.time < 20000)
            step = 1;
        else if (cut == 1)
            step = 1 + (dice >> 40) % 900;
        else if (cut == 2)
            step = to_event(oracle, ticks);
        else if (cut == 3)
            step = 1 + (dice >> 40) % (dice >> 63 ? 300 : 30000);
        if (step > ticks)
            step = ticks;
        if (rkm04_now(&oracle->unit) == before)
            oracle_advance(oracle, step);
        ticks -= step;
    }
}

/* Is a message for one motor, or a question about it? */
static bool is_about(const struct action *action, uint8_t motor)
{
    return action->length >= 2 && (action->message[1] == motor || (action->message[1] == '0' && action->message[0] <= 3));
}

static void send_message(struct oracle *oracle, const struct action *action, uint8_t alone)
{
    uint8_t message[TEXTS_MAX], motor = action->length >= 2 ? action->message[1] : 0;
    bool own = action->length >= 2 && motor >= '1' && motor <= '4';
    bool about = !alone || is_about(action, alone);
    bool holds_up = story.config.readings.store_time > 0 && oracle_is_store(action->message, action->length); /* every motor */
    if ((!about && !holds_up) || action->length > RKM04_MESSAGE_MAX)
        return;
    memcpy(message, action->message, action->length);
    if (alone && about)
        message[1] = alone;
    oracle_exchange(oracle, message, action->length, own ? &oracle->motor[motor - '1'].rest : &oracle->common);
}

static void live_action(struct oracle *oracle, const struct action *action, unsigned cut, bool seen, uint8_t alone)
{
    switch (action->kind) {
    case ACT_MESSAGE:
        send_message(oracle, action, alone);
        break;
    case ACT_INPUTS:
        rkm04_set_inputs(&oracle->unit, (uint8_t)action->value);
        break;
    case ACT_TIME:
        let_pass(oracle, action->value, cut);
        break;
    case ACT_LEAP:
        oracle_see_pulses(oracle, false);
        let_pass(oracle, action->value, cut == 1 ? 3 : cut);
        oracle_see_pulses(oracle, seen);
        break;
    case ACT_POWER:
        oracle_power_up(oracle, &story.config, seen);
        break;
    }
}

/* Something else happens, and then it has not happened. */
static void forget_future(struct oracle *oracle)
{
    static const uint8_t other[] = "\0020\\ T03 T82 F77 R @1 X01";
    kept = *oracle;
    rkm04_set_inputs(&oracle->unit, 0x5a);
    oracle_exchange(oracle, other, sizeof other - 1, &oracle->common);
    oracle_exchange(oracle, (const uint8_t *)"\0030", 2, &oracle->common);
    oracle_advance(oracle, 12345);
    *oracle = kept;
}

static void live(struct oracle *oracle, unsigned cut, bool seen, bool snapshot, uint8_t alone)
{
    oracle->common = oracle->calls = 0;
    oracle->writers = 0;
    oracle->in_message = false;
    memset(oracle->motor, 0, sizeof oracle->motor);
    memset(oracle->flash, 0xff, sizeof oracle->flash);
    oracle_power_up(oracle, &story.config, seen);
    for (unsigned i = 0; i < story.count; i++) {
        if (snapshot && i == story.snapshot)
            forget_future(oracle);
        live_action(oracle, &story.action[i], cut, seen, alone);
    }
}

/* ---- Comparing -------------------------------------------------------------------------------------------------------- */

#define SAME(field) FUZZ_CHECK(a->field == b->field, "%s: motor %u differs in " #field, what, number)

static void compare_motor(unsigned number, bool steps, const char *what)
{
    const struct rkm04_motor *a = &first.unit.motor[number - 1], *b = &second.unit.motor[number - 1];
    struct rkm04_motor_state s, t;
    FUZZ_CHECK(first.motor[number - 1].rest == second.motor[number - 1].rest, "%s: motor %u does something else", what, number);
    FUZZ_CHECK(!steps || first.motor[number - 1].steps == second.motor[number - 1].steps, "%s: motor %u: other pulses", what,
               number);
    SAME(position); SAME(program.written); SAME(program.closed); SAME(next); SAME(fresh); SAME(loops); SAME(calls); SAME(count);
    SAME(start_speed); SAME(speed); SAME(acceleration); SAME(forward); SAME(segments); SAME(functions); SAME(keep);
    SAME(guard_m); SAME(guard_n); SAME(guard_x); SAME(state); SAME(fault); SAME(led); SAME(resume); SAME(pin_forward);
    SAME(pendings); SAME(change_speed); SAME(motion.moving);
    if (a->motion.moving) {
        SAME(motion.done); SAME(motion.total); SAME(motion.stopping); SAME(motion.ramp.next); SAME(motion.mark);
    }
    rkm04_motor_state(&first.unit, number, &s);
    rkm04_motor_state(&second.unit, number, &t);
    FUZZ_CHECK(s.steps == t.steps && s.speed == t.speed && s.index == t.index && s.lit == t.lit && s.stopping == t.stopping,
               "%s: motor %u looks different", what, number);
}

static void compare(bool steps, const char *what)
{
    for (unsigned number = 1; number <= RKM04_MOTORS; number++)
        compare_motor(number, steps, what);
    FUZZ_CHECK(first.common == second.common, "%s: other outputs, variables or answers", what);
    FUZZ_CHECK(first.unit.now == second.unit.now && first.unit.outputs == second.unit.outputs &&
                   first.unit.variables == second.unit.variables && first.unit.simulation == second.unit.simulation,
               "%s: another state", what);
    FUZZ_CHECK(memcmp(first.flash, second.flash, sizeof first.flash) == 0, "%s: another flash", what);
}

/* Get Command answers what is in memory, and in another unit it becomes the same. */
static void check_text(unsigned number)
{
    static uint8_t text[9300], again[9300];
    const struct rkm04_program *program = &first.unit.motor[number - 1].program;
    uint8_t ask[] = {5, (uint8_t)('0' + number)};
    size_t n = rkm04_exchange(&first.unit, ask, 2, text, sizeof text), m;
    struct rkm04_reader reader;
    struct rkm04_command command;
    rkm04_read_begin(&reader, text + 2, n - 2);
    for (unsigned i = 0; i < program_count(program); i++) {
        struct rkm04_command wanted = program_at(program, program_oldest(program) + i);
        FUZZ_CHECK(rkm04_read(&reader, &command) == RKM04_READ_COMMAND && command.op == wanted.op &&
                       command.argument == wanted.argument, "P8: command %u of %.*s", i, (int)n - 2, text + 2);
    }
    FUZZ_CHECK(rkm04_read(&reader, &command) == RKM04_READ_END, "P8: %.*s", (int)n - 2, text + 2);
    rkm04_set_command(&fresh, '1', "\\", 1, NULL);
    FUZZ_CHECK(rkm04_set_command(&fresh, '1', text + 2, n - 2, NULL) == 0, "P8: %.*s is refused", (int)n - 2, text + 2);
    ask[1] = '1';
    m = rkm04_exchange(&fresh, ask, 2, again, sizeof again);
    FUZZ_CHECK(m == n && memcmp(text + 2, again + 2, n - 2) == 0, "P8: %.*s became %.*s", (int)n - 2, text + 2, (int)m - 2,
               again + 2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct rkm04_port nothing;
    struct fuzz fuzz = {data, size};
    uint8_t mode = size > 0 ? data[0] : 0, alone = (uint8_t)(mode >> 5 & 3);
    tell(&fuzz);
    live(&first, 0, true, false, 0);
    live(&second, story.cut, true, true, 0);
    compare(true, "K3");
    if (mode & 8) {
        live(&second, 0, false, false, 0);
        compare(false, "pulses skipped over");
    }
    if (mode & 16 && !(first.writers & ~(1u << alone))) {
        live(&second, 0, true, false, (uint8_t)('1' + alone));
        compare_motor(alone + 1u, true, "the motor alone");
    }
    rkm04_init(&fresh, &story.config, &nothing, NULL);
    for (unsigned number = 1; number <= RKM04_MOTORS; number++)
        check_text(number);
    return 0;
}
