// Traces glyph outlines. A web page can draw with system fonts but cannot read the font files, so each character is drawn on
// a canvas, and its outline is traced.
// In: a character. Out: its advance width and closed polygons in units of the em, y upwards from the baseline.

/// Height of the em on the canvas, in pixels. The outlines are accurate to about a tenth of a pixel.
const EM = 128;
/// Space around the em for parts of the glyph that stick out, in pixels.
const MARGIN = EM / 2;
/// Maximum width of a glyph, in pixels. The rest is cut off.
const MAX_WIDTH = 8 * EM;
/// Maximum distance of a left-out point from the simplified outline, in pixels.
const TOLERANCE = 0.15;
/// A pixel is inside the glyph if its alpha is higher than this.
const INSIDE = 127.5;

/// The segments of each marching-squares case. A case is the sum of the corners that are inside: 8 top left, 4 top right,
/// 2 bottom right, 1 bottom left. A segment leads from one side of the cell to another (top, right, bottom, left), with the
/// glyph's interior on its left.
const LINES = ['', 'BL', 'RB', 'RL', 'TR', 'TR BL', 'TB', 'TL', 'LT', 'BT', 'LT RB', 'RT', 'LR', 'BR', 'LB', '']
    .map((lines) => lines.split(' ').filter(Boolean));

const canvas = document.createElement('canvas');
const pen = canvas.getContext('2d', { willReadFrequently: true });

/// Whether the browser returns the pixels that were drawn. Some browsers alter them to prevent fingerprinting.
export function canTrace() {
    canvas.width = canvas.height = 2;
    pen.fillRect(0, 0, 1, 2);
    const { data } = pen.getImageData(0, 0, 2, 2);
    return [0, 1, 2, 3].every((pixel) => data[4 * pixel + 3] === (pixel % 2 === 0 ? 255 : 0));
}

/// Draws a character and traces it: `advance` is its width and `outlines` are its closed polygons, in units of the em.
export function trace(character) {
    // A combining mark gets a space to combine with. U+FE0E asks for an emoji in one colour.
    const isMark = /\p{M}/u.test(character);
    const text = (isMark ? '\u00a0' : '') + character + (/\p{Extended_Pictographic}/u.test(character) ? '\ufe0e' : '');
    const font = `${EM}px sans-serif`;
    pen.font = font;
    const before = isMark ? pen.measureText('\u00a0').width : 0;
    const advance = Math.max(0, pen.measureText(text).width - before);
    canvas.width = Math.min(MAX_WIDTH, Math.ceil(before + advance)) + 2 * MARGIN;
    canvas.height = EM + 2 * MARGIN;
    // Setting the size has reset the font.
    pen.font = font;
    const baseline = EM + MARGIN / 2;
    pen.fillText(text, MARGIN, baseline);
    const [left, pixels] = [MARGIN + before, pen.getImageData(0, 0, canvas.width, canvas.height)];
    const toEm = ([x, y]) => [(x + 0.5 - left) / EM, (baseline - y - 0.5) / EM];
    return { advance: advance / EM, outlines: outlines(pixels).map((points) => simplify(points).map(toEm)) };
}

/// The closed outlines between inside and outside, found by marching squares, as points [x, y] in pixels. The border of the
/// image counts as outside, so that the outline of a glyph that is cut off there is closed, too.
function outlines({ width, height, data }) {
    const isBorder = (x, y) => x === 0 || y === 0 || x === width - 1 || y === height - 1;
    const alpha = (x, y) => (isBorder(x, y) ? 0 : data[4 * (y * width + x) + 3]);
    // Maps each side that an outline crosses to the side that it crosses next. The id of a side is 2 * the index of the pixel
    // at its left or upper end, + 1 if it is vertical.
    const next = new Map();
    const sideId = (x, y, letter) => ({
        T: 2 * (y * width + x), L: 2 * (y * width + x) + 1, B: 2 * ((y + 1) * width + x), R: 2 * (y * width + x + 1) + 1,
    })[letter];
    for (let y = 0; y + 1 < height; y += 1) {
        for (let x = 0; x + 1 < width; x += 1) {
            const corners = [alpha(x, y), alpha(x + 1, y), alpha(x + 1, y + 1), alpha(x, y + 1)];
            const inside = corners.reduce((bits, corner) => 2 * bits + (corner > INSIDE), 0);
            for (const [from, to] of LINES[inside]) next.set(sideId(x, y, from), sideId(x, y, to));
        }
    }
    /// The point on a side where the alpha would be `INSIDE`.
    const crossing = (id) => {
        const [pixel, isVertical] = [id >> 1, id & 1];
        const [x, y] = [pixel % width, Math.floor(pixel / width)];
        const [a, b] = [alpha(x, y), alpha(x + (isVertical ? 0 : 1), y + isVertical)];
        const fraction = (INSIDE - a) / (b - a);
        return isVertical ? [x, y + fraction] : [x + fraction, y];
    };
    const found = [];
    while (next.size > 0) {
        const points = [];
        for (let [at] = next.keys(); next.has(at);) {
            points.push(crossing(at));
            const to = next.get(at);
            next.delete(at);
            at = to;
        }
        found.push(points);
    }
    return found.filter((points) => points.length > 2);
}

/// Simplifies a closed polyline with the Ramer-Douglas-Peucker algorithm, within `TOLERANCE`.
function simplify(points) {
    const closed = [...points, points[0]];
    const kept = new Set([0]);
    const fromStart = points.map((point) => distance(point, points[0]));
    const middle = fromStart.indexOf(Math.max(...fromStart));
    const spans = [[0, middle], [middle, points.length]];
    while (spans.length > 0) {
        const [from, to] = spans.pop();
        let [farthest, largest] = [from, TOLERANCE];
        for (let k = from + 1; k < to; k += 1) {
            const away = distanceToLine(closed[k], closed[from], closed[to]);
            if (away > largest) [farthest, largest] = [k, away];
        }
        kept.add(from);
        if (farthest > from) spans.push([from, farthest], [farthest, to]);
    }
    return points.filter((_, k) => kept.has(k));
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

function distanceToLine(point, a, b) {
    const length = distance(a, b);
    if (length === 0) return distance(point, a);
    return Math.abs((b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0])) / length;
}
