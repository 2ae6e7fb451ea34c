/** The overview of keyboard shortcuts, which `?` opens, and the keys that work everywhere. */

import { signal } from "@preact/signals-core";

import { openedDraft } from "../draft/state";
import { openPlans, plansShown } from "../floorplan/state";
import { PropertiesPanel } from "../forms/properties";
import { redo, undo } from "../state/commands";
import { dismissNewest, notices } from "../state/notices";
import { planId, select, selection } from "../state/plan";
import { isUnderWay } from "../model/run-mode";
import { sendRequest, pendingRequests } from "../state/requests";
import { run, runIsOn, showRun } from "../state/run";
import { mayOperate, mayPlan } from "../state/session";
import { listShown, panel, tool } from "../state/view";
import { t } from "../texts";
import { css, customElement, html, PageElement, query } from "../ui/element";

/** Whether the overview is open. */
export const keysShown = signal(false);

@customElement("argo-keys")
export class PageKeys extends PageElement {
  static override styles = css`
    dialog {
      width: min(760px, calc(100vw - 24px));
      max-height: calc(100vh - 48px);
      padding: 16px 20px 20px;
      border: 1px solid var(--line);
      border-radius: 10px;
      background: var(--raised);
      color: var(--text);
      box-shadow: var(--shadow);
    }
    dialog::backdrop {
      background: rgb(0 0 0 / 40%);
    }
    .groups {
      columns: 2;
      column-gap: 28px;
      margin-top: 12px;
    }
    section {
      break-inside: avoid;
      margin-bottom: 14px;
    }
    dl {
      display: grid;
      grid-template-columns: max-content 1fr;
      gap: 4px 12px;
      margin: 6px 0 0;
    }
    dd {
      margin: 0;
    }
    kbd {
      padding: 1px 5px;
      border: 1px solid var(--line);
      border-radius: 4px;
      background: var(--sunken);
      font: inherit;
      font-size: 12px;
    }
    @media (max-width: 600px) {
      .groups {
        columns: 1;
      }
    }
  `;

  @query("dialog") private readonly dialog!: HTMLDialogElement;

  constructor() {
    super();
    this.listen("keydown", this.onKey);
  }

  override updated(): void {
    if (keysShown.value && !this.dialog.open) this.dialog.showModal();
    if (!keysShown.value && this.dialog.open) this.dialog.close();
  }

  private readonly onKey = (event: KeyboardEvent): void => {
    if (event.defaultPrevented || inPopover(event)) return;
    if (isTyping(event)) {
      const form = event.composedPath().some((one) => one instanceof PropertiesPanel);
      if (event.key === "Escape" && form) dispatchEvent(new CustomEvent("focus-list"));
      return;
    }
    const key = event.key.toLowerCase();
    const command = event.ctrlKey || event.metaKey;
    if (key === "?" && !command) keysShown.value = true;
    else if (command && planId.value !== null && mayPlan() && key === "z") void (event.shiftKey ? redo() : undo());
    else if (command && planId.value !== null && mayPlan() && key === "y") void redo();
    else if (key === "p" && !command && !event.altKey && planId.value !== null) void openPlans("plans");
    else if (key === "f8" && planId.value !== null) openRun();
    else if (key === "f9" && !event.repeat && canTakeOver()) void takeOver();
    else if (key === "escape" && listShown.value) listShown.value = false;
    else if (key === "escape" && tool.value !== "select") {
      tool.value = "select";
      dispatchEvent(new CustomEvent("focus-list"));
    }
    else if (key === "escape" && notices.value.length > 0) dismissNewest();
    else if (key === "escape" && selection.value.length > 0) select([]);
    else return;
    event.preventDefault();
  };

  override render() {
    const { draft, ...others } = t().keys;
    const all = openedDraft.value === null ? [...Object.values(others), draft] : [draft, ...Object.values(others)];
    const groups = keysShown.value ? all : [];
    return html`<dialog
      aria-labelledby="title"
      @close=${() => (keysShown.value = false)}
      @click=${(event: Event) => event.target === this.dialog && this.dialog.close()}
    >
      <div class="row">
        <h1 id="title" class="grow">${t().frame.keysTitle}</h1>
        <button @click=${() => this.dialog.close()}>${t().frame.close}</button>
      </div>
      <div class="groups">
        ${groups.map(
          ({ title, keys }) =>
            html`<section>
              <h2>${title}</h2>
              <dl>
                ${keys.map(
                  ([key, what]) =>
                    html`<dt>${key.split(" ").map((one) => html`<kbd>${one}</kbd> `)}</dt>
                      <dd>${what}</dd>`,
                )}
              </dl>
            </section>`,
        )}
      </div>
    </dialog>`;
  }
}

/** Return whether the open mission is driving the robot autonomously. */
function canTakeOver(): boolean {
  const now = run.value;
  if (now === null || now.status !== "running" || now.plan !== planId.value || !mayOperate()) return false;
  return now.mode !== "supervised" && !pendingRequests.value.includes("take_over") && !isUnderWay(now, "take_over");
}

async function takeOver(): Promise<void> {
  openRun();
  await sendRequest({ kind: "take_over" });
}

/** Show the robot's present run, not a past one, and move the focus to the next likely button. */
function openRun(): void {
  if (runIsOn.value) void showRun(null);
  panel.value = "run";
  plansShown.value = "off";
  setTimeout(() => dispatchEvent(new CustomEvent("open-run")));
}

/** Return whether a key belongs to a menu, which the browser closes with Escape. */
function inPopover(event: KeyboardEvent): boolean {
  return event.composedPath().some((one) => one instanceof HTMLElement && one.matches(":popover-open"));
}

/** Return whether a key belongs to a field or a dialog. */
export function isTyping(event: KeyboardEvent): boolean {
  return event.composedPath().some(
    (target) =>
      target instanceof HTMLElement &&
      (target.isContentEditable || target.matches("input:not([type=checkbox]), textarea, select, dialog")),
  );
}
