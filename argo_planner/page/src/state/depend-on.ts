/** Make an effect or a computed value depend on signals whose values it does not use. */
export function dependOn(...signals: readonly { readonly value: unknown }[]): readonly unknown[] {
  return signals.map((one) => one.value);
}
