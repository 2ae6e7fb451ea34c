/** Checkpoints in fields with suggestions: `#4 valve R25`. */

import type { WorldCheckpoint } from "../api/types";

export function checkpointSuggestion(checkpoint: WorldCheckpoint): string {
  return `#${checkpoint.id} ${checkpoint.name}`;
}

/** Return the checkpoint that the text names by suggestion, number or name; null: none, or several. */
export function parseCheckpoint(
  typed: string,
  checkpoints: readonly WorldCheckpoint[],
): WorldCheckpoint | null {
  const meant = typed.trim().toLowerCase();
  if (meant === "") return null;
  const number = /^#?\s*(\d+)(\s|$)/.exec(meant)?.[1];
  if (number !== undefined) return checkpoints.find((one) => one.id === Number(number)) ?? null;
  const named = checkpoints.filter((one) => one.name.toLowerCase() === meant);
  const found = named.length > 0 ? named : checkpoints.filter((one) => one.name.toLowerCase().includes(meant));
  return found.length === 1 ? (found[0] ?? null) : null;
}
