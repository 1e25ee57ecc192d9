// Autosaves in the browser's database (IndexedDB): a closed tab, a crash or a lost GPU loses at most half a minute of training.
// In: the files of the training, from the app. Out: the newest session that no open tab is writing, to be continued.

const DATABASE = 'wayfield';
/// Maximum number of sessions to keep, apart from those of open tabs.
const MAX_KEPT = 3;
/// Set in the session storage while the page reloads to continue training.
const CONTINUE_KEY = 'wayfield: continue';
/// The longest wait for an autosave, in ms.
const MAX_WAIT_MS = 3000;

/// The autosave of this tab's training: its key, and the policy and time of the last save.
let own = newSession();
/// Files that the app has passed for the next autosave.
let pending = {};
/// The description of the session to offer.
let offer;
/// Whether the user asked to continue that session before the page was reloaded.
let continued = false;
/// Resolved when the next autosave to begin is stored.
let nextStored = withResolvers();
/// The autosave that is on its way to the database, if any.
let storing = Promise.resolve();

function withResolvers() {
    const parts = {};
    parts.promise = new Promise((resolve, reject) => Object.assign(parts, { resolve, reject }));
    return parts;
}

export function newKey() {
    return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, '0')).join('');
}

function newSession() {
    const key = newKey();
    lock(key);
    return { key, policy: undefined, storedAt: undefined };
}

/// Marks what is stored under a key as in use while this tab is open. (Browsers have no locks on a host without HTTPS. There,
/// everything is offered.)
export function lock(key) {
    navigator.locks?.request(`wayfield ${key}`, () => new Promise(() => {}));
}

/// Like `lock`, unless another tab uses what is stored under the key. Returns whether it was free.
export async function lockIfFree(key) {
    if (navigator.locks === undefined) return true;
    return new Promise((resolve) => navigator.locks.request(`wayfield ${key}`, { ifAvailable: true }, (held) => {
        resolve(held !== null);
        return held && new Promise(() => {});
    }));
}

export async function keysInUse() {
    const { held } = await navigator.locks?.query() ?? { held: [] };
    return new Set(held.map(({ name }) => name.replace('wayfield ', '')));
}

/// The result of a request or a transaction.
const done = (request) => new Promise((resolve, reject) => {
    request.onsuccess = request.oncomplete = () => resolve(request.result);
    request.onerror = request.onabort = () => reject(request.error ?? new Error('the browser has aborted the transaction'));
});

/// Calls `use` with the stores of notes (one per session, with its description) and of files, and waits until the changes
/// are stored.
async function withStores(mode, use) {
    const opening = indexedDB.open(DATABASE, 1);
    opening.onupgradeneeded = () => {
        opening.result.createObjectStore('notes', { keyPath: 'key' });
        opening.result.createObjectStore('files');
    };
    const database = await done(opening);
    try {
        const transaction = database.transaction(['notes', 'files'], mode);
        const [result] = await Promise.all([
            use(transaction.objectStore('notes'), transaction.objectStore('files')), done(transaction),
        ]);
        return result;
    } finally {
        database.close();
    }
}

/// The sessions that no open tab is using, newest first.
async function unused() {
    const inUse = await keysInUse();
    const notes = await withStores('readonly', (notes) => done(notes.getAll()));
    return notes.filter(({ key }) => !inUse.has(key)).sort((a, b) => b.savedMs - a.savedMs);
}

const removeAll = (keys) => withStores('readwrite', (notes, files) => {
    for (const key of keys) {
        notes.delete(key);
        files.delete(key);
    }
});

/// Looks for a session to offer, and deletes old ones. Without a database, none is offered.
export async function find() {
    try {
        const key = sessionStorage.getItem(CONTINUE_KEY);
        sessionStorage.removeItem(CONTINUE_KEY);
        if (key !== null) offer = await withStores('readonly', (notes) => done(notes.get(key)));
        continued = offer !== undefined;
        const [newest, ...older] = await unused();
        offer ??= newest;
        await removeAll(older.slice(MAX_KEPT - 1).map(({ key }) => key).filter((key) => key !== offer.key));
    } catch (error) {
        console.info(`no earlier session: ${error}`);
    }
}

/// The description of the session to offer, for the app.
export function offered() {
    if (offer === undefined) return undefined;
    return JSON.stringify({ ...offer.note, age_s: Math.max(0, Math.round((Date.now() - offer.savedMs) / 1000)) });
}
export const isContinued = () => continued;

/// The files of the offered session.
export async function load() {
    const files = await withStores('readonly', (_, files) => done(files.get(offer.key)));
    if (files === undefined) throw new Error('it was deleted');
    offer.policy = files['policy-last.safetensors'];
    return files;
}

/// Makes the offered session this tab's own: the next autosave replaces it.
export function adopt() {
    own = { key: offer.key, policy: offer.policy, storedAt: offer.savedMs };
    lock(own.key);
    offer = undefined;
}

/// Begins the autosave of another training run. The previous autosave is kept.
export function begin() {
    // Even if nothing is stored yet: the first autosave of the previous training run may still be on its way to the database.
    own = newSession();
    pending = {};
}

/// Deletes the autosave of this tab's training.
export function remove() {
    const { key } = own;
    // Only after an autosave on its way to the database, which would write what is deleted back.
    storing.catch(() => {}).then(() => removeAll([key])).catch(() => {});
    begin();
}

/// Adds a file to the next autosave. The bytes are copied, because the memory of the module may move or change.
export function addFile(name, bytes) {
    pending[name] = bytes.slice();
}

/// Stores the files that were added, in place of the autosave of this tab's training. If the browser grants no more space,
/// deletes the sessions that no open tab uses.
export async function store(noteJson) {
    const [session, files, note, stored] = [own, pending, JSON.parse(noteJson), nextStored];
    pending = {};
    nextStored = withResolvers();
    session.policy = files['policy-last.safetensors'];
    const put = () => withStores('readwrite', (notes, storedFiles) => {
        notes.put({ key: session.key, note, savedMs: Date.now() });
        storedFiles.put(files, session.key);
    });
    storing = put().catch(async (error) => {
        if (error?.name !== 'QuotaExceededError') throw error;
        await removeAll((await unused()).map(({ key }) => key));
        await put();
    });
    await storing;
    session.storedAt = Date.now();
    stored.resolve();
}

/// Asks the app to save, and waits until the autosave is stored, but at most for `MAX_WAIT_MS`.
export async function saveNow(app) {
    if (app?.save_soon === undefined) return;
    const stored = nextStored.promise;
    app.save_soon();
    await Promise.race([stored, new Promise((later) => setTimeout(later, MAX_WAIT_MS))]);
}

/// The age of the autosave in words; undefined without one.
export function describe() {
    if (own.storedAt === undefined) return undefined;
    const seconds = Math.round((Date.now() - own.storedAt) / 1000);
    return `The training run was saved ${inWords(seconds)} ago.`;
}

/// A duration, rounded down to a suitable unit.
function inWords(seconds) {
    if (seconds <= 120) return `${seconds} s`;
    const hours = Math.floor(seconds / 3600);
    if (hours < 1) return `${Math.floor(seconds / 60)} min`;
    return hours < 48 ? `${hours} h` : `${Math.floor(hours / 24)} days`;
}

/// The policy that the app passed last, even if it could not be stored.
export const lastPolicy = () => own.policy ?? new Uint8Array();

/// Makes the page continue this tab's training after it is reloaded.
export function continueAfterReload() {
    sessionStorage.setItem(CONTINUE_KEY, own.key);
}
