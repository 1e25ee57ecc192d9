// The page around the program: it loads the module, and is to it what files, dialogs, a command line and a terminal are
// elsewhere. The program's side is src/app/browser.rs.

const byId = (id) => document.getElementById(id);
const cover = byId('cover');
const KEPT = 'wayfield: preferences';

/// The program cannot run, or not go on: says so, with `detail` for whoever reports it.
function stop(text, detail = '') {
    cover.hidden = false;
    byId('bar').hidden = true;
    byId('said').textContent = text;
    byId('detail').textContent = detail;
    byId('detail').hidden = detail === '';
    byId('again').hidden = false;
    document.body.dataset.state = 'failed';
}

byId('reload').addEventListener('click', (event) => {
    event.preventDefault();
    location.reload();
});
byId('usual').addEventListener('click', (event) => {
    event.preventDefault();
    location.assign(location.pathname);
});

// What the program does with a key or the wheel, the browser shall not do, too: scroll, leave the canvas, save the page.
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
    stop('The graphics driver has taken the picture away, and the program cannot go on without one.'));

let program;

/// Hands a file of the user's to the program.
async function openUserFile(file) {
    if (document.body.dataset.state !== 'started') return;
    // No policy is longer; the program says what is wrong with the rest, also of what cannot be read.
    const most = 2 ** 27 + 1;
    const bytes = await file.slice(0, most).arrayBuffer().catch(() => new ArrayBuffer(0));
    program.receive_file(file.name, new Uint8Array(bytes));
}

byId('file').addEventListener('change', (event) => {
    for (const file of event.target.files) openUserFile(file);
    // The same file may be chosen again.
    event.target.value = '';
});
addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', (event) => {
    event.preventDefault();
    for (const file of event.dataTransfer?.files ?? []) openUserFile(file);
});

/// A text as letters that an address may hold, and back.
async function compress(text) {
    const bytes = await through(new TextEncoder().encode(text), new CompressionStream('deflate-raw'));
    return btoa(Array.from(new Uint8Array(bytes), (byte) => String.fromCharCode(byte)).join(''))
        .replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
}
async function decompress(letters) {
    const bytes = Uint8Array.from(atob(letters.replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0));
    // No world is longer; the program says what is wrong with it.
    const most = 2 ** 20 + 1;
    const text = await through(bytes, new DecompressionStream('deflate-raw'), most);
    return new TextDecoder().decode(text);
}
async function through(bytes, transform, most = Infinity) {
    const reader = new Blob([bytes]).stream().pipeThrough(transform).getReader();
    const pieces = [];
    for (let length = 0; length < most;) {
        const { done, value } = await reader.read();
        if (done) break;
        pieces.push(value);
        length += value.length;
    }
    return new Blob(pieces).arrayBuffer();
}

/// The world that the address holds, if it holds one.
let embeddedScenario;

/// How often the address was changed: one that takes its time gives way to a later one.
let turn = 0;
function changeAddress(address) {
    turn += 1;
    history.replaceState(null, '', address);
}

let failure = false;

globalThis.wayfieldPage = {
    query_parameter: (key) => new URLSearchParams(location.search).get(key) ?? undefined,
    started() {
        cover.hidden = true;
        document.body.dataset.state = 'started';
        document.body.dataset.startedMs = Math.round(performance.now());
    },
    failed(text) {
        failure = true;
        console.error(text);
        stop('The program has stopped: it met an error of its own. What was learnt here is lost.', text);
    },
    open_file_picker: () => byId('file').click(),
    save(name, bytes) {
        // The program's memory may move or change: a copy.
        const url = URL.createObjectURL(new Blob([bytes.slice()], { type: 'application/octet-stream' }));
        const link = document.createElement('a');
        link.href = url;
        link.download = name;
        link.click();
        setTimeout(() => URL.revokeObjectURL(url), 60_000);
    },
    report(json) {
        const standing = JSON.parse(json);
        document.body.dataset.standing = json;
        const rate = standing.success_rate === null ? 'not tested yet'
            : `${(100 * standing.success_rate).toFixed(1)} % of the test's episodes succeed`;
        byId('standing').textContent =
            `${standing.scenario}, ${standing.preset}: ${standing.episodes} episodes, ${rate}.`
            + (standing.notice === null ? '' : ` ${standing.notice}`);
    },
    embedded_scenario: () => embeddedScenario,
    async set_share_link(scenario, preset, seed, world) {
        const query = new URLSearchParams(location.search);
        for (const [key, value] of Object.entries({ scenario, preset, seed })) query.set(key, value);
        if (world === undefined) return changeAddress(`?${query}`);
        wayfieldPage.clear_share_link();
        const mine = turn;
        // After the #, what a browser sends to nobody. Where it cannot be packed, there is no link.
        const letters = await compress(world).catch(() => undefined);
        if (mine === turn && letters !== undefined) changeAddress(`?${query}#world=${letters}`);
    },
    clear_share_link: () => changeAddress(location.pathname),
    save_preferences(text) {
        // Where nothing may be kept, nothing is.
        try { localStorage.setItem(KEPT, text); } catch {}
    },
    load_preferences() {
        try { return localStorage.getItem(KEPT) ?? undefined; } catch { return undefined; }
    },
};

// What ends the program without a message of its own, such as too little memory.
addEventListener('error', (event) => {
    if (event.error instanceof WebAssembly.RuntimeError && !failure) wayfieldPage.failed(String(event.error));
});

/// The module's bytes as they arrive, with the bar moving. Their number is written by the build: a host that compresses
/// says nothing of it, or something else.
async function arriving(url, total) {
    const response = await fetch(url);
    if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
    let got = 0;
    const counted = response.body.pipeThrough(new TransformStream({
        transform(piece, to) {
            got += piece.length;
            const share = Math.min(got / total, 1);
            byId('bar').value = share;
            byId('said').textContent = `Loading: ${Math.round(100 * share)} %`;
            if (share === 1) byId('said').textContent = 'Starting';
            to.enqueue(piece);
        },
    }));
    // This type makes the browser compile while it loads, whatever the host calls it.
    return new Response(counted, { headers: { 'Content-Type': 'application/wasm' } });
}

async function begin() {
    if (typeof WebAssembly !== 'object') {
        return stop('This browser runs no WebAssembly, which the program is made of. Any browser of the last years does.');
    }
    if (!document.createElement('canvas').getContext('webgl2')) {
        return stop('This browser offers no WebGL 2, by which the program draws. It may be switched off in its settings, or'
            + ' by a graphics driver that it does not trust; another browser may have it.');
    }
    const letters = new URLSearchParams(location.hash.slice(1)).get('world');
    if (letters !== null) embeddedScenario = await decompress(letters).catch(() => 'not a world: the address is damaged');
    try {
        // Which build it is, so that no cache puts parts of two together.
        const { bytes, mark } = await fetch('build.json', { cache: 'no-cache' }).then((response) => response.json());
        const { default: initialise, ...rest } = await import(`./wayfield.js?${mark}`);
        wayfieldPage.program = program = rest;
        await initialise({ module_or_path: await arriving(`wayfield_bg.wasm?${mark}`, bytes) });
    } catch (error) {
        if (!failure) stop('The program could not be loaded. Is the network there? Then try again.', String(error));
    }
}

begin();
