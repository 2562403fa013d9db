// The part of a curve that is in sight, with no more points than the screen can show.

// The number of the first time after a time.
function after(times, time) {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1; else high = middle;
  }
  return low;
}

// The points of a curve in a stretch of time, one more on each side. Where there are many, each of so many columns has its first, least,
// greatest and last point.
function inSight(curve, [from, to], columns) {
  const start = Math.max(after(curve.x, from) - 1, 0);
  const end = Math.min(after(curve.x, to) + 1, curve.x.length);
  if (end - start <= 4 * columns) return { x: curve.x.slice(start, end), y: curve.y.slice(start, end) };
  const kept = [];
  const width = (to - from) / columns;
  for (let i = start; i < end;) {
    const beyond = from + (Math.floor((curve.x[i] - from) / width) + 1) * width;
    let [first, least, greatest] = [i, i, i];
    // A gap stays one, and a point is in a column even where that is narrower than a double can tell.
    do {
      if (curve.y[i] < curve.y[least]) least = i;
      if (curve.y[i] > curve.y[greatest]) greatest = i;
      i += 1;
    } while (i < end && curve.x[i] < beyond && curve.y[i] !== null && curve.y[i - 1] !== null);
    kept.push(...new Set([first, least, greatest, i - 1].sort((a, b) => a - b)));
  }
  return { x: kept.map((i) => curve.x[i]), y: kept.map((i) => curve.y[i]) };
}
