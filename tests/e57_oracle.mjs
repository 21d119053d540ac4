// node e57_oracle.mjs PACKAGE (E57 PTX|refused)...: the points of each PTX that was made of an E57 file against
// what web-e57 reads from that. One line per file; fails on any difference.
import { readFileSync } from "fs";
import { basename, resolve } from "path";
import { pathToFileURL } from "url";

const [folder, ...pairs] = process.argv.slice(2);
const { convertE57 } = await import(pathToFileURL(resolve(folder, "e57.js")));

const rows = (text) => text.split("\n").filter((line) => line.trim()).map((line) => line.trim().split(/\s+/).map(Number));

// Points in world coordinates, as web-e57 gives them.
function ours(text) {
  const lines = rows(text), points = [];
  let posed = false;
  for (let at = 0; at < lines.length; ) {
    const count = lines[at][0] * lines[at + 1][0], m = lines.slice(at + 6, at + 10);
    posed ||= m.some((row, i) => row.some((value, j) => value !== (i === j ? 1 : 0)));
    for (const p of lines.slice(at + 10, at + 10 + count))
      points.push({
        xyz: [0, 1, 2].map((k) => p[0] * m[0][k] + p[1] * m[1][k] + p[2] * m[2][k] + m[3][k]),
        rgb: p.length === 7 ? p.slice(4) : null,
        none: p[0] === 0 && p[1] === 0 && p[2] === 0,
      });
    at += 10 + count;
  }
  return { points, posed };
}

const near = (a, b) => Math.abs(a - b) <= 1e-6 * Math.max(1, Math.abs(a));

// Samples without a return are not written by one of the two, and grids are in another order.
function difference(mine, theirs, posed) {
  const key = (p) => p.xyz.map(Math.fround);
  const order = (a, b) => a.key[0] - b.key[0] || a.key[1] - b.key[1] || a.key[2] - b.key[2];
  if (!posed) {
    mine = mine.filter((p) => !p.none);
    theirs = theirs.filter((p) => p.xyz.some((value) => value !== 0));
    for (const list of [mine, theirs]) {
      for (const point of list) point.key = key(point);
      list.sort(order);
    }
  }
  if (mine.length !== theirs.length) return `${mine.length} points, web-e57 has ${theirs.length}`;
  for (let i = 0; i < mine.length; ++i) {
    const same = posed ? mine[i].xyz.every((v, k) => near(v, theirs[i].xyz[k]))
                       : mine[i].key.every((v, k) => v === theirs[i].key[k]);
    if (!same) return `point ${i}: ${mine[i].xyz}, web-e57 has ${theirs[i].xyz}`;
    if (mine[i].rgb && theirs[i].rgb && posed && !mine[i].rgb.every((v, k) => Math.abs(v - theirs[i].rgb[k]) <= 1))
      return `colour ${i}: ${mine[i].rgb}, web-e57 has ${theirs[i].rgb}`;
  }
  return sum(mine) === sum(theirs) || !mine.every((p) => p.rgb) ? "" : "the colours differ";
}
const sum = (points) => points.reduce((total, p) => total + (p.rgb ? p.rgb[0] + 3 * p.rgb[1] + 7 * p.rgb[2] : 0), 0);

let equal = 0, different = 0, points = 0;
for (let i = 0; i < pairs.length; i += 2) {
  const name = basename(pairs[i]);
  let theirs;
  try {
    const text = Buffer.from(convertE57(new Uint8Array(readFileSync(pairs[i])), "XYZ")).toString();
    theirs = rows(text).map((p) => ({ xyz: p.slice(0, 3), rgb: p.length >= 6 ? p.slice(3, 6) : null }));
  } catch (error) {
    console.log(`${name}: web-e57 cannot read it (${String(error).slice(0, 80)})`);
    continue;
  }
  if (pairs[i + 1] === "refused") {
    const fine = theirs.length === 0;
    console.log(`${name}: ${fine ? "no points in either" : `refused, web-e57 has ${theirs.length} points`}`);
    fine ? ++equal : ++different;
    continue;
  }
  const mine = ours(readFileSync(pairs[i + 1], "utf8"));
  const what = difference(mine.points, theirs, mine.posed);
  what ? ++different : ++equal;
  points += mine.points.length;
  console.log(`${name}: ${what || `equal, ${mine.points.length} points`}`);
}
console.log(`${equal} files equal, ${different} different, ${points} points compared`);
process.exit(different > 0 || equal === 0 ? 1 : 0);
