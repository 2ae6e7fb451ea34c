import { both } from "./both";

export const script = both(
  {
    title: "The mission as a script",
    apply: "Apply",
    applying: "Applying…",
    revert: "Put aside",
    back: "Bring my text back",
    unchanged: "Same as the mission",
    changed: "Not applied yet",
    refused: "The script was refused; the mission is as it was.",
    overtaken: "The mission was changed meanwhile, so your text is not what it is any more.",
    theirs: "Show the mission as it is now",
    anyway: "Apply mine all the same",
    mayNotPlan: "You may look only: missions are changed by those with the role “plan”.",
    hasErrors: "The mission has errors, so there is no script of it at present.",
    line: (line: number) => `Line ${line}`,
    hint: (hint: string) => `Way out: ${hint}`,
    problems: "What is wrong",
    notes: "How the script was read where it was not clear",
    notesOpen: (count: number) =>
      count === 1
        ? "One thing in the script was not clear: please check how it was read."
        : `${count} things in the script were not clear: please check how they were read.`,
    look: "Look",
    confirm: "OK",
    confirmAll: "All OK",
    loading: "The script is being written…",
  },
  {
    title: "Die Mission als Skript",
    apply: "Anwenden",
    applying: "Wird angewendet …",
    revert: "Beiseitelegen",
    back: "Meinen Text zurückholen",
    unchanged: "So ist die Mission",
    changed: "Noch nicht angewendet",
    refused: "Das Skript wurde abgelehnt; die Mission ist, wie sie war.",
    overtaken: "Die Mission wurde inzwischen geändert, Ihr Text ist also nicht mehr ihr Stand.",
    theirs: "Zeigen, wie die Mission jetzt ist",
    anyway: "Meinen trotzdem anwenden",
    mayNotPlan: "Sie dürfen nur zusehen: Missionen ändern die mit der Rolle „plan“.",
    hasErrors: "Die Mission hat Fehler, darum gibt es zurzeit kein Skript von ihr.",
    line: (line: number) => `Zeile ${line}`,
    hint: (hint: string) => `Ausweg: ${hint}`,
    problems: "Was nicht stimmt",
    notes: "Was beim Hereinholen angenommen wurde",
    notesOpen: (count: number) =>
      count === 1
        ? "Etwas im Skript wurde geheilt oder angenommen: bitte bestätigen Sie es."
        : `${count} Dinge im Skript wurden geheilt oder angenommen: bitte bestätigen Sie sie.`,
    look: "Ansehen",
    confirm: "Stimmt so",
    confirmAll: "Alles stimmt so",
    loading: "Das Skript wird geschrieben …",
  },
);
