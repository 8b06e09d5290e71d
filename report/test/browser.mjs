// SPDX-License-Identifier: GPL-3.0-or-later
// A headless Chromium that is spoken to over a pipe (the DevTools protocol), so that tests need no package.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

const FLAGS = [
  "--headless=new",
  "--remote-debugging-pipe",
  "--no-first-run",
  "--disable-extensions",
  "--disable-background-networking",
  "--disable-dev-shm-usage",
  "--hide-scrollbars",
  "--use-angle=swiftshader", // WebGL without a graphics card
  "--enable-unsafe-swiftshader",
  "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", // no network but this machine
];

export async function launch(program) {
  const profile = mkdtempSync(join(tmpdir(), "tetlap-page-"));
  const root = process.getuid?.() === 0 ? ["--no-sandbox"] : [];
  const child = spawn(program, [...FLAGS, ...root, `--user-data-dir=${profile}`, "about:blank"], {
    stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
  });
  const waiting = new Map();
  const listeners = [];
  let last = 0;
  let text = "";
  child.stdio[4].setEncoding("utf8").on("data", (part) => {
    const messages = (text + part).split("\0");
    text = messages.pop();
    for (const one of messages.map((message) => JSON.parse(message))) {
      const answer = waiting.get(one.id);
      if (answer) {
        waiting.delete(one.id);
        if (one.error) answer.reject(new Error(`${answer.method}: ${one.error.message}`));
        else answer.resolve(one.result);
      } else listeners.forEach((listener) => listener(one));
    }
  });
  child.on("exit", () => waiting.forEach(({ reject }) => reject(new Error("the browser ended"))));
  const send = (method, params = {}, sessionId) =>
    new Promise((resolve, reject) => {
      waiting.set(++last, { resolve, reject, method });
      child.stdio[3].write(`${JSON.stringify({ id: last, method, params, sessionId })}\0`);
    });
  const close = async () => {
    const ended = new Promise((resolve) => child.once("exit", resolve));
    await send("Browser.close").catch(() => child.kill());
    await ended;
    rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
  };
  return { open: (url, view) => open(send, listeners, url, view), close };
}

// A tab at `url`, ready when its document says so. `problems` collects what its console complains of.
async function open(send, listeners, url, { width = 1280, height = 900, theme = "light", isMobile = false } = {}) {
  const { targetId } = await send("Target.createTarget", { url: "about:blank" });
  const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
  const call = (method, params) => send(method, params, sessionId);
  const problems = [];
  const requests = [];
  listeners.push((event) => {
    if (event.sessionId !== sessionId) return;
    const { params } = event;
    if (event.method === "Runtime.exceptionThrown") problems.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (event.method === "Runtime.consoleAPICalled" && /error|warning|assert/.test(params.type))
      problems.push(params.args.map((one) => one.value ?? one.description).join(" "));
    if (event.method === "Log.entryAdded" && params.entry.level === "error") problems.push(params.entry.text);
    if (event.method === "Network.requestWillBeSent") requests.push(params.request.url);
  });
  for (const domain of ["Runtime", "Page", "Log", "Network"]) await call(`${domain}.enable`);
  await call("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: isMobile });
  await call("Emulation.setEmulatedMedia", { features: [{ name: "prefers-color-scheme", value: theme }] });
  await call("Page.navigate", { url });
  const page = {
    problems,
    requests,
    async eval(expression) {
      const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
      if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
      return result.value;
    },
    async until(expression, seconds = 60) {
      for (const end = Date.now() + 1000 * seconds; Date.now() < end; await new Promise((wake) => setTimeout(wake, 50)))
        if (await page.eval(expression)) return;
      throw new Error(`after ${seconds} s this is still not so: ${expression}\n${problems.join("\n")}`);
    },
    async key(key, code = key) {
      const text = key.length === 1 ? key : undefined;
      await call("Input.dispatchKeyEvent", { type: "keyDown", key, code, text });
      await call("Input.dispatchKeyEvent", { type: "keyUp", key, code });
    },
    mouse: (type, x, y, buttons = 0) => call("Input.dispatchMouseEvent", { type, x, y, buttons, button: type === "mouseMoved" && !buttons ? "none" : "left", clickCount: 1 }),
    async screenshot(whole = false) {
      const clip = whole ? { x: 0, y: 0, width, height: await page.eval("document.documentElement.scrollHeight"), scale: 1 } : undefined;
      const { data } = await call("Page.captureScreenshot", { format: "png", captureBeyondViewport: whole, clip });
      return Buffer.from(data, "base64");
    },
    close: () => send("Target.closeTarget", { targetId }),
  };
  await page.until("document.documentElement?.dataset.ready !== undefined");
  await page.eval("document.fonts.ready.then(() => undefined)");
  return page;
}
