// Questions to the solver and their answers: newest first, stale ones stopped, nothing asked twice.

/** What a command has answered so far, made of the lines of its stream. */
export class Answer {
  constructor(slot, command, options) {
    Object.assign(this, { slot, command, options });
    this.columns = [];
    this.units = [];
    this.rows = [];
    this.special = null;
    this.pictures = [];
    this.says = [];
    this.object = null;
    this.reached = null;
    this.ended = null;
    this.error = null;
    this.lines = [];
    this.began = performance.now();
    this.milliseconds = null;
  }

  take(line) {
    this.lines.push(line);
    if (line.columns) {
      this.columns = line.columns;
      this.units = line.units ?? [];
      this.rows = [];
    } else if (line.rows) {
      for (const row of line.rows) this.rows.push(row);
    } else if (line.special) this.special = line.special;
    else if (line.picture) this.pictures.push(line.picture);
    else if (line.say !== undefined) this.says.push(line.say);
    else if (line.reached !== undefined) this.reached = line.reached;
    else if (line.object) this.object = line.object;
    else if (line.ended) this.ended = line.ended;
    else if (line.error) this.error = line.error;
    if (this.ended || this.error) this.milliseconds = performance.now() - this.began;
  }

  /** The column of that name, as an array; null where there is none. */
  column(name) {
    const place = this.columns.indexOf(name);
    return place < 0 ? null : this.rows.map((row) => row[place]);
  }

  get result() {
    return this.object?.result ?? null;
  }
}

/** One text for one question: names in order, what is not given left out. */
export function keyOf(command, options) {
  const given = Object.entries(options).filter(([, value]) => value !== null && value !== undefined && value !== false);
  given.sort(([a], [b]) => (a < b ? -1 : 1));
  return `${command} ${JSON.stringify(given)}`;
}

/** Asks the server that has sent this page. */
export class HttpTransport {
  constructor(base) {
    this.base = base;
    this.answers = true;
  }

  async ask({ command, options, background, signal }, take) {
    const headers = { "content-type": "application/json", accept: "application/x-ndjson" };
    if (background) headers.priority = "u=6";
    const body = JSON.stringify(options);
    const response = await fetch(`${this.base}api/${command}`, { method: "POST", headers, body, signal, cache: "no-store" });
    const type = response.headers.get("content-type") ?? "";
    if (!type.includes("ndjson")) {
      const answer = await response.json().catch(() => null);
      if (response.ok && answer) {
        take({ object: answer });
        take({ ended: "done" });
      } else take({ error: answer?.error ?? { kind: "defect", message: `the server answered ${response.status}` } });
      return;
    }
    const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
    let rest = "";
    for (;;) {
      const { value, done } = await reader.read();
      if (done) break;
      const lines = (rest + value).split("\n");
      rest = lines.pop();
      for (const line of lines) if (line) take(JSON.parse(line));
    }
    if (rest) take(JSON.parse(rest));
  }

  /** The page as one file with what it shows; null where that failed. */
  async save(content) {
    const headers = { "content-type": "application/json" };
    const response = await fetch(`${this.base}api/save`, { method: "POST", headers, body: JSON.stringify(content) });
    return response.ok ? response.text() : null;
  }
}

/** Asks the kernel of a notebook, by the messages of its widget. */
export class WidgetTransport {
  constructor(model) {
    this.model = model;
    this.answers = true;
    this.waiting = new Map();
    // All views of a widget get all messages: each has names of its own for its questions.
    this.name = Math.random().toString(36).slice(2);
    this.next = 1;
    this.listener = (message) => {
      if (message.type === "lines") this.waiting.get(message.id)?.(message.lines);
    };
    model.on("msg:custom", this.listener);
  }

  /** The view has gone: nothing is asked any more. */
  close() {
    this.answers = false;
    this.model.off("msg:custom", this.listener);
  }

  ask({ command, options, background, signal }, take) {
    const id = `${this.name}-${this.next++}`;
    return new Promise((done, failed) => {
      if (!this.answers) {
        failed(new DOMException("the view has gone", "AbortError"));
        return;
      }
      const leave = () => {
        this.waiting.delete(id);
        this.model.send({ type: "stop", id });
        failed(new DOMException("stopped", "AbortError"));
      };
      signal?.addEventListener("abort", leave, { once: true });
      this.waiting.set(id, (lines) => {
        for (const line of lines) {
          take(line);
          if (!line.ended && !line.error) continue;
          this.waiting.delete(id);
          signal?.removeEventListener("abort", leave);
          done();
        }
      });
      this.model.send({ type: "ask", id, command, options, background: Boolean(background) });
    });
  }
}

/** Answers what a saved page has kept, by its slot; it computes nothing. */
export class RecordedTransport {
  constructor(recording) {
    this.recording = recording;
    this.answers = false;
  }

  async ask({ slot }, take) {
    const lines = this.recording[slot];
    if (!lines) take({ error: { kind: "saved", message: "This saved page has no answer to that." } });
    else for (const line of lines) take(line);
  }
}

/** Curves that refine behind are few at once: a browser opens six connections to a server, and drags need some. */
const BACKGROUND = 2;
/** Answers that are kept for going back. */
const KEPT = 300;
/** Answers with more rows are not kept. */
const KEPT_ROWS = 50000;

/** Asks for each slot (a pane's question at a point) one thing at a time, the newest. */
export class Engine {
  constructor(transport) {
    this.transport = transport;
    this.current = new Map();
    this.kept = new Map();
    this.waiting = [];
    this.running = 0;
    this.listeners = new Set();
  }

  /** Whether new questions are answered, and not only those of a recording. */
  get answers() {
    return this.transport.answers;
  }

  /** Calls back whenever what is being computed changes, with the slots. */
  onChange(listener) {
    this.listeners.add(listener);
  }

  /** The slots for which something is computed. */
  get busy() {
    return [...this.current.entries()].filter(([, one]) => one.busy).map(([slot]) => slot);
  }

  changed() {
    // Answers that come at once are no news.
    this.telling ??= setTimeout(() => {
      this.telling = null;
      const slots = this.busy;
      for (const listener of this.listeners) listener(slots);
    }, 60);
  }

  /** Stops what is asked for that slot. */
  stop(slot) {
    const current = this.current.get(slot);
    if (!current) return;
    current.abort.abort();
    this.current.delete(slot);
    this.waiting = this.waiting.filter((one) => one !== current);
    this.changed();
  }

  /** Stops all slots of which this is true. */
  stopWhere(is) {
    for (const slot of [...this.current.keys()]) if (is(slot)) this.stop(slot);
  }

  /**
   * Asks a command for a slot and stops what was asked for it before.
   *
   * What is asked in the background waits its turn, `first` before the others; `onUpdate(answer)` is called as lines come and at the end. Resolves with the answer, or null where a newer question took its place.
   */
  ask(slot, command, options, { background = false, first = false, onUpdate } = {}) {
    const key = keyOf(command, options);
    const before = this.current.get(slot);
    if (before && before.key === key && (before.busy || !before.answer.error)) {
      if (onUpdate) before.listeners.push(onUpdate);
      if (onUpdate && before.answer.lines.length) onUpdate(before.answer);
      return before.promise;
    }
    this.stop(slot);
    const one = { slot, key, busy: true, abort: new AbortController(), listeners: onUpdate ? [onUpdate] : [] };
    one.answer = new Answer(slot, command, options);
    this.current.set(slot, one);
    const kept = this.kept.get(key);
    if (kept) {
      one.busy = false;
      one.answer = Object.assign(Object.create(Answer.prototype), kept, { slot, fromMemory: true });
      one.promise = Promise.resolve(one.answer);
      onUpdate?.(one.answer);
      this.changed();
      return one.promise;
    }
    one.promise = new Promise((resolve) => {
      one.start = () => this.run(one, { command, options, background }).then(resolve);
      one.abort.signal.addEventListener("abort", () => resolve(null), { once: true });
    });
    one.background = background;
    if (background) {
      if (first) this.waiting.unshift(one);
      else this.waiting.push(one);
      this.next();
    } else one.start();
    this.changed();
    return one.promise;
  }

  next() {
    while (this.running < BACKGROUND && this.waiting.length) {
      const one = this.waiting.shift();
      this.running += 1;
      one.start().finally(() => {
        this.running -= 1;
        this.next();
      });
    }
  }

  async run(one, { command, options, background }) {
    const { answer } = one;
    const signal = one.abort.signal;
    const tell = () => {
      if (this.current.get(one.slot) === one) for (const listener of one.listeners) listener(answer);
    };
    let drawn = 0;
    const take = (line) => {
      if (signal.aborted) return;
      answer.take(line);
      // As many updates as a screen shows.
      const now = performance.now();
      if (now - drawn < 30 || line.ended || line.error) return;
      drawn = now;
      tell();
    };
    answer.began = performance.now();
    try {
      await this.transport.ask({ slot: one.slot, command, options, background, signal }, take);
    } catch (error) {
      if (signal.aborted) return null;
      answer.error = { kind: "defect", message: `No answer: ${error.message}. Has the program ended?` };
    }
    if (signal.aborted) return null;
    if (!answer.ended && !answer.error) answer.error = { kind: "defect", message: "The answer ended early." };
    answer.milliseconds ??= performance.now() - answer.began;
    one.busy = false;
    if (!answer.error && answer.rows.length <= KEPT_ROWS) {
      this.kept.set(one.key, answer);
      if (this.kept.size > KEPT) this.kept.delete(this.kept.keys().next().value);
    }
    tell();
    this.changed();
    return answer;
  }

  /** What is shown now, slot by slot, for a saved page. */
  recording() {
    const all = [...this.current.entries()].filter(([, one]) => !one.busy && one.answer.lines.length);
    return Object.fromEntries(all.map(([slot, one]) => [slot, one.answer.lines]));
  }
}
