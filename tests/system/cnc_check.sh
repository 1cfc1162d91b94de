#!/bin/bash
# SPDX-License-Identifier: MIT
# rkm04 check on texts of a CNC872: configuration, NC program, PLC program.
. "${0%/*}/lib.sh"
documents=$(cd "${0%/*}/../../docs" && pwd)/CNC872.md

texts() {
    cd "$folder" || exit 1
    printf '<ChannelConfig>\n <Axis Name="X"/>\n <Axis Name="4"/>\n</ChannelConfig>\n' >mill.xml
    printf 'G1 X10 A4=5 F1000\n' >part.nc
    printf 'MODULE_MAIN\n LDR STOPPI\nMODULE_MAIN_END\n' >MILL.PLC
}

test_texts_without_errors_say_nothing() {
    texts
    exits 0 "$RKM04" check --config mill.xml mill.xml part.nc MILL.PLC
    same "" "$said$complained" "output"
}

test_errors_have_their_line_and_column() {
    texts
    printf '; c\n\nMODULE_MAIN\n  LDR  STOPPY ;\n TIM 3\nMODULE_MAIN_END' >bad.plc
    exits 1 "$RKM04" check bad.plc
    same "bad.plc:4:8: error: there is no cell \`STOPPY' [plc-error]
    LDR  STOPPY ;
         ^~~~~~
  hint: did you mean \`STOPPI'?
bad.plc:5:2: error: unknown instruction \`TIM' [plc-error]
   TIM 3
   ^~~" "$said" "bad.plc"
    exits 1 "$RKM04" check part.nc
    holds "$said" "part.nc:1:8: error: " "an axis that X, Y, Z do not have"
    printf 'G1 Y1 F100\n' >y.nc
    exits 1 "$RKM04" check --config mill.xml y.nc
    holds "$said" "[nc-error]" "an axis that the machine does not have"
    printf '<ChannelConfig><Axis/></ChannelConfig>' >bad.xml
    exits 1 "$RKM04" check --config bad.xml y.nc
    holds "$said" "bad.xml:1:" "the configuration"
    holds "$said" "[config-error]" "the configuration"
    exits 1 "$RKM04" check --config none.xml y.nc
    holds "$complained" "cannot read none.xml" "stderr"
}

test_what_is_no_program_is_refused_by_its_name() {
    texts
    echo 'switches: []' >m.machine.yaml
    exits 2 "$RKM04" check m.machine.yaml
    holds "$complained" "m.machine.yaml: expected a program; \`rkm04 test' runs scenarios" "stderr"
}

test_a_slip_in_a_name_has_the_nearest_as_a_hint() {
    texts
    printf '%s\n' DATA 'CLAMP_I BIT 0' DATA_END MODULE_MAIN ' LRD STOPPI' ' LDR STPPI' ' LDR CLAPM_I' ' LDR kxh0' \
        'MECH_BEGIN OPEN' ' LDR KHX0' 'MECH_END OPEN' ' FL 1,OEPN' ' LDR NOTHING_LIKE_IT' MODULE_MAIN_END >slip.plc
    exits 1 "$RKM04" check slip.plc
    same "LDR STOPPI CLAMP_I KHX0 OPEN" "$(sed -n "s/.*hint: did you mean \`\(.*\)'?/\1/p" <<<"$said" | xargs)" "the hints"
    same 6 "$(grep -c 'error: ' <<<"$said")" "errors"
}

test_errors_as_json() {
    texts
    printf 'LDR A\n' >a.plc
    exits 1 "$RKM04" check --json a.plc mill.xml
    same "1 a.plc 1 1 plc-error" "$(python3 -c 'import json, sys
all = json.load(sys.stdin); one = all["diagnostics"][0]
print(all["errors"], one["file"], one["line"], one["column"], one["name"])' <<<"$said")" "json"
}

test_programs_of_the_documentation_have_no_errors() {
    python3 - "$documents" "$folder" <<'END'
import re, sys
blocks = re.findall(r"^```\w*\n(.*?)^```", open(sys.argv[1], encoding="utf-8").read(), re.M | re.S)
programs = [block for block in blocks if "MODULE_" in block]
assert programs
for number, program in enumerate(programs):
    open(f"{sys.argv[2]}/{number}.plc", "w", encoding="utf-8").write(program)
END
    exits 0 "$RKM04" check "$folder"/*.plc
}

run_cases "$@"
