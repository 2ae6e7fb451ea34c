/** Names of faults. */

import { t } from ".";

/** Return the name of a kind of fault; one of a package has no other name than its kind. */
export function faultText(kind: string): string {
  return (t().run.fault as Readonly<Record<string, string>>)[kind] ?? kind;
}
