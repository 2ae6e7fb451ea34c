/** All texts of the page in both languages, with a file for each area. */

import { signal } from "@preact/signals-core";

import { compare } from "./compare";
import { draft } from "./draft";
import { evaluate } from "./evaluate";
import { faults } from "./faults";
import { floorplan } from "./floorplan";
import { forms } from "./forms";
import { frame } from "./frame";
import { home } from "./home";
import { keys } from "./keys";
import { list } from "./list";
import { route } from "./route";
import { run } from "./run";
import { scene } from "./scene";
import { script } from "./script";
import { strip } from "./strip";
import { tasks } from "./tasks";
import { verdict } from "./verdict";
import { words } from "./words";

export type Language = "en" | "de";

const AREAS = { compare, draft, evaluate, faults, floorplan, forms, frame, home, keys, list, route, run, scene, script, strip, tasks, verdict, words };
type Areas = typeof AREAS;
export type Texts = { readonly [area in keyof Areas]: Areas[area]["en"] };

function texts(language: Language): Texts {
  const entries = Object.entries(AREAS).map(([area, both]) => [area, both[language]]);
  return Object.fromEntries(entries) as Texts;
}

const ALL: Record<Language, Texts> = { en: texts("en"), de: texts("de") };

export const language = signal<Language>("en");

/** Return the texts in the chosen language. */
export function t(): Texts {
  return ALL[language.value];
}

/** Return the locale of dates: the browser's, if it has the page's language. */
export function dateLocale(): string {
  return navigator.languages.find((one) => one.startsWith(language.value)) ?? language.value;
}
