/** Texts of the list of missions. */

import { both } from "./both";

interface ExampleTexts {
  readonly title: string;
  readonly about: string;
}
type Examples = Readonly<Record<string, ExampleTexts | undefined>>;

const examplesEn: Examples = {
  mission_1: { title: "Mission sheet", about: "A sheet of the competition, read from paper, with words that were cut apart" },
  any_order: { title: "Sheet in any order", about: "Leaves the order of the checkpoints open: let Argo find the best one" },
  protocol_2: { title: "Plain sentences", about: "Patrols a floor, measures, adds a task and deletes one" },
  protocol_3: { title: "Conditions and rounds", about: "Retries, a condition, repeated steps, and a reaction to a low battery" },
  rounds_and_windows: { title: "Rounds and time windows", about: "Waits, rounds at an interval, and times at which tasks may begin" },
  ground: { title: "Ground floor with alarms", about: "A round that reacts to alarms: try it with faults" },
  upstairs: { title: "Up the stairs", about: "A drive to the second floor, for faults on stairs and walkways" },
};

const examplesDe: Examples = {
  mission_1: { title: "Missionsblatt", about: "Ein Blatt des Wettbewerbs, vom Papier gelesen, mit zerschnittenen Wörtern" },
  any_order: { title: "Blatt ohne feste Reihenfolge", about: "Lässt die Reihenfolge der Prüfpunkte offen: Argo findet die beste" },
  protocol_2: { title: "Einfache Sätze", about: "Fährt ein Stockwerk ab, misst, ergänzt eine Aufgabe und löscht eine" },
  protocol_3: { title: "Bedingungen und Runden", about: "Wiederholte Versuche, eine Bedingung, Runden und eine Reaktion auf niedrigen Ladestand" },
  rounds_and_windows: { title: "Runden und Zeitfenster", about: "Wartet, fährt Runden in einem Abstand und beginnt Aufgaben zu bestimmten Zeiten" },
  ground: { title: "Erdgeschoss mit Alarmen", about: "Eine Runde, die auf Alarme reagiert: zum Ausprobieren von Störungen" },
  upstairs: { title: "Die Treppe hinauf", about: "Eine Fahrt in das zweite Stockwerk, für Störungen auf Treppen und Laufstegen" },
};

export const home = both(
  {
    siteFigures: (floors: number, checkpoints: number, docks: number) =>
      `${counted(floors, "floor", "floors")}, ${counted(checkpoints, "checkpoint", "checkpoints")}, ${counted(docks, "dock", "docks")}`,
    pictureOf: (site: string, figures: string) => `Picture of the site ${site}: ${figures}`,
    search: "Search for a mission",
    searchHint: "Name, folder, checkpoint or #8",
    count: (count: number) => (count === 1 ? "1 mission" : `${count.toLocaleString("en")} missions`),
    countOf: (found: number, all: number) => `${found.toLocaleString("en")} of ${all.toLocaleString("en")}`,
    nothingFound: "No mission fits this search.",
    showMore: (left: number) => `Show more (${left.toLocaleString("en")} left)`,
    folders: "Folders",
    allFolders: "All",
    noFolder: "No folder",
    folder: "Folder",
    folderHint: "Name of an existing or a new folder",
    file: "Move to a folder",
    fileOne: (name: string) => `Move ${name} to a folder`,
    takeOut: "Take out of the folder",
    filed: (name: string, folder: string) => `${name} is in the folder ${folder}.`,
    unfiled: (name: string) => `${name} is in no folder.`,
    filedSince: (name: string) => `Somebody else has moved ${name} in the meantime, so it stays there.`,
    lastRun: "Last run",
    neverRun: "never",
    expected: "Expected time",
    acts: "Copy, move, delete",
    copy: "Use as a template",
    copyOne: (name: string) => `Use ${name} as a template`,
    runs: "Runs",
    noRuns: "No mission was run yet.",
    startedBy: (by: string, when: string) => `${when}, ${by}`,
    deletedMission: "(deleted)",
    status: { preparing: "starting", running: "under way", interrupted: "interrupted", ended: "ended" },
    examples: "Examples",
    beginWithExample: "Begin with an example",
    exampleIsCopied: "A click opens a copy, which you can plan, change and run.",
    exampleTexts: examplesEn,
  },
  {
    siteFigures: (floors: number, checkpoints: number, docks: number) =>
      `${counted(floors, "Stockwerk", "Stockwerke")}, ${counted(checkpoints, "Prüfpunkt", "Prüfpunkte")}, ${counted(docks, "Ladestation", "Ladestationen")}`,
    pictureOf: (site: string, figures: string) => `Bild der Anlage ${site}: ${figures}`,
    search: "Mission suchen",
    searchHint: "Name, Ordner, Prüfpunkt oder #8",
    count: (count: number) => (count === 1 ? "1 Mission" : `${count.toLocaleString("de")} Missionen`),
    countOf: (found: number, all: number) => `${found.toLocaleString("de")} von ${all.toLocaleString("de")}`,
    nothingFound: "Keine Mission passt zu dieser Suche.",
    showMore: (left: number) => `Weitere zeigen (noch ${left.toLocaleString("de")})`,
    folders: "Ordner",
    allFolders: "Alle",
    noFolder: "Ohne Ordner",
    folder: "Ordner",
    folderHint: "Name eines vorhandenen oder neuen Ordners",
    file: "In einen Ordner verschieben",
    fileOne: (name: string) => `${name} in einen Ordner verschieben`,
    takeOut: "Aus dem Ordner nehmen",
    filed: (name: string, folder: string) => `${name} ist im Ordner ${folder}.`,
    unfiled: (name: string) => `${name} ist in keinem Ordner.`,
    filedSince: (name: string) => `Jemand anderes hat ${name} inzwischen verschoben, daher bleibt die Mission dort.`,
    lastRun: "Letzte Fahrt",
    neverRun: "keine",
    expected: "Erwartete Zeit",
    acts: "Kopieren, verschieben, löschen",
    copy: "Als Vorlage verwenden",
    copyOne: (name: string) => `${name} als Vorlage verwenden`,
    runs: "Fahrten",
    noRuns: "Noch keine Mission wurde gefahren.",
    startedBy: (by: string, when: string) => `${when}, ${by}`,
    deletedMission: "(gelöscht)",
    status: { preparing: "beginnt", running: "läuft", interrupted: "unterbrochen", ended: "beendet" },
    examples: "Beispiele",
    beginWithExample: "Mit einem Beispiel beginnen",
    exampleIsCopied: "Ein Klick öffnet eine Kopie, die Sie planen, ändern und fahren können.",
    exampleTexts: examplesDe,
  },
);

function counted(count: number, one: string, many: string): string {
  return `${count} ${count === 1 ? one : many}`;
}
