/**
 * Starts the built binary (environment variable GEOSIS) with a sample survey loaded, runs a test with its address in
 * GEOSIS_URL, and stops it: node with_server.mjs TEST.mjs. Exits as the test does.
 */
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { createInterface } from 'node:readline';
import { fileURLToPath } from 'node:url';

const GEOSIS = process.env.GEOSIS;
const PAGE = process.env.GEOSIS_TEST_PAGE ?? fileURLToPath(new URL('../../viewer/dist', import.meta.url));
const folder = mkdtempSync(join(tmpdir(), 'geosis-e2e-'));

async function startServer() {
  const flags = ['--listen', '127.0.0.1:0', '--store', join(folder, 'store'), '--page', PAGE];
  const server = spawn(GEOSIS, ['serve', '--grpc', 'off', ...flags], { stdio: ['ignore', 'pipe', 'inherit'] });
  server.on('exit', (code, signal) => code === 0 || console.error(`the server ended: ${signal ?? `status ${code}`}`));
  const lines = createInterface({ input: server.stdout });
  const [line] = await Promise.race([once(lines, 'line'), once(server, 'exit')]);
  const url = /^listening on (http:\S+)/.exec(line)?.[1];
  if (!url) throw new Error(`the server did not start: ${line}`);
  return { server, url };
}

async function uploadSample(url) {
  const path = join(folder, 'sample.sgy');
  execFileSync(GEOSIS, ['synth', path, '--dims', '64,80,64']);
  const answer = await fetch(`${url}/v1/volumes?name=sample.sgy`, { method: 'POST', body: readFileSync(path) });
  if (answer.status !== 201) throw new Error(`upload: ${answer.status} ${await answer.text()}`);
}

let server;
let status = 1;
try {
  const started = await startServer();
  server = started.server;
  await uploadSample(started.url);
  const test = spawn(process.execPath, process.argv.slice(2), { stdio: 'inherit', env: { ...process.env, GEOSIS_URL: started.url } });
  [status] = await once(test, 'exit');
} finally {
  if (server?.exitCode === null) {
    const stopped = once(server, 'exit');
    server.kill('SIGTERM');
    await stopped;
  }
  rmSync(folder, { recursive: true });
}
process.exit(status ?? 1);
