import { both } from "./both";
import { run } from "./run";

type Kinds = typeof run.en.fault;

/** A set of faults by its name: a kind, numbered where it is there more than once. */
function named(kinds: Kinds, none: string): (name: string) => string {
  return (name) => {
    if (name === "none" || name === "nothing") return none;
    const [kind, number] = name.split(" ");
    const known = kinds[kind as keyof Kinds] as string | undefined;
    return known === undefined ? name : number === undefined ? known : `${known} ${number}`;
  };
}

type Words = Readonly<Record<string, string>>;

/** A requirement, such as `success >= 0.98`, as a sentence in these words. */
function required(words: Words, least: string, most: string) {
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
    mayNotPlan: "You may look only: missions are evaluated by those with the role “plan”.",
    hasErrors: "The mission has errors: mend them first.",
    nothing: "There is nothing to evaluate yet.",
    how: "In which worlds, and how",
    hint: "The mission is run in many worlds: what checkpoints show, and what goes wrong, differs.",
    firstSeed: "First seed",
    ideal: "Also where nothing goes wrong",
    require: "Required: success in at least (%)",
    requireHint: "It stops as soon as this is decided.",
    width: "Or until the interval is no wider than (%)",
    vary: "What differs from world to world",
    ranges: {
      charge: "Charge at the start (%)",
      capacity: "Capacity that the battery has left (%)",
      speed: "Share of its speed (%)",
      offset: "The start is missed by up to (cm)",
    },
    from: (what: string) => `${what}, from`,
    to: (what: string) => `${what}, to`,
    badRange: (what: string) => `${what}: the least comes first, and both are there.`,
    found: "Evaluation",
    states: {
      running: "Running",
      done: "Done",
      failed: "Could not be evaluated",
      cancelled: "Ended by hand",
      interrupted: "Interrupted",
    },
    success: "successful",
    runsOf: (done: string, most: string) => `${done} of ${most} runs`,
    left: (time: string) => `at most ${time} left`,
    interval: (low: string, high: string) => `95 % interval: ${low} to ${high}`,
    kinds: {
      while: "(Wilson: while runs come it claims nothing)",
      whileMixed: "(Wilson over all runs: while they come it claims nothing; at the end a world counts as one)",
      exact: "(exact, Clopper-Pearson)",
      worlds: "(confidence sequence: a world with its several runs counts as one)",
      anyTime: "(confidence sequence: it holds whenever one stops, as the requirement decides that)",
      cutShort: (runs: string) =>
        `(confidence sequence: it holds whyever it was ended; of the ${runs} runs of the first worlds without a gap)`,
    },
    count: (runs: string) => `${runs} of them count`,
    serviceEnded: "The service ended before all was run.",
    enough: (done: string, planned: string) => `${done} of at most ${planned} runs: they were enough`,
    required: required(
      {
        success: "Success",
        detected: "All faults found",
        contact: "A contact",
        mishap: "Trouble on the way",
        late: "Too late",
        "false alarm": "A false alarm",
      },
      "in at least",
      "in at most",
    ),
    moreWorlds: "It takes more worlds to decide: evaluate once more in more of them, or require less.",
    underWay: "An evaluation of this mission is under way: wait for it, or end it.",
    busy: (name: string, author: string) => `“${name}” is being evaluated, begun by ${author}: wait for it, or end it there.`,
    which: "Evaluation of",
    begun: (when: string, state: string) => `${when}: ${state}`,
    forget: "Delete this evaluation",
    chart: "The rate of success and its interval, run by run",
    cancel: "End the evaluation",
    goOn: "Go on",
    stale: "The mission was changed since this was begun.",
    verdicts: { met: "is met", missed: "is missed", "not decided": "is not decided" },
    byFaults: "By what goes wrong",
    what: "What",
    share: "Success",
    runs: "Runs",
    times: (least: string, median: string, most: string) =>
      least === most ? `A success took ${median}.` : `A success took ${median} in the median, ${least} to ${most}.`,
    lost: (count: number) =>
      count === 1
        ? "1 run could not be carried out, and does not count."
        : `${count} runs could not be carried out, and do not count.`,
    failing: "Runs that are no success",
    failed: (seed: number, faults: string | null) => (faults === null ? `World ${seed}` : `World ${seed}, ${faults}`),
    more: (count: number) => `and ${count} more, in the report`,
    replaying: "It is made again…",
    replayed: (seed: number, faults: string) => `Run in world ${seed}, ${faults}: made again, as it went`,
    noPictures: "What the camera saw is not shown: pictures are kept of no run.",
    back: "Back to the evaluation",
    report: "Report with all tables and pictures",
    noFailure: "No run failed.",
    faultsNamed: named(run.en.fault, "no faults"),
  },
  {
    begin: "Bewerten",
    worlds: "Welten",
    mayNotPlan: "Sie dürfen nur zusehen: Missionen bewerten die mit der Rolle „plan“.",
    hasErrors: "Die Mission hat Fehler: beheben Sie diese zuerst.",
    nothing: "Es gibt noch nichts zu bewerten.",
    how: "In welchen Welten, und wie",
    hint: "Die Mission läuft in vielen Welten: was Prüfpunkte zeigen und was schiefgeht, ist verschieden.",
    firstSeed: "Erster Seed",
    ideal: "Auch dort, wo nichts schiefgeht",
    require: "Gefordert: Erfolg in mindestens (%)",
    requireHint: "Sobald das entschieden ist, hört sie auf.",
    width: "Oder bis das Intervall höchstens so breit ist (%)",
    vary: "Was von Welt zu Welt verschieden ist",
    ranges: {
      charge: "Ladung am Anfang (%)",
      capacity: "Verbliebene Kapazität der Batterie (%)",
      speed: "Anteil der Geschwindigkeit (%)",
      offset: "Der Anfang ist verfehlt um bis zu (cm)",
    },
    from: (what: string) => `${what}, von`,
    to: (what: string) => `${what}, bis`,
    badRange: (what: string) => `${what}: das Kleinere zuerst, und beide.`,
    found: "Bewertung",
    states: {
      running: "Läuft",
      done: "Fertig",
      failed: "Ließ sich nicht bewerten",
      cancelled: "Von Hand beendet",
      interrupted: "Unterbrochen",
    },
    success: "erfolgreich",
    runsOf: (done: string, most: string) => `${done} von ${most} Läufen`,
    left: (time: string) => `noch höchstens ${time}`,
    interval: (low: string, high: string) => `95-%-Intervall: ${low} bis ${high}`,
    kinds: {
      while: "(Wilson: solange Läufe kommen, behauptet es nichts)",
      whileMixed: "(Wilson über alle Läufe: solange sie kommen, behauptet es nichts; am Ende zählt eine Welt einmal)",
      exact: "(exakt, Clopper-Pearson)",
      worlds: "(Konfidenzfolge: eine Welt mit ihren Läufen zählt einmal)",
      anyTime: "(Konfidenzfolge: sie gilt, wann immer man aufhört, denn das entscheidet die Forderung)",
      cutShort: (runs: string) =>
        `(Konfidenzfolge: sie gilt, warum auch immer beendet wurde; von den ${runs} Läufen der ersten Welten ohne Lücke)`,
    },
    count: (runs: string) => `${runs} davon zählen`,
    serviceEnded: "Der Dienst endete, bevor alles gelaufen war.",
    enough: (done: string, planned: string) => `${done} von höchstens ${planned} Läufen: sie haben genügt`,
    required: required(
      {
        success: "Erfolg",
        detected: "Alle Fehler gefunden",
        contact: "Eine Berührung",
        mishap: "Schwierigkeiten unterwegs",
        late: "Zu spät",
        "false alarm": "Ein Fehlalarm",
      },
      "in mindestens",
      "in höchstens",
    ),
    moreWorlds: "Das zu entscheiden braucht mehr Welten: bewerten Sie in mehr davon, oder fordern Sie weniger.",
    underWay: "Diese Mission wird gerade bewertet: warten Sie, oder beenden Sie das.",
    busy: (name: string, author: string) => `„${name}“ wird gerade bewertet, begonnen von ${author}: warten Sie, oder beenden Sie es dort.`,
    which: "Bewertung vom",
    begun: (when: string, state: string) => `${when}: ${state}`,
    forget: "Diese Bewertung löschen",
    chart: "Der Anteil der Erfolge und sein Intervall, Lauf für Lauf",
    cancel: "Bewertung beenden",
    goOn: "Weitermachen",
    stale: "Die Mission wurde geändert, seit das begann.",
    verdicts: { met: "ist erfüllt", missed: "ist verfehlt", "not decided": "ist nicht entschieden" },
    byFaults: "Nach dem, was schiefgeht",
    what: "Was",
    share: "Erfolg",
    runs: "Läufe",
    times: (least: string, median: string, most: string) =>
      least === most ? `Ein Erfolg dauerte ${median}.` : `Ein Erfolg dauerte im Median ${median}, ${least} bis ${most}.`,
    lost: (count: number) =>
      count === 1
        ? "1 Lauf war nicht möglich und zählt nirgends."
        : `${count} Läufe waren nicht möglich und zählen nirgends.`,
    failing: "Läufe ohne Erfolg",
    failed: (seed: number, faults: string | null) => (faults === null ? `Welt ${seed}` : `Welt ${seed}, ${faults}`),
    more: (count: number) => `und ${count} weitere, im Bericht`,
    replaying: "Er wird noch einmal gemacht …",
    replayed: (seed: number, faults: string) => `Lauf in Welt ${seed}, ${faults}: noch einmal gemacht, wie er war`,
    noPictures: "Was die Kamera sah, wird nicht gezeigt: Bilder werden von keinem Lauf behalten.",
    back: "Zurück zur Bewertung",
    report: "Bericht mit allen Tabellen und Bildern",
    noFailure: "Kein Lauf ist misslungen.",
    faultsNamed: named(run.de.fault, "keine Fehler"),
  },
);
