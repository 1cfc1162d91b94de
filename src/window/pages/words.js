// SPDX-License-Identifier: MIT
// The words of the page. The Czech ones are those of the unit's manual.
const words = {
  en: {
    service: "Service", panel: "Panel", stop: "Stop all", language: "Language", theme: "Colours", "theme-auto": "as the system",
    "theme-light": "light", "theme-dark": "dark", port: "Port", framing: "Framing", baud: "19200 baud, 8N1", connect: "Connect",
    disconnect: "Disconnect", find: "Find ports", motor: "Motor", message: "Message", bytes: "Bytes (hex)", send: "Send",
    broadcast: "To all units (DNode 0): no unit answers.", open: "Open", save: "Save", format: "Format", file: "File",
    answers: "Answers", search: "Search", "save-text": "Save as text", clear: "Clear", positions: "Positions",
    poll: "Ask repeatedly",
    rate: "Rate", "positions-graph": "Positions over the last minute", profile: "Profile of the present motion (Get Tabul Run)",
    "profile-none": "Send Get Tabul Run to see the present motion.", "profile-empty": "No motion.", emulator: "Emulator",
    bus: "Bus",
    show: "Show", clock: "Clock", "snapshot-name": "Snapshot", snapshot: "Take", restore: "Return to it", "record-kind": "Trace",
    record: "Start trace", "record-stop": "Stop trace", recording: "Save recording", faults: "Injected faults",
    "clear-faults": "Clear all faults", inject: "Inject", plant: "Mechanics", "plant-open": "Attach plant file",
    "plant-none": "Remove plant",
    dialogue: "Dialogue on the bus", "no-emulator": "No emulator is running. Start one: rkm04 serve",
    lost: "The connection to rkmctl window is lost; trying again …",
    connected: "Port {0} is open.", closed: "No port is open.", "stop-done": "Stop sent (K to unit and bus) in {0} ms.",
    "stop-failed": "Stop could not be sent: no port is open.", errors: "{0} errors, {1} warnings",
    "no-errors": "The unit takes the text.",
    refused: "Refused", sent: "sent", silent: "no answer", cancelled: "stopped", power: "Power", reset: "Reset",
    idle: "until idle",
    state: "State", command: "Command", waits: "Waits for", position: "Position", "true-position": "True position",
    speed: "Speed",
    loops: "Loops, calls", guards: "Guards", jammed: "jammed", lead: "lead missing", unit: "Unit",
    "speed-graph": "Speed and position of motors 1 to 4 over the last minute",
    axis: "Axis of motor {0}", "power-up": "S1 (counts at power-up): node {0}", ask: "asks", answer: "answers",
    ended: "The emulator has ended; waiting for it …",
    flag0: "ok", flag1: "bad value after {0}", flag2: "unknown command {0}", flag3: "memory overflowed",
    stored: "stored in flash",
    "not-stored": "flash error {0}", steps: "{0} steps done, place {1}", unknown: "unknown message {0}",
    pieces: "{0} commands in {1} messages",
    all: "all", level: "level", rtt: "round trip", done: "done", clearone: "Clear",
    programs: "Programs", "no-program": "No program in memory.", "lost-steps": "({0} steps lost)", address: "Address",
    "address-up": "Address (counts at power-up): {0}",
  },
  cs: {
    service: "Servis", panel: "Panel", stop: "Zastavit vše", language: "Jazyk", theme: "Barvy", "theme-auto": "podle systému",
    "theme-light": "světlé", "theme-dark": "tmavé", port: "Port", framing: "Rámce", baud: "19200 Bd, 8N1",
    connect: "Inicializace",
    disconnect: "Odpojit", find: "Najít porty", motor: "Motor", message: "Typ zprávy", bytes: "Bajty (hex)", send: "Odeslat",
    broadcast: "Všem jednotkám (DNode 0): žádná neodpovídá.", open: "Otevřít", save: "Uložit", format: "Upravit", file: "Soubor",
    answers: "Odpovědi", search: "Hledat", "save-text": "Uložit jako text", clear: "Smazat", positions: "Pozice",
    poll: "Číst opakovaně",
    rate: "Četnost", "positions-graph": "Pozice za poslední minutu", profile: "Průběh současného pohybu (Get Tabul Run)",
    "profile-none": "Současný pohyb ukáže zpráva Get Tabul Run.", "profile-empty": "Motor se nepohybuje.", emulator: "Emulátor",
    bus: "Sběrnice",
    show: "Zobrazit", clock: "Čas", "snapshot-name": "Snímek", snapshot: "Uložit snímek", restore: "Vrátit se k němu",
    "record-kind": "Záznam průběhu",
    record: "Spustit záznam", "record-stop": "Ukončit záznam", recording: "Uložit nahrávku", faults: "Vložené poruchy",
    "clear-faults": "Zrušit všechny poruchy", inject: "Vložit", plant: "Mechanika", "plant-open": "Připojit soubor mechaniky",
    "plant-none": "Odebrat mechaniku",
    dialogue: "Dialog na sběrnici", "no-emulator": "Žádný emulátor neběží. Spustit: rkm04 serve",
    lost: "Spojení s rkmctl window je přerušeno; zkouší se znovu …",
    connected: "Port {0} je otevřen.", closed: "Žádný port není otevřen.",
    "stop-done": "Stop odeslán (K jednotce a sběrnici) za {0} ms.",
    "stop-failed": "Stop nelze odeslat: žádný port není otevřen.", errors: "chyby: {0}, varování: {1}",
    "no-errors": "Jednotka text přijme.",
    refused: "Odmítnuto", sent: "odesláno", silent: "bez odpovědi", cancelled: "zastaveno", power: "Napájení", reset: "Reset",
    idle: "do klidu",
    state: "Stav", command: "Povel", waits: "Čeká na", position: "Pozice", "true-position": "Skutečná pozice", speed: "Rychlost",
    loops: "Cykly, volání", guards: "Hlídání", jammed: "zablokováno", lead: "chybí fáze", unit: "Jednotka",
    "speed-graph": "Rychlost a pozice motorů 1 až 4 za poslední minutu",
    axis: "Osa motoru {0}", "power-up": "S1 (platí po zapnutí): adresa {0}", ask: "se ptá", answer: "odpovídá",
    ended: "Emulátor skončil; čeká se na něj …",
    flag0: "v pořádku", flag1: "chybná hodnota za {0}", flag2: "neznámý povel {0}", flag3: "přetečení paměti programu",
    stored: "uloženo do FLASH",
    "not-stored": "chyba zápisu do FLASH {0}", steps: "vykonáno kroků {0}, povel {1}", unknown: "neznámá zpráva {0}",
    pieces: "povelů {0}, zpráv {1}",
    all: "všechny", level: "úroveň", rtt: "doba odezvy", done: "hotovo", clearone: "Zrušit",
    programs: "Programy", "no-program": "V paměti není program.", "lost-steps": "(ztracené kroky: {0})", address: "Adresa",
    "address-up": "Adresa (platí po zapnutí): {0}",
  },
};

let language = "en";

export function setLanguage(name) {
  language = words[name] ? name : "en";
  document.documentElement.lang = language;
  for (const element of document.querySelectorAll("[data-word]"))
    element.textContent = word(element.dataset.word);
  for (const element of document.querySelectorAll("[data-label]"))
    element.setAttribute("aria-label", word(element.dataset.label));
}

export function languageName() { return language; }

export function word(name, ...values) {
  return (words[language][name] ?? name).replace(/\{(\d)\}/g, (_, at) => values[at]);
}

export const wordNames = Object.keys(words.en);
export const missingWords = Object.keys(words.en).filter((name) => !(name in words.cs));
