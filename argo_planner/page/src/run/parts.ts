/** Shared parts of the panels for runs, evaluations and orders: styles, speeds, list of checkpoints. */

import { checkpointSuggestion } from "../model/checkpoint-choice";
import { world } from "../state/world";
import { t } from "../texts";
import { css, html } from "../ui/element";

/** Simulated seconds per second; null: as fast as possible. */
export const SPEEDS: readonly (number | null)[] = [0.5, 1, 2, 5, 10, 30, null];

export function speedName(speed: number | null): string {
  return speed === null ? t().run.fullSpeed : t().run.times(speed);
}

/** Return the speed of an option. */
export function readSpeed(value: string): number | null {
  return value === "null" ? null : Number(value);
}

/** Render the checkpoints as suggestions of a field. */
export function checkpointList(id: string) {
  return html`<datalist id=${id}>
    ${(world.value?.checkpoints ?? []).map((one) => html`<option value=${checkpointSuggestion(one)}></option>`)}
  </datalist>`;
}

export const parts = css`
  :host {
    container-type: inline-size;
  }
  h2 {
    margin-bottom: 4px;
    font-size: 13px;
    text-transform: none;
  }
  label {
    font-size: 12px;
    color: var(--dim);
  }
  label > input,
  label > select {
    font-size: 14px;
    color: var(--text);
    min-width: 0;
    width: 100%;
  }
  .pair {
    display: grid;
    grid-template-columns: 1fr 1fr;
    gap: var(--gap);
  }
  .begin {
    display: grid;
    grid-template-columns: 1fr minmax(110px, auto);
    align-items: end;
    gap: var(--gap);
  }
  .begin button,
  .begin select {
    min-height: 44px;
  }
  .begin button {
    font-weight: 600;
  }
  .reason {
    color: var(--dim);
    font-size: 12px;
  }
  .wrong {
    color: var(--bad);
    overflow-wrap: anywhere;
  }
  .inner {
    display: grid;
    grid-template-columns: minmax(0, 1fr);
    gap: 10px;
    padding: 4px 0 4px 10px;
    border-left: 2px solid var(--line);
  }
  details > summary {
    padding: 4px 0;
  }
`;
