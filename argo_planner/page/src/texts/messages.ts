/** Messages of the service and its libraries, in the language of the page. They come as English texts, with the
 * templates and the parameters that they were made from. */

import { effect, signal } from "@preact/signals-core";

import type { Wording } from "../api/types";
import { language, t } from ".";
import plainEnglish from "./plain-english.json";

type Catalogue = Readonly<Record<string, string>>;
type Parameter = Wording["parameters"][string];

/** English templates that name fields of files or identifiers, in the words of the page. */
const PLAIN: Catalogue = plainEnglish;
/** German templates by the English ones; empty until German is chosen. */
const german = signal<Catalogue>({});

effect(() => {
  if (language.value === "de" && Object.keys(german.value).length === 0) void loadGerman();
});

/** Load the German templates. */
export async function loadGerman(): Promise<void> {
  german.value = (await import("../../../../argo_compiler/base/german.json")).default;
}

/** Return a message in the language of the page; without `wording` the text is its own template. */
export function said(text: string, wording?: Wording | null): string {
  return wording ? worded(wording) : inLanguage(text);
}

/** Return a message, or an empty text if there is none. */
export function saidIfAny(text: string | null | undefined, wording?: Wording | null): string {
  return text ? said(text, wording) : "";
}

/** Return several messages in the language of the page. */
export function saidAll(texts: readonly string[], wordings?: readonly (Wording | null)[]): string[] {
  return texts.map((text, at) => said(text, wordings?.[at]));
}

/** Return a template in the language of the page; what no catalogue has stays as it is. */
function inLanguage(template: string): string {
  const catalogue: Catalogue = language.value === "de" ? german.value : PLAIN;
  return catalogue[template] ?? template;
}

function worded({ template, parameters }: Wording): string {
  const known = inLanguage(template);
  if (Object.keys(parameters).length === 0) return known;
  return known.replace(/\{\{|\}\}|\{(\w+)(?::([^}]*))?\}/g, (field, name: string | undefined, format: string | undefined) =>
    name === undefined ? field.charAt(0) : shown(parameters[name], format ?? ""),
  );
}

function shown(value: Parameter | undefined, format: string): string {
  if (value === undefined) return "";
  if (typeof value === "string") return value;
  if (typeof value === "number") return shownNumber(value, format);
  if ("template" in value) return worded(value);
  return joined(value.map((item) => shown(item, "")), format);
}

const SEPARATORS: Catalogue = { "": ", ", ";": "; ", ">": " > ", " ": " " };

/** Join the items of a list as its format says: with `and` or `or` before the last one, or with a separator. */
function joined(items: readonly string[], format: string): string {
  const separator = SEPARATORS[format];
  if (separator !== undefined) return items.join(separator);
  const conjunction = { and: t().words.and, or: t().words.or }[format] ?? format;
  const last = items.length - 1;
  return last < 1 ? items.join("") : `${items.slice(0, last).join(", ")} ${conjunction} ${items[last] ?? ""}`;
}

/** Format a number as Python does, but with the signs of the language. */
function shownNumber(value: number, format: string): string {
  const [, sign = "", comma = "", digits, kind = ""] = /^([+]?)(,?)(?:\.(\d+))?([a-z%]?)$/.exec(format) ?? [];
  const places = digits === undefined ? 6 : Number(digits);
  let text = String(value);
  if (kind === "f") text = value.toFixed(places);
  else if (kind === "%") text = `${(100 * value).toFixed(places)}${language.value === "de" ? " %" : "%"}`;
  else if (kind === "g") text = general(value, Math.max(places, 1));
  if (comma !== "") text = text.replace(/\d(?=(\d{3})+(?!\d))/g, "$&,");
  if (sign !== "" && value >= 0) text = `+${text}`;
  if (language.value !== "de") return text;
  return text.replace(/[.,]/g, (mark) => (mark === "." ? "," : "."));
}

/** Format a number with a number of significant digits, without zeros at the end. */
function general(value: number, digits: number): string {
  const text = value.toPrecision(digits);
  return text.includes("e") ? String(Number(text)) : text.replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
}
