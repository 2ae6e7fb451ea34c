/** Sentences of the service about the result of a run, which is English: in German if they are known, and
 * unchanged otherwise. `argo_env/run/result.py`, `termination.py` and `verdict_line.py` make them. */

import { both } from "./both";

type Phrases = readonly (readonly [english: RegExp, german: string])[];

const WORDS: Phrases = [
  [/^Success$/, "Erfolg"],
  [/^No success$/, "Kein Erfolg"],
  [/^Completed with failures$/, "Mit Fehlschlägen abgeschlossen"],
  [/^Interrupted$/, "Unterbrochen"],
  [/^Done$/, "Fertig"],
  [/^1 finding$/, "1 Befund"],
  [/^(\d+) findings$/, "$1 Befunde"],
  [/^1 late task$/, "1 verspätete Aufgabe"],
  [/^(\d+) late tasks$/, "$1 verspätete Aufgaben"],
  [/^1 contact$/, "1 Berührung"],
  [/^(\d+) contacts$/, "$1 Berührungen"],
  [/^1 mishap$/, "1 Zwischenfall"],
  [/^(\d+) mishaps$/, "$1 Zwischenfälle"],
];
const SENTENCES: Phrases = [
  [/^everything was done as planned$/, "alles wurde wie geplant erledigt"],
  [/^the mission was completed$/, "die Mission wurde abgeschlossen"],
  [
    /^the mission was aborted, and the robot returned to its dock$/,
    "die Mission wurde vorzeitig beendet, und der Roboter kehrte zu seiner Ladestation zurück",
  ],
  [
    /^the mission was aborted, and the robot went to a safe area$/,
    "die Mission wurde vorzeitig beendet, und der Roboter fuhr in einen sicheren Bereich",
  ],
  [
    /^the mission was aborted, and the robot did not reach the place where it should wait$/,
    "die Mission wurde vorzeitig beendet, und der Roboter erreichte den Ort nicht, an dem er warten sollte",
  ],
  [/^the mission was aborted$/, "die Mission wurde vorzeitig beendet"],
  [/^the mission was cancelled by a person$/, "die Mission wurde von einer Person beendet"],
  [/^the mission has not ended after (.+)$/, "die Mission war nach $1 noch nicht beendet"],
  [/^it was stopped after (.+), Argo's limit for a run$/, "die Fahrt wurde nach $1 beendet: Länger darf keine Fahrt dauern"],
  [/^it was stopped after (.+)$/, "die Fahrt wurde nach $1 beendet"],
  [
    /^the robot has stood still since (.+), waiting for an event, and nothing more occurs$/,
    "der Roboter steht seit $1 und wartet auf ein Ereignis, aber es geschieht nichts mehr",
  ],
  [
    /^the robot has stood still since (.+), paused, and nothing more occurs$/,
    "der Roboter steht seit $1, die Mission ist angehalten, und es geschieht nichts mehr",
  ],
  [
    /^the robot has stood still since (.+), held by its emergency stop, and nothing more occurs$/,
    "der Roboter steht seit $1, durch seinen Not-Halt, und es geschieht nichts mehr",
  ],
  [/^the battery was empty after (.+)$/, "die Batterie war nach $1 leer"],
  [/^it took (.+) of at most (.+)$/, "die Fahrt dauerte $1, erlaubt sind höchstens $2"],
  [/^the robot is not docked in starting area (\d+)$/, "der Roboter steht nicht an der Ladestation von Bereich $1"],
  [
    /^the robot is docked in starting area (\d+), not in (\d+)$/,
    "der Roboter steht an der Ladestation von Bereich $1, nicht an der von Bereich $2",
  ],
  [/^failed: (.+)$/, "fehlgeschlagen: $1"],
  [/^missed the time window: (.+)$/, "Zeitfenster verpasst: $1"],
  [/^done before this run: (.+)$/, "vor dieser Fahrt erledigt: $1"],
  [/^done by hand or skipped before this run: (.+)$/, "vor dieser Fahrt von Hand erledigt oder übersprungen: $1"],
  [/^passed over: (.+)$/, "durch eine Bedingung ausgelassen: $1"],
  [/^done by hand: (.+)$/, "von Hand erledigt: $1"],
  [/^skipped by a person: (.+)$/, "von einer Person übersprungen: $1"],
  [/^optional tasks that failed: (.+)$/, "fehlgeschlagene optionale Aufgaben: $1"],
];

/** What was noticed, behind the verdict of a run without success. */
const NOTICED = /^(.+)\. (\d+ (?:finding|late task|contact|mishap)s?\b[^:]*): (.+)$/;
/** The verdict behind what was noticed in a run with success. */
const COMPLETED = /^(.+)\. The (mission was completed.*)$/;

/** Translate each known part of a text; `separator` is between the parts. */
function translate(text: string, phrases: Phrases, separator: string): string {
  const parts = text.split(separator).map((part) => {
    const known = phrases.find(([english]) => english.test(part));
    return known === undefined ? part : part.replace(...known);
  });
  return parts.join(separator);
}

const germanWord = (word: string) => translate(word, WORDS, ", ");
const germanVerdict = (text: string) => translate(text, SENTENCES, "; ");

function germanHeadline(text: string): string {
  const [, verdict, counts, noticed] = NOTICED.exec(text) ?? [];
  if (verdict && counts && noticed) return `${germanVerdict(verdict)}. ${germanWord(counts)}: ${noticed}`;
  const [, before, completed] = COMPLETED.exec(text) ?? [];
  if (before && completed) return `${before}. ${germanVerdict(`the ${completed}`).replace(/^d/, "D")}`;
  return germanVerdict(text);
}

const unchanged = (text: string) => text;

export const service = both(
  { outcome: unchanged, verdict: unchanged, headline: unchanged },
  { outcome: germanWord, verdict: germanVerdict, headline: germanHeadline },
);
