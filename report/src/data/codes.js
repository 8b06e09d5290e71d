// SPDX-License-Identifier: GPL-3.0-or-later
// Arrays out of the page's text: the way back of app/report/codes.c.

export const LEVELS = 65534; // codes 0 … 65534 go from low to high
export const NO_CODE = 65535; // not finite

async function inflate(text) {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// `source` is the document that holds the arrays: this page, or a newer one that was fetched.
function textOf(source, id) {
  const element = source.getElementById(id);
  if (!element) throw new Error(`the page lacks its array ${id}`);
  return element.textContent;
}

// Codes (rows, rowSize): differences to the row before, in the first row to the code `stride` before.
export async function readCodes(source, id, rowSize, stride) {
  const bytes = await inflate(textOf(source, id));
  const count = bytes.length / 2;
  const codes = new Uint16Array(count);
  for (let i = 0; i < count; i++) {
    const folded = bytes[i] | (bytes[count + i] << 8);
    const back = i < rowSize ? stride : rowSize;
    codes[i] = (i < back ? 0 : codes[i - back]) + ((folded >> 1) ^ -(folded & 1));
  }
  return codes;
}

// Whole numbers: differences to the number `stride` before.
export async function readIntegers(source, id, stride) {
  const bytes = await inflate(textOf(source, id));
  const count = bytes.length / 4;
  const numbers = new Int32Array(count);
  for (let i = 0; i < count; i++) {
    let folded = 0;
    for (let plane = 0; plane < 4; plane++) folded |= bytes[plane * count + i] << (8 * plane);
    numbers[i] = (i < stride ? 0 : numbers[i - stride]) + ((folded >>> 1) ^ -(folded & 1));
  }
  return numbers;
}

export function decode(low, high, code) {
  return code === NO_CODE ? NaN : low + (code / LEVELS) * (high - low);
}
