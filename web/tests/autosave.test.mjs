// Autosaves in a real browser: a reload, a lost WebGL context or a crash of the module loses next to nothing, and where the
// browser stores nothing, the page says so.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { centre, click, closeWithoutErrors, crash, isShown, offeredOnlyOnceClosed, open, pageUnderTest, picture, status, until } from './support.mjs';

const app = pageUnderTest();

/// The descriptions of the stored sessions.
const sessions = (page) => page.evaluate(() => new Promise((resolve, reject) => {
    const opening = indexedDB.open('wayfield');
    opening.onerror = () => reject(opening.error);
    opening.onsuccess = () => {
        const database = opening.result;
        if (!database.objectStoreNames.contains('notes')) return resolve([]);
        const all = database.transaction('notes').objectStore('notes').getAll();
        all.onsuccess = () => {
            database.close();
            resolve(all.result.map(({ note }) => note));
        };
    };
}));

/// Lets the page train and save, as when the focus leaves it. Returns the description of the autosave.
async function trainAndSave(page) {
    const now = await until(page, (now) => now.gradient_steps > 0);
    for (let k = 0; k < 60; k += 1) {
        await page.evaluate(() => dispatchEvent(new Event('blur')));
        await page.waitForTimeout(500);
        const saved = (await sessions(page)).find(({ env_steps }) => env_steps >= now.env_steps);
        if (saved !== undefined) return saved;
    }
    throw new Error(`not saved within 30 s: ${JSON.stringify(await status(page))}`);
}

test('after a reload, the last session can be continued exactly where it was saved', async (t) => {
    const page = await open(app.browser, `${app.address}?pace=full&seed=3`);
    const saved = await trainAndSave(page);
    assert.deepEqual([saved.scenario, saved.preset, saved.seed], ['Scenario I', 'Fast', 3]);
    await page.goto(`${app.address}?paused`);
    const before = await until(page, (now) => now.paused);
    assert.deepEqual([before.env_steps, before.seed], [0, 0], 'nothing continues by itself');
    await centre(page, 'Continue');
    await picture(page, 'offer');
    await click(page, 'Continue');
    const now = await until(page, (now) => now.seed === 3);
    assert.equal(now.env_steps, saved.env_steps, 'exactly where it was saved');
    assert.match(now.notice, /last session continues/);
    assert.equal(await isShown(page, 'Not now'), false, 'the offer is gone');
    await click(page, 'Run');
    await until(page, (later) => later.env_steps > now.env_steps && later.gradient_steps > now.gradient_steps);
    await trainAndSave(page);
    assert.equal((await sessions(page)).length, 1, 'its next autosave replaces it');
    t.diagnostic(`continued at ${now.env_steps} env steps`);
    await closeWithoutErrors(page);
});

test('a session of an open tab is not offered in another tab', async () => {
    const page = await open(app.browser, `${app.address}?pace=full`);
    await trainAndSave(page);
    await offeredOnlyOnceClosed(app, page, 'Continue');
});

test('after a lost WebGL context, one click reloads the page and continues the training', async () => {
    const page = await open(app.browser, `${app.address}?pace=full&seed=3`);
    const saved = await trainAndSave(page);
    await page.evaluate(() => document.querySelector('canvas').getContext('webgl2').getExtension('WEBGL_lose_context').loseContext());
    await page.waitForFunction(() => document.body.dataset.state === 'failed', null, { timeout: 20_000 });
    assert.match(await page.textContent('#message'), /graphics driver has reset.*saved \d+ s ago/);
    await picture(page, 'lost-context');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#policy')]);
    assert.match((await readFile(await download.path())).subarray(8, 200).toString(), /"__metadata__"/, 'the policy is a file');
    await Promise.all([page.waitForEvent('load'), page.click('#continue')]);
    const now = await until(page, (now) => now.seed === 3 && now.env_steps >= saved.env_steps);
    // The notice disappears after a few seconds.
    if (now.notice !== null) assert.match(now.notice, /last session continues/);
    await page.context().close();
});

test('after a crash of the module, the page offers to continue from the autosave', async () => {
    const page = await open(app.browser, `${app.address}?pace=full&seed=3`);
    const saved = await trainAndSave(page);
    await crash(page);
    assert.match(await page.textContent('#message'), /internal error.*saved \d+ s ago/);
    assert.match(await page.textContent('#detail'), /unreachable/);
    await Promise.all([page.waitForEvent('load'), page.click('#continue')]);
    await until(page, (now) => now.seed === 3 && now.env_steps >= saved.env_steps);
    await page.context().close();
});

for (const [what, prepare] of [
    ['without a database, as in some private windows', () => Object.defineProperty(globalThis, 'indexedDB', { value: undefined })],
    ['without space in the database', () => {
        IDBObjectStore.prototype.put = () => {
            throw new DOMException('no space', 'QuotaExceededError');
        };
    }],
]) {
    test(`${what}, the page says that it cannot save, and training goes on`, async () => {
        const page = await open(app.browser, `${app.address}?pace=full`, { prepare: (page) => page.addInitScript(prepare) });
        const now = await until(page, (now) => now.gradient_steps > 0);
        await page.waitForTimeout(3000);
        await page.evaluate(() => dispatchEvent(new Event('blur')));
        const reported = await until(page, (now) => now.notice !== null);
        assert.match(reported.notice, /Autosave failed.*save the policy/s);
        await until(page, (later) => later.env_steps > reported.env_steps);
        assert.ok(reported.env_steps > now.env_steps);
        await picture(page, 'no-autosave');
        await closeWithoutErrors(page);
    });
}

test('a damaged autosave is reported, and the new training run goes on', async () => {
    const page = await open(app.browser, `${app.address}?pace=full&seed=3`);
    await trainAndSave(page);
    await page.goto('about:blank');
    await page.goto(`${app.address}?paused`);
    await until(page, (now) => now.paused);
    await page.evaluate(() => new Promise((resolve) => {
        indexedDB.open('wayfield').onsuccess = ({ target: { result: database } }) => {
            const transaction = database.transaction('files', 'readwrite');
            const store = transaction.objectStore('files');
            store.openCursor().onsuccess = ({ target: { result: cursor } }) => {
                const files = cursor.value;
                files['checkpoint/latest.bin'] = files['checkpoint/latest.bin'].slice(0, 5000);
                cursor.update(files);
            };
            transaction.oncomplete = () => {
                database.close();
                resolve();
            };
        };
    }));
    await click(page, 'Continue');
    const now = await until(page, (now) => now.notice !== null);
    assert.match(now.notice, /latest\.bin/);
    assert.deepEqual([now.seed, now.env_steps], [0, 0]);
    await click(page, 'Run');
    await until(page, (later) => later.env_steps > 0);
    await page.context().close();
});
