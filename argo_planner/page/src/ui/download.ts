/** Files that the page makes. */

/** Let the browser store a text as a file. */
export function downloadText(name: string, text: string, media: string): void {
  const address = URL.createObjectURL(new Blob([text], { type: `${media};charset=utf-8` }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  URL.revokeObjectURL(address);
}
