// Text in a real browser: characters that the app's typeface lacks, and input methods.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { centre, click, closeWithoutErrors, file, open, ownScenario, pageUnderTest, picture, press, until } from './support.mjs';

const app = pageUnderTest();

/// Opens the editor with a scenario called `name`.
async function edit(name, options = {}) {
    const page = await open(app.browser, `${app.address}?edit`, options);
    await until(page, (now) => now.paused);
    await page.setInputFiles('#file', file('named.ron', await ownScenario(name)));
    // Undo is enabled once the file has replaced the scenario that was there before.
    await centre(page, 'Undo');
    return page;
}

/// The pixels of the field with the scenario's name, once they no longer change.
async function nameField(page) {
    const [x, y] = await centre(page, 'Scenario name');
    const clip = { x: x - 100, y: y - 13, width: 200, height: 26 };
    let last;
    for (let k = 0; k < 20; k += 1) {
        await page.waitForTimeout(500);
        const now = (await page.screenshot({ clip })).toString('base64');
        if (now === last) return now;
        last = now;
    }
    throw new Error('the field never comes to rest');
}

/// The scenario's name in its file.
async function savedName(page) {
    const [saved] = await Promise.all([page.waitForEvent('download'), click(page, 'Save')]);
    return /name: "([^"]*)"/.exec(await readFile(await saved.path(), 'utf8'))[1];
}

test('a name in Japanese is drawn with the fonts of the browser', async () => {
    const drawn = {};
    for (const name of ['迷路', '路迷']) {
        const page = await edit(name);
        drawn[name] = await nameField(page);
        await picture(page, `name-${name}`);
        await closeWithoutErrors(page);
    }
    assert.notEqual(drawn['迷路'], drawn['路迷'], 'missing glyphs would all look the same');
});

test('in a browser that adds noise to canvas pixels, missing glyphs are boxes, and the page works', async () => {
    const noise = () => {
        const read = CanvasRenderingContext2D.prototype.getImageData;
        CanvasRenderingContext2D.prototype.getImageData = function (...area) {
            const image = read.apply(this, area);
            crypto.getRandomValues(image.data.subarray(0, Math.min(image.data.length, 65_536)));
            return image;
        };
    };
    const options = { prepare: (page) => page.addInitScript(noise) };
    const [one, other] = [await edit('迷路', options), await edit('路迷', options)];
    assert.equal(await nameField(one), await nameField(other));
    await closeWithoutErrors(one);
    await closeWithoutErrors(other);
});

test('a saved figure has a Japanese name as text', async () => {
    const page = await open(app.browser, app.address, { options: { viewport: { width: 1280, height: 900 } } });
    await until(page, (now) => now.env_steps > 0);
    await page.setInputFiles('#file', file('named.ron', await ownScenario('迷路')));
    await until(page, (now) => now.scenario === 'named.ron' && now.episodes > 0);
    await click(page, 'Export');
    const [saved] = await Promise.all([page.waitForEvent('download'), click(page, 'Figure as SVG…')]);
    assert.match(await readFile(await saved.path(), 'utf8'), /<text[^>]*>[^<]*迷路/s);
    await closeWithoutErrors(page);
});

test('an input method composes text in a field, and plain keys still work there and elsewhere', async () => {
    const page = await edit('Mine');
    const cdp = await page.context().newCDPSession(page);
    const compose = (text) => cdp.send('Input.imeSetComposition', { text, selectionStart: text.length, selectionEnd: text.length });
    await click(page, 'Scenario name');
    await page.waitForFunction(() => document.activeElement.id === 'egui_text_agent');
    await press(page, 'Control', 'a');
    await compose('めい');
    await page.waitForTimeout(400);
    await compose('めいろ');
    await page.waitForTimeout(400);
    await picture(page, 'composing');
    await cdp.send('Input.insertText', { text: '迷路' });
    await page.waitForTimeout(400);
    await page.keyboard.press('Space');
    await page.keyboard.type('x1y', { delay: 200 });
    await page.keyboard.press('Backspace');
    await page.waitForTimeout(400);
    await cdp.send('Input.insertText', { text: '😀' });
    await page.waitForTimeout(1000);
    await picture(page, 'composed');
    assert.equal(await savedName(page), '迷路 x1😀');
    // A composition that is cancelled leaves the text as it was.
    await click(page, 'Scenario name');
    await page.keyboard.press('End');
    await compose('めい');
    await page.waitForTimeout(400);
    await compose('');
    await page.waitForTimeout(400);
    assert.equal(await savedName(page), '迷路 x1😀');
    // On the canvas, keys are shortcuts again.
    await page.mouse.click(640, 600, { delay: 300 });
    await page.waitForFunction(() => document.activeElement.id === 'canvas');
    await press(page, 'Control', 'z');
    await press(page, 'Control', 'z');
    assert.equal(await savedName(page), 'Mine');
    await closeWithoutErrors(page);
});
