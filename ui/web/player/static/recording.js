// Recording in the page: unpacked data, and curves with their values at any time.

const TIME_STEP = 0.01; // Seconds; as in curves.py.

// Returns the recording in a text in base 64, which is compressed JSON.
export async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).json();
}

export class Curve {
  // `units` has the size of the unit of each value.
  constructor(packed, units) {
    this.times = summed(packed.times, TIME_STEP);
    this.values = packed.values.map((column, index) => summed(column, units[index]));
  }

  get length() {
    return this.times.length;
  }

  // Index of the last sample up to a time; -1 before the first.
  last(time) {
    return lastUpTo(this.times, time);
  }

  // Values at a time, interpolated linearly; before the first sample the first, after the last sample the last.
  at(time) {
    const index = Math.min(Math.max(this.last(time), 0), this.length - 1);
    const next = Math.min(index + 1, this.length - 1);
    const seconds = this.times[next] - this.times[index];
    const share = seconds > 0 ? Math.min(Math.max((time - this.times[index]) / seconds, 0), 1) : 0;
    return this.values.map((column) => column[index] + share * (column[next] - column[index]));
  }

  // Values of the last sample up to a time; null before the first.
  held(time) {
    const index = this.last(time);
    return index < 0 ? null : this.values.map((column) => column[index]);
  }
}

// Index of the last of some sorted numbers that is not greater than a number; -1 if all are greater.
export function lastUpTo(sorted, number) {
  let [low, high] = [0, sorted.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] <= number) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

// Time in minutes and seconds, with tenths of a second if asked for.
export function clock(seconds, tenths = false) {
  const whole = tenths ? Math.floor(seconds * 10 + 1e-6) / 10 : Math.floor(seconds);
  const rest = whole % 60;
  return `${Math.floor(whole / 60)}:${tenths ? rest.toFixed(1).padStart(4, "0") : String(rest).padStart(2, "0")}`;
}

function summed(differences, unit) {
  const numbers = new Float64Array(differences.length);
  let sum = 0;
  for (let index = 0; index < numbers.length; index++) {
    sum += differences[index];
    numbers[index] = sum * unit;
  }
  return numbers;
}
