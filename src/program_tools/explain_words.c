/* SPDX-License-Identifier: MIT */
#include "explain_words.h"

#include <stddef.h>
#include <string.h>

static const char *const language_names[] = {"en", "cs"};

enum explain_language explain_language_named(const char *name)
{
    unsigned i = 0;
    while (i < EXPLAIN_LANGUAGES && strcmp(language_names[i], name) != 0)
        i++;
    return (enum explain_language)i;
}

const char *explain_phrase(enum explain_phrase phrase, enum explain_language language)
{
    static const char *const phrases[PHRASES][EXPLAIN_LANGUAGES] = {
        [PHRASE_FORWARD] = {"forward", "vpřed"},
        [PHRASE_BACK] = {"back", "vzad"},
        [PHRASE_EITHER] = {"forward or back", "vpřed nebo vzad"},
        [PHRASE_STEPS] = {"%lld steps %s", "%lld kroků %s"},
        [PHRASE_SOME_STEPS] = {"the steps set before, %s", "počet kroků dle zadání, %s"},
        [PHRASE_COMPOUND] = {"compound motion of %u segments, %llu steps %s", "složený pohyb, %u úseků, %llu kroků %s"},
        [PHRASE_SOME_COMPOUND] = {"compound motion", "složený pohyb"},
        [PHRASE_NOTHING] = {"no steps are set: nothing moves", "počet kroků není zadán: bez pohybu"},
        [PHRASE_GUARD] = {"guarded by %c%02u", "hlídáno %c%02u"},
        [PHRASE_NEVER] = {"never executed", "nikdy se neprovede"},
        [PHRASE_SUBROUTINE] = {"subroutine", "podprogram"},
    };
    return phrases[phrase][language];
}

/* Numbers from low to high mean this; commands without a number have 0. */
static const struct meaning {
    char op;
    unsigned low, high;
    const char *words[EXPLAIN_LANGUAGES];
} meanings[] = {
    {'\\', 0, 0, {"reset: back to the start values S100 V1000 A2000", "reset: výchozí stav, S100 V1000 A2000"}},
    {'@', 1, 80, {"label %u", "návěští %u"}},
    {'A', 1, 60000, {"acceleration %u steps/s²", "zrychlení %u kroků/s²"}},
    {'B', 1, 16000000, {"set %u steps back", "pohyb vzad: zadá %u kroků"}},
    {'C', 1, 8, {"output %02u off", "zruš výstup %02u"}},
    {'C', 40, 40, {"T40 off: in a full memory, new commands overwrite old ones", "zruš funkci 40: plná paměť se přepisuje"}},
    {'C', 41, 41, {"T41 off: end of the simulation", "zruš funkci 41: konec simulace"}},
    {'C', 42, 50, {"function %u off (no effect)", "zruš funkci %u (bez účinku)"}},
    {'C', 51, 58, {"function %u off", "zruš funkci %u"}},
    {'C', 75, 75, {"resume the motion after K; only alone in a message", "obnovení pohybu po K; pouze samostatně"}},
    {'C', 80, 95, {"variable %u off", "zruš proměnnou %u"}},
    {'C', 100, 100, {"set the position counter to 0", "smaž čítač polohy"}},
    {'D', 0, 0, {"reverse the direction", "změna směru pohybu"}},
    {'E', 0, 0, {"end of the loop", "konec smyčky"}},
    {'F', 1, 16000000, {"set %u steps forward", "pohyb vpřed: zadá %u kroků"}},
    {'G', RKM04_G_FORWARD, RKM04_G_FORWARD, {"move forward without end", "trvale vpřed"}},
    {'G', RKM04_G_BACK, RKM04_G_BACK, {"move back without end", "trvale vzad"}},
    {'G', 1, 2000000000, {"move to position %u", "absolutní poloha: dojezd na %u"}},
    {'H', 0, 0, {"move to position 0", "výchozí poloha: pohyb na absolutní nulu"}},
    {'J', 1, 80, {"continue at label %u", "skok na návěští %u"}},
    {'K', 0, 0, {"stop the motion and the program; only alone in a message", "konec pohybu; pouze samostatně"}},
    {'L', 1, 255, {"loop: %u times", "začátek smyčky: %u opakování"}},
    {'M', 1, 8, {"guard: input %02u at 1 stops the next motion", "stop od BI True: vstup %02u v log. 1 ukončí pohyb"}},
    {'N', 1, 8, {"guard: input %02u at 0 stops the next motion", "stop od BI False: vstup %02u v log. 0 ukončí pohyb"}},
    {'O', 1, 8, {"wait until input %02u is 1", "BI True: čeká na vstup %02u v log. 1"}},
    {'O', 80, 95, {"wait until variable %u is 1", "BI True: čeká na proměnnou %u v log. 1"}},
    {'R', 0, 0, {"move", "proveď pohyb"}},
    {'S', 1, 2000, {"start/stop speed %u steps/s", "startovní rychlost %u kroků/s"}},
    {'T', 1, 8, {"output %02u on", "nastav výstup %02u"}},
    {'T', 40, 40, {"T40 on: a full memory accepts no more commands", "nastav funkci 40: plná paměť další povely nepřijme"}},
    {'T', 41, 41, {"T41 on: simulation, the unit makes no pulses", "nastav funkci 41: simulace bez výstupních signálů"}},
    {'T', 42, 50, {"function %u on (no effect)", "nastav funkci %u (bez účinku)"}},
    {'T', 51, 58, {"function %u on: its output is set when the last segment begins",
                   "nastav funkci %u: výstup na začátku posledního úseku"}},
    {'T', 80, 95, {"variable %u on", "nastav proměnnou %u"}},
    {'U', 0, 0, {"end of guards M and N", "reset stop od BI"}},
    {'V', 1, 16000, {"maximum speed %u steps/s", "maximální rychlost %u kroků/s"}},
    {'W', 1, 16000000, {"dwell %u ms", "čekání %u ms"}},
    {'X', 1, 8, {"total stop: input %02u at 1 ends the program", "total stop od BI True: vstup %02u v log. 1 ukončí program"}},
    {'Y', 0, 0, {"segment of a compound motion", "složený pohyb: úsek do tabulky"}},
    {'Z', 1, 8, {"wait until input %02u is 0", "BI False: čeká na vstup %02u v log. 0"}},
    {'Z', 80, 95, {"wait until variable %u is 0", "BI False: čeká na proměnnou %u v log. 0"}},
    {')', 1, 8, {"move forward at start/stop speed until input %02u is 1", "limit vpřed: startovní rychlostí na vstup %02u"}},
    {'(', 1, 8, {"move back at start/stop speed until input %02u is 1", "limit vzad: startovní rychlostí na vstup %02u"}},
    {'=', 0, UINT32_MAX, {"set the position counter to %d", "zapiš absolutní polohu %d"}},
    {'\'', 1, 80, {"call the subroutine at label %u", "volání podprogramu na návěští %u"}},
    {'.', 0, 0, {"end of the subroutine", "konec podprogramu"}},
    {'[', 0, 0, {"wait until ] is in memory, then execute what follows", "program: čeká na konec programu ]"}},
    {']', 0, 0, {"the commands after [ may be executed", "konec programu: povely od [ se vykonají"}},
};

const char *explain_template(struct rkm04_command command, enum explain_language language)
{
    static const char *const jump_if[EXPLAIN_LANGUAGES] = {"if %s %02u is %u, continue at label %u",
                                                           "podmíněný skok: je-li %s %02u v log. %u, na návěští %u"};
    if (command.op == 'I')
        return jump_if[language];
    for (size_t i = 0; i < sizeof meanings / sizeof meanings[0]; i++) {
        const struct meaning *one = &meanings[i];
        if (one->op == (char)command.op && one->low <= command.argument && command.argument <= one->high)
            return one->words[language];
    }
    return "?";
}
