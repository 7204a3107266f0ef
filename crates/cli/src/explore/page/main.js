/** @file The page begins here. */

/** Shows that the server is there. */
export function begin() {
  document.body.append("twinslip explore");
}

if (globalThis.document?.getElementById("begin")) {
  begin();
}
