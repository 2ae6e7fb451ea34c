import { both } from "./both";

export const script = both(
  {
    title: "The mission as a script",
    apply: "Apply",
    applying: "Applying …",
    revert: "Discard",
    back: "Restore my text",
    unchanged: "Same as the mission",
    changed: "Not applied yet",
    refused: "The script was rejected; the mission is unchanged.",
    overtaken: "The mission was changed in the meantime; your text is based on an older revision.",
    theirs: "Show the current mission",
    anyway: "Apply my text anyway",
    mayNotPlan: "You need the role “plan” to change missions.",
    hasErrors: "The mission has errors, so it can't be shown as a script.",
    line: (line: number) => `Line ${line}`,
    hint: (hint: string) => `Remedy: ${hint}`,
    problems: "Problems",
    notes: "Unclear passages, and how they were read",
    notesOpen: (count: number) =>
      count === 1
        ? "One passage of the script was unclear: please check how it was read."
        : `${count} passages of the script were unclear: please check how they were read.`,
    look: "Show",
    confirm: "Confirm",
    confirmAll: "Confirm all",
    loading: "Loading the script …",
  },
  {
    title: "Die Mission als Skript",
    apply: "Anwenden",
    applying: "Wird angewendet …",
    revert: "Verwerfen",
    back: "Meinen Text wiederherstellen",
    unchanged: "Entspricht der Mission",
    changed: "Noch nicht angewendet",
    refused: "Das Skript wurde abgelehnt; die Mission ist unverändert.",
    overtaken: "Die Mission wurde inzwischen geändert; Ihr Text beruht auf einem älteren Stand.",
    theirs: "Aktuelle Mission zeigen",
    anyway: "Meinen Text trotzdem anwenden",
    mayNotPlan: "Zum Ändern von Missionen brauchen Sie die Rolle „plan“.",
    hasErrors: "Die Mission hat Fehler und kann daher nicht als Skript gezeigt werden.",
    line: (line: number) => `Zeile ${line}`,
    hint: (hint: string) => `Abhilfe: ${hint}`,
    problems: "Probleme",
    notes: "Unklare Stellen und wie sie gelesen wurden",
    notesOpen: (count: number) =>
      count === 1
        ? "Eine Stelle im Skript war unklar: Bitte prüfen Sie, wie sie gelesen wurde."
        : `${count} Stellen im Skript waren unklar: Bitte prüfen Sie, wie sie gelesen wurden.`,
    look: "Zeigen",
    confirm: "Bestätigen",
    confirmAll: "Alle bestätigen",
    loading: "Das Skript wird geladen …",
  },
);
