import { both } from "./both";

export const frame = both(
  {
    notReached: "The service is not reached. What you do is sent as soon as it is.",
    deleted: "Somebody has deleted this mission.",
    stale: "This was changed meanwhile, so your edit was not made.",
    changedBy: (who: string, what: readonly string[]) => `${who} changed ${what.join(", ")}`,
    doItAnyway: "Do it all the same",
    panels: { properties: "Details", script: "Script", route: "Order", run: "Run" },
  },
  {
    notReached: "Der Dienst antwortet nicht. Was Sie tun, wird gesendet, sobald er es tut.",
    deleted: "Jemand hat diese Mission gelöscht.",
    stale: "Das wurde inzwischen geändert, darum wurde Ihre Änderung nicht gemacht.",
    changedBy: (who: string, what: readonly string[]) => `${who} hat ${what.join(", ")} geändert`,
    doItAnyway: "Trotzdem machen",
    panels: { properties: "Details", script: "Skript", route: "Reihenfolge", run: "Fahrt" },
  },
);
