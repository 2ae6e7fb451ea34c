/** The details of the selection: a task, a group, a reaction, several tasks, or the mission. */

import { keyed } from "lit/directives/keyed.js";

import type { Task } from "../api/types";
import { isTaskKey, nameOfKey } from "../model/outline";
import { editFromForm } from "../state/commands";
import { identityOf } from "../state/identity";
import { mission, planId, selection, tasksByName } from "../state/plan";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import type { FormField } from "./field";
import { groupForm } from "./group-form";
import { headerForm } from "./header-form";
import { checkField, countField, optionsOf, selectField, speedField } from "./parts";
import { reactionForm } from "./reaction-form";
import { taskForm } from "./task-form";

@customElement("argo-properties")
export class PropertiesPanel extends PageElement {
  static override styles = css`
    :host {
      padding: 12px;
    }
    h2,
    h3 {
      margin: 4px 0 8px;
    }
    h3 {
      margin-top: 14px;
    }
    p {
      margin-bottom: 8px;
    }
    .title {
      display: flex;
      align-items: start;
      justify-content: space-between;
    }
    .two,
    .four {
      display: grid;
      grid-template-columns: 1fr 1fr;
      column-gap: 8px;
    }
    fieldset {
      margin: 0 0 8px;
      padding: 4px 8px 6px;
      border: 1px solid var(--line);
      border-radius: 6px;
    }
    legend {
      padding: 0 4px;
      color: var(--dim);
    }
    .way {
      margin-bottom: 10px;
      padding: 8px;
      border-left: 3px solid var(--accent);
      background: var(--ground);
    }
    details {
      margin: 8px 0;
      border-top: 1px solid var(--line);
    }
    summary {
      padding: 6px 0;
    }
    ul {
      margin: 14px 0;
      padding-left: 40px;
      list-style: disc;
    }
    .error {
      color: var(--bad);
    }
  `;

  constructor() {
    super();
    this.listen("open-details", ({ detail }) => this.focusField(detail));
  }

  /** Move the cursor into the field with this label, or into the first field. */
  private focusField(label: string | undefined): void {
    const fields = [...this.renderRoot.querySelectorAll<FormField>("argo-field")];
    (fields.find((field) => field.label === label) ?? fields[0])?.focus();
  }

  override render() {
    const open = mission.value;
    if (open === null) return nothing;
    const keys = selection.value;
    const [key] = keys;
    const tasks = keys.filter(isTaskKey).flatMap((one) => {
      const task = tasksByName.value.get(nameOfKey(one));
      return task ? [task] : [];
    });
    const whole = () => keyed(planId.value, headerForm(open));
    if (tasks.length > 1) return html`${keyed(keys.map(identityOf).join(), severalForm(tasks))}`;
    if (key === undefined) return html`${whole()}`;
    const name = nameOfKey(key);
    const task = tasks[0];
    const group = open.groups.find((one) => one.name === name);
    const reaction = open.reactions.find((one) => one.event === name);
    let form;
    if (isTaskKey(key) && task) form = taskForm(task);
    else if (key.startsWith("group:") && group) form = groupForm(group);
    else if (reaction) form = reactionForm(reaction);
    else return html`${whole()}`;
    return html`${keyed(identityOf(key), form)}`;
  }
}

/** Render the fields that can be set for several tasks at once. */
function severalForm(tasks: readonly Task[]) {
  const texts = t().forms;
  const set = (fields: Partial<Task>) =>
    editFromForm(() => tasks.map(({ name }) => ({ kind: "change_task", name, ...fields }) as const));
  const shared = <Key extends keyof Task>(key: Key): Task[Key] | null => {
    const [first] = tasks;
    return first && tasks.every((one) => one[key] === first[key]) ? first[key] : null;
  };
  return html`<h2>${texts.several(tasks.length)}</h2>
    ${speedField(texts.speed, shared("velocity"), (velocity) => set({ velocity }))}
    ${countField(texts.retries, shared("retries"), (retries) => set({ retries: retries ?? 0 }))}
    ${selectField(
      texts.onFailure,
      shared("on_failure") ?? "",
      optionsOf(texts.failures).filter(({ value }) => value !== "branch"),
      (value) => set({ on_failure: value as Task["on_failure"], failure_target: null }),
    )}
    ${checkField(texts.optional, shared("optional") ?? false, (optional) => set({ optional }))}
    ${countField(texts.priority, shared("priority"), (priority) =>
      set({ priority: priority ?? 1 }),
    )}`;
}
