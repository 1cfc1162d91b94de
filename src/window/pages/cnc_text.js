// SPDX-License-Identifier: MIT
// A program of a CNC872: a text, a file chosen or dropped, loaded by cnc.load. What is wrong is shown at its place.
import { word } from "./words.js";
import { saveText } from "./editor.js";
import { make, write } from "./make.js";

const BYTES_MAX = 250000; // of a text, so that rkmctl window takes the message

export class CncText {
  // load(text, name): cnc.load. kind: name of a new file, words of the title and of what has been loaded, class of the element.
  constructor(load, { name, title, loaded, part }) {
    this.load = load;
    this.titleWord = title;
    this.loadedWord = loaded;
    this.element = make("section", { class: part });
    this.text = "";
    this.name = name;
    this.loaded = null; // lines of what has been loaded from here
  }

  build() {
    this.area = make("textarea", { class: "plain", spellcheck: "false", "aria-label": word(this.titleWord) });
    this.area.value = this.text;
    this.area.oninput = () => { this.text = this.area.value; };
    const file = make("input", { type: "file", hidden: "", tabindex: "-1", "aria-hidden": "true" });
    file.onchange = () => { this.take(file.files[0]); file.value = ""; };
    this.result = make("p", { class: "note", role: "status" });
    this.place = make("button", { hidden: "" }, word("cnc-place"));
    this.title = make("h3", {}, `${word(this.titleWord)} ${this.name}`);
    const button = (text, act) => make("button", { onclick: act }, text);
    this.element.replaceChildren(this.title, make("div", { class: "row" }, button(word("open"), () => file.click()),
      button(word("save"), () => saveText(this.text, this.name)), button(word("cnc-load"), () => this.send()), file),
    this.area, this.result, this.place);
    this.element.ondragover = (event) => event.preventDefault();
    this.element.ondrop = (event) => {
      event.preventDefault();
      this.take(event.dataTransfer.files[0]);
    };
  }

  async take(file) {
    if (!file)
      return;
    if (file.size > BYTES_MAX) {
      this.tell(word("cnc-large", file.name, BYTES_MAX), true);
      return;
    }
    this.name = file.name;
    write(this.title, `${word(this.titleWord)} ${this.name}`);
    this.area.value = this.text = await file.text();
    this.tell("", false);
  }

  setText(text) {
    this.area.value = this.text = text;
    this.tell("", false);
  }

  tell(text, isWrong) {
    write(this.result, text);
    this.result.classList.toggle("wrong", isWrong);
    this.place.hidden = true;
  }

  async send() {
    const { text } = this;
    if (new Blob([text]).size > BYTES_MAX) {
      this.tell(word("cnc-large", this.name, BYTES_MAX), true);
      return;
    }
    const answer = await this.load(text, this.name);
    if (!answer.error) {
      this.loaded = text.split("\n");
      this.tell(word(this.loadedWord, this.name, answer.instructions ?? answer.blocks), false);
      return;
    }
    this.tell(answer.error, true);
    const place = /:(\d+):(\d+): /.exec(answer.error);
    this.place.hidden = !place;
    this.place.onclick = () => this.show(Number(place[1]), Number(place[2]));
  }

  // Select what is at a line and column, from 1. Columns are bytes of UTF-8.
  show(line, column) {
    const lines = this.area.value.split("\n"), before = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    const bytes = new TextEncoder().encode(lines[line - 1] ?? "").slice(0, column - 1);
    const at = before + new TextDecoder().decode(bytes).length;
    this.area.focus();
    this.area.setSelectionRange(at, Math.min(at + 1, this.area.value.length));
  }

  // The text of a line that is being executed, if it has been loaded from here.
  lineText(line) { return line === null ? "" : (this.loaded?.[line - 1] ?? "").trim(); }
}
