/* SPDX-License-Identifier: MIT */
/* The type Sim of the extension: the calls of handle.h for Python, and nothing else.
 *
 * A call that may last gives up the interpreter's lock; a second thread that comes meanwhile gets BusyError. */
#include "sim_type.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PAUSE_NS 50000000 /* of real time between two questions whether a signal has come */
#define ANSWER_ROOM 16384 /* bytes: the longest answer, a full memory, has 9101 */

struct sim_object {
    PyObject_HEAD
    struct handle *handle; /* NULL: closed */
    bool busy;             /* a thread is in a call */
    PyThreadState *state;  /* of that thread, while the interpreter's lock is given up */
    bool raised;           /* a signal handler has raised an exception */
    struct timespec asked;
};

static PyObject *none(void)
{
    Py_INCREF(Py_None);
    return Py_None;
}

/* ---- Calls ------------------------------------------------------------------------------------------------------------ */

static struct handle *enter(struct sim_object *self)
{
    if (self->busy) {
        PyErr_SetString(busy_type, "the bus is in use by another thread: expected one thread at a time; let the threads take "
                                   "turns, for example with a threading.Lock");
        return NULL;
    }
    if (!self->handle) {
        PyErr_SetString(closed_type, "the bus is closed: expected an open one");
        return NULL;
    }
    self->busy = true;
    self->raised = false;
    return self->handle;
}

static void leave(struct sim_object *self)
{
    self->busy = false;
}

static void release(struct sim_object *self)
{
    clock_gettime(CLOCK_MONOTONIC_COARSE, &self->asked);
    self->state = PyEval_SaveThread();
}

static void take_back(struct sim_object *self)
{
    PyEval_RestoreThread(self->state);
    self->state = NULL;
}

/* Asked by the handle while time passes: has a signal come, such as that of Ctrl-C? */
static bool paused(void *context)
{
    struct sim_object *self = context;
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC_COARSE, &now);
    if ((now.tv_sec - self->asked.tv_sec) * 1000000000 + now.tv_nsec - self->asked.tv_nsec < PAUSE_NS)
        return false;
    self->asked = now;
    take_back(self);
    self->raised = PyErr_CheckSignals() != 0;
    self->state = PyEval_SaveThread();
    return self->raised;
}

static PyObject *refuse_call(const struct refusal *refusal)
{
    if (refusal->code == REFUSED_MEMORY)
        return PyErr_NoMemory();
    PyObject *error = PyObject_CallFunction(refused_type, "s", refusal->text);
    PyObject *code = error ? PyLong_FromLong(refusal->code) : NULL;
    if (code && PyObject_SetAttrString(error, "code", code) == 0)
        PyErr_SetObject(refused_type, error);
    Py_XDECREF(code);
    Py_XDECREF(error);
    return NULL;
}

static json_t *load(const char *text)
{
    json_error_t error;
    json_t *json = json_loads(text, JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL, &error);
    if (json)
        return json;
    if (json_error_code(&error) == json_error_numeric_overflow) {
        struct refusal refusal;
        refuse(&refusal, REFUSED_PARAMS, "expected numbers below 2^63, found a %s", error.text);
        refuse_call(&refusal);
    } else {
        PyErr_Format(PyExc_ValueError, "expected JSON: %s", error.text);
    }
    return NULL;
}

static PyObject *dump(json_t *json)
{
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    PyObject *result = text ? PyUnicode_FromString(text) : PyErr_NoMemory();
    free(text);
    return result;
}

static PyObject *sim_call(struct sim_object *self, PyObject *args)
{
    const char *method, *text;
    struct refusal refusal;
    if (!PyArg_ParseTuple(args, "ss:call", &method, &text))
        return NULL;
    struct handle *handle = enter(self);
    json_t *params = handle ? load(text) : NULL, *result = NULL;
    if (params) {
        release(self);
        result = handle_call(handle, method, params, &refusal);
        take_back(self);
        if (!result && !self->raised)
            refuse_call(&refusal);
    }
    json_decref(params);
    if (handle)
        leave(self);
    return result ? dump(result) : NULL;
}

static PyObject *sim_now_(struct sim_object *self, PyObject *unused)
{
    (void)unused;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    uint64_t now = sim_now(&handle->sim);
    leave(self);
    return PyLong_FromUnsignedLongLong(now);
}

static PyObject *sim_next_event_(struct sim_object *self, PyObject *unused)
{
    (void)unused;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    uint64_t event = sim_next_event(&handle->sim), due = sim_due(&handle->sim), now = sim_now(&handle->sim);
    leave(self);
    event = due < event ? due : event;
    if (event == DEVICE_NEVER)
        return none();
    return PyLong_FromUnsignedLongLong(event > now ? event : now);
}

/* The tick of an argument. Returns false: an exception is set. */
static bool read_tick(PyObject *value, uint64_t *tick)
{
    long long number = PyLong_AsLongLong(value);
    if (number == -1 && PyErr_Occurred())
        return false;
    if (number < 0 || (uint64_t)number > SIM_TIME_MAX) {
        PyErr_Format(PyExc_ValueError, "virtual time goes from 0 to %llu us: expected a tick in it, found %lld",
                     (unsigned long long)SIM_TIME_MAX, number);
        return false;
    }
    *tick = (uint64_t)number;
    return true;
}

static PyObject *sim_advance_(struct sim_object *self, PyObject *value)
{
    uint64_t tick;
    struct handle *handle = read_tick(value, &tick) ? enter(self) : NULL;
    if (!handle)
        return NULL;
    release(self);
    handle_advance(handle, tick);
    take_back(self);
    leave(self);
    if (self->raised)
        return NULL;
    return none();
}

static PyObject *sim_wait_byte(struct sim_object *self, PyObject *args)
{
    uint64_t tick;
    PyObject *value;
    Py_ssize_t count = 1;
    int stop = -1;
    if (!PyArg_ParseTuple(args, "O|ni:wait_byte", &value, &count, &stop))
        return NULL;
    struct handle *handle = read_tick(value, &tick) ? enter(self) : NULL;
    if (!handle)
        return NULL;
    release(self);
    handle_advance_to_bytes(handle, tick, count > 0 ? (size_t)count : 0, stop);
    take_back(self);
    bool heard = handle->host.count > 0;
    leave(self);
    return self->raised ? NULL : PyBool_FromLong(heard);
}

static PyObject *text_or_none(const char *text)
{
    return text ? PyUnicode_FromString(text) : none();
}

/* What can be seen of a motor: (position, true_position, state, speed, fault, led), as in the method `state`, which has more. */
static PyObject *axis_tuple(struct sim *sim, unsigned number, unsigned axis)
{
    const struct device_kind *kind = sim_device(sim);
    const struct device_axis seen = sim_axis(sim, number, axis);
    const struct plant *plant = sim->unit[number - 1u].plant;
    int64_t position;
    PyObject *true_position = plant && plant_position(plant, axis, &position) ? PyLong_FromLongLong(position) : none();
    return Py_BuildValue("(iNNINN)", seen.position, true_position, text_or_none(kind->state_name(seen.state)),
                         (unsigned int)seen.speed, text_or_none(seen.fault != 0 ? kind->fault_name(seen.fault) : NULL),
                         text_or_none(kind->led_name(seen.led)));
}

static PyObject *sim_axis_(struct sim_object *self, PyObject *args)
{
    const char *name;
    int axis;
    if (!PyArg_ParseTuple(args, "si:axis", &name, &axis))
        return NULL;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    struct sim *sim = &handle->sim;
    const int axes = (int)sim_device(sim)->axes;
    unsigned number = sim_unit_named(sim, name);
    PyObject *result = NULL;
    if (number > 0 && axis >= 1 && axis <= axes)
        result = axis_tuple(sim, number, (unsigned)axis);
    else
        PyErr_Format(PyExc_ValueError, "expected a unit of this bus and a motor from 1 to %d, found unit %s, motor %d", axes,
                     name, axis);
    leave(self);
    return result;
}

/* ---- The host --------------------------------------------------------------------------------------------------------- */

/* Returns the tick at which the last byte will have passed. */
static PyObject *sim_write(struct sim_object *self, PyObject *data)
{
    char *bytes;
    Py_ssize_t length;
    if (PyBytes_AsStringAndSize(data, &bytes, &length) != 0)
        return NULL;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    release(self);
    bool is_done = handle_host_write(handle, (const uint8_t *)bytes, (size_t)length);
    take_back(self);
    uint64_t now = sim_now(&handle->sim), passed = handle->host.free;
    leave(self);
    if (self->raised)
        return NULL;
    if (!is_done) {
        PyErr_SetString(error_type, "virtual time has reached its end: the bytes are not sent");
        return NULL;
    }
    return PyLong_FromUnsignedLongLong(passed > now ? passed : now);
}

static PyObject *sim_configure(struct sim_object *self, PyObject *args)
{
    unsigned int baud;
    int data_bits, stop_halves;
    const char *parity;
    if (!PyArg_ParseTuple(args, "Iisi:configure", &baud, &data_bits, &parity, &stop_halves))
        return NULL;
    if (baud == 0 || data_bits < 5 || data_bits > 8 || strlen(parity) != 1 || !strchr("NEOMS", parity[0]) || stop_halves < 2 ||
        stop_halves > 4) {
        PyErr_SetString(PyExc_ValueError, "expected a speed from 1 baud, 5 to 8 data bits, parity N, E, O, M or S, and 1, 1.5 or "
                                          "2 stop bits");
        return NULL;
    }
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    handle_host_configure(handle, (struct line_settings){baud, (uint8_t)data_bits, parity[0], (uint8_t)stop_halves});
    leave(self);
    return none();
}

/* Take bytes that have come; `each` makes an object of every one, or is NULL: they become a bytes object. */
static PyObject *take(struct sim_object *self, PyObject *value, bool with_ticks)
{
    Py_ssize_t most = PyLong_AsSsize_t(value);
    if (most < 0 && PyErr_Occurred())
        return NULL;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    size_t length = most < 0 || (size_t)most > handle->host.count ? handle->host.count : (size_t)most;
    struct handle_byte *heard = malloc((length + 1u) * sizeof *heard);
    uint8_t *bytes = malloc(length + 1u);
    PyObject *result = heard && bytes ? PyList_New(with_ticks ? (Py_ssize_t)length : 0) : PyErr_NoMemory();
    if (result) {
        handle_host_read(handle, heard, length);
        for (size_t i = 0; i < length; i++)
            bytes[i] = heard[i].byte;
    }
    for (size_t i = 0; result && with_ticks && i < length; i++)
        PyList_SetItem(result, (Py_ssize_t)i, Py_BuildValue("(Ki)", (unsigned long long)heard[i].tick, (int)heard[i].byte));
    if (result && !with_ticks) {
        Py_DECREF(result);
        result = PyBytes_FromStringAndSize((const char *)bytes, (Py_ssize_t)length);
    }
    free(heard);
    free(bytes);
    leave(self);
    return result;
}

static PyObject *sim_read(struct sim_object *self, PyObject *value)
{
    return take(self, value, false);
}

static PyObject *sim_read_ticks(struct sim_object *self, PyObject *value)
{
    return take(self, value, true);
}

static PyObject *sim_in_waiting(struct sim_object *self, PyObject *unused)
{
    (void)unused;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    size_t count = handle->host.count;
    leave(self);
    return PyLong_FromSize_t(count);
}

/* Bytes that found no room. */
static PyObject *sim_lost(struct sim_object *self, PyObject *unused)
{
    (void)unused;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    uint64_t lost = handle->host.lost;
    leave(self);
    return PyLong_FromUnsignedLongLong(lost);
}

static PyObject *sim_break_(struct sim_object *self, PyObject *on)
{
    int level = PyObject_IsTrue(on);
    struct handle *handle = level >= 0 ? enter(self) : NULL;
    if (!handle)
        return NULL;
    sim_break(&handle->sim, level != 0);
    leave(self);
    return none();
}

/* Forget what the host has written and has not set out. Returns the number of bytes. */
static PyObject *sim_purge_(struct sim_object *self, PyObject *unused)
{
    (void)unused;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    size_t number = sim_purge(&handle->sim);
    handle->host.free = (handle->sim.segment.host_free + WIRE_TICK - 1u) / WIRE_TICK;
    leave(self);
    return PyLong_FromSize_t(number);
}

/* Is the bus at rest: no byte under way, no answer to come? */
static PyObject *sim_is_idle(struct sim_object *self, PyObject *unused)
{
    (void)unused;
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    bool idle = segment_idle(&handle->sim.segment);
    leave(self);
    return PyBool_FromLong(idle);
}

/* ---- Messages --------------------------------------------------------------------------------------------------------- */

/* The bytes on the wires of a message to a node. */
static PyObject *sim_frame(struct sim_object *self, PyObject *args)
{
    int node;
    const char *message;
    Py_ssize_t length;
    struct handle *handle = PyArg_ParseTuple(args, "iy#:frame", &node, &message, &length) ? enter(self) : NULL;
    if (!handle)
        return NULL;
    const struct rkm04_framing *framing = handle->sim.monitor.framing->link;
    const struct device_kind *kind = sim_device(&handle->sim);
    leave(self);
    if (!kind->receive)
        return PyErr_Format(PyExc_ValueError, "the device %s has no bus, and takes no messages", kind->name);
    if (node >= 0 && node <= 255 && length <= (Py_ssize_t)kind->request_max)
        return frame_message(framing, node, (const uint8_t *)message, (size_t)length);
    PyErr_Format(PyExc_ValueError, "expected a node from 0 (all units) to 255 and a message of at most %u bytes",
                 kind->request_max);
    return NULL;
}

/* Let time pass until a whole message has come, at most up to `tick`. */
static bool receive_whole(struct handle *handle, uint64_t tick, struct rkm04_receiver *receiver, uint8_t *message)
{
    const struct device_framing *framing = handle->sim.monitor.framing;
    struct handle_byte byte;
    for (;;) {
        bool open = framing->end && receiver->length > 0;
        uint64_t silence = open ? receiver->last + framing->silence : DEVICE_NEVER;
        if (!handle_advance_to_bytes(handle, silence < tick ? silence : tick, 1, -1))
            return false;
        const struct handle_host *host = &handle->host;
        bool has_byte = host->count > 0 && host->heard[host->head].tick < silence;
        if (has_byte && handle_host_read(handle, &byte, 1) > 0) {
            if (framing->link->receive(receiver, byte.byte, byte.tick, message, ANSWER_ROOM))
                return true;
        } else if (sim_now(&handle->sim) >= silence) {
            if (framing->end(receiver, message, true))
                return true;
            *receiver = (struct rkm04_receiver){.phase = 0};
        } else {
            return false;
        }
    }
}

/* Let time pass until a whole message has come to the host, at most up to a tick; the bytes that led to it are taken. Returns
 * (dnode, snode, message), or None. */
static PyObject *sim_receive_message(struct sim_object *self, PyObject *value)
{
    static const char wanted_until[] = "(iiy#)";
    uint64_t tick;
    struct rkm04_receiver receiver = {0};
    uint8_t *message = malloc(ANSWER_ROOM);
    struct handle *handle = message && read_tick(value, &tick) ? enter(self) : NULL;
    if (!handle) {
        free(message);
        return NULL;
    }
    release(self);
    bool whole = receive_whole(handle, tick, &receiver, message);
    take_back(self);
    leave(self);
    PyObject *result = NULL;
    if (!self->raised && whole)
        result = Py_BuildValue(wanted_until, receiver.dnode, receiver.snode, (const char *)message, (Py_ssize_t)receiver.length);
    else if (!self->raised)
        result = none();
    free(message);
    return result;
}

/* Take the gathered events of a subscription: (lines of JSON, number of lost ones, tick of the first lost). */
static PyObject *sim_events(struct sim_object *self, PyObject *value)
{
    long number = PyLong_AsLong(value);
    struct handle *handle = number == -1 && PyErr_Occurred() ? NULL : enter(self);
    if (!handle)
        return NULL;
    sim_finish_tick(&handle->sim);
    struct handle_subscription *subscription = number > 0 ? handle_subscription(handle, (unsigned)number) : NULL;
    PyObject *result = NULL;
    if (subscription)
        result = Py_BuildValue("(y#KK)", subscription->text ? subscription->text : "", (Py_ssize_t)subscription->length,
                               (unsigned long long)subscription->lost, (unsigned long long)subscription->lost_since);
    else
        PyErr_Format(PyExc_ValueError, "there is no subscription %ld", number);
    if (result) {
        subscription->length = 0;
        subscription->lost = 0;
    }
    leave(self);
    return result;
}

/* ---- The type --------------------------------------------------------------------------------------------------------- */

static PyObject *sim_close(struct sim_object *self, PyObject *unused)
{
    (void)unused;
    if (!self->handle)
        return none();
    struct handle *handle = enter(self);
    if (!handle)
        return NULL;
    self->handle = NULL;
    leave(self);
    handle_free(handle);
    return none();
}

static void sim_dealloc(struct sim_object *self)
{
    PyTypeObject *type = Py_TYPE(self);
    handle_free(self->handle);
    freefunc free_object = (freefunc)PyType_GetSlot(type, Py_tp_free);
    free_object(self);
    Py_DECREF(type);
}

static PyObject *sim_new(PyTypeObject *type, PyObject *args, PyObject *keywords)
{
    static char *names[] = {"options", NULL};
    const char *text;
    struct refusal refusal;
    if (!PyArg_ParseTupleAndKeywords(args, keywords, "s:Sim", names, &text))
        return NULL;
    json_t *options = load(text);
    allocfunc allocate = (allocfunc)PyType_GetSlot(type, Py_tp_alloc);
    struct sim_object *self = options ? (struct sim_object *)allocate(type, 0) : NULL;
    if (self) {
        self->handle = handle_new(options, &refusal);
        if (self->handle) {
            self->handle->paused = paused;
            self->handle->paused_context = self;
        } else {
            refuse_call(&refusal);
            Py_DECREF(self);
            self = NULL;
        }
    }
    json_decref(options);
    return (PyObject *)self;
}

static PyMethodDef sim_methods[] = {
    METHOD("call", sim_call, METH_VARARGS, "call(method, params): execute a method of the control socket; JSON in, JSON out."),
    METHOD("now", sim_now_, METH_NOARGS, "now(): present tick, us."),
    METHOD("next_event", sim_next_event_, METH_NOARGS, "next_event(): tick before which nothing happens, or None."),
    METHOD("axis", sim_axis_, METH_VARARGS, "axis(unit, motor): (position, true_position, state, speed, fault, led)."),
    METHOD("advance", sim_advance_, METH_O, "advance(tick): let time pass up to the tick."),
    METHOD("wait_byte", sim_wait_byte, METH_VARARGS,
           "wait_byte(tick, count=1, stop=-1): let time pass until the host has so many bytes, or that one, up to the tick."),
    METHOD("write", sim_write, METH_O, "write(data): the host sends; returns the tick of its end."),
    METHOD("configure", sim_configure, METH_VARARGS, "configure(baud, data_bits, parity, stop_halves): the host's port."),
    METHOD("read", sim_read, METH_O, "read(most): bytes that were received; -1: all."),
    METHOD("read_ticks", sim_read_ticks, METH_O, "read_ticks(most): the same as a list of (tick, byte)."),
    METHOD("in_waiting", sim_in_waiting, METH_NOARGS, "in_waiting(): how many received bytes can be read."),
    METHOD("lost", sim_lost, METH_NOARGS, "lost(): how many bytes were dropped because they were not read in time."),
    METHOD("set_break", sim_break_, METH_O, "set_break(on): the host holds the wires at 0, or releases them."),
    METHOD("purge", sim_purge_, METH_NOARGS, "purge(): drop bytes that were written but not sent yet."),
    METHOD("is_idle", sim_is_idle, METH_NOARGS, "is_idle(): no byte is being sent, no answer is due."),
    METHOD("frame", sim_frame, METH_VARARGS, "frame(node, message): bytes on the wires."),
    METHOD("hear_message", sim_receive_message, METH_O, "hear_message(tick): (dnode, snode, message) or None at the tick."),
    METHOD("events", sim_events, METH_O, "events(subscription): take (lines of JSON, lost, tick of the first lost)."),
    METHOD("close", sim_close, METH_NOARGS, "close(): close its files and free it."),
    {NULL, NULL, 0, NULL},
};

static PyType_Slot sim_slots[] = {
    {Py_tp_doc, "Sim(options): a bus in virtual time."},
    {Py_tp_new, (void *)sim_new},
    {Py_tp_dealloc, (void *)sim_dealloc},
    {Py_tp_methods, sim_methods},
    {0, NULL},
};

PyType_Spec sim_spec = {
    .name = "rkm04._sim.Sim",
    .basicsize = sizeof(struct sim_object),
    .flags = Py_TPFLAGS_DEFAULT,
    .slots = sim_slots,
};
