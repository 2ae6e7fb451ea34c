/** The person and the settings of the page, stored in the browser if possible. */

import { effect, signal } from "@preact/signals-core";

import { responseData, client, setAuthor } from "../api/client";
import type { ServiceSummary } from "../api/types";
import { language, type Language } from "../texts";

export type Theme = "light" | "dark";

/** The service and the person's role; null until the service has answered. */
export const service = signal<ServiceSummary | null>(null);
export const author = signal(storedSetting("author") ?? "");
export const theme = signal<Theme>(firstTheme());

/** Return whether a name is that of the person at the page. */
export function isMe(name: string): boolean {
  return name === (service.value?.named ? service.value.author : author.value || "somebody");
}

/** Return whether the person may change missions. */
export function mayPlan(): boolean {
  return service.value !== null && service.value.role !== "view";
}

/** Return whether the person may start and control runs. */
export function mayOperate(): boolean {
  return service.value?.role === "operate";
}

/** Return the names of what installed packages offer of a kind, such as `sensor`. */
export function extensionsOf(kind: string): readonly string[] {
  return (service.value?.extensions ?? []).filter((one) => one.kind === kind).map((one) => one.name);
}

/** Return the options of a choice: Argo's own with their texts, and those of installed packages with their names. */
export function withExtensions(
  own: readonly string[],
  texts: Readonly<Record<string, string>>,
  kind: string,
): readonly (readonly [string, string])[] {
  return [...own, ...extensionsOf(kind)].map((name) => [name, texts[name] ?? name]);
}

/** Read the stored settings, and store changes. */
export function beginSession(): void {
  language.value = firstLanguage();
  effect(() => {
    setAuthor(author.value);
    storeSetting("author", author.value);
  });
  effect(() => {
    document.documentElement.dataset["theme"] = theme.value;
    storeSetting("theme", theme.value);
  });
  effect(() => {
    document.documentElement.lang = language.value;
    storeSetting("language", language.value);
  });
}

/** Read the summary of the service. Throws `Refusal` or `Unreached`. */
export async function readService(): Promise<void> {
  service.value = await responseData(client.GET("/api/service"));
}

function firstTheme(): Theme {
  const known = storedSetting("theme");
  if (known === "dark" || known === "light") return known;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

function firstLanguage(): Language {
  const known = storedSetting("language");
  if (known === "de" || known === "en") return known;
  return navigator.language.startsWith("de") ? "de" : "en";
}

/** Return a setting stored in the browser; null: there is none. */
export function storedSetting(name: string): string | null {
  try {
    return localStorage.getItem(`argo.${name}`);
  } catch {
    return null; // storage is disabled
  }
}

export function storeSetting(name: string, value: string): void {
  try {
    localStorage.setItem(`argo.${name}`, value);
  } catch {
    // storage is disabled or full: the setting is lost
  }
}
