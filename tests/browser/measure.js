// What is wrong with the page at this width, as a list of sentences, and its links to files.
((width) => {
  const wrong = [];
  const name = (element) => {
    const text = element.textContent.trim().replace(/\s+/g, " ").slice(0, 40);
    return `<${element.tagName.toLowerCase()} class="${element.getAttribute("class") ?? ""}"> "${text}"`;
  };
  const all = (selector) => [...document.querySelectorAll(selector)];
  const scrolls = (element) => ["auto", "scroll"].includes(getComputedStyle(element).overflowX);
  const inside = (element) => {
    for (let up = element.parentElement; up; up = up.parentElement) if (scrolls(up)) return true;
    return false;
  };

  // what is folded is measured too
  for (const details of all("details")) details.open = true;

  if (document.documentElement.scrollWidth > width) wrong.push(`the page is ${document.documentElement.scrollWidth} wide`);
  for (const element of all("body *")) {
    if (inside(element)) continue;
    const box = element.getBoundingClientRect();
    if (box.width > 0 && (box.right > width + 0.5 || box.left < -0.5)) {
      wrong.push(`sticks out of the window, ${box.left} to ${box.right}: ${name(element)}`);
    }
    const own = getComputedStyle(element);
    if (own.display !== "inline" && own.overflowX === "visible" && element.scrollWidth > element.clientWidth + 1) {
      wrong.push(`its content is wider by ${element.scrollWidth - element.clientWidth}: ${name(element)}`);
    }
  }

  for (const image of all("img")) {
    if (!(image.getAttribute("alt") ?? "").trim()) wrong.push(`no alternative text: ${image.src.slice(0, 60)}`);
    if (!image.complete || image.naturalWidth === 0) wrong.push(`not drawn: ${image.src.slice(0, 60)}`);
  }

  const ids = all("[id]").map((element) => element.id);
  for (const id of ids) if (ids.indexOf(id) !== ids.lastIndexOf(id)) wrong.push(`twice the id ${id}`);
  for (const element of all("[aria-labelledby]")) {
    const label = document.getElementById(element.getAttribute("aria-labelledby"));
    if (!label) wrong.push(`nothing labels ${name(element)}`);
  }
  const files = [];
  for (const link of all("a[href]")) {
    const address = link.getAttribute("href");
    if (address.startsWith("#")) {
      if (!document.getElementById(decodeURIComponent(address.slice(1)))) wrong.push(`no target: ${address}`);
    } else if (new URL(link.href).protocol !== "file:" || link.host) {
      wrong.push(`leads away: ${link.href}`);
    } else {
      files.push(decodeURIComponent(new URL(link.href).pathname));
    }
    if (!link.textContent.trim() && !link.querySelector("img")) wrong.push(`a link without words: ${address}`);
  }

  if (all("script").length) wrong.push("there is a script");
  for (const element of all("*")) {
    for (const attribute of element.attributes) {
      if (attribute.name.startsWith("on")) wrong.push(`a script in ${attribute.name} of ${name(element)}`);
    }
  }
  if (!document.documentElement.lang) wrong.push("no language");
  if (!document.title) wrong.push("no title");
  if (all("main").length !== 1) wrong.push("not one main part");
  for (const head of all("th")) if (!head.scope) wrong.push(`no scope: ${name(head)}`);
  let level = 0;
  for (const heading of all("h1, h2, h3, h4, h5, h6")) {
    const next = Number(heading.tagName[1]);
    if (next > level + 1) wrong.push(`from level ${level} to ${next}: ${name(heading)}`);
    level = next;
  }
  return { wrong, files };
})
