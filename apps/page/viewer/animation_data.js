// SPDX-License-Identifier: MIT
// The numbers of an animation: its values by cell and bin, sums, and what its bins mean.

/** One pass over all values: the sum of each cell, and the mean over all cells of each bin. */
function sumUp(codes, values, cells, bins) {
  const perCell = new Float64Array(cells);
  const perBin = new Float64Array(bins);
  for (let cell = 0, i = 0; cell < cells; ++cell) {
    let sum = 0;
    for (let bin = 0; bin < bins; ++bin, ++i) {
      const value = values[codes[i]];
      sum += value;
      perBin[bin] += value;
    }
    perCell[cell] = sum;
  }
  for (let bin = 0; bin < bins; ++bin) perBin[bin] /= cells;
  return { perCell, perBin };
}

const indexOfMaximum = (numbers) => numbers.reduce((best, number, i) => (number > numbers[best] ? i : best), 0);

class AnimationData {
  constructor(animation, cells, quantity) {
    this.animation = animation;
    this.cells = cells;
    this.bins = animation.bins;
    this.quantity = quantity;
    const { perCell, perBin } = sumUp(quantity.codes, quantity.values, cells, animation.bins);
    this.sums = perCell;
    this.means = perBin;
    this.brightestCell = indexOfMaximum(perCell);
    this.brightestBin = indexOfMaximum(perBin);
    this.isFrames = animation.axis === 'frame';
    this.word = this.isFrames ? 'frame' : 'bin';
  }

  value(cell, bin) {
    return this.quantity.values[this.quantity.codes[cell * this.bins + bin]];
  }

  histogram(cell) {
    return Float64Array.from({ length: this.bins }, (unused, bin) => this.value(cell, bin));
  }

  largestAt(bin) {
    let code = 0;
    for (let cell = 0; cell < this.cells; ++cell) code = Math.max(code, this.quantity.codes[cell * this.bins + bin]);
    return this.quantity.values[code];
  }

  /** Where a bin begins on the axis of time; frames are counted from one, each around its number. */
  edge(bin) {
    return this.isFrames ? bin + 0.5 : this.animation.start + bin * this.animation.step;
  }

  binAt(position) {
    const bin = this.isFrames ? position - 0.5 : (position - this.animation.start) / this.animation.step;
    return Math.min(this.bins - 1, Math.max(0, Math.floor(bin)));
  }

  /** A bin in words, such as `path length 1.234 m` (its middle). */
  describe(bin) {
    const { labels, axis, start, step } = this.animation;
    if (this.isFrames) return (labels && labels[bin]) || `frame ${bin + 1}`;
    const decimals = Math.min(6, Math.max(3, 1 - Math.floor(Math.log10(step))));
    return `${axis} ${viewer.withUnit(viewer.formatFixed(start + (bin + 0.5) * step, decimals), 'm')}`;
  }

  axisTitle() {
    return this.isFrames ? 'frame' : viewer.titleWithUnit(this.animation.axis, 'm');
  }

  valueText(value) {
    return viewer.withUnit(viewer.formatNumber(value), this.animation.unit);
  }
}

viewer.loadAnimation = async function (animation, cells) {
  const { bins, first_lit: first, last_lit: last } = animation;
  viewer.require(Number.isInteger(bins) && bins > 0, 'The capture has no bins.');
  viewer.require(animation.axis === 'frame' || animation.step > 0, 'The capture\u2019s bins have no width.');
  viewer.require(
    Number.isInteger(first) && Number.isInteger(last) && first >= 0 && first <= last && last < bins,
    'The capture does not say where its light lies.',
  );
  const quantity = await viewer.loadQuantity(animation.values, cells * bins);
  if (animation.whole) quantity.values = quantity.values.map(Math.round);
  return new AnimationData(animation, cells, quantity);
};
