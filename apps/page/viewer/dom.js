// SPDX-License-Identifier: MIT
// Elements, labelled controls, the page's colours, and numbers as people read them.

viewer.views = {};  // what starts each kind of view, by its data-view

// ---- Elements. Text only ever enters the page as text, never as markup. ----

/** A new element. Functions among the attributes listen to the event they are named after. */
viewer.element = function (tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (typeof value === 'function') {
      made.addEventListener(name, value);
    } else if (value === true) {
      made.setAttribute(name, '');
    } else if (value !== false && value !== null && value !== undefined) {
      made.setAttribute(name, String(value));
    }
  }
  made.append(...children);
  return made;
};

viewer.button = function (text, control, onClick) {
  return viewer.element('button', { type: 'button', 'data-control': control, click: onClick }, text);
};

/** A button that stays pressed until it is pressed again. */
viewer.toggle = function (text, control, isOn, onChange) {
  const made = viewer.button(text, control, () => {
    const on = made.getAttribute('aria-pressed') !== 'true';
    made.setAttribute('aria-pressed', String(on));
    onChange(on);
  });
  made.setAttribute('aria-pressed', String(isOn));
  return made;
};

function labelled(text, kind, input) {
  return viewer.element('label', { class: 'control ' + kind }, viewer.element('span', {}, text), input);
}

/** Controls that belong together, in a frame with their title. */
viewer.group = (title, ...controls) =>
  viewer.element('fieldset', {}, viewer.element('legend', {}, title), ...controls);

/** A drop-down list with its label; `options` are [value, text] pairs. */
viewer.select = function (text, control, options, chosen, onChange) {
  const list = viewer.element('select', {
    'data-control': control,
    change: () => onChange(list.value),
  });
  const label = labelled(text, 'control-select', list);
  label.setOptions = function (pairs, value) {
    list.replaceChildren(...pairs.map(([v, t]) => viewer.element('option', { value: v }, t)));
    list.value = String(value);
  };
  label.setOptions(options, chosen);
  return label;
};

/** A check box with its label. */
viewer.check = function (text, control, isOn, onChange) {
  const box = viewer.element('input', {
    type: 'checkbox',
    'data-control': control,
    change: () => onChange(box.checked),
  });
  box.checked = isOn;
  return labelled(text, 'control-check', box);
};

/** A slider with its label and, behind it, the value in words. */
viewer.slider = function (text, control, limits, value, describe, onInput) {
  const input = viewer.element('input', {
    type: 'range',
    'data-control': control,
    min: limits.min,
    max: limits.max,
    step: limits.step || 1,
  });
  const words = viewer.element('output', {});
  const label = labelled(text, 'control-range', input);
  label.append(words);
  label.input = input;
  label.show = function (number) {
    input.value = String(number);
    words.textContent = describe(number);
    input.setAttribute('aria-valuetext', describe(number));
  };
  label.show(value);
  input.addEventListener('input', () => {
    label.show(Number(input.value));
    onInput(Number(input.value));
  });
  return label;
};

const kSteps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** The step to the right and upwards that an arrow key asks for. */
viewer.stepOfKey = (key) => kSteps[key];

/** The nearest of `count` indices. */
viewer.clampIndex = (index, count) => Math.min(count - 1, Math.max(0, index));

/** Calls back with the width of an element, now and whenever it changes. */
viewer.watchWidth = function (element, callback) {
  let last = 0;
  new ResizeObserver(() => {
    const width = element.clientWidth;
    if (width > 0 && width !== last) callback((last = width));
  }).observe(element);
};

const kPanel = { width: 286, gap: 24, stackBelow: 760 };  // pixels

/**
 * Lays a view out as its picture with a panel of controls beside it, or below it on narrow pages;
 * calls back with the width that is left for the picture.
 */
viewer.splitBody = function (view, picture, panel, callback) {
  const layout = viewer.element('div', { class: 'view-split' }, picture, panel);
  view.body.append(layout);
  viewer.watchWidth(view.body, (width) => {
    const isStacked = width < kPanel.stackBelow;
    layout.classList.toggle('stacked', isStacked);
    callback(isStacked ? width : width - kPanel.width - kPanel.gap);
  });
};

// ---- The page's colours, for canvases. Print is always dark on white. ----

const kPrint = {
  ink: '#000000', soft: '#444444', line: '#cccccc', panel: '#ffffff', accent: '#124a94', error: '#a3271f', missing: '#d9dde4',
};
const themeListeners = [];
let isPrinting = false;

viewer.theme = function () {
  if (isPrinting) return Object.assign({ dark: false }, kPrint);
  const style = getComputedStyle(document.documentElement);
  const theme = { dark: matchMedia('(prefers-color-scheme: dark)').matches };
  for (const name of Object.keys(kPrint)) {
    theme[name] = style.getPropertyValue('--' + name).trim() || kPrint[name];
  }
  return theme;
};

/** Calls back when colours change: another colour scheme, or before and after printing. */
viewer.onThemeChange = function (callback) {
  themeListeners.push(callback);
};

function announceTheme(printing) {
  isPrinting = printing;
  for (const callback of themeListeners) callback();
}
matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => announceTheme(isPrinting));
addEventListener('beforeprint', () => announceTheme(true));
addEventListener('afterprint', () => announceTheme(false));

// ---- Numbers as text ----

const kSuperscripts = '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079';

function withMinus(text) {
  return text.replace('-', '\u2212');
}

/** A number with so many significant digits; very large and small ones with a power of ten. */
viewer.formatNumber = function (value, digits = 4) {
  if (!Number.isFinite(value)) return 'no value';
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size >= 1e-3 && size < 1e5) return withMinus(String(Number(value.toPrecision(digits))));
  const [mantissa, exponent] = value.toExponential(digits - 1).split('e');
  const power = powerOfTen(Number(exponent));
  const factor = String(Number(mantissa));
  return factor === '1' ? power : withMinus(factor) + ' \u00d7 ' + power;
};

const powerOfTen = (exponent) =>
  '10' + (exponent < 0 ? '\u207b' : '') + String(Math.abs(exponent)).replace(/\d/g, (d) => kSuperscripts[d]);

viewer.formatFixed = function (value, decimals = 3) {
  return Number.isFinite(value) ? withMinus(value.toFixed(decimals)) : 'no value';
};

/** The power of a thousand by which an axis up to `high` is best labelled, and its text. */
viewer.axisFactor = function (high) {
  const exponent = high > 0 ? 3 * Math.floor(Math.log10(high) / 3 + 1e-9) : 0;
  const isPlain = high >= 0.05 && exponent <= 3;
  return isPlain ? { factor: 1, text: '' } : { factor: Math.pow(10, exponent), text: powerOfTen(exponent) };
};

viewer.withUnit = function (text, unit) {
  return unit && text !== 'no value' ? text + ' ' + unit : text;
};

viewer.titleWithUnit = function (title, unit) {
  return unit ? title + ' (' + unit + ')' : title;
};

viewer.capitalised = function (text) {
  return text ? text[0].toUpperCase() + text.slice(1) : '';
};

// ---- Places. All that the page shows lies in the frame of its wall; x, y and z alone are the world's. ----

viewer.wallAxes = ['wall x', 'wall y', 'depth'];
viewer.wallTitles = ['wall x (m)', 'wall y (m)', 'depth from the wall (m)'];

/** A place on the wall, or before it, in words. */
viewer.positionText = (...position) =>
  position.map((value, axis) => `${viewer.wallAxes[axis]} ${viewer.formatFixed(value)} m`).join(', ');

/** A place before the wall in words, and in the world where that is another frame. */
viewer.placeText = function (position) {
  const text = viewer.positionText(...position);
  if (!viewer.worldFromWall) return text;
  const world = viewer.worldFromWall.map(([a, b, c, d]) => a * position[0] + b * position[1] + c * position[2] + d);
  return `${text} (in the world ${world.map((value) => viewer.formatFixed(value)).join(', ')} m)`;
};
