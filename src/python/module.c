/* SPDX-License-Identifier: MIT */
/* The extension rkm04._sim. It keeps to the stable ABI, so one build serves every Python from 3.9 on. python/rkm04/_sim.pyi
 * lists what it has; the package documents what it does. */
#include "sim_type.h"

#include <stdlib.h>
#include <string.h>

PyObject *error_type, *refused_type, *busy_type, *closed_type;

PyObject *frame_message(const struct rkm04_framing *framing, int node, const uint8_t *message, size_t length)
{
    struct rkm04_sender sender;
    uint8_t *out = malloc(length * RKM04_FRAME_EDGE_MAX + 2 * RKM04_FRAME_EDGE_MAX);
    if (!out)
        return PyErr_NoMemory();
    size_t written = framing->begin(&sender, (uint8_t)node, 0, length, false, out);
    for (size_t i = 0; i < length; i++)
        written += framing->put(&sender, message[i], out + written);
    written += framing->end(&sender, out + written);
    PyObject *result = PyBytes_FromStringAndSize((const char *)out, (Py_ssize_t)written);
    free(out);
    return result;
}

/* A time as people write it, "1.5s", in us. */
static PyObject *module_time(PyObject *module, PyObject *text)
{
    (void)module;
    Py_ssize_t length;
    uint64_t ticks;
    size_t wrong;
    const char *string;
    PyObject *bytes = PyUnicode_AsUTF8String(text);
    if (!bytes)
        return NULL;
    length = PyBytes_Size(bytes);
    string = PyBytes_AsString(bytes);
    const char *expected = time_value_read(string, (size_t)length, &ticks, &wrong);
    PyObject *result = NULL;
    if (expected)
        PyErr_Format(PyExc_ValueError, "expected %s, found %R", expected, text);
    else
        result = PyLong_FromUnsignedLongLong(ticks);
    Py_DECREF(bytes);
    return result;
}

/* A message in words, as in --wire FILE.log. */
static PyObject *module_words(PyObject *module, PyObject *args)
{
    (void)module;
    const char *message, *device;
    Py_ssize_t length;
    int answer;
    if (!PyArg_ParseTuple(args, "y#ps:words", &message, &length, &answer, &device))
        return NULL;
    const struct device_kind *kind = device_kind_named(device);
    if (!kind)
        return PyErr_Format(PyExc_ValueError, "unknown device %s", device);
    char *text = malloc(WIRE_WORDS_MAX);
    if (!text)
        return PyErr_NoMemory();
    struct wire_text out = {.text = text, .room = WIRE_WORDS_MAX};
    if (length > 0)
        wire_words_message(&out, kind->words, (const uint8_t *)message, (size_t)length, answer != 0);
    PyObject *result = PyUnicode_FromString(wire_text_end(&out));
    free(text);
    return result;
}

/* The bytes on the wires of a message to a node, in a framing of this name. */
static PyObject *module_frame(PyObject *module, PyObject *args)
{
    (void)module;
    const char *name, *message;
    Py_ssize_t length;
    int node;
    if (!PyArg_ParseTuple(args, "siy#:frame", &name, &node, &message, &length))
        return NULL;
    const struct rkm04_framing *framing = rkm04_framing_named(name);
    if (framing && node >= 0 && node <= 255 && length <= DEVICE_MESSAGE_MAX)
        return frame_message(framing, node, (const uint8_t *)message, (size_t)length);
    PyErr_Format(PyExc_ValueError, "expected framing hdlc or plain, a node from 0 to 255, and at most %d bytes",
                 (int)DEVICE_MESSAGE_MAX);
    return NULL;
}

/* The first whole message among bytes on the wires: (bytes up to its end, dnode, snode, message), or None. Times between the
 * bytes do not count. */
static PyObject *module_unframe(PyObject *module, PyObject *args)
{
    (void)module;
    const char *name, *bytes;
    Py_ssize_t length;
    struct rkm04_receiver receiver = {0};
    if (!PyArg_ParseTuple(args, "sy#:unframe", &name, &bytes, &length))
        return NULL;
    const struct rkm04_framing *framing = rkm04_framing_named(name);
    if (!framing)
        return PyErr_Format(PyExc_ValueError, "expected framing hdlc or plain, found %s", name);
    uint8_t *message = malloc((size_t)length + 1u);
    if (!message)
        return PyErr_NoMemory();
    PyObject *result = NULL;
    for (Py_ssize_t at = 0; at < length && !result && !PyErr_Occurred(); at++)
        if (framing->receive(&receiver, (uint8_t)bytes[at], 0, message, (size_t)length))
            result = Py_BuildValue("(niiy#)", at + 1, receiver.dnode, receiver.snode, (const char *)message,
                                   (Py_ssize_t)receiver.length);
    free(message);
    if (!result && !PyErr_Occurred()) {
        Py_INCREF(Py_None);
        return Py_None;
    }
    return result;
}

static PyMethodDef module_methods[] = {
    METHOD("time", module_time, METH_O, "time(text): us of a time as in \"1.5s\"."),
    METHOD("words", module_words, METH_VARARGS, "words(message, answer): the message in words."),
    METHOD("frame", module_frame, METH_VARARGS, "frame(framing, node, message): bytes on the wires."),
    METHOD("unframe", module_unframe, METH_VARARGS, "unframe(framing, data): (used, dnode, snode, message) or None."),
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef definition = {
    PyModuleDef_HEAD_INIT,
    .m_name = "rkm04._sim",
    .m_doc = "The simulation in this process. Use rkm04.Bus.",
    .m_size = -1,
    .m_methods = module_methods,
};

static PyObject *add_error(PyObject *module, const char *name, const char *full, const char *text, PyObject *base)
{
    PyObject *type = PyErr_NewExceptionWithDoc(full, text, base, NULL);
    if (!type)
        return NULL;
    Py_INCREF(type); /* one reference is the module's, one stays here */
    return PyModule_AddObject(module, name, type) == 0 ? type : NULL;
}

PyMODINIT_FUNC PyInit__sim(void)
{
    PyObject *module = PyModule_Create(&definition), *type = module ? PyType_FromSpec(&sim_spec) : NULL;
    if (!type || PyModule_AddObject(module, "Sim", type) != 0 ||
        PyModule_AddStringConstant(module, "version", RKM04_VERSION) != 0)
        return NULL;
    error_type = add_error(module, "Error", "rkm04.Error", "Base class of the errors of this package.", PyExc_RuntimeError);
    refused_type = add_error(module, "RefusedError", "rkm04.RefusedError",
                             "A request was refused; the text says why. `code` is that of JSON-RPC.", error_type);
    busy_type = add_error(module, "BusyError", "rkm04.BusyError", "Another thread uses the bus at the same time.", error_type);
    closed_type = add_error(module, "ClosedError", "rkm04.ClosedError", "The bus is closed.", error_type);
    return error_type && refused_type && busy_type && closed_type ? module : NULL;
}
