/* SPDX-License-Identifier: MIT */
/* cnc872.h: the face of the CNC872's core to other rooms. Clauses in brackets refer to docs/CNC872.md. */
#ifndef CNC872_CNC872_H
#define CNC872_CNC872_H

#include "cells.h"
#include "config.h"
#include "nc.h"
#include "operand.h"
#include "plc.h"

#endif
