/** The sheet of keys. */

import { both } from "./both";

interface Sheet {
  readonly title: string;
  readonly keys: readonly (readonly [key: string, what: string])[];
}
type Sheets = Readonly<Record<"everywhere" | "list" | "adding" | "scene" | "script" | "byHand", Sheet>>;

export const keys = both<Sheets>(
  {
    everywhere: {
      title: "Everywhere",
      keys: [
        ["?", "this sheet"],
        ["Ctrl+Z", "undo what you did last"],
        ["Ctrl+Y", "redo it"],
        ["F8", "start, watch and steer the run"],
        ["F9", "take over from the run"],
        ["Esc", "put the tool away, close a message, unselect"],
      ],
    },
    list: {
      title: "Tasks",
      keys: [
        ["↑ ↓", "select the one above or below"],
        ["Shift+↑ Shift+↓", "select several"],
        ["← →", "fold and unfold a group"],
        ["Alt+↑ Alt+↓", "move what is selected"],
        ["Alt+← Alt+→", "out of a group, into one"],
        ["Enter", "open the details"],
        ["F2", "rename"],
        ["v", "show it in the site"],
        ["Delete", "delete"],
        ["Ctrl+A", "select all"],
        ["Ctrl+C Ctrl+V", "copy and paste"],
      ],
    },
    adding: {
      title: "Adding",
      keys: [
        ["m", "measure a checkpoint"],
        ["n", "navigation tool"],
        ["w", "waypoint at a place"],
        ["g", "group what is selected"],
        ["o", "obstacle tool"],
      ],
    },
    scene: {
      title: "Site",
      keys: [
        ["↑ ↓ ← →", "move the camera, or the ghost of the navigation tool"],
        ["Shift+↑", "twice as fast; five cells with the ghost"],
        [", .", "turn the ghost"],
        ["Enter", "place the ghost"],
        ["PageUp PageDown", "floor above or below"],
      ],
    },
    script: { title: "Script", keys: [["Ctrl+Enter", "apply what is written"]] },
    byHand: {
      title: "Driving by hand",
      keys: [
        ["↑ W", "drive ahead, as long as it is held"],
        ["↓ S", "drive back"],
        ["← A", "turn left"],
        ["→ D", "turn right"],
        ["Space", "stand still"],
        ["Esc", "end driving with the keys"],
      ],
    },
  },
  {
    everywhere: {
      title: "Überall",
      keys: [
        ["?", "diese Übersicht"],
        ["Strg+Z", "rückgängig machen, was Sie zuletzt taten"],
        ["Strg+Y", "wiederholen"],
        ["F8", "Fahrt starten, verfolgen und steuern"],
        ["F9", "die Fahrt von Hand übernehmen"],
        ["Esc", "Werkzeug weglegen, Meldung schließen, Auswahl aufheben"],
      ],
    },
    list: {
      title: "Aufgaben",
      keys: [
        ["↑ ↓", "darüber oder darunter auswählen"],
        ["Umschalt+↑ Umschalt+↓", "mehrere auswählen"],
        ["← →", "Gruppe zu- und aufklappen"],
        ["Alt+↑ Alt+↓", "Ausgewähltes verschieben"],
        ["Alt+← Alt+→", "aus einer Gruppe, in eine Gruppe"],
        ["Enter", "Details öffnen"],
        ["F2", "umbenennen"],
        ["v", "in der Anlage zeigen"],
        ["Entf", "löschen"],
        ["Strg+A", "alle auswählen"],
        ["Strg+C Strg+V", "kopieren und einfügen"],
      ],
    },
    adding: {
      title: "Hinzufügen",
      keys: [
        ["m", "einen Prüfpunkt messen"],
        ["n", "Navigationswerkzeug"],
        ["w", "Wegpunkt an einem Ort"],
        ["g", "Ausgewähltes gruppieren"],
        ["o", "Hinderniswerkzeug"],
      ],
    },
    scene: {
      title: "Anlage",
      keys: [
        ["↑ ↓ ← →", "Kamera bewegen, oder den Umriss des Navigationswerkzeugs"],
        ["Umschalt+↑", "doppelt so schnell; fünf Felder mit dem Umriss"],
        [", .", "den Umriss drehen"],
        ["Enter", "den Umriss setzen"],
        ["Bild↑ Bild↓", "Stockwerk darüber oder darunter"],
      ],
    },
    script: { title: "Skript", keys: [["Strg+Enter", "Geschriebenes anwenden"]] },
    byHand: {
      title: "Von Hand fahren",
      keys: [
        ["↑ W", "vorwärts fahren, solange gedrückt"],
        ["↓ S", "rückwärts fahren"],
        ["← A", "nach links drehen"],
        ["→ D", "nach rechts drehen"],
        ["Leertaste", "stehen bleiben"],
        ["Esc", "Fahren mit den Tasten beenden"],
      ],
    },
  },
);
