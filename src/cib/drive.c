/* SPDX-License-Identifier: MIT */
#include "drive.h"

#include <string.h>

#include "cib_report.h"
#include "outputs.h"
#include "phase.h"
#include "profile.h"
#include "ramp.h"

/* The planner has 32 bits for a way: a longer one begins as an endless motion, until so much is left. */
#define LONGEST_WAY (UINT32_MAX - (uint32_t)CIB_BRAKE_ERROR_MAX)
#define LONG_WAY_LEFT (UINT64_C(1) << 31)

_Static_assert(RKM04_SEGMENTS_MAX >= 2, "brake_error takes a second segment (profile.h)");

/* What waits for its slot. */
enum order { ORDER_NONE, ORDER_PLACE, ORDER_WAY, ORDER_SPEED, ORDER_STOP, ORDER_STOP_FAST };

/* What the pulse leads to at which the drive updates its motion. */
enum after { AFTER_END, AFTER_TURN, AFTER_LONG_WAY };

void drive_reset(struct cib_unit *unit, struct cib_drive *drive)
{
    const struct cib_drive_setup *setup = &unit->setup.drive[drive - unit->drive];
    const uint16_t sequence = drive->sequence, command = drive->command, p2 = drive->p2, ack = drive->ack;
    const uint32_t p1 = drive->p1;
    memset(drive, 0, sizeof *drive); /* a compound literal would be a second drive on the stack */
    drive->sequence = sequence;
    drive->command = command;
    drive->p1 = p1;
    drive->p2 = p2;
    drive->ack = ack;
    drive->invel_due = drive->idle_due = drive->slot = CIB_NEVER;
    drive->motion.ramp.next = CIB_NEVER;
    if (!cib_has_drive(unit, axis_of(unit, drive) - 1))
        return;
    drive->start_speed = setup->start_speed;
    drive->acceleration = setup->acceleration_max;
    drive->deceleration = drive->stop_deceleration = setup->deceleration_max;
    drive->status = setup->ramps != 0 ? CIB_RAMP : 0;
}

/* ---- MCSTAT (BC4-BC6) ---------------------------------------------------------------------------------------------- */

static void set_status(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick, unsigned status)
{
    const unsigned axis = axis_of(unit, drive), changed = drive->status ^ status;
    if (changed == 0)
        return;
    if ((changed & CIB_MOVE) != 0)
        drive->idle_due = (status & CIB_MOVE) == 0 && unit->config.idle_off > 0
                              ? tick + (uint64_t)unit->config.idle_off * (CIB_TICKS_PER_SECOND / 1000)
                              : CIB_NEVER;
    drive->status = (uint8_t)status;
    if ((changed & CIB_DIR) != 0 && unit->port->direction)
        unit->port->direction(unit->context, tick, axis, (status & CIB_DIR) == 0);
    report_event(unit, tick, axis, CIB_EVENT_STATUS, status);
}

/* What a motion reaches does not show in MCSTAT while that is the one of a command that waits for its slot (BC5). */
static bool is_waiting(const struct cib_drive *drive)
{
    return drive->slot != CIB_NEVER;
}

/* ---- Motions ------------------------------------------------------------------------------------------------------- */

/* Nothing is left to do. */
static void stand(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick, bool moved)
{
    drive->motion.moving = false;
    drive->motion.ramp.next = CIB_NEVER;
    if (moved)
        report_event(unit, tick, axis_of(unit, drive), CIB_EVENT_MOTION, 0);
    if (is_waiting(drive))
        return;
    const unsigned reached = drive->goal.kind == PROFILE_TO_PLACE ? CIB_TRG : 0;
    set_status(unit, drive, tick, (drive->status & ~CIB_MOVE) | reached);
}

/* Where a motion is under way to, for the planner. */
static struct profile_goal goal_of(const struct cib_unit *unit, const struct cib_drive *drive)
{
    struct profile_goal goal = {.kind = (enum profile_goal_kind)drive->goal.kind,
                                .way = drive->goal.way,
                                .speed = drive->goal.speed,
                                .start_speed = drive->goal.start_speed,
                                .acceleration = drive->goal.acceleration,
                                .deceleration = drive->goal.deceleration,
                                .early = unit->config.brake_error};
    if (goal.kind == PROFILE_TO_PLACE && size_of(goal.way) > LONGEST_WAY) {
        goal.kind = PROFILE_FOR_EVER;
        goal.speed = goal.way > 0 ? goal.speed : -goal.speed;
    }
    return goal;
}

/* The pulse at which a motion to a position is updated, if the planner does not end it there. */
static void set_check(struct cib_drive *drive, const struct profile_goal *goal)
{
    const uint64_t length = size_of(drive->goal.way);
    if (drive->goal.kind != PROFILE_TO_PLACE)
        return;
    if (goal->kind == PROFILE_FOR_EVER) {
        drive->after = AFTER_LONG_WAY;
        drive->check = (uint32_t)(length - LONG_WAY_LEFT);
    } else if (goal->early < 0) { /* it is cut (BM8) */
        drive->check = (uint32_t)length;
    }
}

/* INVEL is due where the ramp to the speed ends, or now (BC6). Returns MCSTAT with it in that case. */
static unsigned find_invel(struct cib_drive *drive, uint64_t tick, unsigned status)
{
    const struct rkm04_motion *motion = &drive->motion;
    const struct rkm04_instant *end = &motion->ramp.end;
    const uint64_t due = end->tick + ((end->high | end->low) != 0);
    if (drive->goal.kind != PROFILE_FOR_EVER)
        return status;
    if (motion->profile.point[motion->profile.leg].slope != 0 && due > tick)
        drive->invel_due = due;
    else if (!is_waiting(drive))
        status |= CIB_INVEL;
    return status;
}

/* Plan to the goal at `tick`, from rest or from where the motion is (BM2, BM5, BM6). moved: pulses came up to now. */
static void go(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick, bool moved)
{
    struct rkm04_motion *motion = &drive->motion;
    const struct profile_goal goal = goal_of(unit, drive);
    const enum profile_answer answer = profile_go(motion, tick, CIB_TICKS_PER_SECOND, &goal);
    drive->check = 0;
    drive->invel_due = CIB_NEVER;
    if (answer == PROFILE_STANDS) {
        stand(unit, drive, tick, moved);
        return;
    }
    if (!moved)
        report_event(unit, tick, axis_of(unit, drive), CIB_EVENT_MOTION, 1);
    unsigned status = (drive->status & ~CIB_DIR) | CIB_MOVE | (motion->forward ? 0 : CIB_DIR);
    drive->after = answer == PROFILE_TURNS ? AFTER_TURN : AFTER_END;
    if (answer == PROFILE_MOVES) {
        set_check(drive, &goal);
        status = find_invel(drive, tick, status);
    }
    set_status(unit, drive, tick, status);
}

/* The last pulse of a plan came at `tick`, or the one at which the drive updates its motion. */
static void update_motion(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick)
{
    struct rkm04_motion *motion = &drive->motion;
    if (drive->after == AFTER_END) {
        stand(unit, drive, tick, true);
        return;
    }
    drive->goal.way += motion->forward ? -(int64_t)motion->done : (int64_t)motion->done;
    if (drive->after == AFTER_TURN)
        motion->moving = false;
    go(unit, drive, tick, true);
}

/* A motion command acts in the slot `tick`, with the parameters of now (BK3, BP3). */
static void act(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick, const struct cib_order *order)
{
    const unsigned scale = unit->config.acc_unit;
    const unsigned deceleration = order->kind == ORDER_STOP_FAST ? drive->stop_deceleration : drive->deceleration;
    drive->goal.start_speed = (drive->status & CIB_RAMP) != 0 ? drive->start_speed : CIB_SPEED_MAX; /* BM4 */
    drive->goal.acceleration = (uint16_t)(drive->acceleration * scale);
    drive->goal.deceleration = (uint16_t)(deceleration * scale);
    drive->goal.kind = PROFILE_TO_STOP;
    if (order->kind == ORDER_PLACE || order->kind == ORDER_WAY) {
        drive->goal.kind = PROFILE_TO_PLACE;
        drive->goal.way = order->kind == ORDER_WAY ? order->value : (int64_t)order->value - drive->position;
        drive->goal.speed = order->speed;
    } else if (order->kind == ORDER_SPEED) {
        drive->goal.kind = PROFILE_FOR_EVER;
        drive->goal.speed = order->value;
    }
    go(unit, drive, tick, drive->motion.moving);
}

bool drive_is_turning(const struct cib_drive *drive)
{
    return drive->after == AFTER_TURN;
}

bool drive_is_stopping(const struct cib_drive *drive)
{
    return drive->goal.kind == PROFILE_TO_STOP || drive_is_turning(drive);
}

void drive_do_slot(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick)
{
    static const struct cib_order stop = {.kind = ORDER_STOP_FAST};
    if (drive->slot == tick) {
        drive->slot = CIB_NEVER;
        act(unit, drive, tick, &drive->waiting);
    } else if (unit->stop_slot == tick && cib_has_drive(unit, axis_of(unit, drive) - 1)) {
        set_status(unit, drive, tick, drive->status & ~(CIB_INVEL | CIB_TRG));
        act(unit, drive, tick, &stop);
    }
}

/* ---- Pulses -------------------------------------------------------------------------------------------------------- */

static bool pulses_are_seen(const struct cib_unit *unit)
{
    return unit->port->steps || unit->port->outputs;
}

static void count_pulses(const struct cib_unit *unit, struct cib_drive *drive, uint32_t count)
{
    const unsigned rows = phase_rows(unit->setup.drive[drive - unit->drive].mode);
    const uint32_t change = drive->motion.forward ? count : 0 - count;
    if (count == 0)
        return;
    drive->position = (int32_t)((uint32_t)drive->position + change);
    drive->row = (uint8_t)((drive->row + change) % rows);
    drive->started = true;
    drive->off = false;
    drive->motion.done += count;
}

/* Pulses that come together: one, if the outputs are watched. */
static void send_pulses(struct cib_unit *unit, struct cib_drive *drive, const uint64_t *tick, size_t count)
{
    const bool forward = drive->motion.forward;
    count_pulses(unit, drive, 1);
    const int32_t position = drive->position;
    count_pulses(unit, drive, (uint32_t)count - 1);
    if (unit->port->steps)
        unit->port->steps(unit->context, axis_of(unit, drive), tick, count, position, forward);
    outputs_changed(unit, tick[count - 1]);
}

/* Pulses that may be sent before the drive updates its motion. */
static uint32_t room_of(const struct cib_drive *drive)
{
    return drive->check != 0 ? drive->check - drive->motion.done : UINT32_MAX;
}

bool drive_run(struct cib_unit *unit, struct cib_drive *drive, uint64_t limit)
{
    struct rkm04_motion *motion = &drive->motion;
    uint64_t tick[64];
    const uint32_t most = sizeof tick / sizeof *tick;
    while (motion->ramp.next <= limit) {
        if (!pulses_are_seen(unit))
            count_pulses(unit, drive, ramp_skip(&motion->ramp, limit, room_of(drive) - 1));
        const uint32_t room = room_of(drive);
        tick[0] = motion->ramp.next;
        const size_t count = ramp_pulses(&motion->ramp, &motion->profile, limit, tick, room < most ? room : most);
        const uint64_t last = tick[count > 0 ? count - 1 : 0];
        const size_t together = unit->port->outputs ? 1 : count;
        for (size_t i = 0; i < count; i += together)
            send_pulses(unit, drive, tick + i, together);
        if (motion->ramp.next == CIB_NEVER || room_of(drive) == 0) {
            update_motion(unit, drive, last);
            return false;
        }
    }
    return true;
}

uint64_t drive_next_pulse(const struct cib_drive *drive)
{
    return drive->motion.ramp.next;
}

uint64_t drive_next_report(const struct cib_unit *unit, const struct cib_drive *drive)
{
    const struct rkm04_ramp *ramp = &drive->motion.ramp;
    if (pulses_are_seen(unit) || ramp->next == CIB_NEVER)
        return ramp->next;
    return ramp_quiet_pulses(ramp, drive->check != 0 ? room_of(drive) - 1 : UINT32_MAX);
}

/* ---- What else is due ---------------------------------------------------------------------------------------------- */

uint64_t drive_next_due(const struct cib_drive *drive)
{
    uint64_t due = drive->invel_due < drive->idle_due ? drive->invel_due : drive->idle_due;
    return drive->slot < due ? drive->slot : due;
}

void drive_do_due(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick)
{
    if (drive->invel_due == tick) {
        drive->invel_due = CIB_NEVER;
        if (!is_waiting(drive))
            set_status(unit, drive, tick, drive->status | CIB_INVEL);
    }
    if (drive->idle_due == tick) {
        drive->idle_due = CIB_NEVER;
        drive->off = true;
        outputs_changed(unit, tick);
    }
}

/* ---- Commands (section 5) ------------------------------------------------------------------------------------------ */

enum command {
    COMMAND_NOTHING = 0,
    COMMAND_RAMPS = 9,
    COMMAND_START_SPEED = 11,
    COMMAND_ACCELERATION = 12,
    COMMAND_DECELERATION = 13,
    COMMAND_STOP_DECELERATION = 14,
    COMMAND_POSITION = 100,
    COMMAND_MOVE_TO = 101,
    COMMAND_MOVE_BY = 102,
    COMMAND_RUN = 105,
    COMMAND_STOP = 108,
    COMMAND_STOP_FAST = 109
};

/* MCERR (BC3). */
enum refusal { TAKEN, NO_COMMAND, NO_DRIVE, OUT_OF_RANGE, ABOVE_MAXIMUM, IS_MOVING };

const char *cib_error_name(uint16_t error)
{
    static const char *const name[] = {"none", "command", "no drive", "range", "maximum", "moving"};
    return error < sizeof name / sizeof *name ? name[error] : "unknown";
}

static bool is_command(uint16_t number)
{
    return number == COMMAND_NOTHING || number == COMMAND_RAMPS ||
           (number >= COMMAND_START_SPEED && number <= COMMAND_STOP_DECELERATION) ||
           (number >= COMMAND_POSITION && number <= COMMAND_MOVE_BY) || number == COMMAND_RUN || number == COMMAND_STOP ||
           number == COMMAND_STOP_FAST;
}

/* A value between `least` and `maximum`, which is at most `most`. */
static enum refusal refusal_of_value(uint64_t value, uint32_t least, uint32_t most, uint32_t maximum)
{
    if (value < least || value > most)
        return OUT_OF_RANGE;
    return value > maximum ? ABOVE_MAXIMUM : TAKEN;
}

/* P1 is an unsigned number here: a negative one is out of every range. */
static enum refusal refusal_of(const struct cib_unit *unit, const struct cib_drive *drive)
{
    const struct cib_drive_setup *setup = &unit->setup.drive[drive - unit->drive];
    const uint64_t speed = size_of((int32_t)drive->p1);
    if (!is_command(drive->command))
        return NO_COMMAND;
    if (!cib_has_drive(unit, axis_of(unit, drive) - 1))
        return NO_DRIVE;
    switch (drive->command) {
    case COMMAND_RAMPS:
        return drive->p1 > 1 ? OUT_OF_RANGE : TAKEN;
    case COMMAND_START_SPEED:
        return refusal_of_value(drive->p1, CIB_SPEED_MIN, CIB_SPEED_MAX, CIB_SPEED_MAX);
    case COMMAND_ACCELERATION:
        return refusal_of_value(drive->p1, CIB_ACCELERATION_MIN, CIB_ACCELERATION_MAX, setup->acceleration_max);
    case COMMAND_DECELERATION:
        return refusal_of_value(drive->p1, CIB_ACCELERATION_MIN, CIB_ACCELERATION_MAX, setup->deceleration_max);
    case COMMAND_STOP_DECELERATION:
        return refusal_of_value(drive->p1, CIB_ACCELERATION_MIN, CIB_ACCELERATION_MAX, CIB_ACCELERATION_MAX);
    case COMMAND_POSITION:
        return (drive->status & CIB_MOVE) != 0 ? IS_MOVING : TAKEN;
    case COMMAND_MOVE_TO:
    case COMMAND_MOVE_BY:
        return refusal_of_value(drive->p2, CIB_SPEED_MIN, UINT32_MAX, setup->speed_max);
    case COMMAND_RUN:
        return speed == 0 ? TAKEN : refusal_of_value(speed, CIB_SPEED_MIN, UINT32_MAX, setup->speed_max);
    default:
        return TAKEN;
    }
}

uint64_t drive_slot_from(uint64_t tick)
{
    return tick == 0 ? CIB_SLOT_TICKS : (tick + CIB_SLOT_TICKS - 1) / CIB_SLOT_TICKS * CIB_SLOT_TICKS;
}

/* A motion command waits for its slot; until then MCSTAT is its (BC5). Returns MCSTAT. */
static unsigned wait_for_slot(struct cib_unit *unit, struct cib_drive *drive, unsigned status)
{
    static const uint8_t orders[] = {[COMMAND_MOVE_TO - 100] = ORDER_PLACE,
                                     [COMMAND_MOVE_BY - 100] = ORDER_WAY,
                                     [COMMAND_RUN - 100] = ORDER_SPEED,
                                     [COMMAND_STOP - 100] = ORDER_STOP,
                                     [COMMAND_STOP_FAST - 100] = ORDER_STOP_FAST};
    const int32_t value = (int32_t)drive->p1;
    unsigned order = orders[drive->command - 100];
    if (order == ORDER_SPEED && value == 0)
        order = ORDER_STOP;
    drive->waiting = (struct cib_order){(uint8_t)order, value, drive->p2};
    drive->slot = drive_slot_from(unit->now);
    const bool to_do = drive->motion.moving || order == ORDER_SPEED || (order == ORDER_WAY && value != 0) ||
                       (order == ORDER_PLACE && value != drive->position);
    return (status & ~(CIB_INVEL | CIB_TRG | CIB_MOVE)) | (to_do ? CIB_MOVE : 0);
}

/* Do a good command. */
static void execute(struct cib_unit *unit, struct cib_drive *drive)
{
    const uint16_t value = (uint16_t)drive->p1;
    unsigned status = drive->status & ~CIB_ERR;
    switch (drive->command) {
    case COMMAND_NOTHING:
        break;
    case COMMAND_RAMPS:
        status = value != 0 ? status | CIB_RAMP : status & ~CIB_RAMP;
        break;
    case COMMAND_START_SPEED:
        drive->start_speed = value;
        break;
    case COMMAND_ACCELERATION:
        drive->acceleration = value;
        break;
    case COMMAND_DECELERATION:
        drive->deceleration = value;
        break;
    case COMMAND_STOP_DECELERATION:
        drive->stop_deceleration = value;
        break;
    case COMMAND_POSITION:
        drive->position = (int32_t)drive->p1;
        report_event(unit, unit->now, axis_of(unit, drive), CIB_EVENT_POSITION, drive->p1);
        break;
    default:
        status = wait_for_slot(unit, drive, status);
    }
    set_status(unit, drive, unit->now, status);
}

void drive_take(struct cib_unit *unit, struct cib_drive *drive)
{
    const unsigned axis = axis_of(unit, drive);
    drive->ack = drive->sequence;
    drive->error = (uint16_t)refusal_of(unit, drive);
    if (drive->error != TAKEN) {
        report_event(unit, unit->now, axis, CIB_EVENT_REFUSED, drive->error);
        set_status(unit, drive, unit->now, drive->status | CIB_ERR);
        return;
    }
    report_event(unit, unit->now, axis, CIB_EVENT_TAKEN, drive->command);
    execute(unit, drive);
}
