// Decoding of the page's data, values between samples, and helpers for elements.
"use strict";

const TYPES = { i2: Int16Array, f4: Float32Array, u1: Uint8Array, u2: Uint16Array };

/** Numbers of a packed array, row by row, with the number of its columns. */
function unpack(entry) {
  const text = atob(entry.data);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const codes = new TYPES[entry.type](bytes.buffer);
  if (!entry.scale) return { values: codes, columns: entry.columns, rows: entry.rows };
  const values = new Float32Array(codes.length);
  for (let i = 0; i < codes.length; i++) {
    const column = i % entry.columns;
    values[i] = codes[i] * entry.scale[column] + entry.offset[column];
  }
  return { values, columns: entry.columns, rows: entry.rows };
}

function unpackAll(arrays) {
  return Object.fromEntries(Object.entries(arrays).map(([name, entry]) => [name, unpack(entry)]));
}

/** Sample before a time, and the part of the way to the next one. */
function locate(times, t) {
  const t0 = times.values, last = times.rows - 1;
  if (last < 1 || t <= t0[0]) return [0, 0];
  if (t >= t0[last]) return [last, 0];
  let low = 0, high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t0[middle] <= t) low = middle; else high = middle;
  }
  return [low, (t - t0[low]) / (t0[low + 1] - t0[low])];
}

/** Row of an array between two samples. */
function between(array, [sample, part], from = 0, count = array.columns) {
  const start = sample * array.columns + from, out = new Array(count);
  for (let j = 0; j < count; j++) {
    const a = array.values[start + j];
    out[j] = part ? a + part * (array.values[start + array.columns + j] - a) : a;
  }
  return out;
}

/** Unit quaternion x, y, z, w between two samples. */
function turnBetween(array, [sample, part]) {
  const a = between(array, [sample, 0]);
  const b = part ? between(array, [sample + 1, 0]) : a;
  const sign = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] < 0 ? -1 : 1;
  const q = a.map((value, i) => value + part * (sign * b[i] - value));
  const length = Math.hypot(...q) || 1;
  return q.map((value) => value / length);
}

function column(array, index) {
  const out = new Float32Array(array.rows);
  for (let i = 0; i < array.rows; i++) out[i] = array.values[i * array.columns + index];
  return out;
}

/** Element with attributes and children; texts enter it as text, never as HTML. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

function colourOf(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

function figure(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return value.toExponential(2);
  return String(Number(value.toPrecision(4)));
}
