// Starts ngs-studio, and runs the commands that its page shows in a shell.
import { execFileSync, spawn } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

// Starts ngs-studio for `source` with working directory `folder`. `url` includes the token.
export function startStudio(source, folder, out) {
  const stdio = ['ignore', 'ignore', 'pipe'];
  const child = spawn('ngs-studio', [source, '-o', out, '--no-browser'], { cwd: folder, stdio });
  process.on('exit', () => child.kill());
  return new Promise((resolve, reject) => {
    let output = '';
    child.stderr.on('data', (data) => {
      output += data;
      const url = /http:\/\/127\.0\.0\.1:\d+\/\?token=\w+/.exec(output)?.[0];
      if (url) resolve({ url, stop: () => stop(child) });
    });
    child.on('exit', (code) => reject(new Error(`ngs-studio ended with ${code}: ${output}`)));
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

// Map of relative path to content for every file below `folder`.
export function filesOf(folder) {
  const names = fs.readdirSync(folder, { recursive: true, withFileTypes: true }).filter((entry) => entry.isFile());
  return new Map(names.map((entry) => {
    const file = path.join(entry.parentPath, entry.name);
    return [path.relative(folder, file), fs.readFileSync(file)];
  }));
}
