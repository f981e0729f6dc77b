// SPDX-License-Identifier: MIT
// Reads what the page holds: the metadata, and arrays that are unpacked when first needed.

const kTypes = { u8: Uint8Array, u16: Uint16Array, u32: Uint32Array };
const kVersion = 1;
const arrays = new Map();  // promises of unpacked bytes, by the array's number

/** Throws an error that tells the reader in words what is wrong, unless all is well. */
viewer.require = function (isWell, message) {
  if (!isWell) throw new Error(message);
};

viewer.readMetadata = function () {
  const holder = document.getElementById('nlos-data');
  viewer.require(holder, 'The page holds no data.');
  let metadata = null;
  try {
    metadata = JSON.parse(holder.textContent);
  } catch (error) {
    throw new Error('The page\u2019s description of its data is damaged: ' + error.message);
  }
  viewer.require(metadata && metadata.version === kVersion, 'The page\u2019s data are of an unknown version.');
  viewer.require(
    Array.isArray(metadata.results) && Array.isArray(metadata.animations),
    'The page\u2019s description of its data lacks its results or captures.',
  );
  return metadata;
};

function bytesOfBase64(text) {
  const characters = atob(text);
  const bytes = new Uint8Array(characters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = characters.charCodeAt(i);
  return bytes;
}

async function unpack(index) {
  const holder = document.getElementById('nlos-array-' + index);
  viewer.require(holder, `Array ${index} is missing from the page.`);
  try {
    const packed = new Blob([bytesOfBase64(holder.textContent)]);
    const stream = packed.stream().pipeThrough(new DecompressionStream('deflate'));
    return await new Response(stream).arrayBuffer();
  } catch (error) {
    throw new Error(`Array ${index} is damaged and cannot be unpacked.`);
  }
}

/** The numbers of one array, as a typed array of exactly `count` numbers. */
viewer.loadArray = async function (index, type, count) {
  const Type = kTypes[type];
  viewer.require(Type, `Array ${index} has numbers of an unknown type.`);
  if (!arrays.has(index)) arrays.set(index, unpack(index));
  const buffer = await arrays.get(index);
  const found = buffer.byteLength / Type.BYTES_PER_ELEMENT;
  viewer.require(found === count, `Array ${index} holds ${found} numbers instead of ${count}.`);
  return new Type(buffer);
};

function valuesOfCodes(description, levels) {
  const { coding, low, high } = description;
  const values = new Float64Array(levels);
  for (let code = 1; code < levels; ++code) {
    const fraction = (code - 1) / (levels - 2);
    values[code] = coding === 'log' ? high * Math.pow(low / high, 1 - fraction) : low + (high - low) * fraction;
  }
  values[0] = coding === 'log' ? 0 : NaN;
  if (coding === 'log' && !(low > 0 && high >= low)) values.fill(0);
  return values;
}

/**
 * Loads a quantity of `count` values: `codes` as stored, `values` by code, and `at(i)`, the value
 * of element i (NaN where it is missing).
 */
viewer.loadQuantity = async function (description, count) {
  viewer.require(description && typeof description === 'object', 'A quantity is not described.');
  const { type, coding } = description;
  viewer.require(type === 'u8' || type === 'u16', 'A quantity has numbers of an unknown type.');
  viewer.require(coding === 'linear' || coding === 'log', 'A quantity has an unknown coding.');
  viewer.require(
    Number.isFinite(description.low) && Number.isFinite(description.high),
    'A quantity has no range.',
  );
  const codes = await viewer.loadArray(description.array, type, count);
  const values = valuesOfCodes(description, type === 'u8' ? 256 : 65536);
  return { codes, values, low: description.low, high: description.high, at: (i) => values[codes[i]] };
};

/** Loads points as x, y, z, x, y, z ... in metres. */
viewer.loadPoints = async function (description) {
  viewer.require(
    description && viewer.isTriple(description.low) && viewer.isTriple(description.high),
    'Points have no range.',
  );
  const { low, high, count } = description;
  const codes = await viewer.loadArray(description.array, description.type, 3 * count);
  const positions = new Float32Array(codes.length);
  for (let i = 0; i < codes.length; ++i) {
    const axis = i % 3;
    positions[i] = low[axis] + ((high[axis] - low[axis]) * codes[i]) / 65535;
  }
  return positions;
};

/** The results for which `isWanted(result)` holds, with their indices. */
viewer.resultsWith = (results, isWanted) =>
  results.map((result, index) => ({ result, index })).filter(({ result }) => isWanted(result));

viewer.isTriple = (numbers) => Array.isArray(numbers) && numbers.length === 3 && numbers.every(Number.isFinite);

viewer.isRange = (numbers) => Array.isArray(numbers) && numbers.length === 2 && numbers.every(Number.isFinite);

/** The smallest range around all ranges; null when there are none. */
viewer.unionOfRanges = function (ranges) {
  const good = ranges.filter(viewer.isRange);
  if (good.length === 0) return null;
  return [Math.min(...good.map((r) => r[0])), Math.max(...good.map((r) => r[1]))];
};

/** Loads a map: its values and where it lies. */
viewer.loadMap = async function (map) {
  viewer.require(
    map && viewer.isRange(map.size) && viewer.isRange(map.x_m) && viewer.isRange(map.y_m),
    'A map lacks its size or place.',
  );
  const [nx, ny] = map.size;
  const quantity = await viewer.loadQuantity(map.values, nx * ny);
  const indexAt = (x, y) => {
    const ix = Math.floor(((x - map.x_m[0]) / (map.x_m[1] - map.x_m[0])) * nx);
    const iy = Math.floor(((y - map.y_m[0]) / (map.y_m[1] - map.y_m[0])) * ny);
    return ix >= 0 && ix < nx && iy >= 0 && iy < ny ? ix * ny + iy : -1;
  };
  const valueAt = (x, y) => (indexAt(x, y) < 0 ? NaN : quantity.at(indexAt(x, y)));
  return { map, quantity, valueAt };
};

/** Outer edges of voxels along an axis, from the first and last centre and their number. */
function outerEdges([first, last], count) {
  const half = count > 1 ? (last - first) / (count - 1) / 2 : 0.005;
  return [first - half, last + half];
}

/** Loads a volume: codes stored [x][y][z], with the outer edges of its voxels. */
viewer.loadVolume = async function (volume) {
  viewer.require(
    viewer.isTriple(volume.size) && ['x_m', 'y_m', 'z_m'].every((axis) => viewer.isRange(volume[axis])),
    'A volume lacks its size or place.',
  );
  const [nx, ny, nz] = volume.size;
  const quantity = await viewer.loadQuantity(volume.values, nx * ny * nz);
  const edges = [outerEdges(volume.x_m, nx), outerEdges(volume.y_m, ny), outerEdges(volume.z_m, nz)];
  return { size: volume.size, edges, quantity, reduced: volume.reduced || '' };
};
