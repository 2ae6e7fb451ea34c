/** Durations as people write them. */

/** Format a duration (s) so that it has one meaning: `1 h 5 min`, `90 s`. */
export function writeTime(seconds: number): string {
  if (seconds < 120 && seconds % 60 !== 0) return `${decimal(seconds)} s`;
  const hours = Math.floor(seconds / 3600);
  const minutes = Math.floor((seconds % 3600) / 60);
  const rest = Math.round(1000 * (seconds % 60)) / 1000;
  const parts = [];
  if (hours > 0) parts.push(`${hours} h`);
  if (minutes > 0) parts.push(`${minutes} min`);
  if (rest > 0 || parts.length === 0) parts.push(`${decimal(rest)} s`);
  return parts.join(" ");
}

/** Format a number with at most three decimals, but never exactly three: `1.125` could be 1125. */
function decimal(value: number): string {
  const text = String(Math.round(1000 * value) / 1000);
  return /\.\d{3}$/.test(text) ? `${text}0` : text;
}
