/** Where the browser keeps the key as long as its tab is open. */
const KEY = 'geosis-key';

/** Asks for the key of a server that needs one. */
export class SignIn {
  #form;
  #input;

  /** onKey(key)   when somebody has typed one. */
  constructor(form, { onKey }) {
    this.#form = form;
    this.#input = form.querySelector('input');
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      const key = this.#input.value.trim();
      sessionStorage.setItem(KEY, key);
      this.#input.value = '';
      form.hidden = true;
      onKey(key);
    });
  }

  /** The key that this tab was given; '' = none. */
  get key() {
    return sessionStorage.getItem(KEY) ?? '';
  }

  show() {
    this.#form.hidden = false;
    this.#input.focus();
  }
}
