/** The overview of keyboard shortcuts. */

import { both } from "./both";

interface Sheet {
  readonly title: string;
  readonly keys: readonly (readonly [key: string, what: string])[];
}
type Sheets = Readonly<Record<"everywhere" | "mouse" | "list" | "adding" | "scene" | "script" | "draft" | "byHand", Sheet>>;

export const keys = both<Sheets>(
  {
    everywhere: {
      title: "Everywhere",
      keys: [
        ["?", "this overview"],
        ["Ctrl+Z", "undo your last edit"],
        ["Ctrl+Y", "redo it"],
        ["p", "floor plans and mission sheet"],
        ["F8", "start, watch and control the run"],
        ["F9", "take over the robot"],
        ["Esc", "leave the tool, close a message, clear the selection"],
      ],
    },
    mouse: {
      title: "Mouse",
      keys: [
        ["Click", "select a task, a checkpoint or a path"],
        ["Ctrl+Click", "add it to the selection"],
        ["Shift+Drag", "select the tasks in a frame of the site"],
        ["Drag", "turn the site; move rows of the list"],
        ["Right drag", "move the site"],
        ["Wheel", "zoom; turn the ghost of the navigation tool"],
        ["Right click", "leave the tool"],
        ["Double click", "rename a row"],
      ],
    },
    list: {
      title: "Tasks",
      keys: [
        ["↑ ↓", "select the task above or below"],
        ["Shift+↑ Shift+↓", "select several"],
        ["← →", "fold and unfold a group"],
        ["Alt+↑ Alt+↓", "move the selection"],
        ["Alt+← Alt+→", "move out of a group, into a group"],
        ["Enter", "open the details"],
        ["F2", "rename"],
        ["v", "show it in the site"],
        ["/", "filter the tasks"],
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
        ["g", "group the selection"],
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
    script: { title: "Script", keys: [["Ctrl+Enter", "apply the text"]] },
    draft: {
      title: "Draft of a script",
      keys: [
        ["↑ ↓", "line above or below"],
        ["n Shift+N", "next or previous line that is left"],
        ["c", "confirm what is proposed"],
        ["1 … 9", "take a choice"],
        ["e", "say the line in other words"],
        ["x", "set the line aside"],
        ["u", "undo the decision on the line"],
        ["Shift+C", "confirm all proposed lines"],
        ["Shift+X", "list the lines that name nothing, to set them aside"],
        ["Ctrl+Z", "undo your last decision"],
        ["Ctrl+Enter", "plan the mission, once nothing is left"],
      ],
    },
    byHand: {
      title: "Driving by hand",
      keys: [
        ["↑ W", "drive forward while held"],
        ["↓ S", "drive backward"],
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
        ["Strg+Z", "Ihre letzte Änderung rückgängig machen"],
        ["Strg+Y", "wiederholen"],
        ["p", "Grundrisse und Missionsblatt"],
        ["F8", "Fahrt starten, verfolgen und steuern"],
        ["F9", "den Roboter übernehmen"],
        ["Esc", "Werkzeug verlassen, Meldung schließen, Auswahl aufheben"],
      ],
    },
    mouse: {
      title: "Maus",
      keys: [
        ["Klick", "eine Aufgabe, einen Prüfpunkt oder einen Weg auswählen"],
        ["Strg+Klick", "zur Auswahl hinzufügen"],
        ["Umschalt+Ziehen", "die Aufgaben in einem Rahmen der Anlage auswählen"],
        ["Ziehen", "die Anlage drehen; Zeilen der Liste verschieben"],
        ["Rechts ziehen", "die Anlage verschieben"],
        ["Rad", "vergrößern; den Geist des Navigationswerkzeugs drehen"],
        ["Rechtsklick", "das Werkzeug verlassen"],
        ["Doppelklick", "eine Zeile umbenennen"],
      ],
    },
    list: {
      title: "Aufgaben",
      keys: [
        ["↑ ↓", "Aufgabe darüber oder darunter auswählen"],
        ["Umschalt+↑ Umschalt+↓", "mehrere auswählen"],
        ["← →", "Gruppe zu- und aufklappen"],
        ["Alt+↑ Alt+↓", "Auswahl verschieben"],
        ["Alt+← Alt+→", "aus einer Gruppe, in eine Gruppe verschieben"],
        ["Enter", "Details öffnen"],
        ["F2", "umbenennen"],
        ["v", "in der Anlage zeigen"],
        ["/", "die Aufgaben filtern"],
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
        ["g", "Auswahl gruppieren"],
        ["o", "Hinderniswerkzeug"],
      ],
    },
    scene: {
      title: "Anlage",
      keys: [
        ["↑ ↓ ← →", "Kamera bewegen, oder den Umriss des Navigationswerkzeugs"],
        ["Umschalt+↑", "doppelt so schnell; fünf Felder mit dem Umriss"],
        [", .", "den Umriss drehen"],
        ["Enter", "den Umriss platzieren"],
        ["Bild↑ Bild↓", "Stockwerk darüber oder darunter"],
      ],
    },
    script: { title: "Skript", keys: [["Strg+Enter", "den Text anwenden"]] },
    draft: {
      title: "Entwurf eines Skripts",
      keys: [
        ["↑ ↓", "Zeile darüber oder darunter"],
        ["n Umschalt+N", "nächste oder vorige offene Zeile"],
        ["c", "den Vorschlag bestätigen"],
        ["1 … 9", "eine der Möglichkeiten wählen"],
        ["e", "die Zeile anders sagen"],
        ["x", "die Zeile beiseitelegen"],
        ["u", "die Entscheidung über die Zeile rückgängig machen"],
        ["Umschalt+C", "alle Vorschläge bestätigen"],
        ["Umschalt+X", "die Zeilen auflisten, die nichts nennen, um sie beiseitezulegen"],
        ["Strg+Z", "Ihre letzte Entscheidung rückgängig machen"],
        ["Strg+Enter", "die Mission planen, sobald nichts mehr offen ist"],
      ],
    },
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
