/** Formats of numbers. The browser takes long to make one, and a list has hundreds of numbers. */

const formats = new Map<string, Intl.NumberFormat>();

/** Return the format of numbers in a language, with at least `least` and at most `most` decimals. */
export function numberFormat(language: string, least: number, most: number): Intl.NumberFormat {
  const key = `${language} ${least} ${most}`;
  let format = formats.get(key);
  if (format === undefined) {
    format = new Intl.NumberFormat(language, { minimumFractionDigits: least, maximumFractionDigits: most });
    formats.set(key, format);
  }
  return format;
}
