/** Who works here, and how they like the page. Kept in the browser where it lets us. */

import { effect, signal } from "@preact/signals-core";

import { answered, client, workAs } from "../api/client";
import type { ServiceSummary } from "../api/types";
import { language, type Language } from "../texts";

export type Theme = "light" | "dark";

/** What the service is, and what whoever looks may do; null until it has said so. */
export const service = signal<ServiceSummary | null>(null);
export const author = signal(kept("author") ?? "");
export const theme = signal<Theme>(firstTheme());

/** Whether something was done under the name of whoever looks. */
export function isMe(name: string): boolean {
  return name === (service.value?.named ? service.value.author : author.value || "somebody");
}

/** Whether they may change missions. */
export function mayPlan(): boolean {
  return service.value !== null && service.value.role !== "view";
}

/** Whether they may start and steer runs. */
export function mayOperate(): boolean {
  return service.value?.role === "operate";
}

/** Reads what was kept, and keeps what changes. */
export function beginSession(): void {
  language.value = firstLanguage();
  effect(() => {
    workAs(author.value);
    keep("author", author.value);
  });
  effect(() => {
    document.documentElement.dataset["theme"] = theme.value;
    keep("theme", theme.value);
  });
  effect(() => {
    document.documentElement.lang = language.value;
    keep("language", language.value);
  });
}

/** Asks the service who it is. Throws `Refusal` or `Unreached`. */
export async function readService(): Promise<void> {
  service.value = await answered(client.GET("/api/service"));
}

function firstTheme(): Theme {
  const known = kept("theme");
  if (known === "dark" || known === "light") return known;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

function firstLanguage(): Language {
  const known = kept("language");
  if (known === "de" || known === "en") return known;
  return navigator.language.startsWith("de") ? "de" : "en";
}

/** What the browser keeps under a name; null if it keeps nothing. */
export function kept(name: string): string | null {
  try {
    return localStorage.getItem(`argo.${name}`);
  } catch {
    return null; // storage is switched off
  }
}

export function keep(name: string, value: string): void {
  try {
    localStorage.setItem(`argo.${name}`, value);
  } catch {
    // storage is switched off or full: it is not known next time
  }
}
