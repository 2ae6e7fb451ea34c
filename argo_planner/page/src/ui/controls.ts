/** Shared buttons and choices. */

import { html, nothing } from "./element";
import { icon, type Icon } from "./icons";

interface IconButton {
  /** Text of the tooltip, if it differs from the label. */
  readonly title?: string | typeof nothing;
  readonly disabled?: boolean;
  readonly pressed?: boolean;
  readonly expanded?: boolean;
  readonly size?: number;
  /** Id of the menu that the button opens. */
  readonly opens?: string;
  /** Further CSS classes. */
  readonly look?: string;
}

/** Render a button with an icon only; screen readers announce its label. */
export function iconButton(sign: Icon, label: string, act: ((event: Event) => unknown) | null, more: IconButton = {}) {
  return html`<button
    type="button"
    class="icon ${more.look ?? "bare"}"
    aria-label=${label}
    title=${more.title ?? label}
    aria-pressed=${more.pressed ?? nothing}
    aria-expanded=${more.expanded ?? nothing}
    popovertarget=${more.opens ?? nothing}
    ?disabled=${more.disabled ?? false}
    @click=${act}
  >
    ${icon(sign, more.size)}
  </button>`;
}

type Option<Value> = readonly [value: Value, label: unknown];

/** Render the options of a choice. */
export function options<Value>(all: readonly Option<Value>[], chosen?: Value) {
  return all.map(
    ([value, label]) => html`<option value=${String(value)} .selected=${value === chosen}>${label}</option>`,
  );
}

/** Render a choice with its label, for a form. */
export function choice<Value>(label: string, name: string, all: readonly Option<Value>[], chosen?: Value) {
  return html`<label>
    ${label}
    <select name=${name}>
      ${options(all, chosen)}
    </select>
  </label>`;
}

/** Return the value of the field that an event comes from. */
export function valueOf(event: Event): string {
  return (event.target as HTMLInputElement | HTMLSelectElement).value;
}
