// The program ngs-studio, and what a shell does with the commands that its page shows.
import { execFileSync, spawn } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

// Serves `source` from `folder`, as somebody would who types it there. `url` has the token.
export function startStudio(source, folder, out) {
  const stdio = ['ignore', 'ignore', 'pipe'];
  const child = spawn('ngs-studio', [source, '-o', out, '--no-browser'], { cwd: folder, stdio });
  process.on('exit', () => child.kill());
  return new Promise((resolve, reject) => {
    let said = '';
    child.stderr.on('data', (data) => {
      said += data;
      const url = /http:\/\/127\.0\.0\.1:\d+\/\?token=\w+/.exec(said)?.[0];
      if (url) resolve({ url, stop: () => stop(child) });
    });
    child.on('exit', (code) => reject(new Error(`ngs-studio ended with ${code}: ${said}`)));
  });
}

function stop(child) {
  return new Promise((resolve) => {
    if (child.exitCode !== null) return resolve(child.exitCode);
    child.removeAllListeners('exit');
    child.on('exit', (code, signal) => resolve(code ?? signal));
    child.kill('SIGTERM');
  });
}

export function runCommands(text, folder) {
  execFileSync('bash', ['-euo', 'pipefail', '-c', text], { cwd: folder, stdio: ['ignore', 'pipe', 'pipe'] });
}

// Every file below `folder` by its name there, with its bytes.
export function filesOf(folder) {
  const names = fs.readdirSync(folder, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  return new Map(names.map((entry) => {
    const file = path.join(entry.parentPath, entry.name);
    return [path.relative(folder, file), fs.readFileSync(file)];
  }));
}
