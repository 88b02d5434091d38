// How late samples come, of clocks that were never set to each other: later than the quickest did.

/** The quickest is looked for among these last seconds twice, since the clocks drift apart. */
const REMEMBERED = 10;
const KEPT = 1024;

export class Latency {
  constructor() {
    this.kept = new Float32Array(KEPT);
    this.sorted = new Float32Array(KEPT);
    this.restart();
  }

  restart() {
    this.count = 0;
    this.quickest = Infinity;
    this.quickestBefore = Infinity;
    this.since = -Infinity;
  }

  /** In milliseconds; both times in seconds, each by its own clock. */
  take(device, host) {
    if (host - this.since > REMEMBERED) {
      this.quickestBefore = this.quickest;
      this.quickest = Infinity;
      this.since = host;
    }
    const between = host - device;
    if (between < this.quickest) this.quickest = between;
    const late = (between - Math.min(this.quickest, this.quickestBefore)) * 1000;
    this.kept[this.count % KEPT] = late;
    this.count += 1;
    return late;
  }

  /** Of the last thousand samples. */
  percentiles() {
    const count = Math.min(this.count, KEPT);
    if (count === 0) return null;
    this.sorted.set(this.kept);
    const sorted = this.sorted.subarray(0, count).sort();
    const percentile = (part) => sorted[Math.min(count - 1, Math.floor(part * count))];
    return { p50: percentile(0.5), p99: percentile(0.99) };
  }
}
