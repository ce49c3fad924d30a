// Queries on binary PLY files, read independently of the tools:
//
//   ply.mjs count FILE                  rows
//   ply.mjs median FILE COLUMN
//   ply.mjs equal-to FILE COLUMN VALUE  rows with that value
//   ply.mjs same A B                    common columns have equal values in every row; prints their number
//   ply.mjs fixed BEFORE AFTER          rows with ngs_fixed = 1 have equal ngs_label in BEFORE and AFTER; prints their number
import fs from 'node:fs';

const readers = { float: ['readFloatLE', 4], double: ['readDoubleLE', 8], uchar: ['readUInt8', 1], uint: ['readUInt32LE', 4], int: ['readInt32LE', 4] };

function read(path) {
  const data = fs.readFileSync(path), end = data.indexOf('end_header\n') + 11;
  const header = data.subarray(0, end).toString('latin1').split('\n');
  if (!header.includes('format binary_little_endian 1.0')) throw new Error(`${path}: not binary`);
  const rows = Number(header.find((line) => line.startsWith('element vertex')).split(' ')[2]);
  const columns = {};
  let stride = 0;
  for (const line of header.filter((text) => text.startsWith('property'))) {
    const [, type, name] = line.split(' ');
    columns[name] = { at: stride, read: readers[type][0] };
    stride += readers[type][1];
  }
  if (end + rows * stride > data.length) throw new Error(`${path}: truncated`);
  const value = (row, name) => data[columns[name].read](end + row * stride + columns[name].at);
  return { rows, columns, value };
}
const column = (ply, name) => Array.from({ length: ply.rows }, (_, row) => ply.value(row, name));
function fail(text) { console.error(text); process.exit(1); }

const [question, path, ...rest] = process.argv.slice(2);
const ply = read(path);
if (question === 'count') console.log(ply.rows);
if (question === 'median') console.log(column(ply, rest[0]).sort((a, b) => a - b)[ply.rows >> 1]);
if (question === 'equal-to') console.log(column(ply, rest[0]).filter((x) => x === Number(rest[1])).length);
if (question === 'same') {
  const other = read(rest[0]), common = Object.keys(ply.columns).filter((name) => name in other.columns);
  if (ply.rows !== other.rows) fail(`${ply.rows} rows, expected ${other.rows}`);
  for (const name of common)
    for (let row = 0; row < ply.rows; ++row)
      if (!Object.is(ply.value(row, name), other.value(row, name))) fail(`${name} differs in row ${row}`);
  console.log(common.length);
}
if (question === 'fixed') {
  const other = read(rest[0]), rows = column(ply, 'ngs_fixed').flatMap((x, row) => (x === 1 ? [row] : []));
  if (other.rows < ply.rows) fail(`${other.rows} rows left of ${ply.rows}`);
  const lost = rows.filter((row) => other.value(row, 'ngs_label') !== ply.value(row, 'ngs_label'));
  if (lost.length) fail(`${lost.length} of ${rows.length} rows fixed by hand changed their label`);
  console.log(rows.length);
}
