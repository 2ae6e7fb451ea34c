/** Both languages of an area, the second of the same shape as the first. */
export function both<Area>(en: Area, de: NoInfer<Area>): { readonly en: Area; readonly de: Area } {
  return { en, de };
}
