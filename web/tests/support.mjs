// What the tests of the page share: a host that serves it, a browser that opens it, and words for what a user does.
// In: the folder that web/build made. Out: pages, and what they say of themselves (`standing`, from src/app/browser.rs).

import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { join, extname } from 'node:path';

const { WAYFIELD_PAGE, WAYFIELD_SEEN, WAYFIELD_CHROMIUM, WAYFIELD_PLAYWRIGHT } = process.env;
const { chromium } = await import(WAYFIELD_PLAYWRIGHT);

const TYPES = {
    '.html': 'text/html', '.css': 'text/css', '.js': 'text/javascript', '.json': 'application/json',
    '.wasm': 'application/wasm',
};

/// Serves the page below a path of its own, as a project's page on a shared host; answers with its address.
export async function serve() {
    const below = '/some/where/';
    const server = createServer(async (request, response) => {
        const path = new URL(request.url, 'http://localhost').pathname; // (Without what tells builds apart.)
        const name = path === below ? 'index.html' : path.slice(below.length);
        try {
            if (!path.startsWith(below) || name.includes('/')) throw new Error('elsewhere');
            const bytes = await readFile(join(WAYFIELD_PAGE, name));
            response.writeHead(200, { 'Content-Type': TYPES[extname(name)] ?? 'application/octet-stream' });
            response.end(bytes);
        } catch {
            response.writeHead(404);
            response.end();
        }
    });
    await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
    return { address: `http://127.0.0.1:${server.address().port}${below}`, close: () => server.close() };
}

const FLAGS = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync'];
export const SOFTWARE_GPU = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

export const launch = (gpu = SOFTWARE_GPU) =>
    chromium.launch({ executablePath: WAYFIELD_CHROMIUM, args: [...FLAGS, ...gpu] });

/// Opens a page that writes down all it complains of and all that it asks the network for.
export async function open(browser, address, { options = {}, prepare = async () => {} } = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, acceptDownloads: true, ...options });
    const page = await context.newPage();
    page.complaints = [];
    page.asked = [];
    page.on('console', (message) => {
        if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
    });
    page.on('pageerror', (error) => page.complaints.push(String(error)));
    page.on('request', (request) => page.asked.push(request.url()));
    await prepare(page);
    await page.goto(address);
    await page.waitForFunction(() => document.body.dataset.state !== undefined, null, { timeout: 120_000 });
    return page;
}

/// What the page said last of how the training stands.
export const standing = (page) => page.evaluate(() => JSON.parse(document.body.dataset.standing ?? 'null'));

/// Waits until `holds` of the standing; answers with it.
export async function until(page, holds, seconds = 60) {
    const end = Date.now() + seconds * 1000;
    let last;
    for (;;) {
        last = await standing(page);
        if (last !== null && holds(last)) return last;
        if (Date.now() > end) throw new Error(`not within ${seconds} s: ${holds}\nlast: ${JSON.stringify(last)}`);
        await page.waitForTimeout(200);
    }
}

/// Presses the mouse at a place long enough for a slow software GPU to draw a frame in between.
export async function click(page, x, y) {
    await page.mouse.move(x, y);
    await page.waitForTimeout(300);
    await page.mouse.down();
    await page.waitForTimeout(300);
    await page.mouse.up();
    await page.waitForTimeout(600);
}

/// Presses a key with another one held, as long.
export async function press(page, held, key) {
    await page.keyboard.down(held);
    await page.waitForTimeout(400);
    await page.keyboard.down(key);
    await page.waitForTimeout(400);
    await page.keyboard.up(key);
    await page.waitForTimeout(400);
    await page.keyboard.up(held);
}

/// Gives the page `hide` and `show`, which do what a browser does when the user goes to another tab and comes back: no more
/// frames are asked for, and it is told. (Headless Chromium takes every tab for visible.)
export const canBeHidden = (page) => page.addInitScript(() => {
    const ask = requestAnimationFrame.bind(globalThis);
    let held = null;
    globalThis.requestAnimationFrame = (callback) => (held === null ? ask(callback) : held.push(callback));
    const tell = (state) => {
        Object.defineProperty(document, 'visibilityState', { value: state, configurable: true });
        Object.defineProperty(document, 'hidden', { value: state === 'hidden', configurable: true });
        document.dispatchEvent(new Event('visibilitychange'));
    };
    globalThis.hide = () => {
        held = [];
        tell('hidden');
    };
    globalThis.show = () => {
        const waiting = held;
        held = null;
        tell('visible');
        waiting.forEach(ask);
    };
});

/// Keeps a picture for whoever wants to look.
export const picture = (page, name) =>
    page.screenshot({ path: join(WAYFIELD_SEEN, `${name}.png`), timeout: 120_000 });
