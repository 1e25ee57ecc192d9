// The page around the app. It loads the WebAssembly module and provides what a browser has instead of a desktop: a file picker
// and downloads, options in the URL instead of a command line, and status and error messages instead of a terminal. Its
// counterpart in the app is src/app/browser.rs.

import * as autosaves from './autosave.js';
import * as backups from './editor_backup.js';
import { fontWith } from './font.js';
import { connect } from './text_input.js';

const byId = (id) => document.getElementById(id);
const cover = byId('cover');
const PREFERENCES_KEY = 'wayfield: preferences';

/// Reports that the app cannot run or continue. `detail` is for bug reports. If the training was saved, offers to continue it.
function stop(text, detail = '') {
    const saved = autosaves.describe();
    const unsaved = backups.describe();
    text = [text, saved, unsaved].filter((part) => part !== undefined).join(' ');
    byId('rescue').hidden = saved === undefined;
    cover.hidden = false;
    byId('bar').hidden = true;
    byId('message').textContent = text;
    byId('detail').textContent = detail;
    byId('detail').hidden = detail === '';
    byId('retry').hidden = false;
    document.body.dataset.state = 'failed';
}

byId('reload').addEventListener('click', (event) => {
    event.preventDefault();
    location.reload();
});
byId('continue').addEventListener('click', () => {
    autosaves.continueAfterReload();
    location.reload();
});
byId('policy').addEventListener('click', () => wayfieldPage.save('policy.safetensors', autosaves.lastPolicy()));
byId('reset').addEventListener('click', (event) => {
    event.preventDefault();
    location.assign(location.pathname);
});

// Keys that the app handles. The browser must not handle them too: it would scroll, move the focus or save the page.
const KEYS = new Set([' ', 'Tab', 'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '/', "'"]);
const KEYS_WITH_CTRL = new Set(['s', 'o', 'd', 'z', 'y']);
const canvas = byId('canvas');
canvas.addEventListener('keydown', (event) => {
    const keys = event.ctrlKey || event.metaKey ? KEYS_WITH_CTRL : KEYS;
    // With Caps Lock, a letter is a capital.
    const key = event.key.length === 1 && !event.shiftKey ? event.key.toLowerCase() : event.key;
    if (keys.has(key) && !event.altKey) event.preventDefault();
});
canvas.addEventListener('wheel', (event) => event.preventDefault(), { passive: false });
canvas.addEventListener('contextmenu', (event) => event.preventDefault());
canvas.addEventListener('webglcontextlost', async () => {
    await autosaves.saveNow(app);
    if (!hasFailed) stop('The graphics driver has reset, so the app cannot draw any more.');
});

let app;
let hasFailed = false;

/// Passes to the app the files that the user has chosen or dropped, all in one frame: a map needs its image.
async function openUserFiles(files) {
    if (document.body.dataset.state !== 'started') return;
    // One byte more than the largest policy. The app reports what is wrong with a larger or unreadable file.
    const maxBytes = 2 ** 27 + 1;
    const read = (file) => file.slice(0, maxBytes).arrayBuffer().catch(() => new ArrayBuffer(0));
    const named = await Promise.all(Array.from(files, async (file) => [file.name, await read(file)]));
    for (const [name, bytes] of named) app.receive_file(name, new Uint8Array(bytes));
}

byId('file').addEventListener('change', (event) => {
    openUserFiles(event.target.files);
    // Without this, choosing the same file again would have no effect.
    event.target.value = '';
});
addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', (event) => {
    event.preventDefault();
    openUserFiles(event.dataTransfer?.files ?? []);
});

// When the pointer or the focus leaves the page, the user may be about to close it. While the page is hidden, no frame runs
// in which the training could be saved.
for (const [target, event] of [[document.documentElement, 'mouseleave'], [globalThis, 'blur'], [document, 'visibilitychange']])
    target.addEventListener(event, () => {
        if (document.body.dataset.state === 'started') app.save_soon();
    });

/// Compresses text to URL-safe base64; `decompress` is the inverse.
async function compress(text) {
    const bytes = await through(new TextEncoder().encode(text), new CompressionStream('deflate-raw'));
    return btoa(Array.from(new Uint8Array(bytes), (byte) => String.fromCharCode(byte)).join(''))
        .replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}
async function decompress(encoded) {
    const bytes = Uint8Array.from(atob(encoded.replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0));
    // One byte more than the largest scenario. The app reports what is wrong with a larger one.
    const maxBytes = 2 ** 20 + 1;
    const text = await through(bytes, new DecompressionStream('deflate-raw'), maxBytes);
    return new TextDecoder().decode(text);
}
/// Pipes bytes through a transform, and stops after `maxBytes`.
async function through(bytes, transform, maxBytes = Infinity) {
    const reader = new Blob([bytes]).stream().pipeThrough(transform).getReader();
    const pieces = [];
    for (let length = 0; length < maxBytes;) {
        const { done, value } = await reader.read();
        if (done) break;
        pieces.push(value);
        length += value.length;
    }
    return new Blob(pieces).arrayBuffer();
}

/// Text of the scenario embedded in the URL, if there is one.
let embeddedScenario;

/// Number of changes of the URL so far. A change that is still being prepared is dropped if another one is made meanwhile.
let addressVersion = 0;
function changeAddress(address) {
    addressVersion += 1;
    history.replaceState(null, '', address);
}

globalThis.wayfieldPage = {
    query_parameter: (key) => new URLSearchParams(location.search).get(key) ?? undefined,
    started() {
        cover.hidden = true;
        document.body.dataset.state = 'started';
        document.body.dataset.startedMs = Math.round(performance.now());
    },
    failed(text) {
        hasFailed = true;
        console.error(text);
        stop('The app has stopped because of an internal error.', text);
    },
    autosave_file: autosaves.addFile,
    autosave: (number, note) => autosaves.store(note)
        .then(() => app.autosave_stored(number), (error) => app.autosave_stored(number, String(error))),
    begin_autosave: autosaves.begin,
    delete_autosave: autosaves.remove,
    last_session: autosaves.offered,
    continues_last_session: autosaves.isContinued,
    adopt_last_session: autosaves.adopt,
    load_session: () => autosaves.load().then((files) => {
        for (const [name, bytes] of Object.entries(files)) app.receive_session_file(name, bytes);
        app.session_received();
    }).catch((error) => app.session_received(`The last session cannot be read: ${error}`)),
    last_backups: backups.offered,
    adopt_backup: backups.adopt,
    store_backup: backups.store,
    delete_backup: backups.remove,
    open_file_picker: () => byId('file').click(),
    save(name, bytes) {
        // Copied, because the memory of the module may move or change.
        const url = URL.createObjectURL(new Blob([bytes.slice()], { type: 'application/octet-stream' }));
        const link = document.createElement('a');
        link.href = url;
        link.download = name;
        link.click();
        setTimeout(() => URL.revokeObjectURL(url), 60_000);
    },
    report(json) {
        const status = JSON.parse(json);
        document.body.dataset.status = json;
        const rate = status.success_rate === null ? 'not evaluated yet'
            : `success rate ${(100 * status.success_rate).toFixed(1)} %`;
        byId('status').textContent =
            `Scenario ${status.scenario}, preset ${status.preset}: ${status.episodes} episodes, ${rate}.`
            + (status.notice === null ? '' : ` ${status.notice}`);
    },
    font_with: fontWith,
    edit_text: connect(byId('egui_text_agent'), canvas, () => app),
    embedded_scenario: () => embeddedScenario,
    async set_share_link(scenario, preset, seed, embedded) {
        const query = new URLSearchParams(location.search);
        for (const [key, value] of Object.entries({ scenario, preset, seed })) query.set(key, value);
        if (embedded === undefined) return changeAddress(`?${query}`);
        wayfieldPage.clear_share_link();
        const version = addressVersion;
        // In the fragment, which browsers do not send to the host. If the compression fails, the URL stays cleared.
        const encoded = await compress(embedded).catch(() => undefined);
        if (version === addressVersion && encoded !== undefined) changeAddress(`?${query}#scenario=${encoded}`);
    },
    clear_share_link: () => changeAddress(location.pathname),
    save_preferences(text) {
        // If storage is disabled, the preferences are not saved.
        try { localStorage.setItem(PREFERENCES_KEY, text); } catch {}
    },
    load_preferences() {
        try { return localStorage.getItem(PREFERENCES_KEY) ?? undefined; } catch { return undefined; }
    },
};

// Errors that stop the app without a call of `failed`, such as running out of memory.
addEventListener('error', (event) => {
    if (event.error instanceof WebAssembly.RuntimeError && !hasFailed) wayfieldPage.failed(String(event.error));
});

/// Fetches the module and updates the progress bar. `total` is the uncompressed size in bytes, known from the build: a host
/// that compresses does not report it.
async function fetchWithProgress(url, total) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    let received = 0;
    const counted = response.body.pipeThrough(new TransformStream({
        transform(piece, to) {
            received += piece.length;
            const fraction = Math.min(received / total, 1);
            byId('bar').value = fraction;
            byId('message').textContent = fraction === 1 ? 'Starting…' : `Loading… ${Math.round(100 * fraction)} %`;
            to.enqueue(piece);
        },
    }));
    // This content type lets the browser compile while loading. The host may send another one.
    return new Response(counted, { headers: { 'Content-Type': 'application/wasm' } });
}

/// Makes the stage so small that its canvas has at most `maxSide` device pixels per side, and scales it up to the size of
/// the page. A larger canvas cannot be drawn: it is a single GPU texture.
function fitStage(maxSide) {
    const scale = Math.max(1, ...[innerWidth, innerHeight].map((side) => Math.ceil(side * devicePixelRatio) / maxSide));
    const style = byId('stage').style;
    style.width = style.height = `${100 / scale}%`;
    style.transform = scale > 1 ? `scale(${scale})` : '';
}

async function start() {
    if (typeof WebAssembly !== 'object') {
        return stop('This browser does not support WebAssembly. Please use a recent version of any major browser.');
    }
    const gl = document.createElement('canvas').getContext('webgl2');
    if (!gl) {
        return stop('This browser does not provide WebGL 2, which the app needs to draw. It may be disabled in the settings or'
            + ' blocked because of the graphics driver. Please try another browser.');
    }
    const maxSide = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    gl.getExtension('WEBGL_lose_context')?.loseContext();
    fitStage(maxSide);
    addEventListener('resize', () => fitStage(maxSide));
    const encoded = new URLSearchParams(location.hash.slice(1)).get('scenario');
    if (encoded !== null) {
        // The app reports this text as an invalid scenario.
        embeddedScenario = await decompress(encoded).catch(() => 'not a scenario: the address is damaged');
    }
    await Promise.all([autosaves.find(), backups.find()]);
    try {
        // The build id in the URLs prevents a cache from combining files of two builds.
        const { bytes, build_id } = await fetch('build.json', { cache: 'no-cache' }).then((response) => response.json());
        const { default: initialise, ...rest } = await import(`./wayfield.js?${build_id}`);
        wayfieldPage.app = app = rest;
        await initialise({ module_or_path: await fetchWithProgress(`wayfield_bg.wasm?${build_id}`, bytes) });
    } catch (error) {
        if (!hasFailed) stop('The app could not be loaded. Please check your internet connection and reload.', String(error));
    }
}

start();
