import { both } from "./both";
import { run } from "./run";

type Kinds = typeof run.en.fault;

/** Return a function that names a set of faults: by its kind, with a number if the kind occurs more than once. */
function faultNamer(kinds: Kinds, none: string): (name: string) => string {
  return (name) => {
    if (name === "none" || name === "nothing") return none;
    const [kind, number] = name.split(" ");
    const known = kinds[kind as keyof Kinds] as string | undefined;
    return known === undefined ? name : number === undefined ? known : `${known} ${number}`;
  };
}

type Words = Readonly<Record<string, string>>;

/** Return a function that writes a requirement, such as `success >= 0.98`, as a sentence. */
function requirementWriter(words: Words, least: string, most: string) {
  return (requirement: string, percent: (part: number) => string): string => {
    const [, quantity = "", sign = "", number = ""] = /^([a-z ]+) (>=|<=) ([\d.e-]+)$/.exec(requirement) ?? [];
    const word = words[quantity];
    if (word === undefined) return requirement;
    return `${word} ${sign === ">=" ? least : most} ${percent(Number(number))}`;
  };
}

export const evaluate = both(
  {
    begin: "Evaluate",
    worlds: "Worlds",
    mayNotPlan: "You need the role “plan” to evaluate missions.",
    hasErrors: "The mission has errors: fix them first.",
    nothing: "There are no tasks to evaluate yet.",
    how: "Evaluation settings",
    neededDrive: "the fastest that the faults allow",
    hint: "Runs the mission in many worlds: values of checkpoints and faults differ from world to world.",
    firstSeed: "First world (random seed)",
    ideal: "Also without faults",
    require: "Required success rate (%)",
    requireHint: "The evaluation stops as soon as this is decided.",
    width: "Or stop when the 95 % range is at most this wide (%)",
    vary: "Differences between worlds",
    ranges: {
      charge: "Charge at the start (%)",
      capacity: "Remaining battery capacity (%)",
      speed: "Robot speed (%)",
      offset: "Error of the start pose, up to (cm)",
    },
    from: (what: string) => `${what}, from`,
    to: (what: string) => `${what}, to`,
    badRange: (what: string) => `${what}: enter both values, the smaller one first.`,
    found: "Evaluation",
    states: {
      running: "Running",
      done: "Done",
      failed: "Failed",
      cancelled: "Stopped by a person",
      interrupted: "Interrupted",
    },
    success: "successful",
    runsOf: (done: string, most: string) => `${done} of ${most} runs`,
    left: (time: string) => `at most ${time} left`,
    interval: (low: string, high: string) => `95 % range: ${low} to ${high}`,
    kinds: {
      while: "(preliminary until all runs are done)",
      whileMixed: "(preliminary, over all runs; in the end each world counts once)",
      exact: "(exact)",
      worlds: "(each world counts once, with all its runs)",
      anyTime: "(valid although the requirement decides when to stop)",
      cutShort: (runs: string) =>
        `(valid for any reason to stop; from the ${runs} runs of the first complete worlds)`,
    },
    count: (runs: string) => `${runs} of them count`,
    enough: (done: string, planned: string) => `${done} of at most ${planned} runs: no more were needed`,
    required: requirementWriter(
      {
        success: "Success",
        detected: "All faults detected",
        contact: "Contact",
        mishap: "Mishap",
        late: "Late end",
        "false alarm": "False alarm",
      },
      "in at least",
      "in at most",
    ),
    moreWorlds: "More worlds are needed to decide this: evaluate again in more worlds, or require less.",
    underWay: "An evaluation of this mission is running: wait for it, or stop it.",
    busy: (name: string, author: string) => `“${name}” is being evaluated, started by ${author}: wait for it, or stop it there.`,
    which: "Evaluation shown",
    begun: (when: string, state: string) => `${when}: ${state}`,
    forget: "Delete this evaluation",
    chart: "Success rate and its 95 % range, run by run",
    cancel: "Stop the evaluation",
    goOn: "Continue",
    stale: "The mission was changed after this evaluation began.",
    verdicts: { met: "met", missed: "not met", "not decided": "undecided" },
    byFaults: "By fault",
    what: "Fault",
    share: "Success",
    runs: "Runs",
    times: (least: string, median: string, most: string) =>
      least === most
        ? `Successful runs took ${median}.`
        : `Successful runs took ${least} to ${most}, half of them at most ${median}.`,
    lost: (count: number) =>
      count === 1
        ? "1 run could not be carried out and does not count."
        : `${count} runs could not be carried out and do not count.`,
    failing: "Unsuccessful runs",
    failed: (seed: number, faults: string | null) => (faults === null ? `World ${seed}` : `World ${seed}, ${faults}`),
    more: (count: number) => `and ${count} more, in the report`,
    replaying: "Repeating the run …",
    replayed: (seed: number, faults: string) => `Repeated run in world ${seed}, ${faults}`,
    noPictures: "Camera pictures are not shown: they are not stored.",
    back: "Back to the evaluation",
    report: "Report with all tables and pictures",
    noFailure: "No run failed.",
    faultsNamed: faultNamer(run.en.fault, "no faults"),
  },
  {
    begin: "Bewerten",
    worlds: "Welten",
    mayNotPlan: "Zum Bewerten von Missionen brauchen Sie die Rolle „plan“.",
    hasErrors: "Die Mission hat Fehler: Bitte beheben Sie diese zuerst.",
    nothing: "Es gibt noch keine Aufgaben zu bewerten.",
    how: "Einstellungen der Bewertung",
    neededDrive: "der schnellste, den die Störungen zulassen",
    hint: "Führt die Mission in vielen Welten aus: Werte der Prüfpunkte und Störungen sind in jeder Welt anders.",
    firstSeed: "Erste Welt (Zufallsstartwert)",
    ideal: "Auch ohne Störungen",
    require: "Geforderte Erfolgsquote (%)",
    requireHint: "Die Bewertung endet, sobald dies entschieden ist.",
    width: "Oder Ende, wenn der 95-%-Bereich höchstens so breit ist (%)",
    vary: "Unterschiede zwischen den Welten",
    ranges: {
      charge: "Ladestand zu Beginn (%)",
      capacity: "Verbliebene Kapazität der Batterie (%)",
      speed: "Geschwindigkeit des Roboters (%)",
      offset: "Abweichung der Startposition, bis zu (cm)",
    },
    from: (what: string) => `${what}, von`,
    to: (what: string) => `${what}, bis`,
    badRange: (what: string) => `${what}: Geben Sie beide Werte an, den kleineren zuerst.`,
    found: "Bewertung",
    states: {
      running: "Läuft",
      done: "Fertig",
      failed: "Fehlgeschlagen",
      cancelled: "Von einer Person beendet",
      interrupted: "Unterbrochen",
    },
    success: "erfolgreich",
    runsOf: (done: string, most: string) => `${done} von ${most} Fahrten`,
    left: (time: string) => `noch höchstens ${time}`,
    interval: (low: string, high: string) => `95-%-Bereich: ${low} bis ${high}`,
    kinds: {
      while: "(vorläufig, bis alle Fahrten fertig sind)",
      whileMixed: "(vorläufig, über alle Fahrten; am Ende zählt jede Welt einmal)",
      exact: "(exakt)",
      worlds: "(jede Welt zählt mit allen ihren Fahrten einmal)",
      anyTime: "(gültig, obwohl die Anforderung das Ende bestimmt)",
      cutShort: (runs: string) =>
        `(gültig, warum auch immer beendet wurde; aus den ${runs} Fahrten der ersten vollständigen Welten)`,
    },
    count: (runs: string) => `${runs} davon zählen`,
    enough: (done: string, planned: string) => `${done} von höchstens ${planned} Fahrten: Mehr waren nicht nötig`,
    required: requirementWriter(
      {
        success: "Erfolg",
        detected: "Alle Störungen erkannt",
        contact: "Berührung",
        mishap: "Zwischenfall",
        late: "Verspätetes Ende",
        "false alarm": "Fehlalarm",
      },
      "in mindestens",
      "in höchstens",
    ),
    moreWorlds: "Um dies zu entscheiden, sind mehr Welten nötig: Bewerten Sie noch einmal in mehr Welten, oder fordern Sie weniger.",
    underWay: "Diese Mission wird gerade bewertet: Warten Sie das Ende ab, oder beenden Sie die Bewertung.",
    busy: (name: string, author: string) =>
      `„${name}“ wird gerade bewertet, gestartet von ${author}: Warten Sie das Ende ab, oder beenden Sie die Bewertung dort.`,
    which: "Gezeigte Bewertung",
    begun: (when: string, state: string) => `${when}: ${state}`,
    forget: "Diese Bewertung löschen",
    chart: "Erfolgsquote und ihr 95-%-Bereich, Fahrt für Fahrt",
    cancel: "Bewertung beenden",
    goOn: "Fortsetzen",
    stale: "Die Mission wurde nach Beginn dieser Bewertung geändert.",
    verdicts: { met: "erfüllt", missed: "nicht erfüllt", "not decided": "nicht entschieden" },
    byFaults: "Nach Störung",
    what: "Störung",
    share: "Erfolg",
    runs: "Fahrten",
    times: (least: string, median: string, most: string) =>
      least === most
        ? `Erfolgreiche Fahrten dauerten ${median}.`
        : `Erfolgreiche Fahrten dauerten ${least} bis ${most}, die Hälfte davon höchstens ${median}.`,
    lost: (count: number) =>
      count === 1
        ? "1 Fahrt konnte nicht ausgeführt werden und zählt nicht."
        : `${count} Fahrten konnten nicht ausgeführt werden und zählen nicht.`,
    failing: "Erfolglose Fahrten",
    failed: (seed: number, faults: string | null) => (faults === null ? `Welt ${seed}` : `Welt ${seed}, ${faults}`),
    more: (count: number) => `und ${count} weitere, im Bericht`,
    replaying: "Die Fahrt wird wiederholt …",
    replayed: (seed: number, faults: string) => `Wiederholte Fahrt in Welt ${seed}, ${faults}`,
    noPictures: "Kamerabilder werden nicht gezeigt: Sie werden nicht gespeichert.",
    back: "Zurück zur Bewertung",
    report: "Bericht mit allen Tabellen und Bildern",
    noFailure: "Keine Fahrt ist fehlgeschlagen.",
    faultsNamed: faultNamer(run.de.fault, "keine Störungen"),
  },
);
