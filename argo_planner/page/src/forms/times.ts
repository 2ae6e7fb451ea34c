/** Times as people write them. */

/** Parse a time such as `90`, `90 s`, `1:30`, `1:30 min`, `1:05:00`, `10 min`, `1.5 h`, `2 h 30 min` or `20'`
 * into seconds; null: the text is no time. */
export function readTime(text: string): number | null {
  const said = text.trim().toLowerCase().replaceAll(",", ".");
  const clock = /^(?:(\d+):)?(\d{1,3}):(\d{1,2}(?:\.\d+)?)(?:\s*(?:h|min|s))?$/.exec(said);
  if (clock)
    return 3600 * Number(clock[1] ?? 0) + 60 * Number(clock[2]) + Number(clock[3]);
  const part =
    /(\d+(?:\.\d+)?)\s*(hours?|h|stunden?|std|minutes?|minuten?|min|m|['′’]|seconds?|sekunden?|sec|s|["″])?(?=\s|$|\d)/y;
  let total = 0;
  let at = 0;
  while (at < said.length) {
    part.lastIndex = at;
    const found = part.exec(said);
    if (!found) return null;
    total += Number(found[1]) * secondsOf(found[2] ?? "s");
    at = part.lastIndex;
    while (said[at] === " ") at++;
  }
  return said === "" ? null : total;
}

/** Format a time (s) so that `readTime` can parse it: `1 h 5 min`, `90 s`. */
export function writeTime(seconds: number): string {
  if (seconds < 120 && seconds % 60 !== 0) return `${round(seconds)} s`;
  const hours = Math.floor(seconds / 3600);
  const minutes = Math.floor((seconds % 3600) / 60);
  const rest = round(seconds % 60);
  const parts = [];
  if (hours > 0) parts.push(`${hours} h`);
  if (minutes > 0) parts.push(`${minutes} min`);
  if (rest > 0 || parts.length === 0) parts.push(`${rest} s`);
  return parts.join(" ");
}

function secondsOf(unit: string): number {
  if (unit.startsWith("h") || unit.startsWith("st")) return 3600;
  return unit.startsWith("m") || "'′’".includes(unit) ? 60 : 1;
}

function round(value: number): number {
  return Math.round(1000 * value) / 1000;
}
