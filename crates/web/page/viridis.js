// The colours of maps.

/** Viridis, whose lightness rises evenly: it reads without colours, too. */
const VIRIDIS = ['440154', '482878', '3e4989', '31688e', '26828e', '1f9e89', '35b779', '6ece58', 'b5de2b', 'fde725'];

/** @param {number} share @returns {[number, number, number]} */
function viridis(share) {
  const place = Math.min(1, Math.max(0, share)) * (VIRIDIS.length - 1);
  const n = Math.min(VIRIDIS.length - 2, Math.floor(place));
  const parts = (/** @type {string} */ hex) => [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16));
  const [low, high] = [parts(VIRIDIS[n]), parts(VIRIDIS[n + 1])];
  const mix = low.map((one, k) => Math.round(one + (high[k] - one) * (place - n)));
  return [mix[0], mix[1], mix[2]];
}
