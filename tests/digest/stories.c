/* SPDX-License-Identifier: MIT */
/* stories.c: random sessions. The number of a story makes it, the same on every machine: programs of every command, most of
 * them sensible, and in the middle of them inputs, questions, K, C75, changes of speed, new programs, stores and power cuts.
 *
 * The dice are thrown at most once in a list of arguments or values: compilers work those out in any order. */
#include "digest.h"

#define DEPTH_MAX 2    /* of pieces inside pieces */
#define QUIET_EVERY 5  /* each so manieth story has motions of any length, and no pulses are asked for */
#define TEXT_ROOM (SESSION_TEXT_MAX + 1)

static uint64_t dice;
static bool quiet, plain;
static char text[TEXT_ROOM]; /* of the request being written */
static unsigned depth;

/* splitmix64 */
static uint64_t draw(uint64_t below)
{
    uint64_t z = dice += UINT64_C(0x9E3779B97F4A7C15);
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return (z ^ z >> 31) % below;
}

static bool chance(unsigned percent)
{
    return draw(100) < percent;
}

/* 1 to high, each order of magnitude about as likely as the next. */
static uint64_t up_to(uint64_t high)
{
    uint64_t limit = 1;
    unsigned magnitudes = 1;
    for (uint64_t n = high; n >= 4; n /= 4)
        magnitudes++;
    for (uint64_t n = draw(magnitudes) + 1; n > 0 && limit < high; n--)
        limit *= 4;
    return 1 + draw(limit < high ? limit : high);
}

/* ---- Commands ----------------------------------------------------------------------------------------------------- */

static void put(const char *more)
{
    append(text, sizeof text, more);
}

/* A blank, the command, its number. */
static void put_command(char op, uint64_t number)
{
    const char command[] = {' ', op, '\0'};
    put(command);
    append_number(text, sizeof text, number);
}

static char one_of(const char *list)
{
    return list[draw(text_length(list))];
}

/* The same with one of these commands. */
static void put_one_of(const char *commands, uint64_t number)
{
    put_command(one_of(commands), number);
}

static uint64_t any_source(void)
{
    return chance(40) ? 1 + draw(3) : 80 + draw(4);
}

static uint64_t any_speed(void)
{
    static const uint16_t usual[] = {100, 500, 1000, 2500};
    if (quiet || chance(8))
        return up_to(RKM04_SPEED_MAX);
    return chance(50) ? usual[draw(4)] : up_to(3000);
}

static uint64_t any_acceleration(void)
{
    static const uint16_t usual[] = {500, 1000, 2000, 10000, 60000};
    return chance(60) ? usual[draw(5)] : up_to(RKM04_ACCELERATION_MAX);
}

static uint64_t any_count(void)
{
    return chance(15) ? 1 + draw(3) : up_to(quiet ? 16000000 : 1000);
}

static void parameters(void)
{
    if (chance(60))
        put_command('S', chance(50) ? 100 : up_to(RKM04_START_SPEED_MAX));
    if (chance(70))
        put_command('V', any_speed());
    if (chance(70))
        put_command('A', any_acceleration());
}

static void move(void)
{
    if (chance(80))
        put_one_of("FFB", any_count());
    put(chance(20) ? " D R" : " R");
}

static void compound(void)
{
    const char *direction = chance(5) ? "FB" : chance(50) ? "F" : "B";
    if (chance(40))
        put_command('T', 51 + draw(8));
    for (uint64_t left = chance(10) ? 11 : 1 + draw(6); left > 0; left--) {
        if (chance(80))
            put_one_of(direction, any_count());
        if (chance(70))
            put_command('V', any_speed());
        if (chance(30))
            put_command('A', any_acceleration());
        put(" Y");
    }
    put(chance(95) ? " R" : "");
}

static void goal(void)
{
    if (chance(40))
        put(" H");
    else
        put_command('G', quiet ? up_to(2000000000) : up_to(2000));
}

static void guard(void)
{
    if (chance(15))
        put(" U");
    else
        put_one_of("MMNNX", 1 + draw(3));
}

static void endless(void)
{
    guard();
    put(chance(50) ? " G+" : " G-");
}

static void limit_move(void)
{
    put_one_of("()", 1 + draw(3));
}

static void piece(void);

static void loop(void)
{
    put_command('L', chance(90) ? 1 + draw(4) : 255);
    for (uint64_t left = 1 + draw(3); left > 0; left--)
        piece();
    put(" E");
}

static void call(void)
{
    uint64_t label = 10 + draw(20), after = 31 + draw(50);
    put_command('\'', label);
    put_command('J', after);
    put_command('@', label);
    piece();
    put(" .");
    put_command('@', after);
}

static void jump(void)
{
    uint64_t kind = draw(4);
    if (kind < 2) {
        put_command('@', 1 + draw(6));
    } else if (kind == 2) {
        put_command('J', 1 + draw(6));
    } else {
        put_command('I', any_source());
        put(chance(50) ? "H" : "L");
        append_number(text, sizeof text, 1 + draw(6));
    }
}

static void wait(void)
{
    put_one_of("OZZ", any_source());
}

static void dwell(void)
{
    put_command('W', up_to(quiet ? 16000000 : 200));
}

static void output(void)
{
    put_one_of("TTC", chance(50) ? 1 + draw(8) : 80 + draw(4));
}

static void function(void)
{
    put_one_of("TTC", chance(30) ? 51 + draw(8) : chance(30) ? 41 : 40 + draw(19));
}

static void counter(void)
{
    static const char *const usual[] = {" C100", " =2000000000", " =-2000000000", " =0", " = - 77", " =1234"};
    put(usual[draw(6)]);
}

/* What ends in a fault, or holds the program up, as a rule. */
static void odd(void)
{
    static const char *const odd_ones[] = {" E", " .", " J79", " '78", " '5", " [", " ]", " ]", " L2", " K", " C75"};
    put(odd_ones[draw(11)]);
}

/* What is written otherwise, or wrong. */
static void spelling(void)
{
    static const char *const spelt[] = {" { a note }", " F 0012",   " I 01 H 20", " \2645", " \"6", "\t\r\n", " G +",
                                        " Q",          " v100",     " F0",        " (9",       " T59", " =+5",   " I01X5",
                                        " {",          " F9999999999", " \\"};
    put(spelt[draw(chance(85) ? 7 : 17)]);
}

static void piece(void)
{
    static void (*const pieces[])(void) = {
        move, move, move, move, compound, compound, parameters, goal, endless, limit_move, guard, jump, jump, wait, dwell, dwell,
        output, output, function, counter, odd, spelling, loop, loop, call,
    };
    if (depth == DEPTH_MAX)
        return;
    depth++;
    pieces[draw(sizeof pieces / sizeof pieces[0])]();
    depth--;
}

static void send_text(char motor)
{
    session_set(motor, text, text_length(text));
    text[0] = '\0';
}

static void send_program(char motor)
{
    if (chance(60))
        put("\\");
    parameters();
    for (uint64_t left = 1 + draw(6); left > 0; left--)
        piece();
    send_text(motor);
}

/* ---- What happens in a story -------------------------------------------------------------------------------------- */

static char any_motor(void)
{
    return one_of("011122334");
}

static void act_program(void)
{
    send_program(any_motor());
}

static void act_inputs(void)
{
    session_inputs((uint8_t)draw(8));
}

static void act_stop(void)
{
    put("K");
    send_text(any_motor());
}

static void act_resume(void)
{
    put("C75");
    send_text(any_motor());
}

static void act_speed(void)
{
    put_command('V', any_speed());
    send_text(any_motor());
}

static void act_ask(void)
{
    uint8_t question = (uint8_t)(4 + draw(4));
    session_ask(question, any_motor());
    if (chance(70))
        session_fetch(SIZE_MAX);
}

static void act_fetch(void)
{
    session_fetch((size_t)draw(100));
}

static void act_store(void)
{
    session_ask(3, any_motor());
}

static void act_power(void)
{
    if (chance(30))
        session_power_cycle();
}

/* A memory that is nearly full, and goes round. */
static void act_fill(void)
{
    static const char *const fill[] = {" D", " T80 C80", " W1", " F5", " @7"};
    char motor = any_motor();
    if (chance(80))
        return;
    for (uint64_t left = 1 + draw(4); left > 0; left--) {
        while (text_length(text) + 10 < sizeof text)
            put(fill[draw(5)]);
        send_text(motor);
    }
}

/* What is said of a frame that is longer than the buffer depends on the buffer's size (L4). In the plain framing any bytes
 * announce a length: these ones a small one, and silence ends them. */
static void act_noise(void)
{
    uint8_t noise[40];
    size_t length = (size_t)draw(sizeof noise);
    for (size_t i = 0; i < length; i++)
        noise[i] = (uint8_t)(plain ? draw(4) : chance(20) ? 0x7e : draw(256));
    session_bytes(noise, length);
    if (plain)
        session_to(session_now() + 101 * MS);
}

static void act(void)
{
    static void (*const acts[])(void) = {
        act_program, act_program, act_program, act_inputs, act_inputs, act_inputs, act_inputs, act_stop, act_resume, act_resume,
        act_speed, act_speed, act_ask, act_ask, act_ask, act_fetch, act_store, act_power, act_fill, act_noise,
    };
    acts[draw(sizeof acts / sizeof acts[0])]();
}

/* Until the next thing happens: at once, a tick, to a slot, or longer. */
static uint64_t pause_ticks(void)
{
    switch (draw(6)) {
    case 0:
        return draw(2);
    case 1:
        return RKM04_SLOT_TICKS - session_now() % RKM04_SLOT_TICKS;
    case 2:
        return draw(20 * MS);
    default:
        return up_to(quiet ? 20 * SECOND : 400 * MS);
    }
}

static void run_story(unsigned number)
{
    static const uint16_t latency[] = {0, 0, 0, 7, 300, 2000};
    char name[16] = "random-";
    dice = number;
    quiet = number % QUIET_EVERY == 0;
    struct session session = {.quiet = quiet};
    session.node = (uint8_t)(1 + draw(RKM04_NODE_MAX));
    session.latency = latency[draw(6)];
    plain = chance(40);
    session.framing = plain ? &rkm04_plain : &rkm04_hdlc;
    session_begin(&session);
    session_inputs((uint8_t)draw(8));
    for (char motor = '1'; motor <= '4'; motor++)
        if (motor == '1' || chance(40))
            send_program(motor);
    for (unsigned left = 24; left > 0; left--) {
        session_to(session_now() + pause_ticks());
        act();
    }
    session_to(session_now() + (quiet ? 100 * SECOND : SECOND));
    for (char motor = '1'; motor <= '4'; motor++)
        for (uint8_t question = 4; question <= 7; question++)
            session_ask(question, motor);
    append_number(name, sizeof name, number);
    session_end(name);
}

void run_stories(void)
{
    for (unsigned number = 1; number <= STORIES; number++)
        run_story(number);
}
