// The last minute of the chosen curves, a value each millisecond, and bounds of every sixteen.

export const MOST = 60000;
const GROUP = 16;
const GROUPS = Math.ceil(MOST / GROUP) + 1;

// A real wheel does not say everything all the time: nothing is drawn there.
function known(value) {
  return Number.isFinite(value) ? value : null;
}

export class Samples {
  constructor() {
    this.curves = new Map(); // by name: raw, low, high
    this.first = 0;
    this.end = 0;
  }

  choose(names) {
    this.curves = new Map(
      names.map((name) => [name, { raw: new Float32Array(MOST), low: new Float32Array(GROUPS), high: new Float32Array(GROUPS) }]),
    );
    this.first = this.end = 0;
  }

  // A group that does not begin with its first row is not complete, and window() leaves it out.
  add(first, count, values) {
    if (this.end !== first) this.first = first;
    const stores = [...this.curves.values()];
    let place = 0;
    for (let row = first; row < first + count; row++) {
      const at = row % MOST;
      const group = Math.floor(row / GROUP) % GROUPS;
      const begins = row % GROUP === 0;
      for (const { raw, low, high } of stores) {
        const value = values[place++];
        raw[at] = value;
        const unknown = Number.isNaN(value);
        if (begins || !(unknown || low[group] <= value)) low[group] = value;
        if (begins || !(unknown || high[group] >= value)) high[group] = value;
      }
    }
    this.end = first + count;
    this.first = Math.max(this.first, this.end - MOST);
  }

  // Times in s and values between two rows, at most about twice `wide` points, of the latest rows,
  // whose group is not complete, each.
  window(from, to, wide) {
    const begin = Math.max(Math.ceil(from), this.first);
    const end = Math.min(Math.floor(to) + 1, this.end);
    const stores = [...this.curves.values()];
    if (end <= begin) return [[], ...stores.map(() => [])];
    return end - begin <= 2 * wide ? this.raw(begin, end, stores) : this.bounds(begin, end, wide, stores);
  }

  raw(begin, end, stores) {
    const times = Float64Array.from({ length: end - begin }, (_, k) => (begin + k + 1) / 1e3);
    return [times, ...stores.map(({ raw }) => Array.from(times, (_, k) => known(raw[(begin + k) % MOST])))];
  }

  // So many groups together that there are at most `wide` of them, at places that stay.
  bounds(begin, end, wide, stores) {
    const joined = Math.ceil((end - begin) / GROUP / wide);
    const from = Math.ceil(begin / GROUP / joined) * joined;
    const count = Math.max(Math.floor((Math.floor(end / GROUP) - from) / joined), 0);
    const length = joined * GROUP;
    const rest = (from + count * joined) * GROUP;
    const times = Float64Array.from({ length: 2 * count + end - rest }, (_, k) =>
      ((k < 2 * count ? from * GROUP + (k / 2) * length : rest + k - 2 * count) + 1) / 1e3); // prettier-ignore
    const values = stores.map(({ raw, low, high }) => {
      const out = new Array(times.length);
      for (let k = 0; k < count; k++) {
        let [least, most] = [Infinity, -Infinity];
        for (let group = from + k * joined; group < from + (k + 1) * joined; group++) {
          if (low[group % GROUPS] < least) least = low[group % GROUPS];
          if (high[group % GROUPS] > most) most = high[group % GROUPS];
        }
        out[2 * k] = known(least);
        out[2 * k + 1] = known(most);
      }
      for (let row = rest; row < end; row++) out[2 * count + row - rest] = known(raw[row % MOST]);
      return out;
    });
    return [times, ...values];
  }

  value(name, time_s) {
    const row = Math.round(time_s * 1e3) - 1;
    return row >= this.first && row < this.end ? this.curves.get(name)?.raw[row % MOST] : undefined;
  }
}
