/** The fields of a hold or a wait for a charged battery. */

import type { Reaction, WaitRule } from "../api/types";
import { t } from "../texts";
import { html } from "../ui/element";
import { numberField, timeField } from "./parts";

type Charge = Pick<Reaction & WaitRule, "charge_to" | "charge_for">;

/** The fields of something that waits for another event. */
export const NO_CHARGE: Charge = { charge_to: null, charge_for: null };

export function chargeFields(charge: Charge, save: (change: Partial<Charge>) => Promise<string | null>) {
  const texts = t().forms;
  return html`${numberField(
      texts.chargeTo,
      percent(charge.charge_to),
      (charge_to) => save({ charge_to: share(charge_to) }),
      { note: "%" },
    )}
    ${timeField(texts.chargeFor, charge.charge_for, (charge_for) => save({ charge_for }))}`;
}

/** Return a share of the battery's charge, 0 to 1, in percent. */
export function percent(share: number | null | undefined): number | null {
  return share === null || share === undefined ? null : Math.round(1000 * share) / 10;
}

/** Return a percentage as a share, 0 to 1. */
export function share(percentage: number | null): number | null {
  return percentage === null ? null : percentage / 100;
}
