// Backups of the editor in a real browser: after a crash or in a new tab, the unsaved changes can be restored.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { centre, click, closeWithoutErrors, crash, isShown, offeredOnlyOnceClosed, open, pageUnderTest, picture, until } from './support.mjs';

const app = pageUnderTest();

/// Adds a circle in the open editor, and waits until it is backed up.
async function addCircle(page) {
    await until(page, (now) => now.paused);
    await click(page, 'Add a circle');
    await centre(page, 'Obstacle 1');
    await page.waitForFunction(() => Object.keys(localStorage).some((key) => key.startsWith('wayfield: editor ')), null,
        { timeout: 20_000 });
}

test('after a crash, the unsaved changes of the editor can be restored, and are gone once discarded', async () => {
    const page = await open(app.browser, `${app.address}?scenario=empty&edit`);
    await addCircle(page);
    await crash(page);
    assert.match(await page.textContent('#message'), /internal error.*restore the unsaved changes/);
    page.errors.length = 0;
    await page.goto(`${app.address}?paused`);
    await until(page, (now) => now.paused);
    await centre(page, 'Restore');
    await picture(page, 'restore');
    await click(page, 'Restore');
    await centre(page, 'Obstacle 1');
    await picture(page, 'restored');
    await page.reload();
    await until(page, (now) => now.paused);
    // Still unsaved.
    await click(page, 'Restore');
    await click(page, 'Close the editor');
    await click(page, 'Discard changes');
    await page.reload();
    await until(page, (now) => now.paused);
    await centre(page, 'Run');
    await page.waitForTimeout(2000);
    assert.equal(await isShown(page, 'Restore'), false);
    await closeWithoutErrors(page);
});

test('a backup that cannot be read does not hide an older one', async () => {
    const page = await open(app.browser, `${app.address}?scenario=empty&edit`);
    await addCircle(page);
    await crash(page);
    page.errors.length = 0;
    await page.evaluate(() => {
        localStorage.setItem('wayfield: editor newer', JSON.stringify({ text: '(', savedMs: Date.now() + 1000 }));
        localStorage.setItem('wayfield: editor cut-off', '{"text": "(na');
        localStorage.setItem('wayfield: editor other', 'null');
    });
    await page.goto(`${app.address}?paused`);
    await until(page, (now) => now.paused);
    await click(page, 'Restore');
    await centre(page, 'Obstacle 1');
    await closeWithoutErrors(page);
});

test('two tabs that restore the same changes have a backup each', async () => {
    const page = await open(app.browser, `${app.address}?scenario=empty&edit`);
    await addCircle(page);
    const tabs = [await page.context().newPage(), await page.context().newPage()];
    await page.close();
    for (const tab of tabs) {
        await tab.bringToFront();
        await tab.goto(`${app.address}?paused`);
        await until(tab, (now) => now.paused);
        await centre(tab, 'Restore');
    }
    for (const tab of tabs) {
        await tab.bringToFront();
        await click(tab, 'Restore');
        await centre(tab, 'Obstacle 1');
    }
    const keys = await tabs[1].evaluate(() => Object.keys(localStorage).filter((key) => key.startsWith('wayfield: editor ')));
    assert.equal(keys.length, 2);
    await tabs[0].context().close();
});

test('the browser does not handle the keys of the editor too', async () => {
    const page = await open(app.browser, `${app.address}?scenario=empty&edit`);
    await until(page, (now) => now.paused);
    const unhandled = await page.evaluate(() => ['d', 'z', 'y'].filter((key) => {
        const event = new KeyboardEvent('keydown', { key, code: `Key${key.toUpperCase()}`, ctrlKey: true, cancelable: true });
        return document.querySelector('canvas').dispatchEvent(event);
    }));
    assert.deepEqual(unhandled, [], 'Ctrl+D would open the dialog for bookmarks');
    await closeWithoutErrors(page);
});

test('what is edited in an open tab is not offered in another one', async () => {
    const page = await open(app.browser, `${app.address}?scenario=empty&edit`);
    await addCircle(page);
    await offeredOnlyOnceClosed(app, page, 'Restore');
});
