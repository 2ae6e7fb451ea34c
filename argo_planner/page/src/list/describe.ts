/** What a task or a group is, in a few words, until the service has said it in sentences. */

import type { Group, Task, World } from "../api/types";
import { t } from "../texts";

/** What a task does. */
export function describeTask(task: Task, world: World | null): string {
  const texts = t().list;
  if (task.action === "MEASURE") {
    const checkpoint = world?.checkpoints.find((one) => String(one.id) === task.object_id);
    const name = checkpoint ? `#${checkpoint.id} ${checkpoint.name}` : `#${task.object_id ?? "?"}`;
    return texts.measures(name, checkpoint ? checkpoint.floor : null);
  }
  if (task.action === "WAIT") {
    const wait = task.wait;
    if (typeof wait?.duration === "number") return texts.waits(t().words.seconds(wait.duration));
    return wait?.event ? texts.waitsFor(t().words.event[wait.event]) : texts.waitsUntil;
  }
  if (!task.pose) return t().words.action[task.action];
  const floor = floorAt(task.pose.z, world);
  const at = `${task.pose.x.toFixed(1)}, ${task.pose.y.toFixed(1)}`;
  return task.action === "START" ? texts.startsAt(at, floor) : texts.drivesTo(at, floor);
}

/** How often a group is done. */
export function describeGroup(group: Group): string {
  const texts = t().list;
  const parts: string[] = [];
  if (group.max_repeat_count > 0) parts.push(texts.times(group.max_repeat_count));
  if (group.max_repeat_duration > 0) parts.push(texts.during(t().words.seconds(group.max_repeat_duration)));
  if (group.every > 0) parts.push(texts.every(t().words.seconds(group.every)));
  if (group.until.length > 0) parts.push(texts.until);
  return parts.length > 0 ? parts.join(", ") : texts.endless;
}

/** Number of the floor at a height (m). */
export function floorAt(z: number, world: World | null): number | null {
  let found: number | null = null;
  for (const floor of world?.floors ?? []) if (floor.z <= z + 0.5) found = floor.number;
  return found;
}
