/**
 * Which colour each vertex has. Colours are '#rrggbb' where the page uses them, too, and linear RGB for the renderer.
 *
 * plain        one colour for all
 * bodies       one for each body
 * depth        from light at the top of the surface to dark at its bottom
 * reliability  the plain one where samples were measured, pale where they were filled in
 * agreement    the plain one where traces agree along the reflectors, pale where layers are likely to be mis-tied
 */
export const COLOURINGS = Object.freeze(['plain', 'bodies', 'depth', 'reliability', 'agreement']);

/** Reliability of what was measured; everything below was filled in, wholly or in part. */
const MEASURED = 255;

/** Agreement of traces that are alike along the layers. */
const WHOLLY = 255;

/** How strongly the most reliable filling shows: a good guess is a guess, too, and is to be seen. */
const LEAST_FILLED = 0.6;

/** How strongly a reliability shows as filled in, 0 = measured ... 1 = nothing is known. */
export function filledShare(reliability) {
  if (reliability === MEASURED) return 0;
  return LEAST_FILLED + (1 - LEAST_FILLED) * (1 - reliability / (MEASURED - 1));
}

/** How strongly a low agreement shows, 0 = traces agree wholly ... 1 = not at all. */
export function doubtfulShare(agreement) {
  return 1 - agreement / WHOLLY;
}

/** The colourings that shade from the plain colour to the pale one, by the share that a vertex' value makes. */
const SHADINGS = Object.freeze({ reliability: filledShare, agreement: doubtfulShare });

/**
 * The largest bodies' colours. Chosen so that any two stay apart (OKLab, lightness counted for less because shading
 * plays with it) for full colour vision, protanopia, deuteranopia and tritanopia, and from the sky of both themes.
 */
const PALETTE = Object.freeze(['#cf8a35', '#377ee3', '#9cc57a', '#9260b0', '#3abdee', '#924f1b', '#4d7b7c', '#ee6aa6']);

/** The colours of the depth from top to bottom: lightness falls all the way, so that it can be read without telling hues apart. */
export const RAMP = Object.freeze(['#f7d35c', '#ee9a45', '#d9605a', '#a8417f', '#6d3c93', '#46479b']);

/** Each further round through the palette is mixed with white or black, so that neighbours in the list still differ. */
const ROUNDS = Object.freeze([
  { towards: 0, share: 0 },
  { towards: 1, share: 0.3 },
  { towards: 0, share: 0.28 },
]);

/** The palette in all its rounds, for the page and for the renderer. */
const COLOURS = Object.freeze(ROUNDS.flatMap(({ towards, share }) =>
  PALETTE.map((colour) => hexOf(channelsOf(colour).map((channel) => channel + share * (towards - channel)))),
));
const LINEAR_COLOURS = Object.freeze(COLOURS.map(linearOf));

/** The colours of the depth as the renderer has them, finely stepped. */
const SHADES = 256;
const DEPTHS = Object.freeze(Array.from({ length: SHADES }, (_, shade) => {
  const place = (shade / (SHADES - 1)) * (RAMP.length - 1);
  const before = Math.min(RAMP.length - 2, Math.floor(place));
  const [from, to] = [channelsOf(RAMP[before]), channelsOf(RAMP[before + 1])];
  return linearOf(hexOf(from.map((channel, at) => channel + (place - before) * (to[at] - channel))));
}));

/** A body's colour, the same for the same number always. */
export function bodyColour(body) {
  return COLOURS[body % COLOURS.length];
}

/** The colour of a body in a colouring. */
export function swatchColour(colouring, body, plain) {
  return colouring === 'bodies' ? bodyColour(body) : plain;
}

/** The colourings that these parts have the attributes for. */
export function colouringsOf(parts) {
  const attributes = { plain: 'positions', bodies: 'body', depth: 'positions', reliability: 'reliability', agreement: 'agreement' };
  return COLOURINGS.filter((name) => name === 'plain' || parts.some((part) => part[attributes[name]]));
}

/** The colouring to use when this one is wanted. */
export function colouringFor(wanted, available) {
  return available.includes(wanted) ? wanted : 'plain';
}

/**
 * Linear RGB of each vertex, (n, 3) float32; null in the plain colouring, where the material's own colour is enough.
 *
 * part        {positions, body: (n) uint32 | null, reliability, agreement: (n) uint8 | null}; without reliability all
 *             was measured, without agreement samples are joined along the axes
 * plain, pale '#rrggbb' of what is to be trusted and of what is not
 * top, bottom heights on the display that have the first and the last colour of the depth
 */
export function vertexColours(part, { colouring, plain, pale, top, bottom }) {
  if (colouring === 'plain') return null;
  const colours = new Float32Array(part.positions.length);
  const shares = paleShares(part, colouring);
  if (colouring === 'bodies' && part.body) paintBodies(colours, part.body);
  else if (colouring === 'depth') paintDepths(colours, part.positions, top, bottom);
  else if (shares) paintShaded(colours, part[colouring], shares, linearOf(plain), linearOf(pale));
  else paintAll(colours, linearOf(plain));
  return colours;
}

/** How strongly each vertex shows as pale, 0 ... 255; null where there is nothing to tell. */
export function palenessOf(part, colouring) {
  const shares = paleShares(part, colouring)?.map((share) => Math.round(255 * share));
  return shares ? part[colouring].map((value) => shares[value]) : null;
}

/** For each value of the shading's attribute its share; null where the colouring is no shading or the part has no such attribute. */
function paleShares(part, colouring) {
  const share = SHADINGS[colouring];
  return share && part[colouring] ? Array.from({ length: 256 }, (_, value) => share(value)) : null;
}

function paintBodies(colours, body) {
  for (let vertex = 0, at = 0; vertex < body.length; ++vertex, at += 3) {
    const [red, green, blue] = LINEAR_COLOURS[body[vertex] % LINEAR_COLOURS.length];
    colours[at] = red;
    colours[at + 1] = green;
    colours[at + 2] = blue;
  }
}

function paintDepths(colours, positions, top, bottom) {
  const scale = top > bottom ? (SHADES - 1) / (top - bottom) : 0;
  for (let at = 0; at < positions.length; at += 3) {
    const shade = Math.round((top - positions[at + 1]) * scale);
    const [red, green, blue] = DEPTHS[Math.min(SHADES - 1, Math.max(0, shade))];
    colours[at] = red;
    colours[at + 1] = green;
    colours[at + 2] = blue;
  }
}

function paintShaded(colours, values, shares, plain, pale) {
  const shades = shares.map((share) => plain.map((channel, at) => channel + share * (pale[at] - channel)));
  for (let vertex = 0, at = 0; vertex < values.length; ++vertex, at += 3) {
    const [red, green, blue] = shades[values[vertex]];
    colours[at] = red;
    colours[at + 1] = green;
    colours[at + 2] = blue;
  }
}

function paintAll(colours, colour) {
  for (let at = 0; at < colours.length; at += 3) colours.set(colour, at);
}

/** '#rrggbb' to the three numbers in [0, 1] that light adds up in. */
export function linearOf(hex) {
  return channelsOf(hex).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
}

function channelsOf(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

function hexOf(channels) {
  return `#${channels.map((channel) => Math.round(255 * channel).toString(16).padStart(2, '0')).join('')}`;
}
