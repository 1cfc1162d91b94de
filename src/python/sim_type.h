/* SPDX-License-Identifier: MIT */
/* sim_type.h: what the two halves of the extension rkm04._sim share. Python comes first: it sets what the system's headers
 * show. */
#ifndef RKM04_PYTHON_SIM_TYPE_H
#define RKM04_PYTHON_SIM_TYPE_H

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x03090000
#include <Python.h>

#include "handle.h"

#define METHOD(name, function, flags, text) {name, (PyCFunction)(void (*)(void))(function), flags, text}

extern PyObject *error_type, *refused_type, *busy_type, *closed_type; /* of errors: module.c */
extern PyType_Spec sim_spec;                                          /* of the type Sim: sim_type.c */

/* The bytes on the wires of a message to a node. Returns a bytes object. */
PyObject *frame_message(const struct rkm04_framing *framing, int node, const uint8_t *message, size_t length);

#endif
