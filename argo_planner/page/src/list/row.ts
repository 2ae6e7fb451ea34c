/** A row of the list: a task or a group. */

import { classMap } from "lit/directives/class-map.js";

import type { Action } from "../api/types";
import { ownName, type Row } from "../model/outline";
import { groupDetail, stepNumbers, taskDetail, taskTitle } from "../state/task-labels";
import { t } from "../texts";
import { said } from "../texts/messages";
import { css, html, nothing } from "../ui/element";
import { styled } from "../ui/styled";
import { icon, type Icon } from "../ui/icons";
import type { Marks } from "./marks";

/** px */
export const ROW_HEIGHT = 46;

const SIGNS: Record<Action, Icon> = {
  START: "flag",
  WAYPOINT: "drive",
  MEASURE: "gauge",
  WAIT: "wait",
};

/** px */
const NUMBER_WIDTH = 32;

export const rowStyles = css`
  [role="treeitem"] {
    position: absolute;
    right: 0;
    left: 0;
    display: grid;
    grid-template-columns: 26px minmax(0, 1fr) auto;
    align-items: center;
    gap: 4px;
    height: ${ROW_HEIGHT}px;
    padding: 2px 6px 2px ${NUMBER_WIDTH}px;
    border-bottom: 1px solid var(--sunken);
    cursor: default;
  }
  [role="treeitem"]:hover {
    background: var(--sunken);
  }
  [role="treeitem"][aria-selected="true"] {
    background: var(--chosen);
  }
  [role="treeitem"].group {
    font-weight: 600;
  }
  [role="treeitem"].lit {
    outline: 2px solid var(--accent);
    outline-offset: -2px;
  }
  [role="treeitem"].active {
    box-shadow: inset 3px 0 var(--accent);
  }
  .flash {
    animation: flash 1.6s;
  }
  @keyframes flash {
    from {
      background: var(--person-ground);
    }
  }
  .number {
    position: absolute;
    left: 0;
    width: ${NUMBER_WIDTH - 2}px;
    color: var(--dim);
    font-size: 12px;
    font-weight: 400;
    font-variant-numeric: tabular-nums;
    text-align: right;
  }
  .sign {
    display: grid;
    place-content: center;
    width: 26px;
    height: 26px;
    border-radius: 50%;
    color: var(--dim);
  }
  .fold {
    width: 26px;
    min-height: 26px;
    padding: 0;
    border: 0;
    background: none;
  }
  .names {
    min-width: 0;
  }
  .names > * {
    display: block;
    overflow: hidden;
    text-overflow: ellipsis;
    white-space: nowrap;
  }
  .detail {
    color: var(--dim);
    font-size: 12px;
    font-weight: 400;
  }
  .names input {
    width: 100%;
    min-height: 26px;
  }
  .marks {
    display: flex;
    align-items: center;
    gap: 3px;
  }
  @container (max-width: 300px) {
    .count {
      display: none;
    }
  }
  .error {
    color: var(--bad);
  }
  .warning {
    color: var(--warn);
  }
  .good {
    color: var(--good);
  }
  .who {
    display: inline-block;
    width: 10px;
    height: 10px;
    border-radius: 50%;
    background: var(--person);
  }
`;

export interface RowState {
  readonly chosen: boolean;
  /** Whether the pointer is on its words in the script. */
  readonly lit: boolean;
  readonly folded: boolean;
  /** Initial text of the field for its name; null: there is no field. */
  readonly name: string | null;
  /** Total number of rows. */
  readonly of: number;
  /** px at the right that lines of branches take */
  readonly branches: number;
  readonly marks: Marks;
  readonly may: boolean;
  /** Saves the typed name; `byKey`: the list is to get the focus back. */
  readonly onNamed: (row: Row, name: string, byKey: boolean) => Promise<void>;
}

export function rowView(row: Row, index: number, shown: RowState) {
  const group = row.kind === "group";
  const { marks } = shown;
  const place = {
    top: `${index * ROW_HEIGHT}px`,
    "padding-left": `${NUMBER_WIDTH + 14 * Math.min(row.depth, 8)}px`,
    "padding-right": `${6 + shown.branches}px`,
  };
  const detail = row.kind === "task" ? taskDetail(row.task) : groupDetail(row.group);
  return html`<div
    role="treeitem"
    id=${`row-${index}`}
    data-index=${index}
    data-name=${nameOf(row)}
    class=${classMap({ group, lit: shown.lit, active: marks.run === "active", flash: marks.changed })}
    ${styled(place)}
    draggable=${shown.may && shown.name === null ? "true" : "false"}
    aria-level=${row.depth + 1}
    aria-setsize=${shown.of}
    aria-posinset=${index + 1}
    aria-selected=${shown.chosen}
    aria-expanded=${group ? !shown.folded : nothing}
  >
    <span class="number">${stepNumbers.value.get(row.key) ?? nothing}</span>
    ${group
      ? html`<span class="fold sign" title=${shown.folded ? t().list.unfold : t().list.fold}
          >${icon(shown.folded ? "right" : "down", 16)}</span
        >`
      : html`<span class="sign" title=${t().words.action[row.task.action]}
          >${icon(SIGNS[row.task.action], 18)}</span
        >`}
    <span class="names">
      ${shown.name !== null ? nameField(row, shown.name, shown.onNamed) : html`<span>${titleOf(row)}</span>`}
      <span class="detail" title=${detail}>${detail}</span>
    </span>
    <span class="marks">
      ${group ? html`<span class="count dim">${t().list.count(row.count)}</span>` : nothing}
      ${marks.people.map(
        (name) => html`<span class="who" role="img" title=${t().list.selectedBy(name)} aria-label=${t().list.selectedBy(name)}></span>`,
      )}
      ${marks.run ? runMark(marks.run) : nothing}
      ${marks.problem
        ? html`<span class=${marks.problem.severity} role="img" title=${said(marks.problem.message, marks.problem.message_wording)} aria-label=${said(marks.problem.message, marks.problem.message_wording)}
            >${icon("warning", 18)}</span
          >`
        : nothing}
    </span>
  </div>`;
}

/** Return the name of a task, or that of a group without the groups around it. */
export function nameOf(row: Row): string {
  return row.kind === "task" ? row.task.name : ownName(row.group.name);
}

function titleOf(row: Row): string {
  return row.kind === "task" ? taskTitle(row.task) : ownName(row.group.name);
}

function nameField(row: Row, text: string, onNamed: RowState["onNamed"]) {
  const onKey = (event: KeyboardEvent) => {
    event.stopPropagation();
    if (event.key !== "Escape" && event.key !== "Enter") return;
    const field = event.target as HTMLInputElement;
    void onNamed(row, event.key === "Enter" ? field.value.trim() : nameOf(row), true);
  };
  const onBlur = (event: FocusEvent) => {
    const field = event.target as HTMLInputElement;
    if (field.isConnected) void onNamed(row, field.value.trim(), false);
  };
  return html`<input
    aria-label=${t().list.renameTask}
    maxlength="200"
    .value=${text}
    @keydown=${onKey}
    @blur=${onBlur}
    @dblclick=${(event: Event) => event.stopPropagation()}
  />`;
}

function runMark(state: NonNullable<Marks["run"]>) {
  const signs: Record<typeof state, readonly [Icon, string]> = {
    done: ["check", "good"],
    abnormal: ["warning", "error"],
    failed: ["close", "error"],
    byHand: ["hand", "good"],
    active: ["play", ""],
    skipped: ["skip", "dim"],
  };
  const [sign, tone] = signs[state];
  const wording = t().list.states[state];
  return html`<span class=${tone} role="img" title=${wording} aria-label=${wording}>${icon(sign, 18)}</span>`;
}
