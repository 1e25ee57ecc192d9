// Helpers for the page tests: a server for the page, a browser that opens it, and user actions.
// In: the folder made by web/build, Chromium and Playwright, in environment variables that web/check sets. Out: pages, and the
// status that they report (from src/app/browser.rs).

import assert from 'node:assert/strict';
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { after, before } from 'node:test';
import { join, extname } from 'node:path';

const { WAYFIELD_PAGE, WAYFIELD_SEEN, WAYFIELD_CHROMIUM, WAYFIELD_PLAYWRIGHT } = process.env;
const { chromium } = await import(WAYFIELD_PLAYWRIGHT);

const TYPES = {
    '.html': 'text/html', '.css': 'text/css', '.js': 'text/javascript', '.json': 'application/json',
    '.wasm': 'application/wasm',
};

/// Serves the page under a sub-path, like a project page on a shared host. Returns its address and a function that stops it.
async function serve() {
    const base = '/some/where/';
    const server = createServer(async (request, response) => {
        const path = new URL(request.url, 'http://localhost').pathname; // Without the query, which is the build id.
        const name = path === base ? 'index.html' : path.slice(base.length);
        try {
            if (!path.startsWith(base) || name.includes('/')) throw new Error('not served');
            const bytes = await readFile(join(WAYFIELD_PAGE, name));
            response.writeHead(200, { 'Content-Type': TYPES[extname(name)] ?? 'application/octet-stream' });
            response.end(bytes);
        } catch {
            response.writeHead(404);
            response.end();
        }
    });
    await new Promise((listening) => server.listen(0, '127.0.0.1', listening));
    return { address: `http://127.0.0.1:${server.address().port}${base}`, close: () => server.close() };
}

const FLAGS = ['--no-sandbox', '--disable-quic', '--no-first-run', '--disable-background-networking',
    '--disable-component-update', '--disable-sync'];
export const SOFTWARE_GPU = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];

export const launch = (gpu = SOFTWARE_GPU) =>
    chromium.launch({ executablePath: WAYFIELD_CHROMIUM, args: [...FLAGS, ...gpu] });

/// Serves the page and launches a browser while the tests of a file run. Returns an object whose `address` and `browser` are set
/// before the first test.
export function pageUnderTest() {
    const tested = {};
    let close;
    before(async () => {
        ({ address: tested.address, close } = await serve());
        tested.browser = await launch();
    });
    after(async () => {
        close?.();
        await tested.browser?.close();
    });
    return tested;
}

/// Checks that the page has reported no errors or warnings, and closes it.
export async function closeWithoutErrors(page) {
    assert.deepEqual(page.errors, []);
    await page.context().close();
}

/// Opens a page, and records its errors and warnings and its network requests.
export async function open(browser, address, { options = {}, prepare = async () => {} } = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, acceptDownloads: true, ...options });
    const page = await context.newPage();
    page.errors = [];
    page.requests = [];
    page.on('console', (message) => {
        if (['error', 'warning'].includes(message.type())) page.errors.push(message.text());
    });
    page.on('pageerror', (error) => page.errors.push(String(error)));
    page.on('request', (request) => page.requests.push(request.url()));
    await prepare(page);
    await page.goto(address);
    await page.waitForFunction(() => document.body.dataset.state !== undefined, null, { timeout: 120_000 });
    return page;
}

/// The text of Scenario I with another name.
export const ownScenario = async (name) => (await readFile(new URL('../../scenarios/scenario-1.ron', import.meta.url), 'utf8'))
    .replace(/name: "[^"]*"/, `name: "${name}"`);

/// A file for the page.
export const file = (name, text) => ({ name, mimeType: 'application/octet-stream', buffer: Buffer.from(text) });

/// The status that the page reported last.
export const status = (page) => page.evaluate(() => JSON.parse(document.body.dataset.status ?? 'null'));

/// Waits until `condition` holds for the status. Returns the status.
export async function until(page, condition, seconds = 60) {
    const end = Date.now() + seconds * 1000;
    let last;
    for (;;) {
        last = await status(page);
        if (last !== null && condition(last)) return last;
        if (Date.now() > end) throw new Error(`not within ${seconds} s: ${condition}\nlast status: ${JSON.stringify(last)}`);
        await page.waitForTimeout(200);
    }
}

/// The centre of the control or arena object with this accessible name. Waits until it is displayed, enabled and at rest.
export async function centre(page, name, seconds = 30) {
    const find = () => page.evaluate((name) => [...wayfieldPage.app.control(name) ?? []].join(), name);
    const end = Date.now() + seconds * 1000;
    for (let last = ''; ;) {
        const found = await find();
        if (found !== '' && found === last) {
            const [left, top, width, height] = found.split(',').map(Number);
            return [left + width / 2, top + height / 2];
        }
        if (Date.now() > end) throw new Error(`no control '${name}' at rest within ${seconds} s; last: ${found || 'none'}`);
        last = found;
        await page.waitForTimeout(300);
    }
}

/// Whether a control or arena object with this accessible name is displayed and enabled. Call `centre` for another control first:
/// the app knows no names until one frame after the first request.
export const isShown = (page, name) => page.evaluate((name) => wayfieldPage.app.control(name) !== undefined, name);

/// Asserts that what `page` has stored is offered by the button `name` in another tab only after `page` is closed, and can be
/// refused. Closes both.
export async function offeredOnlyOnceClosed(app, page, name) {
    const other = await page.context().newPage();
    await other.goto(`${app.address}?paused`);
    await until(other, (now) => now.paused);
    await centre(other, 'Run');
    await other.waitForTimeout(2000);
    assert.equal(await isShown(other, name), false);
    await page.close();
    await other.reload();
    await until(other, (now) => now.paused);
    await centre(other, name);
    await click(other, 'Not now');
    await other.waitForFunction((name) => wayfieldPage.app.control(name) === undefined, name, { timeout: 20_000 });
    await other.context().close();
}

/// Stops the app as a panic does, and waits until the page says so.
export async function crash(page) {
    // A module whose start function is the instruction `unreachable`: what a panic compiles to.
    await page.evaluate(() => setTimeout(() => new WebAssembly.Instance(new WebAssembly.Module(new Uint8Array([
        0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 8, 1, 0, 10, 5, 1, 3, 0, 0, 11])))));
    await page.waitForFunction(() => document.body.dataset.state === 'failed', null, { timeout: 20_000 });
}

/// Clicks on the control with this accessible name, slowly enough for a software GPU to draw a frame in between.
export async function click(page, name) {
    await page.mouse.move(...await centre(page, name));
    await page.waitForTimeout(300);
    await page.mouse.down();
    await page.waitForTimeout(300);
    await page.mouse.up();
    await page.waitForTimeout(600);
}

/// Presses a key while another one is held, as slowly as `click`.
export async function press(page, held, key) {
    await page.keyboard.down(held);
    await page.waitForTimeout(400);
    await page.keyboard.down(key);
    await page.waitForTimeout(400);
    await page.keyboard.up(key);
    await page.waitForTimeout(400);
    await page.keyboard.up(held);
}

/// Adds `hide` and `show` to the page, which act like a browser when the user switches to another tab and back: animation
/// frames stop, and the page is notified. (Headless Chromium treats every tab as visible.)
export const canBeHidden = (page) => page.addInitScript(() => {
    const ask = requestAnimationFrame.bind(globalThis);
    let held = null;
    globalThis.requestAnimationFrame = (callback) => (held === null ? ask(callback) : held.push(callback));
    const notify = (state) => {
        Object.defineProperty(document, 'visibilityState', { value: state, configurable: true });
        Object.defineProperty(document, 'hidden', { value: state === 'hidden', configurable: true });
        document.dispatchEvent(new Event('visibilitychange'));
    };
    globalThis.hide = () => {
        held = [];
        notify('hidden');
    };
    globalThis.show = () => {
        const waiting = held;
        held = null;
        notify('visible');
        waiting.forEach(ask);
    };
});

/// Saves a screenshot for inspection.
export const picture = (page, name) =>
    page.screenshot({ path: join(WAYFIELD_SEEN, `${name}.png`), timeout: 120_000 });
