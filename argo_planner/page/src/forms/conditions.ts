/** Forms of conditions on readings: of transitions, rounds and waits. */

import type { Condition } from "../api/types";
import { mayPlan } from "../state/session";
import { checkpointsById } from "../state/world";
import { t } from "../texts";
import { html } from "../ui/element";
import { bound, unitText } from "../ui/figures";
import { icon } from "../ui/icons";
import type { Commit } from "./field";
import { checkField, checkpointOptions, numberField, optionsOf, selectField, timeField } from "./parts";

type Conditions = readonly Condition[];
/** Changes the conditions. It gets their state when the edit is made, not when the form was drawn. */
type Save = (change: (was: Conditions) => Conditions) => ReturnType<Commit>;

/** Create the default condition: the reading is above its normal range. */
export function aboveNormalCondition(object_id: string): Condition {
  const param1 = checkpointsById.value.get(object_id)?.nominal.high ?? 0;
  return { type: "MEASURED_VALUE_GREATER", id: "", object_id, param1, inclusive: false };
}

/** Render conditions with their fields, and a button that adds one. */
export function conditionList(conditions: Conditions, save: Save, label: string) {
  const texts = t().forms;
  const add = () =>
    save((was) => [...was, aboveNormalCondition(was[0]?.object_id ?? checkpointOptions()[0]?.value ?? "1")]);
  return html`<div class="conditions">
    ${conditions.map((condition, index) =>
      conditionForm(condition, index, save),
    )}
    <button class="bare" ?disabled=${!mayPlan()} @click=${add}>
      ${icon("add", 16)} ${conditions.length === 0 ? label : texts.andCondition}
    </button>
  </div>`;
}

function conditionForm(
  condition: Condition,
  index: number,
  save: Save,
) {
  const texts = t().forms;
  const set = (change: Partial<Condition>) =>
    save((was) => was.map((one, at) => (at === index ? { ...one, ...change } : one)));
  const checkpoint = checkpointsById.value.get(condition.object_id);
  const unit = unitText(checkpoint?.unit ?? "");
  const compares = condition.type.startsWith("MEASURED");
  const within = condition.type === "MEASURED_VALUE_WITHIN";
  return html`<fieldset>
    <legend>${index === 0 ? texts.ifCondition : texts.andIf}</legend>
    ${selectField(texts.valueOf, condition.object_id, checkpointOptions(), (object_id) =>
      set({ object_id }),
    )}
    ${selectField(texts.is, condition.type, optionsOf(texts.comparisons), (type) =>
      set(changedType(condition, type as Condition["type"], checkpoint?.nominal)),
    )}
    ${compares
      ? html`<div class=${within ? "two" : ""}>
            ${numberField(
              within ? texts.from : texts.bound,
              condition.param1,
              (param1) => set({ param1 }),
              { note: unit },
            )}
            ${within
              ? numberField(texts.to, condition.param2, (param2) => set({ param2 }), { note: unit })
              : null}
          </div>
          ${checkField(texts.inclusive, condition.inclusive, (inclusive) => set({ inclusive }))}`
      : null}
    ${checkpoint
      ? html`<p class="dim">
          ${texts.nominal(bound(checkpoint.nominal.low), bound(checkpoint.nominal.high), unit)}
        </p>`
      : null}
    ${compares || condition.type === "READING_STALE"
      ? timeField(texts.maxAge, condition.max_age, (max_age) => set({ max_age }))
      : null}
    <button
      class="bare danger"
      ?disabled=${!mayPlan()}
      @click=${() => save((was) => was.filter((_, at) => at !== index))}
    >
      ${icon("bin", 16)} ${texts.removeCondition}
    </button>
  </fieldset>`;
}

/** Return the fields that change with the type of a condition: bounds are added or removed. */
function changedType(
  condition: Condition,
  type: Condition["type"],
  nominal: { readonly low: number; readonly high: number } | undefined,
): Partial<Condition> {
  const low = condition.param1 ?? nominal?.low ?? 0;
  if (type === "MEASURED_VALUE_WITHIN")
    return { type, param1: nominal?.low ?? low, param2: nominal?.high ?? low + 1 };
  if (type.startsWith("MEASURED")) return { type, param1: low, param2: null };
  const max_age = type === "READING_STALE" ? (condition.max_age ?? 600) : null;
  return { type, param1: null, param2: null, inclusive: false, max_age };
}
