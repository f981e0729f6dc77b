// SPDX-License-Identifier: MIT
// Colour maps as small tables, scales from values to shares of a colour map, and pictures of both.

// Colours at even steps; those between are blended. All but the diverging one grow evenly
// lighter, so that they survive colour blindness and black-and-white print.
const kAnchors = {
  depth:  // viridis
    '440154 48186a 472d7b 424086 3b528b 33638d 2c728e 26818e 21908c ' +
    '1f9f88 28ae80 3ebc74 5dc963 82d34c abdc32 d5e21a fde725',
  heat:  // inferno
    '000004 0b0724 210c4a 3c0965 57106d 70196e 89226a a32b61 bb3755 ' +
    'd14644 e35932 f1711e f98d0a fcab0f f9ca32 f2e865 fcffa4',
  share:  // cividis
    '00224e 002e6a 1a386f 32436d 434e6c 52596d 61656f 6f7073 7c7b78 ' +
    '8b8778 9b9376 aba072 bbad6c ccba64 ddc958 efd748 fee838',
  diverging:  // blue, white, red
    '2166ac 4393c3 92c5de d1e5f0 ffffff fddbc7 f4a582 d6604d b2182b',
};

// One colour for each result; they differ for colour-blind readers too.
const kResultColours = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#d55e00', '#56b4e9', '#8c8c8c', '#f0e442'];

const tables = {};

function blendedTable(anchors) {
  const colours = anchors.split(' ').map((hex) => parseInt(hex, 16));
  const table = new Uint32Array(256);  // as the four bytes of a picture element
  for (let i = 0; i < 256; ++i) {
    const position = (i / 255) * (colours.length - 1);
    const low = Math.min(Math.floor(position), colours.length - 2);
    const blend = (shift) => {
      const a = (colours[low] >> shift) & 255;
      const b = (colours[low + 1] >> shift) & 255;
      return Math.round(a + (b - a) * (position - low));
    };
    table[i] = (255 << 24) | (blend(0) << 16) | (blend(8) << 8) | blend(16);
  }
  return table;
}

/** 256 colours of a map, each as the picture element 0xAABBGGRR. */
viewer.colourTable = function (name) {
  const known = Object.prototype.hasOwnProperty.call(kAnchors, name) ? name : 'heat';
  if (!tables[known]) tables[known] = blendedTable(kAnchors[known]);
  return tables[known];
};

viewer.resultColour = (index) => kResultColours[index % kResultColours.length];

/** The range that a colour map covers: a diverging one is centred on zero, shares are 0 to 1. */
viewer.colourRange = function (colours, range) {
  if (colours === 'share') return [0, 1];
  let [low, high] = viewer.isRange(range) ? range : [0, 1];
  if (colours === 'diverging') {
    const reach = Math.max(Math.abs(low), Math.abs(high)) || 1;
    return [-reach, reach];
  }
  return low < high ? [low, high] : [low - 0.5, low + 0.5];
};

// ---- Scales ----

const kDefaultDecades = 1e-4;  // of a logarithmic scale whose range names no smallest value

/** Round numbers between low and high, about `count` of them. */
viewer.roundTicks = function (low, high, count) {
  const span = high - low;
  if (!(span > 0) || !(count > 0)) return [low];
  const rough = span / count;
  const power = Math.pow(10, Math.floor(Math.log10(rough)));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((s) => s >= rough * 0.999);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-6); i * step <= high + step * 1e-6; ++i) ticks.push(i * step);
  return ticks;
};

function logTicks(low, high) {
  const first = Math.ceil(Math.log10(low) - 1e-6);
  const last = Math.floor(Math.log10(high) + 1e-6);
  const factors = last - first >= 2 ? [1] : [1, 2, 5];
  const ticks = [];
  for (let exponent = first - 1; exponent <= last; ++exponent) {
    for (const factor of factors) {
      const value = factor * Math.pow(10, exponent);
      if (value >= low * 0.999 && value <= high * 1.001) ticks.push(value);
    }
  }
  return ticks;
}

const clampUnit = (share) => Math.min(1, Math.max(0, share));

/** A scale of one of the kinds `linear`, `gamma` (square root) and `log`: values to 0..1. */
viewer.makeScale = function (kind, low, high) {
  if (!(high > low)) high = low + (Math.abs(low) || 1);
  if (kind === 'log') {
    if (!(low > 0)) low = high * kDefaultDecades;
    const span = Math.log(high / low);
    return {
      kind, low, high,
      toUnit: (value) => (value > 0 ? clampUnit(Math.log(value / low) / span) : 0),
      fromUnit: (share) => low * Math.exp(share * span),
      ticks: () => logTicks(low, high),
    };
  }
  const power = kind === 'gamma' ? 0.5 : 1;
  return {
    kind, low, high,
    toUnit: (value) => Math.pow(clampUnit((value - low) / (high - low)), power),
    fromUnit: (share) => low + (high - low) * Math.pow(share, 1 / power),
    ticks: (count) => viewer.roundTicks(low, high, count),
  };
};

/** The choice of how values become brightness, for select(). */
viewer.valueScales = [['linear', 'Linear'], ['gamma', 'Square root (gamma)'], ['log', 'Logarithmic']];

/** One picture element for each value; missing values are transparent. */
viewer.colourValues = function (values, scale, colours) {
  const table = viewer.colourTable(colours);
  const painted = new Uint32Array(values.length);
  for (let i = 0; i < values.length; ++i) {
    painted[i] = values[i] === values[i] ? table[Math.round(scale.toUnit(values[i]) * 255)] : 0;
  }
  return painted;
};

/** CSS text of a picture element. */
viewer.cssColour = function (element) {
  return `rgba(${element & 255},${(element >> 8) & 255},${(element >> 16) & 255},${(element >>> 24) / 255})`;
};

// ---- Pictures ----

/** A canvas of width x height elements; `colourAt(column, row)` counts from the top left. */
viewer.makeBitmap = function (width, height, colourAt) {
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  const context = canvas.getContext('2d');
  const image = context.createImageData(width, height);
  const elements = new Uint32Array(image.data.buffer);
  for (let row = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column) {
      elements[row * width + column] = colourAt(column, row);
    }
  }
  context.putImageData(image, 0, 0);
  return canvas;
};

/** A map as an eye at the wall sees it: x from right to left, y upwards. */
viewer.bitmapOfMap = function (loaded, scale, colours) {
  const [nx, ny] = loaded.map.size;
  const lookup = viewer.colourValues(loaded.quantity.values, scale, colours);
  const codes = loaded.quantity.codes;
  return viewer.makeBitmap(nx, ny, (column, row) => lookup[codes[(nx - 1 - column) * ny + (ny - 1 - row)]]);
};
