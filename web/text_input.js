// Text input by an input method (Japanese, Chinese, ...), an emoji picker or a virtual keyboard. Browsers offer these only
// in text elements. So while the app edits text, an invisible text field has the focus: it passes keys on to the canvas,
// and composed text to the app.
// In: where the app edits text. Out: keys for the canvas; calls of `compose_text` and `insert_text` of the app.

/// A copy of a key event with the fields that the canvas reads.
const keyCopy = (event) => {
    const { key, code, location, repeat, ctrlKey, shiftKey, altKey, metaKey } = event;
    return new KeyboardEvent(event.type,
        { key, code, location, repeat, ctrlKey, shiftKey, altKey, metaKey, cancelable: true });
};

/// Whether an input method handles the key. The app must not see such a key.
const isComposed = (event) => event.isComposing || event.keyCode === 229 || event.key === 'Dead';

/// Connects `field`, the invisible text field, with `canvas`. `app` returns the functions of the app. Returns a function that
/// moves the field to the text cursor. Its argument is the cursor's left, top and height in CSS pixels, or undefined if no text
/// is edited.
export function connect(field, canvas, app) {
    let isEditing = false;

    for (const type of ['keydown', 'keyup']) {
        field.addEventListener(type, (event) => {
            if (isComposed(event)) return;
            // bevy_egui listens on the document, and on phones would handle the key again.
            event.stopPropagation();
            // Otherwise the field would also take the character.
            const isText = [...event.key].length === 1 && !event.ctrlKey && !event.metaKey;
            if (!canvas.dispatchEvent(keyCopy(event)) || isText) event.preventDefault();
        });
    }
    field.addEventListener('compositionupdate', (event) => app().compose_text(event.data));
    field.addEventListener('compositionend', (event) => {
        app().insert_text(event.data);
        field.value = '';
    });
    field.addEventListener('input', (event) => {
        if (event.isComposing) return;
        // Composed text has already arrived; pasted text arrives with the clipboard event.
        if (['insertText', 'insertReplacementText'].includes(event.inputType)) app().insert_text(field.value);
        field.value = '';
    });

    // For the app, the field is a part of the canvas.
    const keepOnCanvas = (event) => {
        if (event.target === canvas && event.relatedTarget === field) event.stopImmediatePropagation();
        if (event.target === canvas && event.type === 'focus' && isEditing) field.focus();
        if (event.target === field && event.relatedTarget !== canvas) canvas.dispatchEvent(new FocusEvent(event.type));
    };
    for (const type of ['focus', 'blur']) addEventListener(type, keepOnCanvas, true);

    return (cursor) => {
        isEditing = cursor !== undefined;
        if (isEditing) {
            const [left, top, height] = cursor;
            Object.assign(field.style, { left: `${left}px`, top: `${top}px`, height: `${height}px` });
            field.hidden = false;
            if (document.activeElement === canvas) field.focus();
        } else {
            if (document.activeElement === field) canvas.focus();
            field.hidden = true;
        }
    };
}
