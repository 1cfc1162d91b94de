/* SPDX-License-Identifier: MIT */
#include "client_help.h"

#include <stdio.h>
#include <string.h>

#include "client_port.h"
#include "text/text.h"

#define UNIT_OPTIONS "  -p PORT, -n NODE, --timeout=MS, --framing=NAME, --json"
#define MOTOR_OPTIONS "  -m MOTOR\n" UNIT_OPTIONS
#define EMULATOR_OPTIONS "  -c PATH, --line=N, --timeout=MS, --json"

static const struct help {
    const char *name, *usage, *text, *options, *examples;
} commands[] = {
    {"version", "version", "The unit's version text.", UNIT_OPTIONS, "  rkmctl -p " CLIENT_PORT_EXAMPLE " version\n"},
    {"set", "set TEXT",
     "Send a program text in one message; the unit begins to execute it. If it\n"
     "refuses the text, its flag and the place are shown.",
     "  --allow-overflow\n" MOTOR_OPTIONS, "  rkmctl -m 2 set \"\\ S100 V1000 A2000 F5000 R\"\n"},
    {"send", "send FILE",
     "Check a program file and send it, in several messages if it is long; - is\n"
     "standard input.",
     "  --allow-overflow, --message-max=BYTES\n" MOTOR_OPTIONS, "  rkmctl -n 3 -m 2 send drill.rks\n"},
    {"store", "store", "Write the program in memory to flash; the unit starts it at power-up.", MOTOR_OPTIONS,
     "  rkmctl -m 0 store\n"},
    {"position", "position", "The position counter; with -m 0 those of all motors.", MOTOR_OPTIONS,
     "  rkmctl -m 0 --json position\n"},
    {"command", "command", "The program in memory.", MOTOR_OPTIONS, "  rkmctl -m 1 command\n"},
    {"table", "table", "Break points of the present motion: (step;speed).", MOTOR_OPTIONS, "  rkmctl -m 1 table\n"},
    {"progress", "progress", "Steps done in the present motion, and the place of the present command.", MOTOR_OPTIONS,
     "  rkmctl -m 1 progress\n"},
    {"raw", "raw HEX", "Send these bytes as a message and show those of the answer.", UNIT_OPTIONS, "  rkmctl raw 04 31\n"},
    {"pmc", "pmc COMMAND [...]",
     "A PMC-1HS or PMC-2HS, on its line of text, by Modbus (--face modbus) or, with\n"
     "--control, in an emulator:\n"
     "  run [AXES] [REG]           run the program; AXES is x, y or xy, without it all\n"
     "  jog x+|x-|y+|y-...         move until stopped\n"
     "  move [by] x=N y=N          to a position, or by a distance, in pulses\n"
     "  speed x=N y=N              their speed, 1 to 8000 times the multiplier\n"
     "  stop [AXES] [now]          stop with a ramp; now: without (Modbus, --control)\n"
     "  home [AXES]                home search\n"
     "  position                   the counters\n"
     "  errors [clear [AXES]]      show or clear the errors\n"
     "  program get|put FILE       the program of all axes (Modbus, --control)\n"
     "  parameters get|put FILE    the parameters likewise\n"
     "  store [AXES]               keep program and parameters in flash likewise",
     "  -p PORT, --face=NAME, -n NODE, --baud=RATE\n  -c PATH, -u UNIT, --timeout=MS, --json",
     "  rkmctl -p " CLIENT_PORT_EXAMPLE " pmc move x=1000 y=-5\n"
     "  rkmctl -p " CLIENT_PORT_EXAMPLE " --face modbus pmc program put drill.pmc\n"},
    {"state", "state", "Everything about the unit, or about all units.", "  -u UNIT\n" EMULATOR_OPTIONS,
     "  rkmctl state --json\n"},
    {"watch", "watch", "The front panel of the units, live.", "  --once\n" EMULATOR_OPTIONS, "  rkmctl watch\n"},
    {"di", "di [N=LEVEL...]", "The inputs; with N=LEVEL set them.", "  -u UNIT\n" EMULATOR_OPTIONS, "  rkmctl di 3=1 5=0\n"},
    {"wait", "wait CONDITION",
     "Wait until the condition holds; exit status 3 if it does not within --limit of\n"
     "virtual time. `rkmctl --help' lists the conditions.",
     "  --limit=TIME, --advance, -u UNIT\n" EMULATOR_OPTIONS,
     "  rkmctl wait \"m1.position>=5000\" --limit 10s\n  rkmctl wait --advance idle\n"},
    {"advance", "advance TIME|CONDITION", "Advance a stepped clock by a time, or until a condition holds.",
     "  --limit=TIME, -u UNIT\n" EMULATOR_OPTIONS, "  rkmctl advance 250ms\n  rkmctl advance m1.idle --limit 60s\n"},
    {"events", "events [KIND...] [motor=N] [cell=NAME...] [count=N]",
     "Print events, a line each; exit status 3 if there are fewer than count within\n"
     "--limit. docs/CONTROL.md describes the kinds.",
     "  --limit=TIME, -u UNIT\n" EMULATOR_OPTIONS, "  rkmctl events motion command motor=1 count=4\n"},
    {"snapshot", "snapshot NAME|file=PATH", "Save the state of everything, under a name or in a file.",
     "  --force\n" EMULATOR_OPTIONS, "  rkmctl snapshot homed\n"},
    {"restore", "restore NAME|file=PATH", "Return to a snapshot.", EMULATOR_OPTIONS, "  rkmctl restore homed\n"},
    {"reset", "reset", "Power off and on; flash is kept.", "  -u UNIT\n" EMULATOR_OPTIONS, "  rkmctl reset\n"},
    {"power", "power on|off", "The power switch.", "  -u UNIT\n" EMULATOR_OPTIONS, "  rkmctl -u 3 power off\n"},
    {"switch", "switch NODE [reset]", "The address switch S1, 1 to 16, read at power-up; with reset the power is\n"
     "switched off and on.",
     "  -u UNIT\n" EMULATOR_OPTIONS, "  rkmctl switch 5 reset\n"},
    {"clock", "clock [CLOCK]", "Show or set the clock: real, xN with N from 0.001 to 10000, max, stepped.", EMULATOR_OPTIONS,
     "  rkmctl clock x100\n"},
    {"fault", "fault [inject KIND NAME=VALUE...|clear [ID]]",
     "List injected faults; inject one; clear one or all. docs/FAULTS.md has the\n"
     "kinds with their parameters, `rkmctl call fault.kinds' those of this device.",
     "  -u UNIT\n" EMULATOR_OPTIONS,
     "  rkmctl fault inject drop direction=to_master count=1\n  rkmctl fault clear\n"},
    {"plant", "plant [set FILE|none|motor=N NAME=VALUE...]", "Show, attach or change the simulated mechanics.",
     "  -u UNIT\n" EMULATOR_OPTIONS, "  rkmctl plant set axis.yaml\n  rkmctl plant motor=1 jammed=true\n"},
    {"cib", "cib status [A|B]|command A|B NUMBER [P1 [P2]]|di|do [N=LEVEL...]|pwm [N DUTY]|config [get|put FILE|apply]",
     "A CIB module: its drives; a command to one; inputs as they show and buttons;\n"
     "outputs; duty of a PWM output in 0.01 %; the configuration that is proposed, as\n"
     "a file has it: show it, read it from a file, apply it.",
     "  -u UNIT\n" EMULATOR_OPTIONS,
     "  rkmctl cib command A 102 3000 500\n  rkmctl cib config put two-drives.yaml\n  rkmctl cib config apply\n"},
    {"cnc",
     "cnc get CELL...|set CELL=VALUE...|cells [TEXT]|start|stop|reset|jog AXIS[+|-]...|home AXIS|panel NAME=VALUE...|"
     "load FILE...|plc [FIRST [LINES]]",
     "A CNC872: values of cells between CNC system and PLC program; set them; list\n"
     "those with a text in their names; keys of the panel; jog begins a motion with +\n"
     "or - and ends it without; what else the panel has (docs/CNC872.md); load texts:\n"
     ".plc is a PLC program, .yaml switches, anything else an NC program; plc lists\n"
     "the PLC program that runs, with values of cells.",
     "  -u UNIT\n" EMULATOR_OPTIONS,
     "  rkmctl cnc get PO_STOP B_INK_EX[0]\n  rkmctl cnc set STOP_REQ=1\n  rkmctl cnc panel mode=manual feed=50\n"
     "  rkmctl cnc jog X+\n  rkmctl cnc load mill.plc\n"},
    {"trace", "trace start FILE|stop [NUMBER]", "Begin a trace (" TRACE_ENDINGS ", " WIRE_ENDINGS "), or end it.",
     "  --force\n" EMULATOR_OPTIONS, "  rkmctl trace start run.vcd\n"},
    {"call", "call METHOD [JSON|NAME=VALUE...]", "Any other method of the control socket.", EMULATOR_OPTIONS,
     "  rkmctl call units\n"},
    {"window", "window", "The service program in a browser, for real and virtual units.",
     "  -p PORT, -c PATH, --http=ADDRESS:PORT, --open", "  rkmctl window --open\n"},
    {"shutdown", "shutdown", "End the emulator, and wait until it has ended.", EMULATOR_OPTIONS,
     "  rkmctl shutdown\n"},
    {"shell", "shell",
     "Type commands and program text; Tab completes, the history is kept. A line that\n"
     "begins with a small letter is a command, any other is program text for the\n"
     "present motor; `node N' and `motor M' choose. With -f FILE the commands of a\n"
     "file.",
     "  -f FILE and those of all commands", "  rkmctl -p " CLIENT_PORT_EXAMPLE " shell\n  rkmctl shell -f check.txt\n"},
};

#define COMMANDS (sizeof commands / sizeof commands[0])

const char *client_help_name(unsigned i)
{
    return i < COMMANDS ? commands[i].name : NULL;
}

bool client_help_show(const char *command)
{
    for (size_t i = 0; i < COMMANDS; i++) {
        const struct help *help = &commands[i];
        if (strcmp(help->name, command) != 0)
            continue;
        printf("Usage: rkmctl [OPTION...] %s\n%s\n\nOptions (`rkmctl --help' describes them):\n%s\n\nExamples:\n%s\n"
               "Exit status: 0 success, 1 failure, 2 wrong usage, 3 no answer, or not in time\n", help->usage, help->text,
               help->options, help->examples);
        return true;
    }
    return false;
}

bool client_help_wanted(int argc, char **argv)
{
    const char *command = NULL;
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
        if (command != NULL && (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-?") == 0))
            return client_help_show(command);
        for (size_t k = 0; command == NULL && k < COMMANDS; k++)
            if (strcmp(argv[i], commands[k].name) == 0)
                command = commands[k].name;
    }
    return false;
}
