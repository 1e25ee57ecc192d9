// TrueType fonts for characters that the app's typeface lacks, made from the outlines of the browser's fonts (glyphs.js).
// In: characters. Out: the bytes of a font file. Table by table as in the OpenType specification.

import { canTrace, trace } from './glyphs.js';

/// Units of the font per em.
const UNITS = 2048;
/// The same as in the app's typeface.
const [ASCENT, DESCENT, LINE_GAP] = [0.905, -0.212, 0.033].map((part) => Math.round(part * UNITS));

/// A font with the characters of `text`; undefined if the browser does not let pages read what they draw.
export function fontWith(text) {
    if (!canTrace()) return undefined;
    const characters = [...new Set(text)].sort((a, b) => a.codePointAt(0) - b.codePointAt(0));
    // Glyph 0 stands for missing characters.
    const glyphs = [{ advance: 0, outlines: [] }, ...characters.map(trace)].map(toUnits);
    return fontFile(characters, glyphs);
}

/// Rounds a traced glyph to whole units.
function toUnits({ advance, outlines }) {
    const round = ([x, y]) => [Math.round(x * UNITS), Math.round(y * UNITS)];
    const rounded = outlines.map((points) => points.map(round));
    const points = rounded.flat();
    const range = (axis) => points.reduce(([low, high], point) => [Math.min(low, point[axis]), Math.max(high, point[axis])],
        points.length > 0 ? [Infinity, -Infinity] : [0, 0]);
    const [[left, right], [bottom, top]] = [range(0), range(1)];
    return { advance: Math.round(advance * UNITS), outlines: rounded, points, box: [left, bottom, right, top] };
}

/// Big-endian numbers.
const u16 = (value) => [value >> 8 & 255, value & 255];
const u32 = (value) => [...u16(value >>> 16), ...u16(value & 65535)];
const u16s = (...values) => values.flatMap(u16);
const padded = (bytes) => [...bytes, ...new Array(-bytes.length & 3).fill(0)];

function fontFile(characters, glyphs) {
    const outlines = glyphs.map((glyph) => padded(glyphTable(glyph)));
    const offsets = outlines.reduce((offsets, bytes) => [...offsets, offsets.at(-1) + bytes.length], [0]);
    const tables = Object.entries({
        cmap: cmapTable(characters),
        glyf: outlines.flat(),
        head: headTable(glyphs),
        hhea: [...u16s(1, 0, ASCENT, DESCENT, LINE_GAP, Math.max(...glyphs.map(({ advance }) => advance))),
            ...u16s(0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, glyphs.length)],
        hmtx: glyphs.flatMap(({ advance, box }) => u16s(advance, box[0])),
        loca: offsets.flatMap(u32),
        maxp: maxpTable(glyphs),
    });
    const HEADER_BYTES = 12 + 16 * tables.length;
    // The last three numbers speed up a binary search in the directory, for readers that use them.
    const directory = [...u32(0x00010000), ...u16s(tables.length, 64, 2, 16 * tables.length - 64)];
    let content = [];
    for (const [tag, bytes] of tables) {
        // Checksum (0: not computed), offset, length.
        const entry = [0, HEADER_BYTES + content.length, bytes.length];
        directory.push(...[...tag].map((letter) => letter.charCodeAt(0)), ...entry.flatMap(u32));
        content = content.concat(padded(bytes));
    }
    return Uint8Array.from([...directory, ...content]);
}

/// A simple glyph: every point is on the curve, and every coordinate is the 16-bit difference from the previous point.
function glyphTable({ outlines, points, box }) {
    if (points.length === 0) return [];
    const ends = outlines.reduce((ends, { length }) => [...ends, (ends.at(-1) ?? -1) + length], []);
    const differences = (axis) => points.flatMap((point, k) => u16(point[axis] - (k > 0 ? points[k - 1][axis] : 0)));
    const ON_CURVE = 1;
    return [
        ...u16s(outlines.length, ...box, ...ends, 0), ...points.map(() => ON_CURVE), ...differences(0), ...differences(1),
    ];
}

/// The glyph of each character, in format 12, which covers all of Unicode.
function cmapTable(characters) {
    const groups = characters.flatMap((character, k) => [character.codePointAt(0), character.codePointAt(0), k + 1]);
    const [WINDOWS, ALL_OF_UNICODE] = [3, 10];
    return [
        ...u16s(0, 1, WINDOWS, ALL_OF_UNICODE), ...u32(12),
        ...u16s(12, 0), ...[16 + 4 * groups.length, 0, characters.length, ...groups].flatMap(u32),
    ];
}

function headTable(glyphs) {
    const boxes = glyphs.map(({ box }) => box);
    const extreme = (choose, k) => choose(...boxes.map((box) => box[k]));
    const [VERSION, MAGIC, BASELINE_AT_0] = [0x00010000, 0x5f0f3cf5, 1];
    const [SMALLEST_READABLE, LEFT_TO_RIGHT, LONG_OFFSETS] = [8, 2, 1];
    return [
        ...[VERSION, VERSION, 0, MAGIC].flatMap(u32), ...u16s(BASELINE_AT_0, UNITS),
        // Times of creation and change: none.
        ...new Array(16).fill(0),
        ...u16s(extreme(Math.min, 0), extreme(Math.min, 1), extreme(Math.max, 2), extreme(Math.max, 3)),
        ...u16s(0, SMALLEST_READABLE, LEFT_TO_RIGHT, LONG_OFFSETS, 0),
    ];
}

function maxpTable(glyphs) {
    const most = (count) => Math.max(...glyphs.map(count));
    return [
        ...u32(0x00010000),
        ...u16s(glyphs.length, most(({ points }) => points.length), most(({ outlines }) => outlines.length)),
        // No composite glyphs, no instructions, one zone.
        ...u16s(0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0),
    ];
}
