/** Combine the texts of an area in both languages; they must have the same keys. */
export function both<Area>(en: Area, de: NoInfer<Area>): { readonly en: Area; readonly de: Area } {
  return { en, de };
}
