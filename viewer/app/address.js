/** The page's address, which remembers what is shown. */

export function addressParameters() {
  return new URL(location.href).searchParams;
}

/** Keeps these; null takes one away. */
export function remember(values) {
  const address = new URL(location.href);
  for (const [name, value] of Object.entries(values)) {
    if (value === null) address.searchParams.delete(name);
    else address.searchParams.set(name, value);
  }
  history.replaceState(null, '', address);
}

/** Forgets what was asked for, but not how it looks. */
export function forgetRequest() {
  remember({ volume: null, range: null, missing: null, min_voxels: null, velocity: null, grid: null });
}
