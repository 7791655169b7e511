/**
 * Saves a level as a file when one of the section's buttons, whose values are formats, is pressed.
 *
 * fetchFile   async (format) => {blob, name}
 */
export function listenToSave(section, fetchFile) {
  const note = section.querySelector('[role="status"]');
  section.addEventListener('click', async ({ target }) => {
    if (!target.value) return;
    note.textContent = 'Preparing …';
    try {
      giveToBrowser(await fetchFile(target.value));
      note.textContent = '';
    } catch (error) {
      note.textContent = error.message;
    }
  });
}

function giveToBrowser({ blob, name }) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
