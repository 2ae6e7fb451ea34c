/** Has whatever is drawn or computed follow signals whose values it does not need. */
export function heed(...signals: readonly { readonly value: unknown }[]): readonly unknown[] {
  return signals.map((one) => one.value);
}
