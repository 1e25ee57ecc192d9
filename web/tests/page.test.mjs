// End-to-end tests of the page in a real browser. With a software GPU the app draws only about ten frames per second, so each
// test checks several promises of docs/browser.md.

import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { brotliCompressSync, constants } from 'node:zlib';
import {
    SOFTWARE_GPU, canBeHidden, centre, click, closeWithoutErrors, file, isShown, launch, open, ownScenario, pageUnderTest, picture,
    press, status, until,
} from './support.mjs';

const app = pageUnderTest();

// Tall enough for the whole setup panel.
const TALL = { viewport: { width: 1280, height: 900 } };

test('the compressed module is at most 6.6 MB', async (t) => {
    const module = await readFile(new URL('wayfield_bg.wasm', pathToFileURL(`${process.env.WAYFIELD_PAGE}/`)));
    const compressed = brotliCompressSync(module, { params: { [constants.BROTLI_PARAM_QUALITY]: 9 } }).length;
    t.diagnostic(`${module.length} bytes, ${compressed} with brotli`);
    assert.ok(compressed <= 6_600_000, `${compressed} bytes`);
});

test('the page works under any path, contacts no other host, and the robot learns to drive', async (t) => {
    const page = await open(app.browser, `${app.address}?pace=full`, { options: { colorScheme: 'light' } });
    assert.equal(await page.evaluate(() => document.body.dataset.state), 'started');
    const startedMs = await page.evaluate(() => Number(document.body.dataset.startedMs));
    const first = await until(page, (now) => now.env_steps > 0);
    await until(page, (now) => now.episodes > first.episodes && now.gradient_steps > 0);
    const good = await until(page, (now) => now.best_success_rate >= 0.9, 240);
    const goodAfter = await page.evaluate(() => performance.now() / 1000);
    assert.ok(good.env_steps <= 30_000, `${good.env_steps} env steps to 90 % success`);
    const best = await until(page, (now) => now.best_success_rate >= 0.99, 240);
    const seconds = await page.evaluate(() => performance.now() / 1000);
    t.diagnostic(`started after ${startedMs} ms; 90 % after ${goodAfter.toFixed(1)} s, 99 % after ${seconds.toFixed(1)} s `
        + `(${best.env_steps} env steps); longest slice ${best.longest_slice_ms.toFixed(1)} ms, `
        + `mean ${(best.stepping_ms / best.frames).toFixed(1)} ms per frame; ${best.frames_per_s.toFixed(1)} frames/s; `
        + `${(best.stepping_ms / best.gradient_steps).toFixed(2)} ms of stepping per gradient step`);
    assert.ok(seconds <= 60, `${seconds} s to 99 % success`);
    await picture(page, 'trained');
    const description = await page.textContent('#status');
    assert.match(description, /Scenario scenario-1, preset fast: \d+ episodes, success rate [\d.]+ %/, 'for screen readers');
    for (const url of page.requests) assert.ok(url.startsWith(app.address) || url === 'data:,', `unexpected request: ${url}`);
    await closeWithoutErrors(page);
});

test('the page draws on a screen with more pixels than the largest texture of the GPU', async () => {
    const options = { viewport: { width: 1500, height: 300 }, deviceScaleFactor: 6 };
    const page = await open(app.browser, app.address, { options });
    await until(page, (now) => now.frames > 20, 120);
    const { width, maxSide, shown } = await page.evaluate(() => {
        const canvas = document.querySelector('canvas');
        const gl = document.createElement('canvas').getContext('webgl2');
        return { width: canvas.width, maxSide: gl.getParameter(gl.MAX_TEXTURE_SIZE), shown: canvas.getBoundingClientRect().width };
    });
    assert.ok(width <= maxSide, `${width} pixels, at most ${maxSide}`);
    assert.ok(Math.abs(shown - 1500) < 2, `${shown} of 1500 points`);
    await closeWithoutErrors(page);
});

test('a clock that the browser rounds to 100 ms costs no frames', async () => {
    const round = () => {
        const now = performance.now.bind(performance);
        performance.now = () => Math.floor(now() / 100) * 100;
    };
    const opened = async (prepare) => {
        const page = await open(app.browser, `${app.address}?pace=full`, { prepare });
        await until(page, (now) => now.env_steps > 10_000, 240);
        return page;
    };
    // Both at the same time, so that whatever else the machine does slows both down.
    const pages = [await opened(async () => {}), await opened((page) => page.addInitScript(round))];
    const frames = () => Promise.all(pages.map(async (page) => (await status(page)).frames));
    const before = await frames();
    await pages[0].waitForTimeout(10_000);
    const [fine, coarse] = (await frames()).map((after, k) => after - before[k]);
    await Promise.all(pages.map((page) => page.context().close()));
    assert.ok(coarse >= fine * 2 / 3, `${coarse} frames in 10 s, ${fine} with a fine clock`);
});

test('the page runs no injected script and can contact no other host', async () => {
    const page = await open(app.browser, app.address);
    const tried = await page.evaluate(async () => {
        const forbidden = new Set();
        document.addEventListener('securitypolicyviolation', (violation) => forbidden.add(violation.effectiveDirective));
        const add = (kind, given) => document.head.append(Object.assign(document.createElement(kind), given));
        add('script', { textContent: 'globalThis.ran = "inline"' });
        add('script', { src: 'data:text/javascript,globalThis.ran = "injected"' });
        add('style', { textContent: 'body { opacity: 0 }' });
        const otherOrigin = location.origin.replace('127.0.0.1', 'localhost');
        add('base', { href: otherOrigin });
        new Image().src = `${otherOrigin}/picture.png`;
        const reached = await fetch(otherOrigin).then(() => 'reached', () => 'refused');
        const evaluate = () => {
            try {
                return new Function('return "evaluated"')();
            } catch {
                return 'refused';
            }
        };
        // Delayed, because code evaluated directly by the debugger is exempt from the Content-Security-Policy.
        const evaluated = await new Promise((later) => setTimeout(() => later(evaluate()), 100));
        await new Promise((later) => setTimeout(later, 500));
        return { reached, evaluated, ran: globalThis.ran ?? 'nothing', forbidden: [...forbidden].sort() };
    });
    assert.deepEqual(tried, {
        reached: 'refused', evaluated: 'refused', ran: 'nothing',
        forbidden: ['base-uri', 'connect-src', 'img-src', 'script-src', 'script-src-elem', 'style-src-elem'],
    });
    await page.context().close();
});

test('the address selects scenario, preset, seed and pace', async () => {
    const page = await open(app.browser, `${app.address}?scenario=scenario-2&preset=per_d3qn&seed=4294967295&pace=20&paused`);
    const now = await until(page, (now) => now.scenario === 'scenario-2');
    assert.deepEqual([now.preset, now.seed, now.paused, now.pace], ['per_d3qn', 4294967295, true, { Times: 20 }]);
    assert.equal(now.env_steps, 0);
    await picture(page, 'from-address');
    await closeWithoutErrors(page);
});

test('training can continue or restart in a scenario selected with the mouse, and the address is updated', async () => {
    const page = await open(app.browser, `${app.address}?seed=5`, { options: TALL });
    await until(page, (now) => now.env_steps > 0);
    await click(page, 'Scenario');
    await click(page, 'Empty');
    await picture(page, 'selected');
    await click(page, 'Continue training in Empty');
    await until(page, (now) => now.scenario === 'empty' && now.env_steps > 0);
    await page.waitForFunction(() => location.search === '', null, { timeout: 20_000 });
    await click(page, 'Restart training');
    await page.waitForFunction(() => new URLSearchParams(location.search).get('scenario') === 'empty', null, { timeout: 20_000 });
    const now = await status(page);
    assert.deepEqual([now.scenario, now.preset, now.seed], ['empty', 'fast', 5]);
    await closeWithoutErrors(page);
});

test('one click compares an expert with the current policy', async () => {
    const page = await open(app.browser, app.address, { options: TALL });
    await until(page, (now) => now.env_steps > 0);
    await click(page, 'Watch an expert');
    const now = await until(page, (now) => now.mode === 'Compare');
    assert.match(now.notice, /Scenario I expert/);
    await page.waitForTimeout(4000);
    await picture(page, 'expert');
    assert.equal((await status(page)).env_steps, now.env_steps, 'training is suspended during the comparison');
    await closeWithoutErrors(page);
});

test('a classical driver is compared with the current policy in the levels of a generator', async () => {
    const page = await open(app.browser, `${app.address}?scenario=clutter&seed=3`, { options: TALL });
    const before = await until(page, (now) => now.env_steps > 0);
    assert.equal(before.scenario, 'clutter');
    await page.waitForFunction(() => new URLSearchParams(location.search).get('scenario') === 'clutter', null, { timeout: 20_000 });
    await click(page, 'Watch a classical driver');
    await click(page, 'A* and DWA on its own map');
    const now = await until(page, (now) => now.mode === 'Compare');
    assert.match(now.notice, /Class B: builds a map/);
    await page.waitForTimeout(4000);
    await picture(page, 'driver');
    await closeWithoutErrors(page);
});

test('a map is opened together with its image, the general policy drives in it, and it is shared by link', async () => {
    // A room of 4 m x 4 m with walls of 0.1 m, and a pillar in the middle.
    const size = 40;
    const isWall = (x, y) => Math.min(x, y, size - 1 - x, size - 1 - y) === 0 || (Math.abs(x - 20) < 3 && Math.abs(y - 20) < 3);
    const pixels = Array.from({ length: size * size }, (_, k) => (isWall(k % size, Math.floor(k / size)) ? 0 : 254));
    const image = file('room.pgm', Buffer.concat([Buffer.from(`P5\n${size} ${size}\n255\n`), Buffer.from(pixels)]));
    const map = file('room.yaml', 'image: room.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n');

    const page = await open(app.browser, app.address, { options: TALL });
    await until(page, (now) => now.env_steps > 0);
    await page.setInputFiles('#file', map);
    await until(page, (now) => /there is no image `room\.pgm`/.test(now.notice));
    await page.setInputFiles('#file', image);
    await until(page, (now) => /an image does not state its scale/.test(now.notice));
    await page.setInputFiles('#file', [map, image]);
    await until(page, (now) => now.scenario === 'room.yaml' && now.env_steps > 0);
    await page.waitForFunction(() => location.hash.startsWith('#scenario='));
    const link = page.url();
    await click(page, 'Watch the general policy');
    const now = await until(page, (now) => now.mode === 'Compare');
    assert.match(now.notice, /The general policy drives .* not trained in room\.yaml/);
    await page.waitForTimeout(4000);
    await picture(page, 'map');
    await closeWithoutErrors(page);

    const other = await open(app.browser, link, { options: TALL });
    await until(other, (now) => now.scenario === 'room.yaml.ron' && now.env_steps > 0);
    await closeWithoutErrors(other);
});

test('an invalid scenario is reported with line and column; a valid one starts a training run that can be shared by link', async () => {
    const page = await open(app.browser, app.address, { options: TALL });
    const before = await until(page, (now) => now.env_steps > 0);
    const valid = await ownScenario('Mine');
    await page.setInputFiles('#file', file('broken.ron', valid.replace('radius_m', 'radius_cm')));
    const reported = await until(page, (now) => now.notice !== null);
    assert.match(reported.notice, /broken\.ron:\d+:\d+: .*radius_cm.*did you mean `radius_m`/s);
    await until(page, (now) => now.env_steps > reported.env_steps);
    await picture(page, 'broken');
    for (const [name, text] of [['empty.ron', ''], ['picture.png', 'not an image'], ['short.safetensors', 'not a policy'],
        ['deep.ron', '('.repeat(100_000)]]) {
        await page.setInputFiles('#file', file(name, text));
        await until(page, (now) => now.notice?.includes(name));
    }
    await page.setInputFiles('#file', file('mine.ron', valid));
    const started = await until(page, (now) => now.scenario === 'mine.ron' && now.env_steps > 0);
    assert.equal(started.preset, before.preset);
    await page.waitForFunction(() => location.hash.startsWith('#scenario='));
    const link = page.url();
    assert.ok(link.length < 2000, `${link.length} characters`);
    await closeWithoutErrors(page);

    const other = await open(app.browser, link, { options: TALL });
    const shared = await until(other, (now) => now.env_steps > 0);
    assert.equal(shared.scenario, 'mine.ron');
    await picture(other, 'shared');
    await closeWithoutErrors(other);

    const damaged = await open(app.browser, link.slice(0, -40));
    const now = await until(damaged, (now) => now.env_steps > 0);
    assert.equal(now.scenario, 'scenario-1');
    assert.match(now.notice, /mine\.ron/);
    await damaged.context().close();
});

test('a saved policy can be opened again, and a dropped file is opened', async () => {
    const page = await open(app.browser, app.address, { options: TALL });
    await until(page, (now) => now.gradient_steps > 0);
    const [saved] = await Promise.all([page.waitForEvent('download'), press(page, 'Control', 's')]);
    assert.equal(saved.suggestedFilename(), 'scenario-1-fast-0.safetensors');
    const policy = await readFile(await saved.path());
    assert.match(policy.subarray(8, 200).toString(), /"__metadata__"/);
    const [dialog] = await Promise.all([page.waitForEvent('filechooser'), click(page, 'Open…')]);
    await dialog.setFiles({ name: 'back.safetensors', mimeType: '', buffer: policy });
    const now = await until(page, (now) => now.mode === 'Compare');
    assert.match(now.notice, /back\.safetensors/);
    const drop = async (name, text) => page.evaluate(([name, text]) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], name));
        document.querySelector('canvas').dispatchEvent(new DragEvent('drop', { dataTransfer, bubbles: true, cancelable: true }));
    }, [name, text]);
    await drop('dropped.ron', await ownScenario('Dropped'));
    await until(page, (now) => now.scenario === 'dropped.ron' && now.mode === 'Train');
    await closeWithoutErrors(page);
});

test('an obstacle can be dragged with the mouse, and the modified scenario can be saved', async () => {
    const page = await open(app.browser, `${app.address}?paused`, { options: TALL });
    await until(page, (now) => now.paused);
    const save = async () => {
        const [saved] = await Promise.all([page.waitForEvent('download'), click(page, 'Save scenario…')]);
        assert.match(saved.suggestedFilename(), /\.ron$/);
        return readFile(await saved.path(), 'utf8');
    };
    const before = await save();
    assert.match(before, /name: "Scenario I"/);
    const [x, y] = await centre(page, 'Obstacle 2');
    await page.mouse.move(x, y);
    await page.waitForTimeout(500);
    await page.mouse.down();
    for (let k = 1; k <= 5; k += 1) {
        await page.mouse.move(x - 8 * k, y - 10 * k);
        await page.waitForTimeout(300);
    }
    await page.mouse.up();
    await until(page, (now) => now.scenario_modified);
    await picture(page, 'dragged');
    const moved = await save();
    const differ = before.split('\n').filter((line, k) => line !== moved.split('\n')[k]);
    assert.equal(differ.length, 1, `only the position of one obstacle differs: ${differ}`);
    await closeWithoutErrors(page);
});

test('an edited scenario is saved with its comments, and training continues in it', async () => {
    const page = await open(app.browser, `${app.address}?scenario=empty&edit`, { options: TALL });
    await until(page, (now) => now.paused);
    const save = async () => {
        const [saved] = await Promise.all([page.waitForEvent('download'), click(page, 'Save')]);
        assert.equal(saved.suggestedFilename(), 'empty.ron');
        return readFile(await saved.path(), 'utf8');
    };
    const before = await save();
    const shipped = await readFile(new URL('../../scenarios/empty.ron', import.meta.url), 'utf8');
    assert.equal(before, shipped, 'an unchanged scenario is saved byte for byte, with its comments');
    await click(page, 'Add a circle');
    await picture(page, 'editor');
    const added = await save();
    const lines = added.split('\n').filter((line) => !before.split('\n').includes(line));
    assert.equal(lines.filter((line) => line.includes('Circle(radius_m:')).length, 1, `one more circle: ${lines}`);
    assert.ok(lines.length <= 3, `nothing else has changed: ${lines}`);
    await click(page, 'Undo');
    assert.doesNotMatch(await save(), /Circle\(radius_m:/, 'after undo the circle is gone');
    await click(page, 'Add a circle');
    const beforeApplying = await status(page);
    await click(page, 'Continue here');
    const now = await until(page, (now) => now.scenario_modified && !now.paused && now.env_steps > beforeApplying.env_steps);
    assert.equal(now.scenario, 'empty.ron', 'the scenario has the name of the saved file');
    await picture(page, 'continues-in-edited-scenario');
    await closeWithoutErrors(page);
});

test('simulation and initial weights are bit-identical to a native build', async () => {
    const page = await open(app.browser, `${app.address}?paused`);
    const fixture = new URL('../../tests/fixtures/fingerprints.json', import.meta.url);
    for (const { scenario, preset, seed, control_steps, fingerprint } of JSON.parse(await readFile(fixture))) {
        if (scenario.endsWith('.ron')) {
            await page.setInputFiles('#file', file(scenario, await readFile(new URL(scenario, fixture))));
            await until(page, (now) => now.scenario === scenario);
        }
        const found = await page.evaluate((args) => wayfieldPage.app.fingerprint(...args),
            [scenario, preset, seed, control_steps]);
        assert.equal(found, fingerprint, `${scenario}, ${preset}, seed ${seed}`);
    }
    await closeWithoutErrors(page);
});

test('a paused page uses almost no CPU', async (t) => {
    const page = await open(app.browser, `${app.address}?paused`);
    await until(page, (now) => now.paused);
    await page.waitForTimeout(3000);
    const cdp = await page.context().newCDPSession(page);
    await cdp.send('Performance.enable');
    const busy = async () => {
        const { metrics } = await cdp.send('Performance.getMetrics');
        return metrics.find(({ name }) => name === 'TaskDuration').value;
    };
    const [before, frames] = [await busy(), (await status(page)).frames];
    await page.waitForTimeout(10_000);
    const [after, later] = [await busy(), (await status(page)).frames];
    t.diagnostic(`paused for 10 s: the main thread was busy for ${((after - before) * 1000).toFixed(0)} ms, `
        + `${later - frames} frames`);
    assert.ok(later - frames <= 20, `${later - frames} frames in 10 s`);
    assert.ok(after - before < 1, `busy for ${after - before} s of 10`);
    await closeWithoutErrors(page);
});

test('the page survives being hidden and resized, and accepts touch', async () => {
    const page = await open(app.browser, app.address, { options: { hasTouch: true }, prepare: canBeHidden });
    await until(page, (now) => now.env_steps > 0);
    await page.evaluate(() => hide());
    await page.waitForTimeout(2000);
    const hidden = await status(page);
    await page.waitForTimeout(8000);
    assert.deepEqual(await status(page), hidden, 'nothing happens while hidden');
    await page.evaluate(() => show());
    const later = await until(page, (now) => now.env_steps > hidden.env_steps);
    // In 8 s a visible page takes 3,200 env steps.
    assert.ok(later.env_steps - hidden.env_steps < 2000, 'the steps of the hidden time are not made up for');
    const canvas = () => page.evaluate(() => {
        const { width, height } = document.querySelector('canvas');
        return [width, height];
    });
    for (const [width, height] of [[1000, 640], [390, 844], [844, 390], [1280, 720]]) {
        await page.setViewportSize({ width, height });
        await page.waitForFunction(([w, h]) => {
            const { width, height } = document.querySelector('canvas');
            return width === w && height === h;
        }, [width, height], { timeout: 20_000 })
            .catch(async () => assert.fail(`the canvas is ${await canvas()} instead of ${width} x ${height}`));
        const now = await status(page);
        await until(page, (later) => later.frames > now.frames + 2);
        await picture(page, `at-${width}x${height}`);
    }
    await page.touchscreen.tap(...await centre(page, 'Pause'));
    await until(page, (now) => now.paused);
    await closeWithoutErrors(page);
});

for (const scale of [0.5, 2, 4]) {
    test(`at the scale factor ${scale}, the canvas has the resolution of the screen and the controls are in the window`, async (t) => {
        const flags = [`--force-device-scale-factor=${scale}`, '--window-size=720,540'];
        const scaled = await launch([...SOFTWARE_GPU, ...flags]);
        t.after(() => scaled.close());
        const page = await open(scaled, app.address, { options: { viewport: null } });
        await until(page, (now) => now.frames > 3);
        const [ratio, width, height, pixels] = await page.evaluate(() =>
            [devicePixelRatio, innerWidth, innerHeight, document.querySelector('canvas').width]);
        assert.equal(ratio, scale);
        assert.equal(pixels, scale * width);
        for (const name of ['Pause', 'Edit', 'Plots panel', 'Export']) {
            const [x, y] = await centre(page, name);
            assert.ok(x > 0 && x < width && y > 0 && y < height, `${name} at ${x}, ${y} of ${width} x ${height}`);
        }
        await picture(page, `scale-${scale}`);
        await closeWithoutErrors(page);
    });
}

test('invalid options in the address are reported, and the defaults are used', async () => {
    const page = await open(app.browser, `${app.address}?scenario=scenario-9&seed=-1&pace=fastest`);
    const now = await until(page, (now) => now.env_steps > 0);
    assert.deepEqual([now.scenario, now.seed, now.pace], ['scenario-1', 0, { Times: 5 }]);
    assert.match(now.notice, /scenario-9.*did you mean `scenario-\d`/s);
    await picture(page, 'no-such-scenario');
    // The status has the latest notice only.
    for (const [option, notice] of [
        ['seed=-1', 'Invalid address: seed=-1\nhelp: use a whole number, 0 or more'],
        ['pace=fastest', 'Invalid address: pace=fastest\nhelp: use 0.01 to 100 (times real time), or full'],
    ]) {
        await page.goto(`${app.address}?${option}`);
        assert.equal((await until(page, (now) => now.env_steps > 0)).notice, notice);
    }
    await page.context().close();
});

test('the app takes only its own shortcuts from the browser, and the view is restored after a reload', async () => {
    const page = await open(app.browser, app.address);
    await until(page, (now) => now.env_steps > 0);
    const isTaken = (options) => page.evaluate((options) => {
        const event = new KeyboardEvent('keydown', { bubbles: true, cancelable: true, ...options });
        return !document.querySelector('canvas').dispatchEvent(event);
    }, options);
    for (const options of [{ key: ' ' }, { key: 'Tab' }, { key: 'ArrowUp' }, { key: 's', ctrlKey: true }, { key: 'o', metaKey: true }])
        assert.ok(await isTaken(options), JSON.stringify(options));
    for (const options of [{ key: 'F5' }, { key: 'F12' }, { key: 'r', ctrlKey: true }, { key: 'c', ctrlKey: true }, { key: 'Tab', ctrlKey: true }])
        assert.ok(!await isTaken(options), JSON.stringify(options));
    await click(page, 'Plots panel');
    await page.waitForFunction(() => localStorage.getItem('wayfield: preferences')?.includes('plots_open: false'));
    await page.reload();
    // In the plots panel, Export would be enabled after the first episode.
    await until(page, (now) => now.episodes > 0);
    await centre(page, 'Plots panel');
    await picture(page, 'without-plots');
    assert.equal(await isShown(page, 'Export'), false, 'the plots panel stays closed');
    await closeWithoutErrors(page);
});

test('a missing WebGL 2 or a missing module is reported', async (t) => {
    const withoutWebGl = await launch(['--disable-gpu', '--disable-3d-apis']);
    t.after(() => withoutWebGl.close());
    const failed = await open(withoutWebGl, app.address);
    assert.equal(await failed.evaluate(() => document.body.dataset.state), 'failed');
    assert.match(await failed.textContent('#message'), /WebGL 2/);
    await picture(failed, 'no-webgl');
    const page = await open(app.browser, app.address, {
        prepare: (page) => page.route('**/*.wasm?*', (route) => route.fulfill({ status: 404 })),
    });
    assert.equal(await page.evaluate(() => document.body.dataset.state), 'failed');
    assert.match(await page.textContent('#message'), /could not be loaded/);
    assert.match(await page.textContent('#detail'), /404/);
    await picture(page, 'no-module');
    await page.context().close();
});
