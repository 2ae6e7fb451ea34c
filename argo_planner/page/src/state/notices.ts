/** What the page tells whoever looks: short messages, some with a way out. */

import { signal } from "@preact/signals-core";

import { Refusal, Unreached } from "../api/client";
import { t } from "../texts";

export interface Notice {
  readonly id: number;
  readonly tone: "info" | "warn" | "bad";
  readonly text: string;
  readonly details: readonly string[];
  readonly actions: readonly { readonly label: string; readonly act: () => void }[];
}

export const notices = signal<readonly Notice[]>([]);
/** ms after which a message goes, if there is nothing to be chosen in it */
const STAYS_MS = { info: 5_000, warn: 15_000, bad: 25_000 };
const MOST = 3;
let count = 0;

/** Tells something; the id under which it can be dismissed. */
export function tell(
  tone: Notice["tone"],
  text: string,
  more: { details?: readonly string[]; actions?: Notice["actions"] } = {},
): number {
  const id = ++count;
  const notice = { id, tone, text, details: more.details ?? [], actions: more.actions ?? [] };
  const others = notices.value.filter((one) => one.text !== text);
  notices.value = [...others, notice].slice(-MOST);
  if (notice.actions.length === 0) dismissLater(id, STAYS_MS[tone]);
  return id;
}

/** Nothing goes that nobody could have seen. */
function dismissLater(id: number, ms: number): void {
  setTimeout(() => (document.hidden ? dismissLater(id, ms) : dismiss(id)), ms);
}

/** Takes the newest message away. */
export function dismissNewest(): void {
  notices.value = notices.value.slice(0, -1);
}

export function dismiss(id: number): void {
  notices.value = notices.value.filter((one) => one.id !== id);
}

/** Tells of an error; anything that is no answer of the service is thrown on. */
export function tellError(error: unknown): void {
  if (error instanceof Refusal) {
    const { diagnostics } = error.problem;
    const details = diagnostics.flatMap((one) => (one.hint ? [one.hint] : []));
    tell("bad", messageOf(error), { details: [...new Set(details)].slice(0, 5) });
  } else if (error instanceof Unreached) {
    tell("warn", t().frame.notReached);
  } else throw error;
}

/** Does what the service is asked for; a notice says why not. Whether it was done. */
export async function telling(work: () => Promise<unknown>): Promise<boolean> {
  try {
    await work();
    return true;
  } catch (error) {
    tellError(error);
    return false;
  }
}

/** Why something was refused, in a sentence. */
export function messageOf(refusal: Refusal): string {
  const errors = refusal.problem.diagnostics.filter((one) => one.severity === "error");
  return errors.length > 0 ? errors.map((one) => one.message).join("; ") : refusal.problem.detail;
}
