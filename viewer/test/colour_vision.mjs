/**
 * How far colours lie apart for people: simulation after Machado, Oliveira and Fernandes 2009 at full severity, difference
 * in OKLab (Ottosson 2020). Lightness counts for three quarters: shading plays with it.
 */
export const VISIONS = {
  full: [1, 0, 0, 0, 1, 0, 0, 0, 1],
  protanopia: [0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998],
  deuteranopia: [0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.01182, 0.04294, 0.968881],
  tritanopia: [1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.3039],
};

const times = (matrix, [x, y, z]) => [0, 3, 6].map((row) => matrix[row] * x + matrix[row + 1] * y + matrix[row + 2] * z);

function linear(hex) {
  const channels = hex.match(/[0-9a-f]{2}/gi).map((digits) => parseInt(digits, 16) / 255);
  return channels.map((channel) => (channel > 0.04045 ? Math.pow((channel + 0.055) / 1.055, 2.4) : channel / 12.92));
}

function oklab(rgb) {
  const cone = times([0.4122214708, 0.5363325363, 0.0514459929, 0.2119034982, 0.6806995451, 0.1073969566,
    0.0883024619, 0.2817188376, 0.6299787005], rgb).map(Math.cbrt);
  return times([0.2104542553, 0.793617785, -0.0040720468, 1.9779984951, -2.428592205, 0.4505937099,
    0.0259040371, 0.7827717662, -0.808675766], cone);
}

export function colourDifference(a, b, vision) {
  const seen = [a, b].map((hex) => oklab(times(VISIONS[vision], linear(hex)).map((channel) => Math.min(1, Math.max(0, channel)))));
  return Math.hypot(0.75 * (seen[0][0] - seen[1][0]), seen[0][1] - seen[1][1], seen[0][2] - seen[1][2]);
}

export function luminanceOf(hex) {
  const [red, green, blue] = linear(hex);
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}
