/** Messages about lines of a script, which the service words in English. In German those below are translated; others
 * stay as they are. */

import { language } from ".";

/** In a key `{}` stands for quoted words, and `<>` for any other part, such as a number, one of the fixed texts or a
 * list of them. */
const GERMAN: Readonly<Record<string, string>> = {
  // why a line is set aside
  "a comment": "ein Kommentar",
  "a courtesy": "eine Höflichkeit",
  "a field that a mission does not have": "ein Feld, das eine Mission nicht hat",
  "a field that a person fills in": "ein Feld, das jemand ausfüllt",
  "a greeting": "eine Anrede",
  "a heading": "eine Überschrift",
  "a line at the foot of the page": "eine Zeile am Ende der Seite",
  "a number of a part of the sheet": "eine Nummer eines Teils des Blatts",
  "a part of a legend or of a list of tags": "ein Teil einer Legende oder einer Liste von Kennzeichen",
  "a part of what the number of rounds says": "ein Teil der Angabe, wie oft die Runde gefahren wird",
  "a picture": "ein Bild",
  "a question that names nothing of the mission": "eine Frage, die nichts von der Mission nennt",
  "a reference to the lines below": "ein Verweis auf die Zeilen darunter",
  "a remark": "eine Bemerkung",
  "a repetition of what is said above": "eine Wiederholung von etwas weiter oben",
  "a result that the sheet computes": "ein Ergebnis, das die Tabelle berechnet",
  "a rule of scoring": "eine Regel der Bewertung",
  "a separator": "eine Trennlinie",
  "a signature": "eine Unterschrift",
  "a standing phrase of letters": "eine feste Wendung in Briefen",
  "a statement of what is not needed": "eine Aussage darüber, was nicht nötig ist",
  "a statement that names nothing of the mission": "eine Aussage, die nichts von der Mission nennt",
  "a total": "eine Summe",
  "an announcement of the lines below": "eine Ankündigung der Zeilen darunter",
  "an answer": "eine Antwort",
  "an entry of a log": "ein Eintrag eines Protokolls",
  "an entry that there is none": "ein Eintrag, dass es nichts gibt",
  "an explanation of what a name stands for": "eine Erklärung, wofür ein Name steht",
  "column headings": "Überschriften von Spalten",
  "for people, not for the robot": "für Menschen, nicht für den Roboter",
  "left out, as another line says": "ausgelassen, wie eine andere Zeile sagt",
  "the end of a letter": "das Ende eines Briefs",
  "the footer of the pages": "die Fußzeile der Seiten",
  "the header of the pages": "die Kopfzeile der Seiten",
  "the headings of columns": "die Überschriften der Spalten",
  "the headings of columns, again": "noch einmal die Überschriften der Spalten",
  "the name of a sheet": "der Name eines Blatts",
  "the title": "der Titel",
  // why a line is proposed or open
  "an assistant suggests {}, but <>": "ein Assistent schlägt {} vor, aber <>",
  "suggested by an assistant": "von einem Assistenten vorgeschlagen",
  "Argo does not understand {} here": "Argo versteht {} hier nicht",
  "the sentence is incomplete": "der Satz ist unvollständig",
  "it is not decided what this row asks for": "es ist nicht entschieden, was diese Zeile verlangt",
  "a mission has no date: it begins when it is started": "eine Mission hat kein Datum: Sie beginnt, wenn sie gestartet wird",
  "a comment says {}": "ein Kommentar sagt {}",
  "the comment at <> is {}": "der Kommentar bei <> ist {}",
  "it is not clear which checkpoint {} is": "es ist nicht klar, welcher Kontrollpunkt {} ist",
  "it is not clear which {} is meant": "es ist nicht klar, welches {} gemeint ist",
  "line <> asks for checkpoint <>": "Zeile <> verlangt Kontrollpunkt <>",
  "line <> has another maximum duration": "Zeile <> hat eine andere Höchstdauer",
  "no value satisfies {}": "kein Wert erfüllt {}",
  "the tag {} is not known": "das Kennzeichen {} ist nicht bekannt",
  "there is no checkpoint <> on <>": "Kontrollpunkt <> gibt es auf <> nicht",
  "there is no field {}": "es gibt kein Feld {}",
  "there is no floor <> on <>": "Stockwerk <> gibt es auf <> nicht",
  "there is no step <>": "es gibt keinen Schritt <>",
  "these times can be rounds at these times of day": "diese Zeiten können Runden zu diesen Uhrzeiten sein",
  "this asks for a reading of what the site does not have": "hier wird eine Messung verlangt, die es in der Anlage nicht gibt",
  "this asks for a reading, and names nothing that the site has": "hier wird eine Messung verlangt, aber nichts aus der Anlage genannt",
  "this can be a task, or only say what {} stands for": "das kann eine Aufgabe sein oder nur sagen, wofür {} steht",
  "this can be about what is listed below, or about what was measured before":
    "das kann für die Liste darunter gelten oder für das, was vorher gemessen wurde",
  "this gives a checkpoint other normal values than the site has":
    "hier hat ein Kontrollpunkt andere Normalwerte als in der Anlage",
  "this is a question: it is not clear whether the robot has to do it": "das ist eine Frage: Es ist nicht klar, ob der Roboter es tun soll",
  "this is not possible here": "das ist hier nicht möglich",
  "this may be of the line above": "das kann zur Zeile darüber gehören",
  "this <> would never end": "das würde nie enden",
  "this row has words that are struck through": "diese Zeile hat durchgestrichene Wörter",
  "this row is deleted by a tracked change": "diese Zeile ist durch eine nachverfolgte Änderung gelöscht",
  "this row is hidden in the sheet": "diese Zeile ist im Blatt ausgeblendet",
  "this row is ticked, or marked as done: it may be left out": "diese Zeile ist abgehakt oder erledigt: Sie soll vielleicht ausgelassen werden",
  "this row names several checkpoints": "diese Zeile nennt mehrere Kontrollpunkte",
  "{} can be <>": "{} kann <> sein",
  "{} can be a change, or a remark": "{} kann eine Änderung oder eine Bemerkung sein",
  "{} can be a time of day at which this is done": "{} kann eine Uhrzeit sein, zu der das getan wird",
  "{} can be a time, or a normal range": "{} kann eine Zeit oder ein Normalbereich sein",
  "{} can be read as <>": "{} kann <> bedeuten",
  "{} can change what is done here": "{} kann ändern, was hier getan wird",
  "{} can give another order of the rows": "{} kann eine andere Reihenfolge der Zeilen angeben",
  "{} can mean either of them, or both": "{} kann eines von beiden oder beide bedeuten",
  "{} can mean that the lines below it are not tasks, or not always":
    "{} kann bedeuten, dass die Zeilen darunter keine Aufgaben sind, oder nicht immer",
  "{} can mean that this is done already": "{} kann bedeuten, dass das schon getan ist",
  "{} can mean that this is left out": "{} kann bedeuten, dass das ausgelassen wird",
  "{} can mean that this row is not a task": "{} kann bedeuten, dass diese Zeile keine Aufgabe ist",
  "{} can mean that what comes behind the list is meant of its last item, or of all":
    "{} kann bedeuten, dass das nach der Liste für den letzten Punkt gilt, oder für alle",
  "{} can mean that what follows is done in some cases only, or always":
    "{} kann bedeuten, dass das Folgende nur manchmal getan wird, oder immer",
  "{} in this column can mean that the row is not meant": "{} in dieser Spalte kann bedeuten, dass die Zeile nicht gemeint ist",
  "{} is filled in: this may be done already": "{} ist eingetragen: Das ist vielleicht schon getan",
  "{} is not an action of the robot": "{} ist keine Handlung des Roboters",
  "{} is not understood as minutes": "{} ist nicht als Minuten zu verstehen",
  "{} is not understood here": "{} wird hier nicht verstanden",
  "{} needs a condition before it": "{} braucht eine Bedingung davor",
  "checkpoint <> is <>, and <> is checkpoint <>": "Kontrollpunkt <> ist <>, und <> ist Kontrollpunkt <>",
  "checkpoint <> is <>": "Kontrollpunkt <> ist <>",
  "<> is on floor <>": "<> ist auf Stockwerk <>",
  "there is no checkpoint <>": "es gibt keinen Kontrollpunkt <>",
  "a single checkpoint has no reverse order; other lines may be meant, too": "ein einzelner Kontrollpunkt hat keine umgekehrte Reihenfolge; vielleicht sind auch andere Zeilen gemeint",
  "{} can be the docking station, or the place named before": "{} kann die Ladestation sein oder der Ort davor",
  "{} can mean only in that case, or only after that": "{} kann bedeuten: nur in diesem Fall, oder erst danach",
  "{} can mean that the others do not satisfy this": "{} kann bedeuten, dass die anderen das nicht erfüllen",
  "{} can mean the path home, or the same checkpoints in reverse order": "{} kann den Heimweg bedeuten, oder dieselben Kontrollpunkte rückwärts",
  "{} can mean their sum, or each of them": "{} kann ihre Summe bedeuten, oder jeden einzelnen",
  "it is not clear what this replaces": "es ist nicht klar, was das ersetzt",
  "it is not clear what to repeat": "es ist nicht klar, was wiederholt wird",
  "it is not clear where {} is": "es ist nicht klar, wo {} ist",
  "it is not clear which step is the next one": "es ist nicht klar, welcher Schritt der nächste ist",
  "only a single measurement can be replaced": "nur eine einzelne Messung kann ersetzt werden",
  "priority 1 can be the highest or the lowest": "Priorität 1 kann die höchste oder die niedrigste sein",
  "the last floor can be that of the exception, or a further exception": "das letzte Stockwerk kann zur Ausnahme gehören oder eine weitere Ausnahme sein",
  "this line can be a heading of those below it, or a command": "diese Zeile kann eine Überschrift der folgenden sein, oder ein Befehl",
  "the marks before the lines can say which of them are meant": "die Zeichen vor den Zeilen können sagen, welche davon gemeint sind",
  "the sign at the beginning can repeat what stands above": "das Zeichen am Anfang kann wiederholen, was darüber steht",
  "this may say who does what is below it": "das kann sagen, wer das Folgende tut",
  "it is not said what is read there": "es ist nicht gesagt, was dort abgelesen wird",
  "the steps can be meant in the order of their numbers, or as they are written": "die Schritte können in der Reihenfolge ihrer Nummern gemeint sein, oder so, wie sie dastehen",
  "the time can be that of each round, of all rounds, or the longest one allowed": "die Zeit kann für jede Runde oder für alle Runden gelten oder die höchste erlaubte sein",
  "this can apply in this case only, or in any case": "das kann nur in diesem Fall gelten, oder in jedem",
  "this can apply only if it still fails, or in any case": "das kann gelten, wenn es immer noch misslingt, oder in jedem Fall",
  "this can apply to each of them, or to all together": "das kann für jedes einzelne gelten, oder für alle zusammen",
  "this can apply to one of them, or to both": "das kann für eines gelten, oder für beide",
  "this can apply to the condition, or to the command": "das kann für die Bedingung gelten, oder für den Befehl",
  "this can apply to the last of these only, or to each of them": "das kann nur für das letzte davon gelten, oder für jedes",
  "this can apply to the measurement before, or ask for it once more": "das kann für die Messung davor gelten, oder sie noch einmal verlangen",
  "this can be a wait before the task, or a time since the start": "das kann ein Warten vor der Aufgabe sein, oder eine Zeit seit dem Start",
  "this can be any of several checkpoints, or the last one": "das kann einer von mehreren Kontrollpunkten sein, oder der letzte",
  "this can be on the same floor as what is before it, or on all floors": "das kann auf demselben Stockwerk sein wie das davor, oder auf allen",
  "this can be the exact number, or a maximum with a condition that is missing": "das kann die genaue Anzahl sein, oder eine Höchstzahl, zu der eine Bedingung fehlt",
  "this can be the last measurement, or another one": "das kann die letzte Messung sein, oder eine andere",
  "this can be the previous step, or all steps so far": "das kann der vorige Schritt sein, oder alle bisherigen",
  "this can be the reading that was asked for just before, or one more": "das kann die eben verlangte Messung sein, oder eine weitere",
  "this can be the value of the checkpoint before it, or of an earlier one": "das kann der Wert des Kontrollpunkts davor sein, oder eines früheren",
  "this can mean all tasks so far, or all checkpoints of the site": "das kann alle bisherigen Aufgaben bedeuten, oder alle Kontrollpunkte der Anlage",
  "this can mean once in total, or once more": "das kann bedeuten: insgesamt einmal, oder noch einmal",
  "this can mean once more in any case, or only after a failure": "das kann bedeuten: auf jeden Fall noch einmal, oder nur, wenn es misslingt",
  "this can mean once more right after it, or at another time": "das kann bedeuten: gleich noch einmal, oder zu einer anderen Zeit",
  "this condition can apply to the last of these only, or to all of them": "diese Bedingung kann nur für das letzte davon gelten, oder für alle",
  "this condition can apply to the last of these only, or to both": "diese Bedingung kann nur für das letzte davon gelten, oder für beide",
  "this count can be that of the way only, or of all that stands before it": "diese Anzahl kann nur für den Weg gelten, oder für alles davor",
  "this duration can apply to each floor, or to all together": "diese Dauer kann für jedes Stockwerk gelten, oder für alle zusammen",
  "this floor can be that of all of them, or of the last one only": "dieses Stockwerk kann für alle gelten, oder nur für das letzte",
  "this limit can apply to each attempt, or to all together": "diese Grenze kann für jeden Versuch gelten, oder für alle zusammen",
  "this number can be that of a checkpoint or of a step": "diese Nummer kann die eines Kontrollpunkts oder eines Schritts sein",
  "this time can be that of each of these tasks, or of the whole mission": "diese Zeit kann für jede dieser Aufgaben gelten, oder für die ganze Mission",
  "this time can belong to the condition, or be a wait before the command": "diese Zeit kann zur Bedingung gehören, oder ein Warten vor dem Befehl sein",
  "{} can apply to the first of these only, or to both": "{} kann nur für das erste davon gelten, oder für beide",
  "{} can apply to the last of these conditions, or to all of them": "{} kann für die letzte dieser Bedingungen gelten, oder für alle",
  "{} can be a further exception, or a further checkpoint": "{} kann eine weitere Ausnahme sein, oder ein weiterer Kontrollpunkt",
  "{} can be the last task, or the last measurement": "{} kann die letzte Aufgabe sein, oder die letzte Messung",
  "{} can mean that more tasks follow": "{} kann bedeuten, dass weitere Aufgaben folgen",
  // hints
  "write the floor behind each, or {}": "schreiben Sie das Stockwerk hinter jedes, oder {}",
  "write it before the condition: {}": "schreiben Sie es vor die Bedingung: {}",
  "write a sentence for each: {}": "schreiben Sie für jedes einen Satz: {}",
  "say it as a sentence": "sagen Sie es als Satz",
  "say, {}": "sagen Sie zum Beispiel {}",
  "is <> meant?": "ist <> gemeint?",
  "possible here: <>": "möglich ist hier: <>",
  "the fields are <>": "die Felder sind <>",
  "the floors are <>, counted from the bottom": "die Stockwerke sind <>, von unten gezählt",
  "the nearest names are <>": "die ähnlichsten Namen sind <>",
  "the nearest numbers are <>": "die nächsten Nummern sind <>",
  "the nearest steps are <>": "die nächsten Schritte sind <>",
  "correct the number or the name": "berichtigen Sie die Nummer oder den Namen",
  "name one of them": "nennen Sie einen davon",
  "name the checkpoint: {}": "nennen Sie den Kontrollpunkt: {}",
  "name the checkpoints, or write {}": "nennen Sie die Kontrollpunkte, oder schreiben Sie {}",
  "remove one of the two": "entfernen Sie eines von beiden",
  "remove the lines that are not tasks, and the heading; or write another heading":
    "entfernen Sie die Zeilen, die keine Aufgaben sind, und die Überschrift; oder schreiben Sie eine andere Überschrift",
  "remove the row, or what stands in this column": "entfernen Sie die Zeile, oder was in dieser Spalte steht",
  "write one sentence for each of them": "schreiben Sie für jedes einen Satz",
  "write it after the command that it belongs to, or remove it": "schreiben Sie es nach dem Befehl, zu dem es gehört, oder entfernen Sie es",
  "write it after the condition that it belongs to": "schreiben Sie es nach der Bedingung, zu der es gehört",
  "write it as an order, or remove it": "schreiben Sie es als Auftrag, oder entfernen Sie es",
  "write the checkpoint's number, or by its full name": "schreiben Sie die Nummer oder den vollen Namen des Kontrollpunkts",
  "write two sentences": "schreiben Sie zwei Sätze",
  "a name such as {}": "ein Name wie {}",
  "a number": "eine Zahl",
  "a place of the site": "ein Ort der Anlage",
  "a speed such as {}": "eine Geschwindigkeit wie {}",
  "a time such as {}": "eine Zeit wie {}",
  "a value such as {}": "ein Wert wie {}",
  "an event such as {}": "ein Ereignis wie {}",
  "how often, such as {}": "wie oft, etwa {}",
  open: "offen",
  closed: "geschlossen",
  // warnings and notes
  "read {} as {}": "{} ist als {} gelesen",
  "step <> is in the position of step <>": "Schritt <> steht an der Stelle von Schritt <>",
  "the normal range of <> is <> here, but <> on the site": "der Normalbereich von <> ist hier <>, aber in der Anlage <>",
  "<> is <> here, but <> is normal on the site": "<> ist hier <>, aber in der Anlage ist <> normal",
  "checkpoint <> is not in the mission anyway, so this has no effect":
    "Kontrollpunkt <> ist ohnehin nicht in der Mission, daher ist das ohne Wirkung",
  "{} can be one word; it is read as two": "{} kann ein Wort sein; es ist als zwei gelesen",
  "{} has no effect": "{} ist ohne Wirkung",
  "{} has no effect by itself: it is <>": "{} ist für sich ohne Wirkung: <>",
  "{} is a remark and has no effect": "{} ist eine Bemerkung und ohne Wirkung",
  "{} is set aside: it is <>": "{} ist beiseitegelegt: <>",
  "{} is taken for <> and has no effect": "{} gilt als <> und ist ohne Wirkung",
  "{} is taken for the title, and adds no task": "{} gilt als Titel und fügt keine Aufgabe hinzu",
  "{} is taken for the title, and has no effect on what is done": "{} gilt als Titel und ändert nicht, was getan wird",
};

/** the parts of keys */
const PARTS = /\{\}|<>/g;
/** the keys with parts, those with the most words of their own first */
const PATTERNS = Object.keys(GERMAN)
  .filter((key) => key.match(PARTS))
  .sort((one, other) => other.length - one.length)
  .map((key) => {
    const source = key.replace(/[.*+?^$()|[\]\\]/g, "\\$&").replace(PARTS, (part) => (part === "{}" ? "(`[^`]*`)" : "(.+?)"));
    return [new RegExp(`^${source}$`), key] as const;
  });
/** where a message is cut, outside of quoted words */
const SEGMENTS = /; (?=(?:[^`]*`[^`]*`)*[^`]*$)/;
const ITEMS = /(, (?!such as)| or | and )/;
/** an item that needs no translation: quoted words, a name or a range with a figure */
const PLAIN = /^(`[^`]*`|.*\d.*)$/;

const known = new Map<string, string | null>();

/** A text, and the language that it is in. */
export interface SpokenText {
  readonly text: string;
  readonly lang: "en" | "de";
}

/** Return a message about a line in the language of the page, if it can be translated. */
export function spoken(message: string): SpokenText {
  const german = language.value === "de" ? inGerman(message) : null;
  return german === null ? { text: message, lang: "en" } : { text: german, lang: "de" };
}

function inGerman(message: string): string | null {
  const found = known.get(message);
  if (found !== undefined) return found;
  const whole = translated(message);
  const segments = message.split(SEGMENTS).map(translated);
  const made = whole ?? (segments.every((one) => one !== null) ? segments.join("; ") : null);
  if (known.size > 5_000) known.clear();
  known.set(message, made);
  return made;
}

function translated(text: string): string | null {
  const fixed = GERMAN[text];
  if (fixed !== undefined) return fixed;
  for (const [pattern, key] of PATTERNS) {
    const parts = pattern.exec(text)?.slice(1).map(listed);
    if (parts === undefined || parts.includes(null)) continue;
    return (GERMAN[key] ?? "").replace(PARTS, () => parts.shift() ?? "");
  }
  return null;
}

/** Return a part of a message, or a list of parts, in German; null: it is not known. */
function listed(part: string): string | null {
  const whole = GERMAN[part] ?? (/^(`[^`]*`|\S+)$/.test(part) ? part : null);
  if (whole !== null) return whole;
  const items = part.split(ITEMS).map((item, at) => (at % 2 > 0 ? jointInGerman(item) : partInGerman(item)));
  return items.includes(null) ? null : items.join("");
}

function jointInGerman(joint: string): string {
  return { " or ": " oder ", " and ": " und " }[joint] ?? joint;
}

function partInGerman(part: string): string | null {
  return translated(part) ?? (PLAIN.test(part) ? part.replace(/(\d) to (\d)/g, "$1 bis $2") : null);
}
