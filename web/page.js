// The page around the app: loads the module, and stands in for files, dialogs, a command line and a terminal. Its
// counterpart in the app is src/app/browser.rs.

const byId = (id) => document.getElementById(id);
const cover = byId('cover');
const PREFERENCES_KEY = 'wayfield: preferences';

/// Reports that the app cannot run or continue. `detail` is for bug reports.
function stop(text, detail = '') {
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
byId('reset').addEventListener('click', (event) => {
    event.preventDefault();
    location.assign(location.pathname);
});

// Keys that the app handles, so that the browser must not: no scrolling, no leaving the canvas, no saving of the page.
const KEYS = new Set([' ', 'Tab', 'ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', '/', "'"]);
const KEYS_WITH_CTRL = new Set(['s', 'o']);
const canvas = byId('canvas');
canvas.addEventListener('keydown', (event) => {
    const keys = event.ctrlKey || event.metaKey ? KEYS_WITH_CTRL : KEYS;
    if (keys.has(event.key) && !event.altKey) event.preventDefault();
});
canvas.addEventListener('wheel', (event) => event.preventDefault(), { passive: false });
canvas.addEventListener('contextmenu', (event) => event.preventDefault());
canvas.addEventListener('webglcontextlost', () =>
    stop('The graphics driver has reset, so the app cannot draw any more. Training progress was lost.'));

let app;

/// Passes a file from the user to the app.
async function openUserFile(file) {
    if (document.body.dataset.state !== 'started') return;
    // One byte more than the largest policy. The app reports what is wrong with a larger or unreadable file.
    const maxBytes = 2 ** 27 + 1;
    const bytes = await file.slice(0, maxBytes).arrayBuffer().catch(() => new ArrayBuffer(0));
    app.receive_file(file.name, new Uint8Array(bytes));
}

byId('file').addEventListener('change', (event) => {
    for (const file of event.target.files) openUserFile(file);
    // Without this, choosing the same file again would have no effect.
    event.target.value = '';
});
addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', (event) => {
    event.preventDefault();
    for (const file of event.dataTransfer?.files ?? []) openUserFile(file);
});

/// Compresses a text to characters allowed in an address; `decompress` is the inverse.
async function compress(text) {
    const bytes = await through(new TextEncoder().encode(text), new CompressionStream('deflate-raw'));
    return btoa(Array.from(new Uint8Array(bytes), (byte) => String.fromCharCode(byte)).join(''))
        .replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}
async function decompress(letters) {
    const bytes = Uint8Array.from(atob(letters.replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0));
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

/// Text of the scenario embedded in the address, if there is one.
let embeddedScenario;

/// Number of changes of the address. A change that takes long is dropped if a later one was made meanwhile.
let addressVersion = 0;
function changeAddress(address) {
    addressVersion += 1;
    history.replaceState(null, '', address);
}

let hasFailed = false;

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
        stop('The app has stopped because of an internal error. Training progress was lost.', text);
    },
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
    embedded_scenario: () => embeddedScenario,
    async set_share_link(scenario, preset, seed, embedded) {
        const query = new URLSearchParams(location.search);
        for (const [key, value] of Object.entries({ scenario, preset, seed })) query.set(key, value);
        if (embedded === undefined) return changeAddress(`?${query}`);
        wayfieldPage.clear_share_link();
        const version = addressVersion;
        // After the #, because browsers do not send that part to the host. If it cannot be compressed, there is no link.
        const letters = await compress(embedded).catch(() => undefined);
        if (version === addressVersion && letters !== undefined) changeAddress(`?${query}#scenario=${letters}`);
    },
    clear_share_link: () => changeAddress(location.pathname),
    save_preferences(text) {
        // Storage may be disabled; then nothing is stored.
        try { localStorage.setItem(PREFERENCES_KEY, text); } catch {}
    },
    load_preferences() {
        try { return localStorage.getItem(PREFERENCES_KEY) ?? undefined; } catch { return undefined; }
    },
};

// Errors that stop the app without calling `failed`, such as too little memory.
addEventListener('error', (event) => {
    if (event.error instanceof WebAssembly.RuntimeError && !hasFailed) wayfieldPage.failed(String(event.error));
});

/// Fetches the module and updates the progress bar. `total` comes from the build, because a host that compresses does not
/// report the uncompressed size.
async function fetchWithProgress(url, total) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    let received = 0;
    const counted = response.body.pipeThrough(new TransformStream({
        transform(piece, to) {
            received += piece.length;
            const share = Math.min(received / total, 1);
            byId('bar').value = share;
            byId('message').textContent = share === 1 ? 'Starting…' : `Loading… ${Math.round(100 * share)} %`;
            to.enqueue(piece);
        },
    }));
    // This type lets the browser compile while loading, whatever type the host sends.
    return new Response(counted, { headers: { 'Content-Type': 'application/wasm' } });
}

async function start() {
    if (typeof WebAssembly !== 'object') {
        return stop('This browser does not support WebAssembly. Please use a recent version of any major browser.');
    }
    if (!document.createElement('canvas').getContext('webgl2')) {
        return stop('This browser does not provide WebGL 2, which the app needs to draw. It may be disabled in the settings or'
            + ' blocked because of the graphics driver. Please try another browser.');
    }
    const letters = new URLSearchParams(location.hash.slice(1)).get('scenario');
    if (letters !== null) embeddedScenario = await decompress(letters).catch(() => 'not a scenario: the address is damaged');
    try {
        // The mark of the build, so that no cache combines the files of two builds.
        const { bytes, mark } = await fetch('build.json', { cache: 'no-cache' }).then((response) => response.json());
        const { default: initialise, ...rest } = await import(`./wayfield.js?${mark}`);
        wayfieldPage.app = app = rest;
        await initialise({ module_or_path: await fetchWithProgress(`wayfield_bg.wasm?${mark}`, bytes) });
    } catch (error) {
        if (!hasFailed) stop('The app could not be loaded. Please check your internet connection and reload.', String(error));
    }
}

start();
