/** The choice of how the camera follows the robot. */

import { following } from "../state/view";
import { t } from "../texts";
import { valueOf } from "../ui/controls";

/** Return the choices with their names, each behind a prefix. */
export function followChoices(word = ""): (readonly [typeof following.value, string])[] {
  const { followOff, followBehind, followAbove } = t().scene;
  return [
    ["off", word + followOff],
    ["behind", word + followBehind],
    ["above", word + followAbove],
  ];
}

export function chooseFollowing(event: Event): void {
  following.value = valueOf(event) as typeof following.value;
}
