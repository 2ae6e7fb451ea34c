/** The faults of a run or an evaluation: add, describe and remove them. */

import type { FaultDescription, FaultField } from "../api/types";
import type { FormField } from "../forms/field";
import { numberField, selectField, timeField } from "../forms/parts";
import {
  atCheckpoint,
  checkpointOf,
  faultProblems,
  hasPlace,
  placeForm,
  refusalOf,
  withField,
  type FaultDraft,
  type FaultValue,
} from "../model/faults";
import {
  addFault,
  beginPlacing,
  faultDescriptions,
  faultsOf,
  openedFault,
  placingFault,
  readFaultKinds,
  removeFault,
  replaceFault,
  stopPlacing,
  type FaultList,
} from "../state/faults";
import { extensionsOf } from "../state/session";
import { world } from "../state/world";
import { t } from "../texts";
import { faultText } from "../texts/fault-names";
import { run } from "../texts/run";
import { iconButton, options } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, property } from "../ui/element";
import { icon } from "../ui/icons";
import { checkpointText, choiceText, faultSummary, fieldText, fromShown, problemText, shownUnit, toShown } from "./fault-words";
import { parts } from "./parts";

/** Return all kinds of faults: those of the texts, in their order, and those of installed packages. */
export function faultKinds(): readonly string[] {
  return [...Object.keys(run.en.fault), ...extensionsOf("fault")];
}

@customElement("argo-faults")
export class FaultChoice extends PageElement {
  static override styles = [
    parts,
    css`
      select {
        width: 100%;
      }
      li {
        padding: 4px 0;
        border-top: 1px solid var(--line);
      }
      .name {
        overflow-wrap: anywhere;
      }
      .name p {
        font-size: 12px;
        color: var(--dim);
      }
      .fields {
        padding: 6px 0 2px 10px;
        border-left: 2px solid var(--accent);
      }
      .two {
        display: grid;
        grid-template-columns: 1fr 1fr;
        gap: 0 var(--gap);
      }
      .buttons {
        display: flex;
        flex-wrap: wrap;
        gap: 6px;
        margin-bottom: 8px;
      }
      fieldset {
        min-width: 0;
        margin: 0 0 8px;
        padding: 4px 8px 0;
        border: 1px solid var(--line);
        border-radius: 6px;
      }
      legend {
        color: var(--dim);
        font-size: 12px;
      }
    `,
  ];

  @property() list: FaultList = "run";
  /** why the service has refused the faults; null: it has not */
  @property({ attribute: false }) refusal: string | null = null;
  private wasPlacing = false;

  override connectedCallback(): void {
    super.connectedCallback();
    void readFaultKinds();
  }

  override updated(): void {
    const places = placingFault.value?.list === this.list;
    if (this.wasPlacing && !places) this.renderRoot.querySelector<HTMLElement>("#place")?.focus();
    this.wasPlacing = places;
  }

  /** Save what is typed in the fields. Returns whether all faults are possible; otherwise a field gets the focus. */
  async settle(): Promise<boolean> {
    for (const field of this.renderRoot.querySelectorAll<FormField>("argo-field"))
      if (!(await field.settle())) return false;
    const wrong = faultsOf(this.list).findIndex((fault) => this.problems(fault).length > 0);
    if (wrong < 0) return true;
    openedFault.value = { list: this.list, index: wrong };
    return false;
  }

  override render() {
    const texts = t().run;
    return html`<h2>${texts.faults}</h2>
      <ul>
        ${faultsOf(this.list).map((fault, index) => this.row(fault, index))}
      </ul>
      <select id="add-fault" aria-label=${texts.addFault} @change=${this.add}>
        <option value="">${texts.addFault}…</option>
        ${options(faultKinds().map((kind) => [kind, faultText(kind)]))}
      </select>`;
  }

  private row(fault: FaultDraft, index: number) {
    const name = faultText(fault.kind);
    const isOpen = openedFault.value?.list === this.list && openedFault.value.index === index;
    const toggle = () => {
      stopPlacing();
      openedFault.value = isOpen ? null : { list: this.list, index };
    };
    const description = faultDescriptions.value.get(fault.kind);
    const refused = refusalOf(this.refusal, index);
    const wrong = isOpen ? [] : this.problems(fault);
    return html`<li>
      <div class="row">
        <div class="grow name">
          ${name}
          <p>${faultSummary(fault)}</p>
        </div>
        ${iconButton("settings", t().faults.edit(name), toggle, { size: 16, expanded: isOpen })}
        ${iconButton("close", t().run.remove(name), () => removeFault(this.list, index), { size: 16 })}
      </div>
      ${[...wrong, ...(refused === null ? [] : [refused])].map((text) => html`<p class="wrong">${text}</p>`)}
      ${isOpen && description !== undefined ? this.fields(fault, index, description) : nothing}
    </li>`;
  }

  private problems(fault: FaultDraft): string[] {
    const description = faultDescriptions.value.get(fault.kind);
    const site = world.value;
    if (description === undefined || site === null) return [];
    return [...faultProblems(fault, description, site)].map(
      ([name, problem]) => `${fieldText(name)}: ${problemText(problem)}`,
    );
  }

  private fields(fault: FaultDraft, index: number, description: FaultDescription) {
    const texts = t().faults;
    const { fields, timed } = description;
    const named = (...names: readonly string[]) => fields.filter((field) => names.includes(field.name));
    const [at, until] = ["at", "until"].map((name) => fields.find((field) => field.name === name));
    const where = named("floor", "checkpoint", "pump", "tower", "place", "rect");
    const others = fields.filter((field) => !where.includes(field) && field !== at && field !== until);
    const time = (field: FaultField | undefined, placeholder: string) =>
      field === undefined
        ? nothing
        : timeField(fieldText(field.name), numberIn(fault, field.name), (value) => this.take(index, description, field.name, value ?? undefined), {
            placeholder,
          });
    return html`<div class="fields" role="group" aria-label=${faultText(fault.kind)}>
      ${timed
        ? html`<div class="two">
            ${time(at, typeof at?.default === "number" ? `${at.default} s` : texts.drawnShort)} ${time(until, texts.never)}
          </div>`
        : html`<p class="reason">${texts.fromStart}</p>`}
      ${description.needs_world ? html`<p class="reason">${texts.needsWorld}</p>` : nothing}
      ${this.place(fault, index, description, where)} ${others.map((field) => this.field(fault, index, description, field))}
      <button type="button" @click=${() => (openedFault.value = null)}>${texts.done}</button>
    </div>`;
  }

  /** Render the fields of the place, and a button for a click in the site. */
  private place(fault: FaultDraft, index: number, description: FaultDescription, where: readonly FaultField[]) {
    const form = placeForm(description);
    const isPlacing = placingFault.value?.list === this.list && placingFault.value.index === index;
    const point = where.find((field) => field.name === "place" || field.name === "rect");
    return html`${where.filter((field) => field !== point).map((field) => this.field(fault, index, description, field))}
    ${point === undefined ? nothing : this.coordinates(fault, index, description, point)}
    ${form === null
      ? nothing
      : html`<div class="buttons">
          <button
            type="button"
            id="place"
            aria-pressed=${isPlacing}
            @click=${() => (isPlacing ? stopPlacing() : beginPlacing(this.list, index))}
          >
            ${icon("arrow", 14)} ${t().faults.inSite}
          </button>
        </div>`}
    ${isPlacing && form !== null ? html`<p class="reason" role="status">${t().faults.hints[form]}</p>` : nothing}
    ${this.problems(fault).map((text) => html`<p class="wrong" role="alert">${text}</p>`)}`;
  }

  /** Render the choice of a place: drawn, at a checkpoint, or at coordinates with their fields. */
  private coordinates(fault: FaultDraft, index: number, description: FaultDescription, field: FaultField) {
    const texts = t().faults;
    const site = world.value;
    if (site === null) return nothing;
    const at = checkpointOf(fault, description, site);
    const there = placeForm(description) === "point" ? texts.atCheckpoint : texts.before;
    const none = fault.kind === "connection_loss" ? texts.whole : texts.drawn;
    const choose = (value: string) => {
      if (value === "") replaceFault(this.list, index, withField(fault, field.name, undefined));
      else if (value !== "own") replaceFault(this.list, index, atCheckpoint(fault, description, Number(value), site));
      else if (!hasPlace(fault)) {
        const first = site.checkpoints[0]?.id;
        if (first !== undefined) replaceFault(this.list, index, atCheckpoint(fault, description, first, site));
      }
      return null;
    };
    const all = [
      { value: "", label: none },
      { value: "own", label: texts.coordinates },
      ...site.checkpoints.map(({ id }) => ({ value: String(id), label: there(checkpointText(id)) })),
    ];
    const value = !hasPlace(fault) ? "" : at === null ? "own" : String(at);
    return html`${selectField(fieldText(field.name), value, all, choose)}
    ${hasPlace(fault) ? html`<div class="two">${this.vector(fault, index, description, field)}</div>` : nothing}`;
  }

  private field(fault: FaultDraft, index: number, description: FaultDescription, field: FaultField) {
    const { name, unit = null, numbers, choices = null } = field;
    const label = fieldText(name);
    const take = (value: FaultValue | undefined) => this.take(index, description, name, value);
    if (choices !== null) {
      const none = name === "floor" && fault.kind === "connection_loss" ? t().faults.everyFloor : t().faults.drawn;
      const all = [{ value: "", label: none }, ...choices.map((one) => ({ value: String(one), label: choiceText(name, one) }))];
      return selectField(label, String(fault[name] ?? ""), all, (value) => take(choices.find((one) => String(one) === value)));
    }
    if (numbers.length > 1)
      return html`<fieldset>
        <legend>${label}</legend>
        <div class="two">${this.vector(fault, index, description, field)}</div>
      </fieldset>`;
    const given = numberIn(fault, name);
    const placeholder = typeof field.default === "number" ? String(toShown(field.default, unit)) : t().faults.drawnShort;
    return numberField(
      label,
      given === null ? null : toShown(given, unit),
      (value) => take(value === null ? undefined : fromShown(value, unit)),
      { note: shownUnit(unit, fault, name), placeholder },
    );
  }

  /** Render a field for each number of a vector. */
  private vector(fault: FaultDraft, index: number, description: FaultDescription, field: FaultField) {
    const given = fault[field.name] ?? (Array.isArray(field.default) ? (field.default as readonly number[]) : undefined);
    const numbers = field.numbers.map((_, k) => (Array.isArray(given) ? (given as readonly number[])[k] : undefined) ?? 0);
    const isLeftOut = given === undefined;
    return field.numbers.map((_, k) =>
      numberField(
        t().faults.axes[field.name]?.[k] ?? String(k + 1),
        isLeftOut ? null : numbers[k],
        (value) =>
          value === null
            ? t().faults.enter
            : this.take(index, description, field.name, numbers.map((one, at) => (at === k ? value : one))),
        { note: field.unit ?? "", placeholder: isLeftOut ? t().faults.drawnShort : "" },
      ),
    );
  }

  /** Give a field another value. Returns what is wrong with it; null: it was taken. */
  private take(index: number, description: FaultDescription, name: string, value: FaultValue | undefined): string | null {
    const fault = faultsOf(this.list)[index];
    const site = world.value;
    if (fault === undefined || site === null) return null;
    const changed = withField(fault, name, value);
    const problem = faultProblems(changed, description, site).get(name);
    if (problem !== undefined && value !== undefined) return problemText(problem);
    replaceFault(this.list, index, changed);
    return null;
  }

  private add(event: Event): void {
    const field = event.target as HTMLSelectElement;
    const kind = field.value;
    field.value = "";
    if (kind !== "") addFault(this.list, kind);
  }
}

function numberIn(fault: FaultDraft, name: string): number | null {
  const value = fault[name];
  return typeof value === "number" ? value : null;
}
