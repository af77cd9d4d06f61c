// Numbers as they are read: three digits, with the unit's prefix.

const prefixes: [number, string][] = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'], [1e-12, 'p']];
const metric = new Set(['m', 's', 'J', 'N s', 'N m s', 'rad']);

export function formatted(value: number | null | undefined, unit: string): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return 'lost';
  if (unit === 'us') return formatted(value * 1e-6, 's');
  if (unit === 'rad') return formatted((value * 180) / Math.PI, '°');
  if (unit === '°') return `${trimmed(value)}°`;
  if (unit === 'relative') return trimmed(value);
  if (value === 0) return `0 ${unit}`.trim();
  if (!metric.has(unit)) return `${trimmed(value)} ${unit}`.trim();
  const size = Math.abs(value);
  if (size < 1e-12) return `< 1 p${unit}`;  // rounding
  const [scale, prefix] = prefixes.find(([at]) => size >= 0.9995 * at) ?? prefixes[prefixes.length - 1]!;
  return `${trimmed(value / scale)} ${prefix}${unit}`;
}

export function trimmed(value: number): string {
  const size = Math.abs(value);
  if (size === 0) return '0';
  if (size < 1e-3 || size >= 1e5) return value.toExponential(1).replace('e', ' e').replace(' e', 'e');
  return String(Number(value.toPrecision(3)));
}

export function seconds(time: number): string {
  return `${time.toFixed(2)} s`;
}

/** An element with classes and children. */
export function make<K extends keyof HTMLElementTagNameMap>(
  tag: K, className = '', ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  if (className !== '') element.className = className;
  element.append(...children);
  return element;
}

/** That is in index.html. */
export function byId<T extends HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (element === null) throw new Error(`index.html has no #${id}`);
  return element as T;
}
