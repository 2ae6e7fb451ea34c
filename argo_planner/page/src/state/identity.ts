/** Identities of the tasks, groups and reactions of the open mission. They stay when names change, so that fields,
 * rows and the selection remain those of the same thing. */

import { signal } from "@preact/signals-core";

/** New keys of what the last change renamed, by the old keys. */
export const renames = signal<ReadonlyMap<string, string>>(new Map());

const identities = new Map<string, string>();
let count = 0;

/** Return the identity of the thing with a key. */
export function identityOf(key: string): string {
  let identity = identities.get(key);
  if (identity === undefined) identities.set(key, (identity = `thing-${++count}`));
  return identity;
}

/** Let renamed things keep their identities, and things that no longer exist lose theirs. */
export function followRenames(renamed: ReadonlyMap<string, string>, exists: (key: string) => boolean): void {
  const moved = [...renamed].map(([old, key]) => [key, identityOf(old)] as const);
  for (const key of [...identities.keys()]) if (renamed.has(key) || !exists(key)) identities.delete(key);
  for (const [key, identity] of moved) identities.set(key, identity);
  if (renamed.size > 0) renames.value = renamed;
}

/** Return keys with the new ones of renamed things. */
export function renamedKeys(keys: Iterable<string>, renamed: ReadonlyMap<string, string>): string[] {
  return [...keys].map((key) => renamed.get(key) ?? key);
}
