// Backups of the scenario editor in the browser's storage: a closed tab or a crash loses only the last seconds of unsaved
// changes.
// In: the changes, as text from the app. Out: the backups that no open tab uses; the app offers the newest that it can read.

import { keysInUse, lock, lockIfFree, newKey } from './autosave.js';

const PREFIX = 'wayfield: editor ';
/// Maximum number of backups to keep, apart from those of open tabs.
const MAX_KEPT = 3;

let own = newKey();
lock(own);
/// The backups to offer, with their keys, newest first.
let offers = [];

/// The stored backups, newest first. Entries that are not backups are skipped.
function stored() {
    const read = (name) => {
        try {
            const { text, savedMs } = JSON.parse(localStorage.getItem(name));
            return { key: name.slice(PREFIX.length), text, savedMs };
        } catch {
            return {};
        }
    };
    const backups = Object.keys(localStorage).filter((key) => key.startsWith(PREFIX)).map(read);
    const isBackup = ({ text, savedMs }) => typeof text === 'string' && typeof savedMs === 'number';
    return backups.filter(isBackup).sort((a, b) => b.savedMs - a.savedMs);
}

/// Looks for backups to offer, and deletes old ones. If storage is disabled, none is offered.
export async function find() {
    try {
        const inUse = await keysInUse();
        const unused = stored().filter(({ key }) => !inUse.has(key));
        offers = unused.slice(0, MAX_KEPT);
        for (const { key } of unused.slice(MAX_KEPT)) localStorage.removeItem(PREFIX + key);
    } catch (error) {
        console.info(`no backup of the editor: ${error}`);
    }
}

/// The backups to offer, for the app.
export function offered() {
    const age = (savedMs) => Math.max(0, Math.round((Date.now() - savedMs) / 1000));
    return JSON.stringify(offers.map(({ key, text, savedMs }) => ({ key, text, age_s: age(savedMs) })));
}

/// Makes the offered backup with this key this tab's own: the tab's next backup replaces it. If another tab has adopted it
/// meanwhile, this tab stores a copy.
export async function adopt(key) {
    const { text } = offers.find((offer) => offer.key === key);
    offers = [];
    if (await lockIfFree(key)) own = key;
    else store(text);
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
