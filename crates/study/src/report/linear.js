// Pictures in linear radiance, as linear.rs packs them.

/// The value of each half float.
function halves() {
  return Float32Array.from({ length: 65536 }, (_, code) => {
    const [sign, exponent, fraction] = [code & 0x8000 ? -1 : 1, (code >> 10) & 31, code & 1023];
    if (exponent === 31) return fraction ? NaN : sign * Infinity;
    return sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -14 * fraction / 1024);
  });
}

function bytesOf(text) { return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)); }

/// The half floats of a picture, a list for each of red, green and blue; linear.rs says how they are packed.
async function unpacked({ width, height, delta, data: text }) {
  const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  const planes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = width * height;
  const codes = [0, 2 * count, 4 * count].map((high) => {
    const channel = new Uint16Array(count);
    for (let row = 0, index = 0; row < height; row++) {
      for (let column = 0, code = 0; column < width; column++, index++) {
        code = ((delta ? code : 0) + (planes[high + index] << 8 | planes[high + count + index])) & 0xffff;
        channel[index] = code;
      }
    }
    return channel;
  });
  return { width, height, codes };
}
