/** Faults in words: their fields, problems and summaries. */

import type { FaultField } from "../api/types";
import { checkpointOf, hasPlace, placeForm, type FaultDraft, type FaultProblem, type FaultValue } from "../model/faults";
import { faultDescriptions } from "../state/faults";
import { checkpointsById, world } from "../state/world";
import { t } from "../texts";
import { figure, seconds, unitText } from "../ui/figures";

/** unit of a share of a whole, which is shown as a percentage */
const SHARE = "1";

export function fieldText(name: string): string {
  return t().faults.fields[name] ?? name;
}

/** Return the unit beside a field. That of a shown value is its checkpoint's. */
export function shownUnit(unit: string | null, fault: FaultDraft, name: string): string {
  if (name === "value") return unitText(checkpointsById.value.get(String(fault["checkpoint"]))?.unit ?? "");
  return unit === SHARE ? "%" : unitText(unit ?? "");
}

/** Return a number as it is shown: a share in percent. */
export function toShown(value: number, unit: string | null): number {
  return unit === SHARE ? Number((100 * value).toPrecision(10)) : value;
}

/** Return the number for a shown one. */
export function fromShown(value: number, unit: string | null): number {
  return unit === SHARE ? Number((value / 100).toPrecision(10)) : value;
}

/** Return the label of a value that is chosen, such as a floor or a defect. */
export function choiceText(name: string, value: string | number): string {
  if (name === "floor") return t().faults.floor(Number(value));
  if (name === "checkpoint") return checkpointText(Number(value));
  return t().faults.choices[value] ?? String(value);
}

export function checkpointText(id: number): string {
  const name = checkpointsById.value.get(String(id))?.name;
  return name === undefined ? `#${id}` : `#${id} ${name}`;
}

/** Return what is wrong with a field. */
export function problemText(problem: FaultProblem): string {
  const texts = t().faults.problems;
  switch (problem.kind) {
    case "limits": {
      const { unit, limits } = problem;
      const show = (value: number | null | undefined) =>
        typeof value === "number" ? `${figure(toShown(value, unit), 3)} ${unit === SHARE ? "%" : unitText(unit ?? "")}`.trim() : null;
      const [least, above, most, below] = [limits.least, limits.above, limits.most, limits.below].map(show);
      if (above) return most ? texts.aboveTo(above, most) : texts.above(above);
      if (below) return least ? texts.toBelow(least, below) : texts.below(below);
      return least && most ? texts.between(least, most) : least ? texts.least(least) : texts.most(most ?? "");
    }
    case "ends early":
      return texts.endsEarly;
    case "no floor":
      return texts.noFloor;
    case "no deck":
      return texts.noDeck(problem.floor);
    case "off site":
      return texts.offSite;
    case "wrong corners":
      return texts.corners;
    case "off scale":
    case "normal": {
      const [low, high] = [figure(problem.low), `${figure(problem.high)} ${unitText(problem.unit)}`];
      return problem.kind === "normal" ? texts.normal(low, high) : texts.offScale(low, high);
    }
  }
}

/** Return the given fields of a fault in one line. */
export function faultSummary(fault: FaultDraft): string {
  const description = faultDescriptions.value.get(fault.kind);
  if (description === undefined) return "";
  const parts = description.fields.flatMap((field) => {
    const value = fault[field.name];
    if (value === undefined) return [];
    if (field.name === "checkpoint") return [checkpointText(Number(value))];
    if (field.name === "place" || field.name === "rect") return [placeText(fault)];
    if (field.name === "floor") return [t().faults.floor(Number(value))];
    return [`${fieldText(field.name)}: ${valueText(fault, field, value)}`];
  });
  return parts.length === 0 ? t().faults.drawn : parts.join(" · ");
}

function placeText(fault: FaultDraft): string {
  const description = faultDescriptions.value.get(fault.kind);
  const site = world.value;
  const at = description && site && hasPlace(fault) ? checkpointOf(fault, description, site) : null;
  if (description !== undefined && at !== null) {
    const texts = t().faults;
    return (placeForm(description) === "point" ? texts.atCheckpoint : texts.before)(checkpointText(at));
  }
  const numbers = (fault["place"] ?? fault["rect"] ?? []) as readonly number[];
  const show = (part: readonly number[]) => `(${part.map((one) => figure(one)).join("; ")})`;
  return fault["rect"] === undefined ? `${show(numbers)} m` : `${show(numbers.slice(0, 2))} – ${show(numbers.slice(2))} m`;
}

function valueText(fault: FaultDraft, { name, unit = null }: FaultField, value: FaultValue): string {
  if (name === "at" || name === "until") return seconds(Number(value));
  if (typeof value === "string") return choiceText(name, value);
  const all = typeof value === "number" ? [value] : value;
  const shown = all.map((one) => figure(toShown(one, unit), 3)).join(name === "size" ? " × " : "; ");
  return `${shown} ${shownUnit(unit, fault, name)}`.trim();
}
