// Backups of the scenario editor in the browser's storage: a closed tab or a crash loses only the last seconds of unsaved
// changes.
// In: the changes, as text from the app. Out: the newest backup that no open tab uses, to be restored.

import { keysInUse, lock, newKey } from './autosave.js';

const PREFIX = 'wayfield: editor ';
/// Maximum number of backups to keep, apart from those of open tabs.
const MAX_KEPT = 3;

let own = newKey();
lock(own);
/// The backup to offer, with its key.
let offer;

/// The stored backups, newest first.
function stored() {
    const keys = Object.keys(localStorage).filter((key) => key.startsWith(PREFIX));
    const read = (name) => ({ key: name.slice(PREFIX.length), ...JSON.parse(localStorage.getItem(name)) });
    return keys.map(read).sort((a, b) => b.savedMs - a.savedMs);
}

/// Looks for a backup to offer, and deletes old ones. If storage is disabled, none is offered.
export async function find() {
    try {
        const inUse = await keysInUse();
        const unused = stored().filter(({ key }) => !inUse.has(key));
        offer = unused[0];
        for (const { key } of unused.slice(MAX_KEPT)) localStorage.removeItem(PREFIX + key);
    } catch (error) {
        console.info(`no backup of the editor: ${error}`);
    }
}

/// The backup to offer, for the app.
export function offered() {
    if (offer === undefined) return undefined;
    return JSON.stringify({ text: offer.text, age_s: Math.max(0, Math.round((Date.now() - offer.savedMs) / 1000)) });
}

/// Makes the offered backup this tab's own: the next one replaces it.
export function adopt() {
    own = offer.key;
    lock(own);
    offer = undefined;
}

/// Stores this tab's backup. Returns an error message, or undefined.
export function store(text) {
    try {
        localStorage.setItem(PREFIX + own, JSON.stringify({ text, savedMs: Date.now() }));
    } catch (error) {
        return String(error);
    }
}

/// What happens to the unsaved changes, in words; undefined without any.
export function describe() {
    try {
        if (localStorage.getItem(PREFIX + own) === null) return undefined;
        return 'After a reload, you can restore the unsaved changes of the editor.';
    } catch {
        return undefined;
    }
}

/// Deletes this tab's backup.
export function remove() {
    try { localStorage.removeItem(PREFIX + own); } catch {}
}
