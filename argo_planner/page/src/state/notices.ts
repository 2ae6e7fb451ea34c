/** Notices of the page: short messages, some with buttons. */

import { signal } from "@preact/signals-core";

import { Refusal, Unreached } from "../api/client";
import type { Diagnostic } from "../api/types";
import { t } from "../texts";
import { said } from "../texts/messages";

export interface Notice {
  readonly id: number;
  readonly tone: "info" | "warn" | "bad";
  readonly text: string;
  readonly details: readonly string[];
  readonly actions: readonly { readonly label: string; readonly act: () => void }[];
  /** id of the mission that was open; null: none was */
  readonly plan: string | null;
}

export const notices = signal<readonly Notice[]>([]);
/** ms after which a notice without buttons disappears */
const STAYS_MS = { info: 5_000, warn: 15_000, bad: 25_000 };
const MOST = 3;
let count = 0;
let openPlanId: string | null = null;

/** Show notices of this mission from now on, and dismiss those of others; null: no mission is open. */
export function showNoticesOf(plan: string | null): void {
  openPlanId = plan;
  if (plan !== null) notices.value = notices.value.filter((one) => one.plan === null || one.plan === plan);
}

/** Show a notice. Returns its id, by which it can be dismissed. */
export function showNotice(
  tone: Notice["tone"],
  text: string,
  more: { details?: readonly string[]; actions?: Notice["actions"] } = {},
): number {
  const id = ++count;
  const notice = { id, tone, text, details: more.details ?? [], actions: more.actions ?? [], plan: openPlanId };
  const others = notices.value.filter((one) => one.text !== text);
  notices.value = [...others, notice].slice(-MOST);
  if (notice.actions.length === 0) dismissLater(id, STAYS_MS[tone]);
  return id;
}

/** Dismiss a notice after a time, but not while the page is hidden. */
function dismissLater(id: number, ms: number): void {
  setTimeout(() => (document.hidden ? dismissLater(id, ms) : dismiss(id)), ms);
}

/** Dismiss the newest notice. */
export function dismissNewest(): void {
  notices.value = notices.value.slice(0, -1);
}

export function dismiss(id: number): void {
  notices.value = notices.value.filter((one) => one.id !== id);
}

/** Show an error of a request as a notice; rethrow all other errors. */
export function showError(error: unknown): void {
  if (error instanceof Refusal) {
    const { diagnostics } = error.problem;
    showNotice("bad", messageOf(error), { details: [...new Set(hintsOf(diagnostics))].slice(0, 5) });
  } else if (error instanceof Unreached) {
    showNotice("warn", t().frame.notReached);
  } else throw error;
}

/** Carry out requests to the service. Returns whether they succeeded; otherwise a notice gives the reason. */
export async function withErrorNotice(work: () => Promise<unknown>): Promise<boolean> {
  try {
    await work();
    return true;
  } catch (error) {
    showError(error);
    return false;
  }
}

/** Carry out requests to the service. Returns null if they succeeded, or the reason, for the place that it is
 * about; rethrows all other errors. */
export async function reasonOfFailure(work: () => Promise<unknown>): Promise<string | null> {
  try {
    await work();
    return null;
  } catch (error) {
    if (error instanceof Unreached) return t().frame.notReached;
    if (!(error instanceof Refusal)) throw error;
    return [messageOf(error), ...new Set(hintsOf(error.problem.diagnostics))].join(" – ");
  }
}

/** Return the reason of a refusal as a sentence. */
export function messageOf(refusal: Refusal): string {
  const errors = refusal.problem.diagnostics.filter((one) => one.severity === "error");
  if (errors.length > 0) return errors.map((one) => said(one.message, one.message_wording)).join("; ");
  return said(refusal.problem.detail, refusal.problem.detail_wording);
}

function hintsOf(diagnostics: readonly Diagnostic[]): string[] {
  return diagnostics.flatMap((one) => (one.hint ? [said(one.hint, one.hint_wording)] : []));
}
