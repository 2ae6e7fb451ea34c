/** How the camera may follow the robot, to be chosen from. */

import { following } from "../state/view";
import { t } from "../texts";
import { valueOf } from "../ui/controls";

/** The ways with their names, which are put behind a word. */
export function waysToFollow(word = ""): (readonly [typeof following.value, string])[] {
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
